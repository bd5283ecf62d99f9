"""The findings, recommendations and objects of a run as files that other programs read.  SI throughout."""

import csv
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from math import isfinite, isnan
from pathlib import Path
from typing import Any

from pipeline.records import Assessment, Finding, Harm, Recommendation, RunRecord, Scene, Urgency
from pipeline.report.files.object_list import LISTED
from pipeline.report.files.ranks import KEYS, keys_part
from pipeline.report.files.workbook import write_workbook
from pipeline.report.pages.chances import chance_columns
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.judging import first_failure
from pipeline.report.pages.notes import Memory, finding_key
from pipeline.report.pages.tallies import state_of
from pipeline.report.text import encodable, safe_cell
from pipeline.report.units import Units, by_hand

_NUMBERS = (
    "demand", "low", "high", "capacity", "utilisation", "error",
    "class_probability", "class_next_probability",
    "median_g", "dispersion", "median_pgv_m_s", "goodness", "annual_rate", "chance_50_years", "chance_50_years_low",
    "chance_50_years_high", *(f"yearly_{state.value}" for state in Harm),
    "probability", "probability_error", *(f"p_{state.value}" for state in Harm), "worth", "expected_loss", "remaining",
)  # fmt: skip
_FLAGS = ("on_display", "settled", "check_sizes")
_LISTS = ("assumptions", "parameters", "checks", "rejected")
FINDING_COLUMNS = (
    "run", "object_number", "gallery", "level", "model", "title", "demand_name", "demand", "unit", "low", "high",
    "range_is", "capacity", "capacity_origin", "utilisation", "verdict", "outcome", "fidelity", "error", "decided_by",
    "motion", "motion_hash", "screen", "note", "assumptions", "version",
)  # fmt: skip
_OWN, _SHARED = FINDING_COLUMNS[:3], FINDING_COLUMNS[3:]
RECOMMENDATION_COLUMNS = (
    "run", "object_number", "gallery", "level", "measure", "title", "sentence", "parameters", "checks", "rejected",
    "remaining", "settled", "source",
)  # fmt: skip
OBJECT_COLUMNS = (
    "run", "object_number", "title", "gallery", "case", "on_display", "state", "object_class", "class_probability",
    "class_next", "class_next_probability", "furniture",
    "furniture_origin", "missing", "probability", "probability_error", "band", "harm", "harm_level",
    *(f"p_{state.value}" for state in Harm), "open_for", "worth", "expected_loss", "check_sizes",
    "median_g", "median_is", "dispersion", "median_pgv_m_s", "goodness", "annual_rate", "chance_50_years",
    "chance_50_years_low", "chance_50_years_high", *(f"yearly_{state.value}" for state in Harm), "page", "rank",
)  # fmt: skip


TABLES = {"findings": FINDING_COLUMNS, "recommendations": RECOMMENDATION_COLUMNS, "objects": OBJECT_COLUMNS}
"""The exported tables, each as CSV and Parquet; findings and objects as JSON Lines too, and all as one workbook."""

RANK = "rank"
"""The last column of the objects: their place among all of the report, which no part of it can know."""

_OF_PARTS = TABLES | {"objects": OBJECT_COLUMNS[: OBJECT_COLUMNS.index(RANK)]}

HEADERS = {f"{name}.csv": (",".join(columns) + "\n").encode() for name, columns in _OF_PARTS.items()}
"""What the CSV files of the parts begin with."""

TEXTS = ("findings.csv", "findings.jsonl", "recommendations.csv", "objects.csv", "objects.jsonl")
EXPORTS = (*TEXTS, *(f"{name}.parquet" for name in TABLES))
"""The exports of a report."""

PARTS_OF_PAGE = (*TEXTS, *(f"{name}.arrow" for name in TABLES), KEYS, LISTED)
"""The files with what a page adds to the exports, to the order of all objects, and to their list.

Of an export in texts the part is a whole file of the same kind.  Of a table it is one in Arrow's format of files: a
Parquet file of a few hundred rows takes ten times as long to read, and every night reads them all.
"""

WORKBOOK = "findings.xlsx"

WORKBOOK_ROWS = 10_000
"""Rows of a table up to which there is a workbook; a spreadsheet holds more, but writing them takes minutes."""


@dataclass(frozen=True, slots=True)
class _RowRest:
    """What a row says of a finding, whichever object it is of: cells, and the rest of a line of CSV and of JSON."""

    cells: Mapping[str, Any]
    csv: str
    json: str


