"""Scenes x motions -> demands -> findings: each demand against its capacity, with a number for how sure we are."""

import logging
from collections.abc import MutableMapping, Sequence
from time import perf_counter

from pipeline.analysis.findings import findings
from pipeline.analysis.plan import Plan, plan
from pipeline.analysis.refinement import AUTO, Effort, examine
from pipeline.analysis.response_charts import SHELF, Shelf
from pipeline.analysis.verdicts import Judgement, LevelMotions, capacity_of, judge
from pipeline.records import Executor, Finding, Progress, Scene

logger = logging.getLogger(__name__)

__all__ = ["FIDELITIES", "Judgement", "LevelMotions", "assess", "capacity_of", "judge"]

FIDELITIES = (AUTO, "chart", "history", "reference")
"""How finely verdicts can be found; `auto` climbs only until each of them stands."""


def assess(
    scenes: Sequence[Scene],
    levels: Sequence[LevelMotions],
    executor: Executor,
    progress: Progress,
    *,
    fidelity: str = AUTO,
    azimuth_step: float = 10.0,
    charts: Shelf = SHELF,
    outcomes: bool = True,
    efforts: MutableMapping[str, Effort] | None = None,
    needing: Sequence[MutableMapping[str, int]] | None = None,
) -> tuple[Plan, list[list[Finding]]]:
    """Run everything the scenes require under every motion and judge it.

    levels    : of one site, at least one
    fidelity  : one of FIDELITIES; `auto` gives the verdicts of `history`
    charts    : where charts are found and kept
    outcomes  : whether to find numbers beyond the verdict: what fails, by how much, and what it does then
    efforts   : what the verdicts took is added here, by the name of the model
    needing   : for how many of each scene's analyses any history was run is added here, by the name of the model
    returns   : the plan (with the reasons for models not run) and the findings of each scene, in their order
    """
    began = perf_counter()
    todo = plan(scenes, levels[0].x_azimuth)
    found: list[list[Finding]] = [[] for _ in scenes]
    total = len(todo.work) * sum(len(level.motions) for level in levels)
    done = 0
    progress.step("analyses", done, total)
    for level in levels:
        for work in todo.work:
            since = perf_counter()
            examined = examine(
                work,
                scenes,
                level,
                executor,
                fidelity=fidelity,
                azimuth_step=azimuth_step,
                charts=charts,
                outcomes=outcomes,
            )
            for case, known in examined.cases:
                made = findings(examined.climb, case, known, scenes)
                where = work.scenes[case.analyses]
                for index, finding in zip(where.tolist(), made, strict=True):
                    found[index].append(finding)
                if needing is not None:
                    for index in where[examined.climb.needed(case)].tolist():
                        needing[index][work.model.name] = needing[index].get(work.model.name, 0) + 1
            if efforts is not None:
                efforts.setdefault(work.model.name, Effort()).add(examined.climb.effort)
            logger.debug(
                "%s of %d scenes under level %r (%d motions): %.3f s",
                work.model.name, len(work.scenes), level.name, len(level.motions), perf_counter() - since,
            )  # fmt: skip
            done += len(level.motions)
            progress.step("analyses", done, total)
    logger.info("assessed %d scenes at %d levels in %.2f s", len(scenes), len(levels), perf_counter() - began)
    return todo, found
