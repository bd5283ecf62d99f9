"""Collisions of neighbours in a gallery: both moving under one motion, not the sum of what each does."""

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from pipeline.analysis.furnished import furnished
from pipeline.analysis.furniture import filter_of
from pipeline.analysis.plan import corners, own_angle
from pipeline.analysis.response import trace
from pipeline.analysis.verdicts import LevelMotions, judge
from pipeline.models import model_named
from pipeline.quantities import Array, G
from pipeline.records import Estimate, Finding, Motion, Scene, Spacing, Support, Verdict

REST, PERIODS = 10.0, 4.0
"""Seconds after the record, and periods of a swing, that histories are followed; the last half tells the rest."""

KEPT = 256
"""Histories that are kept at once."""

MOVING = ("displacement",)
"""Outputs that say how far an object moves from where it stands."""


@dataclass(frozen=True)
class Place:
    """An object that may move, where it stands in its gallery, and how far it moves at most.

    Attributes
    ----------
    at : Array
        (2,) m, east and north.
    reach : float
        M, from its centre to the corner that is furthest out.
    sides : (float, float, float) or None
        Half width and half depth [m] with the azimuth of the width; None where the azimuth is not known.
    most : float
        M, how far it moves at most, its uncertain inputs considered.
    """

    index: int
    scene: Scene
    model: str
    at: Array
    reach: float
    sides: tuple[float, float, float] | None
    most: float

    def half(self, direction: Array) -> float:
        """Return how far its outline reaches along a direction (2,), m; unknown how it is turned: the furthest."""
        if self.sides is None:
            return self.reach
        width, depth, azimuth = self.sides
        along = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
        across = np.array([-along[1], along[0]])
        return float(width * abs(along @ direction) + depth * abs(across @ direction))


def neighbours(
    scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]], levels: Sequence[LevelMotions]
) -> list[Spacing]:
    """Judge the gaps between neighbours of a gallery whose places are known, under each level of shaking.

    Neighbours stand alike (both free, both on walls, both hung from above), in one case or both in none; each object is
    judged against the nearest one at least.  A gap that is as wide as both move at most together is decided by that
    bound; otherwise both are traced under the same motion and the largest closing along the line between their centres
    counts.  Outlines are compared along that line, so that a gap that stays open keeps them apart, as long as neither
    turns.  What rocks, falls or breaks is not judged here.  How far each moves is found as its furniture shakes it.  Of
    objects in furniture that shakes, those of one recorded case move under the same motion, whichever of its variants
    that is; of others only the bound decides, as two showcases need not move alike.
    findings : of each scene; what moves is known from them
    returns  : in the order of the scenes, the nearest pairs first
    cost     : grows with the number of near pairs, not with that of all
    """
    out = []
    for level in levels:
        groups: dict[tuple[str, Support, str], list[Place]] = {}
        for index, (scene, found) in enumerate(zip(scenes, findings, strict=True)):
            place = _place(index, scene, found, level.name)
            if place is not None:
                groups.setdefault((scene.item.gallery, scene.support, scene.item.case), []).append(place)
        for (gallery, _, _), members in groups.items():
            shaken = _Shaken(max([REST, *(PERIODS * period for period in map(_period, members))]))
            out += [_judge(gallery, first, second, level, shaken) for first, second in _near(members)]
    return out


def _place(index: int, scene: Scene, findings: Sequence[Finding], level: str) -> Place | None:
    item = scene.item
    if item.position_x_m is None or item.position_y_m is None or not item.on_display:
        return None
    moves = [f for f in findings if f.level == level and f.demand_name in MOVING and f.high is not None]
    if not moves:
        return None
    worst = max(moves, key=lambda f: f.high or 0.0)
    width, depth = item.width_m or item.base_width_m, item.depth_m or item.base_depth_m
    if width is None and depth is None:
        return None
    half_width, half_depth = 0.5 * (width or depth or 0.0), 0.5 * (depth or width or 0.0)
    sides = None if item.orientation_deg is None else (half_width, half_depth, item.orientation_deg)
    most = float(worst.high or 0.0)
    if scene.support is Support.ISOLATED:
        # What stands on an isolator may move on it besides.
        most = sum(f.high or 0.0 for f in moves)
    at = np.array([item.position_x_m, item.position_y_m])
    reach = float(np.hypot(half_width, half_depth))
    return Place(index, scene, worst.model, at, reach, sides, most)


