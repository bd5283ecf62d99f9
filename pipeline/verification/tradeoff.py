"""Speed against accuracy, measured: every fidelity, step and azimuth setting on the user's motions and objects."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from pipeline.analysis.chart_runs import run_chart
from pipeline.analysis.classify import classify
from pipeline.analysis.faults import sound
from pipeline.analysis.model_runs import prepare, run_model
from pipeline.analysis.plan import plan
from pipeline.analysis.response_charts import ChartCache
from pipeline.cache import TRADEOFFS, Cache, CacheEntry
from pipeline.collection.inventory import read_inventory
from pipeline.kernels import KERNEL_VERSION, SENSITIVE
from pipeline.models import MODELS, model_named
from pipeline.motions.by_name import read_motion
from pipeline.operations.workspace import UsageError, charts_of, folder_of_site, open_workspace
from pipeline.quantities import Array
from pipeline.records import Axis, Chart, Columns, Curve, Item, Model, Motion, Numerics, Progress, Scene
from pipeline.records.numerics import AZIMUTH_STEP, HISTORIES, REFINE
from pipeline.settings import Settings
from pipeline.verification.sampling_cost import SamplingCost, measured_on

STEPS = (1, 2, 4, 8, 16)
"""How much finer than the coarsest step the settings of a fixed direction integrate."""

TRUTH = 64
"""The same of what they are held against."""

CHARTED = 1e-3
"""Tolerance of the charts that are measured."""

AZIMUTHS = (45.0, 30.0, 20.0, 10.0, 5.0)
"""Degrees between the directions of which the worst counts."""

AZIMUTH_TRUTH = 2.0
"""The same of what they are held against."""

REPEATS = 3
"""Runs of which the fastest is the cost: machines are noisy."""

MOVED = 1e-3
"""Share of the largest response of the sample from which an object's error is counted: the rest hardly moves."""

CLOSED = 1e-14
"""Error below which a model is exact but for rounding."""


@dataclass(frozen=True)
class Setting:
    """One setting of one model: what it costs and how wrong it is.

    Attributes
    ----------
    model : str
        Its name.
    kind : str
        "bound" (the upper bound, as if it were the response), "chart" (looked up; the building is not in the cost),
        "step" (all three in a fixed direction), or "azimuth" (the worst of several, at `history`).
    setting : str
        In words.
    fidelity : str
        The fidelity where the setting is one, else "".
    cost : float
        In ns per object and sample, in one thread, without the error estimate.
    median, p95, worst : float
        Relative error of the first output over the objects that move.
    wrong : int
        Objects that fall in one and not in the other, which count in no error.
    """

    model: str
    kind: str
    setting: str
    fidelity: str
    cost: float
    median: float
    p95: float
    worst: float
    wrong: int


@dataclass(frozen=True)
class Sample:
    """What a model was measured on.

    Attributes
    ----------
    model : str
        Its name.
    objects : int
        How many parameter sets.
    moved : int
        How many of their responses count, which move.
    sensitive : int
        How many responses hang on less than 1 % of the motion's amplitude, as the model itself says: no setting can be
        right about them, and they count in no error.
    source : str
        "the collection", or "plausible ranges" where it has no such object.
    """

    model: str
    objects: int
    moved: int
    sensitive: int
    source: str


@dataclass(frozen=True)
class Tradeoff:
    """A measurement, with what it depends on; probabilities: none where they were not asked for."""

    measured: str
    kernels: str
    motions: Sequence[str]
    samples: Sequence[Sample]
    settings: Sequence[Setting]
    probabilities: Sequence[SamplingCost] = ()

    def cheapest(self, wanted: float) -> dict[str, Setting | None]:
        """Return, for each model, the cheapest step whose worst error keeps a wanted one, with every outcome right.

        Parameters
        ----------
        wanted : float
            Relative error.

        Returns
        -------
        dict of str to Setting or None
            By model; None where no step keeps it.
        """
        out: dict[str, Setting | None] = {}
        for sample in self.samples:
            good = [
                s
                for s in self.settings
                if s.model == sample.model and s.kind == "step" and s.worst <= wanted and not s.wrong
            ]
            # A model that is solved in closed form has no step: only noise would make one the cheapest.
            plain = [s for s in good if s.fidelity == "history" and s.worst < CLOSED]
            out[sample.model] = min(plain or good, key=lambda s: s.cost) if good else None
        return out


