"""Files of a source, and what is said where one cannot be read."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import BinaryIO

from pipeline.collection.errors import CollectionError


def stream_of(source: str | Path | BinaryIO, file: str, stack: ExitStack) -> BinaryIO:
    """Return a stream of a source's bytes.

    Parameters
    ----------
    source : str, Path or binary stream
        A stream comes back as it is; a file is opened.
    file : str
        Its name in messages.
    stack : ExitStack
        With which an opened file is closed.

    Returns
    -------
    binary stream
        At the file's beginning, or where it was.

    Raises
    ------
    CollectionError
        For a file that cannot be opened.
    """
    if not isinstance(source, str | Path):
        return source
    try:
        return stack.enter_context(Path(source).open("rb"))
    except OSError as problem:
        raise unreadable(file, problem) from problem


def unreadable(file: str | Path, problem: OSError) -> CollectionError:
    """Return the error of a file that cannot be read, with the remedy.

    Parameters
    ----------
    file : str or Path
        Its name in messages.
    problem : OSError
        Why.

    Returns
    -------
    CollectionError
    """
    return CollectionError(
        f"{file}: cannot be read: {problem.strerror or problem}; see whether the path is right, the share is "
        "mounted and Kouros may read it"
    )
