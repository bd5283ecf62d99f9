"""The class of an object and its probability: museums left out, what may never happen, and odd input."""

from __future__ import annotations

import csv
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from pipeline.analysis.classify import classify
from pipeline.analysis.evidence import IDENTIFIED, chances_of, is_alone, weights
from pipeline.analysis.rule_table import with_own
from pipeline.analysis.rules import readings
from pipeline.records import Item
from pipeline.tables import table
from pipeline.verification.class_fit import CLASSES, Labelled, fit, labelled_of, left_out, probabilities, tabled
from tests.soak import SOAK

FILE = Path(__file__).parents[1] / "data" / "collections" / "labelled_classes.csv"
OTHERS = FILE.with_name("other_museums.csv")
MUSEUMS = ("carnegie", "met", "moma", "williams")
HELD = ("small_flat", "mounted")
SUPPORT = {row["class"]: "held" if row["class"] in HELD else row["support"] for row in table("classes")}
SUPPORT["installation"] = "none"


@cache
def rows() -> tuple[tuple[dict[str, str], Labelled], ...]:
    with FILE.open(encoding="utf-8", newline="") as stream:
        return tuple((row, labelled_of(row)) for row in csv.DictReader(stream) if row["collection"] in MUSEUMS)


LEFT_OUT = MUSEUMS if SOAK else MUSEUMS[:1]
"""Museums that are left out, one after the other: every day that of most objects, of which the bounds hold as well."""


@cache
def unseen() -> tuple[list[Labelled], NDArray[np.float64]]:
    """The objects, each with the probabilities by the weights of the three other museums."""
    found = left_out([one for _, one in rows()], LEFT_OUT)
    return [one for mine, _ in found.values() for one in mine], np.concatenate([p for _, p in found.values()])


def drawn(one: Labelled) -> str:
    by_number = {(row["collection"], row["object_number"]): row["drawn"] for row, _ in rows()}
    return by_number[one.museum, one.item.object_number]


@pytest.mark.long("test_museums_that_were_labelled_before_they_were_read")
def test_a_museum_that_was_left_out() -> None:
    """Of the simple random sample of each museum: class right in 97 %, manner of support in 97 %.

    The bounds are 2 % lower, which is twice the standard error of 97 % of 600 objects and a little.
    """
    objects, found = unseen()
    plain = [at for at, one in enumerate(objects) if drawn(one) == "plain"]
    assert len(plain) == (600 if SOAK else 200)
    taken = [CLASSES[at] for at in found.argmax(axis=1)]
    assert np.mean([taken[at] == objects[at].object_class for at in plain]) >= 0.95
    assert np.mean([SUPPORT[taken[at]] == SUPPORT[objects[at].object_class] for at in plain]) >= 0.955


@pytest.mark.long("test_museums_that_were_labelled_before_they_were_read")
def test_hard_objects_of_a_museum_that_was_left_out() -> None:
    """Of all draws, in which solid and rare things are many times as frequent as in life: 90 % and 94 %."""
    objects, found = unseen()
    taken = [CLASSES[at] for at in found.argmax(axis=1)]
    pairs = [(a, one.object_class) for a, one in zip(taken, objects, strict=True)]
    assert np.mean([a == b for a, b in pairs]) >= 0.88
    assert np.mean([SUPPORT[a] == SUPPORT[b] for a, b in pairs]) >= 0.92


@pytest.mark.long("test_museums_that_were_labelled_before_they_were_read")
def test_where_it_says_ninety_percent_it_is_right_in_ninety() -> None:
    """Calibration on museums left out: of those said to be as likely as that, as many are right, within 4 %."""
    objects, found = unseen()
    sure = found.max(axis=1)
    right = np.array([CLASSES[at] for at in found.argmax(axis=1)]) == [one.object_class for one in objects]
    for low, high in ((0.85, 0.97), (0.9, 1.01), (0.97, 1.01)):
        some = (sure >= low) & (sure < high)
        assert some.sum() > 100
        assert np.mean(right[some]) >= np.mean(sure[some]) - 0.04, (low, high)


