"""Joins of a museum's database: its table of objects, its rows of dimensions, and where an object is now."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, cast

from pipeline.collection.guessing.columns import NUMBER, Column, candidates, columns_of
from pipeline.collection.guessing.likeness import of_table, same_stem
from pipeline.collection.guessing.long_rows import VALUES
from pipeline.collection.guessing.names import CALLED, named, plain
from pipeline.collection.sources.address import expand_secrets
from pipeline.collection.sources.measurement_terms import kind_of, part_of, unit_of
from pipeline.collection.sources.schema import DatabaseTable
from pipeline.collection.sources.sql import read_database

if TYPE_CHECKING:
    from sqlalchemy import TableClause

SAMPLED = 300
"""Rows of a table from which it is told what it holds."""

TMS_OBJECTS = 108
"""Number of the table of objects where TMS has rows for things of several tables."""
_OBJECTS = frozenset(
    {
        *("object", "objects", "objekt", "objekte", "artwork", "artworks", "work", "works", "item", "items"),
        *("oeuvre", "oeuvres", "objet", "objets", "opera", "opere", "oggetti", "objeto", "objetos", "obra", "obras"),
        *("objecten", "obiecte", "tblobjects", "museumobjects", "catalogue", "catalog", "inventar", "inventory"),
        *("collection", "collectionobject", "collectionobjects"),
    }
)
_CURRENT = frozenset(
    {
        "current",
        "curent",
        "actual",
        "actuel",
        "actuelle",
        "attuale",
        "atual",
        "aktuell",
        "aktueller",
        "huidig",
        "huidige",
        "present",
    }
)
_USUAL = frozenset({"home", "normal", "usual", "permanent", "default"})
_FLAGS = frozenset(f"is {word}" for word in _CURRENT) | _CURRENT | {"active", "iscurrent", "current location"}
_NAMES = (*CALLED, "bezeichnung", "label", "description", "term", "title", "code")
_SIZES = frozenset({"height_m", "width_m", "depth_m", "diameter_m", "length_m", "mass_kg", "dimensions"})
_PLACES = (
    "loc",
    "locuri",
    "place",
    "places",
    "spot",
    "position",
    "standplaats",
    "lieu",
    "luogo",
    "lugar",
    "yer",
    "miejsce",
)
"""Names of tables of places that are no names of a column of places: a "place" of an object is where it is from."""

_ENDS = frozenset(
    {
        *("date to", "to date", "end date", "enddate", "date end", "until", "removed", "date out", "dateout"),
        *("bis", "au", "al", "tot", "pana la"),
    }
)


@dataclass(frozen=True)
class Joined:
    """A SELECT over several tables.

    Attributes
    ----------
    query : str
        In the database's own dialect.
    said : tuple of str
        What is joined, and what was settled by choice.
    """

    query: str
    said: tuple[str, ...]


def object_tables(tables: Sequence[DatabaseTable]) -> list[DatabaseTable]:
    """Return the tables that may hold the objects, the likeliest first: those that name object numbers, or else sizes.

    Parameters
    ----------
    tables : sequence of DatabaseTable
        Of the database.

    Returns
    -------
    list of DatabaseTable
        Empty where none names either.
    """

    def likeness(table: DatabaseTable) -> tuple[bool, bool, int, int]:
        found = _named(table)
        number = found.get("object_number")
        own = number is not None and not _is_internal(number)
        called = plain(table.name).replace(" ", "")
        return own, called in _OBJECTS, len(found), sum(_refers(other, table) is not None for other in tables)

    able = [table for table in tables if "object_number" in _named(table)]
    own = [table for table in able if not _is_internal(_named(table)["object_number"])]
    sized = [table for table in tables if len(_SIZES & set(_named(table))) > 1]
    return sorted(own or able or sized, key=likeness, reverse=True)


def joined(url: str, tables: Sequence[DatabaseTable], objects: DatabaseTable) -> Joined | None:
    """Return the SELECT that joins dimensions, places and words to the objects; None where there is nothing to join.

    Parameters
    ----------
    url : str
        Of the database, which is only read.
    tables : sequence of DatabaseTable
        All of it.
    objects : DatabaseTable
        The table of objects.

    Returns
    -------
    Joined or None

    Raises
    ------
    CollectionError
        As `sql.read_database`.
    """
    return _Joiner(url, tables, objects).joined()


def _named(table: DatabaseTable) -> dict[str, str]:
    """Field -> column, as the names alone tell."""
    able = [Column(c) for c in table.columns if plain(c).split()[-1:] != ["id"] or _is_internal(c)]
    return {name: found[0].name for name, found in candidates(able).items()}


def _is_internal(column: str) -> bool:
    what = named(column)
    return what is not None and what.internal


def _refers(table: DatabaseTable, other: DatabaseTable) -> tuple[str, str] | None:
    """Return the columns by which a table refers to another: as declared or as named; a current one first."""
    found = list(_references(table, other))

    def rank(way: tuple[str, str]) -> tuple[bool, bool]:
        words = set(plain(way[0]).split())
        return not words & _CURRENT, bool(words & _USUAL)

    return min(found, key=rank) if found else None


def _references(table: DatabaseTable, other: DatabaseTable) -> Iterator[tuple[str, str]]:
    if table is other:
        return
    for column, (name, there) in table.refers.items():
        if name in (other.shown, other.name):
            yield column, there
    if len(other.key) == 1:
        key = other.key[0]
        for column in table.columns:
            if (column,) == table.key or column in table.refers:
                continue
            # In a Darwin Core archive the rows of an extension have the number of their record so.
            if key.casefold() == "id" and column.casefold() in ("id", "coreid"):
                yield column, key
                continue
            words = plain(column).split()
            ends = plain(key).split()
            if words[-len(ends) :] == ends and ends != ["id"]:  # PrimaryUnitID -> UnitID
                yield column, key
                continue
            ended = words[-1:] == ["id"] or (len(words) == 1 and words[0].endswith("id"))
            if ended:
                stem = words[:-1] if words[-1] == "id" else [words[0][:-2]]
                if stem and (same_stem("".join(stem), other.name) or same_stem(stem[-1], other.name)):
                    yield column, key
    if table.shown.casefold().endswith("dimitemelemxrefs") and plain(other.name) in _OBJECTS and len(other.key) == 1:
        yield from ((column, other.key[0]) for column in table.columns if column.casefold() == "id")
    # Without keys: a column of the same name that is the other's number.
    number = _named(other).get("object_number")
    if number is not None and number in table.columns and not _is_internal(number):
        yield number, number


class _Joiner:
    def __init__(self, url: str, tables: Sequence[DatabaseTable], objects: DatabaseTable) -> None:
        self._url = url
        self._tables = tables
        self._objects = objects
        self._rows: dict[str, list[Column]] = {}
        self._clauses: dict[str, TableClause] = {}
        self._said: list[str] = []
        self._selected: list[Any] = []
        self._labels: set[str] = set()

    def joined(self) -> Joined | None:
        from sqlalchemy import create_mock_engine, select

        self._from: Any = self._clause(self._objects)
        for column in self._objects.columns:
            # What no name tells, contents may; a number of another table tells nothing.
            if column in self._objects.key or not self._is_reference(self._objects, column):
                self._select(self._objects, column, column)
        fields = _named(self._objects)
        if "gallery" not in fields:
            self._place()
        for field, label in (
            ("title", "title"),
            ("object_name", "object_name"),
            ("classification", "classification"),
            ("medium", "medium"),
        ):
            if field not in fields:
                self._word(field, label)
        if not {"height_m", "dimensions"} <= set(fields):
            self._measurements()
        if not self._said:
            return None
        order = self._clause(self._objects).c[fields.get("object_number", self._objects.columns[0])]
        statement = select(*self._selected).select_from(self._from).order_by(order)
        dialect = create_mock_engine(expand_secrets(self._url).url, lambda *_: None).dialect
        query = str(statement.compile(dialect=dialect, compile_kwargs={"literal_binds": True}))
        lines = (
            query.replace(" LEFT OUTER JOIN ", "\nLEFT OUTER JOIN ").replace(" ORDER BY ", "\nORDER BY ").splitlines()
        )
        return Joined("\n".join(line.rstrip() for line in lines), tuple(self._said))

    # What tables hold

    def _columns(self, table: DatabaseTable) -> list[Column]:
        """Return the columns of a table with some of its rows."""
        if table.shown not in self._rows:
            rows = cast(Any, read_database(self._url, table=table.shown))
            with closing(rows):
                header = next(rows)
                self._rows[table.shown] = columns_of(header.cells, (row.cells for row in islice(rows, SAMPLED)))
        return self._rows[table.shown]

    def _others(self) -> Iterator[tuple[DatabaseTable, DatabaseTable | None]]:
        """Yield the tables that refer to the objects, each with the one between, if any."""
        near = [t for t in self._tables if _refers(t, self._objects) is not None]
        for table in near:
            yield table, None
        for table in self._tables:
            if table is not self._objects and table not in near:
                for between in near:
                    if _refers(table, between) is not None:
                        yield table, between
                        break

    def _told(
        self, table: DatabaseTable, tells: Callable[[str], object], share: float
    ) -> tuple[DatabaseTable, str, DatabaseTable | None] | None:
        """Return the table and column whose texts tell something: the table's own, or of one that it refers to."""
        for column in self._columns(table):
            if column.name not in table.key and _known(column, tells) >= share:
                return table, column.name, None
        for other in self._tables:
            if other is not self._objects and _refers(table, other) is not None:
                for column in self._columns(other):
                    texts = [text for text in column.distinct if not NUMBER.fullmatch(text)]
                    # A list of words has many that no object uses.
                    if texts and sum(tells(text) is not None for text in texts) >= max(1, 0.3 * len(texts)):
                        return other, column.name, table
        return None

    # What is joined

    def _measurements(self) -> None:
        for table, between in self._others():
            kind = self._told(table, kind_of, 0.6)
            if kind is None or kind[0] is between:
                continue
            keys = {*table.key, *(c for c in table.columns if self._is_reference(table, c))}
            numeric = [c for c in self._columns(table) if c.numeric and c.name not in keys]
            values = [c for c in numeric if plain(c.name) in VALUES] or numeric
            if not values:
                continue
            if between is not None:
                self._join(between, self._objects)
            self._join(table, between or self._objects)
            self._add(kind, "dimension_type")
            self._select(table, values[0].name, "dimension_value")
            unit = self._told(table, unit_of, 0.6)
            if unit is not None:
                self._add(unit, "dimension_unit")
            part = None
            for place in (table, between):
                if part is None and place is not None:
                    part = self._told(place, lambda text: part_of(text) if text else None, 0.3)
            if part is not None:
                self._add(part, "dimension_part")
            self._said.append(
                f"dimensions are the rows of {table.shown!r}: {kind[1]!r} says which, {values[0].name!r} how much"
                + (f", {unit[1]!r} in which unit" if unit else "; no column tells their unit")
            )
            return

    def _place(self) -> None:
        direct = self._place_of(self._objects)
        if direct is not None:
            self._take_place(self._objects, *direct)
            return
        for table, between in self._others():
            own = _best(table.columns, "gallery")
            there = self._place_of(table)
            if own is None and there is None:
                continue
            if between is not None:
                self._join(between, self._objects)
            flag = next((c for c in table.columns if plain(c) in _FLAGS and c not in table.refers), None)
            end = next((c for c in table.columns if plain(c) in _ENDS), None)
            self._join(table, between or self._objects, flag=flag, empty=end)
            if own is not None and there is None:
                self._select(table, own, "location")
                self._said.append(f"an object's place is {own!r} of {table.shown!r}")
            elif there is not None:
                self._take_place(table, *there)
            if flag is not None:
                self._said.append(f"of several places that one counts whose {flag!r} says yes")
            elif end is not None:
                self._said.append(f"of several places that one counts whose {end!r} is empty")
            else:
                self._said.append(f"{table.shown!r} tells no current place: of several the first counts")
            return

    def _place_of(self, table: DatabaseTable) -> tuple[DatabaseTable, str] | None:
        """Return the table of places that a table refers to, and its column of names."""
        found = []
        for other in self._tables:
            way = _refers(table, other)
            if way is None or other is self._objects:
                continue
            own = _best(other.columns, "gallery")
            if of_table(other.name, "gallery") or any(same_stem(name, other.name) for name in _PLACES):
                own = self._called(other) or own or self._name_of(other)
            if own is not None:
                words = set(plain(way[0]).split())
                found.append((not words & _CURRENT, bool(words & _USUAL), other, own))
        found.sort(key=lambda one: one[:2])
        return (found[0][2], found[0][3]) if found else None

    def _take_place(self, table: DatabaseTable, places: DatabaseTable, column: str) -> None:
        self._join(places, table)
        self._select(places, column, "location")
        for name in places.columns:
            if _field(name) in ("on_display", "case"):
                self._select(places, name, name)
        self._said.append(f"an object's place is {column!r} of {places.shown!r}, to which {table.shown!r} refers")

    def _word(self, field: str, label: str) -> None:
        """Join the table of words, or of titles, that tells a field."""
        for other in self._tables:
            number = _named(other).get("object_number")
            if other is self._objects or other.shown in self._clauses or (number and not _is_internal(number)):
                continue
            # The name of an artist or a donor is no title.
            column = next(
                (c for c in other.columns if _field(c) == field and c not in other.key and plain(c) not in CALLED), None
            )
            if column is None and of_table(other.name, field):
                column = self._name_of(other)
            if column is None or self._is_reference(other, column):
                continue
            if _refers(self._objects, other) is not None or (field == "title" and _refers(other, self._objects)):
                self._join(other, self._objects)
                self._select(other, column, label)
                self._said.append(f"{label} is {column!r} of {other.shown!r}")
                return

    @staticmethod
    def _called(table: DatabaseTable) -> str | None:
        """Return the column of a table that is called its name."""
        plains = {plain(c): c for c in table.columns if c not in table.key}
        ended = (column for name in _NAMES for found, column in plains.items() if found.split()[-1:] == [name])
        return next(ended, None)

    def _name_of(self, table: DatabaseTable) -> str | None:
        called = self._called(table)
        if called is not None:
            return called
        texts = [c for c in self._columns(table) if c.filled and not c.numeric and c.name not in table.key]
        return texts[0].name if texts else None

    def _is_reference(self, table: DatabaseTable, column: str) -> bool:
        return any((way := _refers(table, other)) is not None and way[0] == column for other in self._tables)

    # The statement

    def _clause(self, table: DatabaseTable) -> TableClause:
        from sqlalchemy import column, quoted_name
        from sqlalchemy import table as table_clause

        if table.shown not in self._clauses:
            self._clauses[table.shown] = table_clause(
                quoted_name(table.name, quote=True),
                *(column(quoted_name(name, quote=True)) for name in table.columns),
                schema=None if table.schema is None else quoted_name(table.schema, quote=True),
            )
        return self._clauses[table.shown]

    def _join(self, table: DatabaseTable, to: DatabaseTable, flag: str | None = None, empty: str | None = None) -> None:
        from sqlalchemy import and_, true

        if table.shown in self._clauses:
            return
        new, old = self._clause(table), self._clause(to)
        way = _refers(table, to)
        if way is not None and not (_refers(to, table) and not table.refers):
            condition = new.c[way[0]] == old.c[way[1]]
        else:
            back = _refers(to, table)
            if back is None:
                return
            condition = old.c[back[0]] == new.c[back[1]]
        conditions = [condition]
        of_all = next((name for name in table.columns if name.casefold() == "tableid"), None)
        if of_all is not None and way is not None and way[0].casefold() == "id":
            conditions.append(new.c[of_all] == TMS_OBJECTS)
        if flag is not None:
            said = next((c for c in self._columns(table) if c.name == flag), Column(flag)).distinct
            conditions.append(new.c[flag].is_(true()) if set(said) <= {"true", "false"} and said else new.c[flag] == 1)
        elif empty is not None:
            conditions.append(new.c[empty].is_(None))
        self._from = self._from.outerjoin(new, and_(*conditions))

    def _add(self, told: tuple[DatabaseTable, str, DatabaseTable | None], label: str) -> None:
        table, column, by = told
        if by is not None:
            self._join(table, by)
        self._select(table, column, label)

    def _select(self, table: DatabaseTable, column: str, label: str) -> None:
        from sqlalchemy import quoted_name

        if label not in self._labels:
            self._labels.add(label)
            self._selected.append(self._clause(table).c[column].label(quoted_name(label, quote=True)))


def _field(name: str) -> str | None:
    what = named(name)
    # The number of a place is not its name.
    return None if what is None or plain(name).split()[-1:] == ["id"] else what.field


def _best(columns: Sequence[str], field: str) -> str | None:
    """Return the column whose name says a field best: the whole string of a place before its site."""
    able = [(what.rank, name) for name in columns if _field(name) == field and (what := named(name)) is not None]
    return min(able)[1] if able else None


def _known(column: Column, tells: Callable[[str], object]) -> float:
    texts = [text for text in column.filled if not NUMBER.fullmatch(text)]
    return sum(tells(text) is not None for text in texts) / len(texts) if texts else 0.0
