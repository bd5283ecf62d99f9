"""Error of a probability of harm against its cost: numbers of samples, and the rule that stops when a word is sure.

What each number of samples gives is held against samples of the same objects that are not among them.  The samples are
rows of one scrambled Sobol' sequence, so that those of a short run are the first of a long one: of a run of N samples
with the probability P, the rows after the first n, of which the share p is harmed, have (N P - n p) / (N - n).
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.analysis.classify import classify
from pipeline.analysis.faults import sound
from pipeline.analysis.likelihood.analyses import Stood
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.mapping import PRESETS, load_mapping
from pipeline.collection.reading import read_items
from pipeline.execute import Threads
from pipeline.motions.site import read_site
from pipeline.operations.workspace import folder_of_site, open_workspace
from pipeline.quantities import Array
from pipeline.records import Item, Likelihood, Progress, Sampling, Scene
from pipeline.settings import Settings

NUMBERS = (64, 128, 256, 512)
"""Samples of each object that are measured."""

TRUE_SAMPLES = 4096
"""Samples of what they are held against, these included."""

_NEVER = 2.0
"""A certainty that no number of samples gives: all of them are taken."""


@dataclass(frozen=True)
class SamplingCost:
    """One way to sample: what it costs and how wrong it is.

    Attributes
    ----------
    setting : str
        In words.
    objects : int
        On how many it was measured.
    samples : float
        Of an object, on average.
    seconds : float
        Of processor time for all of them.
    rms, p95, worst : float
        Differences of the probabilities from those of other samples: root mean square, of 95 in 100, the largest.
    stated : float
        Root mean square of the standard errors that it states itself.
    right : float
        Share of the objects whose word is that of the other samples.
    """

    setting: str
    objects: int
    samples: float
    seconds: float
    rms: float
    p95: float
    worst: float
    stated: float
    right: float


def sampling_costs(
    scenes: Sequence[Scene],
    levels: Sequence[LevelMotions],
    progress: Progress,
    *,
    sampling: Sampling | None = None,
    objects: int = 200,
    seed: int = 1991,
) -> list[SamplingCost]:
    """Measure the error of probabilities of harm against their cost.

    Parameters
    ----------
    scenes : sequence of Scene
        Objects, of which some are drawn with the seed.
    levels : sequence of LevelMotions
        Of their floor; the last is used, which by convention is the strongest.
    progress : callable
        Is told what is done, of how much.
    sampling : Sampling, optional
        The words and the rule by which a run stops; Kouros's own where left out.
    objects : int
        How many are drawn; those of which no probability can be found are left out of them.
    seed : int
        Of the draw.

    Returns
    -------
    list of SamplingCost
        Of each of NUMBERS, then of the rule; none where no object has a probability.
    """
    rule = sampling or Sampling()
    picked = np.sort(np.random.default_rng(seed).permutation(len(scenes))[:objects]).tolist()
    some, level = [scenes[at] for at in picked], levels[-1:]
    if not some:
        return []
    ways = {f"{n} samples": Sampling(n, _NEVER, rule.edges) for n in NUMBERS}
    ways[f"until {rule.certainty:.0%} sure, {rule.samples} at most"] = rule
    progress.step("samples", 0, len(ways) + 1)
    true, _ = _run(some, level, Sampling(TRUE_SAMPLES, _NEVER, rule.edges))
    out = []
    for done, (told, how) in enumerate(ways.items(), start=1):
        progress.step("samples", done, len(ways) + 1)
        found, seconds = _run(some, level, how)
        if found:
            out.append(_cost(told, found, true, seconds, rule))
    progress.step("samples", len(ways) + 1, len(ways) + 1)
    return out


def _run(scenes: Sequence[Scene], levels: Sequence[LevelMotions], how: Sampling) -> tuple[list[Likelihood], float]:
    stood = [Stood(at, scene) for at, scene in enumerate(scenes)]
    start = time.process_time()
    found = likelihoods(stood, len(stood), levels, how, Threads(), telling=False)
    return [one[0] for one in found if one], time.process_time() - start


def _cost(
    told: str, found: Sequence[Likelihood], true: Sequence[Likelihood], seconds: float, words: Sampling
) -> SamplingCost:
    share, taken, stated = (np.array([getattr(one, n) for one in found]) for n in ("probability", "samples", "error"))
    others = _others(share, taken, np.array([one.probability for one in true]))
    off = np.abs(share - others)
    right = [one.band is words.band(float(other)) for one, other in zip(found, others, strict=True)]
    return SamplingCost(
        setting=told,
        objects=len(found),
        samples=float(taken.mean()),
        seconds=seconds,
        rms=float(np.sqrt(np.mean(off**2))),
        p95=float(np.percentile(off, 95.0)),
        worst=float(off.max()),
        stated=float(np.sqrt(np.mean(stated**2))),
        right=float(np.mean(right)),
    )


def _others(share: Array, taken: Array, every: Array) -> Array:
    """Return the share of harmed samples among those of the long run that are not in the short one."""
    rest = (TRUE_SAMPLES * every - taken * share) / (TRUE_SAMPLES - taken)
    # Both are whole numbers over powers of two; only rounding may leave the interval.
    return np.clip(rest, 0.0, 1.0)


def measured_on(
    settings: Settings | None, site: str | None, items: Sequence[Item], progress: Progress, objects: int
) -> list[SamplingCost]:
    """Measure on the motions of a site and on what is on display of an inventory, by the settings' own rule.

    Parameters
    ----------
    settings : Settings or None
        None measures on the demonstration's collection.
    site : str or None
        Its folder, or "demo"; None: that of the settings.
    items : sequence of Item
        The inventory.
    progress : callable
        Is told what is done, of how much.
    objects : int
        How many are drawn.

    Returns
    -------
    list of SamplingCost
        As of `sampling_costs`.

    Raises
    ------
    MotionError
        For a site that cannot be used.
    """
    rules = house = sampling = None
    if settings is None:
        items = read_items(PRESETS.parent / "data" / "carnegie_2000.csv", load_mapping("carnegie")).items
    else:
        workspace = open_workspace(settings)
        rules, house, sampling = workspace.rules, workspace.house, settings.likelihood.sampling
    shown = [item for item in items if item.on_display]
    scenes = sound(lambda some: [classify(item, rules, None, house) for item in some], shown)
    levels = [
        LevelMotions(level.name, level.combine, tuple(m.motion for m in level.motions))
        for level in read_site(folder_of_site(settings, site)).levels
    ]
    asked = sampling if sampling is not None and sampling.samples else None
    return sampling_costs(scenes, levels, progress, sampling=asked, objects=objects)
