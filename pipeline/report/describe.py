"""One object in words and in the reader's units."""

from collections import Counter
from collections.abc import Sequence
from math import isfinite, isnan

from pipeline.records import (
    Assessment,
    Check,
    Estimate,
    Finding,
    Mark,
    MotionSummary,
    Origin,
    Recommendation,
    RunRecord,
)
from pipeline.report.decided import Decided
from pipeline.report.errors import ReportError
from pipeline.report.judging import fragility_views
from pipeline.report.ranking import finding_order, finding_state, state_of
from pipeline.report.svg import Spot
from pipeline.report.text import clean, digest, plain, short, words
from pipeline.report.units import Units, ratio
from pipeline.report.views import (
    Bar,
    CheckView,
    FigureView,
    FindingView,
    MeasureView,
    MotionLink,
    NumberView,
    ObjectView,
    State,
)

_ORIGIN_ORDER = {Origin.MEASURED: 0, Origin.DERIVED: 1, Origin.ASSUMED: 2}
_DECIDED = {
    "certificate": "a guaranteed bound, without integration",
    "chart": "the response chart of this motion",
    "history": "a time history of this object",
}


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
        return "not known"
    if isnan(utilisation):
        return "not a number"
    return ratio(utilisation) if isfinite(utilisation) else "∞"


def bar(utilisation: float | None) -> Bar | None:
    """Return the bar of a utilisation: its track spans 0 to 2, and the limit, 1, lies in the middle."""
    if utilisation is None or isnan(utilisation):
        return None
    return Bar(round(50.0 * min(max(utilisation, 0.0), 2.0), 1), utilisation > 2.0, utilisation > 1.0)


