"""Classification by the table of rules, and the numbers a scene gets."""

from dataclasses import replace
from math import exp, hypot, log, pi
from typing import Any

import pytest

from pipeline.analysis.classify import NO_MODEL, WHEN_HELD, classify
from pipeline.analysis.footing import bearing_of
from pipeline.analysis.scene_parameters import material_of
from pipeline.analysis.survey import measurable_of, measurables
from pipeline.records import Furniture, Item, Origin, Support, times_too_thin
from pipeline.tables import Range, Row, table
from pipeline.tables.assumed import assumed, span
from pipeline.tables.fill_rows import fill_of
from pipeline.tables.usual_material_rows import usual_material
from tests import museum

VASE = Item("1", "G", title="Covered vase", classification="Ceramics", medium="porcelain",
            height_m=0.4, width_m=0.2, depth_m=0.2)  # fmt: skip


@pytest.fixture(scope="module")
def carnegie() -> dict[str, Item]:
    reading = museum.carnegie()
    return {item.object_number: item for item in reading.items}


@pytest.mark.parametrize(
    ("title", "classification", "medium", "expected"),
    [
        ("The Red Lantern", "paintings", "oil on canvas", "framed"),
        ("Chandelier", "lighting devices", "gilded bronze", "chandelier"),
        ("Lantern", "lighting devices", "brass", "chandelier"),
        ("Stone lantern", "", "granite", "statue"),
        ("Goblet", "Glass", "blown glass", "stemmed_glass"),
        ("Goblet", "Metals", "silver", "stemmed_glass"),  # the stem is what breaks, whatever it is made of
        ("Wall Drawing #450", "drawings and watercolors", "ink", "wall_painting"),
        ("Bust of a Woman", "sculpture", "marble", "bust"),
        ("Vase with bust of Homer", "Ceramics", "stoneware", "vessel"),
        ("Cheese", "crèches", "terracotta", "figurine"),
        ("Windsor armchair", "Wood", "maple", "seat"),
        ("Pier table", "Wood", "mahogany", "table"),
        ('Table spoon ("Fiddle")', "Metals", "silver", "small_flat"),
        ("Candlestick", "Metals", "brass", "lamp"),
        ("Plate", "Ceramics", "porcelain", "dish"),
        ("<script>alert(1)</script>", "", "", "object"),
        ("", "", "", "object"),
    ],
)
def test_rules(title: str, classification: str, medium: str, expected: str) -> None:
    """Hand-labelled: what a conservator would call the thing."""
    item = replace(VASE, title=title, classification=classification, medium=medium)
    assert classify(item).object_class == expected


@pytest.mark.parametrize(
    ("number", "expected"),
    [
        ("31.1.1.2", "seat"),  # Couch
        ("84.102", "seat"),  # Windsor armchair
        ("56.55.7.82", "figurine"),  # Jug of a crèche
        ("70.32.2510.A-B", "vessel"),  # Covered vase
    ],
)
def test_real_rows(carnegie: dict[str, Item], number: str, expected: str) -> None:
    assert classify(carnegie[number]).object_class == expected


def test_a_tall_marble_figure_is_checked_for_stress() -> None:
    figure = replace(
        VASE, title="Diana", classification="sculpture", medium="marble", height_m=1.8, width_m=0.6, depth_m=0.5
    )
    scene = classify(figure)
    assert scene.object_class == "standing_figure"
    assert scene.models == ("standing", "sliding", "stress", "flexible_stress")


HELD = {"mass_kg": 2.0, "section_width_m": 0.02, "base_width_m": 0.1, "base_depth_m": 0.1}


@pytest.mark.parametrize(
    ("title", "support", "recorded", "missing"),
    [
        # Before, each of these ended the night: classes.csv, mounted: column 'base_ratio' must be a number, not ''.
        # What a mount holds has no section that is known to be weak.
        ("Mask", Support.FASTENED, {}, ()),
        ("Mask", Support.FASTENED, HELD, ()),
        ("Mask", Support.FREESTANDING, {}, ()),
        ("Mask", Support.FREESTANDING, HELD, ()),
        ("Medal", Support.FREESTANDING, HELD, ()),
        # What a panel on its edge stands on is as deep as it is; of one without a depth nobody knows.
        ("Oil painting", Support.FREESTANDING, {"medium": "oil on canvas"}, ()),
        (
            "Oil painting",
            Support.FREESTANDING,
            {"medium": "oil on canvas", "depth_m": None},
            ("base width", "base depth"),
        ),
        ("Chandelier", Support.FASTENED, {"height_m": None}, ("width of its weakest section", "mass")),
        # A vessel's base and section follow from its size; what is made fast needs no base where its section is known.
        ("Vase", Support.FASTENED, {}, ()),
        ("Vase", Support.FASTENED, HELD | {"width_m": None, "depth_m": None}, ()),
        # A hollow section without its wall is not taken as solid; an unknown shape is not taken at all.
        ("Vase", Support.FASTENED, HELD | {"section_shape": "tube"}, ("wall of its weakest section",)),
        ("Mask", Support.FASTENED, HELD | {"section_shape": "star"}, ("width of its weakest section",)),
    ],
)
def test_what_a_class_does_not_assume_is_asked_for(
    title: str, support: Support, recorded: dict[str, Any], missing: tuple[str, ...]
) -> None:
    scene = classify(replace(VASE, title=title, classification="", support=support, **recorded))
    assert scene.missing == missing
    assert {measurable_of(words) for words in missing} <= {m.field for m in measurables()}


