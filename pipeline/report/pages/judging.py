"""Fragility curves and the spacing of neighbours in words, numbers and small pictures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from statistics import median

from markupsafe import Markup

from pipeline.analysis.fragility.published import Published, all_published, in_si
from pipeline.quantities import G
from pipeline.records import Assessment, Finding, Fragility, Harm, Spacing, Support, Verdict
from pipeline.records.fragility import ABOVE, BELOW, FLAT, HARM
from pipeline.records.result import BOUNDS
from pipeline.report.language import _, local, ngettext, said
from pipeline.report.pages.chances import state_word
from pipeline.report.plots.panel import Panel, Scale
from pipeline.report.plots.svg import path, picture, text, through, upright
from pipeline.report.text import clean, count
from pipeline.report.units import Units, percent, significant

_MOST = 2.0 * G
"""Right end of the picture's axis, m/s2."""

_PANEL = Panel(Scale(0.0, _MOST, 10, 200), Scale(0.0, 1.0, 58, 6))
_POINTS = 13

_TOLD = (0.25 * G, 0.5 * G, G)
"""Where the picture's text alternative tells the probability."""

_ENDS = ("chance", "low", "high")

MOVES = ("displacement",)
"""Outputs that tell how far an object moves from where it stands."""


@dataclass(frozen=True, slots=True)
class FragilityView:
    """One fragility curve: what fails and from when on, why it is not sharper, how often, beside what; its picture.

    Attributes
    ----------
    chance : str
        Of harm within 50 years, where joint samples tell it.
    numbers : str
        How well the curve fits these.
    """

    title: str
    sentence: str
    sources: str
    rate: str
    chance: str
    numbers: str
    beside: str
    picture: Markup


@dataclass(frozen=True, slots=True)
class SpacingView:
    """Two neighbours: object numbers, lengths in the reader's units, and how it was decided."""

    first: str
    second: str
    level: str
    gap: str
    needed: str
    together: str
    state: str
    decided: str
    note: str


@dataclass(frozen=True, slots=True)
class RoomView:
    """How much room one object needs around it: by how much it moves at most, with its range."""

    number: str
    level: str
    moves: str
    span: str
    capacity: str


@dataclass(frozen=True, slots=True)
class ShakingView:
    """From what shaking on the free objects of a gallery fail, beside what others published.

    Attributes
    ----------
    note : str
        Why nothing is said of how often that comes; "" where it is said of some.
    """

    sentence: str
    rows: tuple[tuple[str, str, str], ...]
    note: str


def fragility_views(assessment: Assessment, units: Units, *, drawn: bool) -> tuple[FragilityView, ...]:
    """Return the curves of an object, what fails first to begin with; only that one is drawn."""
    number = clean(assessment.scene.item.object_number)
    # States are told beside the curve of harm as a whole.
    told = [f for f in assessment.fragilities if f.state in ("", HARM)]
    # Of what is only bounded there is no curve.
    views = [_view(f, number if drawn and i == 0 and not f.bound else "", units) for i, f in enumerate(told)]
    if assessment.scene.floor:
        # What a floor passes on is scaled with it: its peak, and not that of the ground.
        of_floor = _("in g as felt on the floor %(floor)s") % {"floor": clean(assessment.scene.floor)}
        views = [replace(view, sentence=f"{view.sentence}; {of_floor}") for view in views]
    states = _state_chances(assessment)
    return tuple(replace(view, numbers=f"{view.numbers} {states}".strip()) for view in views)


def _state_chances(assessment: Assessment) -> str:
    """Say how likely an object is to come to each state within 50 years; "" where nobody knows."""
    told = [(f.state, f.chances) for f in assessment.fragilities if f.state and f.state != HARM]
    known = [
        _("%(state)s %(chance)s (%(low)s to %(high)s)")
        % ({"state": state_word(Harm(state), assessment.scene)} | dict(zip(_ENDS, map(_percent, chances), strict=True)))
        for state, chances in told
        if chances is not None
    ]
    within = _("Within 50 years:")
    return f"{within} {', '.join(known)}." if known else ""


