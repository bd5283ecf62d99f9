"""Reports from the galleries as people write them: a CSV file or a workbook, in any language of the pages."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unicodedata import combining, normalize

from pipeline.collection.errors import CollectionError
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.sources.delimited import read_delimited
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xlsx import first_rows, read_sheet
from pipeline.errors import InputError
from pipeline.tables import table

STATES = ("standing", "moved", "fallen", "broken")
"""What may be found."""

FARTHEST = 100.0
"""Metres that an object may have moved, at most: what is more was written in another unit."""

NOTE_LIMIT, WHO_LIMIT = 2000, 200
"""Characters of a note and of a name, at most."""

_TOLD = 5
"""Rows that are named of a file of which more cannot be used."""

_LENGTH = r"\d[\d.,/⁄ ½⅓⅔¼¾⅛⅜⅝⅞]*"
_FIRST = re.compile(rf"^({_LENGTH}\s*(?:mm|cm|m|in|ft|センチ|ミリ|メートル|[\"'])\.?)\s*(\D.*)$")
_MARKS = " \t:;,.-–()[]（）、。：（）"
_UNITS = (
    ("センチ", "cm"), ("ミリ", "mm"), ("メートル", "m"), ("εκατοστά", "cm"), ("εκ", "cm"), ("χιλιοστά", "mm"),
    ("χιλ", "mm"),
)  # fmt: skip
"""Words for units that the texts of dimensions do not have."""


@dataclass(frozen=True, slots=True)
class FoundObject:
    """What somebody found of an object.

    Attributes
    ----------
    state : str
        One of `STATES`.
    moved_m : float or None
        How far it has moved, m; None where nobody says.
    note, who : str
        More words, and whose; "" where there are none.
    """

    state: str
    moved_m: float | None = None
    note: str = ""
    who: str = ""


def state_said(text: str) -> tuple[str, float | None]:
    """Return the state that words tell, and how far it has moved, m.

    Parameters
    ----------
    text : str
        Such as "Fallen", "moved 2 cm", "spostato di 3 mm" or "2cm移動".

    Raises
    ------
    InputError
        For words that are not known, and for a distance that cannot be.
    """
    plain = " ".join(normalize("NFKC", text).split())
    turned = _FIRST.match(plain)
    if turned is not None:
        plain = f"{turned[2]} {turned[1]}"
    number = re.search(r"[\d½⅓⅔¼¾⅛⅜⅝⅞]", plain)
    head, tail = (plain, "") if number is None else (plain[: number.start()], plain[number.start() :])
    word = _folded(head)
    state = _words("state").get(word)
    if state is None and tail:
        # "Moved about 2 cm", "spostato di 2 cm": what stands between is of the number.
        first, _, between = word.rpartition(" ")
        state = _words("state").get(first)
        tail = tail if between in ("by", "di", "de", "κατά", _folded("κατά")) else f"{between} {tail}"
    if state is None:
        raise InputError(
            f"state {text[:40]!r} is not known; use one of {', '.join(STATES)}, and a column note for more"
        )
    if not tail:
        return state, None
    if state != "moved":
        raise InputError(f"state {text[:40]!r}: a distance goes with moved; write other numbers into a column note")
    return state, distance_said(tail)


def distance_said(text: str, unit: str = "") -> float:
    """Return how far something has moved, m.

    Parameters
    ----------
    text : str
        With its unit.
    unit : str
        That of a number which names none; "" where it has to.

    Raises
    ------
    InputError
        For what is no distance.
    """
    plain = normalize("NFKC", text).strip(_MARKS)
    for theirs, ours in _UNITS:
        plain = plain.replace(theirs, ours)
    try:
        cell = of_hand(plain, unit or "m")
    except InputError as problem:
        raise InputError(f"distance {problem}: write it such as 2 cm") from None
    if not (cell.named or unit):
        raise InputError(f"distance {text[:40]!r} has no unit: write it such as 2 cm")
    if cell.value > FARTHEST:
        raise InputError(f"distance {text[:40]!r} is more than {FARTHEST:g} m: write it such as 2 cm")
    return cell.value


def read_found(file: Path, known: Collection[str]) -> dict[str, FoundObject]:
    """Read reports from the galleries.

    Parameters
    ----------
    file : Path
        A workbook (.xlsx), or a CSV file in UTF-8 with commas, semicolons or tabs.  Columns: object and state; moved,
        note and who where somebody has them.  Rows without a state are of objects at which nobody looked.
    known : collection of str
        Numbers of the objects on display.

    Returns
    -------
    dict of str to FoundObject
        By object number; of two rows of one object the later holds.

    Raises
    ------
    InputError
        For a file that cannot be read, and for rows that cannot be used: nothing of it counts then.
    """
    found: dict[str, FoundObject] = {}
    wrong: list[str] = []
    try:
        with _rows(file) as rows:
            header = next(rows, None)
            places = _places(file, [] if header is None else header.cells)
            for row in rows:
                try:
                    one = _found(row, places, known)
                except InputError as problem:
                    wrong.append(f"{file}, row {row.line}: {problem}")
                    continue
                if one is not None:
                    found[one[0]] = one[1]
    except (OSError, CollectionError) as problem:
        raise InputError(f"{file}: cannot be read ({problem}); give a CSV file in UTF-8 or a workbook") from problem
    if wrong:
        more = f"\nand {len(wrong) - _TOLD} more rows" if len(wrong) > _TOLD else ""
        raise InputError("\n".join(wrong[:_TOLD]) + more)
    return found


@contextmanager
def _rows(file: Path) -> Iterator[Iterator[Row]]:
    with file.open("rb") as stream:
        begin = stream.read(4096)
        if begin.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
            # Numbers of objects are texts, whatever a spreadsheet makes of them: 1913.20 is not 1913.2.
            heads = first_rows(file, None, 1)
            yield read_sheet(file, file.name, texts=heads[0] if heads else ())
            return
        stream.seek(0)
        first = begin.partition(b"\n")[0]
        delimiter = max((",", ";", "\t"), key=lambda one: first.count(one.encode()))
        yield read_delimited(stream, file.name, delimiter, "utf-8")


def _places(file: Path, names: Sequence[str]) -> dict[str, int]:
    """Return the place of each column by what it holds."""
    places: dict[str, int] = {}
    for at, name in enumerate(names):
        meaning = _words("column").get(_folded(name))
        if meaning in places:
            raise InputError(f"{file}: two columns hold the {meaning} of objects; leave one of them")
        if meaning is not None:
            places[meaning] = at
    if not {"object", "state"} <= set(places):
        raise InputError(f"{file}, row 1: give the columns object and state")
    return places


def _found(row: Row, places: Mapping[str, int], known: Collection[str]) -> tuple[str, FoundObject] | None:
    """Return the object of a row and what was found; None where nobody looked."""
    fault = row.fault if row.fault[0] else next((row.faults[at] for at in places.values() if at in row.faults), None)
    if fault:
        raise InputError("; ".join(fault))
    cells = {name: row.cells[at].strip() for name, at in places.items()}
    more = {name: cells.get(name, "") for name in ("moved", "note", "who")}
    if not cells["state"]:
        if more["moved"]:
            raise InputError(f"a distance without a state; write one of {', '.join(STATES)}")
        return None
    if cells["object"] not in known:
        raise InputError(f"object {cells['object'][:60]!r} is not on display in the newest run; correct it")
    state, moved = state_said(cells["state"])
    if more["moved"]:
        if state != "moved":
            raise InputError("a distance goes with moved; leave it out, or write it into a column note")
        moved = distance_said(more["moved"])
    for name, most in (("note", NOTE_LIMIT), ("who", WHO_LIMIT)):
        if len(more[name]) > most:
            raise InputError(f"{name} has more than {most} characters; say it shorter")
    return cells["object"], FoundObject(state, moved, more["note"], more["who"])


@cache
def _words(kind: str) -> Mapping[str, str]:
    rows = (row for row in table("found_words") if row["kind"] == kind)
    return {_folded(word): row["meaning"] for row in rows for word in row["words"].split("|")}


def _folded(text: str) -> str:
    """Return words without case, accents and marks around them."""
    parted = normalize("NFKD", normalize("NFKC", text).casefold())
    return " ".join("".join(c for c in parted if not combining(c)).replace("_", " ").strip(_MARKS).split())
