"""One object in words and in the reader's units."""

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import isfinite, isnan
from typing import Any

from pipeline.analysis.stakes import worth_of
from pipeline.analysis.told import unseen_holds
from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.records import (
    Assessment,
    Check,
    Estimate,
    Finding,
    Mark,
    MeasurementRequest,
    MotionSummary,
    Origin,
    Recommendation,
    RunRecord,
    Urgency,
    Verdict,
)
from pipeline.records.result import BOUNDS
from pipeline.report.assumed import assumed, happening, rejected, rule_words, sourced, together
from pipeline.report.errors import ReportError
from pipeline.report.language import _, said
from pipeline.report.pages.chances import chance_view, left_over, open_for, worth_words
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.judging import fragility_views, most, spanned
from pipeline.report.pages.notes import Memory, finding_key
from pipeline.report.pages.plainly import brief_measure, cautions, dangers, full_measure, plain_measure
from pipeline.report.pages.scene_words import furniture, held, left_out, taken_words, what_it_is
from pipeline.report.pages.survey_words import missing_words, wish_views
from pipeline.report.pages.tallies import finding_order, finding_state, grave, state_of, urgency
from pipeline.report.pages.views import (
    Bar,
    CheckView,
    FigureView,
    FindingView,
    Judged,
    MeasureView,
    MotionLink,
    NumberView,
    ObjectView,
    State,
)
from pipeline.report.plots.chart import Spot
from pipeline.report.text import clean, digest, plain, short, words
from pipeline.report.units import Units, by_hand, ratio
from pipeline.tables.body_rows import body_told

_PLACEHOLDER = re.compile(r"{(\w+)}")
_RANGE = re.compile(r" \([^()]*{(?:low|high)}[^()]*\)")
"""Brackets of a sentence that tell the range of a demand."""

_ORIGIN_ORDER = {Origin.MEASURED: 0, Origin.DERIVED: 1, Origin.STATED: 2, Origin.ASSUMED: 3}


@lru_cache(maxsize=1024)
def _asked(sentence: str) -> frozenset[str]:
    return frozenset(_PLACEHOLDER.findall(sentence))


def motion_anchor(motion_hash: str) -> str:
    """Return the id of a motion's section on the motion page."""
    return f"m{digest(motion_hash, 10)}"


def approval(motion: MotionSummary) -> str:
    """Return who answers for a motion and since when, or "" where nobody does."""
    if not motion.approved_by:
        return ""
    return clean(f"{motion.approved_by}, {motion.approved_on}" if motion.approved_on else motion.approved_by)


def percent(utilisation: float | None) -> str:
    """Write demand / capacity for the reader, "∞" where the capacity is zero or nothing stops the object."""
    if utilisation is None:
        return _("not known")
    if isnan(utilisation):
        return _("not a number")
    return ratio(utilisation) if isfinite(utilisation) else "∞"


def decided(by: str) -> str:
    """Say in words what settled a verdict."""
    told = {
        "certificate": _("a guaranteed bound"),
        "chart": _("the response chart"),
        "history": _("a time history"),
    }
    return told.get(by) or clean(by)


def origin(of: Origin) -> str:
    """Say in words where a number comes from."""
    told = {
        Origin.MEASURED: _("measured"),
        Origin.DERIVED: _("derived"),
        Origin.STATED: _("stated by a house rule"),
        Origin.ASSUMED: _("assumed"),
    }
    return told[of]


def bar(utilisation: float | None) -> Bar | None:
    """Return the bar of a utilisation: its track spans 0 to 2, and the limit, 1, lies in the middle."""
    if utilisation is None or isnan(utilisation):
        return None
    return Bar(round(50.0 * min(max(utilisation, 0.0), 2.0)), utilisation > 2.0, utilisation > 1.0)


def _together(views: Sequence[MeasureView]) -> MeasureView:
    """Return one measure for several levels: its checks name theirs."""
    if len(views) == 1:
        return views[0]

    def named(view: MeasureView, checks: Sequence[CheckView]) -> list[CheckView]:
        return [replace(check, title=f"{check.title} ({view.level})") for check in checks]

    return replace(
        views[0],
        level=", ".join(view.level for view in views),
        checks=tuple(check for view in views for check in named(view, view.checks)),
        ended=tuple(check for view in views for check in named(view, view.ended)),
    )


