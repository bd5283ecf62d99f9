"""Validation against experiments: a synthetic one whose truth is known, folders with faults, and folds."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator
from lxml import html

from pipeline.analysis.response import respond
from pipeline.cli import kouros
from pipeline.records import Motion
from pipeline.records.protocols import Silent
from pipeline.resources import resource
from pipeline.verification import odds
from pipeline.verification.experiment import ExperimentError, experiment_schema, read_experiment
from pipeline.verification.validation import Validation, fit, folds, score, threshold, validate
from pipeline.verification.validation_report import document, page

WIDTH, DEPTH, HEIGHT = 0.12, 0.4, 0.6
"""Of the block, m; it is shaken along its width."""

STANDS, FALLS = (0.02, 0.05), (2.0, 3.0)
"""g, amplitudes of the pulses: a quarter of what lifts an edge (width / height is 0.2), and what throws the block down
in the first half cycle; no outcome lies near an end of what is scattered from run to run."""

FRICTION = 0.8
"""Of the block on its table: four times what its edge lifts at, so that it rocks and does not slide."""

FREQUENCIES = (0.8, 1.1, 1.6)
"""Hz, of the sine pulses that are scaled: each is a motion."""

DT = 0.01

TABLE = f"""
title = "A block on a table"
source = "computed with the model of a standing body"
licence = "public domain"
runs = "runs.csv"
run_column = "run"
fold_column = "motion"
motions = "motions.npz"
motion_key = "run{{run:02d}}"
unit = "g"
sampling_rate_hz = {1.0 / DT}
high_pass_hz = 0.0
direction = 0.0

[[body]]
name = "block"
width_m = {WIDTH}
depth_m = {DEPTH}
height_m = {HEIGHT}
friction = {FRICTION}

