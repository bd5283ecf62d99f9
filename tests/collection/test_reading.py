"""Every row of a museum's file becomes an item or is rejected by number; a bad value is named and costs no object."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.collection import reading
from pipeline.collection.cells import Cells
from pipeline.collection.errors import CollectionError, MappingError
from pipeline.collection.inventory import galleries
from pipeline.collection.limits import STANDARD, Limits
from pipeline.collection.mapping import PRESETS, Mapping, load_mapping
from pipeline.collection.reading import NOWHERE, Reading, read_items
from pipeline.collection.sources import delimited
from pipeline.collection.sources.delimited import FIELD_LIMIT
from pipeline.records import Item, Origin, Provenance, Support
from tests import museum
from tests.soak import SOAK, examples

from .conftest import HEADER, MAPPING, Read, one

CARNEGIE = PRESETS.parent / "data" / "carnegie_2000.csv"


@pytest.fixture(scope="module")
def carnegie() -> Reading:
    return museum.carnegie()


@pytest.fixture(scope="module")
def source() -> list[dict[str, str]]:
    with CARNEGIE.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


# ---------------------------------------------------------------------------------------------------------------------
# The Carnegie Museum of Art


def test_carnegie_is_accounted_for(carnegie: Reading) -> None:
    """2,000 rows, 1,374 on view in 34 galleries, 625 "Not on View" and 1 "Off-site": counted with grep in the file."""
    assert (carnegie.rows, len(carnegie.items), carnegie.rejected) == (2000, 2000, ())
    shown = galleries(carnegie.items)
    assert (len(shown), sum(shown.values())) == (34, 1374)
    assert shown["Hall of Architecture"] == 276
    assert sum(not item.on_display for item in carnegie.items) == 626
    assert not any(item.problems for item in carnegie.items)
    assert carnegie.sha256 == hashlib.sha256(CARNEGIE.read_bytes()).hexdigest()
    assert (carnegie.source, carnegie.mapping, carnegie.museum) == (CARNEGIE.name, "carnegie", "Carnegie Museum of Art")


def test_carnegie_dimensions(carnegie: Reading, source: list[dict[str, str]]) -> None:
    """1,637 rows have all three above 0 in the file; with a diameter for a missing width or depth they are 1,831."""
    sizes = [[float(row[f"item_{k}"]) for k in ("width", "height", "depth", "diameter")] for row in source]
    assert sum(w > 0 and h > 0 and d > 0 for w, h, d, _ in sizes) == 1637
    assert sum(h > 0 and (w > 0 or q > 0) and (d > 0 or q > 0) for w, h, d, q in sizes) == 1831
    whole = [item for item in carnegie.items if None not in (item.width_m, item.height_m, item.depth_m)]
    assert len(whole) == 1831


def test_carnegie_values_are_converted_exactly(carnegie: Reading, source: list[dict[str, str]]) -> None:
    """An inch is 127/5000 m: the nearest double of the exact product, by rational arithmetic."""
    couch = next(item for item in carnegie.items if item.object_number == "31.1.1.2")
    assert (couch.title, couch.gallery) == ("Couch", "Gallery 20, Bruce Galleries")
    assert (couch.width_m, couch.height_m, couch.depth_m) == (2.0066, 0.815975, 0.5588)
    for row, item in zip(source, carnegie.items, strict=True):
        exact = Fraction(row["item_height"]) * Fraction(127, 5000)
        assert item.height_m == (float(exact) or None)


# ---------------------------------------------------------------------------------------------------------------------
# Values


@pytest.mark.parametrize(
    ("height", "message", "remedy"),
    [
        ("tall", "'tall' is not a number", "without units"),
        ("nan", "'nan' is not a number", "without units"),
        ("12 in", "'12 in' is not a number", "without units"),
        ("1_000", "'1_000' is not a number", "without units"),
        ("١٢", "'١٢' is not a number", "without units"),
        ('"12,5"', "'12,5' is not a number", 'decimal = ","'),
        ("-3", "'-3' in = -0.0762 m is negative", "unit in the mapping"),
        ("0.0", "'0.0' in = 0 m is zero", "missing = [0.0]"),
        ("inf", "'inf' is infinite", "measure it"),
        ("1e999", "'1e999' is infinite", "measure it"),
        ("9600", "'9600' in = 243.84 m is implausible: not within 0.0005 to 50 m (museums", "unit in the mapping"),
        ("0.019", "'0.019' in = 0.0004826 m is implausible", "unit in the mapping"),
        ("9" * 5000, f"'{'9' * 60}...' is not a number", "without units"),
    ],
)
def test_a_bad_value_is_named_and_costs_no_object(height: str, message: str, remedy: str, read: Read) -> None:
    item = one(read(f"{HEADER}A1,Hall,Vase,{height},\n"))
    (problem,) = item.problems
    assert (item.object_number, item.height_m, problem.field) == ("A1", None, "height_m")
    assert problem.message.startswith("column 'height': ")
    assert message in problem.message
    assert remedy in problem.remedy


@pytest.mark.parametrize(
    ("mass", "value"),
    [("", None), ("0", None), ("Unknown", None), ("0.001", 1e-6), ("1e9", 1e6), (" 12.5 ", 0.0125), ("+.5", 0.0005)],
)
def test_masses(mass: str, value: float | None, read: Read) -> None:
    """What the mapping calls missing is no problem; 1 mg and 1,000 t are the ends of what is plausible."""
    item = one(read(f"{HEADER}A1,Hall,Vase,,{mass}\n"))
    assert (item.mass_kg, item.problems) == (value, ())


@pytest.mark.parametrize("mass", ["0.00099", "1.0001e9"])
def test_masses_beyond_the_ends(mass: str, read: Read) -> None:
    (problem,) = one(read(f"{HEADER}A1,Hall,Vase,,{mass}\n")).problems
    assert "is implausible: not within 1e-06 to 1e+06 kg" in problem.message


@given(st.decimals(min_value="0.02", max_value="1900", places=4, allow_nan=False, allow_infinity=False))
@settings(max_examples=examples(50), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_lengths_are_the_nearest_double_of_the_exact_product(read: Read, inches: object) -> None:
    item = one(read(f"{HEADER}A1,Hall,Vase,{inches},\n"))
    assert item.height_m == float(Fraction(str(inches)) * Fraction(127, 5000))


def test_decimal_commas(read: Read) -> None:
    mapping = MAPPING.replace('delimiter = ","', 'delimiter = ";"\ndecimal = ","').replace('unit = "in"', 'unit = "cm"')
    content = "number;location;title;height;mass\nA1;Hall;Vase;12,5;\nA2;Hall;Vase;1.250;\n"
    first, second = read(content, mapping).items
    assert first.height_m == 0.125
    assert (second.height_m, [p.field for p in second.problems]) == (None, ["height_m"])


def test_a_diameter_fills_only_what_is_missing(read: Read) -> None:
    mapping = MAPPING.replace(
        "[display]",
        'width_m = { column = "width", unit = "m" }\ndepth_m = { column = "depth", unit = "m" }\n'
        'diameter_m = { column = "diameter", unit = "mm" }\n[display]',
    )
    content = "number,location,title,height,mass,width,depth,diameter\nA1,H,V,,,0.3,,200\nA2,H,V,,,,,200\nA3,H,V,,,,,\n"
    sizes = [(item.width_m, item.depth_m) for item in read(content, mapping).items]
    assert sizes == [(0.3, 0.2), (0.2, 0.2), (None, None)]


def test_what_is_at_stake_is_read_and_what_cannot_be_is_told(read: Read) -> None:
    mapping = MAPPING.replace(
        "[display]",
        'value = { column = "insured" }\nirreplaceable = { column = "unique", values = { "ja" = true } }\n'
        'on_loan = { column = "loan" }\n[display]',
    )
    header = "number,location,title,height,mass,insured,unique,loan\n"
    rows = "A1,H,V,,,1250000.50,Ja,yes\nA2,H,V,,,,,\nA3,H,V,,,0,no,n\nA4,H,V,,,-5,perhaps,from Berlin\n"
    rows += "A5,H,V,,,1e13,,\nA6,H,V,,,inf,,\nA7,H,V,,,1e9999,,\nA8,H,V,,,dear,,\nA9,H,V,,,=1+1,,\n"
    a, b, c, d, *others = read(header + rows, mapping).items
    assert (a.value, a.irreplaceable, a.on_loan, a.problems) == (1_250_000.5, True, True, ())
    assert (b.value, b.irreplaceable, b.on_loan, b.problems) == (None, None, None, ())
    assert (c.value, c.irreplaceable, c.on_loan, c.problems) == (0.0, False, False, ())
    assert (d.value, d.irreplaceable, d.on_loan) == (None, None, None)
    assert [p.field for p in d.problems] == ["value", "irreplaceable", "on_loan"]
    for item in (d, *others):
        assert item.value is None
        assert item.problems[0].field == "value"
        assert "insured" in item.problems[0].message
        assert item.problems[0].remedy


def test_words_counts_and_truths(read: Read) -> None:
    mapping = MAPPING.replace(
        "[display]",
        'support = { column = "how", values = { "auf Sockel" = "freestanding" }, missing = ["?"] }\n'
        'section_count = { column = "legs" }\nsusceptible = { column = "fragile", values = { "ja" = true } }\n'
        'medium = { columns = ["made of", "how made"], separator = ", " }\n[display]',
    )
    header = "number,location,title,height,mass,how,legs,fragile,made of,how made\n"
    rows = "A1,H,V,,,AUF SOCKEL,4,Ja,clay,thrown\nA2,H,V,,,hung,2.5,no,,cast\n"
    rows += "A3,H,V,,,floating,0,perhaps,,\nA4,H,V,,,?,,,,\n"
    a, b, c, d = read(header + rows, mapping).items
    assert (a.support, a.section_count, a.susceptible, a.medium) == (Support.FREESTANDING, 4, True, "clay, thrown")
    assert (b.support, b.section_count, b.susceptible, b.medium) == (Support.HUNG, None, False, "cast")
    assert "'2.5' is not a whole number" in b.problems[0].message
    assert (c.support, c.section_count, c.susceptible) == (None, None, None)
    assert [p.field for p in c.problems] == ["support", "section_count", "susceptible"]
    assert "'floating' is none of freestanding, fastened" in c.problems[0].message
    assert "nor of 'auf Sockel'" in c.problems[0].message
    assert (d.support, d.section_count, d.susceptible, d.problems) == (None, None, None, ())


@pytest.mark.parametrize(
    ("said", "hanging"),
    [("two hooks or D-rings", "two_hooks"), ("French cleat", "cleat"), ("wire", "wire"), ("zwei Haken", "two_hooks")],
)
def test_words_that_no_mapping_translates_are_read_as_people_write_them(read: Read, said: str, hanging: str) -> None:
    mapping = MAPPING.replace("[display]", 'hanging = { column = "hung" }\n[display]')
    item = one(read(f"number,location,title,height,mass,hung\nA1,H,V,,,{said}\n", mapping))
    assert (item.hanging, item.problems) == (hanging, ())


def test_texts_are_kept_as_they_are(read: Read) -> None:
    title = """<script>alert("1")</script> & 'q' =cmd|' /C'!A0 \\ ${x} {{7*7}} Ω"""
    quoted = title.replace('"', '""')
    item = one(read(f'{HEADER}A1,Hall,"  {quoted} ",,\n'))
    assert (item.title, item.problems) == (title, ())


def test_control_characters_are_removed_and_it_is_told(read: Read) -> None:
    item = one(read(f'{HEADER}A1,Hall,"a\x1b[31m\u202eb\nc",,\n'))
    (problem,) = item.problems
    assert item.title == "a[31mb c"
    assert "U+000A, U+001B, U+202E" in problem.message


def test_long_texts_are_capped_and_it_is_told(read: Read) -> None:
    item = one(read(f"{HEADER}A1,Hall,{'é' * 2001},,\n"))
    assert item.title == "é" * 2000
    assert "2,001 characters, of which the first 2,000 are kept" in item.problems[0].message


def test_locations(read: Read) -> None:
    hall, store, nowhere = read(f"{HEADER}A1,Hall,,,\nA2, STORE ,,,\nA3, ,,,\n").items
    assert (hall.on_display, store.on_display, nowhere.on_display) == (True, False, False)
    assert (nowhere.gallery, nowhere.problems[0].field) == (NOWHERE, "gallery")
    assert "the location is empty" in nowhere.problems[0].message
    assert not store.problems


def test_the_template_sheet(tmp_path: Path) -> None:
    sheet = tmp_path / "sheet.csv"
    sheet.write_text("object_number,gallery,height_m,support,on_display\n1,Hall,1.2,hung,no\n2,Hall,,,\n", "utf-8")
    first, second = read_items(sheet, load_mapping("kouros")).items
    height = Provenance("height_m", Origin.MEASURED, "1.2 m")
    assert first == Item("1", "Hall", height_m=1.2, support=Support.HUNG, on_display=False, provenance=(height,))
    assert second == Item("2", "Hall")


# ---------------------------------------------------------------------------------------------------------------------
# Rows

GOOD = "B1,Hall,Bust,10,\n"


@pytest.mark.parametrize(
    ("bad", "field", "message"),
    [
        (",Hall,Vase,,\n", "object_number", "the object has no number"),
        (GOOD, "object_number", "object number 'B1' was given in row 1 already"),
        (f"{'x' * 601},Hall,Vase,,\n", "object_number", "an object number of 601 characters"),
        ("A1,Hall,Vase\n", "", "3 cells, the header has 5"),
        ("A1,Hall,Vase,,,\n", "", "6 cells, the header has 5"),
        ('A1,Hall,"Vase" old,,\n', "", "not a row of a CSV file: ',' expected after '\"'"),
        ('A1,Hall,"Vase,,\n', "", "not a row of a CSV file"),
        ("A1,Hall,Va\0se,,\n", "", "a NUL byte in cell 3"),
        (b"A1,Hall,Vas\xe9,,\n", "", "byte 0xe9 at character 4 of cell 3 cannot be read as utf-8"),
        (f"A1,Hall,{'x' * (FIELD_LIMIT + 1)},,\n", "", "a cell of more than 1,048,576 characters"),
    ],
)
def test_a_broken_row_is_named_and_the_rest_goes_on(bad: str | bytes, field: str, message: str, read: Read) -> None:
    raw = bad if isinstance(bad, bytes) else bad.encode()
    reading = read(HEADER.encode() + GOOD.encode() + raw + b"B2,Hall,Bust,20,\n")
    (rejected,) = reading.rejected
    assert [item.object_number for item in reading.items] == ["B1", "B2"]
    assert (rejected.file, rejected.row, rejected.line, rejected.field) == ("museum.csv", 2, 3, field)
    assert rejected.message.startswith("museum.csv, row 2 (line 3): ")
    assert message in rejected.message
    assert rejected.remedy


def test_a_text_longer_than_the_csv_modules_own_limit_is_read(read: Read) -> None:
    """131,072 characters are what Python's reader takes unasked; a provenance may be longer, up to Kouros's limit."""
    long = "x" * FIELD_LIMIT
    reading = read(f'{HEADER}A1,Hall,"{long[:200_000]}",,\nA2,Hall,"{long}",,\n{GOOD}')
    assert [item.object_number for item in reading.items] == ["A1", "A2", "B1"]
    assert not reading.rejected


@pytest.mark.parametrize("cell", ["x" * (FIELD_LIMIT + 1), '"' + f"{'x' * 4999}\n" * (FIELD_LIMIT // 5000 + 1) + '"'])
def test_a_cell_beyond_the_limit_says_what_to_do(cell: str, read: Read) -> None:
    """Also where the cell goes over many lines, which are then rows of their own and are each refused."""
    reading = read(f"{HEADER}A1,Hall,{cell},,\n{GOOD}")
    first = reading.rejected[0]
    assert first.message.startswith("museum.csv, row 1 (line 2): a cell of more than 1,048,576 characters")
    assert "shorten it" in first.remedy
    assert [item.object_number for item in reading.items] == ["B1"]


@pytest.mark.parametrize(
    ("where", "name", "field"),
    [
        (Cells, "number", "height_m"),
        (Cells, "text", "title"),
        (reading, "fill", "dimensions"),
        (reading, "contradictions", ""),
    ],
)
def test_what_kouros_fails_on_in_one_row_stops_no_reading(
    where: Any, name: str, field: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, an error inside of a reader lost the whole import; now a cell is a problem, and a row at most refused."""
    true = getattr(where, name)

    def failing(*given: Any, **more: Any) -> Any:
        if "bad" in repr(given):
            raise IndexError("list index out of range")
        return true(*given, **more)

    file = tmp_path / "rows.csv"
    rows = ["1,R,good,0.3,,", "2,R,bad,bad 0.3,bad 10 cm high,bad", "3,R,good,0.4,,"]
    file.write_text("\n".join(["object_number,gallery,title,height_m,text,note", *rows]), encoding="utf-8")
    columns: dict[str, Any] = {n: {"column": n} for n in ("object_number", "gallery", "title")}
    columns |= {"height_m": {"column": "height_m", "unit": "m"}, "medium": {"column": "note"}}
    source = {"format": "csv", "encoding": "utf-8", "delimiter": ","}
    whole = {"source": source, "museum": {"name": "M"}, "columns": columns, "dimensions": {"columns": ["text"]}}
    mapping = Mapping.model_validate(whole)
    monkeypatch.setattr(where, name, failing)
    for kind, reader in list(reading._READ.items()):
        if reader is true:
            monkeypatch.setitem(reading._READ, kind, failing)
    found = read_items(file, mapping)
    assert found.rows == 3
    if not field:
        assert [item.object_number for item in found.items] == ["1", "3"]
        (refused,) = found.rejected
        assert "row 2 (line 3): Kouros failed to read it, which is not your fault: IndexError" in refused.message
        return
    assert [item.object_number for item in found.items] == ["1", "2", "3"]
    told = [p for p in found.items[1].problems if "Kouros failed to read it" in p.message]
    assert field in {p.field for p in told}
    assert all("list index out of range" in p.message for p in told)
    assert not any("Kouros failed" in p.message for item in found.items[::2] for p in item.problems)