def _view(f: Fragility, draw: str, units: Units) -> FragilityView:
    at = in_g(f.median)
    if f.bound:
        sentence = _bounds(sampled=bool(f.state))[f.bound] % {"at": at}
    else:
        phrase = (
            _("as likely as not it comes to harm at about %(at)s (%(low)s to %(high)s)")
            if f.state
            else _("fails from about %(at)s (%(low)s to %(high)s)")
        )
        sentence = phrase % {"at": at, "low": in_g(f.low), "high": in_g(f.high)}
    again = "; " + _("stronger shaking of the same kind may pass: the weakest that fails counts") if f.returns else ""
    beside = "" if f.published_median is None else in_g(f.published_median)
    return FragilityView(
        title_of(f),
        sentence + again,
        _sources(f),
        "" if f.state else _rate(f),
        _chance(f) if f.state else "",
        _goodness(f, units) if f.state else "",
        clean(beside),
        _picture(f, draw) if draw else Markup(""),
    )


def _sources(f: Fragility) -> str:
    if f.bound and f.samples:
        return ""
    motions = ngettext("%(count)s motion", "%(count)s motions", f.motions) % {"count": count(f.motions)}
    # That few motions cannot tell it is said once a gallery.
    record = _("stated") if f.stated else _("of %(motions)s") % {"motions": motions}
    return _("Dispersion %(whole)s: records %(record)s (%(how)s), measures %(inputs)s, model %(model)s.") % {
        "whole": local(f"{f.dispersion:.2f}"),
        "record": local(f"{f.record:.2f}"),
        "how": record,
        "inputs": local(f"{f.inputs:.2f}"),
        "model": local(f"{f.modelling:.2f}"),
    }


def _goodness(f: Fragility, units: Units) -> str:
    """Say how well the curve fits its samples, and what it is by peak velocity."""
    told = _("The curve of harm is by %(samples)s samples at %(stripes)s intensities.")
    said_so = told % {"samples": count(f.samples), "stripes": count(len(f.stripes))}
    if f.error is not None:
        told = _("By their number its median is known within %(error)s.")
        said_so += " " + told % {"error": percent(f.error)}
    if f.goodness is not None and f.deviance is not None:
        told = _("Deviance %(deviance)s with %(degrees)s degrees of freedom: by chance as large in %(share)s of cases.")
        share = percent(f.goodness)
        said_so += " " + told % {"deviance": local(f"{f.deviance:.1f}"), "degrees": count(f.degrees), "share": share}
    if f.median_pgv is not None:
        told = (
            _("By peak velocity, in which the motions differ less: %(at)s.")
            if f.measure == "pgv"
            else _("By peak velocity: %(at)s.")
        )
        said_so += " " + told % {"at": _speed(f.median_pgv, units)}
    return said_so


def _speed(value: float, units: Units) -> str:
    return f"{significant(value * units.factor('m/s'), 2)}\u202f{units.symbol('m/s')}"


def _bounds(*, sampled: bool) -> Mapping[str, str]:
    if sampled:
        return {
            ABOVE: _("up to %(at)s at least it stays unharmed oftener than not"),
            BELOW: _("already at %(at)s or less it comes to harm oftener than not"),
            FLAT: _("there is no one shaking from which on: up to %(at)s more shaking hardly makes it likelier"),
        }
    return {ABOVE: _("stands up to %(at)s at least"), BELOW: _("fails already at %(at)s or less")}


def title_of(f: Fragility) -> str:
    """Return what a curve is of, in words: a way to fail, or any harm."""
    return _("Harm") + ":" if f.state == HARM else said(clean(f.title))


def _chance(f: Fragility) -> str:
    """Say how likely harm is within 50 years; "" where nobody knows."""
    chances = f.chances
    if chances is None:
        return ""
    told = _("Within 50 years it comes to harm with a chance of %(chance)s (%(low)s to %(high)s).")
    chance, low, high = (_percent(one) for one in chances)
    note = f" {said(clean(f.note))}." if f.note else ""
    return told % {"chance": chance, "low": low, "high": high} + note[:2].upper() + note[2:]