def _period(place: Place) -> float:
    length = place.scene.parameters.get("length")
    return 0.0 if length is None else float(2.0 * np.pi * np.sqrt(length.high / G))


def _near(members: Sequence[Place]) -> list[tuple[Place, Place]]:
    """Return the pairs that might meet, and each object's nearest, each pair once, the earlier object first."""
    if len(members) < 2:
        return []
    from scipy.spatial import cKDTree

    points = np.array([place.at for place in members])
    radius = np.array([place.reach + place.most for place in members])
    tree = cKDTree(points)
    nearest = np.asarray(tree.query(points, k=2)[1])
    pairs = {(min(i, j), max(i, j)) for i, both in enumerate(nearest.tolist()) for j in both if j != i}
    finite = np.isfinite(radius)
    # A pair is found from its larger member, in whose reach the smaller ones are few.
    found = tree.query_ball_point(points, np.where(finite, 2.0 * radius, 0.0))
    for i, others in enumerate(found):
        for j in others:
            if i != j and radius[j] <= radius[i] and np.hypot(*(points[i] - points[j])) < radius[i] + radius[j]:
                pairs.add((min(i, j), max(i, j)))
    return [(members[i], members[j]) for i, j in sorted(pairs)]


def _judge(gallery: str, first: Place, second: Place, level: LevelMotions, shaken: "_Shaken") -> Spacing:
    apart = second.at - first.at
    distance = float(np.hypot(*apart))
    direction = apart / distance if distance > 0.0 else np.array([1.0, 0.0])
    gap = distance - first.half(direction) - second.half(direction)
    known = Spacing(
        gallery=gallery,
        level=level.name,
        first=first.scene.item.object_number,
        second=second.scene.item.object_number,
        gap=gap,
        needed=None,
        low=None,
        high=None,
        radial=None,
        together=first.most + second.most,
        verdict=Verdict.PASS,
        decided_by="bound",
    )
    if gap < 0.0:
        why = "their outlines overlap as they are recorded: mend their places, their sizes, or how they are turned"
        return replace(known, verdict=Verdict.UNDETERMINED, note=why)
    if gap >= known.together:
        return known
    loose = [place for place in (first, second) if not _traceable(place)]
    if loose:
        who = " and ".join(place.scene.item.object_number for place in loose)
        why = f"only the sum of both is known: where {who} moves is not (orientation_deg, or it stands on an isolator)"
        return replace(known, verdict=Verdict.UNDETERMINED, note=why)
    furniture, other = filter_of(first.scene), filter_of(second.scene)
    if furniture != other or (furniture is not None and not first.scene.item.case.strip()):
        why = "only the sum of both is known: they may stand in two showcases, which need not move alike"
        return replace(known, verdict=Verdict.UNDETERMINED, note=why)
    level = furnished(level, furniture)
    each = {motion.hash: _closing(first, second, direction, motion, level.x_azimuth, shaken) for motion in level.every}
    combined = [[level.combined([each[m.hash][i] for m in some]) for i in range(4)] for some in level.variants]
    best, radial = combined[0][0], combined[0][3]
    low, high = min(one[1] for one in combined), max(one[2] for one in combined)
    judged = judge(best, low, high, Estimate.measured(gap, "m"))
    governing = level.told[int(np.argmax([each[motion.hash][0] for motion in level.motions]))]
    return replace(
        known,
        needed=best,
        low=low,
        high=high,
        radial=radial,
        verdict=judged.verdict,
        decided_by="history",
        motion=governing.name,
    )


def _traceable(place: Place) -> bool:
    # A one-directional history needs its direction, and an isolator passes another motion on.
    if place.scene.support is Support.ISOLATED:
        return False
    model = model_named(place.model)
    return model.trace is not None and (model.directions != 1 or place.scene.item.orientation_deg is not None)


