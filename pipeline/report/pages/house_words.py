"""House rules and words of records as people say them: by the titles of their tables, in the reader's language."""

from collections.abc import Callable, Mapping
from functools import cache

from pipeline.report.language import _, said
from pipeline.report.text import words
from pipeline.tables import table

_TABLES = {"hanging": "hangings", "furniture": "furniture", "mount": "mounts"}
"""Field or statement of a rule -> the table whose rows it names."""


# Looked up in the language of the page.
STATED: Mapping[str, Callable[[], str]] = {
    "hanging": lambda: _("how they hang"),
    "furniture": lambda: _("what they stand on or in"),
    "furniture_anchorage": lambda: _("whether that is fastened"),
    "surface": lambda: _("what lies under them"),
    "held": lambda: _("how they are held"),
    "mount": lambda: _("how their mount holds them"),
    "friction": lambda: _("friction under them"),
    "clearance_m": lambda: _("free distance around them"),
    "cg_height_m": lambda: _("height of the centre of gravity"),
    "cg_ratio": lambda: _("height of the centre of gravity as a share of the object's height"),
    "base_ratio": lambda: _("footing as a share of the width"),
    "suspension_length_m": lambda: _("from hook to centre of gravity"),
    "suspension_ratio": lambda: _("from hook to centre of gravity as a share of the object's height"),
    "damping": lambda: _("damping ratio"),
    "frequency_hz": lambda: _("natural frequency"),
}
"""What a house rule may state, what people know without an instrument first."""


def stated_told(name: str) -> str:
    """Return what a house rule states, as the page that asks for it says it."""
    return STATED[name]() if name in STATED else words(name)


def word_told(field: str, word: str) -> str:
    """Return a word that a field may hold, or a rule may state, as people say it.

    Parameters
    ----------
    field : str
        Such as "hanging".
    word : str
        Such as "two_hooks".
    """
    title = _titles(field).get(str(word))
    return said(title) if title else words(str(word))


@cache
def _titles(field: str) -> dict[str, str]:
    listed = _TABLES.get(field)
    return {row[field]: row["title"] for row in table(listed)} if listed else {}
