"""A museum after a good night whose records then changed: what a disturbed second night is measured by."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from lxml import html

from pipeline.collection.database import open_database
from pipeline.records import RunRecord
from pipeline.report.files.manifest import verify_report
from pipeline.store.runs import load_run
from tests.museum import COLUMNS

ROOMS, EACH = 4, 5


def rows(height: float) -> list[str]:
    """Twenty vases in four rooms, of which every second one has another height tonight."""
    columns = COLUMNS.split(",")
    out = []
    for room in range(ROOMS):
        for n in range(EACH):
            told = {
                columns[0]: f"{room}.{n}", columns[1]: f"Room {room}", columns[2]: "Vase",
                columns[3]: f"{(height if n % 2 else 0.4) + 0.05 * n:.3f}", columns[4]: "0.15", columns[5]: "0.15",
            }  # fmt: skip
            out.append(",".join(told.get(column, "") for column in columns))
    return out


@dataclass(frozen=True)
class Nights:
    """A museum after its first good night, with tonight's records in place; what an undisturbed night would find."""

    folder: Path
    before: dict[str, dict[str, str]]
    after: dict[str, dict[str, str]]
    record: RunRecord
    seconds: float


def objects(report: Path) -> dict[str, dict[str, str]]:
    """Return the rows of objects.csv by object number, without the run that found them."""
    with (report / "objects.csv").open(encoding="utf-8", newline="") as stream:
        listed = [row | {"run": ""} for row in csv.DictReader(stream)]
    found = {row["object_number"]: row for row in listed}
    assert len(found) == len(listed)
    return found


def last(database: str) -> RunRecord:
    """Return what the last finished run found, without what tells one night from another."""
    record = load_run(open_database(database))
    kept = {name: value for name, value in record.settings.items() if name != "survey_seconds"}
    return replace(record, run_id="", started="", finished="", settings=kept)


class Expected(Protocol):
    """What the objects of a report may be: those of the night before, or tonight's."""

    @property
    def before(self) -> dict[str, dict[str, str]]: ...
    @property
    def after(self) -> dict[str, dict[str, str]]: ...


def whole(folder: Path, nights: Expected) -> bool:
    """Check that the published report is whole, and say whether it is tonight's."""
    report = (folder / "reports" / "latest").resolve()
    told = json.loads((report / "summary.json").read_text(encoding="utf-8"))
    assert report.name.startswith(told["run_id"])
    assert (report / told["report"]).is_file()
    assert (report / told["latest"]).resolve() == report
    assert not list(verify_report(report))
    found = objects(report)
    assert found in (nights.before, nights.after)
    for page in report.glob("*.html"):
        tree = html.fromstring(page.read_bytes())
        for link in tree.xpath("//a/@href"):
            target = link.partition("#")[0]
            assert not target or (report / target).is_file(), f"{page.name}: {link}"
    for name in ("findings.csv", "findings.jsonl", "findings.parquet", "findings.xlsx", "recommendations.csv"):
        assert (report / name).stat().st_size > 0
    return found == nights.after
