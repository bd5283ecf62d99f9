"""Keep clear: the room that an object needs to slide or to swing in."""

from collections.abc import Mapping

from pipeline.analysis.verdicts import judge
from pipeline.mitigate.measures.base import CLEARANCE, MARGIN, Measure, cleared, round_up
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, known_to_swing, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models import settled_by_room
from pipeline.records import Check, Scene, Support, Verdict

STEPS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6)
"""Rooms that are tried, over what it needs by the best estimates: each 1.4 times the one before."""


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
            return self._likely_enough(one)
        others = [f for f in one.findings if not settled_by_room(f.model) and f.verdict is not Verdict.PASS]
        if others:
            may = "it fails" if any(f.verdict is Verdict.FAIL for f in others) else "it may fail"
            return refused(f"room does not help: {may} otherwise than by moving")
        if not known_to_swing(one.scene):
            return refused("room helps only what swings, and how it hangs is not recorded")
        most = one.moves
        if most is None:
            return refused("it does not move")
        room = round_up(MARGIN * most)
        hangs = one.scene.support in (Support.HUNG, Support.SUSPENDED)
        allowed = self.row.limit_high if hangs else self.row.limit
        if room > allowed:
            return refused(f"it would need {100 * room:.0f} cm of room, more than the {100 * allowed:.0f} cm allowed")
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

    def _likely_enough(self, one: Deficiency) -> Proposal:
        others = [f for f in one.findings if not settled_by_room(f.model) and not (f.utilisation or 0.0) <= 1.0]
        if others:
            return refused("room does not help: it fails otherwise than by moving")
        moving = [f for f in one.findings if settled_by_room(f.model)]
        if not moving or not known_to_swing(one.scene):
            return refused("room helps only what moves, and what hangs only where it is recorded how")
        best = max(f.demand or 0.0 for f in moving)
        hangs = one.scene.support in (Support.HUNG, Support.SUSPENDED)
        allowed = self.row.limit_high if hangs else self.row.limit
        rooms = dict.fromkeys(round_up(MARGIN * best * step) for step in STEPS)
        tried = [room for room in rooms if 0.0 < room <= allowed]
        if not tried:
            least = min(rooms)
            return refused(f"it would need {100 * least:.0f} cm of room, more than the {100 * allowed:.0f} cm allowed")
        candidates = []
        for room in tried:
            numbers = {"clearance": (room, "m"), "movement": (room / MARGIN, "m")}
            candidates.append(Candidate(numbers, (Trial(self.in_place(one, numbers)),)))
        return Proposal(tuple(candidates))
