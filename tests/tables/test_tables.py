"""The tables: they parse, their ranges are in order, their sources are named, and the paper's are the paper's."""

from __future__ import annotations

import csv

import pytest

from pipeline.analysis.classify import NO_MODEL, WHEN_HELD, classify
from pipeline.models import MODELS, model_named
from pipeline.quantities import Quantity
from pipeline.records import ITEM_FIELDS, Support
from pipeline.supports import SUPPORTS
from pipeline.tables import FOLDER, table
from pipeline.tables.assumed import assumed, span
from tests.museum import PAINTING

NAMES = sorted(path.stem for path in FOLDER.glob("*.csv"))

TABLE_1 = [
    ("Rigid", "Rocking"),
    ("Rigid", "Sliding"),
    ("Rigid", "Stress, static"),
    ("Flexible", "2-D, swinging"),
    ("Flexible", "3-D, swinging"),
    ("Flexible", "Stress, dynamic"),
]
TABLE_2 = [
    ("Isolator, friction", "Low friction interface"),
    ("Isolator, horizontal", "Coulomb friction & viscous damping"),
    ("Isolator, rotational", "Damped oscillator"),
]
# Surface materials as printed (the registered-trade-mark signs apart), the coefficient as printed, and whether the
# asterisk ("Data from JPGM") is there.
TABLE_3 = [
    ("Aluminum on terrazzo", "0.20", True),
    ("Marble on terrazzo", "0.15", True),
    ("Teflon on terrazzo", "0.20", True),
    ("Aluminum on Formica", "0.12", True),
    ("Marble on Formica", "0.18", True),
    ("Teflon on Formica", "0.13", True),
    ("Aluminum on mosaic", "0.20", True),
    ("Marble on mosaic", "0.13", True),
    ("Teflon on mosaic", "0.10", True),
    ("Aluminum on aluminum", "0.24", False),
    ("Aluminum on plywood", "0.37", False),
    ("Aluminum on coarse sandpaper", "0.52", False),
    ("Aluminum on Teflon", "0.23", False),
]
TABLE_4 = [("Paint", "Wood", "0.02"), ("Paint", "Rubber pads", "0.06"), ("Cloth", "Rubber pads", "0.13")]


def test_there_is_every_table() -> None:
    assert {
        "friction",
        "damping",
        "materials",
        "isolators",
        "classes",
        "rules",
        "measures",
        "fixings",
        "furniture",
        "usual_furniture",
    } <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_every_table_parses_and_has_no_row_twice(name: str) -> None:
    rows = table(name)
    assert rows
    assert all(cell == cell.strip() for row in rows for cell in row.values())
    assert len({tuple(row.values()) for row in rows}) == len(rows)
    with (FOLDER / f"{name}.csv").open(encoding="utf-8", newline="") as stream:
        header = next(csv.reader(stream))
    assert len(set(header)) == len(header)
    assert list(rows[0]) == header


@pytest.mark.parametrize("name", NAMES)
def test_every_row_says_where_it_comes_from(name: str) -> None:
    """A source, or the reason why (rules, classes and plausible limits are Kouros's own); what is fitted has none."""
    if name == "class_weights":
        pytest.skip("fitted: tests/analysis/test_evidence.py finds it again from the labelled objects")
    for row in table(name):
        column = next(c for c in ("source", "why", "reason") if c in row)
        assert len(row[column]) > 5, row


@pytest.mark.parametrize("name", NAMES)
def test_every_range_is_in_order(name: str) -> None:
    """low <= value <= high, wherever a table has the three columns; all or none of them are filled."""
    for row in table(name):
        for low in (c for c in row if c == "low" or c.endswith("_low")):
            stem = low.removesuffix("low").rstrip("_")
            high = f"{stem}_high" if stem else "high"
            value = stem + "_ratio" if stem + "_ratio" in row else (stem or "value")
            if value not in row:
                assert float(row[low]) < float(row[high]), row
                continue
            cells = [row[low], row[value], row[high]]
            if any(cells):
                assert float(row[low]) <= float(row[value]) <= float(row[high]), row


# Medians [g, of cabinets m/s] and dispersions as published, by the number of the component: FEMA P-58 (2018),
# fragility database v3.1.2, as in DamageAndLossModelLibrary of NHERI SimCenter (seismic/building/component/
# FEMA P-58 2nd Edition/fragility.csv).
P_58 = {
    "E2022.010": (0.40, 0.6),
    "E2022.011": (1.00, 0.5),
    "E2022.012": (0.60, 0.6),
    "E2022.013": (0.25, 0.5),
    "E2022.102a": (0.724, 0.5),
    "E2022.103a": (0.493, 0.5),
    "E2022.104a": (0.361, 0.5),
    "E2022.105a": (0.29, 0.5),
    "E2022.106a": (0.251, 0.5),
    "E2022.112a": (1.229, 0.5),
    "E2022.114a": (0.498, 0.5),
    "E2022.124a": (0.688, 0.5),
    "E2022.125a": (0.526, 0.5),
}


