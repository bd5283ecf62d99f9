"""Which objects need a measure, and at which levels of shaking: by verdicts, or by how likely harm is."""

from collections.abc import Container, Mapping, Sequence

from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.proposals import Case, Deficiency, case_of, known_to_swing
from pipeline.mitigate.trials import HarmAim
from pipeline.models import settled_by_room
from pipeline.models.unanchored import UNANCHORED
from pipeline.records import Finding, Likelihood, Scene, Verdict


def levels_asked(chances: Sequence[Likelihood], aim: HarmAim) -> frozenset[str]:
    """Return the levels at which harm is too likely, also if the object is of the class that it is taken for.

    Where only another class that is possible makes it so, no measure for this one helps: naming the object does.
    """
    too_likely = (one for one in chances if one.probability >= aim.target)
    return frozenset(one.level for one in too_likely if not one.classes or one.classes[0].at_least(aim.target))


def deficiencies(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    stands: Container[tuple[int, str]],
    likely: Sequence[frozenset[str]] | None,
) -> list[Deficiency]:
    """Return the objects with findings at these levels; for those that stand already nothing more is wanted."""
    names = [level.name for level in levels]
    out = []
    for index, (scene, found) in enumerate(zip(scenes, findings, strict=True)):
        here = tuple(f for f in found if f.level in names)
        if likely is not None:
            falls = {f.level for f in here if may_fall([f])}
            wanted = [name for name in names if name in likely[index] or name in falls]
        elif _wanted(scene, here):
            wanted = [name for name in names if _wanted(scene, [f for f in here if f.level == name])]
        else:
            wanted = []
        if here:
            out.append(Deficiency(index, scene, here, tuple(name for name in wanted if (index, name) not in stands)))
    return out


def _wanted(scene: Scene, findings: Sequence[Finding]) -> bool:
    # Where it is not known whether it swings at all, a look behind it settles more than room.
    room = known_to_swing(scene) and _for_room_alone(findings)
    # Furniture that is known not to be fastened and may fall is better fastened than measured.
    return room or may_fall(findings) or any(f.verdict is Verdict.FAIL for f in findings)


def may_fall(findings: Sequence[Finding]) -> bool:
    """Say whether what an object stands in is not fastened, and not known to stay upright."""
    return any(f.model == UNANCHORED.name and f.verdict is not Verdict.PASS for f in findings)


def _for_room_alone(findings: Sequence[Finding]) -> bool:
    still = [f for f in findings if f.verdict is Verdict.UNDETERMINED]
    return bool(still) and all(settled_by_room(f.model) for f in still)


def of_unassessed(scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]]) -> Mapping[Case, tuple[str, ...]]:
    """Return by case the numbers of what stands in it for which no model could be run."""
    out: dict[Case, tuple[str, ...]] = {}
    for scene, found in zip(scenes, findings, strict=True):
        case = case_of(scene)
        if case is not None and not found:
            out[case] = (*out.get(case, ()), scene.item.object_number)
    return out
