"""The findings, recommendations and objects of a run as files that other programs read.  SI throughout."""

import csv
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from math import isfinite, isnan
from pathlib import Path
from typing import Any

from pipeline.records import Finding, Recommendation, RunRecord
from pipeline.report.compose import object_rows
from pipeline.report.units import Units
from pipeline.report.workbook import write_workbook

_NUMBERS = ("demand", "low", "high", "capacity", "utilisation", "error")
FINDING_COLUMNS = (
    "run",
    "object_number",
    "gallery",
    "level",
    "model",
    "title",
    "demand_name",
    "demand",
    "unit",
    "low",
    "high",
    "capacity",
    "capacity_origin",
    "utilisation",
    "verdict",
    "outcome",
    "fidelity",
    "error",
    "decided_by",
    "motion",
    "motion_hash",
    "screen",
    "note",
    "assumptions",
    "version",
)
RECOMMENDATION_COLUMNS = (
    "run",
    "object_number",
    "gallery",
    "level",
    "measure",
    "title",
    "sentence",
    "parameters",
    "checks",
    "rejected",
    "source",
)
OBJECT_COLUMNS = (
    "run",
    "object_number",
    "title",
    "gallery",
    "on_display",
    "state",
    "object_class",
    "missing",
    "median_g",
    "median_is",
    "dispersion",
    "annual_rate",
    "page",
)


def export(record: RunRecord, folder: Path, units: Units) -> None:
    """Write findings.csv, .jsonl and .parquet, recommendations.csv and objects.csv, and all three in findings.xlsx.

    Numbers are in SI; ``unit`` names the unit of demand, low, high, capacity and error.  CSV files are UTF-8 with a
    header row; an unknown number is an empty cell and an endless one is ``inf``.  In CSV a text that starts with
    ``=``, ``+``, ``-``, ``@``, a tab or a carriage return gets a leading apostrophe, because a spreadsheet would run
    it as a formula; JSON Lines and Parquet keep the text as it is.  JSON has no infinity: it is the text "inf" there.
    Only the sentences of recommendations.csv are in the reader's units.  objects.csv has one row for every object,
    so that what could not be assessed is not lost.  In the workbook a text is a text whatever it begins with.

    raises : FileNotFoundError if the folder does not exist
    """
    findings = [_finding(record.run_id, f) for a in record.assessments for f in a.findings]
    recommendations = [_recommendation(record.run_id, r, units) for a in record.assessments for r in a.recommendations]
    _write_csv(folder / "findings.csv", FINDING_COLUMNS, findings)
    _write_csv(folder / "recommendations.csv", RECOMMENDATION_COLUMNS, recommendations)
    objects = object_rows(record)
    _write_csv(folder / "objects.csv", OBJECT_COLUMNS, objects)
    lines = (json.dumps({k: _json(row[k]) for k in FINDING_COLUMNS}, allow_nan=False) for row in findings)
    (folder / "findings.jsonl").write_text("".join(line + "\n" for line in lines), encoding="utf-8", newline="\n")
    _write_parquet(folder / "findings.parquet", findings)
    tables: dict[str, tuple[Sequence[str], Iterable[Mapping[str, Any]]]] = {
        "findings": (FINDING_COLUMNS, findings),
        "recommendations": (RECOMMENDATION_COLUMNS, recommendations),
        "objects": (OBJECT_COLUMNS, objects),
    }
    write_workbook(folder / "findings.xlsx", tables, _began(record.started))


_BEGINS = frozenset("=+-@\t\r\n\uff1d\uff0b\uff0d\uff20")
_INSIDE = re.compile("([;\t\r\n])(?=[=+\\-@\uff1d\uff0b\uff0d\uff20])")
"""Where a formula begins for programs that cut the line of a CSV file at other separators than the comma, whatever its
quotation marks say: spreadsheets of countries that write decimal commas cut at semicolons."""


def safe_cell(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula: an apostrophe goes before = + - @ tab and return.

    The same goes for signs of full width, and after a semicolon, a tab or a line end within the text.
    """
    fit = _encodable(text)
    if _INSIDE.search(fit):
        fit = _INSIDE.sub(r"\1'", fit)
    return "'" + fit if fit[:1] in _BEGINS else fit


def _began(started: str) -> datetime:
    try:
        return datetime.fromisoformat(started)
    except ValueError:
        return datetime(1980, 1, 1, tzinfo=UTC)


def _finding(run: str, f: Finding) -> dict[str, Any]:
    row: dict[str, Any] = {name: getattr(f, name) for name in FINDING_COLUMNS if name != "run"}
    row["run"] = run
    row["verdict"] = f.verdict.value
    row["capacity_origin"] = f.capacity_origin.value if f.capacity_origin else None
    row["assumptions"] = list(f.assumptions)
    return row


def _recommendation(run: str, r: Recommendation, units: Units) -> dict[str, Any]:
    values: dict[str, tuple[float | None, str]] = {k: (v, r.units.get(k, "")) for k, v in r.parameters.items()}
    return {
        "run": run,
        "object_number": r.object_number,
        "gallery": r.gallery,
        "level": r.level,
        "measure": r.measure,
        "title": r.title,
        "sentence": units.fill(r.sentence, values, f"object {r.object_number}, recommendation {r.measure}"),
        "parameters": [f"{k}={v!r} {r.units.get(k, '')}".rstrip() for k, v in r.parameters.items()],
        "checks": [
            f"{c.model}: {'' if c.before is None else f'{c.before!r} -> '}{c.demand!r} of {c.capacity!r} {c.unit}, "
            f"{'passes' if c.passes else 'fails'}"
            for c in r.checks
        ],
        "rejected": list(r.rejected),
        "source": r.source,
    }


def _write_csv(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        for row in rows:
            writer.writerow([_cell(row[name]) for name in columns])


def _cell(value: object) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case float() | int():
            return "" if isnan(value) else repr(float(value))
        case list():
            return safe_cell("; ".join(str(v) for v in value))
        case _:
            return safe_cell(str(value))


def _json(value: object) -> object:
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else str(value)
    return value


def _write_parquet(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    kinds = {name: pa.float64() for name in _NUMBERS} | {"assumptions": pa.list_(pa.string())}
    schema = pa.schema([(name, kinds.get(name, pa.string())) for name in FINDING_COLUMNS])
    fit = [{k: _encodable(v) if isinstance(v, str) else v for k, v in row.items()} for row in rows]
    for row in fit:
        row["assumptions"] = [_encodable(text) for text in row["assumptions"]]
    pq.write_table(pa.Table.from_pylist(fit, schema=schema), path)


def _encodable(text: str) -> str:
    # A lone surrogate, as a badly decoded file leaves behind, cannot be written as UTF-8 at all.
    return text if text.isascii() else text.encode("utf-8", "replace").decode("utf-8")