class FindingRows:
    """Findings as rows of the exports: what does not name the object is written once for all that share it."""

    def __init__(self) -> None:
        self._said: Memory[_RowRest] = Memory()

    def of(self, run: str, findings: Iterable[Finding]) -> tuple[list[dict[str, Any]], str, str]:
        """Return findings as rows, as lines of CSV and as lines of JSON.

        Parameters
        ----------
        run : str
            Identity of the run that found them.

        Returns
        -------
        tuple[list[dict[str, Any]], str, str]
        """
        rows, lines, objects = [], [], []
        begun: dict[tuple[str, str], tuple[dict[str, Any], str, str]] = {}
        for f in findings:
            said = self._said.had(finding_key(f), lambda f=f: _said(f))  # type: ignore[misc]
            own = f.object_number, f.gallery
            if own not in begun:
                names = dict(zip(_OWN, (run, *own), strict=True))
                begun[own] = names, _csv(_OWN, [names])[:-1] + ",", json.dumps(names)[:-1] + ", "
            names, line, one = begun[own]
            rows.append({**names, **said.cells})
            lines.append(line + said.csv)
            objects.append(one + said.json)
        return rows, "".join(lines), "".join(objects)


def _said(f: Finding) -> _RowRest:
    cells: dict[str, Any] = {name: getattr(f, name) for name in _SHARED}
    cells["unit"] = exported_unit(f.unit)
    cells["verdict"] = f.verdict.value
    cells["capacity_origin"] = f.capacity_origin.value if f.capacity_origin else None
    cells["assumptions"] = list(f.assumptions)
    told = json.dumps({name: _json(cells[name]) for name in _SHARED}, allow_nan=False)
    return _RowRest(cells, _csv(_SHARED, [cells]), told[1:] + "\n")


def page_exports(
    record: RunRecord,
    run: str,
    page: str,
    anchors: Callable[[Assessment], str],
    keys: Callable[[Assessment], Urgency | None],
    units: Units,
    findings: FindingRows,
) -> dict[str, bytes]:
    """Return the part of every export that holds the objects of one page.

    Numbers are in SI; ``unit`` names the unit of demand, low, high, capacity and error, 1 for a ratio.  ``range_is``
    says whether low and high are demands, or bounds around them.  CSV files are UTF-8 with a header row; an unknown
    number is an empty cell and an endless one is ``inf``.  In CSV a text that starts with ``=``, ``+``, ``-``, ``@``, a
    tab or a carriage return gets a leading apostrophe, because a spreadsheet would run it as a formula; JSON Lines and
    Parquet keep the text as it is.  JSON has no infinity: it is the text "inf" there.  Only the sentences of
    recommendations are in the reader's units.  objects.csv has one row for every object, so that what could not be
    assessed is not lost; its rank is not in a part, but the key that gives it is.

    Parameters
    ----------
    record : RunRecord
        The run with the objects of this page only.
    run : str
        Identity of the run that found them.
    page : str
        File of the page.
    anchors : callable
        Gives the id of an object on it.
    keys : callable
        Gives what sorts an object among all of the report; None for one that has no rank.
    units : Units
        The reader's, for sentences.
    findings : FindingRows
        Those of other pages of the run.

    Returns
    -------
    dict of str to bytes
        By name of the part, see `PARTS_OF_PAGE`; without that of the list of all objects.
    """
    decided = Decided(record.decisions, units)
    found, lines, objects = findings.of(run, (f for a in record.assessments for f in a.findings))
    rows: dict[str, Sequence[Mapping[str, Any]]] = {
        "findings": found,
        "recommendations": [
            _recommendation(run, r, units) | {"settled": decided.covered(a, r.level)}
            for a in record.assessments
            for r in a.recommendations
        ],
        "objects": [_object(run, a, f"{page}#{anchors(a)}") for a in record.assessments],
    }
    told = {name: _csv(_OF_PARTS[name], rows[name]) for name in ("recommendations", "objects")} | {"findings": lines}
    parts = {f"{name}.csv": HEADERS[f"{name}.csv"] + told[name].encode() for name in TABLES}
    parts["findings.jsonl"] = objects.encode()
    parts["objects.jsonl"] = "".join(map(_line, rows["objects"])).encode()
    parts[KEYS] = keys_part([keys(a) for a in record.assessments])
    return parts | {f"{name}.arrow": table_part(name, rows[name]) for name in TABLES}


def write_exports_workbook(folder: Path, started: str) -> bool:
    """Write findings.xlsx from the Parquet files of a folder, unless one has more than WORKBOOK_ROWS rows.

    In it a text is a text whatever it begins with.

    Parameters
    ----------
    folder : Path
        The report's.
    started : str
        When the run began (ISO 8601), as the workbook's own date.

    Returns
    -------
    bool
        Whether it was written.
    """
    import pyarrow.parquet as pq

    files = {name: folder / f"{name}.parquet" for name in TABLES}
    if any(pq.read_metadata(file).num_rows > WORKBOOK_ROWS for file in files.values()):
        return False
    tables: dict[str, tuple[Sequence[str], Iterable[Mapping[str, Any]]]] = {
        name: (TABLES[name], pq.read_table(file, partitioning=None).to_pylist()) for name, file in files.items()
    }
    write_workbook(folder / WORKBOOK, tables, _began(started))
    return True


ONE = "1"
"""The unit of a ratio, as UCUM writes it."""


def _began(started: str) -> datetime:
    try:
        return datetime.fromisoformat(started)
    except ValueError:
        return datetime(1980, 1, 1, tzinfo=UTC)


