"""A gallery seen from above, to scale: footprints where they stand, the space that each needs, and its verdict."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import cos, hypot, isfinite, radians, sin

from pipeline.quantities import LENGTHS
from pipeline.records import Assessment, Item
from pipeline.report.language import _, ngettext
from pipeline.report.pages.plan_views import PlaceView, PlanView
from pipeline.report.pages.views import STATES, ObjectView, State
from pipeline.report.plots.scales import nice_step
from pipeline.report.text import count, plain, short
from pipeline.report.units import Units

WIDTH = 1000.0
"""Pixels of the drawing's own system; its height follows the gallery."""

_MARGIN, _FOOT, _TALLEST = 26.0, 46.0, 1300.0
_POINT = 0.12
"""Half the side in m of the cross that stands for an object whose footprint is not recorded."""

PLAN_PATTERNS = (
    '<pattern id="po" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
    '<rect width="6" height="6" fill="#fff"/><path d="M0 0V6" stroke="#1c1b1a" stroke-width="2"/></pattern>'
    '<pattern id="pu" width="6" height="6" patternUnits="userSpaceOnUse">'
    '<rect width="6" height="6" fill="#fff"/><circle cx="3" cy="3" r="1.1" fill="#5c5853"/></pattern>'
)
"""Fills that a grey print tells apart: open is hatched, not assessed is dotted; acting is solid, safe is empty."""


@dataclass(frozen=True, slots=True)
class _Place:
    """Where one object stands: centre (m), half width and half depth (m, None: not recorded), needed room (m).

    turn : degrees with the clock from a width that points east
    """

    number: int
    view: ObjectView
    x: float
    y: float
    half: tuple[float, float] | None
    turn: float
    need: float

    @property
    def reach(self) -> float:
        """How far from its centre anything of it is drawn."""
        return hypot(*(self.half or (_POINT, _POINT))) + self.need


def plan_view(pairs: Sequence[tuple[Assessment, ObjectView]], units: Units) -> PlanView | None:
    """Return the plan of the objects whose positions are recorded; None where there is not one.

    pairs : the objects of a gallery, the most urgent first: their numbers on the plan count in this order
    """
    stand = [(a, view) for a, view in pairs if a.scene.item.on_display and _position(a.scene.item) is not None]
    if not stand:
        return None
    places = [_place(number, a, view) for number, (a, view) in enumerate(stand, start=1)]
    rows = tuple(_row(place, a, units) for place, (a, _view) in zip(places, stand, strict=True))
    return _draw(places, units, rows, len(pairs) - len(stand))


def needed_clearance(assessment: Assessment) -> float:
    """Return the free space in m that an object asks for: the farthest it gets by any model, as far as is known.

    What a recommended measure asks for takes its place where it says so: that is the room to keep after it.
    """
    advised = [
        r.parameters["clearance"]
        for r in assessment.recommendations
        if r.units.get("clearance") == "m" and isfinite(r.parameters.get("clearance", float("nan")))
    ]
    moved = [
        end
        for f in assessment.findings
        if f.unit == "m"
        for end in (f.demand, f.high)
        if end is not None and isfinite(end) and end > 0.0
    ]
    return max(advised or moved, default=0.0)


def _position(item: Item) -> tuple[float, float] | None:
    x, y = item.position_x_m, item.position_y_m
    return None if x is None or y is None or not (isfinite(x) and isfinite(y)) else (x, y)


def _footprint(item: Item) -> tuple[float, float] | None:
    width = item.base_width_m or item.width_m
    depth = item.base_depth_m or item.depth_m or width
    return (width, depth) if width and depth else None


def _place(number: int, assessment: Assessment, view: ObjectView) -> _Place:
    item = assessment.scene.item
    x, y = _position(item) or (0.0, 0.0)
    size = _footprint(item)
    half = None if size is None else (0.5 * size[0], 0.5 * size[1])
    # A width that points east lies across the drawing as it is.
    turn = 0.0 if item.orientation_deg is None else item.orientation_deg - 90.0
    return _Place(number, view, x, y, half, turn, needed_clearance(assessment))


def _row(place: _Place, assessment: Assessment, units: Units) -> PlaceView:
    size = _footprint(assessment.scene.item)
    across = _("%(x)s east, %(y)s north") % {"x": units.text(place.x, "m"), "y": units.text(place.y, "m")}
    return PlaceView(
        place.number,
        place.view,
        across,
        _("not recorded") if size is None else f"{units.number(size[0], 'm')} × {units.text(size[1], 'm')}",
        units.text(place.need, "m") if place.need else "–",
    )


