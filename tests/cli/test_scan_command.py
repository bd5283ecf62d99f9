"""The verb `kouros scan`, in words and as JSON; what it gives is a record that the import takes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import trimesh
from click.testing import CliRunner

from pipeline.cli import kouros
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.errors import KourosError


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.stl"
    trimesh.creation.box((200.0, 100.0, 400.0)).export(path)
    return path


def test_json_has_what_the_words_say_and_the_import_takes_it(box: Path, tmp_path: Path) -> None:
    words = ("scan", str(box), "--unit", "mm", "--density", "2000")
    said = CliRunner().invoke(kouros, [*words, "--json"], catch_exceptions=False)
    found = json.loads(said.output)
    assert found["mass_kg"] == pytest.approx(16.0, rel=1e-6)
    assert found["cg_height_m"] == pytest.approx(0.2, rel=1e-6)
    assert found["half_widths_m"]["x"] == pytest.approx(0.1, rel=1e-5)
    assert found["half_widths_m"]["narrowest"] == pytest.approx(0.05, rel=1e-5)
    assert [one["depth_m"] for one in found["contacts"]] == [0.0, 0.0005, 0.002]
    assert "16 kg" in CliRunner().invoke(kouros, words, catch_exceptions=False).output
    record = {"object_number": "1", "gallery": "East", **found["record"]}
    path = tmp_path / "scanned.csv"
    path.write_text(f"{','.join(record)}\n" + ",".join(f'"{cell}"' for cell in record.values()) + "\n")
    (item,) = read_items(path, load_mapping("kouros")).items
    assert item.problems == ()
    assert (item.mass_kg, item.cg_height_m) == (16.0, 0.2)
    assert len(item.contact_polygon) == len(item.contact_polygon_least) == 4


def test_a_mesh_that_cannot_be_used_ends_with_the_exit_code_of_wrong_input(tmp_path: Path) -> None:
    with pytest.raises(KourosError, match=r"^lost\.obj: ") as caught:
        CliRunner().invoke(kouros, ["scan", str(tmp_path / "lost.obj")], catch_exceptions=False)
    assert caught.value.exit_code == 2
