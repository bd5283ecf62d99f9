"""Names of things in the vocabularies that museums and thesauri made, by the name alone.

Truth: tests/data/collections/vocabularies.csv, marked before any of the names was read (README.md there).
"""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.evidence import UNNAMED_SURE
from pipeline.records import Item
from pipeline.tables import table
from pipeline.verification.class_scores import MANNER

NAMES = Path(__file__).parents[1] / "data" / "collections" / "vocabularies.csv"
SURE = 0.8
REACHED = {
    "amcr": (0.78, 0.81),
    "fish": (0.80, 0.84),
    "fish unseen": (0.76, 0.78),
    "indianapolis": (0.86, 0.93),
    "rijksmuseum": (0.77, 0.80),
    "smithsonian": (0.81, 0.82),
    "weltmuseum wien": (0.88, 0.90),
}
"""Share of the names with the right class and manner of support, one name of each less than reached: less is a loss."""


def _taken(name: str, **sizes: float) -> tuple[str, float]:
    """Return the class that a thing with nothing but a name is taken for, and its probability."""
    scene = classify(Item("1", "Room", object_name=name, **sizes))  # type: ignore[arg-type]
    return scene.object_class, dict(scene.chances).get(scene.object_class, 0.0)


def test_names_of_seven_vocabularies() -> None:
    """What is wrong is said: of all names at most 4 % are wrong and said to be 80 % sure, of those at 90 % at most 3 %.

    By the works of the Rijksmuseum that have each name, 98 % are right.
    """
    found: dict[str, list[tuple[bool, bool, float, int]]] = defaultdict(list)
    with NAMES.open(encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            taken, chance = _taken(row["name"])
            able = row["classes"].split("|")
            manner = MANNER[taken] in {MANNER[one] for one in able}
            found[row["source"]].append((taken in able, manner, chance, int(row["works"])))
    for source, (classes, manners) in REACHED.items():
        rows = found[source]
        assert sum(right for right, _, _, _ in rows) / len(rows) >= classes, source
        assert sum(manner for _, manner, _, _ in rows) / len(rows) >= manners, source
    every = [row for rows in found.values() for row in rows]
    assert sum(not right and chance >= SURE for right, _, chance, _ in every) / len(every) <= 0.04
    sure = [right for right, _, chance, _ in every if chance >= 0.9]
    assert sure.count(False) / len(sure) <= 0.03
    works = [(right, many) for right, _, _, many in found["rijksmuseum"]]
    assert sum(many for right, many in works if right) / sum(many for _, many in works) >= 0.98


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("lantern slide", "small_flat"),
        ("tide table", "framed"),
        ("needle making machine", "object"),
        ("boxes {containers}", "cabinet"),
        ("pin (fastener)", "small_flat"),
        ("vase, miniature", "vessel"),
        ("Dinner service (soup bowl)", "dish"),
        ("Dinner service (bread and butter plate)", "dish"),
        ("织布机", "object"),
        ("Kopfbedeckung", "mounted"),
        ("leveäliekkinen öljylamppu", "lamp"),
    ],
)
def test_names_by_their_head(name: str, taken: str) -> None:
    assert _taken(name)[0] == taken


@pytest.mark.parametrize(
    "name",
    ["lantern zorblax", "needle zorblaxing apparatix", "Sledge (hammer)", "zorblax, galvanometer", "zorblax (vase)"],
)
def test_a_name_half_known_is_not_sure(name: str) -> None:
    """What stands behind the known word may be the thing: a lantern slide is no lantern."""
    assert _taken(name)[1] < SURE


@pytest.mark.parametrize(
    ("bare", "adorned"),
    [("vaso", "vaso etrusco"), ("masque", "masque funéraire"), ("lampa", "lampa naftova"), ("chair", "chair II")],
)
def test_adjectives_behind_a_noun_take_nothing_from_it(bare: str, adorned: str) -> None:
    assert _taken(adorned)[0] == _taken(bare)[0]
    assert _taken(adorned)[1] >= _taken(bare)[1] - 0.1


def test_a_name_that_nobody_knows_has_the_chances_of_such_names() -> None:
    """They are those of unknown_names.csv but for the floor of all classes; what may stand is held to stand."""
    shares = {row["class"]: float(row["share"]) for row in table("unknown_names")}
    assert sum(shares.values()) == pytest.approx(1.0, abs=0.01)
    scene = classify(Item("1", "Room", object_name="zorblax"))
    assert scene.object_class == "object"
    for name, chance in scene.chances:
        if name != "object":
            assert chance == pytest.approx(shares[name], abs=0.02)
    small = classify(Item("1", "Room", object_name="zorblax", height_m=0.05, width_m=0.03))
    assert small.object_class == "small_flat"
    assert small.chances[0][1] >= UNNAMED_SURE
    assert _taken("zorblax", height_m=0.3, width_m=0.2, depth_m=0.2)[0] == "object"
