"""What runs through a whole source stops its import until the mapping says what holds; sound sources pass."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from random import Random

import pytest

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.collection.source_audit import ContradictionError, require_settled, unit_named
from pipeline.night.importing import bundled_collection
from pipeline.tables.assumed import assumed
from tests import museum

MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test"
[columns]
object_number = { column = "number" }
gallery = { column = "room" }
medium = { column = "medium" }
height_m = { column = "Height", unit = "LENGTH" OWN }
width_m = { column = "Width", unit = "LENGTH" OWN }
depth_m = { column = "Depth", unit = "LENGTH" OWN }
mass_kg = { column = "mass", unit = "kg", optional = true }
on_display = { column = "shown", optional = true }
"""

TEXTS = '[dimensions]\ncolumns = ["size"]\n'

Sizes = list[tuple[str, str, list[float]]]


@pytest.fixture(scope="module")
def sizes() -> Sizes:
    """Numbers, media and sides [in] of 120 real objects, no two sides of which are alike."""
    with bundled_collection().open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    found = [
        (r["accession_number"], r["medium"], [float(r[f"item_{s}"]) for s in ("height", "width", "depth")])
        for r in rows
    ]
    return [one for one in found if min(one[2]) > 2.0 and one[2][0] > 1.2 * one[2][1] and max(one[2]) < 90.0][:120]


