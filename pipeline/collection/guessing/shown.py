"""Which columns say what is on display, how, and what is in the museum no more."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import tomlkit

from pipeline.collection.display_words import flag_of, says_away
from pipeline.collection.guessing.columns import Column, internal, untaken
from pipeline.collection.guessing.fields import ASKED, MOST_WORDS, tells_display
from pipeline.collection.guessing.names import called, named, path_of, plain
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.remarks import remarks_of_holding
from pipeline.collection.places import SIDES_OF_ROOMS, case_in, parted
from pipeline.collection.record import CHOICES
from pipeline.tables.held_rows import HeldAs, stands_or_hangs, told_by

_REMOVED = frozenset(
    {
        *("disposal", "disposed", "deaccession", "deaccessioned", "deaccessioning", "aussonderung", "abgang"),
        *("radiation", "baja", "dismissione", "alienazione", "afstoting", "utrangering", "abate"),
    }
)
"""Words of a column that tells how an object left the museum."""
_MAY_TELL = ("support", "displayed", "medium", "case", "gallery")
"""Fields whose columns may hold how objects are held: "Tipo de suporte" is what a picture is on, or a plinth."""
_WAYS = 0.5
"""Share of its texts from which a column of another name is one of how objects are held (judgement)."""
_SOME_WAYS, _SPOTS = 0.2, 1.5
"""The same of one that names spots within rooms, and how many spots there are at least for a room (judgement)."""
_MOST_AWAY = 0.3
"""Share of its texts that may name stores (judgement)."""
_FEWEST = 2
"""Different ways that one tells at least: a single "montiert" says how a thing was made."""
_FEW = 0.5
"""Share of the objects that may have left it (judgement)."""


def removed(columns: Sequence[Column], found: Mapping[str, Column], told: GuessNotes) -> tomlkit.items.Table | None:
    """Return the flag by which what left the museum is not on display, where no other one tells; say so.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : mapping of str to Column
        Field -> its column.
    told : GuessNotes
        What is said of it; grows.
    """
    able = [
        one
        for one in columns
        if 0 < len(one.filled) <= _FEW * len(one.values)
        and any(_REMOVED.intersection(plain(word).split()) for word in path_of(one.name))
    ]
    column = min(able, key=lambda one: (-len(one.filled), len(one.distinct)), default=None)
    if column is None:
        return None
    said = f"{len(column.filled)} objects have a text in {column.name!r}, such as {column.filled[0][:80]!r}"
    if "on_display" in {*found, *told.choices} or len(column.distinct) > MOST_WORDS:
        told.doubts.append(f"{said}: see whether they are still there, and leave out those that are not")
        return None
    entry = tomlkit.table()
    entry["column"] = column.name
    entry["values"] = values = tomlkit.inline_table()
    for text in {text.casefold(): text for text in column.distinct}.values():
        values[text] = False
    told.doubts.append(
        f"{said}: these are taken to be there no more, and not on display; --choose on_display=- leaves that"
    )
    return entry


def words_of_display(columns: Sequence[Column], found: dict[str, Column], told: GuessNotes) -> None:
    """Take a column for how objects are displayed only where it holds words of that; whatever it is called.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : dict of str to Column
        Field -> its column; one of mounts becomes that of how objects are displayed, where it tells that.
    told : GuessNotes
        What is said of it; grows.
    """
    column = found.get("displayed")
    if column is not None and "displayed" not in told.choices and not tells_display(column):
        del found["displayed"]
        if "on_display" not in {*found, *told.choices} and any(
            flag_of(t, display=True) is not None for t in column.filled
        ):
            # "Displayed?" is answered by yes and no.
            found["on_display"] = column
    flag = found.get("on_display")
    if flag is not None and "on_display" not in told.choices and _holds_ways(flag):
        # "Posizione" is nearly "esposizione", and says where in a room a thing is.
        del found["on_display"]
        found.setdefault("displayed", flag)
    mounts = found.get("support")
    if "displayed" not in found and mounts is not None and "support" not in told.choices and tells_display(mounts):
        found["displayed"] = found.pop("support")
        told.doubts.append(f"column {mounts.name!r} is taken to say in words how objects are displayed or held")
    medium = found.get("medium")
    if "displayed" not in found and medium is not None and "medium" not in told.choices and _holds_ways(medium):
        # "Suporte" is what a picture is painted on, and "suporte expositivo" what a thing stands in.
        found["displayed"] = found.pop("medium")
        told.doubts.append(f"column {medium.name!r} is taken to say in words how objects are displayed or held")
    hanging = found.get("hanging")
    if hanging is not None and not {"displayed", "hanging"} & {*found.keys() - {"hanging"}, *told.choices}:
        vocabulary = {one.value for one in CHOICES["hanging"]}
        if _holds_ways(hanging) and any(text.casefold() not in vocabulary for text in hanging.distinct):
            # "2 D-rings, wire", and of another object "bolted to plinth": words that tell more than how things hang.
            found["displayed"] = found.pop("hanging")
            told.doubts.append(f"column {hanging.name!r} is taken to say in words how objects are displayed or held")
    if not {"displayed", "support"} & {*found, *told.choices}:
        _cases_and_spots(found, told)
    if not {"displayed", "support"} & {*found, *told.choices}:
        _by_what_it_holds(columns, found, told)


def room_and_position(able: Sequence[Column], found: dict[str, Column], told: GuessNotes) -> None:
    """Take the room for the place where another column tells where in it a thing is: "Salon", and "on the mantel".

    Parameters
    ----------
    able : sequence of Column
        That may name places.
    found : dict of str to Column
        Field -> its column; that of the gallery may become how objects are displayed.
    told : GuessNotes
        What is said of it; grows.
    """
    where = found.get("gallery")
    if where is None or {"gallery", "displayed"} & {*found.keys() - {"gallery"}, *told.choices}:
        return
    rooms = [one for one in able if one is not where and one.filled and not (_of_stores(one) or internal(one))]
    room = next((one for one in rooms if not _holds_ways(one)), None)
    if room is None or not (_holds_ways(where) or _within(where, room)):
        return
    found["gallery"], found["displayed"] = room, where
    told.doubts.append(f"column {room.name!r} is taken for the room, and {where.name!r} for where in it a thing is")
    told.questions[:] = [one for one in told.questions if one.key != "gallery"]
    _ask_no_more(where, told)


def _ask_no_more(taken: Column, told: GuessNotes) -> None:
    """Leave a column that is taken out of what may be chosen for another field."""
    told.questions[:] = filter(None, (one.without(taken.name) for one in told.questions))


def _cases_and_spots(found: dict[str, Column], told: GuessNotes) -> None:
    """Take a column of cases for where in a room things are, where some of it says that: "on platform", "hung"."""
    cases = found.get("case")
    if cases is None or "case" in told.choices or cases is found.get("gallery"):
        return
    spots = sum(not case_in(text) and stands_or_hangs(text) for text in cases.distinct)
    if spots >= max(_FEWEST, _SOME_WAYS * len(cases.distinct)):
        found["displayed"] = found.pop("case")
        told.doubts.append(f"column {cases.name!r} is taken to say in which case things are, and how they are held")


def _by_what_it_holds(columns: Sequence[Column], found: dict[str, Column], told: GuessNotes) -> None:
    column = _free_to_tell(columns, found)
    if column is None and (remarks := remarks_of_holding(_free(columns, found), told)) is not None:
        found["displayed"] = remarks
        told.doubts.append(f"column {remarks.name!r} is taken to say of some objects how they are fixed")
    if column is not None:
        apart = sum(parted(text).room != text for text in column.distinct)
        if not {"gallery"} & {*found, *told.choices} and 2 * apart >= len(column.distinct):
            # "Torre, colgada de viga": the place, and how a thing is held there.
            found["gallery"] = column
            told.doubts.append(
                f"column {column.name!r} is taken to tell where objects are, and how they are held there"
            )
            return
        found["displayed"] = column
        told.doubts.append(
            f"column {column.name!r} is taken to say how objects are displayed or held, by what it holds"
        )
        _ask_no_more(column, told)


def ways_beside(columns: Sequence[Column], found: Mapping[str, Column], told: GuessNotes) -> tuple[Column, ...]:
    """Return the column of how objects are displayed and one of remarks that says it too: "bolted to platform".

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : mapping of str to Column
        Field -> its column.
    told : GuessNotes
        What is said of it; grows.

    Returns
    -------
    tuple of Column
        Both; () where no other column says it.
    """
    first = found.get("displayed")
    second = None if first is None or "displayed" in told.choices else _free_to_tell(columns, found)
    if first is not None and second is None and "displayed" not in told.choices:
        # "Sala" beside "Ubicación" with "Vitrina 6" and "Jardín": where in the room a thing is.
        able = (one for one in untaken(columns, found.values()) if called(one.name, "gallery") and not internal(one))
        second = next((one for one in able if not _of_stores(one) and _tells_ways(one, _SOME_WAYS)), None)
    if first is not None and second is None and "displayed" not in told.choices:
        second = remarks_of_holding(_free(columns, found), told)
    if first is None or second is None:
        return ()
    told.doubts.append(f"column {second.name!r} is taken to say more of how objects are held, by what it holds")
    _ask_no_more(second, told)
    return first, second


def _free_to_tell(columns: Sequence[Column], found: Mapping[str, Column]) -> Column | None:
    """Return the column that no field takes, most of whose texts tell how things are held."""
    able = (one for one in _free(columns, found) if not one.prose)
    return max(filter(_holds_ways, able), key=lambda one: len(one.filled), default=None)


def _free(columns: Sequence[Column], found: Mapping[str, Column]) -> list[Column]:
    """Return the columns that no field takes, and whose names say nothing of what else they may be."""
    free = [one for one in untaken(columns, found.values()) if one.filled]
    able = [one for one in free if (what := named(one.name)) is None or (what.field in _MAY_TELL and not what.internal)]
    # Where a thing is kept while it is not on display tells nothing of how it is shown.
    return [one for one in able if not _of_stores(one)]


def _of_stores(column: Column) -> bool:
    """Whether a column tells where things are kept that are not on display, by its name or by many of its texts."""
    some = column.distinct[:ASKED]
    return says_away(column.name) or sum(map(says_away, some)) > _MOST_AWAY * len(some)


def _within(where: Column, room: Column) -> bool:
    """Whether one column names several spots in each room of the other, some of them in words that are known."""
    spots = len(where.distinct) >= _SPOTS * len(room.distinct) and len(room.distinct) < len(room.filled)
    return spots and _tells_ways(where, _SOME_WAYS)


def _holds_ways(column: Column) -> bool:
    return tells_display(column) and _tells_ways(column, _WAYS)


def _tells_ways(column: Column, share: float) -> bool:
    """Whether so many of a column's different texts, and `_FEWEST` at least, tell how a thing is held."""
    # "N", "CENTER" and "CEILING": a side of the room or its middle tells nothing, and speaks against nothing.
    some = [text for text in column.distinct[:ASKED] if text.casefold() not in SIDES_OF_ROOMS]
    ways = sum(told_by(text) != HeldAs() or bool(case_in(text)) for text in some)
    return ways >= max(_FEWEST, share * len(some))


def place_of_shown(found: dict[str, Column], told: GuessNotes) -> None:
    """Take a column called "on view" for the place, where it names a gallery for what is on view, and else nothing."""
    shown = found.get("on_display")
    if shown is None or not shown.filled:
        return
    known = [flag_of(text, display=True) for text in shown.distinct]
    # "Ausstellung" with the names of exhibitions, which several things share, and no word of a flag among them.
    exhibitions = set(known) == {None} and _FEWEST < len(known) < len(shown.filled) and not shown.prose
    gaps = len(shown.filled) < len(shown.values) or False in known
    if known.count(None) > 0.5 * len(known) and (gaps or exhibitions):
        found["gallery"] = found.pop("on_display")
        told.doubts.append(
            f"column {shown.name!r} is taken to name the place of what is on display, such as "
            f"{shown.filled[0][:80]!r}; what has none is not on display"
        )
