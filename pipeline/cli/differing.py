"""Changes between two runs, as lines or as JSON."""

import json
from collections.abc import Sequence
from typing import Any

import click

from pipeline.cli.console import listed, printable
from pipeline.operations.run_summary import json_ready, plain_changes
from pipeline.quantities import figures
from pipeline.records import FieldChange, RunChanges, VerdictChange
from pipeline.report.pages.news import sentences

NEWS = 20
"""Objects whose news is printed; JSON has all."""


def print_changes(changes: RunChanges, wanted_json: bool) -> None:
    """Print what changed, news of objects first; lines show the first of each kind, JSON has all.

    Parameters
    ----------
    changes : RunChanges
        Between two runs.
    wanted_json : bool
        JSON in place of lines.
    """
    if wanted_json:
        click.echo(json.dumps(json_ready(plain_changes(changes)), indent=2))
        return
    click.echo(f"from {changes.old} to {changes.new}")
    for sentence in sentences(changes, NEWS):
        click.echo(f"  {printable(sentence)}")
    for title, lines in _kinds(changes):
        listed(title, lines)
    if not changes:
        click.echo("nothing changed")


def _kinds(changes: RunChanges) -> list[tuple[str, Sequence[str]]]:
    return [
        ("worse", [_verdict(v) for v in changes.worsened]),
        ("fixed", [_verdict(v) for v in changes.fixed]),
        ("verdict", [_verdict(v) for v in changes.others]),
        ("new", [f"{p.object_number} ({p.gallery})" for p in changes.added]),
        ("gone", [f"{p.object_number} ({p.gallery})" for p in changes.removed]),
        ("moved", [f"{m.object_number}: {m.before} -> {m.after}" for m in changes.moved]),
        ("changed", [f"{i.object_number} ({i.gallery}): {'; '.join(map(_field, i.fields))}" for i in changes.inputs]),
        ("motion", [f"{m.level} {m.name}{f' on floor {m.floor}' if m.floor else ''}" for m in changes.motions]),
        (
            "decision",
            [
                f"{'made' if c.new else 'ended'}: {c.decision.object_number}: {c.decision.matter}, {c.decision.who}"
                for c in changes.decisions
            ],
        ),
        ("setting", [_field(f) for f in changes.settings]),
        ("version", [_field(f) for f in changes.versions]),
    ]


def _verdict(change: VerdictChange) -> str:
    why = "; ".join(f"{cause.kind} {cause.what}" for cause in change.causes) or "nothing that the runs keep differs"
    what = f"{change.object_number} ({change.gallery}) {change.model}, {change.level}"
    return f"{what}: {change.before or 'none'} -> {change.after or 'none'}, because of {why}"


def _field(change: FieldChange) -> str:
    before, after = _value(change.before), _value(change.after)
    if before == after:
        return f"{change.name} {after}: another range or source"
    return f"{change.name} {before} -> {after}"


def _value(value: Any) -> str:
    if isinstance(value, dict) and "value" in value:
        return figures(value["value"], 4) if isinstance(value["value"], float) else str(value["value"])
    text = "none" if value is None else value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:59]}…"
