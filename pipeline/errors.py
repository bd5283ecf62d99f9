"""Errors that people can mend, and the exit code that each of them ends a command with.

Whatever is raised that is no `KourosError` is a fault of Kouros, however it is called: a ValueError from inside a
library is not the user's.
"""

import re
import traceback
from collections.abc import Collection
from difflib import get_close_matches
from pathlib import Path
from typing import ClassVar

_PACKAGE = Path(__file__).parent

FAULT = "a fault of Kouros, not of yours"
"""How the words begin that are told of what is no `KourosError`."""

_LONGEST = 300
"""Characters of an unexpected error that are told: some quote whole arrays."""


class KourosError(Exception):
    """Something that a person can mend: the message names file, row or field, what is wrong and the remedy.

    Attributes
    ----------
    exit_code : ClassVar[int]
        Of the command that ends with it: 2 usage or settings, 4 a motion was refused, 5 collection unreachable, 6
        another run holds the lock, 7 input shrank suspiciously.
    """

    exit_code: ClassVar[int] = 2


class DamageWarning(UserWarning):
    """Something that Kouros keeps is not what was written; what can be made again is."""


class InputError(KourosError, ValueError):
    """A value that was given, in a call, a file or a table, and cannot be used."""


def raised_at(problem: BaseException) -> str:
    """Return the place in Kouros that an error came from, "" where there is none.

    An error of another process has no traceback here: it carries the place as an attribute of this name.
    """
    there = getattr(problem, "raised_at", None)
    if isinstance(there, str):
        return there
    own = [step for step in traceback.extract_tb(problem.__traceback__) if _PACKAGE in Path(step.filename).parents]
    return "".join(f"{Path(s.filename).relative_to(_PACKAGE).as_posix()}, line {s.lineno}, {s.name}" for s in own[-1:])


def fault_words(problem: BaseException) -> str:
    """Return an unexpected error in words, with the place in Kouros that it came from."""
    place = raised_at(problem)
    at = f" ({place})" if place else ""
    said = str(problem) if len(str(problem)) <= _LONGEST else f"{str(problem)[:_LONGEST]}..."
    return f"{type(problem).__name__}{': ' if said else ''}{said}{at}"


def mends_toml(problem: Exception) -> str:
    """Return what mends a text that is not TOML, by what its reader says."""
    if any(word in str(problem) for word in ("twice", "overwrite", "mutate")):
        return "that table or key is there before: put all of its lines below the first of them"
    return "quote texts and write one key a line"


def near(name: str, known: Collection[str]) -> str:
    """Return a question after the names that are most like one that is not known.

    Parameters
    ----------
    name : str
        The one that is not known.
    known : collection of str
        Those that are.

    Returns
    -------
    str
        "; did you mean 'x' or 'y'?", or "" where none is like it.
    """
    # Of "Gallery 11" the gallery is meant that begins so, and none whose letters are as many.
    begins = sorted(one for one in known if re.match(rf"{re.escape(name)}\b", one, re.IGNORECASE)) if name else []
    close = begins[:3] or get_close_matches(name, known, n=3)
    return f"; did you mean {' or '.join(map(repr, close))}?" if close else ""