def read(
    folder: Path,
    header: str,
    rows: Sequence[Sequence[object]],
    *,
    unit: str = "in",
    own: str = "",
    more: str = TEXTS,
) -> Reading:
    text = MAPPING.replace("LENGTH", unit).replace("OWN", own) + more
    (folder / "m.toml").write_text(text, encoding="utf-8")
    with (folder / "m.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(header.split(","))
        writer.writerows(rows)
    return read_items(folder / "m.csv", load_mapping(folder / "m.toml"))


HEADER = "number,room,medium,Height,Width,Depth,size"


def texts(sizes: Sizes, order: Sequence[int] = (0, 1, 2), wrong: int = 0) -> list[list[object]]:
    """Rows whose columns are in inches, and whose texts say the same; `wrong` of them twice as much."""
    rows: list[list[object]] = []
    for at, (number, medium, sides) in enumerate(sizes):
        h, w, d = (side * (2.0 if at < wrong else 1.0) for side in sides)
        rows.append([number, "Hall", medium, *(f"{sides[k]:g}" for k in order), f"H {h:g} x W {w:g} x D {d:g} in."])
    return rows


def settled(reading: Reading) -> bool:
    try:
        require_settled(reading.source, reading.suspicions)
    except ContradictionError:
        return False
    return True


def test_sound_sources_and_single_slips_pass(sizes: Sizes, tmp_path: Path) -> None:
    assert read(tmp_path, HEADER, texts(sizes)).suspicions == ()
    # Less than half: each row's own doubt, and the whole is imported.
    some = read(tmp_path, HEADER, texts(sizes, wrong=50))
    assert (some.suspicions, some.choices) == ((), ())
    assert sum(bool(item.problems) for item in some.items) == 50
    assert read(tmp_path, HEADER, texts(sizes[:19]), unit="cm").suspicions == (), "fewer may be chance"
    carnegie = museum.carnegie()
    assert (carnegie.suspicions, carnegie.choices) == ((), ())


def test_columns_against_texts_name_rows_and_the_unit_that_fits(sizes: Sizes, tmp_path: Path) -> None:
    reading = read(tmp_path, HEADER, texts(sizes), unit="cm")
    assert [one.field for one in reading.suspicions] == ["height_m", "width_m", "depth_m"]
    with pytest.raises(ContradictionError) as caught:
        require_settled(reading.source, reading.suspicions)
    told = str(caught.value)
    assert caught.value.exit_code == 5
    assert "m.csv: it contradicts itself in most rows, and nothing was imported" in told
    # An inch is 2.54 cm.
    assert "the column 'Height' and the texts say other things of height in 120 of 120 rows, mostly 2.54 times" in told
    assert 'say unit = "in" in [columns.height_m]' in told
    assert '[holds] texts = "columns" or texts = "texts"' in told
    assert told.count(f"row 1, {sizes[0][0]}: its column says") == 3
    assert "row 4," not in told, "three rows are examples enough"


def test_what_the_mapping_says_holds_is_used_and_told(sizes: Sizes, tmp_path: Path) -> None:
    number, _, sides = sizes[0]
    for held, height in (("columns", sides[0] * 0.01), ("texts", sides[0] * 0.0254)):
        reading = read(tmp_path, HEADER, texts(sizes), unit="cm", more=f'{TEXTS}[holds]\ntexts = "{held}"\n')
        assert settled(reading)
        assert len(reading.choices) == 3
        assert f'[holds] texts = "{held}"' in reading.choices[0].message
        first = reading.items[0]
        assert first.object_number == number
        assert first.height_m == pytest.approx(height, rel=1e-6)
        (of,) = [one for one in first.provenance if one.field == "height_m"]
        assert of.written.endswith("cm" if held == "columns" else "in")
        assert f"the {held[:-1]} is used" in next(p.message for p in first.problems if p.field == "height_m")


def test_exchanged_height_and_width(sizes: Sizes, tmp_path: Path) -> None:
    reading = read(tmp_path, HEADER, texts(sizes, order=(1, 0, 2)))
    (found,) = reading.suspicions
    assert (found.holds, found.field) == ("sides", "height_m, width_m")
    assert "height and width are exchanged in 120 of 120 rows" in found.message
    assert (
        "exchange the column 'Height' and the column 'Width' in [columns.height_m] and [columns.width_m]"
        in found.remedy
    )
    assert not settled(reading)
    assert settled(read(tmp_path, HEADER, texts(sizes, order=(1, 0, 2)), more=f'{TEXTS}[holds]\nsides = "mapping"\n'))


@pytest.mark.parametrize("name", ["Einheit", "Height unit", "unité", "dimension_units", "Maßeinheit"])
def test_a_column_of_units_that_says_otherwise(sizes: Sizes, tmp_path: Path, name: str) -> None:
    header = f"number,room,medium,Height,Width,Depth,{name}"
    rows = [[number, "Hall", medium, *sides, "cm"] for number, medium, sides in sizes[:10]]
    reading = read(tmp_path, header, rows, more="")
    fields = {one.field for one in reading.suspicions if one.holds == "units"}
    assert fields == ({"height_m"} if "Height" in name else {"height_m", "width_m", "depth_m"})
    found = next(one for one in reading.suspicions if one.field == "height_m")
    assert (
        f"the column {name!r} says cm in 10 of 10 rows, the mapping that the column 'Height' is in in" in found.message
    )
    assert f'unit_column = "{name}" in [columns.height_m]' in found.remedy
    assert len(found.examples) == 3
    assert not settled(reading)
    assert settled(read(tmp_path, header, rows, more='[holds]\nunits = "mapping"\n'))


def test_each_row_is_read_in_its_own_unit(sizes: Sizes, tmp_path: Path) -> None:
    header = "number,room,medium,Height,Width,Depth,Einheit"
    told = ["cm", "Zoll", "", "mm.", "furlongs"]
    rows = [[number, "Hall", medium, *sides, unit] for unit, (number, medium, sides) in zip(told, sizes, strict=False)]
    reading = read(tmp_path, header, rows, own=', unit_column = "Einheit"', more="")
    assert reading.suspicions == ()
    # Without a unit of its own, or one that is known, the mapping's (inches) counts.
    for item, (_, _, sides), metres in zip(reading.items, sizes, (0.01, 0.0254, 0.0254, 0.001, 0.0254), strict=False):
        assert item.height_m == pytest.approx(sides[0] * metres, rel=1e-9)
    assert "'furlongs' is no unit that is known; in is taken" in reading.items[4].problems[0].message
    assert [bool(item.problems) for item in reading.items] == [False] * 4 + [True]


@pytest.mark.parametrize(
    ("text", "kind", "unit"),
    [
        ("cm", "m", "cm"), ("inches", "m", "in"), ("Zoll", "m", "in"), ("(mm)", "m", "mm"), ("kg", "kg", "kg"),
        ("lbs", "kg", "lb"), ("cm", "kg", None), ("kg", "m", None), ("pieces", "m", None), ("12", "m", None),
        ("", "m", None),
    ],
)  # fmt: skip
def test_units_by_name(text: str, kind: str, unit: str | None) -> None:
    assert unit_named(text, kind) == unit


def weighed(sizes: Sizes, share: tuple[float, float], factor: float) -> list[list[object]]:
    random, rows = Random(5), []
    for number, medium, sides in sizes:
        material = assumed().material_in(medium)
        if material is not None:
            volume = sides[0] * sides[1] * sides[2] * 0.0254**3
            mass = volume * material.density * random.uniform(*share) * factor
            rows.append([number, "Hall", medium, *(f"{side:g}" for side in sides), f"{mass:.6g}"])
    return rows


WEIGHED = "number,room,medium,Height,Width,Depth,mass"


def test_pounds_that_the_mapping_calls_kilograms(sizes: Sizes, tmp_path: Path) -> None:
    """Solid things fill half to nine tenths of their boxes: 2.2 times as much is more than a block of the material."""
    assert read(tmp_path, WEIGHED, weighed(sizes, (0.5, 0.9), 1.0), more="").suspicions == ()
    reading = read(tmp_path, WEIGHED, weighed(sizes, (0.5, 0.9), 2.2046), more="")
    (found,) = reading.suspicions
    assert found.holds == "weights"
    assert "would be heavier than a solid block of it" in found.message
    assert "read as in and lb" in found.message
    assert not settled(reading)
    assert settled(read(tmp_path, WEIGHED, weighed(sizes, (0.5, 0.9), 2.2046), more='[holds]\nweights = "mapping"\n'))


def test_a_weight_that_does_not_fit_its_object_is_the_rows_own_doubt(sizes: Sizes, tmp_path: Path) -> None:
    rows = weighed(sizes, (0.1, 0.5), 1.0)
    heavy, light = float(str(rows[0][-1])) * 40.0, float(str(rows[1][-1])) * 1e-4
    rows[0][-1], rows[1][-1] = f"{heavy:.6g}", f"{light:.6g}"
    reading = read(tmp_path, WEIGHED, rows, more="")
    assert reading.suspicions == ()
    first, second = reading.items[:2]
    assert first.mass_kg is None
    assert any("times as heavy as a solid block of" in p.message for p in first.problems)
    assert second.mass_kg == pytest.approx(light, rel=1e-5)
    assert any("as if mass or size were in another unit; it is used" in p.message for p in second.problems)
    assert not any(item.problems for item in reading.items[2:])


def shown(sizes: Sizes, room: str, away: int, flag: str = "yes") -> list[list[object]]:
    return [
        [number, room if at < away else "Hall 3", medium, *sides, flag]
        for at, (number, medium, sides) in enumerate(sizes)
    ]


SHOWN = "number,room,medium,Height,Width,Depth,shown"


def test_flags_against_locations(sizes: Sizes, tmp_path: Path) -> None:
    some = read(tmp_path, SHOWN, shown(sizes, "Depot 3", 30), more="")
    assert some.suspicions == ()
    doubts = [p for item in some.items for p in item.problems if p.field == "on_display"]
    assert len(doubts) == 30
    assert "the location 'Depot 3' that it is not; the flag is used" in doubts[0].message
    assert all(item.on_display for item in some.items)
    most = read(tmp_path, SHOWN, shown(sizes, "Depot 3", 90), more="")
    (found,) = most.suspicions
    assert (found.holds, found.message.startswith("90 of 120 objects that a flag says to be on display")) == (
        "display",
        True,
    )
    assert not settled(most)
    for held, on in (("flag", 120), ("location", 30)):
        reading = read(tmp_path, SHOWN, shown(sizes, "Depot 3", 90), more=f'[holds]\ndisplay = "{held}"\n')
        assert settled(reading)
        assert sum(item.on_display for item in reading.items) == on
    # The mapping's own list of stores holds over a flag, and of galleries over a name.
    listed = read(tmp_path, SHOWN, shown(sizes, "Hall 9", 5), more='[display]\nnot_on_display = ["Hall 9"]\n')
    assert sum(item.on_display for item in listed.items) == 115
    assert sum(bool(item.problems) for item in listed.items) == 5
    open_ = read(tmp_path, SHOWN, shown(sizes, "Depot 3", 90), more='[display]\non_display = ["Depot 3"]\n')
    assert (open_.suspicions, sum(item.on_display for item in open_.items)) == ((), 120)


def test_without_a_flag_the_name_of_a_location_is_taken_and_told(sizes: Sizes, tmp_path: Path) -> None:
    header = "number,room,medium,Height,Width,Depth"
    rows = [row[:-1] for row in shown(sizes, "Réserve 2", 70)]
    reading = read(tmp_path, header, rows, more="")
    assert sum(item.on_display for item in reading.items) == 50
    (choice,) = reading.choices
    assert "70 objects taken not to be on display, as the name of the location says: 'Réserve 2' (70)" in choice.message
    assert settled(reading)
    named = read(tmp_path, header, rows, more='[display]\nnot_on_display = ["Réserve 2"]\n')
    assert (named.choices, sum(item.on_display for item in named.items)) == ((), 50)


def test_zeros_that_a_spreadsheet_dropped_are_seen(sizes: Sizes, tmp_path: Path) -> None:
    header = "number,room,medium,Height,Width,Depth"
    kept = [[f"1913.{at}", "Hall", "oak", 1, 2, 3] for at in range(1, 101)]
    assert read(tmp_path, header, kept, more="").suspicions == ()
    lost = [[str(float(row[0])), *row[1:]] for row in kept]
    reading = read(tmp_path, header, lost, more="")
    # 1913.10 to 1913.90 and 1913.100 became numbers that were given already.
    assert len(reading.rejected) == 10
    (found,) = reading.suspicions
    assert "none ends in 0, as if a spreadsheet had taken them for decimals" in found.message
    assert settled(reading), "it is told, and stops nothing"
