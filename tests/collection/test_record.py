"""The record in Python, in SQL and in JSON Schema has the same fields; real items fit the schema."""

from __future__ import annotations

import json
from dataclasses import fields

import jsonschema
import pytest

from pipeline.collection.inventory import ITEM
from pipeline.collection.mapping import DIAMETER
from pipeline.collection.record import KINDS, item_schema, plausible, to_items, to_records
from pipeline.records import Item, Problem, Support
from pipeline.resources import resource
from tests.museum import carnegie
from tests.soak import SOAK

SCHEMA = json.loads(resource("schemas", "item.schema.json").read_text(encoding="utf-8"))


def test_the_published_schema_is_the_records() -> None:
    assert item_schema() == SCHEMA
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_python_sql_and_json_have_the_same_fields() -> None:
    names = [f.name for f in fields(Item)]
    assert names == list(SCHEMA["properties"])
    assert [*names, "since", "until", "digest", "assessment_digest", "seal"] == list(ITEM.columns.keys())
    assert not SCHEMA["additionalProperties"]
    assert [c.name for c in ITEM.primary_key] == ["object_number", "since"]


def test_what_may_be_null_is_the_same_everywhere() -> None:
    for f in fields(Item):
        in_python = "None" in str(f.type)
        in_json = {"type": "null"} in SCHEMA["properties"][f.name].get("anyOf", [])
        assert in_python == in_json == ITEM.columns[f.name].nullable, f.name


def test_every_number_has_a_plausible_range_and_a_reason() -> None:
    numbers = {name for name, kind in KINDS.items() if kind in ("number", "integer", "polygon")}
    assert set(plausible()) == numbers | {DIAMETER}
    for limits in plausible().values():
        assert limits.low < limits.high
        assert limits.reason
    for name in numbers:
        assert plausible()[name].reason in SCHEMA["properties"][name]["description"]


@pytest.mark.long("collection/test_real_files::test_every_row_is_accounted_for_and_fits_the_schema")
def test_every_carnegie_item_fits_the_schema() -> None:
    items = list(carnegie().items)
    validator = jsonschema.Draft202012Validator(SCHEMA)
    # Every day each eighth: what the schema's own library takes for one is a millisecond and a half.
    for record in to_records(items[:: 1 if SOAK else 8]):
        validator.validate(json.loads(json.dumps(record)))
    assert to_items(to_records(items)) == items


@pytest.mark.parametrize(
    "change",
    [{"height_m": 51.0}, {"height_m": "1"}, {"support": "floating"}, {"gallery": ""}, {"weight": 1}, {"title": None}],
)
def test_the_schema_refuses_other_records(change: dict[str, object]) -> None:
    good = to_records([Item("1", "Hall", support=Support.HUNG, problems=(Problem("title", "short", "lengthen it"),))])[
        0
    ]
    jsonschema.validate(good, SCHEMA)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**good, **change}, SCHEMA)
