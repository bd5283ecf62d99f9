"""Templates filled in: everything escaped, nothing undefined, phrases in the reader's language."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from pipeline.report.errors import ReportError
from pipeline.report.language import Language
from pipeline.report.text import clean, count, plain
from pipeline.resources import resource


def environment(language: Language | None = None) -> Environment:
    """Return the templates' environment: everything escaped, nothing undefined, phrases in the language."""
    env = Environment(
        loader=FileSystemLoader(resource("templates")),
        autoescape=True,
        # Templates do not change while a report is written: nobody need look.
        auto_reload=False,
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