@pytest.mark.long("test_museums_that_were_labelled_before_they_were_read")
def test_no_museum_is_sure_where_it_is_wrong() -> None:
    """Of each museum left out by itself, at least 90 % of those said to be as likely as that."""
    objects, found = unseen()
    for museum in LEFT_OUT:
        at = [k for k, one in enumerate(objects) if one.museum == museum and found[k].max() >= 0.9]
        assert len(at) > 100
        right = np.mean([CLASSES[found[k].argmax()] == objects[k].object_class for k in at])
        assert right >= 0.9, (museum, right)


def test_the_table_of_weights_is_what_the_labels_give() -> None:
    """Fitted anew: the same class for all but a few objects, and the same probability but for rounding."""
    with FILE.open(encoding="utf-8", newline="") as stream:
        everything = [labelled_of(row) for row in csv.DictReader(stream)]
    items = [one.item for one in everything]
    anew, stored = probabilities(tabled(fit(everything)), items), probabilities(weights(), items)
    assert np.mean(anew.argmax(axis=1) == stored.argmax(axis=1)) >= 0.995
    assert np.quantile(np.abs(anew - stored), 0.999) < 0.05


def classed(item: Item) -> bool:
    return item.classification not in ("", "(not assigned)") or bool(item.object_name)


def test_flat_works_do_not_become_standing_things() -> None:
    """Below 1 in 500, those with a vessel or a chair in their title (`trap`) among them."""
    flat = [one.item for _, one in rows() if one.object_class == "framed" and (one.item.medium or classed(one.item))]
    standing = ("freestanding",)
    wrong = [item.title for item in flat if SUPPORT[classify(item).object_class] in standing]
    assert len(flat) > 500
    assert len(wrong) / len(flat) < 1 / 500, wrong


def test_flat_works_stay_flat_where_only_their_technique_says_so() -> None:
    """Without classification and object name: the medium decides before the title."""
    flat = [one.item for _, one in rows() if one.object_class == "framed" and one.item.medium]
    bare = [replace(item, classification="", object_name="") for item in flat]
    wrong = [(i.title, i.medium) for i in bare if SUPPORT[classify(i).object_class] == "freestanding"]
    assert len(wrong) / len(bare) < 0.05, wrong


@pytest.mark.parametrize(
    ("record", "expected"),
    [
        ({"title": "Whaler and Fishing Vessels", "medium": "Oil on canvas"}, {"framed"}),
        ({"title": "Chair", "medium": "gelatin silver print", "height_m": 0.2, "width_m": 0.25}, {"framed"}),
        ({"title": "Der Stuhl", "medium": "Öl auf Leinwand"}, {"framed"}),
        ({"title": "Le vase bleu", "medium": "huile sur toile"}, {"framed"}),
        ({"title": "Vaso di fiori", "medium": "olio su tela"}, {"framed"}),
        ({"title": "Vaso di fiori", "object_name": "dipinto"}, {"framed"}),
        ({"object_name": "Red-figure vase", "medium": "terracotta", "height_m": 0.4}, {"vessel"}),
        ({"title": "Terracotta neck-amphora (jar)", "classification": "Vases", "medium": "Terracotta"}, {"vessel"}),
        ({"object_name": "Icon leaf", "medium": "tempera on wood", "height_m": 0.3}, {"small_flat", "framed"}),
        ({"object_name": "Pectoral cross", "medium": "gold, enamel"}, {"small_flat"}),
        ({"object_name": "Coffin board", "medium": "wood", "height_m": 1.8, "width_m": 0.4}, {"mounted", "relief"}),
        ({"object_name": "Appliqué", "medium": "silver", "height_m": 0.05, "width_m": 0.04}, {"small_flat"}),
        ({"object_name": "Tablet", "medium": "clay", "height_m": 0.1, "width_m": 0.06}, {"small_flat"}),
        ({"object_name": "Coin", "medium": "gold"}, {"small_flat"}),
        ({"object_name": "Fibula", "medium": "bronz"}, {"small_flat"}),
        ({"title": "Book of Hours", "classification": "Manuscripts", "medium": "ink on vellum"}, {"small_flat"}),
        ({"object_name": "Longcase clock", "medium": "walnut", "height_m": 2.2}, {"clock"}),
        ({"object_name": "lustre", "medium": "cristal"}, {"chandelier"}),
        ({"object_name": "Violine", "medium": "Fichte, Ahorn"}, {"mounted"}),
        ({"title": "Ship model, HMS Victory", "medium": "wood"}, {"model"}),
        ({"object_name": "dulap", "medium": "lemn"}, {"cabinet"}),
        ({"object_name": "montre de poche", "medium": "or"}, {"small_flat"}),
        ({"object_name": "Clock Model No. 101", "medium": "plastic"}, {"clock"}),
        ({"title": "Jar (lid)", "medium": "carved wood"}, {"small_flat"}),
        ({"object_name": "teapot", "title": "Harlequin", "medium": "bone china"}, {"vessel"}),
        ({"title": "Untitled", "gallery": "Photography", "medium": "", "height_m": 0.2, "width_m": 0.25}, {"framed"}),
        ({"title": "志野茶碗", "medium": "陶器", "height_m": 0.09}, {"vessel"}),
        ({"title": "松林図屏風", "classification": "絵画"}, {"object", "framed"}),
        ({"title": "秋冬山水図", "medium": "紙本墨画"}, {"framed"}),
        ({"object_name": "能面", "medium": "木造彩色", "height_m": 0.21}, {"mounted"}),
        ({"object_name": "theepot", "medium": "porselein"}, {"vessel"}),
        ({"object_name": "Cómoda", "classification": "Mobiliário"}, {"cabinet"}),
        ({"object_name": "arqueta", "medium": "plata"}, {"cabinet"}),
        ({"object_name": "Gewandspange", "medium": "Bronze"}, {"small_flat"}),
        (
            {"title": "John Beatty Memorial", "classification": "sculpture", "medium": "marble", "height_m": 0.72,
             "width_m": 1.56, "depth_m": 0.12},
            {"relief", "mounted"},
        ),
    ],
)  # fmt: skip
def test_what_things_are(record: dict[str, object], expected: set[str]) -> None:
    """Hand-labelled: what a conservator would call the thing, in words that the labels do not have."""
    assert classify(Item("1", **({"gallery": "G"} | record))).object_class in expected  # type: ignore[arg-type]


