"""What people decided, in words and in the reader's units."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from pipeline.records import Assessment, Decision, DecisionKind, Standing, Verdict
from pipeline.report.language import _, said
from pipeline.report.text import clean, words
from pipeline.report.units import Units
from pipeline.report.views import DecisionsView, DecisionView, ObjectView

_KINDS = (DecisionKind.ACCEPT, DecisionKind.INSTALLED, DecisionKind.CLASS, DecisionKind.VERDICT)


def _title(kind: DecisionKind) -> str:
    told = {
        DecisionKind.ACCEPT: _("Risk accepted"),
        DecisionKind.INSTALLED: _("Installed"),
        DecisionKind.CLASS: _("Class decided"),
        DecisionKind.VERDICT: _("Verdict overruled"),
    }
    return told[kind]


class Decided:
    """The decisions of one run, by object."""

    def __init__(self, decisions: Iterable[Standing], units: Units) -> None:
        self._units = units
        self._of: dict[str, list[Standing]] = {}
        for standing in decisions:
            self._of.setdefault(standing.decision.object_number, []).append(standing)

    def of(self, assessment: Assessment) -> tuple[DecisionView, ...]:
        """Return the decisions about an object."""
        return tuple(self._view(s) for s in self._of.get(assessment.scene.item.object_number, ()))

    def covered(self, assessment: Assessment, level: str | None = None) -> bool:
        """Say whether all that does not pass (at a level) is accepted or overruled, and beyond doubt.

        level : None for all levels; without anything that does not pass there is nothing to cover
        """
        mine = self._of.get(assessment.scene.item.object_number, ())
        bad = [f for f in assessment.findings if f.verdict is not Verdict.PASS and level in (None, f.level)]
        return bool(bad) and all(any(s.covers(f.model, f.level) for s in mine) for f in bad)

    def strangers(self, assessments: Iterable[Assessment]) -> tuple[DecisionView, ...]:
        """Return the decisions about objects that the run does not have."""
        there = {a.scene.item.object_number for a in assessments}
        return tuple(self._view(s) for number, mine in self._of.items() if number not in there for s in mine)

    def _view(self, standing: Standing) -> DecisionView:
        decision = standing.decision
        return DecisionView(
            kind=decision.kind.value,
            number=clean(decision.object_number),
            title=_title(decision.kind),
            what=clean(self._what(decision)),
            who=clean(decision.who),
            date=clean(decision.date),
            why=clean(decision.why),
            until=clean(decision.until),
            doubts=tuple(said(clean(doubt)) for doubt in standing.doubts),
        )

    def _what(self, decision: Decision) -> str:
        if decision.kind is DecisionKind.INSTALLED:
            # "clearance 35 cm" and not "clearance, clearance 35 cm".
            values = {name: self._units.text(v, decision.units[name]) for name, v in decision.parameters.items()}
            own = values.pop(decision.measure, "")
            given = ", ".join(f"{words(name)} {text}" for name, text in values.items())
            parts = (f"{words(decision.measure)} {own}".strip(), given, decision.product)
        elif decision.kind is DecisionKind.CLASS:
            parts = (words(decision.object_class), "", "")
        else:
            told = {Verdict.PASS: _("passes"), Verdict.FAIL: _("fails")}
            verdict = told.get(decision.verdict, "") if decision.verdict else ""
            about = f"{words(decision.model)} {verdict}".strip()
            parts = (about, _("level %(level)s") % {"level": decision.level} if decision.level else "", "")
        return ", ".join(part for part in parts if part)


def decisions_view(objects: Sequence[ObjectView], strangers: Sequence[DecisionView] = ()) -> DecisionsView:
    """Gather the decisions about objects, in their order, under the headings of a page; those in doubt come first."""
    pairs = [(d, o) for o in objects for d in o.decisions]
    everything: list[tuple[DecisionView, ObjectView | None]] = [*pairs, *((d, None) for d in strangers)]
    counts: Mapping[str, int] = Counter(d.kind for d, _object in everything)
    doubted = tuple(pair for pair in everything if pair[0].doubts)
    groups = {kind.value: tuple(p for p in everything if p[0].kind == kind and not p[0].doubts) for kind in _KINDS}
    return DecisionsView(
        accepted=counts.get(DecisionKind.ACCEPT, 0),
        installed=counts.get(DecisionKind.INSTALLED, 0),
        classes=counts.get(DecisionKind.CLASS, 0),
        verdicts=counts.get(DecisionKind.VERDICT, 0),
        settled=sum(o.settled for o in objects),
        doubted=doubted,
        groups=tuple((kind, members) for kind, members in groups.items() if members),
    )
