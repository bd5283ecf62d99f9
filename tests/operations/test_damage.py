"""What is kept cannot rot unnoticed: single damages to everything that a night keeps and reads again."""

from __future__ import annotations

import os
import re
import sqlite3
import warnings
from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.cache import CacheWarning
from pipeline.cli.console import Console
from pipeline.errors import DamageWarning, KourosError
from pipeline.night.run import run
from pipeline.operations.workspace import open_workspace
from pipeline.records import Decision, DecisionKind
from pipeline.report.errors import ReportWarning
from pipeline.settings import load_settings, template
from pipeline.store.decisions import add_decision
from tests.night.test_jobs import MAPPING

SILENT = Console(quiet=True)
DAMAGES = int(os.environ.get("KOUROS_DAMAGES", "110"))
SEED = 17
DATABASE = "kouros.sqlite"
EXPORTS = ("findings.csv", "objects.csv", "recommendations.csv")

COLUMNS = "object_number,gallery,title,height_m,width_m,depth_m"


def rows(changed: bool) -> list[str]:
    """Twenty vases in four rooms, of which one has another height tonight."""
    return [
        f"{room}.{n},Room {room},Vase,{0.3 + 0.05 * n + (0.01 if changed and (room, n) == (0, 0) else 0.0):.3f},0.15,0.15"
        for room in range(4)
        for n in range(5)
    ]


def write_export(folder: Path, changed: bool = False) -> None:
    (folder / "export.csv").write_text("\n".join([COLUMNS, *rows(changed)]) + "\n", encoding="utf-8")


@pytest.fixture(scope="module")
def museum(tmp_path_factory: pytest.TempPathFactory, shaking: Path) -> Path:
    """A museum after two nights, with a decision made between them; tonight one of its objects has changed."""
    folder = tmp_path_factory.mktemp("damage") / "museum"
    folder.mkdir()
    write_export(folder)
    (folder / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    text = template(museum="Test", source="export.csv", mapping="mapping.toml", site=str(shaking))
    (folder / "kouros.toml").write_text(text.split("\n[logs]")[0], encoding="utf-8")
    settings = load_settings(folder / "kouros.toml")
    run(settings, SILENT)
    decided = Decision(
        0, "1.1", DecisionKind.RISK, "Curator", "2031-05-01", "It stands well.", "2031-05-01T12:00:00+00:00"
    )
    add_decision(open_workspace(settings).engine, decided)
    run(settings, SILENT)
    with sqlite3.connect(folder / DATABASE) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    write_export(folder, changed=True)
    return folder


@dataclass(frozen=True)
class Night:
    """What came of a night: the report without what tells one run from another, what was said, why it was refused."""

    report: dict[str, str]
    said: tuple[str, ...]
    refused: str


RUN_ID = re.compile(r"\d{8}T\d{6}\.\d{3}-\d+(-\d+)?")
TIME = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(\+00:00|Z| UTC)?|\d+(\.\d+)? (s|seconds)\b")


def night(folder: Path) -> Night:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            run(load_settings(folder / "kouros.toml"), SILENT)
        except KourosError as problem:
            return Night({}, tuple(str(w.message) for w in caught), f"{type(problem).__name__}: {problem}")
    said = tuple(str(w.message) for w in caught if issubclass(w.category, DamageWarning | CacheWarning | ReportWarning))
    report = (folder / "reports" / "latest").resolve()
    found = {
        file.name: file.read_text(encoding="utf-8") for file in (*report.glob("*.html"), *map(report.joinpath, EXPORTS))
    }
    return Night({name: TIME.sub("T", RUN_ID.sub("R", text)) for name, text in found.items()}, said, "")