def test_museums_that_were_labelled_before_they_were_read() -> None:
    """Of 271 records of other museums in nine languages: at least 87 % and 91 %, by words that were added afterwards.

    That is 3 % below what is reached, near twice the standard error. No weight is found from these records.
    """
    with OTHERS.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    items = [(row["class"], labelled_of(row).item) for row in rows]
    pairs = [(right, classify(item).object_class) for right, item in items if not is_alone(item, readings(item))]
    assert len(pairs) > 240
    assert np.mean([right == taken for right, taken in pairs]) >= 0.87
    assert np.mean([SUPPORT[right] == SUPPORT[taken] for right, taken in pairs]) >= 0.91
    bare = [(right, classify(item)) for right, item in items if is_alone(item, readings(item)) and item.title]
    assert len(bare) > 10
    wrong = [scene for right, scene in bare if scene.object_class != right]
    assert all("title alone" in scene.rule or scene.next_class for scene in wrong)


@cache
def by_title_alone() -> list[tuple[str, Item, Item]]:
    """Labelled objects of four museums with all but title and sizes blanked, and then with no sizes either."""
    nothing = dict.fromkeys(("object_name", "classification", "medium", "gallery"), "")
    less = [(one.object_class, replace(one.item, **nothing)) for _, one in rows() if one.item.title]  # type: ignore[arg-type]
    return [(right, item, replace(item, height_m=None, width_m=None, depth_m=None)) for right, item in less]


def test_flat_works_known_by_their_title_alone_do_not_stand() -> None:
    """Of 623 flat works, of which 168 have a vessel, a chair and the like in their title: 1 in 500, sized or not.

    With the depth of a frame beside a title that names a thing, a few more stand: not 1 in 100. Of a title that names
    nothing and no size nothing is claimed: that is an object whose class and sizes are asked for.
    """
    flat = [(sized, bare) for right, sized, bare in by_title_alone() if right == "framed"]
    assert len(flat) > 600

    def stands(item: Item) -> bool:
        scene = classify(item)
        asked = scene.object_class == "object" and scene.missing
        return SUPPORT[scene.object_class] == "freestanding" and not asked

    bare = [item.title for _, item in flat if stands(item)]
    assert len(bare) / len(flat) <= 1 / 500, bare
    sized = [item.title for item, _ in flat if stands(item)]
    assert len(sized) / len(flat) < 1 / 100, sized


