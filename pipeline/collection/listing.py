"""The objects of a collection in as much as they are sorted by, in columns: half a million of them are had in no time.

They are kept in a file from night to night, so that a night asks the inventory only for those that changed since.
"""

from __future__ import annotations

import hashlib
import json
from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, overload

import numpy as np

from pipeline.resources import replacing


class Listed(NamedTuple):
    """An object in as much as the objects of a collection are sorted by.

    kind : see `inventory.ITEM`
    """

    object_number: str
    gallery: str
    case: str
    on_display: bool
    digest: str
    kind: int | None

    @property
    def assessment_digest(self) -> str:
        """Of the record, without what tells one object from others of its kind."""
        return self.digest if self.kind is None else f"{self.kind & (2**64 - 1):016x}"


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

    table : pyarrow.Table with the columns of `Listed`
    """

    table: Any

    @classmethod
    def of(cls, objects: Iterable[Listed]) -> Listing:
        """Return some objects, in their order."""
        import pyarrow as pa

        columns = list(zip(*objects, strict=True)) or [()] * len(Listed._fields)
        return cls(pa.table([pa.array(list(c), t) for c, t in zip(columns, _schema().types, strict=True)], _schema()))

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

    @property
    def complete(self) -> bool:
        """Whether the digest and the kind of every object are known."""
        return not (_equal(self._array("digest"), "").any() or self.table.column("kind").null_count)

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

    def changed(self, gone: Collection[str], new: Iterable[Listed]) -> Listing:
        """Return a sorted listing without some objects, and with others.

        gone : object numbers
        """
        import pyarrow as pa

        left = np.delete(np.arange(len(self)), list(self.places(gone).values()))
        kept = Listing(self.table.take(left)) if len(left) < len(self) else self
        parts, start = [], 0
        for one in sorted(new, key=order):
            at = bisect_left(kept, order(one), lo=start, key=order)
            parts += [kept.table.slice(start, at - start), Listing.of([one]).table]
            start = at
        return Listing(pa.concat_tables([*parts, kept.table.slice(start)]).combine_chunks())

    def joined(self, runs: Iterable[Run]) -> Listing:
        """Return the objects of some runs, one behind the other."""
        import pyarrow as pa

        parts = [self.table.slice(run.start, run.end - run.start) for run in runs]
        return Listing(pa.concat_tables(parts).combine_chunks() if parts else self.table.slice(0, 0))

    def _array(self, name: str) -> Any:
        # Of one piece, so that places in it are places in the listing.
        return self.table.column(name).combine_chunks()


def write_listing(file: Path, listing: Listing, told: Mapping[str, Any]) -> None:
    """Keep a listing; where that cannot be, the next night reads the inventory, and that is all.

    told : what it is the listing of, for JSON
    """
    import pyarrow as pa

    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, _schema()) as stream:
        stream.write_table(listing.table)
    content = sink.getvalue()
    head = json.dumps([hashlib.sha256(content).hexdigest(), told]).encode()
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as aside, aside.open("wb") as binary:
            binary.write(head + b"\n")
            binary.write(content)


def read_listing(file: Path) -> tuple[Listing, dict[str, Any]] | None:
    """Return what `write_listing` kept, and what was told with it; None where it is not there, or damaged."""
    import pyarrow as pa

    try:
        with file.open("rb") as binary:
            digest, told = json.loads(binary.readline(1 << 16))
            content = binary.read()
        if hashlib.sha256(content).hexdigest() != digest:
            return None
        table = pa.ipc.open_stream(pa.py_buffer(content)).read_all()
        return (Listing(table.combine_chunks()), dict(told)) if table.schema == _schema() else None
    except (OSError, ValueError, TypeError, pa.ArrowException):
        return None


def _schema() -> Any:
    import pyarrow as pa

    text = pa.large_string()
    types = {"on_display": pa.bool_(), "kind": pa.int64()}
    return pa.schema([(name, types.get(name, text)) for name in Listed._fields])


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