def test_what_is_part_of_the_building_stays_so() -> None:
    scene = classify(replace(VASE, title="Fresco", classification="", medium="", support=Support.FASTENED))
    assert scene.models == ()
    assert "part of the building" in scene.missing[0]


def test_every_assumed_number_is_named_and_has_a_range_and_a_source() -> None:
    scene = classify(VASE)
    for name, estimate in scene.parameters.items():
        assert estimate.low <= estimate.value <= estimate.high, name
        if estimate.origin is Origin.ASSUMED:
            assert estimate.note in scene.assumptions, name
            assert estimate.source, name
    assert any(text.startswith("support: freestanding, assumed") for text in scene.assumptions)


NAMED = {
    "framed": "oil painting", "relief": "relief", "chandelier": "chandelier", "stemmed_glass": "goblet",
    "standing_figure": "statue", "bust": "bust", "statue": "statue", "figurine": "figurine", "vessel": "vase",
    "dish": "plate", "lamp": "candlestick", "cabinet": "cabinet", "seat": "chair", "table": "table", "clock": "clock",
    "model": "architectural model", "object": "telephone",
}  # fmt: skip
"""A name for each class that has numbers, and so a way to it."""


@pytest.mark.parametrize("material", [row["material"] for row in table("materials")])
@pytest.mark.parametrize(
    "row", [r for r in table("classes") if r["models"] not in (NO_MODEL, WHEN_HELD)], ids=lambda r: str(r["class"])
)
def test_every_range_of_class_and_material_travels_to_the_models(row: Row, material: str) -> None:
    """Low, value and high of each cell, times the dimension that it is a share of, are those of the estimate."""
    stuff = next(r for r in table("materials") if r["material"] == material)
    tall = row["class"] in ("standing_figure", "statue")
    item = replace(
        VASE, title=NAMED[row["class"]], classification="Glass" if row["class"] == "stemmed_glass" else "", medium="",
        height_m=0.8 if tall else 0.3, width_m=0.3, depth_m=0.3, material=stuff["words"].partition("|")[0],
    )  # fmt: skip
    scene = classify(item)
    assert scene.object_class == row["class"] or tall  # which of the two it is, the material says
    row = next(r for r in table("classes") if r["class"] == scene.object_class)
    for name, estimate in scene.parameters.items():
        assert estimate.low <= estimate.value <= estimate.high, name
        assert estimate.source or estimate.origin is Origin.DERIVED, name
    found = scene.parameters
    ends = ("low", "value", "high")
    clearance = [float(row[c]) for c in ("clearance_low", "clearance", "clearance_high")]
    assert [getattr(found["clearance"], s) for s in ends] == clearance
    if row["support"] != "freestanding":
        assert {"length", "damping"} <= set(found)
        return
    shares = [item.height_m * float(row[c]) for c in ("cg_low", "cg_ratio", "cg_high")]  # type: ignore[operator]
    assert [getattr(found["cg_height"], s) for s in ends] == pytest.approx(shares)
    bears = bearing_of(item, row["class"])
    assert bears is not None
    # Base and share that bears have nothing to do with each other: their ends add up as squares, in the logarithm.
    based = [float(row[c]) for c in ("base_low", "base_ratio", "base_high")]
    pairs = ((based[0], bears.low), (based[2], bears.high))
    away = [hypot(log(base / based[1]), log(share / bears.share)) for base, share in pairs]
    half = 0.15 * based[1] * bears.share
    halves = [half * exp(-away[0]), half, half * exp(away[1])]
    assert [getattr(found["half_width"], s) for s in ends] == pytest.approx(halves)
    friction = span(assumed().friction_of(stuff["friction_as"], "", scene.furniture))
    assert [getattr(found["friction_static"], s) for s in ends] == [friction.low, friction.value, friction.high]
    tensile = [float(stuff[c]) for c in ("tensile_low", "tensile", "tensile_high")]
    assert [getattr(found["allowable_stress"], s) for s in ends] == tensile
    box = 0.3 * 0.3 * item.height_m * (pi / 4 if row["round"] == "yes" else 1.0)  # type: ignore[operator]
    weighs = [float(stuff[f"density{end}"]) for end in ("_low", "", "_high")]
    usual = usual_material(str(row["class"]), item.title, item.height_m or 0.0) if material == "unknown" else None
    if usual is not None:  # nobody recorded what it is made of
        weighs = [usual.density_low, usual.of.density, usual.density_high]
    made = stuff["material"] if usual is None else usual.material
    fill = fill_of(row["class"], made, item.height_m or 0.0) or Range(
        *(float(row[c]) for c in ("fill", "fill_low", "fill_high")), ""
    )
    masses = [box * share * density for share, density in zip((fill.low, fill.value, fill.high), weighs, strict=True)]
    assert [getattr(found["mass"], s) for s in ends] == pytest.approx(masses)