def measure(
    motions: Sequence[Motion],
    items: Sequence[Item],
    progress: Progress,
    *,
    models: Sequence[str] = (),
    objects: int = 128,
    seed: int = 1991,
    charts: ChartCache | None = None,
) -> Tradeoff:
    """Measure error against cost for each model at every setting.

    Parameters
    ----------
    motions : sequence of Motion
        Each model is run under each of them; errors are over all, costs the mean.
    items : sequence of Item
        The collection that parameters are drawn from, at random with the seed.
    progress : callable
        Is told what is done, of how much.
    models : sequence of str
        Their names; all where empty.
    objects : int
        Parameter sets of each model.
    seed : int
        Of the draws.
    charts : ChartCache or None
        Where charts are found and kept; None: in memory only.

    Returns
    -------
    Tradeoff
        Errors relative, costs in ns per object and sample.

    Notes
    -----
    Errors are against a step TRUTH times finer than the coarsest, and directions every AZIMUTH_TRUTH degrees.
    """
    chosen = [model_named(name) for name in models] or list(MODELS)
    scenes = sound(lambda some: [classify(item) for item in some], items)
    samples, settings = [], []
    cache = ChartCache() if charts is None else charts
    for done, model in enumerate(chosen):
        progress.step("models", done, len(chosen))
        values, source = _drawn(model, scenes, objects, np.random.default_rng(seed))
        size = next(iter(values.values())).size
        # A few objects would not fill the lanes that the kernels work in, and each would seem dear.
        full = {name: np.resize(column, max(size, objects)) for name, column in values.items()}
        rows, moved, sensitive = _of_model(model, motions, full, cache)
        settings += rows
        counted, doubtful = (int(one[:, :size].sum()) for one in (moved, sensitive))
        samples.append(Sample(model.name, size, counted, doubtful, source))
    progress.step("models", len(chosen), len(chosen))
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return Tradeoff(now, KERNEL_VERSION, [m.name for m in motions], samples, settings)


def _drawn(
    model: Model, scenes: Sequence[Scene], objects: int, rng: np.random.Generator
) -> tuple[dict[str, Array], str]:
    for work in plan(scenes).work if scenes else ():
        if work.model is model:
            rows = np.unique(work.spans.rows[work.spans.starts])
            picked = rng.choice(rows, min(objects, rows.size), replace=False)
            return {
                name: np.ascontiguousarray(column[picked]) for name, column in work.values.items()
            }, "the collection"
    given: dict[str, Any] = {}
    for name, (low, high) in model.trials.ranges.items():
        part = rng.uniform(size=objects)
        given[name] = low * (high / low) ** part if low > 0.0 else low + (high - low) * part
    return prepare(model, given), "plausible ranges"


def _of_model(
    model: Model, motions: Sequence[Motion], values: Mapping[str, Array], charts: ChartCache
) -> tuple[list[Setting], NDArray[np.bool_], NDArray[np.bool_]]:
    two = model.directions == 2 or (model.directions == 0 and values["directions"][0] == 2.0)
    angle = None if two else 0.0
    truth = [_stepped(model, motion, values, angle, TRUTH) for motion in motions]
    for motion, true in zip(motions, truth, strict=True):
        # Only a run with its error estimate says which outcomes hang on next to nothing.
        true["note"] = model.run(motion.excitation(angle), values, REFINE["history"], True)["note"]
    names = {refine: fidelity for fidelity, refine in REFINE.items()}
    rows = []
    if model.bound is not None:
        runs = [_timed(partial(_bounded, model, motion, values, angle)) for motion in motions]
        rows.append(_setting(model, "bound", "upper bound", "bound", motions, runs, truth))
    if model.chart is not None:
        # One chart serves the objects that differ along its axis only: the others are those of the first.
        along = {n: v if n == model.chart.name else np.full_like(v, v[0]) for n, v in values.items()}
        charted = [_stepped(model, motion, along, angle, TRUTH) for motion in motions]
        looked = partial(_looked_up, model, angle=angle, charts=charts)
        runs = [_timed(partial(looked, motion, along)) for motion in motions]
        rows.append(_setting(model, "chart", f"chart to {CHARTED:g}", "chart", motions, runs, charted))
    for refine in STEPS:
        name = names.get(refine, "")
        told = f"{name} (step 1/{refine})" if name else f"step 1/{refine}"
        runs = [_timed(partial(_stepped, model, motion, values, angle, refine)) for motion in motions]
        rows.append(_setting(model, "step", told, name, motions, runs, truth))
    if not two:
        finest = [_turned(model, motion, values, AZIMUTH_TRUTH) for motion in motions]
        for step in AZIMUTHS:
            told = f"every {step:g} degrees" + (" (the default)" if step == AZIMUTH_STEP else "")
            runs = [_timed(partial(_turned, model, motion, values, step), 1) for motion in motions]
            rows.append(_setting(model, "azimuth", told, "", motions, runs, finest))
    return rows, np.array([_counted(model, one) for one in truth]), np.array([_sensitive(one) for one in truth])


