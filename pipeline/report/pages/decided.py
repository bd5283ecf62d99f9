"""Decisions of people, in words and in the reader's units."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from pipeline.records import Assessment, Decision, DecisionKind, DecisionStatus, Verdict
from pipeline.report.language import _, said
from pipeline.report.pages.views import DecisionsView, DecisionView, Pointer
from pipeline.report.text import clean, words
from pipeline.report.units import Units

_KINDS = (DecisionKind.ACCEPT, DecisionKind.INSTALLED, DecisionKind.CLASS, DecisionKind.VERDICT)


def _title(kind: DecisionKind) -> str:
    told = {
        DecisionKind.ACCEPT: _("Risk accepted"),
        DecisionKind.INSTALLED: _("Installed"),
        DecisionKind.CLASS: _("Class decided"),
        DecisionKind.VERDICT: _("Verdict overruled"),
    }
    return told[kind]


def by_object(decisions: Iterable[DecisionStatus]) -> dict[str, list[DecisionStatus]]:
    """Return decisions by the number of the object that they are about."""
    found: dict[str, list[DecisionStatus]] = {}
    for standing in decisions:
        found.setdefault(standing.decision.object_number, []).append(standing)
    return found


class Decided:
    """The decisions of one run, by object."""

    def __init__(self, decisions: Iterable[DecisionStatus], units: Units) -> None:
        self._units = units
        self._of = by_object(decisions)

    def of(self, assessment: Assessment) -> tuple[DecisionView, ...]:
        """Return the decisions about an object."""
        return tuple(self._view(s) for s in self._of.get(assessment.scene.item.object_number, ()))

    def covered(self, assessment: Assessment, level: str | None = None) -> bool:
        """Say whether all that does not pass (at a level) is accepted or overruled, and beyond doubt.

        Parameters
        ----------
        level : str or None, optional
            None for all levels; without anything that does not pass there is nothing to cover.

        Returns
        -------
        bool
        """
        mine = self._of.get(assessment.scene.item.object_number, ())
        bad = [f for f in assessment.findings if f.verdict is not Verdict.PASS and level in (None, f.level)]
        return bool(bad) and all(any(s.covers(f.model, f.level) for s in mine) for f in bad)

    def newest(self, numbers: Iterable[str]) -> str:
        """Return the day on which the newest decision about some objects was written down; "" for none."""
        return max((s.decision.recorded[:10] for number in numbers for s in self._of.get(number, ())), default="")

    def all(self) -> tuple[DecisionView, ...]:
        """Return all decisions."""
        return tuple(self._view(s) for mine in self._of.values() for s in mine)

    def _view(self, standing: DecisionStatus) -> DecisionView:
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


def decisions_view(
    objects: Iterable[tuple[Sequence[DecisionView], bool, Pointer | None]],
) -> DecisionsView:
    """Gather the decisions about objects, in their order, under the headings of a page; those in doubt come first.

    Parameters
    ----------
    objects : Iterable[tuple[Sequence[DecisionView], bool, Pointer | None]]
        The decisions, whether they settle the object, and the object; None where the run does not have it.

    Returns
    -------
    DecisionsView
    """
    listed = list(objects)
    pairs = [(d, o) for decisions, _settled, o in listed for d in decisions]
    counts: Mapping[str, int] = Counter(d.kind for d, _object in pairs)
    return DecisionsView(
        accepted=counts.get(DecisionKind.ACCEPT, 0),
        installed=counts.get(DecisionKind.INSTALLED, 0),
        classes=counts.get(DecisionKind.CLASS, 0),
        verdicts=counts.get(DecisionKind.VERDICT, 0),
        settled=sum(settled for _decisions, settled, _object in listed),
        doubted=tuple(pair for pair in pairs if pair[0].doubts),
        groups=_grouped([pair for pair in pairs if not pair[0].doubts]),
    )


def merged(views: Sequence[DecisionsView]) -> DecisionsView:
    """Return the decisions of several pages together, in the order of the pages."""
    return DecisionsView(
        accepted=sum(v.accepted for v in views),
        installed=sum(v.installed for v in views),
        classes=sum(v.classes for v in views),
        verdicts=sum(v.verdicts for v in views),
        settled=sum(v.settled for v in views),
        doubted=tuple(pair for v in views for pair in v.doubted),
        groups=_grouped([pair for v in views for _kind, members in v.groups for pair in members]),
    )


_Pair = tuple[DecisionView, Pointer | None]


def _grouped(pairs: Sequence[_Pair]) -> tuple[tuple[str, tuple[_Pair, ...]], ...]:
    groups = {kind.value: tuple(pair for pair in pairs if pair[0].kind == kind) for kind in _KINDS}
    return tuple((kind, members) for kind, members in groups.items() if members)
