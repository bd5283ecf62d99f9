"""Phrases of the tables, for the catalogue of a translation: what a report shows of a CSV file's columns."""

import csv
from collections.abc import Collection, Iterator, Mapping
from io import TextIOWrapper
from typing import IO

_Found = tuple[int, str, str, list[str]]


def table_phrases(
    file: IO[bytes],
    keywords: Collection[str],  # noqa: ARG001 - asked of every method of extraction
    comment_tags: Collection[str],  # noqa: ARG001
    options: Mapping[str, str],
) -> Iterator[_Found]:
    """Yield the texts of some columns of a table, as babel asks of a method of extraction.

    options : "columns", the names of the columns, separated by commas
    returns : (line, function, phrase, comments) for each text that is not empty
    """
    wanted = [name.strip() for name in options.get("columns", "").split(",") if name.strip()]
    rows = csv.DictReader(TextIOWrapper(file, encoding="utf-8", newline=""))
    for row in rows:
        yield from ((rows.line_num, "_", row[name], []) for name in wanted if row.get(name))
