"""Rows of bare numbers that are taken many at once are read as if each were looked at by itself."""

import random
import re

import pytest

from pipeline.motions.formats import columns
from pipeline.motions.formats.record_text import FormatError, Lines

PLAIN = ("1", "-2.5", "+.5", "3.", "1e5", "1E-3")
ODD = (
    *PLAIN,
    "1D2",
    '"4"',
    "1" * 20,
    "1" * 21,
    "1.e400",
    "nan",
    "",
    "1-2",
    "1.0-2.0",
    "x",
    "00:00:01",
    "5\x0c",
    "\x00",
)
GAPS = (" ", "  ", "\t", ",", " , ", ";", "\r", " \r")


def rows(chance: random.Random) -> tuple[Lines, int]:
    """Rows of one width, and in most files one or two that are odd in some way."""
    gap, width, count = chance.choice(GAPS[:6]), chance.randint(1, 4), chance.choice((3, 6, 300, 600))
    odd = chance.sample(range(count), chance.choice((0, 1, 2)))
    lines = []
    for row in range(count):
        if row in odd:
            cells = [chance.choice(ODD) for _ in range(width + chance.choice((0, 0, -1, 1)))]
            text = chance.choice(GAPS).join(cells) + chance.choice(("", " ", ",", "\r"))
        else:
            text = gap.join(chance.choice(PLAIN) for _ in range(width))
        lines.append(text.encode("latin-1"))
    return Lines("some.txt", lines), width


def read(lines: Lines, width: int) -> str:
    """The numbers, or why they are refused."""
    try:
        values, same = columns._values(lines, 0, columns._form(lines.text(0)), width)
    except FormatError as problem:
        return str(problem)
    return f"{values.tolist()} {same}"


def test_many_at_once_are_what_each_is_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    chance = random.Random(5)
    files = [rows(chance) for _ in range(300)]
    together = [read(*one) for one in files]
    monkeypatch.setattr(columns, "_plain_rows", lambda *_: re.compile(rb"(?!)"))
    assert [read(*one) for one in files] == together
    refused = sum(answer.startswith("some.txt: line") for answer in together)
    assert 50 < refused < 250
