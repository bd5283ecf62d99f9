"""Scene -> which models, with which parameters, and why the others not; equal work only once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline.models import MODELS
from pipeline.quantities import Array
from pipeline.records import Model, Scene


@dataclass(frozen=True)
class Work:
    """All analyses of one model: unique parameter sets, and which of them each scene asked for.

    values : by parameter, (k,) unique sets
    scenes : (m,) index of the scene of each analysis
    best   : (m,) row of values with the best estimates
    spread : for each analysis, the rows that span its uncertain inputs (the best one among them)
    """

    model: Model
    values: Mapping[str, Array]
    scenes: Sequence[int]
    best: Sequence[int]
    spread: Sequence[tuple[int, ...]]


@dataclass(frozen=True)
class Plan:
    """What to run, and for each scene which models were not run and why."""

    work: tuple[Work, ...]
    skipped: tuple[Mapping[str, str], ...]


def plan(scenes: Sequence[Scene]) -> Plan:
    """Choose the models of each scene and gather their parameter sets, each set once however many objects share it."""
    skipped: list[dict[str, str]] = [{} for _ in scenes]
    work = []
    for model in MODELS:
        chosen = []
        for index, scene in enumerate(scenes):
            reason = _reason(model, scene)
            if reason:
                skipped[index][model.title] = reason
            else:
                chosen.append(index)
        if chosen:
            work.append(_gather(model, scenes, chosen))
    return Plan(tuple(work), tuple(skipped))


def _reason(model: Model, scene: Scene) -> str:
    if scene.missing:
        return f"not recorded: {', '.join(scene.missing)}"
    reason = model.applies(scene)
    if not reason and model.name not in scene.models:
        return f"not required: {scene.rule.partition(': ')[2]}; it is free to move instead"
    return reason


def _gather(model: Model, scenes: Sequence[Scene], chosen: Sequence[int]) -> Work:
    names = [q.name for q in model.needs]
    defaults = [np.nan if q.default is None else q.default for q in model.needs]
    rows: list[list[float]] = []
    best, spans = [], []
    for index in chosen:
        known = scenes[index].parameters
        base = [known[n].value if n in known else d for n, d in zip(names, defaults, strict=True)]
        vertices = [base]
        # One input at a time at its ends: what each of them can do to the demand on its own.
        for at, name in enumerate(names):
            if name in known and known[name].low < known[name].high:
                for end in (known[name].low, known[name].high):
                    vertices.append([*base[:at], end, *base[at + 1 :]])
        best.append(len(rows))
        spans.append(range(len(rows), len(rows) + len(vertices)))
        rows.extend(vertices)
    matrix = np.array(rows)
    unique, where = _unique_rows(matrix)
    return Work(
        model,
        {name: np.ascontiguousarray(unique[:, i]) for i, name in enumerate(names)},
        tuple(chosen),
        tuple(int(where[i]) for i in best),
        tuple(tuple(int(where[i]) for i in span) for span in spans),
    )


def _unique_rows(matrix: Array) -> tuple[Array, NDArray[np.intp]]:
    # Bit for bit, so that NaN (not given) equals NaN.
    bits = np.ascontiguousarray(matrix).view(np.uint64)
    _, first, inverse = np.unique(bits, axis=0, return_index=True, return_inverse=True)
    return matrix[first], inverse.reshape(-1)