def _draw(places: Sequence[_Place], units: Units, rows: tuple[PlaceView, ...], missing: int) -> PlanView:
    west, east = min(p.x - p.reach for p in places), max(p.x + p.reach for p in places)
    south, north = min(p.y - p.reach for p in places), max(p.y + p.reach for p in places)
    across, up = max(east - west, 1.0), max(north - south, 1.0)
    scale = min((WIDTH - 2 * _MARGIN) / across, (_TALLEST - _MARGIN - _FOOT) / up)
    height = up * scale + _MARGIN + _FOOT
    left = 0.5 * (WIDTH - across * scale)

    def at(x: float, y: float) -> tuple[float, float]:
        return left + (x - west) * scale, _MARGIN + (north - y) * scale

    rings = "".join(_ring(p, *at(p.x, p.y), scale) for p in places if p.need)
    # The least urgent are drawn first, so that what must be acted on is never hidden.
    shapes = "".join(_shape(p, *at(p.x, p.y), scale) for p in reversed(places))
    tally = {state: sum(p.view.state is state for p in places) for state in STATES}
    phrase = ngettext(
        "%(count)s object at its recorded position, north up; the plan shows %(width)s by %(depth)s.",
        "%(count)s objects at their recorded positions, north up; the plan shows %(width)s by %(depth)s.",
        len(places),
    )
    size = {"count": count(len(places)), "width": units.text(across, "m"), "depth": units.text(up, "m")}
    states = _("%(act)s to act on, %(open)s open, %(unknown)s cannot be assessed, %(safe)s safe.")
    verdicts = states % {state.value: count(number) for state, number in tally.items()}
    told = " ".join((phrase % size, verdicts, _("The table below says the same.")))
    heading = escape(_("Plan of the gallery, to scale"))
    ground = (
        f'<svg class="plan" viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="group" aria-labelledby="plant pland">'
        f'<title id="plant">{heading}</title><desc id="pland">{escape(told)}</desc>'
        f"<defs>{PLAN_PATTERNS}</defs>{rings}"
    )
    twice = Counter(p.view.number for p in places)
    centres = {p.view.number: at(p.x, p.y) for p in places if twice[p.view.number] == 1}
    objects = f"{shapes}{_bar(scale, height, units)}{_north(height)}</svg>"
    return PlanView(ground, objects, rows, missing, centres)


def _ring(place: _Place, x: float, y: float, scale: float) -> str:
    # The exact set of points within the needed room of a rectangle is that rectangle with round corners.
    half = place.half or (0.0, 0.0)
    need = place.need * scale
    w, h = half[0] * scale + need, half[1] * scale + need
    return (
        f'<rect class="rg"{_turned(place, x, y)} x="{x - w:.1f}" y="{y - h:.1f}" width="{2 * w:.1f}" '
        f'height="{2 * h:.1f}" rx="{need:.1f}"/>'
    )


def _turned(place: _Place, x: float, y: float) -> str:
    # With the clock, as SVG turns and as azimuths count.
    return f' transform="rotate({place.turn:.6g} {x:.1f} {y:.1f})"' if place.turn and place.half else ""


def _shape(place: _Place, x: float, y: float, scale: float) -> str:
    kind = {State.ACT: "pa", State.OPEN: "po", State.UNKNOWN: "pu", State.SAFE: "ps"}[place.view.state]
    if place.half is None:
        r = _POINT * scale
        box = f'<path class="{kind} pc" d="M{x - r:.1f} {y:.1f}H{x + r:.1f}M{x:.1f} {y - r:.1f}V{y + r:.1f}"/>'
    else:
        w, h = (max(half * scale, 1.5) for half in place.half)
        box = (
            f'<rect class="{kind}"{_turned(place, x, y)} x="{x - w:.1f}" y="{y - h:.1f}" '
            f'width="{2 * w:.1f}" height="{2 * h:.1f}"/>'
        )
    name = plain(short(f"{place.number}: {place.view.number} {place.view.short}", 70))
    # The number stands beside the footprint, where its own size does not depend on the object's.
    turn = radians(place.turn)
    half = place.half or (_POINT, _POINT)
    beside = x + (abs(half[0] * cos(turn)) + abs(half[1] * sin(turn))) * scale + 3
    return (
        f'<a href="#{place.view.anchor}" aria-label="{escape(name)}">{box}'
        f'<text class="pn" x="{beside:.1f}" y="{y + 4:.1f}">{place.number}</text></a>'
    )


def _bar(scale: float, height: float, units: Units) -> str:
    feet = units.length in ("in", "ft")
    unit, metres = (_("ft"), LENGTHS["ft"]) if feet else (_("m"), 1.0)
    # About a fifth of the drawing, a round number of metres or feet.
    length = nice_step(0.14 * WIDTH / (scale * metres))
    pixels, y = length * metres * scale, height - 18
    end, middle = _MARGIN + pixels, _MARGIN + 0.5 * pixels
    ticks = f"M{_MARGIN} {y - 5:.1f}V{y:.1f}H{end:.1f}V{y - 5:.1f}M{middle:.1f} {y - 3:.1f}V{y:.1f}"
    return (
        f'<path class="pb" d="{ticks}"/>'
        f'<text class="pl" x="{_MARGIN + pixels + 6:.1f}" y="{y + 2:.1f}">{length:g} {escape(unit)}</text>'
    )


def _north(height: float) -> str:
    x, y, told = WIDTH - _MARGIN, height - 14, escape(_("North"))
    return (
        f'<path class="pz" d="M{x:.0f} {y - 26:.0f}L{x + 7:.0f} {y:.0f}L{x:.0f} {y - 6:.0f}L{x - 7:.0f} {y:.0f}Z"/>'
        f'<text class="pl e" x="{x - 12:.0f}" y="{y:.0f}">{told}</text>'
    )
