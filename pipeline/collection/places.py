"""A place that names a room and what a thing stands in there, "Gallery 1, case 3", and where the one ends."""

import re
from functools import cache

from pipeline.records import Furniture
from pipeline.tables.held_rows import words_for
from pipeline.tables.rows import any_of

_SEPARATOR = re.compile(r"\s*[,;/>|]\s*|:\s+|\s+[-–—]\s+")
_SIGN = r"(?:[a-z]?\d[\w.-]{0,5}|[a-z]|[ivx]{1,4})"
"""What tells one case from the next: 3, 12b, A, IV."""
_NUMBERED = ("case", "cases", "Schrank", "kast")
"""Words that name furniture only where a number follows."""


def parted(place: str) -> tuple[str, str]:
    """Return the room of a place, and the case, plinth or shelf that it names besides; "" where it names none.

    Parameters
    ----------
    place : str
        As the museum writes it.

    Returns
    -------
    (str, str)
        A place that names a case and no room is both: "Vitrine 3".
    """
    ends = [found.span() for found in _SEPARATOR.finditer(place)]
    spans = list(zip((0, *(end for _, end in ends)), (*(start for start, _ in ends), len(place)), strict=True))
    whole, numbered, inside = _patterns()
    named = [bool(whole.match(place[start:end])) for start, end in spans]
    if not any(named):
        found = inside.search(place)
        room = place[: found.start()].rstrip() if found else ""
        return (room, place[len(room) :].strip()) if room else (place, "")
    first = named.index(True)
    if first:
        return place[: spans[first - 1][1]], place[spans[first][0] :]
    room_at = named.index(False) if not all(named) else 0
    if room_at:
        # "Case 3, Gallery 1": the other way round.
        return place[spans[room_at][0] :], place[: spans[room_at - 1][1]]
    return (place, place) if len(spans) > 1 or numbered.match(place) else (place, "")


@cache
def _patterns() -> tuple[re.Pattern[str], re.Pattern[str], re.Pattern[str]]:
    """Return what is wholly a case, what is so with its number, and where one with a number begins."""
    kinds = (Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF)
    plain = [word for kind in kinds for word in words_for(kind) if "*" not in word]
    word, numbered = f"(?:{any_of(plain).pattern})", f"(?:{any_of([*plain, *_NUMBERED]).pattern})"
    counted = rf"{numbered}\s*(?:no\.?|nr\.?|n[.°º]|#|№)?\s*{_SIGN}"
    before = r"\s*(?:[^\W\d_]+[\s-]+){0,2}"
    return (
        re.compile(rf"{before}(?:{counted}|{word}|case)\s*$", re.IGNORECASE),
        re.compile(rf"{before}{counted}\s*$", re.IGNORECASE),
        re.compile(rf"{counted}(?!\w).*$", re.IGNORECASE | re.DOTALL),
    )
