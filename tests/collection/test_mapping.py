"""A mapping is refused with its file, key and remedy; the published schema says the same."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path

import jsonschema
import pytest

from pipeline.collection.errors import MappingError
from pipeline.collection.mapping import (
    DIAMETER,
    MAPPABLE,
    PRESETS,
    Mapping,
    check_header,
    load_mapping,
    mapping_schema,
    preset_names,
)
from pipeline.collection.record import KINDS, units_of
from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import ITEM_FIELDS
from pipeline.resources import resource

from .conftest import MAPPING

Make = Callable[[str], Mapping]

FAULTS = {
    "typo in a field": ("height_m =", "heigth_m =", "did you mean 'height_m'"),
    "typo in a key": (
        "missing =",
        "mising =",
        r"columns\.mass_kg\.mising: there is no such key \(did you mean 'missing'",
    ),
    "typo in a section": ("[museum]", "[musem]", "musem: there is no such key .did you mean 'museum'"),
    "length without unit": (', unit = "in"', "", r"columns\.height_m: a length has no unit; add unit"),
    "mass in a unit of length": ('unit = "g"', 'unit = "cm"', "a mass cannot be in 'cm'.*kg, g, lb, oz"),
    "unknown unit": ('unit = "in"', 'unit = "inch"', "a length cannot be in 'inch'"),
    "text with a unit": ('column = "title"', 'column = "title", unit = "m"', "unit is for lengths"),
    "no object number": ('object_number = { column = "number" }\n', "", "columns.object_number is missing"),
    "problems are Kouros's own": ("title =", "problems =", "there is no such field"),
    "two kinds of source": ('column = "title"', 'column = "title", columns = ["a"]', "needs one of column"),
    "number of two columns": ('column = "height"', 'columns = ["a", "b"]', "only texts can be joined"),
    "sum of one column": ('column = "height", unit = "in"', 'column = "height", units = ["in"]', "units needs one of"),
    "sum in a unit of masses": (
        'column = "height", unit = "in"',
        'columns = ["a", "b"], units = ["ft", "kg"]',
        "units needs one of m, cm",
    ),
    "sum in a unit as well": (
        'column = "height", unit = "in"',
        'columns = ["a", "b"], units = ["ft", "in"], unit = "in"',
        "units says all of units",
    ),
    "sum of texts": ('column = "title"', 'columns = ["a", "b"], units = ["ft", "in"]', "units needs one of none"),
    "first of one column": ('column = "title"', 'column = "title", first = true', "first is for texts"),
    "opening of a number": (
        'column = "height", unit = "in"',
        'column = "height", unit = "in", opening = true',
        "opening is for texts",
    ),
    "missing number of a text": ('column = "title"', 'column = "title", missing = [0.0]', "must hold texts, in quotes"),
    "missing that is no number": ("[0.0,", "[nan,", "finite"),
    "optional number": ('column = "number"', 'column = "number", optional = true', "leave out optional"),
    "unknown encoding": ('"utf-8"', '"utf-7"', "source.encoding"),
    "long delimiter": ('delimiter = ","', 'delimiter = "||"', "source.delimiter"),
    "unknown support": (
        "title = { column",
        'support = { column = "how", values = { "text" = "freestandig" } }\ntitle = { column',
        "'text' cannot mean 'freestandig'; it must be one of freestanding",
    ),
    "quoted truth": (
        "title = { column",
        'susceptible = { column = "how", values = { "ja" = "true" } }\ntitle = { column',
        "'ja' cannot mean 'true'; it must be one of true, false",
    ),
    "values that differ in capitals": (
        'column = "title"',
        'column = "title", values = { "A" = "x", "a" = "y" }',
        "capitals only",
    ),
}

# The rules that JSON Schema states too; the others compare two values, or are about TOML's own types.
SCHEMA_SEES = [
    "typo in a field",
    "typo in a key",
    "typo in a section",
    "length without unit",
    "mass in a unit of length",
    "unknown unit",
    "text with a unit",
    "no object number",
    "problems are Kouros's own",
    "two kinds of source",
    "unknown encoding",
    "long delimiter",
]


@cache
def schema() -> jsonschema.Draft202012Validator:
    """The schema of mappings, made once: that it is one itself is tested once."""
    return jsonschema.Draft202012Validator(mapping_schema())


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_named_with_file_key_and_remedy(fault: str, make_mapping: Make) -> None:
    before, after, message = FAULTS[fault]
    assert MAPPING.count(before) == 1
    with pytest.raises(MappingError, match=message) as refused:
        make_mapping(MAPPING.replace(before, after))
    assert str(refused.value).startswith("mapping.toml: ")
    assert refused.value.exit_code == 2


@pytest.mark.parametrize("fault", SCHEMA_SEES)
def test_the_schema_refuses_what_python_refuses(fault: str) -> None:
    before, after, _ = FAULTS[fault]
    with pytest.raises(jsonschema.ValidationError):
        schema().validate(tomllib.loads(MAPPING.replace(before, after)))


def test_the_published_schema_is_the_models() -> None:
    published = json.loads(resource("schemas", "mapping.schema.json").read_text(encoding="utf-8"))
    assert published == mapping_schema()
    jsonschema.Draft202012Validator.check_schema(published)


@pytest.mark.parametrize("name", preset_names())
def test_presets_load_and_fit_the_schema(name: str) -> None:
    assert load_mapping(name).name == name
    schema().validate(tomllib.loads((PRESETS / f"{name}.toml").read_text(encoding="utf-8")))


def test_the_template_sheet_has_every_field_under_its_own_name() -> None:
    columns = load_mapping("kouros").columns
    assert set(columns) == {*ITEM_FIELDS, DIAMETER} - {"dimensions", "provenance", "problems"} == set(MAPPABLE)
    texts = load_mapping("kouros").dimensions
    assert texts is not None
    assert (texts.columns, texts.optional) == (("dimensions",), True)
    assert all(column.column == field for field, column in columns.items())
    assert [field for field, column in columns.items() if not column.optional] == ["object_number", "gallery"]


def test_every_length_and_mass_of_the_record_needs_a_unit() -> None:
    """The contract writes a field's unit at the end of its name; a polygon's coordinates are lengths."""
    for field in MAPPABLE:
        length = field.endswith("_m") or KINDS.get(field) == "polygon"
        assert units_of(field) == (LENGTHS if length else MASSES if field.endswith("_kg") else {})


def test_an_unknown_name_lists_the_presets() -> None:
    with pytest.raises(MappingError, match=r"'carnegi' is neither.*carnegie, .*kouros.*did you mean 'carnegie'"):
        load_mapping("carnegi")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[source\n", "not TOML.*line 1.*quote texts"),
        (b"[display]\n[source]\n[display]\n", "not TOML.*line 3.*below the first"),
        (b'name = "\xff"', "byte 8 is not UTF-8"),
        (b"", "source: Field required"),
    ],
)
def test_files_that_are_no_mapping(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(MappingError, match=rf"broken\.toml: {message}"):
        load_mapping(path)


def test_a_column_that_is_not_in_the_file(make_mapping: Make) -> None:
    mapping = make_mapping(MAPPING)
    header = ["number", "location", "title", "heigth", "mass"]
    with pytest.raises(MappingError) as refused:
        check_header(mapping, "museum.csv", header)
    for word in ("mapping.toml", "columns.height_m", "'height'", "did you mean 'heigth'", *map(repr, header)):
        assert word in str(refused.value)


def test_a_column_that_is_there_twice(make_mapping: Make) -> None:
    with pytest.raises(MappingError, match=r"columns\.title: museum\.csv has 2 columns named 'title'; rename"):
        check_header(make_mapping(MAPPING), "museum.csv", ["number", "location", "title", "height", "mass", "title"])


def test_a_slip_in_the_template_sheets_header_is_not_lost() -> None:
    check_header(load_mapping("kouros"), "sheet.csv", ["object_number", "gallery", "height_m"])
    with pytest.raises(MappingError, match=r"'hieght_m' that the mapping does not know \(did you mean 'height_m'"):
        check_header(load_mapping("kouros"), "sheet.csv", ["object_number", "gallery", "hieght_m"])


def test_mappings_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="frozen"):
        load_mapping("carnegie").museum.name = "Another"  # type: ignore[misc]
