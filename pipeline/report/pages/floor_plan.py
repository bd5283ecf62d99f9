"""A gallery seen from above, to scale: footprints where they stand, the space that each needs, and its verdict."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, isfinite, radians, sin

from markupsafe import Markup

from pipeline.quantities import LENGTHS
from pipeline.records import Assessment, Item
from pipeline.report.language import _, ngettext
from pipeline.report.pages.judging import SpacingView
from pipeline.report.pages.views import STATES, Judged, ObjectView, State
from pipeline.report.plots import svg
from pipeline.report.plots.panel import Panel, Scale, nice_step
from pipeline.report.plots.svg import Element, Point
from pipeline.report.text import count, plain, short
from pipeline.report.units import Units, by_hand


@dataclass(frozen=True, slots=True)
class PlaceView:
    """A row of the plan's table: the number on the plan, the object, and where it stands, in the reader's units."""

    number: int
    object: ObjectView
    position: str
    footprint: str
    clearance: str


@dataclass(frozen=True, slots=True)
class GalleryPlanView:
    """A gallery to scale: the drawing, its legend in rows, and how many objects have no recorded position.

    Attributes
    ----------
    tight : tuple of SpacingView
        The neighbours between which a line is drawn, for they may meet: each pair once, as it is at its worst level.
    """

    svg: Markup
    places: tuple[PlaceView, ...]
    missing: int
    tight: tuple[SpacingView, ...]


WIDTH = 1000.0
"""Pixels of the drawing's own system; its height follows the gallery."""

_MARGIN, _FOOT, _TALLEST = 26.0, 46.0, 1300.0
_POINT = 0.12
"""Half the side in m of the cross that stands for an object whose footprint is not recorded."""

