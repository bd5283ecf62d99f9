"""Names from outside, made harmless: of files and folders, and words for people."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

_LONGEST = 120


def safe_name(name: str) -> str:
    """Return a file's name without anything that could lead elsewhere, hide it or steer a terminal.

    Parameters
    ----------
    name : str
        The last part of a path, or words.

    Returns
    -------
    str
        Letters, digits and ``._+-`` alone, at most 120 of them, beginning with a letter or a digit; the ending stays.
    """
    plain = unicodedata.normalize("NFC", name.encode("utf-8", "replace").decode("utf-8"))
    kept = re.sub(r"[^\w.+-]+", "_", plain).lstrip("._+-")
    stem, dot, ending = kept.rpartition(".")
    while len(kept.encode()) > _LONGEST:
        stem, kept = stem[:-1], stem[:-1] + dot + ending if stem else kept[:-1]
    return kept or "file"


def one_line(text: str) -> str:
    """Return words in one line of at most 200 characters, without what steers a terminal."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())[:200]


def free_name(name: str, taken: Iterable[str]) -> str:
    """Return a file's name that is not among those taken, whatever their case: with a number before it, where it is."""
    lower = {one.casefold() for one in taken}
    numbered = (name if n == 1 else f"{n}-{name}" for n in range(1, len(lower) + 3))
    return next(one for one in numbered if one.casefold() not in lower)