class Sayings:
    """Findings and numbers in words, each once for all objects of a run that share it.

    Parameters
    ----------
    motions : iterable of MotionSummary
        Of the run.
    """

    def __init__(self, motions: Iterable[MotionSummary], units: Units) -> None:
        self._motions, self._units = {m.hash: m for m in motions}, units
        self._links: dict[tuple[str, str], MotionLink] = {}
        self._findings: Memory[FindingView] = Memory()
        self._numbers: Memory[NumberView] = Memory()
        self._origins: Memory[str] = Memory()
        self._assumed: Memory[str] = Memory()
        self._rejected: Memory[str] = Memory()
        self._told: Memory[str] = Memory()

    def finding(self, f: Finding) -> FindingView:
        """Return a finding in words.

        Raises
        ------
        ReportError
            Naming the object, for a bad sentence.
        """
        return self._findings.had(finding_key(f), lambda: self._finding(f))

    def number(self, name: str, estimate: Estimate) -> NumberView:
        """Return a number that a model was run with in words."""
        return self._numbers.had((name, estimate), lambda: self._number(name, estimate))

    def told(self, say: Callable[[Any], str], about: Any, *alike: Hashable) -> str:
        """Return what a function says about something, once for all objects that have it alike.

        Parameters
        ----------
        alike : Hashable
            What it looks at, where that is not the whole.

        Returns
        -------
        str
        """
        return self._told.had((say, *(alike or (about,))), lambda: say(about))

    def origin(self, of: Origin) -> str:
        """Say in words where a number comes from."""
        return self._origins.had(of, lambda: origin(of))

    def _finding(self, f: Finding) -> FindingView:
        values: dict[str, tuple[float | None, str]] = {
            "demand": (f.demand, f.unit),
            "capacity": (f.capacity, f.unit),
            "low": (f.low, f.unit),
            "high": (f.high, f.unit),
        }
        where, utilisation = f"object {f.object_number}, finding {f.model}", percent(f.utilisation)
        return FindingView(
            title=said(clean(f.title)),
            level=clean(f.level),
            state=finding_state(f),
            outcome=said(clean(f.outcome)),
            sentence=clean(self._units.fill(self._certain(f, self.told(self._happening, f.sentence)), values, where)),
            numbers=self._sums(f, utilisation),
            utilisation=utilisation,
            bar=bar(f.utilisation),
            screen=happening(clean(f.screen), self._units),
            note=said(clean(f.note)),
            motion=self._motion(f.motion_hash, f.motion),
            assumptions=tuple(self.assumed(text) for text in f.assumptions),
            size="" if f.utilisation is None or isnan(f.utilisation) else f"{min(f.utilisation, 1e9):.3g}",
        )

    def _sums(self, f: Finding, utilisation: str) -> str:
        span = spanned(f, self._units)
        error = "" if f.fidelity == "bound" else self._error(f)
        by = {"means": decided(f.decided_by), "error": error}
        means = (_("Decided by %(means)s, error %(error)s.") if error else _("Decided by %(means)s.")) % by
        capacity = self._units.text(f.capacity, f.unit)
        of = self.origin(f.capacity_origin) if f.capacity_origin else ""
        # What the sentence has said is not said again.
        asked = _asked(f.sentence)
        ranged = not span or {"low", "high"} <= asked
        if "demand" in asked and ranged and f.demand == f.utilisation:
            # Of a share of what is allowed nothing is left to say.
            return means
        if "demand" not in asked or not ranged:
            demand = most(f, self._units)
            demand += " " + _("(%(range)s with what is uncertain)") % {"range": span} if span else ""
            phrase = _("Demand %(demand)s, capacity %(capacity)s, utilisation %(utilisation)s.")
        else:
            demand, phrase = "", _("Capacity %(capacity)s, utilisation %(utilisation)s.")
            capacity = of or capacity if "capacity" in asked else capacity
        capacity += f" ({of})" if of and capacity != of else ""
        return f"{phrase % {'demand': demand, 'capacity': capacity, 'utilisation': utilisation}} {means}"

    @staticmethod
    def _certain(f: Finding, sentence: str) -> str:
        """Return the sentence without its brackets about a range where nothing is uncertain."""
        low = f.demand if f.range_is == BOUNDS else f.low
        return _RANGE.sub("", sentence) if low == f.demand == f.high else sentence

    def _motion(self, motion_hash: str, name: str) -> MotionLink:
        key = (motion_hash, name)
        if key not in self._links:
            motion = self._motions.get(motion_hash)
            self._links[key] = MotionLink(
                name=clean(name),
                short=clean(motion_hash[:8]),
                anchor=motion_anchor(motion_hash) if motion else "",
                approved=approval(motion) if motion else "",
            )
        return self._links[key]

    def _span(self, low: float | None, high: float | None, unit: str) -> str:
        if low is None or high is None or low == high:
            return ""
        return self._units.pair(low, high, unit)

    def _error(self, f: Finding) -> str:
        if not f.error:
            return ""
        if f.demand and isfinite(f.demand) and f.error < 5e-4 * abs(f.demand):
            return _("less than 0.1 %")
        return self._units.text(f.error, f.unit)

    def _number(self, name: str, e: Estimate) -> NumberView:
        span = f" ({self._units.bare(e.low, e.high, e.unit)})" if self._span(e.low, e.high, e.unit) else ""
        text = f"{words(clean(name))} {self._units.text(e.value, e.unit)}{span}"
        # As among the assumptions of the object, where the same text is named once.
        return NumberView(text, self.origin(e.origin), self.assumed(e.note), self.told(sourced, clean(e.source)))

    def _happening(self, sentence: str) -> str:
        return happening(sentence, self._units)

    def rejected(self, text: str) -> str:
        """Say which measure was passed over and why, in the language and the lengths of the reader."""
        return self._rejected.had(text, lambda: rejected(clean(text), self._units))

    def assumed(self, text: str) -> str:
        """Say what was assumed, in the language and the lengths of the reader."""
        return self._assumed.had(text, lambda: assumed(clean(text), self._units))


