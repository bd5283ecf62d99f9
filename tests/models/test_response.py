"""`respond`, `prepare`, `trace`: what they refuse and in which words, and what their tables look like."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from parameters import BLOCK, VALID
from shaking import along_x, random_motion

from pipeline import respond, trace
from pipeline.analysis.model_runs import prepare
from pipeline.models import MODELS, model_named
from pipeline.quantities import G

MOTION = random_motion(31)


def test_every_model_is_tested() -> None:
    assert {model.name for model in MODELS} == set(VALID)


@pytest.mark.parametrize("name", list(VALID))
def test_the_table_of_every_model(name: str) -> None:
    """The contract's columns in their order, each of its type, one row a parameter set."""
    many = {k: np.full(3, v) for k, v in VALID[name].items()}
    model = model_named(name)
    # Those that are given, and those that have a value by default.
    used = [q.name for q in model.needs if q.name in many or q.default is not None]
    for fidelity in ("history", "reference"):
        table = respond(name, MOTION, fidelity=fidelity, **many)
        assert list(table.columns) == [*(q.name for q in model.gives), "error", "fidelity", "note", "angle", *used]
        assert len(table) == 3
        for quantity in model.gives:
            kind = {"bool": "b", "count": "i"}.get(quantity.unit, "f")
            assert table[quantity.name].dtype.kind == kind, quantity.name
        assert table["error"].dtype.kind == "f"
        assert (table["error"] >= 0.0).all()
        assert set(table["fidelity"]) == {fidelity}
        assert all(isinstance(note, str) for note in table["note"])
        assert table["angle"].isna().all() == (model.directions != 1)


