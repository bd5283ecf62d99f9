r"""What people found in the galleries, and what it says of the shaking: Bayes over what all objects have in common.

A draw x of what is in common (both peaks of the shaking and how hard the record is beside them, three standard normals
before anybody looked) has the weight

.. math::

    w(x) \propto \varphi(x) \prod_i \big(\epsilon + (1 - 2 \epsilon)\, P_i(\text{found}_i \mid x)\big) / q(x)

over the objects that somebody looked at, epsilon being the chance that a report is wrong, and q what x was drawn from:
first phi itself, then twice a normal about what the weights said, half as wide again, so that many reports leave more
than a few draws with a weight (adaptive importance sampling).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pipeline.event.answer import Draws, chances, moved_of, normals, placed
from pipeline.event.capacities import KINDS, Capacities
from pipeline.event.message import SiteShaking
from pipeline.quantities import Array, G
from pipeline.records import Harm
from pipeline.records.fragility import HARM

WRONG = 0.02
"""Chance that a report is wrong, of the object or of its state: judgement, from 0.005 to 0.05."""

FIRST, ROUNDS, WIDER = 4096, 2, 1.5
"""Draws before anybody looked, further rounds, and by how much each is wider than what the one before said."""

FEW = 64.0
"""Draws that have to count at least in a round; where fewer do, the reports count for less in it, and fully at last."""


def conditioned(
    capacities: Capacities, found: Mapping[int, str], shaking: SiteShaking, objects: int = 0
) -> tuple[Draws, SiteShaking]:
    """Return draws of what all objects have in common, after what was found, and the shaking that they say.

    Parameters
    ----------
    capacities : Capacities
        Of all objects.
    found : mapping of int to str
        By place of the object, one of `pipeline.event.found.STATES`.
    shaking : SiteShaking
        As the messages have it.
    objects : int
        How many objects the draws are for.
    """
    known = capacities.known
    places = [at for at in sorted(found) if known[at]]
    if not places:
        return placed(shaking, normals(objects)), shaking
    few, states = capacities.some(places), [found[at] for at in places]
    points, last = normals(count=FIRST), normals(objects)
    spread = np.zeros(len(points))
    for _ in range(ROUNDS):
        said = _ln_likelihood(few, states, placed(shaking, points))
        weights = _weights(said, -0.5 * (points**2).sum(axis=1) - spread)
        mean = weights @ points
        off = points - mean
        root = WIDER * np.linalg.cholesky((off * weights[:, None]).T @ off + 1e-6 * np.eye(3))
        base = normals(count=FIRST)
        points, spread = mean + base @ root.T, -0.5 * (base**2).sum(axis=1)
    said = _ln_likelihood(few, states, placed(shaking, points))
    weights = _normal(said - 0.5 * (points**2).sum(axis=1) - spread)
    # As many as are needed are kept of these, by even steps through their weights.
    steps = (np.arange(len(last)) + 0.5) / len(last)
    kept = points[np.minimum(np.searchsorted(np.cumsum(weights), steps), len(points) - 1)]
    draws = placed(shaking, kept)
    return draws, _after(shaking, placed(shaking, points, weights), len(places))


def _after(shaking: SiteShaking, draws: Draws, reports: int) -> SiteShaking:
    """Return the shaking that weighted draws say."""
    means = [float(draws.weights @ part) for part in (draws.ln_pga, draws.ln_pgv)]
    sds = [
        math.sqrt(max(float(draws.weights @ (part - mean) ** 2), 0.0))
        for part, mean in zip((draws.ln_pga, draws.ln_pgv), means, strict=True)
    ]
    return replace(
        shaking, pga_g=math.exp(means[0]) / G, pgv_cm_s=100.0 * math.exp(means[1]), pga_ln_sd=sds[0], pgv_ln_sd=sds[1],
        origin=f"{shaking.origin}, and {reports} reports from the galleries",
    )  # fmt: skip


def _ln_likelihood(capacities: Capacities, states: Sequence[str], draws: Draws) -> Array:
    chance = chances(capacities, draws, slice(0, len(states)))
    moved, falls = moved_of(chance), chance[KINDS.index(Harm.FALLS.value)]
    by_state = {
        "standing": np.maximum(1.0 - moved - falls, 0.0),
        "moved": moved,
        "fallen": falls,
        "broken": np.maximum(chance[KINDS.index(HARM)], falls),
    }
    each = np.stack([by_state[state][:, at] for at, state in enumerate(states)], axis=1)
    out: Array = np.log(WRONG + (1.0 - 2.0 * WRONG) * each).sum(axis=1)
    return out


def _normal(ln: Array) -> Array:
    weights = np.exp(ln - ln.max())
    return np.asarray(weights / weights.sum())


def _weights(said: Array, before: Array) -> Array:
    """Return weights with as much of the reports in them as leaves enough draws."""
    share = 1.0
    while True:
        weights = _normal(share * said + before)
        if 1.0 / float((weights**2).sum()) >= FEW or share < 1e-3:
            return weights
        share *= 0.7
