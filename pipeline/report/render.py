"""The pages: views and templates become a folder of files that needs no network and no program but a browser."""

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from pipeline.records import Chart, RunRecord
from pipeline.report.compose import STORED_PAGE, compose
from pipeline.report.errors import ReportError
from pipeline.report.exports import export
from pipeline.report.svg import PATTERNS, Drawing
from pipeline.report.text import clean, plain
from pipeline.report.traces import trace
from pipeline.report.units import Units
from pipeline.report.views import FigureView, GalleryView
from pipeline.resources import resource


def render(record: RunRecord, folder: Path, *, units: Units | None = None) -> Path:
    """Write a whole report: pages and exports.  The same record gives the same bytes.

    folder  : a new folder; it appears only when everything in it is written
    units   : the reader's units; centimetres where None
    returns : the path of index.html
    raises  : ReportError if the folder exists, or if the record cannot be shown (see ``compose``)
    """
    folder = Path(folder)
    if folder.exists():
        raise ReportError(f"{folder} exists already; a report never overwrites another: name a new folder")
    partial = folder.with_name(f".{folder.name}.{os.getpid()}.partial")
    partial.mkdir(parents=True)
    chosen = units or Units()
    try:
        for name, text in _pages(record, chosen):
            (partial / name).write_text(text, encoding="utf-8", newline="\n")
        export(record, partial, chosen)
        partial.rename(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise
    return folder / "index.html"


def _pages(record: RunRecord, units: Units) -> list[tuple[str, str]]:
    museum = compose(record, units)
    env = environment()
    shared = {"museum": museum, "units": units, "stored_page": STORED_PAGE}
    traces = {
        view.anchor: Markup(trace(motion, units, view.anchor))  # noqa: S704 - svg.py escapes all text itself
        for view, motion in zip(museum.motions, record.motions, strict=True)
    }
    pages = [
        ("index.html", _fill(env, "index.html", shared | {"here": "index"})),
        ("method.html", _fill(env, "method.html", shared | {"here": "method"})),
        ("motion.html", _fill(env, "motion.html", shared | {"here": "motion", "traces": traces})),
    ]
    for gallery in museum.galleries:
        drawings = _drawings(gallery, record.charts, units)
        context = shared | {
            "here": "gallery",
            "gallery": gallery,
            "drawings": list(drawings.values()),
            "symbols": Markup(PATTERNS + "".join(d.symbol() for d in drawings.values())),  # noqa: S704
            "figure": _figure(drawings),
        }
        pages.append((gallery.page, _fill(env, "gallery.html", context)))
    return pages


def environment() -> Environment:
    """Return the templates' environment: everything escaped, nothing undefined, phrases marked for translation."""
    env = Environment(
        loader=FileSystemLoader(resource("templates")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        extensions=["jinja2.ext.i18n"],
        finalize=_present,
    )
    env.install_null_translations(newstyle=True)  # type: ignore[attr-defined]
    env.filters["plain"] = plain
    return env


def _present(value: object) -> object:
    """Refuse to print None, and clean any plain text once more on its way out."""
    if value is None:
        raise ReportError("a template prints None; give the view a text for what is not known")
    return clean(value) if type(value) is str else value


def _fill(env: Environment, template: str, context: Mapping[str, Any]) -> str:
    return env.get_template(template).render(context)


def _drawings(gallery: GalleryView, charts: Mapping[str, Chart], units: Units) -> dict[str, Drawing]:
    return {key: Drawing(charts[key], units, f"c{i}") for i, key in enumerate(gallery.charts)}


def _figure(drawings: Mapping[str, Drawing]) -> Callable[[FigureView, str, str], Markup]:
    def figure(view: FigureView, ident: str, subject: str) -> Markup:
        return Markup(drawings[view.chart].figure(view.spots, ident, subject))  # noqa: S704

    return figure
