"""Scans of bodies whose volume, centre of gravity, inertia and contact are known in closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh.transformations import rotation_matrix

from pipeline.meshes import Scan, scan_object

WIDTH, DEPTH, HEIGHT = 0.2, 0.1, 0.4

SINGLE = 1e-6
"""STL and PLY hold single precision: relative error of a coordinate 6e-8, of a volume a few times that."""


def box() -> trimesh.Trimesh:
    return trimesh.creation.box((WIDTH, DEPTH, HEIGHT))


def saved(mesh: trimesh.Trimesh, folder: Path, name: str) -> Path:
    path = folder / name
    mesh.export(path)
    return path


def frustum(lower: float, upper: float, height: float, sections: int) -> trimesh.Trimesh:
    """Truncated pyramid on a regular polygon, standing on z = 0."""
    around = 2.0 * np.pi * np.arange(sections) / sections
    ring = np.column_stack([np.cos(around), np.sin(around), np.zeros(sections)])
    points = np.vstack([lower * ring, upper * ring + [0.0, 0.0, height]])
    hull = trimesh.Trimesh(points, process=False)
    at = np.arange(sections)
    on = (at + 1) % sections
    sides = np.vstack([np.column_stack([at, on, at + sections]), np.column_stack([on, on + sections, at + sections])])
    fan = np.column_stack([np.zeros(sections - 2, int), at[1:-1], at[2:]])
    return trimesh.Trimesh(hull.vertices, np.vstack([sides, fan[:, ::-1], fan + sections]), process=False)


@pytest.mark.parametrize("name", ["box.stl", "box.ply", "box.obj"])
def test_a_box(tmp_path: Path, name: str) -> None:
    found = scan_object(saved(box(), tmp_path, name), density=2000.0)
    assert found.closed
    assert found.volume == pytest.approx(WIDTH * DEPTH * HEIGHT, rel=SINGLE)
    assert found.mass == pytest.approx(2000.0 * WIDTH * DEPTH * HEIGHT, rel=SINGLE)
    assert (found.fill, found.shares) == (pytest.approx(1.0, rel=SINGLE), (1.0,))
    assert found.cg_height == pytest.approx(0.5 * HEIGHT, rel=SINGLE)
    sides = np.array([WIDTH, DEPTH, HEIGHT])
    others = np.array([DEPTH**2 + HEIGHT**2, WIDTH**2 + HEIGHT**2, WIDTH**2 + DEPTH**2])
    assert found.size == pytest.approx(sides, rel=SINGLE)
    assert found.gyration == pytest.approx(np.sqrt(others / 12.0), rel=SINGLE)
    assert (found.leaned, found.notes) == (pytest.approx(0.0, abs=1e-3), ())
    for contact in found.contacts:
        assert contact.polygon is not None
        reached = [contact.polygon.reach(way) for way in (0, 90, 180, 270)]
        assert reached == pytest.approx([0.1, 0.05, 0.1, 0.05], rel=1e-5)


@pytest.mark.parametrize(("lower", "upper"), [(0.05, 0.08), (0.08, 0.05)])
def test_a_frustum(tmp_path: Path, lower: float, upper: float) -> None:
    """On a regular polygon of n corners, area n r^2 sin(2 pi / n) / 2: the closed forms of a cone frustum hold."""
    n, height = 24, 0.3
    found = scan_object(saved(frustum(lower, upper, height, n), tmp_path, "frustum.obj"), density=1000.0)
    squares = lower**2 + lower * upper + upper**2
    assert found.volume == pytest.approx(0.5 * n * np.sin(2.0 * np.pi / n) * height * squares / 3.0, rel=SINGLE)
    centroid = 0.25 * height * (lower**2 + 2.0 * lower * upper + 3.0 * upper**2) / squares
    assert found.cg_height == pytest.approx(centroid, rel=SINGLE)
    least, stated, most = (one.polygon for one in found.contacts)
    assert least is not None
    assert stated is not None
    assert most is not None
    # The nearest edge of a regular polygon is at r cos(pi / n).
    inner = np.cos(np.pi / n)
    assert least.narrowest()[0] == pytest.approx(lower * inner, rel=1e-5)
    # A cone that opens upwards touches more the deeper it sinks in; one that closes does not.
    for polygon, contact in ((stated, found.contacts[1]), (most, found.contacts[2])):
        wider = max(lower, lower + (upper - lower) * contact.depth / height)
        assert polygon.narrowest()[0] == pytest.approx(wider * inner, rel=1e-5)


def test_a_foot_ring_bears_on_its_outer_edge(tmp_path: Path) -> None:
    n = 48
    ring = trimesh.creation.annulus(0.04, 0.05, 0.01, sections=n)
    found = scan_object(saved(ring, tmp_path, "ring.ply"))
    area = 0.5 * n * np.sin(2.0 * np.pi / n) * (0.05**2 - 0.04**2)
    assert found.volume == pytest.approx(area * 0.01, rel=1e-5)
    assert found.mass is None
    assert found.polygon.narrowest()[0] >= 0.05 * np.cos(np.pi / n) * (1.0 - 1e-5)
    assert found.polygon.inscribed(8).narrowest()[0] < found.polygon.narrowest()[0]


def test_three_feet_bear_on_the_triangle_between_them(tmp_path: Path) -> None:
    """The nearest edge of an equilateral triangle is at half the radius of its corners."""
    top = trimesh.creation.cylinder(0.1, 0.02, sections=90).apply_translation([0.0, 0.0, 0.06])
    feet = []
    for angle in (0.0, 120.0, 240.0):
        foot = trimesh.creation.cone(0.002, 0.05, sections=6)
        foot.apply_transform(rotation_matrix(np.pi, [1, 0, 0]))
        feet.append(foot.apply_translation([*(0.08 * np.cos(np.radians([angle, angle - 90.0]))), 0.05]))
    path = saved(trimesh.util.concatenate([top, *feet]), tmp_path, "tripod.obj")
    least = scan_object(path, bodies="all").contacts[0].polygon
    assert least is not None
    assert least.narrowest()[0] == pytest.approx(0.04, rel=1e-3)


@pytest.mark.parametrize("degrees", [0.4, 3.0])
def test_a_leaning_box_settles_onto_its_base(tmp_path: Path, degrees: float) -> None:
    """A scan that was not levelled rests on an edge as drawn: the pose is found by the base of its hull."""
    leaning = box().apply_transform(rotation_matrix(np.radians(degrees), [1.0, 1.0, 0.0]))
    path = saved(leaning, tmp_path, "leaning.obj")
    found = scan_object(path)
    assert found.leaned == pytest.approx(degrees, rel=1e-4)
    assert found.polygon.narrowest()[0] == pytest.approx(0.5 * DEPTH, rel=1e-4)
    assert found.cg_height == pytest.approx(0.5 * HEIGHT, rel=1e-5)
    with pytest.raises(ValueError, match=r"leaning\.obj: .*does not hold the centre of gravity.*--settle"):
        scan_object(path, settle=0.0, depth=1e-4)


def test_a_box_that_leans_too_far_is_refused(tmp_path: Path) -> None:
    path = saved(box().apply_transform(rotation_matrix(np.radians(20.0), [1, 0, 0])), tmp_path, "fallen.stl")
    with pytest.raises(ValueError, match=r"fallen\.stl: .*20\.0 degrees.*--up"):
        scan_object(path)
    assert scan_object(path, settle=30.0).polygon.narrowest()[0] == pytest.approx(0.5 * DEPTH, rel=1e-4)


@pytest.mark.parametrize(
    ("up", "size"),
    [
        ("z", (WIDTH, DEPTH, HEIGHT)), ("-z", (WIDTH, DEPTH, HEIGHT)), ("y", (WIDTH, HEIGHT, DEPTH)),
        ("-y", (WIDTH, HEIGHT, DEPTH)), ("x", (HEIGHT, DEPTH, WIDTH)), ("-x", (HEIGHT, DEPTH, WIDTH)),
    ],
)  # fmt: skip
def test_the_axis_that_points_upwards(tmp_path: Path, up: str, size: tuple[float, float, float]) -> None:
    """A frustum on its narrow end, drawn along another axis: its centre of gravity is above the middle, not below."""
    assert scan_object(saved(box(), tmp_path, "box.obj"), up=up).size == pytest.approx(size, rel=SINGLE)
    turns = {
        "z": np.eye(4), "-z": rotation_matrix(np.pi, [1, 0, 0]), "y": rotation_matrix(-np.pi / 2, [1, 0, 0]),
        "-y": rotation_matrix(np.pi / 2, [1, 0, 0]), "x": rotation_matrix(np.pi / 2, [0, 1, 0]),
        "-x": rotation_matrix(-np.pi / 2, [0, 1, 0]),
    }  # fmt: skip
    drawn = frustum(0.05, 0.08, 0.3, 12).apply_transform(turns[up])
    assert scan_object(saved(drawn, tmp_path, "drawn.obj"), up=up).cg_height > 0.5 * 0.3


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_units(tmp_path: Path, unit: str, metres: float) -> None:
    path = saved(box().apply_scale(1.0 / metres), tmp_path, "box.obj")
    assert scan_object(path, unit=unit).size == pytest.approx((WIDTH, DEPTH, HEIGHT), rel=SINGLE)


def test_what_was_wound_inwards_is_turned_and_a_cavity_is_taken_off(tmp_path: Path) -> None:
    inwards = box()
    inwards.invert()
    assert scan_object(saved(inwards, tmp_path, "in.ply")).volume == pytest.approx(0.008, rel=1e-5)
    hollow = trimesh.creation.box((0.1, 0.05, 0.2))
    hollow.invert()
    found = scan_object(saved(trimesh.util.concatenate([box(), hollow]), tmp_path, "hollow.stl"))
    assert found.volume == pytest.approx(0.008 - 0.001, rel=1e-5)
    assert found.notes == ("1 closed cavities are taken off",)


def test_two_bodies_are_asked_about(tmp_path: Path) -> None:
    crumb = trimesh.creation.box((0.01, 0.01, 0.01)).apply_translation([0.3, 0.0, -0.3])
    path = saved(trimesh.util.concatenate([box(), crumb]), tmp_path, "two.stl")
    with pytest.raises(ValueError, match=r"two\.stl: 2 separate bodies .*--bodies all.*--bodies largest"):
        scan_object(path)
    assert scan_object(path, bodies="largest").volume == pytest.approx(0.008, rel=1e-5)
    beside = box().apply_translation([0.3, 0.0, 0.0])
    both = scan_object(saved(trimesh.util.concatenate([box(), beside]), tmp_path, "both.stl"), bodies="all")
    assert (both.shares, both.size[0]) == (pytest.approx((0.5, 0.5)), pytest.approx(0.3 + WIDTH))
    assert both.polygon.reach(0.0) == pytest.approx(0.15 + 0.5 * WIDTH)


def doubted(found: Scan, words: str) -> bool:
    return any(words in note for note in found.notes)


def test_a_base_that_is_not_flat_is_doubted(tmp_path: Path) -> None:
    """A block on three pins of different length, the fourth corner 1 mm short: how deep it sinks in decides."""
    block = trimesh.creation.box((0.2, 0.2, 0.3)).apply_translation([0.0, 0.0, 0.16])
    corners = [(0.08, 0.08, 0.0), (-0.08, 0.08, 0.0), (-0.08, -0.08, 0.0), (0.08, -0.07, 0.001)]
    pins = [
        trimesh.creation.cone(0.003, 0.05, sections=5)
        .apply_transform(rotation_matrix(np.pi, [1, 0, 0]))
        .apply_translation([x, y, z + 0.05])
        for x, y, z in corners
    ]
    path = saved(trimesh.util.concatenate([block, *pins]), tmp_path, "pins.obj")
    found = scan_object(path, bodies="all", depth=0.0003)
    least, _, most = (one.polygon for one in found.contacts)
    assert least is not None
    assert most is not None
    # By its own weight it rests on the three that hold its centre of gravity, whose diagonal is close by.
    assert least.narrowest()[0] < 0.005
    assert most.narrowest()[0] > 0.06
    assert doubted(found, "hangs on the contact depth")
