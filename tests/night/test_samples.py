"""What a sample of the objects asks for is found once, and again when anything changes that it rests on."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from pipeline.cache import SAMPLES
from pipeline.night import prepare
from pipeline.night.importing import import_collection
from pipeline.night.prepare import admit, run_context
from pipeline.operations.workspace import open_workspace
from pipeline.settings import load_settings
from tests.museum import workspace
from tests.night.changing import FRICTION, RULES, measures

ROWS = [
    *(f"{n},A,Covered vase,{0.2 + 0.02 * n},0.2,0.2" for n in range(4)),
    *(f"p{n},B,Painting of a landscape,{0.5 + 0.1 * n},0.8,0.05" for n in range(3)),
]


def asked(folder: Path, x_azimuth: float = 90.0) -> tuple[Any, ...]:
    """Return what the objects of the museum in a folder ask for: charts by model, angle and parameters, and models."""
    at_work = open_workspace(load_settings(folder / "kouros.toml"))
    import_collection(at_work, folder / "export.csv", str(folder / "mapping.toml"), shrink_limit=1.0)
    index = at_work.object_index()
    context = run_context(at_work, at_work.site(), index, index.objects, datetime.now(UTC))
    tasks, models = admit(at_work, context, index, index.objects, x_azimuth)
    assert context.admitted is not None
    # A friction that nobody measured is no number, and as such equals nothing.
    charts = {(task.model, task.angle, str(sorted(task.alike.items()))) for task in tasks}
    assert len(charts) == len(context.admitted)
    assert len(tasks) == len(charts) * len(context.motions)
    return charts, context.admitted, models


@pytest.fixture
def museum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    # Of a handful of objects no chart pays.
    monkeypatch.setattr(prepare, "WORTH", 0.0)
    return workspace(tmp_path, ROWS).home


def kept(folder: Path) -> set[str]:
    return {file.name for file in (load_settings(folder / "kouros.toml").kept / SAMPLES).glob("*")}


def replaced(file: str, old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        text = (folder / file).read_text(encoding="utf-8")
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1), encoding="utf-8")

    return change


def setting(name: str, file: str, text: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        (folder / file).write_text(text, encoding="utf-8")
        replaced("kouros.toml", f'{name} = ""', f'{name} = "{file}"')(folder)

    return change


def test_it_is_found_once(museum: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, charts = asked(museum), kept(museum)
    assert {"standing", "swing"} <= before[2]
    assert {model for model, *_ in before[0]} >= {"swing"}

    def classified(*_: object, **__: object) -> None:
        raise AssertionError("classified again")

    monkeypatch.setattr(prepare, "_classed", classified)
    assert asked(museum) == before
    assert kept(museum) == charts


@pytest.mark.parametrize(
    "change",
    [
        replaced("export.csv", "0.2,0.2,0.2", "0.2,0.2,0.3"),
        replaced("export.csv", "Covered vase", "Bust of a man"),
        replaced("kouros.toml", 'furniture = "floor"', 'furniture = "shelf"'),
        setting("rules", "rules.csv", RULES.format("bust", "vase")),
        setting("friction", "friction.csv", FRICTION.format(0.1)),
        setting("measures", "measures.csv", measures(0.05)),
    ],
    ids=["size", "name", "house rule", "rules", "table", "measures"],
)
def test_it_is_found_again_when_what_it_rests_on_changes(museum: Path, change: Callable[[Path], None]) -> None:
    asked(museum)
    before = kept(museum)
    change(museum)
    found = asked(museum)
    assert len(kept(museum)) == len(before) + 1
    # As a museum finds it that has nothing kept.
    for file in (load_settings(museum / "kouros.toml").kept / SAMPLES).iterdir():
        file.unlink()
    assert asked(museum) == found


def test_directions_are_those_of_the_building(museum: Path) -> None:
    asked(museum)
    asked(museum, 45.0)
    assert len(kept(museum)) == 2
