"""The objects of a collection in as much as they are sorted and told apart by, in columns of Arrow."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, overload

import numpy as np


class Listed(NamedTuple):
    """An object in as much as the objects of a collection are sorted and told apart by.

    Attributes
    ----------
    object_number, gallery, case, on_display
        Fields of its record.
    digest : str
        `record.digest_of` its record.
    assessment_digest : str
        `record.assessment_digest_of` its record.
    """

    object_number: str
    gallery: str
    case: str
    on_display: bool
    digest: str
    assessment_digest: str


class Run(NamedTuple):
    """The objects of one gallery that are on display, or that are not, as they lie in a listing."""

    on_display: bool
    gallery: str
    start: int
    end: int


def order(one: Listed) -> tuple[bool, str, str, str]:
    """Return what objects are sorted by: those on display first, by gallery, case and object number."""
    return not one.on_display, one.gallery, one.case, one.object_number


@dataclass(frozen=True, eq=False)
class Listing(Sequence[Listed]):
    """Objects in columns.

    Attributes
    ----------
    table : Any
        pyarrow.Table with the columns of `Listed`.
    """

    table: Any

    @classmethod
    def of(cls, objects: Iterable[Sequence[Any]]) -> Listing:
        """Return some objects, in their order."""
        import pyarrow as pa

        columns = list(zip(*objects, strict=True)) or [()] * len(Listed._fields)
        return cls(pa.table([pa.array(list(c), t) for c, t in zip(columns, _schema().types, strict=True)], _schema()))

    @classmethod
    def joining(cls, parts: Iterable[Listing]) -> Listing:
        """Return the objects of some listings, one behind the other."""
        import pyarrow as pa

        tables = [part.table for part in parts]
        return cls(pa.concat_tables(tables)) if tables else cls.of([])

    def sorted(self) -> Listing:
        """Return the objects as `order` sorts them: Arrow compares texts as UTF-8, which is by code points as well."""
        import pyarrow.compute as pc

        keys = [("on_display", "descending"), *((name, "ascending") for name in ("gallery", "case", "object_number"))]
        table = self.table.set_column(3, "on_display", pc.cast(self.table.column("on_display"), "int8"))
        return Listing(self.table.take(pc.sort_indices(table, sort_keys=keys)).combine_chunks())

    def by(self, key: Callable[[str], str]) -> Listing:
        """Return the objects as a key of their numbers sorts them."""
        numbers = self.column("object_number")
        return Listing(self.table.take(sorted(range(len(numbers)), key=lambda at: (key(numbers[at]), numbers[at]))))

    def __len__(self) -> int:
        """How many objects."""
        return int(self.table.num_rows)

    @overload
    def __getitem__(self, at: int) -> Listed: ...
    @overload
    def __getitem__(self, at: slice) -> Listing: ...

    def __getitem__(self, at: int | slice) -> Listed | Listing:
        """Return one object, or some of them as a listing."""
        if isinstance(at, slice):
            start, stop, step = at.indices(len(self))
            if step == 1:
                return Listing(self.table.slice(start, max(0, stop - start)))
            return Listing(self.table.take(list(range(start, stop, step))))
        if not -len(self) <= at < len(self):
            raise IndexError(at)
        return Listed(*(column[at % len(self)].as_py() for column in self.table.columns))

    def __iter__(self) -> Iterator[Listed]:
        """Yield the objects."""
        return map(Listed, *(column.to_pylist() for column in self.table.columns))

    def column(self, name: str) -> list[Any]:
        """Return one field of all objects."""
        values: list[Any] = self.table.column(name).to_pylist()
        return values

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """The galleries of objects that are sorted, in their order."""
        if not len(self):
            return ()
        shown = self._array("on_display").to_numpy(zero_copy_only=False)
        starts = np.flatnonzero(_differs(self._array("gallery")) | np.diff(shown, prepend=not shown[0]))
        ends = [*starts[1:].tolist(), len(self)]
        galleries = self._array("gallery").take(starts).to_pylist()
        return tuple(
            Run(bool(shown[start]), gallery, start, end)
            for gallery, start, end in zip(galleries, starts.tolist(), ends, strict=True)
        )

    @property
    def galleries(self) -> set[str]:
        """The galleries that there are."""
        return {run.gallery for run in self.runs}

    @property
    def shown(self) -> int:
        """How many objects are on display."""
        return sum(run.end - run.start for run in self.runs if run.on_display)

    def companies(self) -> Any:
        """Return where those begin that stay together, (n,) ints: those of a case, and each other object by itself."""
        alone = np.asarray(_equal(self._array("case"), ""))
        return np.flatnonzero(alone | _differs(self._array("case")) | _differs(self._array("gallery")))

    def places(self, numbers: Collection[str]) -> dict[str, int]:
        """Return where objects are, by number; what is not there is left out."""
        import pyarrow as pa
        import pyarrow.compute as pc

        if not numbers:
            return {}
        column = self._array("object_number")
        found = pc.is_in(column, pa.array(sorted(numbers), column.type))
        at = np.flatnonzero(found.to_numpy(zero_copy_only=False))
        return dict(zip(column.take(at).to_pylist(), at.tolist(), strict=True))

    def digest(self) -> bytes:
        """Return what stands for the numbers and the records of all objects, in their order."""
        found = hashlib.sha256()
        for name in ("object_number", "digest"):
            text, ends = _bytes(self._array(name))
            found.update(ends)
            found.update(text)
        return found.digest()

    def joined(self, runs: Iterable[Run]) -> Listing:
        """Return the objects of some runs, one behind the other."""
        parts = [self[run.start : run.end] for run in runs]
        return Listing(Listing.joining(parts).table.combine_chunks())

    def _array(self, name: str) -> Any:
        # Of one piece, so that places in it are places in the listing.
        return self.table.column(name).combine_chunks()


def _schema() -> Any:
    import pyarrow as pa

    text = pa.large_string()
    return pa.schema([(name, pa.bool_() if name == "on_display" else text) for name in Listed._fields])


def _equal(column: Any, value: object) -> Any:
    import pyarrow.compute as pc

    return pc.equal(column, value).to_numpy(zero_copy_only=False)


def _differs(column: Any) -> Any:
    """Return where the entry is another than the one before, (n,) flags; the first one is."""
    import pyarrow.compute as pc

    out = np.ones(len(column), bool)
    out[1:] = pc.not_equal(column.slice(1), column.slice(0, len(column) - 1)).to_numpy(zero_copy_only=False)
    return out


def _bytes(column: Any) -> tuple[memoryview, bytes]:
    """Return the text of a column of texts, one behind the other, and where each of them ends."""
    _, where, text = column.buffers()
    places = np.frombuffer(where, np.int64, len(column) + 1, 8 * column.offset)
    return memoryview(text or b"")[places[0] : places[-1]], (places[1:] - places[0]).tobytes()