def _percent(chance: float) -> str:
    """Write a chance in percent with two digits at most: more would be a boast."""
    if chance < 0.001:
        return _("less than 0.1 %")
    if chance > 0.99:
        return _("more than 99 %")
    return f"{significant(100.0 * chance, 1 if chance < 0.01 else 2)}\u00a0%"


def _rate(f: Fragility) -> str:
    if f.annual_rate is None or f.rate_low is None or f.rate_high is None:
        return ""
    return _("about once in %(years)s years (%(low)s to %(high)s)") % {
        "years": years(f.annual_rate),
        "low": years(f.rate_high),
        "high": years(f.rate_low),
    }


def in_g(acceleration: float) -> str:
    """Write an acceleration in g with two digits: more would be a boast."""
    return f"{significant(acceleration / G, 2)}\u202fg"


def _published(one: Published) -> str:
    median = in_g(in_si(one)) if one.unit == "g" else f"{significant(in_si(one), 2)}\u202fm/s"
    return _("%(median)s, dispersion %(beta)s") % {"median": median, "beta": significant(one.dispersion, 2)}


def years(rate: float) -> str:
    """Write 1 / rate with two digits; "∞" for never."""
    if not (rate > 0.0 and isfinite(rate)):
        return "∞"
    period = 1.0 / rate
    # In words of this size a digit more would be a boast.
    rounded = float(f"{period:.2g}")
    return count(int(rounded)) if rounded >= 100.0 else significant(period, 2)


def _picture(f: Fragility, number: str) -> Markup:
    """Return the probability of failing against the peak acceleration of the floor, 0 to 2 g."""
    # Closer together where curves are steep.
    steps = [_MOST * (i / (_POINTS - 1)) ** 2 for i in range(_POINTS)]
    points = [(round(x), round(y)) for x, y in (_PANEL.at(a, f.probability(a)) for a in steps)]
    # From where it is certain on it is one line.
    rising = next((i for i, (_x, y) in enumerate(points) if y == points[-1][1]), len(points) - 1) + 1
    drawn = [_PANEL.axes()]
    if f.published_median is not None:
        drawn.append(path("gd", upright(round(_PANEL.x.at(f.published_median)), _PANEL.y.end, _PANEL.y.start)))
    drawn.append(path("cu", through([*points[:rising], points[-1]] if rising < len(points) else points)))
    drawn.append(text("2 g", 216, 68, "ty"))
    at = [
        _("%(probability)s at %(acceleration)s") % {"probability": f"{f.probability(a):.0%}", "acceleration": in_g(a)}
        for a in _TOLD
    ]
    told = _("Probability of failure:") + " " + ", ".join(at) + "."
    return picture("chart curve", 220, 72, f"{clean(number)}: {title_of(f).rstrip(':')}", told, drawn)


def shaking_view(members: Sequence[Assessment]) -> ShakingView | None:
    """Return the median of the free objects' medians beside the published ones; None where there is none.

    Where half of them stand at all that was tried, the median is said to be at least that.
    """
    free = [a.fragilities[0] for a in members if a.scene.support is Support.FREESTANDING and a.fragilities]
    if not free:
        return None
    middle = median(inf if f.bound in (ABOVE, FLAT) else f.median for f in free)
    if isfinite(middle):
        phrase = ngettext(
            "The one object that stands free fails from about %(at)s of peak acceleration of its floor on.",
            "Half of the %(count)s objects that stand free fail below %(at)s of peak acceleration of their floor.",
            len(free),
        )
    else:
        # Each of these bounds is below its own median, and so is their median below that of the medians.
        middle = median(0.0 if f.bound in (BELOW, FLAT) else f.median for f in free)
        phrase = ngettext(
            "The one object that stands free stands at %(at)s of peak acceleration of its floor at least.",
            "Half of the %(count)s objects that stand free stand at %(at)s of peak acceleration of their floor "
            "at least.",
            len(free),
        )
    classes = {a.scene.object_class for a in members if a.scene.support is Support.FREESTANDING}
    # Of furniture only where there is some.
    told = [p for p in all_published() if not p.classes or classes & set(p.classes)]
    rows = tuple((said(p.what), _published(p), p.source) for p in told)
    note = "" if any(f.annual_rate is not None for f in free) else free[0].note
    return ShakingView(phrase % {"count": count(len(free)), "at": in_g(middle)}, rows, said(clean(note)))