def _stepped(model: Model, motion: Motion, values: Mapping[str, Array], angle: float | None, refine: int) -> Columns:
    return model.run(motion.excitation(angle), values, refine, False)


def _bounded(model: Model, motion: Motion, values: Mapping[str, Array], angle: float | None) -> Columns:
    return run_model(model, motion, values, Numerics("bound"), angle)[0]


def _looked_up(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    *,
    angle: float | None,
    charts: ChartCache,
) -> Columns:
    return run_chart(model, motion, values, Numerics(tolerance=CHARTED), angle, charts=charts)[0]


def _turned(model: Model, motion: Motion, values: Mapping[str, Array], step: float) -> Columns:
    return run_model(model, motion, values, replace(HISTORIES, azimuth_step=step), None)[0]


def _timed(work: Callable[[], Columns], repeats: int = REPEATS) -> tuple[Columns, float]:
    best, answer = np.inf, work()
    for _ in range(repeats):
        start = time.perf_counter()
        answer = work()
        best = min(best, time.perf_counter() - start)
    return answer, best


def _counted(model: Model, truth: Columns) -> NDArray[np.bool_]:
    """Which objects' errors count: those that move, and whose outcome does not hang on next to nothing."""
    first = np.abs(truth[model.gives[0].name])
    moves: NDArray[np.bool_] = (first > MOVED * np.max(first, initial=0.0)) & ~_sensitive(truth)
    return moves


def _sensitive(truth: Columns) -> NDArray[np.bool_]:
    bits: NDArray[np.bool_] = (truth["note"].astype(np.int64) & SENSITIVE) > 0
    return bits


def _setting(
    model: Model,
    kind: str,
    told: str,
    fidelity: str,
    motions: Sequence[Motion],
    runs: Sequence[tuple[Columns, float]],
    truth: Sequence[Columns],
) -> Setting:
    first = model.gives[0].name
    outcome = next((q.name for q in model.gives if q.unit == "bool"), None)
    errors, wrong, cost = [], 0, []
    for motion, (columns, seconds), true in zip(motions, runs, truth, strict=True):
        counted = _counted(model, true)
        if outcome is not None and kind != "bound":
            differ = (columns[outcome] != true[outcome]) & ~_sensitive(true)
            wrong += int(differ.sum())
            counted = counted & ~differ
        errors.append(np.abs(columns[first] - true[first])[counted] / np.abs(true[first][counted]))
        cost.append(1e9 * seconds / true[first].size / motion.samples)
    every = np.concatenate(errors) if errors else np.zeros(0)
    if not every.size:
        every = np.zeros(1)
    return Setting(
        model=model.name,
        kind=kind,
        setting=told,
        fidelity=fidelity,
        cost=float(np.mean(cost)),
        median=float(np.median(every)),
        p95=float(np.percentile(every, 95.0)),
        worst=float(every.max()),
        wrong=wrong,
    )