def test_a_file_that_is_cut_off_in_a_quoted_cell(read: Read) -> None:
    reading = read(f'{HEADER}{GOOD}A1,Hall,"A vase of\nthe tw')
    assert len(reading.items) == 1
    assert [(r.row, r.line) for r in reading.rejected] == [(2, 3), (3, 4)]
    assert "unexpected end of data" in reading.rejected[0].message


def test_line_numbers_count_lines_and_rows_count_objects(read: Read) -> None:
    reading = read(f'{HEADER}A1,Hall,"two\nlines",,\n\nA2,Hall,short\n')
    assert [(r.row, r.line) for r in reading.rejected] == [(2, 5)]


@given(st.lists(st.text('ab,"\n\r;\0\x1cé', max_size=30), min_size=1, max_size=12))
@settings(max_examples=examples(150), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_row_is_accounted_for_in_any_file(read: Read, lines: list[str]) -> None:
    """The fixture asserts rows == items + rejected; the good last row is there whatever stands above it."""
    reading = read(HEADER + "\n".join(lines) + f"\n{GOOD.replace('B1', 'LAST')}")
    numbers = [item.object_number for item in reading.items]
    assert numbers[-1] == "LAST"
    assert len(set(numbers)) == len(numbers)
    assert all(rejected.message and rejected.remedy for rejected in reading.rejected)


def test_broken_quotes_everywhere_do_not_take_for_ever(read: Read, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of these lines opens a quote that no later line closes: read naively, 20,000 lines are read 2e8 times.

    Every day it is given up after an eighth of what it may take.
    """
    monkeypatch.setattr(delimited, "RESCUE_LIMIT", delimited.RESCUE_LIMIT >> (0 if SOAK else 3))
    with pytest.raises(CollectionError, match="too many rows with broken quotation marks"):
        read(HEADER + 'a","\n' * 20_000)


# ---------------------------------------------------------------------------------------------------------------------
# Files


def test_a_byte_order_mark_is_no_part_of_the_header(read: Read) -> None:
    assert one(read(b"\xef\xbb\xbf" + (HEADER + GOOD).encode())).object_number == "B1"


def test_other_encodings(read: Read) -> None:
    latin = MAPPING.replace('"utf-8"', '"cp1252"')
    assert one(read(f"{HEADER}A1,Hall,Vénus – 5€,,\n".encode("cp1252"), latin)).title == "Vénus – 5€"
    wide = MAPPING.replace('"utf-8"', '"utf-16"')
    assert one(read(f"{HEADER}A1,Hall,Vénus,,\n".encode("utf-16"), wide)).title == "Vénus"
    with pytest.raises(CollectionError, match="begins with the mark of UTF-8, and the mapping says cp1252"):
        read(b"\xef\xbb\xbf" + (HEADER + GOOD).encode(), latin)
    with pytest.raises(CollectionError, match=r"the header cannot be read: byte 0xff .* as utf-8"):
        read((HEADER + GOOD).encode("utf-16"))
    with pytest.raises(CollectionError, match=r"near line \d+: byte .* cannot be read as utf-16"):
        read((HEADER + GOOD).encode("utf-16")[:-1], wide)


@pytest.mark.parametrize("content", ["", "\n\n", HEADER, HEADER + "\n\r\n"])
def test_an_empty_collection(content: str, read: Read) -> None:
    with pytest.raises(CollectionError, match="empty collection") as refused:
        read(content)
    assert refused.value.exit_code == 5


def test_files_that_cannot_be_read(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> None:
    mapping = make_mapping(MAPPING)
    with pytest.raises(CollectionError, match="cannot be read: No such file"):
        read_items(tmp_path / "absent.csv", mapping)
    with pytest.raises(CollectionError, match="not a file"):
        read_items(tmp_path, mapping)
    with pytest.raises(MappingError, match="has no column 'accession_number'"):
        read_items(tmp_path / "mapping.toml", load_mapping("carnegie"))


def test_a_file_beyond_the_limit_is_not_even_opened(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> None:
    """A sparse file: 1 GiB and a byte of holes that take no room on the disk."""
    path = tmp_path / "large.csv"
    with path.open("wb") as stream:
        stream.truncate(STANDARD.bytes + 1)
    with pytest.raises(CollectionError, match="1,073,741,825 bytes, more than 1,073,741,824"):
        read_items(path, make_mapping(MAPPING))


def test_a_line_without_end(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> None:
    path = tmp_path / "endless.csv"
    with path.open("wb") as stream:
        stream.truncate(20 << 20)
    with pytest.raises(CollectionError, match="a row of more than 16,777,216 characters"):
        read_items(path, make_mapping(MAPPING))


def test_too_many_rows_and_too_many_bytes(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> None:
    path = tmp_path / "m.csv"
    path.write_text(HEADER + "1,H,,,\n2,H,,,\n", encoding="utf-8")
    two = Limits(bytes=path.stat().st_size, rows=2)
    assert read_items(path, make_mapping(MAPPING), two).rows == 2
    with pytest.raises(CollectionError, match=r"m\.csv: more than 1 rows; .* raise \[limits\] rows"):
        read_items(path, make_mapping(MAPPING), replace(two, rows=1))
    with pytest.raises(CollectionError, match=r"bytes, more than .* raise \[limits\] megabytes"):
        read_items(path, make_mapping(MAPPING), replace(two, bytes=two.bytes - 1))


def test_a_source_that_comes_too_slowly(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> None:
    """The clock is looked at between rows: a pipe behind a share may give one every minute."""
    path = tmp_path / "m.csv"
    path.write_text(HEADER + "".join(f"{n},H,,,\n" for n in range(20_000)), encoding="utf-8")
    with pytest.raises(
        CollectionError, match=r"m\.csv, row [\d,]+: reading took more than 0.001 s; .*\[limits\] seconds"
    ):
        read_items(path, make_mapping(MAPPING), Limits(seconds=0.001))


def test_the_field_limit_of_other_readers_is_left_alone(read: Read) -> None:
    before = csv.field_size_limit()
    read(HEADER + GOOD)
    assert csv.field_size_limit() == before


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("approx. two feet", "a number in words is not read: 'two feet'"),
        ("H 10 cm; width one and a half inches", "a number in words is not read: 'one and a half inches'"),
        ("see file", "the text 'see file' holds no dimension that can be read"),
        ("No. 12", "the text 'No. 12' holds no dimension that can be read"),
        ("Dimensions variable", None),
        ("10 min.", None),
        ("H 10 cm, four handles", "not understood: 'four handles'"),
        ("-", None),
    ],
)
def test_a_text_from_which_nothing_is_read_is_named(text: str, told: str | None, read: Read) -> None:
    content = f'number,location,title,height,mass,size\n1,Hall,Cup,,,"{text}"\n'
    (item,) = read(content, MAPPING + '[dimensions]\ncolumns = ["size"]\n').items
    assert [p.message for p in item.problems if p.field == "dimensions"] == ([] if told is None else [told])


@pytest.mark.parametrize("said", ["none", "No", "-", "keine", "aucun", "нет", "なし", "0", "n/a"])
def test_a_word_for_none_is_no_isolator(said: str, tmp_path: Path) -> None:
    """What stands on an isolator that nobody described is not assessed: an object without one is."""
    file = tmp_path / "export.csv"
    file.write_text(f"object_number,gallery,title,isolator\n1,G,Vase,{said}\n2,G,Vase,LoadPoint 4\n", encoding="utf-8")
    first, second = read_items(file, load_mapping("kouros")).items
    assert (first.isolator, second.isolator) == ("", "LoadPoint 4")
