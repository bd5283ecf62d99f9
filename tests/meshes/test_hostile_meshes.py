"""Meshes that are damaged, hostile or no solids: an error names the file and the remedy, whatever is in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.meshes import reading, scan_object
from pipeline.meshes.reading import MeshError
from tests.soak import examples

CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
TETRAHEDRON = f"{CORNERS}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
HEADER = "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("empty.obj", "", "no points"),
        ("prose.stl", "no mesh at all", "STL mesh that can be read|no points"),
        ("nan.obj", TETRAHEDRON.replace("v 1 0 0", "v nan 0 0"), "point 2 is no finite number"),
        ("infinite.obj", TETRAHEDRON.replace("v 1 0 0", "v inf 0 0"), "point 2 is no finite number"),
        ("index.obj", f"{CORNERS}f 1 2 9\n", "cannot|can be read|names a point"),
        ("open.obj", f"{CORNERS}f 1 3 2\nf 1 2 4\nf 2 3 4\n", "not closed .3 edges.*close its holes.*--hull"),
        ("cloud.obj", CORNERS, "cloud of 4 points.*--hull"),
        ("wound.obj", TETRAHEDRON.replace("f 1 3 2", "f 1 2 3"), "inside out.*normals"),
        ("flat.obj", TETRAHEDRON.replace("v 0 0 1", "v 1 1 0"), "no volume"),
        ("degenerate.obj", f"{CORNERS}f 1 1 2\nf 2 2 3\n", r"cloud of \d points"),
        ("huge.obj", TETRAHEDRON.replace("1", "1e300", 1), "1e.300 m large in unit 'm'.*--unit"),
        ("many.ply", HEADER.format("binary_little_endian", 99999999999), "PLY mesh that can be read"),
        ("model.fbx", "x", "no obj, ply or stl file"),
    ],
)
def test_what_is_no_solid_is_refused(tmp_path: Path, name: str, text: str, words: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(MeshError, match=rf"(?s)^{name}: .*(?:{words})"):
        scan_object(tmp_path / name)


def test_a_file_that_is_not_there_or_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(MeshError, match=r"^lost\.obj: cannot be read: .*see whether"):
        scan_object(tmp_path / "lost.obj")
    (tmp_path / "long.obj").write_text(TETRAHEDRON)
    monkeypatch.setattr(reading, "MOST_BYTES", 10)
    with pytest.raises(MeshError, match=r"^long\.obj: .*fewer triangles"):
        scan_object(tmp_path / "long.obj")


def test_a_mesh_with_more_points_than_are_accepted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "dense.obj").write_text(TETRAHEDRON)
    monkeypatch.setattr(reading, "MOST_POINTS", 3)
    with pytest.raises(MeshError, match=r"^dense\.obj: 4 points or triangles, more than 3"):
        scan_object(tmp_path / "dense.obj")


def test_a_mesh_opens_no_other_file(tmp_path: Path) -> None:
    """A material library beside it, were it read, would stop the reading: it is a folder."""
    (tmp_path / "beside.mtl").mkdir()
    (tmp_path / "a.obj").write_text(f"mtllib beside.mtl\n{TETRAHEDRON}")
    assert scan_object(tmp_path / "a.obj").volume == pytest.approx(1.0 / 6.0)


@pytest.mark.parametrize("faces", ["", "f 1 3 2\nf 1 2 4\nf 2 3 4\n"])
def test_the_hull_of_what_is_open_is_a_judgement(tmp_path: Path, faces: str) -> None:
    (tmp_path / "open.obj").write_text(CORNERS + faces)
    found = scan_object(tmp_path / "open.obj", hull=True, settle=60.0)
    assert not found.closed
    assert found.volume == pytest.approx(1.0 / 6.0)
    assert "judgement" in found.notes[0]


def test_double_and_degenerate_triangles_do_not_count(tmp_path: Path) -> None:
    (tmp_path / "twice.obj").write_text(f"{TETRAHEDRON}f 1 2 4\nf 1 1 2\n")
    found = scan_object(tmp_path / "twice.obj")
    assert found.volume == pytest.approx(1.0 / 6.0)
    assert found.notes[0].startswith("2 triangles")


WHOLE = {kind: trimesh.creation.box((0.2, 0.1, 0.4)).export(file_type=kind) for kind in ("stl", "ply", "obj")}


@given(kind=st.sampled_from(sorted(WHOLE)), data=st.data())
@settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_bytes_are_damaged_it_is_a_scan_or_an_error(tmp_path: Path, kind: str, data: st.DataObject) -> None:
    whole = WHOLE[kind]
    damaged = bytearray(whole if isinstance(whole, bytes) else whole.encode())
    for at in data.draw(st.lists(st.integers(0, len(damaged) - 1), max_size=4)):
        damaged[at] = data.draw(st.integers(0, 255))
    path = tmp_path / f"damaged.{kind}"
    path.write_bytes(damaged[: data.draw(st.integers(0, len(damaged)))])
    said, found = "", None
    try:
        found = scan_object(path, hull=data.draw(st.booleans()))
    except MeshError as problem:
        said = str(problem)
    if found is None:
        assert said.startswith(path.name)
    else:
        assert np.isfinite([found.volume, *found.size, found.cg_height]).all()
        assert found.volume > 0.0
