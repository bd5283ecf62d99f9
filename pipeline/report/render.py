"""The pages: views and templates become a folder of files that needs no network and no program but a browser."""

import os
import shutil
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from pipeline.records import RunChanges, RunRecord
from pipeline.report.compose import STORED_PAGE, compose
from pipeline.report.errors import ReportError
from pipeline.report.exports import export
from pipeline.report.language import Language, speaking
from pipeline.report.notes import page_notes
from pipeline.report.svg import PATTERNS, Drawing
from pipeline.report.text import clean, count, plain
from pipeline.report.traces import trace
from pipeline.report.units import Units
from pipeline.report.views import FigureView, State
from pipeline.resources import resource


def render(
    record: RunRecord,
    folder: Path,
    *,
    units: Units | None = None,
    language: Language | None = None,
    changes: RunChanges | None = None,
) -> Path:
    """Write a whole report: pages and exports.  The same record gives the same bytes.

    folder  : a new folder; it appears only when everything in it is written
    units   : the reader's units; centimetres where None
    language: of the pages; English where None.  The exports keep the words of the run, for programs read them.
    changes : since the run before, for the index; None where there was none
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
        with speaking(language or Language()):
            pages = _pages(record, chosen, language or Language(), changes)
        for name, text in pages:
            (partial / name).write_text(text, encoding="utf-8", newline="\n")
        export(record, partial, chosen)
        partial.rename(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise
    return folder / "index.html"


def _pages(record: RunRecord, units: Units, language: Language, changes: RunChanges | None) -> list[tuple[str, str]]:
    museum = compose(record, units, changes)
    env = environment(language)
    shared: dict[str, Any] = {"museum": museum, "units": units, "stored_page": STORED_PAGE, "State": State}
    shown = (*(m.charts for m in museum.motions), *(g.charts for g in museum.galleries))
    used = dict.fromkeys(key for keys in shown for key in keys)
    drawings = {key: Drawing(record.charts[key], units, f"c{i}") for i, key in enumerate(used)}
    traces = {
        view.anchor: Markup(trace(motion, units, view.anchor))  # noqa: S704 - svg.py escapes all text itself
        for view, motion in zip(museum.motions, record.motions, strict=True)
    }
    shaken = _drawn([key for motion in museum.motions for key in motion.charts], drawings)
    # Charts of no motion: what accuracy costs, where somebody measured it.
    loose = [key for key in record.charts if not any(motion.hash[:16] in key for motion in record.motions)]
    drawings |= {key: Drawing(record.charts[key], units, f"m{i}") for i, key in enumerate(loose)}
    measured = _drawn(loose, drawings)
    pages = [
        ("index.html", fill(env, "index.html", shared | {"here": "index"})),
        ("method.html", fill(env, "method.html", shared | measured | {"here": "method"})),
        ("motion.html", fill(env, "motion.html", shared | shaken | {"here": "motion", "traces": traces})),
    ]
    script = Markup(resource("templates", "gallery.js").read_text(encoding="utf-8").strip())  # noqa: S704 - our own
    allowed = b64encode(sha256(script.encode()).digest()).decode()
    for gallery in museum.galleries:
        context = shared | _drawn(gallery.charts, drawings) | {"script": script, "script_hash": allowed}
        context |= {"here": "gallery", "gallery": gallery, "notes": page_notes(gallery.objects)}
        pages.append((gallery.page, fill(env, "gallery.html", context)))
    return pages


def environment(language: Language | None = None) -> Environment:
    """Return the templates' environment: everything escaped, nothing undefined, phrases in the language."""
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
    spoken = language or Language()
    phrases = spoken.phrases
    env.install_gettext_translations(phrases, newstyle=True)  # type: ignore[attr-defined]
    # The pages ask for the same few phrases a hundred thousand times.
    env.globals["_"] = lru_cache(maxsize=1024)(lambda text: Markup(phrases.gettext(text)))  # noqa: S704
    env.globals["language"] = spoken
    env.filters["plain"] = plain
    env.filters["drawn"] = Markup  # of a drawing of ours, which escapes all text itself
    env.filters["thousands"] = count
    return env


def _present(value: object) -> object:
    """Refuse to print None."""
    if value is None:
        raise ReportError("a template prints None; give the view a text for what is not known")
    return value


def fill(env: Environment, template: str, context: Mapping[str, Any]) -> str:
    """Return a page: a template filled in, with nothing in it that no page may carry."""
    # Once more over the whole page, because a template may print a text that no view has cleaned.
    return clean(env.get_template(template).render(context))


def _drawn(keys: Sequence[str], drawings: Mapping[str, Drawing]) -> dict[str, Any]:
    """Return what a page needs to show these charts: their symbols, the charts themselves, and the marking of them."""
    mine = {key: drawings[key] for key in keys}
    symbols = PATTERNS + "".join(d.symbol() for d in mine.values())

    def figure(view: FigureView, subject: str) -> Markup:
        return Markup(mine[view.chart].figure(view.spots, subject))  # noqa: S704

    def bare(key: str) -> Markup:
        return Markup(mine[key].figure((), ""))  # noqa: S704

    return {"drawings": mine, "symbols": Markup(symbols), "figure": figure, "bare": bare}  # noqa: S704
