"""Keep clear: the room that an object needs to slide or to swing in."""

from collections.abc import Mapping, Sequence

from pipeline.analysis.verdicts import judge
from pipeline.mitigate.measures.base import CLEARANCE, MARGIN, Measure, cleared, round_up
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, known_to_swing, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models import settled_by_room
from pipeline.models.common import N_
from pipeline.records import Check, Furniture, Scene, Support, Verdict
from pipeline.records import phrases as say

STEPS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6)
"""Rooms that are tried, over what it needs by the best estimates: each 1.4 times the one before."""


LIGHT, HALL = 50.0, 2.0
"""Mass of what hangs from above [kg] up to which it may swing, and how much farther than along a wall: judgement."""

LIGHTING = "chandelier"
"""Class of what may swing whatever it weighs.

ASCE 7-16, sec. 13.6.1, asks for no bracing of light fixtures that hang, where nothing is in their way to any side and
what they hang by bears 1.4 times their weight down and sideways together.
"""

HAND = 0.10
"""Room that is spared around anything [m]; more only around what is itself as wide: judgement."""

TWICE = (
    "Its hook, its chain or cable and their anchor in the ceiling or frame must be rated for at least twice its weight."
)
FOURFOLD = (
    "It hangs short, and is tugged when it swings: its hook, its chain or cable and their anchor in the ceiling or "
    "frame must be rated for at least four times its weight."
)
TWICE_IN_CASE = (
    "Its hook, its wire or cord and what holds them in the case must be rated for at least twice its weight."
)
FOURFOLD_IN_CASE = (
    "It hangs short, and is tugged when it swings: its hook, its wire or cord and what holds them in the case must be "
    "rated for at least four times its weight."
)
"""One of them follows the sentence of a measure that lets what hangs from above swing.

By integrations under the eleven motions of the demonstration: 1.2 to 1.3 times its weight on the mean and 1.7 at most,
with a pendulum of SHORT and more; 3.4 at most with one of 0.3 m.  Rated is what a load may be day by day.
"""

SHORT = 0.5
"""Length from hook to centre of gravity [m] below which what swings is tugged."""


def hung_by(scene: Scene) -> str:
    """Return what is said of what an object hangs by that is let swing from above, behind a space; "" of others."""
    if scene.support is not Support.SUSPENDED:
        return ""
    length = scene.parameters.get("length")
    twice, fourfold = (TWICE_IN_CASE, FOURFOLD_IN_CASE) if scene.furniture is Furniture.SHOWCASE else (TWICE, FOURFOLD)
    return f" {twice if length is not None and length.low >= SHORT else fourfold}"


