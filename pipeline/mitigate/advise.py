"""From what fails to what helps: the least intrusive measure of the table that passes when its models are run again."""

from collections.abc import Callable, Mapping, Sequence

from pipeline.charts import chart_key
from pipeline.mitigate import measures as m
from pipeline.records import Executor, Finding, Mark, Progress, Recommendation, Scene, Verdict
from pipeline.tables import Row, TableError
from pipeline.verdicts import LevelMotions

Measure = Callable[[Scene, Sequence[Finding], m.Site, Row], m.Tried]

MEASURES: Mapping[str, Measure] = {
    "clearance": m.keep_clear,
    "rubber_pads": m.rubber_pads,
    "grip_pad": m.grip_pad,
    "fasten": m.fasten,
    "restrain": m.restrain,
    "friction_isolator": m.low_friction_pad,
    "horizontal_isolator": m.horizontal_isolator,
    "rotational_isolator": m.rotational_isolator,
    "remove": m.remove,
}
"""How each row of measures.csv changes the chain."""

ROOM = ("clearance", "rubber_pads", "restrain")
"""Measures worth advising where only the assumed room leaves the verdict open."""


def advise(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    executor: Executor,
    progress: Progress,
) -> list[list[Recommendation]]:
    """Recommend one measure for each object and level at which something fails, or is open for want of room.

    levels  : of shaking, with the motions that the findings were made under
    returns : the recommendations of each scene, in the order of the scenes
    """
    sites = {level.name: m.Site(level, executor) for level in levels}
    out: list[list[Recommendation]] = []
    for done, (scene, found) in enumerate(zip(scenes, findings, strict=True), start=1):
        mine = []
        for level, site in sites.items():
            here = [f for f in found if f.level == level]
            if any(f.verdict is Verdict.FAIL for f in here):
                mine.append(_least_intrusive(scene, here, level, site, None))
            elif any(f.verdict is Verdict.UNDETERMINED and f.model in m.DISPLACEMENTS for f in here):
                advice = _least_intrusive(scene, here, level, site, ROOM)
                if advice.measure != "remove":
                    mine.append(advice)
        out.append(mine)
        if done % 200 == 0 or done == len(scenes):
            progress.step("recommendations", done, len(scenes))
    return out


def _least_intrusive(
    scene: Scene, findings: Sequence[Finding], level: str, site: m.Site, only: Sequence[str] | None
) -> Recommendation:
    rejected: list[str] = []
    for row in m.measures():
        name = row["measure"]
        if name not in MEASURES:
            raise TableError(f"measures.csv: nothing is known of a measure {name!r}; use {', '.join(MEASURES)}")
        if only is not None and name not in only and name != "remove":
            continue
        tried = MEASURES[name](scene, findings, site, row)
        if tried.passes:
            return _recommendation(scene, level, row, tried, tuple(rejected), site)
        rejected.append(f"{row['title']}: {tried.reason or 'not enough'}")
    raise TableError("measures.csv: the last measure must always be possible (remove)")


def _recommendation(
    scene: Scene, level: str, row: Row, tried: m.Tried, rejected: tuple[str, ...], site: m.Site
) -> Recommendation:
    mark = None
    if tried.mark is not None:
        kind, x, y = tried.mark
        mark = Mark(chart_key(kind, site.level.motions[0]), x, y, row["title"])
    return Recommendation(
        object_number=scene.item.object_number,
        gallery=scene.item.gallery,
        level=level,
        measure=row["measure"],
        title=row["title"],
        sentence=row["sentence"],
        parameters=dict(tried.parameters),
        units=dict(tried.units),
        checks=tried.checks,
        rejected=rejected,
        mark=mark,
        source=row["source"],
    )