def exported_unit(unit: str) -> str:
    """Return a unit as other programs read it: 1 for a ratio, which a "-" would be a formula to a spreadsheet."""
    return ONE if unit == "-" else unit


def sentence_of(r: Recommendation, units: Units) -> str:
    """Return the words of a recommendation with its numbers in the reader's units."""
    values: dict[str, tuple[float | None, str]] = {k: (v, r.units.get(k, "")) for k, v in r.parameters.items()}
    return units.fill(r.sentence, values, f"object {r.object_number}, recommendation {r.measure}", by_hand(units))


def _recommendation(run: str, r: Recommendation, units: Units) -> dict[str, Any]:
    return {
        "run": run,
        "object_number": r.object_number,
        "gallery": r.gallery,
        "level": r.level,
        "measure": r.measure,
        "title": r.title,
        "sentence": sentence_of(r, units),
        "parameters": [f"{k}={v!r} {exported_unit(r.units.get(k, ''))}".rstrip() for k, v in r.parameters.items()],
        "checks": [
            f"{c.model}: {'' if c.before is None else f'{c.before!r} -> '}{c.demand!r} of {c.capacity!r} "
            f"{exported_unit(c.unit)}, {'passes' if c.passes else 'fails'}"
            for c in r.checks
        ],
        "rejected": list(r.rejected),
        "remaining": r.remaining,
        "source": r.source,
    }


NOT_SHOWN = "not on display"
"""The state of an object that was left aside, in the exports."""


def _object(run: str, a: Assessment, page: str) -> dict[str, Any]:
    """Return the plain row of an object, assessed or not, for the export that adds up to all."""
    item = a.scene.item
    return {
        "run": run,
        "object_number": item.object_number,
        "title": item.called,
        "gallery": item.gallery,
        "case": item.case,
        "on_display": item.on_display,
        "state": NOT_SHOWN if a.aside else state_of(a).value,
        "object_class": a.scene.object_class,
        **_class_chances(a.scene),
        "furniture": a.scene.furniture,
        "furniture_origin": a.scene.furniture_origin,
        "missing": "" if a.aside else "; ".join(a.scene.missing),
        **chance_columns(a),
        **first_failure(a),
        "page": page,
    }


def _class_chances(scene: Scene) -> dict[str, Any]:
    """Return how sure the class is, and the next likely one where that is likely at all."""
    sure = dict(scene.chances).get(scene.object_class)
    other = scene.next_class
    return {
        "class_probability": sure,
        "class_next": "" if other is None else other[0],
        "class_next_probability": None if other is None else other[1],
    }


def _line(row: Mapping[str, Any]) -> str:
    return json.dumps({name: _json(row[name]) for name in _OF_PARTS["objects"]}, allow_nan=False) + "\n"


class _CsvLine:
    """Takes a line of CSV in place of a file, and gives it back."""

    def write(self, line: str) -> str:
        return line


def _csv(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    writer: Any = csv.writer(_CsvLine(), lineterminator="\n")
    return "".join([writer.writerow([_cell(row[name]) for name in columns]) for row in rows])


def _cell(value: object) -> str:
    # There are a hundred to an object, most of them nothing, numbers and texts.
    if value is None:
        return ""
    if type(value) is float:
        return "" if isnan(value) else repr(value)
    if isinstance(value, str):
        return safe_cell(str(value))
    match value:
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


@cache
def schema_of(name: str) -> Any:
    """Return the types of the columns of a whole table, for Parquet."""
    import pyarrow as pa

    kinds = {column: pa.float64() for column in _NUMBERS} | dict.fromkeys(_FLAGS, pa.bool_())
    kinds |= dict.fromkeys(_LISTS, pa.list_(pa.string())) | {RANK: pa.int64()}
    return pa.schema([(column, kinds.get(column, pa.string())) for column in TABLES[name]])


def part_of(export: str) -> str:
    """Return which of `PARTS_OF_PAGE` holds what a page adds to one of `EXPORTS`."""
    return f"{export.removesuffix('.parquet')}.arrow" if export.endswith(".parquet") else export


def table_part(name: str, rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Return rows of one of `TABLES` as a part of it: all columns but those that no part can know."""
    import pyarrow as pa

    schema = pa.schema([schema_of(name).field(column) for column in _OF_PARTS[name]])
    columns = [_column([row[field.name] for row in rows], field.type) for field in schema]
    sink = pa.BufferOutputStream()
    # Texts that repeat take a sixth of the room; more than LZ4 does, reading would cost.
    with pa.ipc.new_file(sink, schema, options=pa.ipc.IpcWriteOptions(compression="lz4")) as out:
        out.write_table(pa.Table.from_arrays(columns, schema=schema))
    return bytes(sink.getvalue().to_pybytes())


def _column(values: list[Any], kind: Any) -> Any:
    import pyarrow as pa

    try:
        return pa.array(values, kind)
    except UnicodeEncodeError:
        fit = [[encodable(text) for text in one] if isinstance(one, list) else one and encodable(one) for one in values]
        return pa.array(fit, kind)