class Clearance(Measure):
    """Give it the room that it needs.

    Room changes no demand.  Where harm has to be excluded, nothing is run again: the demands of its findings are held
    against the new room.  All others must pass as they stand: an object that may rock is not helped by room, even where
    only its sliding is known to need some.  Where harm has to become unlikely, the least room that does it is sought.

    References
    ----------
    Agbabian et al. (1991), sec. 2.2 (spacing from Figure 4).
    """

    name = "clearance"
    gives = ("clearance", "movement")
    limits = 2
    limit_unit = "m"
    parameters = (CLEARANCE,)
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return it with ``clearance`` [m] around it."""
        return cleared(scene, parameters)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a tenth more room than it needs: at the worst of what is uncertain, or as little as is enough."""
        if runner.aims:
            return self._likely_enough(one, runner)
        others = [f for f in one.findings if not settled_by_room(f.model) and f.verdict is not Verdict.PASS]
        if others:
            if any(f.verdict is Verdict.FAIL for f in others):
                return refused(N_("room does not help: it fails otherwise than by moving"))
            return refused(N_("room does not help: it may fail otherwise than by moving"))
        if not known_to_swing(one.scene):
            return refused(N_("room helps only what swings, and how it hangs is not recorded"))
        most = one.moves
        if most is None:
            return refused(N_("it does not move"))
        room = round_up(MARGIN * most)
        allowed = self.row.limit_high * _times(one.scene) if _hangs(one.scene) else self.row.limit
        if room > allowed:
            return refused(say.NEEDS_ROOM(room=room, allowed=allowed))
        numbers = {"clearance": (room, "m"), "movement": (most, "m")}
        capacity = self.in_place(one, numbers).parameters["clearance"]
        checks = []
        for f in one.findings:
            demand, used, limit = f.demand or 0.0, f.utilisation or 0.0, f.capacity or 0.0
            passes = f.verdict is Verdict.PASS
            if settled_by_room(f.model):
                judged = judge(demand, f.low or 0.0, f.high or 0.0, capacity)
                passes, used, limit = judged.verdict is Verdict.PASS, judged.utilisation, judged.capacity
            checks.append((f.level, Check(f.model, f.title, demand, f.unit, limit, used, passes, f.demand)))
        return Proposal((Candidate(numbers, checks=tuple(checks)),))

    def prepare(self, objects: Sequence[Deficiency], runner: TrialRunner) -> None:
        """Find out of all at once for which the most room is enough: of most it is not, and no less is tried."""
        if not runner.aims:
            return
        asked = [
            (one, rooms) for one, rooms in ((one, self._rooms(one)) for one in objects) if not isinstance(rooms, str)
        ]
        trials = [self._trial(one, rooms[-1]) for one, rooms in asked]
        left = runner.remaining(trials)
        runner.once(self.row.name, dict[int, float]).update(
            (one.index, max((each.expected for each in some.values()), default=1.0))
            for (one, _), some in zip(asked, left, strict=True)
            if not runner.reaches_aim([some])
        )

    def _likely_enough(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        rooms = self._rooms(one)
        if isinstance(rooms, str):
            return refused(rooms)
        remains = runner.once(self.row.name, dict[int, float]).get(one.index)
        if remains is not None:
            return refused(say.HARM_REMAINS_WITH_ROOM(room=rooms[-1], chance=remains))
        candidates = []
        for room in rooms:
            numbers = {"clearance": (room, "m"), "movement": (room / MARGIN, "m")}
            candidates.append(Candidate(numbers, (self._trial(one, room),)))
        return Proposal(tuple(candidates))

    def _trial(self, one: Deficiency, room: float) -> Trial:
        return Trial(self.change(one.scene, {"clearance": room}))

    def _rooms(self, one: Deficiency) -> tuple[float, ...] | str:
        """Return the rooms to try, rising [m]; in words why there are none."""
        if any(not settled_by_room(f.model) and not (f.utilisation or 0.0) <= 1.0 for f in one.findings):
            return N_("room does not help: it fails otherwise than by moving")
        moving = [f for f in one.findings if settled_by_room(f.model)]
        if not moving or not known_to_swing(one.scene):
            return N_("room helps only what moves, and what hangs only where it is recorded how")
        best = max(f.demand or 0.0 for f in moving)
        allowed = (
            self.row.limit_high * _times(one.scene) if _hangs(one.scene) else min(self.row.limit, _spared(one.scene))
        )
        rooms = tuple(dict.fromkeys(round_up(MARGIN * best * step) for step in STEPS))
        tried = tuple(room for room in rooms if 0.0 < room <= allowed)
        if tried:
            return tried
        return say.HAS_NO_ROOM(room=rooms[0], allowed=allowed)


def _hangs(scene: Scene) -> bool:
    """Whether an object hangs in a room: what hangs in a case has the room of a case."""
    return scene.support in (Support.HUNG, Support.SUSPENDED) and scene.furniture is not Furniture.SHOWCASE


def _times(scene: Scene) -> float:
    """Return how many times as much room is spared around what hangs from above and is light: it swings in a hall."""
    mass = scene.parameters.get("mass")
    light = scene.object_class == LIGHTING or (mass is not None and mass.value <= LIGHT)
    return HALL if scene.support is Support.SUSPENDED and light else 1.0


def _spared(scene: Scene) -> float:
    """Return how much room a display spares on each side of an object at most [m].

    On the floor as much as it is wide; in a case, on a shelf or a pedestal a hand's breadth to glass, neighbour or
    edge, or what is recorded.
    """
    if scene.furniture in (Furniture.SHOWCASE, Furniture.SHELF, Furniture.PEDESTAL):
        return max(HAND, scene.item.clearance_m or 0.0)
    sides = [side for side in (scene.item.width_m, scene.item.depth_m) if side]
    half = scene.parameters.get("half_width")
    return max(HAND, *sides, 2.0 * half.value if half is not None else 0.0)