class Describer:
    """Turns assessments of one run into views."""

    def __init__(self, record: RunRecord, units: Units) -> None:
        self._record, self._units = record, units
        self.decided = Decided(record.decisions, units)
        self._motions = {m.hash: m for m in record.motions}
        self._links: dict[tuple[str, str], MotionLink] = {}
        # Two records of one number in one gallery would share an id; the later ones are told apart by their place.
        seen: Counter[tuple[bool, str, str]] = Counter()
        self._twins: dict[int, int] = {}
        for assessment in record.assessments:
            item = assessment.scene.item
            key = (item.on_display, item.gallery, item.object_number)
            self._twins[id(assessment)] = seen[key]
            seen[key] += 1

    def anchor(self, assessment: Assessment) -> str:
        """Return the id of the object on its page; it stays the same from run to run."""
        twin = self._twins[id(assessment)]
        return f"o{digest(assessment.scene.item.object_number, 10)}" + (f"-{twin + 1}" if twin else "")

    def object(self, assessment: Assessment, page: str) -> ObjectView:
        """Return everything that the report says about one object.

        raises : ReportError naming the object, for a bad sentence or a mark on a chart that the run does not hold
        """
        scene, item = assessment.scene, assessment.scene.item
        ordered = sorted(assessment.findings, key=finding_order)
        findings = tuple(self._finding(f) for f in ordered)
        state = state_of(assessment)
        named = [*scene.assumptions, *(text for f in assessment.findings for text in f.assumptions)]
        estimates = sorted(scene.parameters.items(), key=lambda pair: (_ORIGIN_ORDER[pair[1].origin], pair[0]))
        title = clean(item.title or item.object_name)
        return ObjectView(
            number=clean(item.object_number),
            title=title,
            short=short(title, 80),
            anchor=self.anchor(assessment),
            gallery=clean(item.gallery),
            page=page,
            state=state,
            value_class=clean(item.value_class),
            object_class=clean(scene.object_class),
            rule=clean(scene.rule),
            support=scene.support.value,
            place=clean(item.case),
            lead=findings[0] if findings else None,
            findings=findings,
            measures=tuple(self._measure(r) for r in assessment.recommendations),
            figures=self._figures(ordered, assessment.recommendations) if state is State.ACT else (),
            numbers=tuple(self._number(name, estimate) for name, estimate in estimates),
            assumptions=tuple(dict.fromkeys(clean(text) for text in named)),
            missing=tuple(words(clean(m)) for m in scene.missing),
            problems=tuple((words(clean(p.field)), clean(p.message), clean(p.remedy)) for p in item.problems),
            fragilities=fragility_views(assessment, drawn=state is State.ACT),
            skipped=tuple(f"{words(clean(model))}: {clean(why)}" for model, why in scene.skipped.items()),
            decisions=self.decided.of(assessment),
            settled=self.decided.covered(assessment),
        )

    def _finding(self, f: Finding) -> FindingView:
        values: dict[str, tuple[float | None, str]] = {
            "demand": (f.demand, f.unit),
            "capacity": (f.capacity, f.unit),
            "low": (f.low, f.unit),
            "high": (f.high, f.unit),
        }
        where = f"object {f.object_number}, finding {f.model}"
        utilisation = percent(f.utilisation)
        return FindingView(
            title=clean(f.title),
            level=clean(f.level),
            state=finding_state(f),
            outcome=clean(f.outcome),
            sentence=clean(self._units.fill(f.sentence, values, where)),
            numbers=self._sums(f, utilisation),
            utilisation=utilisation,
            bar=bar(f.utilisation),
            screen=clean(f.screen),
            note=clean(f.note),
            motion=self._motion(f.motion_hash, f.motion),
            assumptions=tuple(clean(text) for text in f.assumptions),
        )

    def _sums(self, f: Finding, utilisation: str) -> str:
        span = self._span(f.low, f.high, f.unit)
        error = "" if f.fidelity == "bound" else self._error(f)
        origin = f" ({f.capacity_origin.value})" if f.capacity_origin else ""
        demand = self._units.text(f.demand, f.unit)
        if f.fidelity == "bound" and f.error:
            demand = f"at most {demand}"
        return (
            f"Demand {demand}{f' ({span} with what is uncertain)' if span else ''}, "
            f"capacity {self._units.text(f.capacity, f.unit)}{origin}, utilisation {utilisation}. "
            f"Decided by {_DECIDED.get(f.decided_by) or clean(f.decided_by)}"
            f"{f', error {error}' if error else ''}."
        )

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
            return "less than 0.1 %"
        return self._units.text(f.error, f.unit)

    def _measure(self, r: Recommendation) -> MeasureView:
        where = f"object {r.object_number}, recommendation {r.measure}"
        for name in r.parameters:
            if name not in r.units:
                raise ReportError(f"{where}: parameter {name!r} has no unit; store its unit with it")
        values: dict[str, tuple[float | None, str]] = {k: (v, r.units[k]) for k, v in r.parameters.items()}
        return MeasureView(
            measure=clean(r.measure),
            title=clean(r.title),
            level=clean(r.level),
            sentence=clean(self._units.fill(r.sentence, values, where)),
            checks=tuple(self._check(c) for c in r.checks),
            rejected=tuple(clean(text) for text in r.rejected),
            source=clean(r.source),
        )

    def _check(self, c: Check) -> CheckView:
        return CheckView(
            clean(c.title),
            self._units.text(c.demand, c.unit),
            self._units.text(c.capacity, c.unit),
            percent(c.utilisation),
            c.passes,
            "" if c.before is None else self._units.text(c.before, c.unit),
        )

    def _number(self, name: str, e: Estimate) -> NumberView:
        span = self._span(e.low, e.high, e.unit)
        text = f"{words(clean(name))} {self._units.text(e.value, e.unit)}{f' ({span})' if span else ''}"
        return NumberView(text, e.origin.value, clean(e.note), clean(e.source))

    def _figures(
        self, findings: Sequence[Finding], recommendations: Sequence[Recommendation]
    ) -> tuple[FigureView, ...]:
        spots: dict[str, list[Spot]] = {}
        for finding in findings:
            if finding_state(finding) is not State.SAFE:
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
        label = plain(mark.label) or (f"{plain(number)} after the measure" if after else plain(number))
        spot = Spot(mark.x, mark.y, label, after)
        listed = spots.setdefault(mark.chart, [])
        if spot not in listed:
            listed.append(spot)
