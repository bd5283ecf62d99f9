"""Runs to store: hostile ones from hypothesis, and a small one that a person can follow."""

import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from enum import StrEnum
from typing import Any, Union, get_args, get_origin, get_type_hints
from uuid import uuid4

from hypothesis import strategies as st
from sqlalchemy import Engine

from pipeline.records import (
    Assessment,
    Chart,
    Check,
    Estimate,
    Finding,
    Found,
    Item,
    Mark,
    MotionSummary,
    Origin,
    Recommendation,
    RunRecord,
    Scene,
    Sheet,
    Spacing,
    Standing,
    Support,
    Verdict,
)
from pipeline.report.pages.tallies import tally
from pipeline.store.results import encode
from pipeline.store.runs import commit_run

HOSTILE = (
    "", " ", "\0", "a\0b", "\x1a0", "\x1a\x1a1\0", "'; DROP TABLE run; --", "%s %(run_id)s :run_id ?", "{demand} {0}",
    "<script>alert(1)</script>", "NaN", "Infinity", "null", '{"$float": "inf"}', "\u202etfel", "e\u0301\u00e9",
    "\U0001f3fa", "\uffff\ufeff", "line\r\nbreak\ttab", "\\u0000", "1" * 300,
)  # fmt: skip

TEXTS = st.text(max_size=8) | st.sampled_from(HOSTILE)
FLOATS = st.floats(allow_nan=False)  # NaN equals nothing, itself included: it has a test of its own
INTEGERS = st.integers(-(2**63), 2**63 - 1)
PLAIN = {str: TEXTS, float: FLOATS, int: INTEGERS, bool: st.booleans()}

_leaf = st.none() | st.booleans() | st.integers() | FLOATS | TEXTS
_keys = TEXTS | st.sampled_from(["$float", "$tuple", "$", "$$float"])
VALUES = st.recursive(
    _leaf,
    lambda inner: (
        st.lists(inner, max_size=3) | st.lists(inner, max_size=3).map(tuple) | st.dictionaries(_keys, inner, max_size=3)
    ),
    max_leaves=8,
)
SETTINGS = st.dictionaries(_keys, VALUES, max_size=4)


def values_of(hint: Any) -> st.SearchStrategy[Any]:
    """Any value of a type hint of the records."""
    if hint in PLAIN:
        return PLAIN[hint]
    if hint is type(None):
        return st.none()
    origin, parts = get_origin(hint), get_args(hint)
    if origin in {Union, types.UnionType}:
        return st.one_of(*map(values_of, parts))
    if origin is tuple:
        return st.lists(values_of(parts[0]), max_size=2).map(tuple)
    if origin is Mapping:
        return st.dictionaries(TEXTS, values_of(parts[1]), max_size=2)
    if issubclass(hint, StrEnum):
        return st.sampled_from(hint)
    assert is_dataclass(hint)
    hints = get_type_hints(hint)
    return st.builds(
        hint, **{field.name: st.deferred(lambda h=hints[field.name]: values_of(h)) for field in fields(hint)}
    )


def _own(assessment: Assessment) -> Assessment:
    """Make the findings and recommendations those of the assessment's object."""
    number = assessment.scene.item.object_number
    return replace(
        assessment,
        findings=tuple(replace(finding, object_number=number) for finding in assessment.findings),
        recommendations=tuple(replace(advice, object_number=number) for advice in assessment.recommendations),
        fragilities=tuple(replace(curve, object_number=number) for curve in assessment.fragilities),
    )


RUNS = st.builds(
    RunRecord,
    **dict.fromkeys(("run_id", "started", "finished", "version", "site", "museum"), TEXTS),
    level_notes=values_of(tuple[str, ...]),
    settings=SETTINGS,
    assessments=st.lists(
        values_of(Assessment).map(_own), max_size=3, unique_by=lambda a: a.scene.item.object_number
    ).map(tuple),
    charts=values_of(Mapping[str, Chart]),
    motions=values_of(tuple[MotionSummary, ...]),
    decisions=values_of(tuple[Standing, ...]),
    demonstration=st.booleans(),
    spacings=values_of(tuple[Spacing, ...]),
)


def finding(number: str, model: str = "rocking", verdict: Verdict = Verdict.PASS, **changed: Any) -> Finding:
    """One finding of the object, all else equal."""
    sample = Finding(
        object_number=number,
        gallery="G1",
        level="design",
        model=model,
        title="Rocking",
        demand_name="rotation_ratio",
        demand=0.4,
        unit="-",
        low=0.3,
        high=0.5,
        capacity=1.0,
        capacity_origin=Origin.DERIVED,
        utilisation=0.4,
        verdict=verdict,
        fidelity="chart",
        error=1e-3,
        decided_by="chart",
        motion="malibu",
        motion_hash="ab" * 32,
        sentence="It rocks by {demand}.",
        assumptions=("friction 0.3, stone on wood",),
        mark=Mark("stability:ab", 0.1, 0.2),
    )
    return replace(sample, **changed)


def assessment(number: str, *findings: Finding, gallery: str = "G1", half_width: float = 0.1) -> Assessment:
    """One assessed object with one recommendation."""
    item = Item(number, gallery, title="Kouros", height_m=2.0)
    width = Estimate.measured(half_width, "m")
    scene = Scene(item, "statue", "freestanding", Support.FREESTANDING, ("rocking",), {"half_width": width})
    check = Check("sliding", "Sliding", 0.1, "m", 0.2, 0.5, True)
    advice = Recommendation(
        number, gallery, "design", "room", "More room", "Give it {room}.", {"room": 0.2}, {"room": "m"}, (check,)
    )
    return Assessment(scene, tuple(replace(found, gallery=gallery) for found in findings), (advice,))


def motion(name: str, motion_hash: str, level: str = "design") -> MotionSummary:
    """A motion's summary."""
    return MotionSummary(
        name, motion_hash, level, "a station", 0.005, 3, {"pga": 3.0}, ("scaled",), series={"x": (0.0, 1.0)}
    )


def run(run_id: str, *assessments: Assessment, day: int = 1, motions: tuple[MotionSummary, ...] = ()) -> RunRecord:
    """A finished run of that day."""
    return RunRecord(
        run_id=run_id,
        started=f"2031-05-{day:02}T01:00:00+00:00",
        finished=f"2031-05-{day:02}T01:05:00+00:00",
        version="0.1.0",
        site="malibu",
        museum="A museum",
        level_notes=("nobody approved the level design",),
        settings={"fidelity": "auto", "keep": 30},
        assessments=assessments,
        charts={},
        motions=motions,
    )


def save_run(engine: Engine, record: RunRecord) -> None:
    """Keep a whole run as one sheet, as a night keeps its many."""
    found = Found(record.assessments, record.wishes, record.spacings)
    encoded = encode(uuid4().hex, "", found, tally)
    sheet = Sheet(encoded.key, "", True, 1, 1, record.run_id, record.finished, encoded.counts)
    commit_run(engine, replace(record, assessments=(), wishes=None, spacings=()), [sheet], [encoded])