def test_what_the_museum_measured_wins_and_is_not_called_assumed() -> None:
    known = replace(
        VASE, support=Support.FREESTANDING, base_width_m=0.12, base_depth_m=0.10, cg_height_m=0.15, mass_kg=2.5,
        friction=0.3, clearance_m=0.2, allowable_stress_pa=2e7, section_shape="round", section_width_m=0.1,
        furniture=Furniture.FLOOR,
    )  # fmt: skip
    parameters = classify(known).parameters
    assert parameters["half_width"].value == pytest.approx(0.05)  # half of the narrower side
    assert parameters["cg_height"].value == 0.15
    assert parameters["friction_static"].value == 0.3
    assert parameters["clearance"].value == 0.2
    assert parameters["mass"].value == 2.5
    assert parameters["allowable_stress"].value == 2e7
    assert parameters["section_modulus"].value == pytest.approx(pi * 0.1**3 / 32)
    assert not classify(known).assumptions


def test_derived_numbers_follow_the_table_of_classes() -> None:
    """vessel: base 0.6 of the width, of which 0.92 bears, centre of gravity at 0.45 of the height (tables)."""
    parameters = classify(VASE).parameters
    assert parameters["half_width"].value == pytest.approx(0.5 * 0.6 * 0.92 * 0.2)
    least = exp(-hypot(log(0.6 / 0.32), log(0.92 / 0.7)))
    assert parameters["half_width"].low == pytest.approx(0.5 * 0.6 * 0.92 * 0.2 * least)
    assert parameters["cg_height"].value == pytest.approx(0.45 * 0.4)


@pytest.mark.parametrize(
    ("change", "missing"),
    [
        (dict.fromkeys(("height_m", "width_m", "depth_m")), ("height", "width (or diameter)")),
        ({"title": "Landscape", "classification": "paintings", "height_m": None}, ()),
        (
            {"title": "Landscape", "classification": "paintings", "height_m": None, "width_m": None, "depth_m": None},
            ("height or suspension length",),
        ),
        # Of what is only known to stand one size says nothing of the others.
        (
            {"title": "Thing", "classification": "", "medium": "", "width_m": None, "depth_m": None},
            ("width (or diameter)",),
        ),
    ],
)
def test_what_is_missing_is_named(change: dict[str, object], missing: tuple[str, ...]) -> None:
    assert classify(replace(VASE, **change)).missing == missing  # type: ignore[arg-type]


def test_a_round_thing_with_one_width_is_taken_as_round_and_says_so() -> None:
    scene = classify(replace(VASE, depth_m=None))
    assert scene.missing == ()
    assert any("depth not recorded: taken as round" in text for text in scene.assumptions)


def test_a_sheet_does_not_stand() -> None:
    scene = classify(replace(VASE, title="Dancer", classification="figurines", height_m=0.5, width_m=0.3, depth_m=0.02))
    assert len(scene.missing) == 1
    assert scene.missing[0].startswith("support (it is 25 times as high as it is deep")
    assert times_too_thin(scene.missing[0]) == 25
    assert [times_too_thin(text) for text in ("support", scene.missing[0][:-1], "25", "height")] == [None] * 4


def test_a_recorded_support_changes_the_models() -> None:
    assert classify(replace(VASE, support=Support.FASTENED)).models == ("stress", "flexible_stress")
    assert classify(replace(VASE, support=Support.HUNG)).models == ("swing", "unhooking", "hanger_load")


def test_the_material_is_the_word_that_stands_first() -> None:
    assert material_of(replace(VASE, medium="marble on a bronze base")).name == "marble"
    assert material_of(replace(VASE, medium="bronze on a marble base")).name == "bronze"
    assert material_of(replace(VASE, medium="mixed media")).name == "unknown"
    assert material_of(replace(VASE, medium="oil on masonite")).name == "unknown"  # no "stone" inside a word