def spacing_views(spacings: Sequence[Spacing], units: Units) -> tuple[SpacingView, ...]:
    """Return the neighbours of a gallery, those that may meet first, then the closest."""
    order = {Verdict.FAIL: 0, Verdict.UNDETERMINED: 1, Verdict.PASS: 2}
    listed = sorted(spacings, key=lambda s: (order[s.verdict], s.gap - s.together, s.first, s.second, s.level))
    return tuple(_spacing(s, units) for s in listed)


def _spacing(s: Spacing, units: Units) -> SpacingView:
    needed = "–"
    if s.needed is not None and s.low is not None and s.high is not None:
        span = f" ({units.pair(s.low, s.high, 'm')})" if s.low < s.high else ""
        needed = units.text(s.needed, "m") + span
    decided = _("both moving together") if s.decided_by == "history" else _("bound: the sum of both")
    state = {Verdict.FAIL: "act", Verdict.UNDETERMINED: "open", Verdict.PASS: "safe"}[s.verdict]
    return SpacingView(
        clean(s.first),
        clean(s.second),
        clean(s.level),
        units.text(s.gap, "m"),
        needed,
        units.text(s.together, "m"),
        state,
        decided,
        clean(s.note),
    )


def room_views(members: Sequence[Assessment], units: Units) -> tuple[RoomView, ...]:
    """Return how far each object of a gallery moves, the furthest first: what to keep free of walls and edges."""
    moving = [f for a in members for f in a.findings if f.demand_name in MOVES and f.demand is not None and f.high]
    moving.sort(key=lambda f: (-(f.high or 0.0), f.object_number, f.level))
    return tuple(
        RoomView(
            clean(f.object_number),
            clean(f.level),
            most(f, units),
            spanned(f, units) or most(f, units),
            units.text(f.capacity, f.unit),
        )
        for f in moving
    )


def most(f: Finding, units: Units) -> str:
    """Write a demand, and that it is only known not to be more where that is so."""
    demand = units.text(f.demand, f.unit)
    return _("at most %(demand)s") % {"demand": demand} if f.fidelity == "bound" and f.error else demand


def spanned(f: Finding, units: Units) -> str:
    """Write the range of a demand; "" where it has none.  Of bounds only the upper one tells anything of it."""
    if f.low is None or f.high is None or f.low == f.high or (f.range_is == BOUNDS and f.high == f.demand):
        return ""
    if f.range_is == BOUNDS:
        return _("at most %(demand)s") % {"demand": units.text(f.high, f.unit)}
    return units.pair(f.low, f.high, f.unit)


def first_failure(assessment: Assessment) -> dict[str, str | float | None]:
    """Return the columns of an export that tell what fails first; empty where no curve was made.

    median_is : "" where the median is known, else "above" or "below": it is only known to be that, or "flat": what
                fails hardly grows with the shaking
    """
    first = next(iter(assessment.fragilities), None)
    rates = {f.state: f.annual_rate for f in assessment.fragilities}
    return {
        "median_g": None if first is None else first.median / G,
        "median_is": "" if first is None else first.bound,
        "dispersion": None if first is None else first.dispersion,
        "median_pgv_m_s": None if first is None else first.median_pgv,
        "goodness": None if first is None else first.goodness,
        "annual_rate": None if first is None else first.annual_rate,
        **_within_years(first),
        **{f"yearly_{state.value}": rates.get(state.value) for state in Harm},
    }


def _within_years(first: Fragility | None) -> dict[str, str | float | None]:
    chances = None if first is None else first.chances
    told = (None, None, None) if chances is None else chances
    return dict(zip(("chance_50_years", "chance_50_years_low", "chance_50_years_high"), told, strict=True))