@pytest.mark.parametrize("name", list(VALID))
def test_a_motion_of_nothing_moves_nothing(name: str) -> None:
    for n in (1, 2, 50):
        row = respond(name, along_x(np.zeros(n), 0.01), **VALID[name]).iloc[0]
        still = [
            q.name for q in model_named(name).gives if q.unit not in ("Pa", "deg") and q.name != "overturning_time"
        ]
        for column in still:
            # What hangs pulls by its weight.
            rests = 1.0 if column == "load" else 0.0
            assert row[column] == rests or (column == "uplift_time" and np.isnan(row[column])), column
        assert row["note"] == ""


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("slidding", {}, "there is no model 'slidding'; did you mean 'sliding'"),
        ("xyzzy", {}, "there is no model 'xyzzy'.*The models are: standing, rocking, sliding"),
        ("", {}, "there is no model ''"),
        ("rocking", {**BLOCK, "half_widht": 0.1}, "rocking has no parameter 'half_widht'; did you mean 'half_width'"),
        ("rocking", {**BLOCK, "qqq": 0.1}, "rocking has no parameter 'qqq'.*It takes: half_width, cg_height"),
        ("rocking", {"half_width": 0.1}, r"rocking needs cg_height \[m\]"),
        ("rocking", {**BLOCK, "half_width": None}, r"rocking needs half_width \[m\]"),
        (
            "rocking",
            {**BLOCK, "half_width": -0.1},
            r"half_width must be a finite number above 0 m, not -0.1 \(entry 0\)",
        ),
        ("rocking", {**BLOCK, "half_width": 0.0}, "half_width must be a finite number above 0 m, not 0"),
        ("rocking", {**BLOCK, "half_width": [0.1, np.nan]}, r"half_width must be .* not nan \(entry 1\)"),
        ("rocking", {**BLOCK, "half_width": [0.1, np.inf]}, r"half_width must be .* not inf \(entry 1\)"),
        (
            "rocking",
            {**BLOCK, "restitution": 1.1},
            "restitution must be a finite number at least 0 and at most 1, not 1.1",
        ),
        ("rocking", {**BLOCK, "half_width": "wide"}, "half_width must be a finite number above 0 m, not 'wide'"),
        ("rocking", {**BLOCK, "half_width": [[0.1, 0.2]]}, r"half_width must be .*not an array of shape \(1, 2\)"),
        ("rocking", {**BLOCK, "half_width": [[0.1], [0.2, 0.3]]}, "half_width must be a finite number"),
        ("rocking", {**BLOCK, "half_width": {"a": 1}}, "half_width must be a finite number"),
        (
            "rocking",
            {"half_width": [0.1, 0.2], "cg_height": [1.0, 2.0, 3.0]},
            "different lengths .half_width: 2, cg_height: 3",
        ),
        ("sliding", {"friction_static": -0.1}, "friction_static must be a finite number at least 0, not -0.1"),
        ("sliding", {"friction_static": 0.1, "directions": 3}, "directions must be .* at most 2, not 3"),
        ("sliding", {"friction_static": 0.1, "directions": 1.5}, "directions must be 1 or 2 for all rows"),
        (
            "sliding",
            {"friction_static": 0.1, "directions": [1, 2]},
            "directions must be 1 or 2 for all rows, not .1.0, 2.0",
        ),
        ("swing", {"length": 1.0, "damping": -0.01}, "damping must be a finite number at least 0, not -0.01"),
    ],
)
def test_bad_parameters_are_refused_in_words(name: str, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        respond(name, MOTION, **parameters)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fidelity": "exact"}, "there is no fidelity 'exact'; choose from screen, bound, chart, history, reference"),
        ({"tail": -1.0}, "tail must be at least 0 s, or None for until rest, not -1.0"),
        ({"tail": np.nan}, "tail must be at least 0 s"),
        ({"tail": np.inf}, "tail must be at least 0 s"),
        ({"angle": np.nan}, "angle must be a number of degrees, or None for RotD100, not nan"),
        ({"angle": np.inf}, "angle must be a number of degrees"),
        ({"angle": None, "azimuth_step": 0.0}, "azimuth_step must be above 0 and at most 90 degrees"),
        ({"angle": None, "azimuth_step": 91.0}, "azimuth_step must be above 0 and at most 90 degrees"),
        ({"angle": None, "azimuth_step": np.nan}, "azimuth_step must be above 0 and at most 90 degrees"),
        ({"angle": np.nan, "fidelity": "screen"}, "angle must be a number of degrees"),
        ({"angle": "north"}, "angle must be a number of degrees"),
        ({"tail": "rest"}, "tail must be at least 0 s"),
    ],
)
def test_bad_options_are_refused_in_words(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        respond("rocking", MOTION, **BLOCK, **options)


def test_a_model_without_a_screen_says_so() -> None:
    with pytest.raises(ValueError, match="the paper gives no closed-form criterion for sliding; ask for history"):
        respond("sliding", MOTION, friction_static=0.1, fidelity="screen")


@pytest.mark.parametrize("name", ["rocking", "sliding", "swing"])
@pytest.mark.parametrize("angle", [0.0, None])
def test_no_objects_is_an_empty_table_or_a_clear_error(name: str, angle: float | None) -> None:
    """A gallery can be empty: never an IndexError or a KeyError from inside."""
    first = next(iter(VALID[name]))
    try:
        rows = len(respond(name, MOTION, angle=angle, **{**VALID[name], first: []}))
    except ValueError:
        rows = 0
    assert rows == 0


def test_kinetic_friction_above_the_static_one_is_refused() -> None:
    """Once at rest nothing could start it that kinetic friction would not stop at once: a contradiction.

    (Integrated all the same, it took half a minute in two directions and moved.)
    """
    with pytest.raises(ValueError, match="friction_kinetic"):
        respond("sliding", along_x([1.5] * 3, 0.01), friction_static=0.1, friction_kinetic=0.3, directions=1)


def test_prepare_broadcasts_and_leaves_the_optional_empty() -> None:
    values = prepare(model_named("rocking"), {"half_width": [0.1, 0.2], "cg_height": 1})
    assert {v.shape for v in values.values()} == {(2,)}
    assert {v.dtype for v in values.values()} == {np.dtype(float)}
    assert np.isnan(values["restitution"]).all()
    assert (values["initial_rotation"] == 0.0).all()


def test_broadcasting_is_one_by_one() -> None:
    """Identical, not only close: a row is the same calculation alone."""
    widths, heights = np.array([0.05, 0.1, 0.2, 0.4]), np.array([0.3, 0.6, 0.9, 1.2])
    table = respond("rocking", MOTION, half_width=widths, cg_height=heights, restitution=0.9)
    for k in range(4):
        one = respond("rocking", MOTION, half_width=widths[k], cg_height=heights[k], restitution=0.9)
        pd.testing.assert_frame_equal(one, table.iloc[[k]].reset_index(drop=True), check_exact=True)


@pytest.mark.parametrize(("name", "turn"), [("rocking", 180), ("swing", 180), ("oscillator", 180), ("stress", 180)])
def test_no_angle_is_the_worst_direction(name: str, turn: int) -> None:
    """RotD100: the row of the angle with the largest first output, compared with the explicit loop."""
    table = respond(name, MOTION, angle=None, **VALID[name]).iloc[0]
    first = model_named(name).gives[0].name
    rows = [respond(name, MOTION, angle=float(a), **VALID[name]).iloc[0] for a in range(0, turn, 10)]
    # Where several directions overturn it they tie, and the demand decides.
    best = max(rows, key=lambda row: (row[first], row[model_named(name).demand]))
    assert table[first] == best[first]
    assert table["angle"] == best["angle"]


def test_a_body_with_two_edges_is_turned_all_the_way_round() -> None:
    """Its other edge is far out: the worst direction may lie beyond 180 degrees."""
    body = {"half_width": 0.4, "half_width_other": 0.08, "cg_height": 0.5}
    rows = [respond("rocking", MOTION, angle=float(a), **body).iloc[0] for a in range(0, 360, 10)]
    worst = max(rows, key=lambda row: row["rotation_ratio"])
    table = respond("rocking", MOTION, angle=None, **body).iloc[0]
    assert table["rotation_ratio"] == worst["rotation_ratio"]
    finer = respond("rocking", MOTION, angle=None, azimuth_step=5.0, **body).iloc[0]
    assert finer["rotation_ratio"] >= table["rotation_ratio"]


def test_angle_turns_from_x_towards_y() -> None:
    """An object shaken along 90 degrees feels y alone; along 180 minus x."""
    motion = random_motion(32)
    for angle, row in ((0.0, 0), (90.0, 1), (180.0, 0), (450.0, 1), (-90.0, 1)):
        got = respond("stress", motion, angle=angle, **VALID["stress"])["shear"][0]
        assert got == pytest.approx(10.0 * np.abs(motion.acceleration[row]).max() / 1e-3, rel=1e-12)


@pytest.mark.parametrize("name", [m.name for m in MODELS if m.trace is not None])
def test_a_trace_stays_below_the_maximum_and_comes_near_it(name: str) -> None:
    """Samples miss the peak by (w dt)^2 / 8 at most, 1 % here; the record is long enough for the peak to lie in it."""
    table = respond(name, MOTION, tail=0.0, **VALID[name]).iloc[0]
    history = trace(name, MOTION, **VALID[name])
    assert list(history["t"]) == pytest.approx(list(np.arange(MOTION.samples) * MOTION.dt))
    if "displacement" in table:
        radius = np.hypot(history["u_x"], history.get("u_y", 0.0)).max()
        top = table["displacement"]
    elif name == "unhooking":
        radius, top = history["opening"].max(), table["opening"]
    else:
        radius = history["rotation"].abs().max()
        top = table["rotation_ratio"] * np.arctan2(0.1, 0.5) if name == "rocking" else table["rotation"]
    assert radius <= top * (1.0 + 1e-6)
    assert radius >= 0.98 * top


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("stress", VALID["stress"], "stress has no time history of its own"),
        ("swing", {"length": [1.0, 2.0], "damping": 0.1}, "trace follows one object at a time"),
        ("swing", {"length": [], "damping": 0.1}, "one object|length"),
        ("swing", {"length": -1.0, "damping": 0.1}, "length must be"),
        ("swing", {"length": 1.0, "damping": 0.1, "angle": np.nan}, "angle must be a number"),
        ("swing", {"length": 1.0, "damping": 0.1, "angle": None}, "angle must be a number"),
    ],
)
def test_trace_says_what_is_wrong(name: str, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        trace(name, MOTION, **parameters)


def test_an_unbounded_uplift_ratio_is_explained() -> None:
    """a_z = -g exactly and a push: the ratio is infinite, and the note says why."""
    a = np.vstack([np.ones(20), np.zeros(20), np.full(20, -G)])
    row = respond("rocking", type(MOTION)(0.01, a), **BLOCK).iloc[0]
    assert row["uplift_ratio"] == np.inf
    assert "contact lost" in row["note"]
