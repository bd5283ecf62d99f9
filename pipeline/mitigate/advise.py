"""From what fails to what helps: the least intrusive measure of the table that passes when its models are run again."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from pipeline.charting import SHELF, Shelf
from pipeline.charts import chart_key
from pipeline.climb import AUTO
from pipeline.mitigate.bench import Bench, Carriage, Fineness, Trial, checks, passes, why_not
from pipeline.mitigate.means import Means, Measure, own_means
from pipeline.mitigate.measures import DISPLACEMENTS, MEASURES
from pipeline.mitigate.offers import Need, Offer, Proposal, Way
from pipeline.mitigate.shared import SHARED, case_of, company
from pipeline.records import Check, Executor, Finding, Mark, Progress, Recommendation, Scene, Verdict
from pipeline.tables import TableError
from pipeline.verdicts import LevelMotions

ROOM = ("clearance", "rubber_pads", "restrain")
"""Measures worth advising where only the assumed room leaves the verdict open."""

Unit = tuple[Need, ...]
"""Objects that one measure is for: one, or all that share a support."""


def advise(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    executor: Executor,
    progress: Progress,
    *,
    means: Means | None = None,
    fidelity: str = AUTO,
    azimuth_step: float = 10.0,
    charts: Shelf = SHELF,
    carriage: Carriage | None = None,
) -> list[list[Recommendation]]:
    """Recommend one measure for each object and level at which something fails, or is open for want of room alone.

    A measure is a changed scene, and it passes where every model of that scene passes under all motions of the level,
    whatever its uncertain inputs are within their ranges.  So an object whose sliding fails while its rocking is open
    is not told to keep clear: what is advised also keeps it from rocking.  Where nothing fails and something else than
    room is open, nothing is advised: a measurement settles that (`pipeline.survey`).

    levels   : of shaking, with the motions that the findings were made under
    means    : the measures and isolators that there are; None: Kouros's own tables
    fidelity, azimuth_step, charts : as the findings were made
    carriage : what isolators pass on, kept from one call to the next; None: for this call only
    returns  : the recommendations of each scene, in the order of the scenes
    raises   : TableError where the last measure of the table is not removal
    """
    have = means or own_means()
    if not have.measures or have.measures[-1].name != "remove":
        raise TableError("measures.csv: the last measure must always be possible (remove)")
    out: list[list[Recommendation]] = [[] for _ in scenes]
    for at, level in enumerate(levels):
        bench = Bench(level, have, executor, Fineness(fidelity, azimuth_step, charts), carriage)
        search = _Search(bench, _needs(scenes, findings, level.name), _unassessed(scenes, findings))
        for done, measure in enumerate(have.measures, start=1):
            search.tries(measure)
            progress.step("recommendations", at * len(have.measures) + done, len(levels) * len(have.measures))
        for index, recommendation in search.recommended.items():
            out[index].append(recommendation)
    return out


def _needs(scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]], level: str) -> list[Need]:
    out = []
    for index, (scene, found) in enumerate(zip(scenes, findings, strict=True)):
        here = tuple(f for f in found if f.level == level)
        if here:
            wanted = any(f.verdict is Verdict.FAIL for f in here) or _for_room_alone(here)
            out.append(Need(index, scene, here, wanted))
    return out


def _for_room_alone(findings: Sequence[Finding]) -> bool:
    still = [f for f in findings if f.verdict is Verdict.UNDETERMINED]
    return bool(still) and all(f.model in DISPLACEMENTS for f in still)


def _unassessed(
    scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]]
) -> Mapping[tuple[str, str], tuple[str, ...]]:
    out: dict[tuple[str, str], tuple[str, ...]] = {}
    for scene, found in zip(scenes, findings, strict=True):
        case = case_of(scene)
        if case is not None and not found:
            out[case] = (*out.get(case, ()), scene.item.object_number)
    return out


@dataclass
class _Search:
    """The objects of one level that still need something, and what was tried for them.

    unassessed  : numbers of what no model could be run for, by the case that it stands in
    recommended : by the place of the scene
    """

    bench: Bench
    needs: Sequence[Need]
    unassessed: Mapping[tuple[str, str], tuple[str, ...]]
    recommended: dict[int, Recommendation] = field(default_factory=dict)
    rejected: dict[int, list[str]] = field(default_factory=dict)

    def tries(self, measure: Measure) -> None:
        """Try a measure on everything that still needs one: all first offers together, then all second ones."""
        pending = [need for need in self.needs if need.wanted and need.index not in self.recommended]
        # What is only open for want of room is no reason to take it off display.
        pending = [n for n in pending if measure.name in ROOM or any(f.verdict is Verdict.FAIL for f in n.findings)]
        open_: list[tuple[Unit, Proposal, Iterator[Offer]]] = []
        for unit in self._units(pending, measure):
            proposal = (
                SHARED[measure.name](unit, self.bench, measure)
                if measure.name in SHARED
                else MEASURES[measure.name](unit[0], self.bench, measure)
            )
            open_.append((unit, proposal, iter(proposal.offers)))
        last: dict[Unit, str] = {}
        while open_:
            open_ = self._round(open_, measure, last)

    def _units(self, pending: Sequence[Need], measure: Measure) -> list[Unit]:
        if measure.name not in SHARED:
            return [(need,) for need in pending]
        cases = {case_of(need.scene) for need in pending} - {None}
        units: list[Unit] = [tuple(n for n in self.needs if case_of(n.scene) == case) for case in cases]
        units += [(need,) for need in pending if case_of(need.scene) is None]
        return sorted(units, key=lambda unit: unit[0].index)

    def _round(
        self, units: Sequence[tuple[Unit, Proposal, Iterator[Offer]]], measure: Measure, last: dict[Unit, str]
    ) -> list[tuple[Unit, Proposal, Iterator[Offer]]]:
        asked = []
        for unit, proposal, offers in units:
            offer = next(offers, None)
            if offer is None:
                self._reject(unit, measure, proposal.reason or last.get(unit, "not enough"))
            else:
                asked.append((unit, proposal, offers, offer))
        found = iter(self.bench.run([trial for *_, offer in asked for trial in offer.every]))
        still = []
        for unit, proposal, offers, offer in asked:
            results = {id(trial): next(found) for trial in offer.every}
            stands = [next((w for w in ways if passes(results[id(w.trial)])), None) for _, ways in offer.stands]
            failing = [trial for trial in offer.trials if not passes(results[id(trial)])]
            held = all(check.passes for check in offer.checks)
            if not failing and held and all(way is not None for way in stands):
                self._recommend(unit, measure, offer, [way for way in stands if way is not None], results)
                continue
            last[unit] = _said(failing, offer, results)
            still.append((unit, proposal, offers))
        return still

    def _reject(self, unit: Unit, measure: Measure, reason: str) -> None:
        for need in unit:
            if need.wanted and need.index not in self.recommended:
                self.rejected.setdefault(need.index, []).append(f"{measure.title}: {reason}")

    def _recommend(
        self,
        unit: Unit,
        measure: Measure,
        offer: Offer,
        ways: Sequence[Way],
        results: Mapping[int, Sequence[Finding]],
    ) -> None:
        """Record the measure for every object of the unit that needs one.

        What a support does for one object it does for all on it: it takes the place of a lesser measure on each.
        """
        for at, need in enumerate(unit):
            if not need.wanted:
                continue
            ran = [f for trial in offer.trials for f in results[id(trial)]]
            words = dict(offer.words)
            if ways:
                ran += results[id(ways[at].trial)]
                case = case_of(need.scene)
                unknown = self.unassessed.get(case, ()) if case is not None else ()
                words |= {"what": company(unit, need, unknown), "how": ways[at].said}
            numbers = {**offer.numbers, **offer.finish(ran)}
            self.recommended[need.index] = Recommendation(
                object_number=need.number,
                gallery=need.scene.item.gallery,
                level=self.bench.level.name,
                measure=measure.name,
                title=measure.title,
                sentence=_sentence(measure.sentence, words),
                parameters={name: value for name, (value, _) in numbers.items()},
                units={name: unit_ for name, (_, unit_) in numbers.items()},
                checks=(*offer.checks, *checks(ran, need.findings)),
                rejected=tuple(self.rejected.get(need.index, ())),
                mark=self._mark(offer, ran, measure.title),
                source=measure.source,
            )

    def _mark(self, offer: Offer, ran: Sequence[Finding], title: str) -> Mark | None:
        if offer.mark is not None:
            kind, x, y = offer.mark
            return Mark(chart_key(kind, self.bench.level.motions[0]), x, y, title)
        marks = [f.mark for f in ran if f.model == offer.mark_of and f.mark is not None]
        return replace(marks[0], label=title) if marks else None


def _said(failing: Sequence[Trial], offer: Offer, results: Mapping[int, Sequence[Finding]]) -> str:
    if failing:
        return why_not(failing[0].scene, results[id(failing[0])])
    short: list[Check] = [check for check in offer.checks if not check.passes]
    return f"{short[0].title.lower()} is not enough" if short else ""


def _sentence(sentence: str, words: Mapping[str, str]) -> str:
    """Put words into a sentence, whose numbers are filled in later: a brace in them is no placeholder."""

    def said(found: re.Match[str]) -> str:
        text = words.get(found[1])
        return found[0] if text is None else text.replace("{", "{{").replace("}", "}}")

    return re.sub(r"{(\w+)}", said, sentence)
