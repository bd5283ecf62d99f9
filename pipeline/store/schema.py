"""The published JSON Schemas of a finding and of a decision, derived from the records."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from pipeline.records import Decision, Finding, Verdict
from pipeline.store import codec

_MEANING = {
    "object_number": "the museum's number of the object",
    "gallery": "the gallery it stands in",
    "level": "the level of shaking, as the site's manifest names it",
    "model": "the generic model; `kouros models` describes it",
    "title": "the failure in the field's words",
    "demand_name": "the output of the model that is set against the capacity",
    "demand": "what the motion asks of the object by the best estimates, in the unit of the finding, an upper bound "
    "where the fidelity is bound and the error is not 0; null where it could not be computed",
    "unit": "unit of demand, low, high, capacity and error; 1 for a ratio",
    "low": "lower end of the range of the demand over the best estimates and all corners of the uncertain inputs",
    "high": "upper end of that range",
    "range_is": "demands where low and high are such; bounds where that range lies between them for certain",
    "capacity": "what the object can bear, in the unit of the finding; null where it is not known",
    "capacity_origin": "whether the capacity was measured, derived, stated by a house rule or assumed",
    "utilisation": "demand / capacity",
    "verdict": "pass, fail, or undetermined where the range of the demand spans the capacity or something is missing",
    "fidelity": "bound, chart, history or reference, from cheapest to dearest",
    "error": "numerical error of the demand, estimated, in its unit; of a bound, how much less it may be",
    "decided_by": "what settled the verdict: a certificate, a chart or a history",
    "motion": "name of the motion",
    "motion_hash": "SHA-256 of the motion's time step and samples",
    "sentence": "what it means; {demand}, {capacity}, {low} and {high} are to be filled in the reader's units",
    "screen": "the closed-form criterion in words; reported, never deciding",
    "outcome": "what the object does by the best estimates beyond its capacity; empty where it stays within",
    "note": "what a specialist should know about the computation",
    "assumptions": "every default that was used, with its source",
    "mark": "where the object lies on a chart of the run; null where it is on none",
    "version": "version of Kouros",
}

_DECIDED = {
    "id": "counts up; decisions are never changed",
    "object_number": "the museum's number of the object",
    "kind": "accepted risk, installed measure, decided class, overruled verdict, or withdrawal of an earlier decision",
    "who": "who decided",
    "date": "the day of the decision, ISO 8601",
    "why": "the reason, in that person's words",
    "recorded": "when it was written down, ISO 8601, UTC",
    "model": "the generic model that is accepted or overruled; empty for all",
    "level": "the level of shaking that it is about; empty for all",
    "until": "the last day on which the risk is accepted, ISO 8601; empty for no end",
    "measure": "the measure that is installed: a row of tables/measures.csv",
    "parameters": "its parameters by name, in SI units",
    "units": "the unit of each parameter",
    "product": "maker and type of what is installed, as text",
    "object_class": "the class that the object is said to be: a row of tables/classes.csv",
    "verdict": "the verdict that the person gives; the computed one stays beside it",
    "withdraws": "the id of the decision that this one ends",
    "run": "the run that was looked at; empty where there was none",
    "digest": "digest of the object's record at that time",
    "basis": "the findings that were looked at",
}


def decision_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of one decision, as `kouros decide --list --json` prints them.

    Raises
    ------
    KeyError
        For a field of the record that is not described here.
    """
    return _schema(Decision, "Kouros decision", "What a person decided about an object.", _DECIDED)


def finding_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of one finding as it is exported, one a line in JSON Lines.

    A float that is not finite is one of the strings "Infinity", "-Infinity", "NaN".  ``run`` names the run in an export
    (the column ``run_id`` in SQL); the record itself does not carry it.

    Returns
    -------
    dict

    Raises
    ------
    KeyError
        For a field of the record that is not described here.
    """
    about = f"One demand set against one capacity; verdicts are {', '.join(Verdict)}."
    run = {"run": {"description": "the run that found it", "type": "string"}}
    return _schema(Finding, "Kouros finding", about, _MEANING, run)


def _schema(
    record: type[Any],
    title: str,
    about: str,
    meaning: Mapping[str, str],
    besides: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    hint: Any = record
    derived = codec.adapter(hint).json_schema(mode="serialization")
    definitions = {name: _readable(part) for name, part in derived["$defs"].items()}
    whole = definitions.pop(record.__name__)
    names = [field.name for field in fields(record)]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "description": about,
        "type": "object",
        "properties": {
            **(besides or {}),
            **{name: {"description": meaning[name]} | whole["properties"][name] for name in names},
        },
        "required": names,
        "additionalProperties": False,
        "$defs": definitions | {"Number": {"anyOf": [{"type": "number"}, {"enum": list(codec.NOT_FINITE)}]}},
    }


def _readable(part: Any) -> Any:
    """Drop pydantic's made-up titles and defaults, and let every number be not finite too."""
    if isinstance(part, list):
        return [_readable(entry) for entry in part]
    if not isinstance(part, dict):
        return part
    if part.get("type") == "number":
        return {"$ref": "#/$defs/Number"}
    if "properties" in part:
        named = {name: _readable(entry) for name, entry in part["properties"].items()}
        return {"type": "object", "properties": named, "required": list(named), "additionalProperties": False}
    return {key: _readable(value) for key, value in part.items() if key not in {"title", "default"}}
