"""Words of rules and records as the desk says them: by the titles of their tables, in the reader's language."""

from functools import cache

from pipeline.report.language import said
from pipeline.report.text import words
from pipeline.tables import table

_TABLES = {"hanging": "hangings", "furniture": "furniture", "mount": "mounts"}
"""Field or statement of a rule -> the table whose rows it names."""


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


def name_told(name: str) -> str:
    """Return the name of a field as a label."""
    told = words(name)
    return told[:1].upper() + told[1:]


@cache
def _titles(field: str) -> dict[str, str]:
    listed = _TABLES.get(field)
    return {row[field]: row["title"] for row in table(listed)} if listed else {}
