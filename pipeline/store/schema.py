"""The published JSON Schema of a finding, derived from the record."""

from dataclasses import fields
from typing import Any

from pipeline.records import Finding, Verdict
from pipeline.store import codec

_MEANING = {
    "object_number": "the museum's number of the object",
    "gallery": "the gallery it stands in",
    "level": "the level of shaking, as the site's manifest names it",
    "model": "the generic model; `kouros models` describes it",
    "title": "the failure in the field's words",
    "demand_name": "the output of the model that is set against the capacity",
    "demand": "what the motion asks of the object, in the unit of the finding; null where it could not be computed",
    "unit": "unit of demand, low, high, capacity and error",
    "low": "lower end of the range of the demand that the uncertain inputs span",
    "high": "upper end of that range",
    "capacity": "what the object can bear, in the unit of the finding; null where it is not known",
    "capacity_origin": "whether the capacity was measured, derived or assumed",
    "utilisation": "demand / capacity",
    "verdict": "pass, fail, or undetermined where the range of the demand spans the capacity or something is missing",
    "fidelity": "bound, chart, history or reference, from cheapest to dearest",
    "error": "numerical error of the demand, estimated, in the unit of the finding",
    "decided_by": "what settled the verdict: a certificate, a chart or a history",
    "motion": "name of the motion",
    "motion_hash": "SHA-256 of the motion's time step and samples",
    "sentence": "what it means; {demand}, {capacity}, {low} and {high} are to be filled in the reader's units",
    "screen": "the closed-form criterion in words; reported, never deciding",
    "outcome": "what happens to the object",
    "note": "what a specialist should know about the computation",
    "assumptions": "every default that was used, with its source",
    "mark": "where the object lies on a chart of the run; null where it is on none",
    "version": "version of Kouros",
}


def finding_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of one finding as it is exported, one a line in JSON Lines.

    A float that is not finite is one of the strings "Infinity", "-Infinity", "NaN".  ``run`` names the run in an export
    (the column ``run_id`` in SQL); the record itself does not carry it.
    raises : KeyError for a field of the record that is not described here
    """
    derived = codec.adapter(Finding).json_schema(mode="serialization")
    definitions = {name: _readable(part) for name, part in derived["$defs"].items()}
    record = definitions.pop("Finding")
    names = [field.name for field in fields(Finding)]
    properties = {name: {"description": _MEANING[name]} | record["properties"][name] for name in names}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Kouros finding",
        "description": f"One demand set against one capacity; verdicts are {', '.join(Verdict)}.",
        "type": "object",
        "properties": {"run": {"description": "the run that found it", "type": "string"}} | properties,
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