def test_fragilities_are_those_of_p_58() -> None:
    told = {
        row["source"].partition("v3.1.2, ")[2].partition(":")[0]: (float(row["median"]), float(row["dispersion"]))
        for row in table("fragility")
    }
    assert told == P_58
    velocities = {row["source"].partition(":")[0][-10:] for row in table("fragility") if row["unit"] == "m/s"}
    assert velocities == {name for name in P_58 if name.endswith("a")}


def test_table_1_and_2_of_the_paper() -> None:
    listed = {model.name: model.listed for model in MODELS if model.listed}
    printed = [(1, *row) for row in TABLE_1] + [(2, *row) for row in TABLE_2]
    assert sorted(listed.values()) == sorted(f"Table {at}, {kind}: {response}" for at, kind, response in printed)
    for name, where in listed.items():
        assert where.partition(", ")[2].lower().startswith(model_named(name).kind)
    assert set(listed) == {m.name for m in MODELS} - {
        "oscillator",
        "standing",
        "unanchored",
        "unhooking",
        "hanger_load",
    }


def test_table_3_of_the_paper() -> None:
    """Word for word and number for number, in the paper's order; the starred rows say that they are JPGM data."""
    rows = [row for row in table("friction") if row["source"].startswith("Agbabian")]
    assert len(rows) == len(TABLE_3)
    for row, (words, value, starred) in zip(rows, TABLE_3, strict=True):
        said = f"{row['object_material']} on {row['surface_material']}"
        assert said.lower() == words.lower()
        assert row["value"] == value
        assert ("JPGM" in row["source"]) is starred
        assert "Table 3" in row["source"]


def test_table_4_of_the_paper() -> None:
    rows = [(r["wall_surface"], r["back_surface"], r["value"]) for r in table("damping")]
    assert rows == TABLE_4
    assert all("Table 4" in r["source"] for r in table("damping"))


@pytest.mark.parametrize(("words", "value", "_starred"), TABLE_3)
def test_a_pair_of_table_3_is_looked_up(words: str, value: str, _starred: bool) -> None:
    """A known pair has its printed value and no span, whatever its capitals."""
    first, second = words.upper().split(" ON ")
    found = span(assumed().friction_of(first, second))
    assert (found.value, found.low, found.high) == (float(value), float(value), float(value))


def test_an_unknown_pair_spans_what_is_not_ruled_out() -> None:
    """Marble: from polished floors of the paper to sawn stone on concrete, felt not counting."""
    marble = span(assumed().friction_of("marble"))
    assert (marble.low, marble.high) == (0.12, 0.90)
    anything = span(assumed().friction_of())
    assert (anything.low, anything.high) == (0.12, 1.00)
    mosaic = span(assumed().friction_of("", "mosaic"))
    assert (mosaic.low, mosaic.high) == (0.13, 0.20)
    assert span(assumed().friction_of("unobtainium", "plywood")).value == 0.37


@pytest.mark.parametrize("material", ["Glass", "Ceramic", "Wood", "Marble", "Aluminum"])
def test_felt_is_put_under_an_object_on_purpose(material: str) -> None:
    """So that it does not count where nothing is known of the surface, and does where it is named."""
    felt = span(assumed().friction_of(material, "felt"))
    assert felt.low < felt.value < felt.high
    assert "felt" not in {row.surface_material.lower() for row in assumed().friction_of(material)}


def test_what_is_judgement_has_a_range() -> None:
    """Of friction a factor of two and more; a number that was measured may have none."""
    for row in table("friction"):
        if "judgement" in row["source"]:
            assert float(row["high"]) >= 2.0 * float(row["low"]), row
    for row in table("classes"):
        for kind in ("base", "section", "fill", "clearance"):
            if row["source"] == "judgement" and row[f"{kind}_low"]:
                assert float(row[f"{kind}_high"]) > float(row[f"{kind}_low"]), row


def test_gold_and_wood_across_the_grain() -> None:
    """19,300 kg/m3 for fine gold; across the grain wood bears 2 MPa (USDA Wood Handbook 2010, Table 5-3)."""
    rows = {row["material"]: row for row in table("materials")}
    assert float(rows["gold"]["density_high"]) == 19300
    assert "gold" not in rows["silver"]["words"].split("|")
    assert float(rows["silver"]["density_high"]) < float(rows["gold"]["density"])
    assert float(rows["wood"]["tensile_low"]) == 2e6
    assert "Wood Handbook" in rows["wood"]["source"]


