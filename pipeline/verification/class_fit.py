"""Weights of evidence for the class of an object, found from labelled objects, and their test on museums left out.

Each labelled object is shown several times, with parts of its record hidden, so that the weights hold for museums that
record no classification, or no object name.  Ridge penalties keep the weights of single rules and signs below those of
fields and classes.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.sparse import csr_matrix
from threadpoolctl import threadpool_limits

from pipeline.analysis.evidence import AGREES, BIAS, GALLERY, SAYING, SILENT, Weights, read_weights, shares_of, signs_of
from pipeline.analysis.rule_table import rules
from pipeline.analysis.rules import PICTURES, readings
from pipeline.records import Item
from pipeline.tables import table

CLASSES = tuple(row["class"] for row in table("classes"))
"""Those of Kouros's own table."""
TEXTS = ("title", "object_name", "classification", "medium")
LENGTHS = ("height_m", "width_m", "depth_m")

HIDDEN: tuple[tuple[tuple[str, ...], float], ...] = (
    ((), 1.0),
    (("classification",), 0.5),
    (("object_name",), 0.3),
    (("title",), 0.3),
    (("gallery",), 0.5),
    (("classification", "object_name", "medium"), 0.2),
    (("title", "classification", "medium", "gallery"), 0.2),
    (("title", "classification", "medium", "gallery", *LENGTHS), 0.2),
    (("classification", "object_name", "medium", "gallery"), 0.3),
    (("classification", "object_name", "medium", "gallery", *LENGTHS), 0.3),
)
"""Parts of a record that are hidden, and the weight of the object without them."""

RENAMED = 0.3
"""Weight of an object whose title is taken as its object name."""

BARE = 1.5
"""Weight of what the table of rules says of a name that stands alone, for each rule that names things.

Few of the labelled objects have nothing but a name, and museums that record little have many such.
"""

NAMING = (1, 3)
"""Words that a title has, at least and at most, which is what other museums record as the name of the thing."""

RIDGE = {"agree": 0.02, "class": 3.0, "rule": 3.0, "sign": 10.0, "gallery": 1.0, "bias": 2.0}
"""Penalties on squared weights."""

LEAST = 0.02
"""Smaller weights are left out of the table."""


@dataclass(frozen=True)
class Labelled:
    """An object with the class that a person gave it."""

    museum: str
    item: Item
    object_class: str


def labelled_of(row: Mapping[str, str]) -> Labelled:
    """Return a row of a file of labelled objects."""
    texts = {name: row[name] for name in TEXTS}
    sizes = {name: float(row[name]) if row[name] else None for name in LENGTHS}
    item = Item(row["object_number"], row["department"], **texts, **sizes)  # type: ignore[arg-type]
    return Labelled(row["collection"], item, row["class"])


def read_labelled(path: Path) -> list[Labelled]:
    """Return the objects of a file of labels."""
    with path.open(encoding="utf-8", newline="") as stream:
        return [labelled_of(row) for row in csv.DictReader(stream)]


@cache
def _shown(one: Labelled) -> dict[tuple[str, ...], float]:
    """Return the signs of an object, whole and with parts hidden, each with its weight."""
    out: dict[tuple[str, ...], float] = {}
    _show(one.item, 1.0, out)
    for item in _named(one):
        _show(item, RENAMED, out)
    return out


def _named(one: Labelled) -> tuple[Item, ...]:
    """Return the object as a museum would record it that keeps an object name, where this one keeps none.

    A work that is hung is named by what it is classified as, another thing by a short title.
    """
    item = one.item
    if item.object_name or not NAMING[0] <= len(item.title.split()) <= NAMING[1]:
        return ()
    if one.object_class not in PICTURES:
        return (replace(item, object_name=item.title, title=""),)
    return (replace(item, object_name=item.classification, classification=""),) if item.classification else ()


@cache
def _bare() -> Mapping[tuple[tuple[str, ...], str], float]:
    """Return the signs that names alone show, each with the class that its rule says."""
    out = {}
    for word in sorted(rules().by_word):
        item = Item("-", "", object_name=word)
        read = readings(item)
        # A word that is only half believed is weighed by its share, and teaches nothing.
        if read.name is not None and read.name is read.decided and read.name.share == 1.0:
            out[signs_of(item, read), read.decided.rule.object_class] = BARE
    return out


def _show(item: Item, share: float, out: dict[tuple[str, ...], float]) -> None:
    """Add the signs of an object, whole and with parts hidden, each with a share of its weight."""
    for hidden, weight in HIDDEN:
        if hidden and not any(getattr(item, name) for name in hidden):
            continue
        less = replace(item, **{name: None if name in LENGTHS else "" for name in hidden})  # type: ignore[arg-type]
        signs = signs_of(less, readings(less))
        out[signs] = out.get(signs, 0.0) + share * weight