@pytest.mark.parametrize(
    ("title", "sizes", "expected"),
    [
        ("Whaler and Fishing Vessels", {"height_m": 0.5, "width_m": 0.7}, {"framed"}),
        ("Still Life with Vase", {"height_m": 0.5, "width_m": 0.4}, {"framed"}),
        ("Der blaue Stuhl", {}, {"framed"}),
        ("La tasse de chocolat", {"height_m": 0.46, "width_m": 0.38}, {"framed"}),
        ("Natura morta con bottiglia", {}, {"framed"}),
        ("Vase", {"height_m": 0.3, "width_m": 0.2, "depth_m": 0.2}, {"vessel"}),
        ("Armchair", {"height_m": 0.9, "width_m": 0.6, "depth_m": 0.6}, {"seat"}),
    ],
)
def test_a_title_alone(title: str, sizes: dict[str, float], expected: set[str]) -> None:
    """By title alone a picture stays possible, and is taken where no depth speaks against it; the record says so."""
    scene = classify(Item("1", "G", title=title, **sizes))
    assert scene.object_class in expected
    assert scene.chances[0][1] < 0.999


def test_chances_add_up_to_one_and_the_class_is_the_likeliest() -> None:
    for _, one in rows()[:300]:
        chances = chances_of(one.item, readings(one.item))
        assert sum(c.probability for c in chances) == pytest.approx(1.0)
        assert [c.probability for c in chances] == sorted((c.probability for c in chances), reverse=True)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param("x" * (1_000_000 if SOAK else 100_000), marks=pytest.mark.long("test_odd_texts_are_read")),
        "a " * (100_000 if SOAK else 20_000),
        "\x00\ud7ff\u202e\u0301" * 50,
        "花瓶",
        "((((((",
        ": : :",
        "says so",
        "\\b|*",
        "%s{}",
    ],
)
def test_odd_texts_are_read(text: str) -> None:
    for name in ("title", "object_name", "classification", "medium"):
        scene = classify(Item("1", "G", **{name: text}))  # type: ignore[arg-type]
        assert scene.object_class in CLASSES


def test_sizes_that_cannot_be_are_no_fault() -> None:
    for height, width, depth in ((0.0, 0.0, 0.0), (1e-9, 1e4, None), (None, 0.0, 1.0)):
        assert classify(Item("1", "G", title="vase", height_m=height, width_m=width, depth_m=depth)).object_class


def test_own_rules_and_identifiers_decide_outright(tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_text(
        "rule,class,aat,classification,words,medium,shape,why\nours,statue,,,vessels,,,so we call it\n",
        encoding="utf-8",
    )
    painting = Item("1", "G", title="Whaler and Fishing Vessels", object_name="vessels", medium="oil on canvas")
    scene = classify(painting, with_own(own))
    assert (scene.object_class, scene.chances) == ("statue", (("statue", 1.0),))
    named = classify(Item("1", "G", title="chair", aat="300132254"))
    assert (named.object_class, named.chances) == ("vessel", (("vessel", IDENTIFIED),))


def test_a_person_decides_outright() -> None:
    scene = classify(Item("1", "G", title="vase"), decided=("bust", "Ann"))
    assert (scene.object_class, scene.chances, scene.next_class) == ("bust", (), None)


def test_another_class_that_would_be_computed_otherwise_is_told() -> None:
    """A lantern stands or hangs: the record does not say, and what is computed differs."""
    told = [
        text
        for _, one in rows()[:: 1 if SOAK else 4]
        for text in classify(one.item).assumptions
        if text.startswith("its class is not certain")
    ]
    assert told
    assert all("say what it is" in text for text in told)


def test_a_record_that_names_no_class_says_so_and_its_chances_add_up() -> None:
    """What is left is taken, with the chance that the classes leave that are likely; both are said."""
    scene = classify(Item("1", "G", title="Minikitchen", medium="aluminum, steel", height_m=0.889, width_m=1.143))
    assert scene.object_class == "object"
    assert "its record names no class" in scene.rule
    assert sum(chance for _, chance in scene.chances) == pytest.approx(1.0)
    assert dict(scene.chances)["object"] > 0.0
    assert scene.next_class is not None
    bare = classify(Item("1", "G"))
    assert (bare.object_class, bare.chances) == ("object", ())
    assert "its record names no class" in bare.rule