class Describer:
    """Turns assessments of one run into views."""

    def __init__(self, record: RunRecord, units: Units, sayings: Sayings) -> None:
        self._record, self._units, self._sayings = record, units, sayings
        self.decided = Decided(record.decisions, units)
        self.surveyed = record.wishes is not None
        self.wishes: dict[str, list[MeasurementRequest]] = {}
        for request in record.wishes or ():
            self.wishes.setdefault(request.object_number, []).append(request)

    def anchor(self, assessment: Assessment) -> str:
        """Return the id of the object on its page; it stays the same from run to run."""
        return f"o{digest(assessment.scene.item.object_number, 10)}"

    def key(self, assessment: Assessment) -> Urgency | None:
        """Return what sorts an object among all of the museum; None for one that is not on display."""
        if not assessment.scene.item.on_display:
            return None
        return urgency(assessment, settled=self.decided.covered(assessment))

    def object(self, assessment: Assessment, page: str) -> ObjectView:
        """Return everything that the report says about one object.

        Raises
        ------
        ReportError
            Naming the object, for a bad sentence or a mark on a chart that the run does not hold.
        """
        scene, item = assessment.scene, assessment.scene.item
        ordered = sorted(assessment.findings, key=finding_order)
        findings = tuple(self._sayings.finding(f) for f in ordered)
        state, fails = state_of(assessment), any(f.verdict is Verdict.FAIL for f in assessment.findings)
        named = [*scene.assumptions, *(text for f in assessment.findings for text in f.assumptions)]
        estimates = sorted(scene.parameters.items(), key=lambda pair: (_ORIGIN_ORDER[pair[1].origin], pair[0]))
        title = clean(item.called)
        worth, chance, told = worth_of(scene), chance_view(assessment), self._sayings.told
        return ObjectView(
            number=clean(item.object_number),
            title=title,
            short=short(title, 80),
            anchor=self.anchor(assessment),
            gallery=clean(item.gallery),
            page=page,
            state=state,
            value_class=clean(item.value_class),
            worth=worth_words(scene, worth) if worth.terms else "",
            object_class=told(what_it_is, (clean(scene.object_class), body_told(one.note for _name, one in estimates))),
            taken=told(taken_words, scene, scene.object_class, scene.chances),
            rule=told(rule_words, clean(scene.rule)),
            support=told(held, scene, scene.support, scene.mount),
            place=clean(item.case),
            furniture=told(furniture, scene, scene.furniture, scene.stands_by, scene.anchorage),
            lead=findings[0] if findings else None,
            findings=findings,
            measures=self._measures(assessment),
            figures=self._figures(ordered, assessment.recommendations) if state is State.ACT and fails else (),
            numbers=tuple(self._sayings.number(name, estimate) for name, estimate in estimates),
            assumptions=tuple(dict.fromkeys(map(self._sayings.assumed, dict.fromkeys(named)))),
            statements=tuple(said(clean(text)) for text in scene.statements),
            missing=tuple(told(missing_words, clean(m)) for m in scene.missing),
            problems=tuple(
                (words(clean(p.field)), self._sayings.assumed(p.message), self._sayings.assumed(p.remedy))
                for p in item.problems
            ),
            wishes=wish_views(self.wishes.get(item.object_number, ()), self._units),
            grave=any(grave(f) for f in assessment.findings) if chance is None else chance.lost,
            chance=chance,
            open_for=open_for(assessment),
            fragilities=fragility_views(assessment, self._units, drawn=state is State.ACT and fails),
            skipped=tuple(told(left_out, one) for one in scene.skipped.items()),
            decisions=self.decided.of(assessment),
            settled=self.decided.covered(assessment),
            dangers=dangers(ordered),
            rests_on=tuple(map(self._sayings.assumed, unseen_holds(scene))),
        )

    def _measures(self, assessment: Assessment) -> tuple[MeasureView, ...]:
        """Return the measures; what is advised alike for several levels is one, with the evidence of each."""
        alike: dict[tuple[object, ...], list[MeasureView]] = {}
        for r in assessment.recommendations:
            key = (r.measure, r.sentence, tuple(sorted(r.parameters.items())))
            alike.setdefault(key, []).append(self._measure(r, assessment.findings))
        return tuple(_together(views) for views in alike.values())

    def _measure(self, r: Recommendation, findings: Sequence[Finding]) -> MeasureView:
        where = f"object {r.object_number}, recommendation {r.measure}"
        for name in r.parameters:
            if name not in r.units:
                raise ReportError(f"{where}: parameter {name!r} has no unit; store its unit with it")
        values: dict[str, tuple[float | None, str]] = {k: (v, r.units[k]) for k, v in r.parameters.items()}
        before = {f.model: f for f in findings if f.level == r.level}
        return MeasureView(
            measure=clean(r.measure),
            named=NAMED_FIRST in r.sentence,
            brief=brief_measure(r, self._units),
            cautions=tuple(cautions(r)),
            title=said(clean(r.title)),
            level=clean(r.level),
            plain=plain_measure(r, self._units) + left_over(r),
            sentence=clean(self._units.fill(full_measure(r), values, where, by_hand(self._units))) + left_over(r),
            checks=tuple(self._check(c, before.get(c.model)) for c in r.checks),
            ended=self._ended(r, before),
            rejected=tuple(together(map(self._sayings.rejected, r.rejected))),
            source=self._sayings.told(sourced, clean(r.source)),
        )

    def _ended(self, r: Recommendation, before: Mapping[str, Finding]) -> tuple[CheckView, ...]:
        """Return the failures that the measure takes away: every model that still applies was run again."""
        if not r.checks:
            return ()
        left = {c.model for c in r.checks}
        gone = [f for name, f in before.items() if name not in left and finding_state(f) is Judged.FAILS]
        return tuple(
            CheckView(
                title=said(clean(f.title)),
                before=self._units.text(f.demand, f.unit),
                demand="–",
                capacity=self._units.text(f.capacity, f.unit),
                utilisation_before=percent(f.utilisation),
                utilisation="–",
                bar_before=bar(f.utilisation),
                bar=None,
                passes=True,
            )
            for f in gone
        )

    def _check(self, c: Check, f: Finding | None) -> CheckView:
        # A model may measure another thing on the changed chain; then the two are not to be compared.
        f = f if f is not None and f.unit == c.unit else None
        return CheckView(
            title=said(clean(c.title)),
            before="" if c.before is None else self._units.text(c.before, c.unit),
            demand=self._units.text(c.demand, c.unit),
            capacity=self._units.text(c.capacity, c.unit),
            utilisation_before="" if f is None else percent(f.utilisation),
            utilisation=percent(c.utilisation),
            bar_before=None if f is None else bar(f.utilisation),
            bar=bar(c.utilisation),
            passes=c.passes,
        )

    def _figures(
        self, findings: Sequence[Finding], recommendations: Sequence[Recommendation]
    ) -> tuple[FigureView, ...]:
        spots: dict[str, list[Spot]] = {}
        for finding in findings:
            if finding_state(finding) is not Judged.PASSES:
                self._add(spots, finding.mark, finding.object_number, after=False)
        for recommendation in recommendations:
            self._add(spots, recommendation.mark, recommendation.object_number, after=True)
        return tuple(FigureView(chart, tuple(marks)) for chart, marks in spots.items())

    def _add(self, spots: dict[str, list[Spot]], mark: Mark | None, number: str, *, after: bool) -> None:
        if mark is None:
            return
        if mark.chart not in self._record.charts:
            raise ReportError(
                f"object {number}: it is marked on chart {mark.chart!r}, which the run does not hold; "
                "store the chart with the run"
            )
        subject = _("%(object)s after the measure") % {"object": plain(number)} if after else plain(number)
        label = said(plain(mark.label)) or subject
        spot = Spot(mark.x, mark.y, label, after)
        listed = spots.setdefault(mark.chart, [])
        if spot not in listed:
            listed.append(spot)
