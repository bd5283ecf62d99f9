"""The heaviest pages: galleries of 300 objects, resampled from the rows of the demonstration's real collection."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from pipeline.records import Assessment, Item, MeasurementRequest, RunRecord

COUNT = 300


def resampled(record: RunRecord, count: int = COUNT, *, seed: int = 1) -> RunRecord:
    """Return the run of one gallery of that many objects, drawn with repetition from those of a real run on display.

    Each draw gets a number of its own and a place on the floor, so that the page also carries the plan; its findings,
    advice and wishes are those of the real object.
    """
    draw = Random(seed)
    # The same ones, whatever the order of a run's pages.
    shown = sorted(
        (a for a in record.assessments if a.scene.item.on_display),
        key=lambda a: (a.scene.item.gallery, a.scene.item.case, a.scene.item.object_number),
    )
    chosen = draw.choices(shown, k=count)
    asked: dict[str, list[MeasurementRequest]] = {}
    for request in record.wishes or ():
        asked.setdefault(request.object_number, []).append(request)
    drawn = [_renamed(a, f"{a.scene.item.object_number}/{i}", i, draw) for i, a in enumerate(chosen)]
    wishes = tuple(
        replace(w, object_number=new.scene.item.object_number, gallery="Sample")
        for old, new in zip(chosen, drawn, strict=True)
        for w in asked.get(old.scene.item.object_number, ())
    )
    return replace(record, assessments=tuple(drawn), wishes=wishes)


def _renamed(a: Assessment, number: str, at: int, draw: Random) -> Assessment:
    place: dict[str, float] = {
        "position_x_m": 1.5 * (at % 20),
        "position_y_m": 1.5 * (at // 20),
        "orientation_deg": draw.choice([0.0, 30.0, 90.0]),
    }
    item: Item = replace(a.scene.item, object_number=number, gallery="Sample", **place)  # type: ignore[arg-type]
    return Assessment(
        replace(a.scene, item=item),
        tuple(replace(f, object_number=number, gallery="Sample") for f in a.findings),
        tuple(replace(r, object_number=number, gallery="Sample") for r in a.recommendations),
    )
