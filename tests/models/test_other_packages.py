"""A model of another package, as the documentation tells how to write one: everything about it in one file.

All is asked of commands in processes of their own, with the folder of the package among those that Python looks in.
"""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pipeline.models import MODELS, model_named
from pipeline.motions.by_name import read_motion
from pipeline.operations.report_status import last_good
from pipeline.quantities import G
from pipeline.records import Item
from pipeline.settings import load_settings, template
from tests.museum import in_common, own_site, small
from tests.packages import install
from tests.warm import kouros_process

ROOT = Path(__file__).resolve().parents[2]

TOPPLING = '''
"""Toppling of vessels by the criterion of West: A_max/g against B/H."""

import numpy as np

from pipeline.models.common import largest_push, needs, unless_free
from pipeline.quantities import G, Quantity
from pipeline.records import Axis, Chart, Curve, Estimate, Figure, Model, Origin, Trials


def _run(motion, parameters, refine, estimate):
    push = largest_push(motion) / G * parameters["cg_height"] / (parameters["grip"] * parameters["half_width"])
    return {"push": push, "error": 1e-12 * push, "note": np.zeros_like(push)}


def _grip(scene):
    note = "grip of its foot: 2 (1.5 to 2.5), assumed"
    return {"grip": Estimate(2.0, "-", Origin.ASSUMED, 1.5, 2.5, note, "judgement")}


def _picture(key, motion):
    heights = (0.1, 1.0)
    slope = largest_push(motion.excitation(None)) / G
    line = Curve("a/g = B/H", heights, tuple(slope * height for height in heights))
    return Chart(key, "Toppling by West", "", Axis("Height", "m"), Axis("Width", "m"), (line,))


TOPPLING = Model(
    name="toppling",
    title="Toppling",
    kind="rigid",
    source="West, as in Kirkpatrick 1927",
    equation="a/g = c B/H",
    needs=(
        Quantity("half_width", "m", "to the edge", 0.0, exclusive=True),
        Quantity("cg_height", "m", "of the centre of gravity", 0.0, exclusive=True),
        Quantity("grip", "-", "of its foot", 0.0, exclusive=True),
    ),
    gives=(Quantity("push", "-", "largest push over what topples it"),),
    directions=1,
    run=_run,
    demand="push",
    capacity=1.0,
    applies=lambda scene: unless_free(scene) or needs(scene, "half_width", "cg_height", "grip"),
    sentence="The push is {demand} ({low} to {high}) times what topples it.",
    fails="topples",
    trials=Trials(
        ranges={"half_width": (0.02, 0.4), "cg_height": (0.05, 1.0), "grip": (1.0, 2.0)},
        extremes={"half_width": [1e-3, 1.0], "cg_height": [1.0, 1e-3], "grip": [1.0, 1.0]},
        sample={"half_width": 0.1, "cg_height": 0.3, "grip": 1.0},
        promised=1e-9,
    ),
    joins=lambda item, object_class, models: object_class == "vessel",
    estimates=_grip,
    pictures=(Figure("toppling", _picture),),
    mark=lambda parameters, _: ("toppling", 2.0 * parameters["cg_height"], 2.0 * parameters["half_width"]),
)
'''
POINTS = "[kouros.models]\ntoppling = kouros_toppling:TOPPLING\n"


@pytest.fixture
def packages(tmp_path: Path) -> Path:
    folder = tmp_path / "packages"
    folder.mkdir()
    return folder


