"""Rows of three museums' real exports, damage included, through their presets (tests/data/collections/README.md)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pipeline.collection.guess import guess
from pipeline.collection.mapping import DIAMETER, load_mapping
from pipeline.collection.measured_cell import of_cell
from pipeline.collection.reading import NOWHERE
from pipeline.collection.record import item_schema, to_records
from pipeline.records import Item, Origin
from tests.collection.real_exports import DATA, FILES, read
from tests.soak import SOAK


def item(name: str, number: str) -> Item:
    return next(item for item in read(name).items if item.object_number == number)


@pytest.mark.parametrize("name", FILES)
def test_every_row_is_accounted_for_and_fits_the_schema(name: str) -> None:
    import jsonschema

    reading = read(name)
    assert reading.rows == len(reading.items) + len(reading.rejected)
    validator = jsonschema.Draft202012Validator(item_schema())
    for record in to_records(list(reading.items)):
        validator.validate(json.loads(json.dumps(record)))


def test_lines_of_a_cell_that_became_rows_are_named() -> None:
    """Ten of the 27 rows are the second or third line of a dimension text."""
    reading = read("met_27_rows_cp1252")
    assert [out.row for out in reading.rejected] == [13, 14, 16, 17, 19, 20, 22, 23, 25, 26]
    assert all("is a dimension: a line inside a cell" in out.message for out in reading.rejected)
    assert "quotation marks" in reading.rejected[0].remedy


def test_a_row_that_the_end_of_the_file_cuts_off_is_named() -> None:
    (out,) = read("tms_rows_cut_off").rejected
    assert (out.row, out.line) == (26, 27)
    assert "unexpected end of data" in out.message
    assert "see whether the file was cut off" in out.remedy


def test_troy_ounces_and_pennyweights_are_a_mass() -> None:
    """3 oz. 19 dwt. are 79/20 troy ounces of 31.1034768 g; the museum's own 123.3 g agrees to 0.5 %."""
    beaker = item("met_27_rows_cp1252", "33120102")
    assert beaker.mass_kg == pytest.approx(79 / 20 * 0.0311034768, rel=1e-15)
    assert beaker.height_m == pytest.approx(2.4375 * 0.0254, rel=1e-15)
    assert beaker.on_display
    assert item("met_27_rows_cp1252", "67.265.9").gallery == NOWHERE


def test_the_base_is_its_own_and_the_whole_goes_before_its_parts() -> None:
    lamp = item("moma_rows", "184.1948.a-g")
    found = {of.field: of for of in lamp.provenance}
    assert (lamp.height_m, lamp.width_m, lamp.depth_m) == (0.365125, 0.10795, 0.1524)
    assert (lamp.base_width_m, lamp.base_depth_m) == (0.1016, 0.1524)
    assert found["height_m"].written == "14 3/8 in"
    assert found["height_m"].note.endswith("characters 10 to 15")
    assert "base" in found["base_width_m"].note


@pytest.mark.parametrize(
    ("cell", "kind", "value", "written"),
    [
        ("23 Zentimeter", "m", 0.23, "23 Zentimeter"),
        ("8 1/2 in", "m", 0.2159, "8 1/2 in"),
        ("32,5 cm", "m", 0.325, "32,5 cm"),
        ("2 kg", "kg", 2.0, "2 kg"),
        ("2 kg", "m", None, ""),
        ("10 x 20 cm", "m", None, ""),
        ("tall", "m", None, ""),
    ],
)
def test_cells_with_their_own_unit(cell: str, kind: str, value: float | None, written: str) -> None:
    found = of_cell(cell, kind, ".")
    assert found == (None if value is None else (value, written))


def test_a_diameter_is_width_and_depth_and_says_so() -> None:
    vase = item("moma_rows", "2252.2001")
    assert (vase.height_m, vase.width_m, vase.depth_m) == (0.606425, 0.3048, 0.3048)
    origins = {of.field: of.origin for of in vase.provenance}
    assert origins == {"height_m": Origin.MEASURED, "width_m": Origin.DERIVED, "depth_m": Origin.DERIVED}


def test_the_weight_of_a_part_is_not_the_objects() -> None:
    work = item("moma_rows", "177.1958.a-f")
    assert work.mass_kg is None
    assert any("only a part is weighed (471.7 kg)" in problem.message for problem in work.problems)


def test_readings_that_contradict_each_other_are_told() -> None:
    """2 1/4 inches stand beside 4 cm."""
    first, second = item("moma_rows", "2284.2001.1-11").problems
    assert (first.field, first.message[:24]) == ("dimensions", "0.05715 m against 0.04 m")
    assert second.message == "the size of '1 (round dish)' is taken for that of the whole object"


def test_the_frame_hangs() -> None:
    """The sheet is 74.5 x 59 cm, its frame 107 x 81 cm."""
    framed = item("tms_rows_cut_off", "83.19.E")
    assert (framed.height_m, framed.width_m) == (1.069975, 0.809625)


@pytest.mark.parametrize("name", FILES)
def test_a_guessed_mapping_reads_what_the_preset_reads(name: str) -> None:
    found = guess(DATA / f"{name}.csv")
    preset = load_mapping(FILES[name])
    assert found.mapping.source.encoding == preset.source.encoding
    assert found.mapping.source.delimiter == preset.source.delimiter
    texts, ours = found.mapping.dimensions, preset.dimensions
    assert texts is not None
    assert ours is not None
    assert texts.columns == ours.columns
    # A museum's second number column is as good a guess as its first.
    for field in set(preset.columns) - {"gallery", "object_number"}:
        assert found.mapping.columns[field] == preset.columns[field]


@pytest.mark.long("test_a_guessed_mapping_reads_what_the_preset_reads")
def test_a_guess_of_carnegie_sees_that_its_unit_is_the_inch(tmp_path: Path) -> None:
    """Of all rows in `make soak`: what a guess costs grows with them."""
    whole = (Path(load_mapping.__code__.co_filename).parent / "data" / "carnegie_2000.csv").read_bytes()
    (tmp_path / "carnegie.csv").write_bytes(b"".join(whole.splitlines(keepends=True)[: None if SOAK else 700]))
    found = guess(tmp_path / "carnegie.csv")
    preset = load_mapping("carnegie")
    assert found.mapping.columns == preset.columns
    assert len([d for d in found.doubts if "inches are taken" in d]) == 1
    assert DIAMETER in found.mapping.columns
