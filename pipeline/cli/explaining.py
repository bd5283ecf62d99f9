"""`kouros run --explain`: the chain of reasoning for one object as text or JSON."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from itertools import groupby
from typing import TYPE_CHECKING

import click

from pipeline.cli.console import printable
from pipeline.cli.shared import Options
from pipeline.quantities import figures

if TYPE_CHECKING:
    from pipeline.records import Estimate, Likelihood, Recommendation
    from pipeline.settings import Settings
    from pipeline.tools.explain import Explanation, Reasoning, Taken


def print_explanation(settings: "Settings", number: str, options: Options, as_json: bool) -> None:
    """Explain one object and print it; nothing is stored.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    number : str
        The museum's number of the object.
    options : Options
        Those that all commands share.
    as_json : bool
        JSON in place of lines.
    """
    from pipeline.operations.run_summary import json_ready
    from pipeline.operations.workspace import open_workspace
    from pipeline.tools.explain import explain

    with options.console() as console:
        explained = explain(open_workspace(settings), number, console)
    if as_json:
        click.echo(json.dumps([json_ready(asdict(one)) for one in explained], indent=2, default=str))
    else:
        # What a record, a manifest or a person's reason holds must not steer a terminal.
        lines = (explanation_lines(one, every=options.verbose) for one in explained)
        click.echo("\n\n".join("\n".join(map(printable, one)) for one in lines))


def explanation_lines(explained: "Explanation", *, every: bool = False) -> Iterator[str]:
    """Yield the reasoning for one object, line by line: what came of it first.

    Parameters
    ----------
    explained : Explanation
        Of the object.
    every : bool
        Each step of each motion; else what the steps of a motion come to.

    Yields
    ------
    str
        A line.
    """
    from pipeline.report.pages.chances import worth_words

    scene = explained.scene
    item = scene.item
    yield f"{item.object_number}  {item.title}  ({item.gallery})"
    yield from _in_short(explained)
    yield f"  class    {scene.object_class}, by rule {scene.rule}"
    yield from _class_lines(explained)
    yield f"  support  {scene.support.value}" + (f", on floor {scene.floor}" if scene.floor else "")
    if scene.mount is not None and scene.mount_origin is not None:
        yield f"  mount    {scene.mount.value}, {scene.mount_origin.value}"
    for statement in scene.statements:
        yield f"  house    {statement}"
    if explained.worth is not None:
        yield f"  worth    {worth_words(scene, explained.worth)}"
    for missing in scene.missing:
        yield f"  missing  {missing}"
    yield "  numbers"
    told: set[str] = set()
    for name, estimate in scene.parameters.items():
        yield f"    {name:<22}{_estimate(estimate, told)}"
    if scene.skipped:
        yield "  not run"
        for title, why in scene.skipped.items():
            yield f"    {title}: {why}"
    for reasoning in explained.reasonings:
        yield from _reasoning(reasoning, every)
    for found in explained.likelihoods:
        yield from _likelihood(found)
    for advice in explained.advice:
        yield from _advice(advice)


def _in_short(explained: "Explanation") -> Iterator[str]:
    """Yield what came of it: how likely harm is, each verdict, and what is advised."""
    for found in explained.likelihoods:
        yield f"  harm     {found.band.value} ({figures(found.probability, 3)}), {found.level}"
    for reasoning in explained.reasonings:
        finding = reasoning.finding
        yield f"  verdict  {finding.title}: {finding.verdict.value}" + (
            f", {finding.outcome}" if finding.outcome else ""
        )
    for advice in explained.advice:
        yield f"  advice   {advice.title}"


def _class_lines(explained: "Explanation") -> Iterator[str]:
    """Yield how likely the classes are, and what that leans on: the natural logarithm of the odds."""
    chances = explained.scene.chances
    if chances:
        yield "  likely   " + ", ".join(f"{name} {probability:.2f}" for name, probability in chances)
    for second, signs in explained.leaning:
        yield f"  leaning  against {second} (logarithm of the odds)"
        for sign, weight in signs:
            yield f"    {weight:+.2f}  {sign}"


def _likelihood(found: "Likelihood") -> Iterator[str]:
    from pipeline.records.likelihood import CLASS

    yield f"  harm, {found.level}: {found.band.value}"
    yield f"    probability {figures(found.probability, 3)} ± {found.error:.1g}, of {found.samples} samples"
    for one in found.classes:
        # What harm does to it as each class, of as many of the samples as had it be that.
        harmed = "not drawn" if one.probability is None else f"harm {one.probability:.2g} of {one.samples} samples"
        yield f"    if {' or '.join(one.classes)} ({one.chance:.2f}): {harmed}"
    for state, probability in found.states.items():
        yield f"    {state:<10}{figures(probability, 3)}"
    if found.open_for:
        what = "what it is" if found.open_for == CLASS else found.open_for
        yield f"    open      {what} alone may change what is decided; it is worth {found.worth:.2g}"


def _reasoning(reasoning: "Reasoning", every: bool) -> Iterator[str]:
    finding = reasoning.finding
    yield f"  {finding.title}, {finding.level} [{finding.demand_name}, {finding.unit}]"
    if finding.screen:
        yield f"    screen    {finding.screen} (never decides)"
    yield from map(_step, reasoning.taken) if every else _steps(reasoning.taken)
    yield f"    capacity  {_estimate(reasoning.capacity)}"
    at_most = "at most " if finding.fidelity == "bound" and finding.error else ""
    span = "at most" if finding.range_is == "bounds" else f"{_number(finding.low)} to"
    yield f"    demand    {at_most}{_number(finding.demand)} ({span} {_number(finding.high)})"
    outcome = f", {finding.outcome}" if finding.outcome else ""
    yield f"    verdict   {finding.verdict.value}{outcome}, decided by {finding.decided_by}, under {finding.motion}"
    if finding.note:
        yield f"    note      {finding.note}"


def _step(taken: "Taken", more: str = "") -> str:
    return f"    {taken.step:<10}{taken.motion}, {taken.inputs}: {taken.told or _taken(taken)}{more}"


def _steps(taken: Iterable["Taken"]) -> Iterator[str]:
    """Yield the steps of one kind under one motion as one line: of the best estimates, and between which others lie."""
    from pipeline.tools.explain import BEST

    for _, group in groupby(taken, key=lambda one: (one.motion, one.step)):
        those = list(group)
        first = next((one for one in those if one.inputs.startswith(BEST)), those[0])
        span = f"{_number(min(one.low for one in those))} to {_number(max(one.high for one in those))}"
        others = len(those) - 1
        yield _step(first, f"; with {others} other set{'s' * (others > 1)}: {span}" if others else "")


def _taken(taken: "Taken") -> str:
    if taken.error is None:
        return _number(taken.low) if taken.low == taken.high else f"{_number(taken.low)} to {_number(taken.high)}"
    value = 0.5 * (taken.low + taken.high)
    return f"{_number(value)} ± {taken.error:.2g}"


def _advice(advice: "Recommendation") -> Iterator[str]:
    values = ", ".join(f"{name} {_number(v)} {advice.units[name]}" for name, v in advice.parameters.items())
    yield f"  advice, {advice.level}: {advice.title}" + (f" ({values})" if values else "")
    from pipeline.mitigate.by_class import NAMED_FIRST
    from pipeline.mitigate.saying import ANCHORED, ONLY_HERE

    if advice.sentence.startswith(ANCHORED):
        yield f"    {ANCHORED}"
    yield from (f"    {words}" for words in (ONLY_HERE, NAMED_FIRST) if words in advice.sentence)
    if advice.remaining is not None:
        yield f"    harm remains with a probability of {advice.remaining:.2g}"
    for check in advice.checks:
        state = "passes" if check.passes else "fails"
        yield f"    {check.title}: {_number(check.demand)} of {_number(check.capacity)} {check.unit}, {state}"
    for rejected in advice.rejected:
        yield f"    rejected  {rejected}"


def _estimate(estimate: "Estimate", told: set[str] | None = None) -> str:
    """Say a number with its range, origin and source; a source among those that were told is not told again."""
    span = f" ({_number(estimate.low)} to {_number(estimate.high)})" if estimate.low < estimate.high else ""
    why = f": {estimate.note}" if estimate.note else ""
    source = f" [{estimate.source}]" if estimate.source and estimate.source not in (told or ()) else ""
    if told is not None:
        told.add(estimate.source)
    return f"{_number(estimate.value)} {estimate.unit}{span}, {estimate.origin.value}{why}{source}"


def _number(value: float | None) -> str:
    return "not known" if value is None else figures(value, 4)
