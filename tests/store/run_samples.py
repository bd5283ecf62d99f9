"""Runs to store: hostile ones from hypothesis, and a small one that a person can follow."""

import json
import types
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from enum import StrEnum
from itertools import count, groupby
from typing import Any, Union, get_args, get_origin, get_type_hints

from hypothesis import strategies as st
from sqlalchemy import Engine

from pipeline.collection.record import KINDS, STRUCTURED, digest_of, to_records
from pipeline.collection.sealing import seal
from pipeline.records import (
    ITEM_FIELDS,
    Assessment,
    Chart,
    Check,
    DecisionStatus,
    Estimate,
    Finding,
    Found,
    Item,
    Mark,
    MotionSummary,
    Origin,
    Page,
    Recommendation,
    RunRecord,
    Scene,
    Spacing,
    Support,
    Verdict,
)
from pipeline.report.pages.tallies import counts, tally
from pipeline.store.pages import Members, page_digest, page_row
from pipeline.store.results import Stored, anonymous, encode, encode_spacings, keep
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
    if origin is tuple and parts[-1] is not Ellipsis:
        return st.tuples(*map(values_of, parts))
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


_COORDINATES = st.floats(allow_nan=False, allow_infinity=False)
POLYGONS = st.lists(st.tuples(_COORDINATES, _COORDINATES), max_size=4).map(tuple)

ITEMS = st.builds(
    Item,
    **{
        # The inventory has no record whose numbers are not finite.
        name: st.none() | st.floats(allow_nan=False, allow_infinity=False)
        if KINDS[name] == "number"
        else POLYGONS
        if KINDS[name] == "polygon"
        else values_of(hint)
        for name, hint in get_type_hints(Item).items()
    },
)


def _own(assessment: Assessment, item: Item) -> Assessment:
    """Make an assessment that of an object."""
    number, gallery = item.object_number, item.gallery
    return replace(
        assessment,
        scene=replace(assessment.scene, item=item),
        findings=tuple(replace(one, object_number=number, gallery=gallery) for one in assessment.findings),
        recommendations=tuple(
            replace(one, object_number=number, gallery=gallery) for one in assessment.recommendations
        ),
        fragilities=tuple(replace(curve, object_number=number) for curve in assessment.fragilities),
    )


def _run(record: RunRecord, spacings: Sequence[tuple[int, Spacing]]) -> RunRecord:
    """Give a run its gaps, each from one of its objects, in the order of these."""
    numbers = [one.scene.item.object_number for one in record.assessments]
    first = sorted(((at % len(numbers), gap) for at, gap in spacings if numbers), key=lambda pair: pair[0])
    return replace(record, spacings=tuple(replace(gap, first=numbers[at]) for at, gap in first))


RUNS = st.builds(
    _run,
    st.builds(
        RunRecord,
        **dict.fromkeys(("run_id", "started", "finished", "version", "site", "museum"), TEXTS),
        level_notes=values_of(tuple[str, ...]),
        settings=SETTINGS,
        assessments=st.lists(
            st.builds(_own, values_of(Assessment), ITEMS), max_size=3, unique_by=lambda a: a.scene.item.object_number
        ).map(tuple),
        charts=values_of(Mapping[str, Chart]),
        motions=values_of(tuple[MotionSummary, ...]),
        decisions=values_of(tuple[DecisionStatus, ...]),
        demonstration=st.booleans(),
    ),
    st.lists(st.tuples(st.integers(0, 99), values_of(Spacing)), max_size=3),
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


def packed(items: Sequence[Item]) -> bytes:
    """Return records as the inventory gives them away."""
    rows = [
        [*(json.dumps(row[name]) if KINDS[name] in STRUCTURED else row[name] for name in ITEM_FIELDS), digest_of(item)]
        for item, row in zip(items, to_records(list(items)), strict=True)
    ]
    return json.dumps(["an inventory", rows]).encode()


def _named(stored: Stored) -> Stored:
    # As a night's: the same results have the same key.
    return replace(stored, key=seal(stored.found))


def _page(assessments: Sequence[Assessment], wishes: Sequence[Any] | None, gaps: str) -> tuple[Members, list[Stored]]:
    """Return the objects of a page, and their results by unit: one object, or all in one case."""
    alone = count()
    units = groupby(assessments, key=lambda one: one.scene.item.case or next(alone))
    stored, results = [], []
    for _, unit in units:
        told = []
        for one in unit:
            mine = None if wishes is None else [w for w in wishes if w.object_number == one.scene.item.object_number]
            told.append(anonymous(one, {}, None if mine is None else tuple(mine)))
        stored.append(_named(encode("", told)))
        results += [(stored[-1].key, at) for at in range(len(told))]
    items = [one.scene.item for one in assessments]
    return Members(packed(items), tuple(map(digest_of, items)), tuple(results), gaps), stored


def save_run(engine: Engine, record: RunRecord) -> None:
    """Keep a whole run as a night does: the results first, then the run with its pages, one for each gallery."""
    stored, pages, rows = [], [], []
    gaps = ""
    if record.spacings:
        stored.append(_named(encode_spacings("", record.spacings, {})))
        gaps = stored[0].key
    galleries = groupby(record.assessments, key=lambda one: (one.scene.item.on_display, one.scene.item.gallery))
    # A run of nothing, too, says on a page that it did not ask what is worth measuring.
    for (on_display, gallery), found in [(at, list(some)) for at, some in galleries] or [((True, ""), [])]:
        members, results = _page(found, record.wishes, gaps)
        key = page_digest(members.digests, members.results, gaps)
        pages.append(Page(key, gallery, on_display, 1, 1, record.run_id, record.started))
        rows.append(page_row(pages[-1], members))
        stored += results
    keep(engine, record.run_id, record.started, stored)
    told = counts(tally(Found(record.assessments, record.wishes, record.spacings)))
    commit_run(engine, replace(record, assessments=(), wishes=None, spacings=()), pages, rows, counts=told)
