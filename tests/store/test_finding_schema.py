"""The record, the table and the published schema of a finding agree; those of a decision too."""

import json
import math
from dataclasses import fields
from types import NoneType
from typing import get_args, get_type_hints

import jsonschema
import pytest
from hypothesis import given, settings

from pipeline.records import ITEM_FIELDS, Decision, Finding
from pipeline.report.files.exports import FINDING_COLUMNS
from pipeline.resources import resource
from pipeline.store import codec
from pipeline.store.schema import decision_schema, finding_schema
from pipeline.store.tables import DECISION, METADATA
from tests.soak import examples
from tests.store.run_samples import finding, values_of

NAMES = {field.name for field in fields(Finding)}


def test_record_and_schema_have_the_same_fields() -> None:
    properties = finding_schema()["properties"]
    assert set(properties) - {"run"} == NAMES == set(finding_schema()["required"])
    hints = get_type_hints(Finding)
    optional = {name for name in NAMES if NoneType in get_args(hints[name])}
    allowing = {
        name for name, part in finding_schema()["properties"].items() if {"type": "null"} in part.get("anyOf", ())
    }
    assert (
        optional == allowing == {"demand", "low", "high", "capacity", "capacity_origin", "utilisation", "error", "mark"}
    )


def test_the_exported_table_has_the_fields_of_the_schema() -> None:
    """But the mark, which is a place on a picture; and ``outcome`` is one of the words that go with a verdict."""
    assert set(FINDING_COLUMNS) - {"run"} == NAMES - {"mark", "sentence"}


def test_the_item_has_a_column_for_each_field() -> None:
    assert set(ITEM_FIELDS) <= {column.name for column in METADATA.tables["item"].columns}


def test_the_published_file_is_the_derived_schema() -> None:
    published = json.loads(resource("schemas", "finding.schema.json").read_text(encoding="utf-8"))
    assert published == finding_schema()
    jsonschema.Draft202012Validator.check_schema(published)


@settings(deadline=None, max_examples=examples(50))
@given(values_of(Finding))
def test_every_finding_satisfies_the_schema(record: Finding) -> None:
    exported = json.loads(codec.to_json(Finding, record)) | {"run": "2031-05-01"}
    jsonschema.validate(exported, finding_schema(), cls=jsonschema.Draft202012Validator)


@pytest.mark.parametrize(
    "change", [{"verdict": "maybe"}, {"demand": "much"}, {"gallery": None}, {"gallerie": "G1"}, {"mark": {"x": 1}}]
)
def test_the_schema_refuses(change: dict[str, object]) -> None:
    good = json.loads(codec.to_json(Finding, finding("1", utilisation=math.inf)))
    jsonschema.validate(good, finding_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(good | change, finding_schema())


def test_the_decision_has_its_columns_and_its_published_schema() -> None:
    names = {field.name for field in fields(Decision)}
    assert {column.name for column in DECISION.columns} - {"seal"} == names == set(decision_schema()["properties"])
    published = json.loads(resource("schemas", "decision.schema.json").read_text(encoding="utf-8"))
    assert published == decision_schema()
    jsonschema.Draft202012Validator.check_schema(published)


@settings(deadline=None, max_examples=examples(50))
@given(values_of(Decision))
def test_every_decision_satisfies_the_schema(record: Decision) -> None:
    exported = json.loads(codec.to_json(Decision, record))
    jsonschema.validate(exported, decision_schema(), cls=jsonschema.Draft202012Validator)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(exported | {"kind": "guess"}, decision_schema())
