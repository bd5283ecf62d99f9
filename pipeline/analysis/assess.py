"""Scenes x motions -> demands -> findings: each demand against its capacity, with a number for how sure we are."""

import logging
from collections.abc import MutableMapping, Sequence
from dataclasses import replace
from time import perf_counter

from pipeline.analysis.cases import Effort
from pipeline.analysis.context import Context
from pipeline.analysis.findings import findings
from pipeline.analysis.furnished import best_furnished
from pipeline.analysis.furniture import filter_of, itself, loose
from pipeline.analysis.loose import movement
from pipeline.analysis.plan import Plan, plan
from pipeline.analysis.refinement import examine
from pipeline.analysis.verdicts import Judgement, LevelMotions, capacity_of, judge
from pipeline.models.unanchored import ABOUT
from pipeline.records import Finding, Numerics, Scene
from pipeline.records import phrases as say
from pipeline.records.numerics import AUTO, CHART, VERDICTS

logger = logging.getLogger(__name__)

__all__ = ["FIDELITIES", "Judgement", "LevelMotions", "assess", "capacity_of", "judge"]

FIDELITIES = (AUTO, CHART, "history", "reference")
"""How finely verdicts can be found; `auto` goes only as far as each of them needs."""


def assess(
    scenes: Sequence[Scene],
    levels: Sequence[LevelMotions],
    context: Context,
    numerics: Numerics = VERDICTS,
    *,
    outcomes: bool = True,
    efforts: MutableMapping[str, Effort] | None = None,
    needing: Sequence[MutableMapping[str, int]] | None = None,
) -> tuple[Plan, list[list[Finding]]]:
    """Run everything the scenes require under every motion and judge it.

    Parameters
    ----------
    scenes
        The objects as they stand.
    levels
        Of one site, at least one.
    context
        Where it runs, who is told, and what was computed before.
    numerics
        How finely: one of `FIDELITIES`; "auto" gives the verdicts of "history".
    outcomes
        Whether to find numbers beyond the verdict: what fails, by how much, and what it does then.
    efforts
        What the verdicts took is added here, by the name of the model.
    needing
        For how many of each scene's analyses any history was run is added here, by the name of the model.

    Returns
    -------
    plan : Plan
        What was run, with the reasons for models not run.
    findings : list of list of Finding
        Of each scene, in their order; after those of the object that of its furniture, where that is not fastened.
    """
    progress = context.progress
    began = perf_counter()
    todo = plan(scenes, levels[0].x_azimuth)
    found: list[list[Finding]] = [[] for _ in scenes]
    total = len(todo.work) * sum(len(level.motions) for level in levels)
    done = 0
    progress.step("analyses", done, total)
    for level in levels:
        for work in todo.work:
            since = perf_counter()
            examined = examine(work, scenes, level, context, numerics, outcomes=outcomes)
            for case, known in examined.cases:
                made = findings(examined.search, case, known, scenes)
                where = work.scenes[case.analyses]
                for index, finding in zip(where.tolist(), made, strict=True):
                    found[index].append(finding)
                if needing is not None:
                    for index in where[examined.search.needed(case)].tolist():
                        needing[index][work.model.name] = needing[index].get(work.model.name, 0) + 1
            if efforts is not None:
                efforts.setdefault(work.model.name, Effort()).add(examined.search.effort)
            logger.debug(
                "%s of %d scenes under level %r (%d motions): %.3f s",
                work.model.name, len(work.scenes), level.name, len(level.motions), perf_counter() - since,
            )  # fmt: skip
            done += len(level.motions)
            progress.step("analyses", done, total)
    # Furniture is judged under the motions of its floor, and never makes an object look assessed that is not.
    stands = [at for at, scene in enumerate(scenes) if loose(scene) and found[at] and not levels[0].passed_on]
    if stands:
        _, judged = assess(
            [itself(scenes[index]) for index in stands],
            levels,
            context.silent,
            numerics,
            outcomes=outcomes,
            efforts=efforts,
            needing=None if needing is None else [needing[index] for index in stands],
        )
        for index, some in zip(stands, judged, strict=True):
            found[index] += [moving(one, scenes[index], levels) for one in some] if outcomes else some
    logger.info("assessed %d scenes at %d levels in %.2f s", len(scenes), len(levels), perf_counter() - began)
    return todo, found


def moving(finding: Finding, scene: Scene, levels: Sequence[LevelMotions]) -> Finding:
    """Say how far furniture moves on its floor by the best estimates, where nothing else is said of what it does.

    Parameters
    ----------
    finding : Finding
        Of the furniture.
    scene : Scene
        The object in it.
    levels : sequence of LevelMotions
        Those of the floor.

    Returns
    -------
    Finding
        With that in its sentence.
    """
    shaken = filter_of(scene)
    if finding.sentence != ABOUT or shaken is None or shaken.loose is None:
        return finding
    level = next(one for one in levels if one.name == finding.level)
    on_floor = best_furnished(level.motions, replace(shaken, loose=None))
    far = level.combined([movement(motion, shaken.loose.best) for motion in on_floor])
    said = say.MOVES_ON_FLOOR(away=far) if far else say.STAYS_ON_FLOOR()
    return replace(finding, sentence=f"{finding.sentence} {said}")