def fit(objects: Sequence[Labelled]) -> Weights:
    """Return the weights that make the labels most probable, less the penalties."""
    classes = CLASSES
    # Many objects show the same: together they are one case of as much weight, two fifths fewer.
    alike = {(signs, classes.index(name)): share for (signs, name), share in _bare().items()}
    for one in objects:
        for signs, share in _shown(one).items():
            case = signs, classes.index(one.object_class)
            alike[case] = alike.get(case, 0.0) + share
    cases = [(*case, share) for case, share in alike.items()]
    columns = {sign: at for at, sign in enumerate(sorted({sign for signs, _, _ in cases for sign in signs}))}
    indices = [columns[sign] for signs, _, _ in cases for sign in signs]
    starts = np.cumsum([0, *(len(signs) for signs, _, _ in cases)])
    shown = csr_matrix((np.ones(len(indices)), indices, starts), shape=(len(cases), len(columns)))
    right = np.array([label for _, label, _ in cases])
    weight = np.array([w for _, _, w in cases])
    said: set[tuple[int, int]] = set()
    for row, (signs, _, _) in enumerate(cases):
        for sign in signs:
            field, _, named = sign.partition(": ")
            if field in SAYING and named in classes:
                said.add((row * len(classes) + classes.index(named), SAYING.index(field)))
    at, fields = np.transpose(sorted(said))
    agreeing = csr_matrix((np.ones(len(said)), (at, fields)), shape=(len(cases) * len(classes), len(SAYING)))
    ridge = np.array([_penalty(sign, classes) for sign in columns])[:, None]
    size = len(columns) * len(classes)
    rows = np.arange(len(right))

    def loss(x: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        of_sign, of_field = x[:size].reshape(len(columns), len(classes)), x[size:]
        scores = shown @ of_sign + (agreeing @ of_field).reshape(len(cases), len(classes))
        scores -= scores.max(axis=1, keepdims=True)
        away = np.exp(scores)
        total = away.sum(axis=1)
        value = -float(weight @ (scores[rows, right] - np.log(total)))
        away /= total[:, None]
        away[rows, right] -= 1.0
        away *= weight[:, None]
        value += 0.5 * float(np.sum(ridge * of_sign**2)) + 0.5 * RIDGE["agree"] * float(of_field @ of_field)
        slope = shown.T @ away + ridge * of_sign
        return value, np.concatenate([slope.ravel(), agreeing.T @ away.ravel() + RIDGE["agree"] * of_field])

    start = np.zeros(size + len(SAYING))
    # Threads of BLAS wait for each other more than they compute on vectors of this size.
    with threadpool_limits(limits=1, user_api="blas"):
        found = minimize(
            loss,
            start,
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": 400, "maxfun": 500, "ftol": 1e-8, "gtol": 1e-3},
        )
    of_sign = found.x[:size].reshape(len(columns), len(classes))
    return Weights(
        classes,
        {sign: of_sign[at] for sign, at in columns.items()},
        {field: float(found.x[size + at]) for at, field in enumerate(SAYING)},
    )


def _penalty(sign: str, classes: tuple[str, ...]) -> float:
    if sign == BIAS:
        return RIDGE["bias"]
    if sign.partition(": ")[2] in (*classes, SILENT):
        return RIDGE["class"]
    if sign.startswith(f"{GALLERY}: "):
        return RIDGE["gallery"]
    return RIDGE["rule" if sign.startswith("rule of ") else "sign"]


def rows_of(found: Weights) -> list[tuple[str, str, str]]:
    """Return weights as rows of the table: sign, class, weight."""
    rows = [(field, AGREES, f"{weight:.2f}") for field, weight in found.agreeing.items()]
    for sign in sorted(found.of_sign):
        pairs = zip(found.classes, found.of_sign[sign], strict=True)
        rows += [(sign, name, f"{weight:.2f}") for name, weight in pairs if abs(weight) >= LEAST]
    return rows


def tabled(found: Weights) -> Weights:
    """Return weights as the table holds them: rounded, without the smallest."""
    rows = tuple({"sign": sign, "class": name, "weight": weight} for sign, name, weight in rows_of(found))
    return read_weights(rows, found.classes)


def probabilities(found: Weights, items: Sequence[Item]) -> NDArray[np.float64]:
    """Return the probability of each class (columns) for each object (rows)."""
    scores = np.array([found.scores(signs_of(item, readings(item))) for item in items])
    return shares_of(scores)


def left_out(
    objects: Sequence[Labelled], museums: Sequence[str] = ()
) -> dict[str, tuple[list[Labelled], NDArray[np.float64]]]:
    """Return by museum its objects, and the probabilities of their classes by the weights of all other museums.

    museums : those that are left out one after the other; all where none is named
    """
    out = {}
    for museum in sorted(museums or {one.museum for one in objects}):
        mine = [one for one in objects if one.museum == museum]
        others = fit([one for one in objects if one.museum != museum])
        out[museum] = mine, probabilities(others, [one.item for one in mine])
    return out


def main() -> None:
    """Write the table of weights from files of labelled objects, whose paths are given."""
    objects = [one for path in sys.argv[1:] for one in read_labelled(Path(path))]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(("sign", "class", "weight"))
    writer.writerows(rows_of(fit(objects)))


if __name__ == "__main__":
    main()