def picture(found: Tradeoff) -> Chart:
    """Return the work-precision plot: cost of each model against the error in 95 of 100 objects, step by step.

    Parameters
    ----------
    found : Tradeoff
        What was measured.

    Returns
    -------
    Chart
        Both axes logarithmic.

    Raises
    ------
    ValueError
        Where no measured model has a step, so that there is nothing to draw.
    """
    curves, closed = [], []
    for sample in found.samples:
        steps = [s for s in found.settings if s.model == sample.model and s.kind == "step"]
        title = model_named(sample.model).title
        if all(s.p95 < CLOSED for s in steps):
            closed.append(f"{title.lower()} {min(s.cost for s in steps):.2g} ns")
        else:
            x, y = zip(*sorted((max(s.p95, CLOSED), s.cost) for s in steps), strict=True)
            curves.append(Curve(title, tuple(x), tuple(y)))
    if not curves:
        raise ValueError("no model of the measurement has a step of integration")
    return Chart(
        key=f"{PICTURE}:{found.kernels}",
        title="What accuracy costs",
        caption=(
            f"Each line is a model, each of its points a step of integration: the relative error that 95 of 100 "
            f"objects keep, and the time for one object and one sample of the record. Measured on "
            f"{found.measured[:10]} under {', '.join(found.motions)}, on objects of this collection where it has such. "
            f"Solved in closed form, so that a finer step buys nothing: {', '.join(closed) or 'none'}."
        ),
        x=Axis("Relative error of the response", "-", "log"),
        y=Axis("Cost in ns per object and sample", "-", "log"),
        curves=tuple(curves),
        source="measured by `kouros tradeoff`",
    )


PICTURE = "tradeoff"
"""How the key of its picture begins."""

LAST = "last"
"""Key under which the last measurement lies for the reports."""


def keep(found: Tradeoff, folder: Path) -> None:
    """Keep a measurement for the next reports, in place of the last one.

    Parameters
    ----------
    found : Tradeoff
        What is kept.
    folder : Path
        Of the cache.
    """
    Cache(folder).put(TRADEOFFS, LAST, CacheEntry(asdict(found)), lasting=True)


def kept(folder: Path) -> Tradeoff | None:
    """Return the last measurement.

    Parameters
    ----------
    folder : Path
        Of the cache.

    Returns
    -------
    Tradeoff or None
        None: never measured, measured on other kernels or models, or damaged.
    """
    found = Cache(folder).get(TRADEOFFS, LAST, lasting=True)
    try:
        last = None if found is None else TypeAdapter(Tradeoff).validate_json(json.dumps(found.said), strict=True)
    except ValueError:
        return None
    # A model of another package may be gone since.
    there = {model.name for model in MODELS}
    fits = last is not None and last.kernels == KERNEL_VERSION and {s.model for s in last.samples} <= there
    return last if fits else None


def tradeoff_on(
    settings: Settings | None, site: str | None, progress: Progress, *, probabilities: int = 0, **wishes: Any
) -> Tradeoff:
    """Measure on a site and on the inventory of the settings, and keep it for the next report.

    Parameters
    ----------
    settings : Settings or None
        None measures on plausible objects, and keeps nothing.
    site : str or None
        Its folder, or "demo"; None: that of the settings.
    progress : callable
        Is told what is done, of how much.
    probabilities : int
        Objects on display whose probabilities of harm are measured too; of the demonstration where settings are None.
    **wishes : Any
        As of `measure`.

    Returns
    -------
    Tradeoff
        What was measured.

    Raises
    ------
    UsageError
        For a model that there is not or where no site is named.
    MotionError
        For a site that cannot be used.
    """
    try:
        names = [model_named(name).name for name in wishes.pop("models", ())]
    except ValueError as problem:
        raise UsageError(str(problem)) from problem
    motions = read_motion(folder_of_site(settings, site))
    items = [] if settings is None else read_inventory(open_workspace(settings).engine)
    with charts_of(settings) as charts:
        found = measure(motions, items, progress, models=names, charts=charts, **wishes)
    if probabilities:
        found = replace(found, probabilities=measured_on(settings, site, items, progress, probabilities))
    # A part would take the place of the whole in the report.
    if settings is not None and site is None and not names:
        keep(found, settings.kept)
    return found
