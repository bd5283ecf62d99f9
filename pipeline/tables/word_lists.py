"""Words that several rows share: word_lists.csv.  A cell has all words of a list where it says `@` and its name."""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Annotated

from pydantic import AfterValidator

from pipeline.errors import InputError, near
from pipeline.tables import table
from pipeline.tables.rows import Entries, TableRow, Text, checked, once

MARK = "@"
"""What a reference to a list begins with."""


class _WordList(TableRow):
    list: Text
    words: Entries
    why: Text


@cache
def word_lists() -> Mapping[str, tuple[str, ...]]:
    """Return the lists by name.

    Returns
    -------
    Mapping[str, tuple[str, ...]]
        The words of each, as they are written.

    Raises
    ------
    TableError
        Naming file, line, list, column and remedy.
    """
    rows = checked(_WordList, table("word_lists"), "word_lists.csv", named="list")
    once((row.list for row in rows), "list", "word_lists.csv")
    return {row.list: row.words for row in rows}


def listed(entries: tuple[str, ...]) -> tuple[str, ...]:
    """Return entries of a cell with the words of each list in place of its name, none twice.

    Parameters
    ----------
    entries : tuple of str
        Words, and names of lists behind `@`.

    Returns
    -------
    tuple[str, ...]

    Raises
    ------
    InputError
        For a list that there is not.
    """
    if not any(entry.startswith(MARK) for entry in entries):
        return entries
    lists = word_lists()
    out: list[str] = []
    for entry in entries:
        name = entry.removeprefix(MARK)
        if name == entry:
            out.append(entry)
        elif name in lists:
            out += lists[name]
        else:
            raise InputError(f"word_lists.csv has no list {name[:80]!r}{near(name, lists)}")
    return tuple(dict.fromkeys(out))


def names_of_things() -> Iterator[tuple[str, str]]:
    """Yield each word by which rules.csv knows a thing, an ending behind its asterisk, after its class.

    Yields
    ------
    tuple[str, str]
        Class and word, as they are written.
    """
    for row in table("rules"):
        for word in listed(tuple(filter(None, row["words"].split("|")))):
            yield row["class"], word


Listed = Annotated[Entries, AfterValidator(listed)]
"""A cell whose entries are parted by `|`, some of them names of lists behind `@`."""