def test_damping_that_is_not_known_is_the_lowest() -> None:
    unknown = classify(PAINTING).parameters["damping"]
    assert (unknown.low, unknown.value, unknown.high) == (0.02, 0.02, 0.13)
    assert span(assumed().damping_of("Cloth", "Rubber pads")).value == 0.13
    assert span(assumed().damping_of("paint", "rubber pads")).value == 0.06


def test_a_pair_that_the_table_lacks_is_not_given_another_walls_damping_as_certain() -> None:
    """Cloth and wood is not in Table 4: the answer must span more than one printed value, or name the one known."""
    found = span(assumed().damping_of("Cloth", "Wood"))
    assert found.low < found.high or found.value == 0.02


def test_rules_name_classes_and_classes_name_models() -> None:
    classes = {r["class"]: r for r in table("classes")}
    assert len(classes) == len(table("classes"))
    rules = table("rules")
    assert len({r["rule"] for r in rules}) == len(rules)
    for rule in rules:
        assert rule["class"] in classes, rule
    assert set(classes) == {r["class"] for r in rules}
    names = {m.name for m in MODELS} | {NO_MODEL, WHEN_HELD}
    for row in classes.values():
        assert set(row["models"].split("|")) <= names, row
        assert row["support"] in {s.value for s in Support}
        assert row["round"] in ("yes", "no")


def test_every_class_with_numbers_says_who_says_so() -> None:
    for row in table("classes"):
        numbers = [row[c] for c in row if c.endswith(("_ratio", "_low", "_high"))]
        assert any(numbers), row
        assert row["source"], row
        if row["models"] == WHEN_HELD:
            assert all(row[f"{kind}_{end}"] for kind in ("cg", "base", "fill") for end in ("low", "high")), row
        elif row["models"] == NO_MODEL:
            assert "nothing is assumed of base, section and mass" in row["source"]
        elif row["support"] == "freestanding":
            kinds = ("cg", "base", "section", "fill", "clearance")
            assert all(row[f"{kind}_{end}"] for kind in kinds for end in ("low", "high")), row


def test_the_last_rule_takes_whatever_is_left() -> None:
    last = table("rules")[-1]
    assert not any(last[c] for c in ("aat", "classification", "words", "medium", "shape"))
    assert all(any(r[c] for c in ("aat", "classification", "words", "medium", "shape")) for r in table("rules")[:-1])


def test_isolators_are_within_the_limits_of_their_models() -> None:
    supports = {s.name: s.model for s in SUPPORTS}
    for row in table("isolators"):
        needs: dict[str, Quantity] = {q.name: q for q in supports[row["kind"]].needs}
        for column in ("frequency", "damping", "friction"):
            if row[column]:
                value = float(row[column])
                # The friction of a low-friction pad is its static one.
                limits = needs.get(column) or needs["friction_static"]
                assert limits.low <= value <= limits.high


def test_horizontal_isolators_are_those_of_figure_6() -> None:
    """2 % damping and friction 0.05 to 0.20."""
    rows = [r for r in table("isolators") if r["kind"] == "horizontal_isolator"]
    assert {r["damping"] for r in rows} == {"0.02"}
    assert {float(r["friction"]) for r in rows} <= {0.05, 0.10, 0.15, 0.20}


def test_materials_refer_to_the_rows_of_table_3() -> None:
    objects = {r["object_material"] for r in table("friction")} | {""}
    for row in table("materials"):
        assert row["friction_as"] in objects
        assert float(row["density"]) > 0.0
    words = [w for r in table("materials") for w in r["words"].split("|") if w]
    assert len(set(words)) == len(words)


def test_measures_are_ordered_and_take_their_limits_from_the_paper() -> None:
    rows = {r["measure"]: r for r in table("measures")}
    orders = [int(r["order"]) for r in table("measures")]
    assert orders == sorted(set(orders))
    assert list(rows)[-1] == "remove"
    assert float(rows["grip_pad"]["limit"]) == max(float(v) for _, v, _ in TABLE_3)
    assert float(rows["surface"]["limit"]) in {float(v) for _, v, _ in TABLE_3}
    (pad,) = (float(r["friction"]) for r in table("isolators") if r["kind"] == "friction_isolator")
    assert pad == min(float(v) for _, v, _ in TABLE_3)
    assert float(rows["rubber_pads"]["limit"]) == 0.06


def test_plausible_limits_are_of_fields_that_exist() -> None:
    known = {*ITEM_FIELDS, "diameter_m"}
    for row in table("plausible"):
        assert row["field"] in known, row["field"]
        assert row["unit"]


def test_a_missing_table_is_named() -> None:
    with pytest.raises(FileNotFoundError):
        table("no_such_table")