def _closing(
    first: Place, second: Place, direction: Array, motion: Motion, x_azimuth: float, shaken: "_Shaken"
) -> tuple[float, float, float, float]:
    """Return by how much two objects close their gap at most: best, low, high; and their largest radial distance, m.

    The largest over the samples: between two of them it may be larger by an eighth of a dt2, 0.1 mm at 1 g and 0.01 s.
    """
    closings = []
    radial = 0.0
    for at, (one, other) in enumerate(product(_variants(first), _variants(second))):
        if one == other and _angle(first, x_azimuth) == _angle(second, x_azimuth):
            # Equal objects move as one, for ever.
            closings.append(0.0)
            continue
        mine, theirs = (
            shaken.history(variant, motion, _angle(place, x_azimuth), x_azimuth)
            for place, variant in ((first, one), (second, other))
        )
        relative = mine.path - theirs.path
        along = direction @ relative
        # After the record nothing keeps them in step: each may be anywhere in what it still swings through.
        after = mine.furthest(direction) + theirs.furthest(-direction)
        closings.append(max(0.0, float(along.max()), after))
        if at == 0:
            radial = float(np.hypot(*relative).max())
    return closings[0], min(closings), max(closings), radial


Variant = tuple[str, tuple[tuple[str, float], ...]]
"""A model with one set of its parameters."""


def _variants(place: Place) -> list[Variant]:
    """Return the parameter sets of an object: the best estimates, then all corners of what is uncertain."""
    known = place.scene.parameters
    names = [q.name for q in model_named(place.model).needs if q.name in known]
    best, low, high = (np.array([[getattr(known[n], end) for n in names]]) for end in ("value", "low", "high"))
    sets, _ = corners(best, low, high, low < high)
    return [(place.model, tuple(zip(names, one, strict=True))) for one in sets.tolist()]


def _angle(place: Place, x_azimuth: float) -> float | None:
    angle = own_angle(model_named(place.model), place.scene, x_azimuth)
    return None if np.isnan(angle) else angle


@dataclass(frozen=True)
class _History:
    """Where an object is, (2, n) m east and north of where it stood; and its last part, when nothing shakes any more.

    turning : whether what it swings through may turn
    """

    path: Array
    last: Array
    turning: bool

    def furthest(self, direction: Array) -> float:
        """Return how far it may still come along a direction after its record, m."""
        if self.turning:
            return float(np.hypot(*self.last).max())
        return float((direction @ self.last).max())


class _Shaken:
    """Histories of objects under padded motions, each computed once while it is wanted."""

    def __init__(self, rest: float) -> None:
        self._rest = rest
        self._padded: dict[str, Motion] = {}
        self._kept: OrderedDict[tuple[Variant, str, float | None, float], _History] = OrderedDict()

    def history(self, variant: Variant, motion: Motion, angle: float | None, x_azimuth: float) -> _History:
        """Return the history of an object, in the directions of the gallery's places."""
        key = (variant, motion.hash, angle, x_azimuth)
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        padded = self._padded.get(motion.hash)
        if padded is None:
            after = int(np.ceil(self._rest / motion.dt))
            still = np.pad(motion.acceleration, ((0, 0), (0, after)))
            padded = self._padded.setdefault(motion.hash, motion.changed(still, f"followed for {self._rest:g} s more"))
        model, parameters = variant
        columns = trace(model, padded, angle=0.0 if angle is None else angle, **dict(parameters))
        u_x = columns["u_x"].to_numpy()
        if "u_y" in columns:
            u_y = columns["u_y"].to_numpy()
        else:
            turn = np.radians(angle or 0.0)
            u_x, u_y = np.cos(turn) * u_x, np.sin(turn) * u_x
        azimuth = np.radians(x_azimuth)
        # x points to its azimuth, clockwise from north, and y is a quarter turn further to the left.
        path = np.stack([np.sin(azimuth) * u_x - np.cos(azimuth) * u_y, np.cos(azimuth) * u_x + np.sin(azimuth) * u_y])
        made = _History(path, path[:, -(padded.samples - motion.samples) // 2 :], model_named(model).turns)
        self._kept[key] = made
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        return made