[[prediction]]
name = "an oracle"
columns = {{block = "oracle"}}
"""


def pulse(frequency: float, amplitude: float) -> np.ndarray:
    """One sine and rest, in g."""
    t = np.arange(0.0, 5.0, DT)
    return np.where(t < 1.0 / frequency, amplitude * np.sin(2.0 * np.pi * frequency * t), 0.0)


def falls(acceleration: np.ndarray) -> bool:
    """What the model says of the block, told its sizes and asked at its usual fidelity."""
    still = np.zeros_like(acceleration)
    motion = Motion(DT, np.vstack([9.80665 * acceleration, still, still]))
    sizes = {"half_width": 0.5 * WIDTH, "cg_height": 0.5 * HEIGHT, "friction_static": FRICTION}
    return bool(respond("standing", motion, **sizes).overturned[0])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An experiment without noise: outcomes are the model's own, at amplitudes far from any threshold."""
    folder = tmp_path_factory.mktemp("experiment")
    rows, arrays = ["run,motion,block,oracle"], {}
    for which, frequency in enumerate(FREQUENCIES):
        for amplitude in (*STANDS, *FALLS):
            run, shaken = len(arrays), pulse(frequency, amplitude)
            assert falls(shaken) == (amplitude in FALLS)
            arrays[f"run{run:02d}"] = shaken
            rows.append(f"{run},sine {which},{int(falls(shaken))},{int(falls(shaken))}")
    np.savez(folder / "motions.npz", **arrays)
    (folder / "runs.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "experiment.toml").write_text(TABLE, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def found(folder: Path) -> Validation:
    return validate(folder, Silent())


def copied(folder: Path, to: Path, **changes: Callable[[str], str]) -> Path:
    """The experiment with files changed as texts: experiment for experiment.toml, runs for runs.csv."""
    for name in ("experiment.toml", "runs.csv"):
        text = (folder / name).read_text(encoding="utf-8")
        (to / name).write_text(changes.get(name.partition(".")[0], str)(text), encoding="utf-8")
    (to / "motions.npz").write_bytes((folder / "motions.npz").read_bytes())
    return to


def test_what_the_model_itself_did_is_found_without_error(found: Validation) -> None:
    """No noise: all outcomes are right, fitted or not, and hardly any probability lies between."""
    (block,) = found.bodies
    assert block.standing.accuracy == 0.5
    assert block.threshold.accuracy == block.fitted.accuracy == block.unfitted.accuracy == 1.0
    assert block.fitted.brier < 0.01
    assert block.unfitted.brier < 0.01
    assert block.others["an oracle"].brier == 0.0
    said = document(found)
    assert said["runs"] == 12
    (body,) = said["bodies"]
    assert {"name", "always_stands", "pgv_threshold", "fitted", "unfitted"} <= body.keys()
    assert body["fitted"].keys() == {"accuracy", "brier", "parameters"}
    assert {"accuracy", "brier", "coverage"} <= body["unfitted"].keys()


def test_a_block_on_a_slippery_table_slides_and_is_not_said_to_fall(folder: Path, tmp_path: Path) -> None:
    """It tilts only where friction is above half width over height: 0.02 is a tenth of that of the block.

    Of half widths with a scatter of sqrt(0.5^2 + 0.3^2) in the logarithm, one in 25,000 is below a tenth (4.0 of them).
    """
    slippery = copied(folder, tmp_path, experiment=lambda t: t.replace(f"friction = {FRICTION}", "friction = 0.02"))
    experiment = read_experiment(slippery)
    shape = odds.shape_of(experiment, experiment.said.body[0])
    assert odds.drawn_odds(experiment, shape, Silent(), "block").max() < 0.01


@pytest.mark.parametrize(
    ("surface", "wanted"),
    [
        ('surface = "marble on Terrazzo"', (0.15, 0.15, 0.15)),  # Agbabian et al. 1991, Table 3
        ('surface = "Marble on felt"', (0.35, 0.15, 0.60)),
        ('friction = 0.42\nsurface = "marble on felt"', (0.42, 0.42, 0.42)),
    ],
)
def test_friction_is_what_is_stated_or_that_of_the_surfaces(
    folder: Path, tmp_path: Path, surface: str, wanted: tuple[float, float, float]
) -> None:
    said = copied(folder, tmp_path, experiment=lambda t: t.replace(f"friction = {FRICTION}", surface))
    (body,) = read_experiment(said).said.body
    found = odds.friction_of(body)
    assert (found.value, found.low, found.high) == wanted


def test_of_surfaces_that_no_table_has_any_friction_is_drawn(folder: Path, tmp_path: Path) -> None:
    """Half of the draws on either side of the best estimate, none beyond the ends."""
    said = copied(
        folder, tmp_path, experiment=lambda t: t.replace(f"friction = {FRICTION}", 'surface = "slate on ice"')
    )
    experiment = read_experiment(said)
    shape = odds.shape_of(experiment, experiment.said.body[0])
    drawn = shape.frictions(np.linspace(0.0, 1.0, 5))
    assert drawn[[0, 2, 4]] == pytest.approx([shape.friction.low, shape.friction.value, shape.friction.high])
    assert drawn[1] == pytest.approx(np.sqrt(drawn[0] * drawn[2]))
    assert shape.friction.high > 5.0 * shape.friction.low


def test_folds_never_part_a_motion(folder: Path) -> None:
    experiment = read_experiment(folder)
    motions = np.array(experiment.folds)
    tested = np.zeros(motions.size, int)
    for test, train in folds(experiment, experiment):
        assert not set(motions[test]) & set(motions[train])
        assert (test | train).all()
        tested += test
    assert (tested == 1).all()


def test_a_motion_whose_outcomes_are_a_lie_is_predicted_from_the_others(folder: Path, tmp_path: Path) -> None:
    """Its runs count in no fit of itself: every one of them is predicted as it truly went, and so comes out wrong."""

    def lie(text: str) -> str:
        first, *rows = text.splitlines()
        cells = [row.split(",") for row in rows]
        return "\n".join(
            [first, *(",".join([c[0], c[1], str(1 - int(c[2])) if c[1] == "sine 2" else c[2], c[3]]) for c in cells)]
        )

    (block,) = validate(copied(folder, tmp_path, runs=lie), Silent()).bodies
    assert block.fitted.accuracy == 8 / 12
    assert (block.fitted.fell_unsaid, block.fitted.stood_unsaid) == (2, 2)


def test_fitted_on_another_experiment_nothing_of_this_one_counts(folder: Path, tmp_path: Path) -> None:
    """One motion alone cannot be parted into folds, but it can be told from the experiment of three."""

    def one(text: str) -> str:
        first, *rows = text.splitlines()
        return "\n".join([first, *(row for row in rows if "sine 1" in row)])

    alone = copied(folder, tmp_path, runs=one)
    with pytest.raises(ExperimentError, match=r"runs\.csv: column 'motion': all runs are of one motion"):
        validate(alone, Silent())
    (block,) = validate(alone, Silent(), fit_on=folder).bodies
    assert block.fitted.accuracy == 1.0
    assert block.parameters == validate(folder, Silent()).bodies[0].parameters


FAULTS = {
    "no key": (lambda t: t.replace('unit = "g"\n', ""), str, r"experiment\.toml: unit: missing"),
    "unknown key": (
        lambda t: t.replace("unit =", "units ="),
        str,
        r"experiment\.toml: unit: missing; add it\n  units: unknown key",
    ),
    "unknown unit": (lambda t: t.replace('"g"', '"ft/s2"'), str, r"unit: input should be 'm/s2'"),
    "wrong unit": (lambda t: t.replace('"g"', '"mg"'), str, r"unit: the strongest motion peaks at 0\.003 g"),
    "no size": (lambda t: t.replace("depth_m", "mass_kg"), str, r"body\[0\]: give a mesh, or width_m"),
    "no such mesh": (
        lambda t: t[: t.index("width_m")] + 'mesh = "block.obj"\n' + t[t.index("[[prediction]]") :],
        str,
        r"body 'block': mesh: block\.obj: cannot be read",
    ),
    "unknown body": (
        lambda t: t.replace("{block =", "{bust ="),
        str,
        r"prediction 'an oracle': there is no body 'bust'",
    ),
    "no column": (str, lambda t: t.replace("block", "bust"), r"runs\.csv: there is no column 'block'"),
    "no outcome": (str, lambda t: t.replace("3,sine 0,1", "3,sine 0,fell"), r"run '3': column 'block' holds 'fell'"),
    "no motion": (str, lambda t: t + "99,sine 0,1,1\n", r"motions\.npz: there is no motion 'run99' of run '99'"),
    "twice": (str, lambda t: t + "3,sine 0,1,1\n", r"line 14: column 'run' is empty, or says the run '3' again"),
    "negative size": (
        lambda t: t.replace("depth_m = 0.4", "depth_m = -0.4"),
        str,
        r"body\[0\]\.depth_m: .*greater than 0",
    ),
    "short row": (str, lambda t: t + "13,sine 0\n", r"line 14: it has not as many cells"),
    "no probability": (str, lambda t: t.replace("0,sine 0,0,0", "0,sine 0,0,2"), r"column 'oracle' holds '2'"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_names_file_and_field(folder: Path, tmp_path: Path, fault: str) -> None:
    table, runs, told = FAULTS[fault]
    changed = copied(folder, tmp_path, experiment=table, runs=runs)
    with pytest.raises(ExperimentError, match=told):
        validate(changed, Silent())


def test_a_mesh_with_a_hole_is_refused_unless_its_hull_is_meant(folder: Path, tmp_path: Path) -> None:
    """A tetrahedron: closed, without one of its faces, and as a cloud of points, which only its hull can stand for."""
    points = "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0 0.2 0\nv 0 0 0.4\n"
    faces = ("f 1 3 2\n", "f 1 2 4\n", "f 2 3 4\n", "f 3 1 4\n")

    def body(text: str) -> str:
        return text[: text.index("width_m")] + 'mesh = "body.obj"\n' + text[text.index("[[prediction]]") :]

    experiment = read_experiment(copied(folder, tmp_path, experiment=body))
    mesh = tmp_path / "body.obj"
    mesh.write_text(points + "".join(faces), encoding="utf-8")
    whole = odds.shape_of(experiment, experiment.said.body[0])
    # The centre of gravity of a tetrahedron is at a quarter of its height; the nearest edge is 0.1 m off (y = -0.1).
    assert whole.cg_height == pytest.approx(0.1)
    assert whole.reach.min() == pytest.approx(0.6 / np.hypot(1.0, 3.0) / 3.0, rel=1e-3)
    assert whole.reach[270] == pytest.approx(0.1)
    mesh.write_text(points + "".join(faces[:3]), encoding="utf-8")
    with pytest.raises(ExperimentError, match=r"body 'block': mesh: body\.obj: the surface is not closed.*hull = true"):
        odds.shape_of(experiment, experiment.said.body[0])
    mesh.write_text(points, encoding="utf-8")
    cloud = odds.shape_of(experiment, experiment.said.body[0])
    assert cloud.cg_height == pytest.approx(0.1)
    assert "cloud" in cloud.notes[0]


def test_a_block_of_known_size_has_the_half_widths_and_inertia_of_a_cuboid(folder: Path) -> None:
    experiment = read_experiment(folder)
    shape = odds.shape_of(experiment, experiment.said.body[0])
    assert shape.reach[[0, 90, 180, 270]] == pytest.approx([0.06, 0.2, 0.06, 0.2])
    assert shape.reach[60] == pytest.approx(0.12)
    # About the axis across x: (width^2 + height^2) / 12, which is what the planar model takes of itself.
    assert shape.across(np.array([0])) ** 2 == pytest.approx((WIDTH**2 + HEIGHT**2) / 12.0)


def test_scores_of_known_probabilities() -> None:
    """By hand: 0.25 of the runs are called wrongly; the mean of 0.01, 0.04, 0.49, 0.16 is 0.175."""
    made = score(np.array([0.1, 0.8, 0.7, 0.6]), np.array([False, True, False, True]))
    assert (made.accuracy, made.brier) == pytest.approx((0.75, 0.175))
    assert (made.fell_as_said, made.fell_unsaid, made.stood_as_said, made.stood_unsaid) == (2, 0, 1, 1)
    # To nine in ten only the first names one outcome; both are named of the others.
    assert (made.coverage, made.stated) == pytest.approx((1.0, 0.975))
    assert [(b.runs, b.observed) for b in made.bins] == [(1, 0.0), (2, 0.5), (1, 1.0)]


def test_the_threshold_is_the_middle_of_the_best_ones() -> None:
    fell = np.array([False, False, True, True])
    assert threshold(np.array([1.0, 2.0, 4.0, 5.0]), fell) == 3.0
    assert threshold(np.array([1.0, 2.0, 4.0, 5.0]), np.zeros(4, bool)) > 5.0


def test_a_fit_finds_the_pair_that_says_what_happened() -> None:
    """Of 2 x 2 pairs one says every outcome for certain: after 40 runs it has all the weight."""
    fell = np.arange(40) % 2 == 0
    chances = np.full((40, 2, 2), 0.5)
    chances[:, 1, 0] = fell
    weights = fit(chances, fell)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[1, 0] > 1.0 - 1e-9


def test_the_schema_is_that_of_the_code_and_takes_the_experiment(folder: Path) -> None:
    import tomllib

    schema = json.loads(resource("schemas", "experiment.schema.json").read_text(encoding="utf-8"))
    assert experiment_schema() == schema, "write experiment_schema() as JSON, indent 2, to schemas/"
    said = tomllib.loads((folder / "experiment.toml").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(said)
    assert list(Draft202012Validator(schema).iter_errors({**said, "units": "g"}))


def test_the_page_shows_the_scores_and_the_diagram(found: Validation) -> None:
    tree = html.fromstring(page(found))
    rows = {row.xpath("string(th)"): row.xpath("td/text()") for row in tree.xpath("//section[@id='b0']//tbody/tr")}
    assert rows["two numbers fitted"][:2] == ["1.000", f"{found.bodies[0].fitted.brier:.3f}"]
    assert rows["it always stands"][0] == "0.500"
    assert tree.xpath("//figure//*[local-name()='svg']")
    assert not tree.xpath("//script | //link | //img")


def test_the_verb_prints_json_and_writes_the_page_unless_it_is_a_dry_run(folder: Path, tmp_path: Path) -> None:
    with chdir(tmp_path):
        dry = CliRunner().invoke(kouros, ["-q", "validate", str(folder), "--dry-run"])
        assert dry.exit_code == 0, dry.output
        assert not list(tmp_path.iterdir())
        done = CliRunner().invoke(kouros, ["-q", "validate", str(folder), "--json", "--out", "page.html"])
        lost = CliRunner().invoke(kouros, ["-q", "validate", str(folder), "--out", "nowhere/page.html"])
    assert json.loads(done.stdout)["bodies"][0]["fitted"]["accuracy"] == 1.0
    assert "two numbers fitted" in dry.stdout
    assert (lost.exit_code, "name another file by --out" in lost.output) == (2, True)
    assert (tmp_path / "page.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
