"""The answer to an earthquake as files: JSON, CSV and GeoJSON beside the page and the sheets."""

import csv
import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pipeline.event.answer import Answer, GalleryAnswer, ObjectAnswer
from pipeline.event.capacities import KINDS
from pipeline.event.message import ReportedEarthquake
from pipeline.report.language import Language
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.event_page import event_page, event_sheets, told_of
from pipeline.report.text import clean, safe_cell

ANSWER, TABLE, PLACES, PAGE = "answer.json", "objects.csv", "event.geojson", "index.html"
"""The files of an answer besides the sheets."""

BRIEF = "event.json"
"""The answer without galleries and objects, what was found of these, and what it answers: to answer it anew."""

EVENT_COLUMNS = (
    "rank", "object_number", "title", "gallery", "case", "floor", "told", "probability", "band",
    *(f"p_{name}" for name in KINDS[1:]), "p_moved", "value", "danger", "expected_loss", "aftershock", "make_safe",
    "reported",
)  # fmt: skip


def event_document(answer: Answer, event: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer for programs.

    Parameters
    ----------
    answer : Answer
        What the shaking did.
    event : mapping
        What is said of the earthquake and of the answer itself, JSON-ready.
    """
    shaking, down = answer.shaking, answer.count
    return {
        "event": dict(event),
        "shaking": {
            "pga_g": _rounded(shaking.pga_g),
            "pgv_cm_s": _rounded(shaking.pgv_cm_s or 0.0),
            "pga_ln_sd": _rounded(shaking.pga_ln_sd),
            "pgv_ln_sd": _rounded(shaking.pgv_ln_sd),
            "from": clean(shaking.origin),
        },
        "expected": {"fallen": _rounded(down.fallen), "low": down.low, "high": down.high},
        "galleries": [_gallery(one) for one in answer.galleries],
        "objects": [_object(one) for one in answer.objects],
    }


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def _gallery(one: GalleryAnswer) -> dict[str, Any]:
    return {
        "gallery": clean(one.name),
        "floor": clean(one.floor),
        "objects": one.objects,
        "unknown": one.unknown,
        "fallen": _rounded(one.count.fallen),
        "low": one.count.low,
        "high": one.count.high,
        "expected_loss": _rounded(one.expected_loss),
        "make_safe": one.make_safe,
    }


def _object(one: ObjectAnswer) -> dict[str, Any]:
    return {
        "object_number": clean(one.number),
        "title": clean(one.title),
        "gallery": clean(one.gallery),
        "case": clean(one.case),
        "floor": clean(one.floor),
        "probability": None if one.probability is None else _rounded(one.probability),
        "band": None if one.band is None else one.band.value,
        "states": {name: _rounded(value) for name, value in one.states.items()},
        "moved": _rounded(one.moved),
        "value": _rounded(one.value),
        "danger": _rounded(one.danger),
        "expected_loss": _rounded(one.expected_loss),
        "aftershock": one.aftershock,
        "make_safe": one.make_safe,
        "reported": one.reported,
    }


def document_text(document: Mapping[str, Any]) -> str:
    """Return a document as JSON with a line for each gallery and each object, so that 100,000 take seconds."""
    dumps = partial(json.dumps, ensure_ascii=False, allow_nan=False)
    parts = []
    for name, value in document.items():
        if isinstance(value, list) and value:
            rows = ",\n".join(f"  {dumps(one)}" for one in value)
            parts.append(f" {dumps(name)}: [\n{rows}\n ]")
        else:
            parts.append(f" {dumps(name)}: {dumps(value)}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def write_event(
    folder: Path,
    answer: Answer,
    quake: ReportedEarthquake,
    site: tuple[float, float],
    event: Mapping[str, Any],
    head: PageHead,
    language: Language,
    question: Mapping[str, Any],
) -> None:
    """Write everything of an answer into a folder that is there.

    Parameters
    ----------
    folder : Path
        Empty.
    answer : Answer
        What the shaking did.
    quake : ReportedEarthquake
        Which it was.
    site : (float, float)
        Of the museum, degrees north and east.
    event : mapping
        As of `event_document`.
    head : PageHead
        Of the run that the answer rests on.
    language : Language
        The reader's.
    question : mapping
        All that is needed to answer the same anew, JSON-ready.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    document = event_document(answer, event)
    pages = {PAGE: event_page(answer, quake, quake.distance_km(*site), head, language, ran(event))}
    pages |= event_sheets(answer, quake, head, language)
    pages[ANSWER] = document_text(document)
    # By their own numbers, as whoever looks for one has it.
    reported = {one.number: one.reported for one in answer.objects if one.reported}
    brief = {name: document[name] for name in ("event", "shaking", "expected")} | {
        "reported": reported,
        "question": question,
    }
    pages[BRIEF] = document_text(brief)
    pages[PLACES] = json.dumps(_places(document, quake, site), ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    for name, text in pages.items():
        # A number that was badly decoded before it came here must not keep the page from being written.
        (folder / name).write_text(text, encoding="utf-8", errors="replace")
    with (folder / TABLE).open("w", encoding="utf-8", errors="replace", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(EVENT_COLUMNS)
        writer.writerows(_row(at, one) for at, one in enumerate(answer.objects, start=1))


def _row(at: int, one: ObjectAnswer) -> list[str]:
    known = one.probability is not None
    values = [one.probability, *(one.states.get(name) for name in KINDS[1:]), one.moved, one.value, one.danger,
              one.expected_loss]  # fmt: skip
    harm, *rest = [f"{value:.4g}" if known and value is not None else "" for value in values]
    texts = [clean(text) for text in (one.number, one.title, one.gallery, one.case, one.floor, told_of(one))]
    said = ["yes" if flag else "no" for flag in (one.aftershock, one.make_safe)]
    row = [str(at), *map(safe_cell, texts), harm, "" if one.band is None else one.band.value]
    return [*row, *rest, *said, safe_cell(one.reported)]


def ran(event: Mapping[str, Any]) -> tuple[int, str]:
    """Return of how many objects the models were run for this answer, and under what."""
    return int(event.get("modelled", 0)), str(event.get("modelled_under", ""))


def _places(document: Mapping[str, Any], quake: ReportedEarthquake, site: tuple[float, float]) -> dict[str, Any]:
    """Return the museum, the epicentre and the galleries as GeoJSON; a gallery has no place of its own on a map."""
    shaken = {**document["shaking"], **document["expected"]}
    features = [_feature(site, {"kind": "museum", **shaken})]
    if quake.latitude is not None and quake.longitude is not None:
        said = {"kind": "epicentre", "name": clean(quake.name or quake.id), "magnitude": quake.magnitude}
        features.append(_feature((quake.latitude, quake.longitude), said))
    features += [_feature(None, {"kind": "gallery", **one}) for one in document["galleries"]]
    return {"type": "FeatureCollection", "features": features}


def _feature(place: tuple[float, float] | None, properties: Mapping[str, Any]) -> dict[str, Any]:
    geometry = None if place is None else {"type": "Point", "coordinates": [place[1], place[0]]}
    return {"type": "Feature", "geometry": geometry, "properties": dict(properties)}