PLAN_PATTERNS = (
    svg.hatch("po", 6, "#fff", svg.stripe(6, "#1c1b1a", 2), turn=45),
    svg.hatch("pu", 6, "#fff", svg.element("circle", cx=3, cy=3, r=1.1, fill="#5c5853")),
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


def plan_view(
    pairs: Sequence[tuple[Assessment, ObjectView]], spacings: Sequence[SpacingView], units: Units
) -> GalleryPlanView | None:
    """Return the plan of the objects whose positions are recorded.

    Parameters
    ----------
    pairs : sequence of (Assessment, ObjectView)
        The objects of a gallery, the most urgent first: their numbers on the plan count in this order.
    spacings : sequence of SpacingView
        What is known of neighbours, the worst first.
    units : Units
        The reader's.

    Returns
    -------
    GalleryPlanView or None
        None where no position is recorded.
    """
    stand = [(a, view) for a, view in pairs if a.scene.item.on_display and _position(a.scene.item) is not None]
    if not stand:
        return None
    places = [_place(number, a, view) for number, (a, view) in enumerate(stand, start=1)]
    rows = tuple(_row(place, a, units) for place, (a, _view) in zip(places, stand, strict=True))
    standing = Counter(p.view.number for p in places)
    # Of a number that stands twice nobody knows which is meant.
    tight = tuple(s for s in _tight(spacings) if standing[s.first] == standing[s.second] == 1)
    return GalleryPlanView(_draw(places, tight, units), rows, len(pairs) - len(stand), tight)


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
    write = by_hand(units)
    across = _("%(x)s east, %(y)s north") % {"x": write("x", place.x, "m"), "y": write("y", place.y, "m")}
    return PlaceView(
        place.number,
        place.view,
        across,
        _("not recorded") if size is None else _across(*(write("size", one, "m") for one in size)),
        write("clearance", place.need, "m") if place.need else "–",
    )


def _across(first: str, second: str) -> str:
    """Return two lengths by each other, with one unit where it is a word behind both."""
    return f"{first.removesuffix(second.rsplit(maxsplit=1)[-1]).rstrip()} × {second}"


def _tight(spacings: Sequence[SpacingView]) -> list[SpacingView]:
    """Return the neighbours that may meet, each pair as it stands at its worst level, the worst first."""
    return list({(s.first, s.second): s for s in reversed(spacings) if s.state != Judged.PASSES}.values())[::-1]


def _draw(places: Sequence[_Place], tight: Sequence[SpacingView], units: Units) -> Markup:
    west, east = min(p.x - p.reach for p in places), max(p.x + p.reach for p in places)
    south, north = min(p.y - p.reach for p in places), max(p.y + p.reach for p in places)
    across, up = max(east - west, 1.0), max(north - south, 1.0)
    scale = min((WIDTH - 2 * _MARGIN) / across, (_TALLEST - _MARGIN - _FOOT) / up)
    height = up * scale + _MARGIN + _FOOT
    left = 0.5 * (WIDTH - across * scale)
    panel = Panel(
        Scale(west, west + across, left, left + across * scale), Scale(north - up, north, height - _FOOT, _MARGIN)
    )
    at = {p.number: panel.at(p.x, p.y) for p in places}
    centres = {p.view.number: at[p.number] for p in places}
    drawn = [
        svg.element("defs", *PLAN_PATTERNS),
        *(_ring(p, *at[p.number], scale) for p in places if p.need),
        *(_gap(s, (centres[s.first], centres[s.second])) for s in tight),
        # The least urgent are drawn first, so that what must be acted on is never hidden.
        *(_shape(p, *at[p.number], scale) for p in reversed(places)),
        *_bar(scale, height, units),
        *_north(height),
    ]
    told = _told(places, units.text(across, "m"), units.text(up, "m"))
    title = _("Plan of the gallery, to scale")
    return svg.picture("plan", WIDTH, round(height), title, told, drawn, "plan", role="group")


def _told(places: Sequence[_Place], across: str, up: str) -> str:
    tally = {state: sum(p.view.state is state for p in places) for state in STATES}
    phrase = ngettext(
        "%(count)s object at its recorded position, north up; the plan shows %(width)s by %(depth)s.",
        "%(count)s objects at their recorded positions, north up; the plan shows %(width)s by %(depth)s.",
        len(places),
    )
    size = {"count": count(len(places)), "width": across, "depth": up}
    states = _("%(act)s to act on, %(watch)s to watch, %(unknown)s cannot be assessed, %(fine)s fine.")
    verdicts = states % {state.value: count(number) for state, number in tally.items()}
    return " ".join((phrase % size, verdicts, _("The table below says the same.")))


def _ring(place: _Place, x: float, y: float, scale: float) -> Element:
    # The exact set of points within the needed room of a rectangle is that rectangle with round corners.
    need = place.need * scale
    w, h = (half * scale + need for half in place.half or (0.0, 0.0))
    return svg.rect("rg", x - w, y - h, 2 * w, 2 * h, turned=_turned(place, x, y), round_=need)


def _turned(place: _Place, x: float, y: float) -> str | None:
    # With the clock, as SVG turns and as azimuths count.
    return f"rotate({place.turn:.6g} {svg.number(x)} {svg.number(y)})" if place.turn and place.half else None


def _gap(spacing: SpacingView, ends: Sequence[Point]) -> Element:
    meet = (
        _("their gap is too small") if spacing.state == Judged.FAILS else _("whether their gap is wide enough is open")
    )
    told = f"{plain(spacing.first)}, {plain(spacing.second)}: {meet} ({spacing.gap})"
    return svg.path(f"gap {spacing.state}", svg.through(ends), svg.element("title", told), role="img")


def _shape(place: _Place, x: float, y: float, scale: float) -> Element:
    kind = {State.ACT: "pa", State.WATCH: "po", State.UNKNOWN: "pu", State.FINE: "ps"}[place.view.state]
    half = place.half or (_POINT, _POINT)
    if place.half is None:
        r = _POINT * scale
        box = svg.path(f"{kind} pc", svg.level(y, x - r, x + r) + svg.upright(x, y - r, y + r))
    else:
        w, h = (max(side * scale, 1.5) for side in half)
        box = svg.rect(kind, x - w, y - h, 2 * w, 2 * h, turned=_turned(place, x, y))
    name = plain(short(f"{place.number}: {place.view.number} {place.view.short}", 70))
    # The number stands beside the footprint, where its own size does not depend on the object's.
    turn = radians(place.turn)
    beside = x + (abs(half[0] * cos(turn)) + abs(half[1] * sin(turn))) * scale + 3
    words = svg.text(str(place.number), beside, y + 4, "pn")
    return svg.element("a", box, words, href=f"#{place.view.anchor}", aria_label=name)


def _bar(scale: float, height: float, units: Units) -> list[Element]:
    feet = units.length in ("in", "ft")
    unit, metres = (_("ft"), LENGTHS["ft"]) if feet else (_("m"), 1.0)
    # About a fifth of the drawing, a round number of metres or feet.
    length = nice_step(0.14 * WIDTH / (scale * metres))
    y, end = height - 18, _MARGIN + length * metres * scale
    ends = f"{svg.upright(_MARGIN, y - 5, y)}H{svg.number(end)}V{svg.number(y - 5)}"
    return [
        svg.path("pb", ends + svg.upright(0.5 * (_MARGIN + end), y - 3, y)),
        svg.text(f"{length:g} {unit}", end + 6, y + 2, "pl"),
    ]


def _north(height: float) -> list[Element]:
    x, y = round(WIDTH - _MARGIN), height - 14
    arrow = [(x, round(y - 26)), (x + 7, round(y)), (x, round(y - 6)), (x - 7, round(y))]
    return [svg.path("pz", svg.through(arrow) + "Z"), svg.text(_("North"), x - 12, round(y), "pl e")]