def python(code: str, *words: str, packages: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run code with the interpreter of the tests, in a folder, with the packages of another installed."""
    command = [sys.executable, "-c", code, *words]
    return subprocess.run(command, cwd=folder, env=beside(packages), capture_output=True, text=True, check=False)


def beside(packages: Path) -> dict[str, str]:
    """The environment with the packages of another installed."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(packages)))}


def kouros(*words: str, packages: Path, folder: Path) -> str:
    done = kouros_process(words, folder, beside(packages))
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_it_is_listed_run_measured_and_tested(packages: Path, tmp_path: Path) -> None:
    install(packages, "kouros_toppling", TOPPLING, POINTS)
    asked = {"packages": packages, "folder": tmp_path}
    listed = json.loads(kouros("models", "--json", **asked))
    assert [one["name"] for one in listed] == [*(model.name for model in MODELS), "toppling"]
    assert [one["name"] for one in listed[-1]["needs"]] == ["half_width", "cg_height", "grip"]
    words = ["half_width=0.1,0.2", "cg_height=0.3", "grip=1"]
    (narrow, wide) = json.loads(kouros("-q", "respond", "toppling", *words, "--json", **asked))
    assert narrow["push"] == pytest.approx(2.0 * wide["push"], rel=1e-12)
    words = ["--site", "demo", "--model", "toppling", "--objects", "4", "--json"]
    measured = json.loads(kouros("-q", "tradeoff", *words, **asked))
    # A closed form: every step gives the same.
    assert measured["cheapest"]["toppling"]["worst"] == 0.0
    code = (
        "from pipeline.verification.self_measurement import CASES\n"
        "for case in CASES:\n"
        "    if case.what.startswith('toppling'): print(case.what, case.measure() <= case.limit, sep=': ')"
    )
    tested = python(code, **asked).stdout.splitlines()
    assert tested == [
        "toppling at dt 0.5 ms: True",
        "toppling at dt 40 ms: True",
        "toppling: 12 motions, extreme objects: True",
    ]


MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test"
[columns.object_number]
column = "number"
[columns.gallery]
column = "gallery"
[columns.title]
column = "title"
[columns.height_m]
column = "height"
unit = "m"
[columns.width_m]
column = "width"
unit = "m"
[columns.depth_m]
column = "width"
unit = "m"
"""


def museum(folder: Path, *rows: str) -> None:
    """A museum of its own in a folder, whose objects stand on the floor: closed forms hold of its motion."""
    in_common(folder)
    own_site(folder)
    (folder / "export.csv").write_text("\n".join(["number,gallery,title,height,width", *rows]) + "\n", encoding="utf-8")
    (folder / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    settings = small(template(museum="Test", source="export.csv", mapping="mapping.toml", site="site"), sampled=False)
    stands = '[[house]]\ngallery = "A"\nfurniture = "floor"\nsaid_by = "Ann"\nsaid_on = 2031-05-01\n'
    (folder / "kouros.toml").write_text(f"{settings}\n{stands}", encoding="utf-8")


def report(folder: Path) -> Path:
    """The folder of the last good report."""
    settings = load_settings(folder / "kouros.toml")
    good = last_good(settings)
    assert good is not None
    return (settings.path(settings.report.folder) / good.report).parent


def found(folder: Path, name: str) -> list[dict[str, str]]:
    """The rows of an export of the last good report."""
    with (report(folder) / name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_night_runs_it_on_the_objects_that_it_names(packages: Path, tmp_path: Path) -> None:
    """A vase gets it, with the grip that it assumes; a box of the same size does not; a new version is a new result."""
    museum(tmp_path, "1,A,Vase,1.2,0.2", "2,A,Box,0.4,0.2")
    install(packages, "kouros_toppling", TOPPLING, POINTS)
    asked = {"packages": packages, "folder": tmp_path}
    kouros("-q", "run", **asked)
    ran = {(row["object_number"], row["model"]): row for row in found(tmp_path, "findings.csv")}
    assert {number for number, model in ran if model == "toppling"} == {"1"}
    assert {number for number, model in ran if model == "standing"} == {"1", "2"}
    topples = ran["1", "toppling"]
    # A vessel's base is 0.6 of its width, of which 0.92 bears, its centre of gravity at 0.45 of its height; of the
    # worst of the directions, every 10 degrees, 1 - cos 5 may be missing.
    peaks = [np.hypot(*m.acceleration[:2]).max() for m in read_motion(tmp_path / "site")]
    pushes = [peak / G * 0.45 * 1.2 / (2.0 * 0.92 * 0.3 * 0.2) for peak in peaks]
    assert any(0.996 * push <= float(topples["demand"]) <= push for push in pushes)
    assert "grip of its foot: 2 (1.5 to 2.5), assumed" in topples["assumptions"]
    (page,) = report(tmp_path).glob("a-*.html")
    assert "Toppling by West" in page.read_text(encoding="utf-8")
    told = kouros("-q", "run", "--explain", "2", **asked)
    assert "Toppling: not required: its name says that it is case furniture or a box (named 'box')\n" in told
    # The same version, and other words in the file: what was kept is of another model.
    (packages / "kouros_toppling.py").write_text(TOPPLING.replace('2.0, "-", Origin', '1.6, "-", Origin'))
    kouros("-q", "run", **asked)
    (again,) = (row for row in found(tmp_path, "findings.csv") if row["model"] == "toppling")
    assert float(again["demand"]) == pytest.approx(float(topples["demand"]) * 2.0 / 1.6, rel=1e-6)


BROKEN = "raise RuntimeError('no licence')"
UNFIT = TOPPLING.replace('demand="push"', 'demand="pull"')


@pytest.mark.parametrize(
    ("source", "wrong"),
    [
        (BROKEN, "RuntimeError: no licence"),
        (UNFIT, "toppling: demand names 'pull'; use one of push"),
        (TOPPLING.replace('name="toppling"', 'name="rocking"'), "there is a part called 'rocking' already"),
        ("TOPPLING = 'toppling'", "it is a str; let the entry point name a pipeline.records.Model"),
        (TOPPLING.replace('"half_width": (0.02, 0.4), ', ""), "toppling: trials.ranges lacks half_width"),
    ],
)
def test_a_broken_one_is_said_and_left_out(packages: Path, tmp_path: Path, source: str, wrong: str) -> None:
    install(packages, "kouros_toppling", source, POINTS, "0.3")
    done = kouros_process(("models", "--json"), tmp_path, beside(packages))
    assert done.returncode == 0
    assert [one["name"] for one in json.loads(done.stdout)] == [model.name for model in MODELS]
    said = "kouros: kouros_toppling 0.3 offers 'toppling' (kouros.models: kouros_toppling:TOPPLING), "
    assert done.stderr.startswith(f"{said}which cannot be used and is left out: {wrong}")
    assert "Mend it, or uninstall kouros_toppling" in done.stderr


@pytest.mark.long("test_a_broken_one_is_said_and_left_out")
def test_a_broken_one_stops_no_night(packages: Path, tmp_path: Path) -> None:
    museum(tmp_path, "1,A,Vase,0.4,0.2")
    install(packages, "kouros_toppling", BROKEN, POINTS)
    done = kouros_process(("-q", "run"), tmp_path, beside(packages))
    assert done.returncode == 0, done.stderr
    assert "left out: RuntimeError: no licence" in done.stderr
    assert {row["model"] for row in found(tmp_path, "findings.csv")} == {"standing", "sliding"}
    checked = kouros_process(("check",), tmp_path, beside(packages)).stdout
    assert "no licence" in checked


def test_what_is_not_tried_on_an_object_says_so_and_no_more() -> None:
    """Only of what would break a section can one say that it moves instead, of hooks that nobody asked of them."""
    from pipeline.analysis.classify import classify
    from pipeline.analysis.plan import plan

    scene = classify(
        Item("1", "A", title="Vase", height_m=0.4, width_m=0.2, depth_m=0.2, mass_kg=2.0, section_width_m=0.05)
    )
    (why,) = plan([scene]).skipped
    assert why["Stress"].startswith("not required: ")
    assert why["Stress"].endswith("; it is free to move instead")
    assert {model.name for model in MODELS if model.unasked} == {"stress", "unhooking"}
    assert model_named("rocking").unasked == ""
