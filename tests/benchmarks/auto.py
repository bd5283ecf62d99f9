"""What `auto` costs beside `history`, model by model, on real objects.

On a first night a chart is built; of sliding it is the one that the report's picture is drawn from, made before the
verdicts whatever they ask for, so that what a night pays for them is the second ratio.

KOUROS_BENCH_COLLECTION names another collection with Carnegie's columns, such as the whole of it.
"""

import gzip
import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.analysis.cases import Effort
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.plan import Work, plan
from pipeline.analysis.refinement import examine
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.execute import Threads
from pipeline.motions import read_motion
from pipeline.night.importing import bundled_collection
from pipeline.records import Item, Numerics, Scene
from pipeline.resources import resource
from tests.benchmarks.common import SEED

COLLECTION = "KOUROS_BENCH_COLLECTION"
WANTED = 0.1
"""Cost of `auto` as a share of that of `history`, above which the table says why."""


def auto() -> None:
    """Print the cost of `auto` and of `history` for each model, with assumed and with measured parameters."""
    file = Path(os.environ.get(COLLECTION) or bundled_collection())
    items = _read(file)
    level = LevelMotions("design", "max", (read_motion(resource("site_motions", "demo"))[0],))
    assumed, measured = ([classify(i) for i in those] for those in (items, _measured(items)))
    for work in plan(measured[:300]).work:
        # Compiles the kernels.
        _seconds(work, measured, level, "auto", ChartCache())
    print(
        f"{file.name}, {len(items):,} objects, one motion, one thread; seconds, of a first night and of one that finds"
    )
    print("the charts in the cache; sets: parameter sets that differ; histories: share of them that are integrated")
    print(
        f"{'model':<18}{'parameters':<10}{'analyses':>9}{'sets':>8}{'history':>9}{'auto':>8}{'ratio':>7}{'again':>8}"
        f"{'ratio':>7}{'histories':>11}"
    )
    for words, scenes in (("assumed", assumed), ("measured", measured)):
        for work in plan(scenes).work:
            charts = ChartCache()
            slow, _ = _seconds(work, scenes, level, "history", charts)
            quick, effort = _seconds(work, scenes, level, "auto", charts)
            again, _ = _seconds(work, scenes, level, "auto", charts)
            share = (effort.verdicts + effort.numbers) / effort.sets
            why = "" if quick <= WANTED * slow else _why(work, effort)
            print(
                f"{work.model.name:<18}{words:<10}{effort.analyses:>9,}{effort.sets:>8,}{slow:>9.2f}{quick:>8.2f}"
                f"{quick / slow:>7.2f}{again:>8.2f}{again / slow:>7.2f}{share:>11.1%}  {why}".rstrip(),
                flush=True,
            )


def _read(file: Path) -> list[Item]:
    if file.suffix != ".gz":
        return list(read_items(file, load_mapping("carnegie")).items)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / file.stem
        plain.write_bytes(gzip.decompress(file.read_bytes()))
        return _read(plain)


def _seconds(
    work: Work, scenes: Sequence[Scene], level: LevelMotions, fidelity: str, charts: ChartCache
) -> tuple[float, Effort]:
    start = time.perf_counter()
    done = examine(work, scenes, level, Context(Threads(1), charts=charts), Numerics(fidelity))
    return time.perf_counter() - start, done.search.effort


def _why(work: Work, effort: Effort) -> str:
    model = work.model
    if model.exact and model.rests is None:
        return "a closed form: there is nothing to spare"
    if model.exact:
        return f"verdicts are exact without a history; {effort.numbers:,} tell whether what rocks falls, in either"
    if model.chart is None:
        return "it is never tabulated, and its bounds are wide"
    if effort.sets < 10 * model.chart.nodes:
        return f"equal work is done once: {effort.sets:,} sets; a chart takes about {model.chart.nodes} analyses"
    return f"a chart takes about {model.chart.nodes} analyses of sets alike but for {model.chart.name}; bounds cost too"


def _measured(items: Sequence[Item]) -> list[Item]:
    """Return the objects as if everything had been measured, each with numbers of its own."""
    rng = np.random.default_rng(SEED)
    out = []
    for item in items:
        share, friction, room, hook = rng.uniform((0.4, 0.1, 0.02, 0.3), (0.9, 0.6, 0.3, 1.5))
        width, depth = item.width_m or item.depth_m, item.depth_m or item.width_m
        out.append(
            replace(
                item,
                friction=float(friction),
                clearance_m=float(room),
                cg_height_m=None if item.height_m is None else 0.5 * item.height_m,
                base_width_m=None if width is None else float(share) * width,
                base_depth_m=None if depth is None else float(share) * depth,
                suspension_length_m=float(hook),
                damping=0.02,
            )
        )
    return out
