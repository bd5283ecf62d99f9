"""The exported tables as Parquet files, put together from sheets that are new and from an earlier report's files."""

from functools import cached_property
from pathlib import Path
from typing import Any

from pipeline.report.errors import cut_short
from pipeline.report.files.background_writer import Behind

GROUP = 20_000
"""Rows of a row group, about: sheet by sheet they would be a thousand, which costs their reader time and room."""


class TableFile:
    """A Parquet file that is being written, by a thread of its own: it compresses while the rest goes on.

    schema  : pyarrow.Schema
    earlier : the same file of an earlier report, whose rows can be taken over
    rows    : how many it has so far
    """

    def __init__(self, path: Path, schema: Any, earlier: Path) -> None:
        import pyarrow.parquet as pq

        self._schema = schema
        self._writer = pq.ParquetWriter(path, schema, compression="zstd")
        self._earlier = earlier
        self._behind = Behind()
        # Tables, and of the earlier file where rows begin and end.
        self._waiting: list[Any] = []
        self._pending = 0
        self.rows = 0

    def add(self, content: bytes) -> tuple[int, int]:
        """Add the rows of a table in Arrow's own format; return where they begin and how many they are."""
        import pyarrow as pa

        table = pa.ipc.open_stream(content).read_all()
        self._waiting.append(table)
        return self._placed(table.num_rows)

    def take(self, start: int, rows: int) -> tuple[int, int]:
        """Take rows over from the earlier file; return where they begin here and how many they are."""
        last = self._waiting[-1] if self._waiting else None
        if isinstance(last, tuple) and last[1] == start:
            self._waiting[-1] = (last[0], start + rows)
        else:
            self._waiting.append((start, start + rows))
        return self._placed(rows)

    def _placed(self, rows: int) -> tuple[int, int]:
        start = self.rows
        self.rows += rows
        self._pending += rows
        if self._pending >= GROUP:
            self._write()
        return start, rows

    def _write(self) -> None:
        waiting, rows = self._waiting, self._pending
        self._waiting, self._pending = [], 0
        if rows:
            held = sum(part.nbytes for part in waiting if not isinstance(part, tuple))
            self._behind.do(held, self._written, waiting, rows)

    def _written(self, waiting: list[Any], rows: int) -> None:
        import pyarrow as pa

        tables = [self._old.rows(*part) if isinstance(part, tuple) else part for part in waiting]
        # What comes from a Parquet file calls the parts of its lists by another name.
        whole = pa.concat_tables([table.cast(self._schema) for table in tables])
        self._writer.write_table(whole, row_group_size=rows)

    @cached_property
    def _old(self) -> "OldTable":
        return OldTable(self._earlier)

    def close(self) -> None:
        """Write what is left and end the file; once more does nothing.

        raises : OSError where it cannot be written, such as a disk that is full; ReportError where the earlier file has
                 fewer rows than it should
        """
        try:
            if self._writer.is_open:
                self._write()
                self._behind.wait()
        finally:
            self._behind.close()
            self._writer.close()
            if "_old" in self.__dict__:
                self._old.close()


class OldTable:
    """The Parquet file of an earlier report, read from the front to the back."""

    def __init__(self, path: Path) -> None:
        import pyarrow.parquet as pq

        self._path = path
        self._file = pq.ParquetFile(path)
        self._ends: list[int] = []
        for group in range(self._file.num_row_groups):
            before = self._ends[-1] if self._ends else 0
            self._ends.append(before + self._file.metadata.row_group(group).num_rows)
        self._group, self._table = -1, None

    def rows(self, start: int, end: int) -> Any:
        """Return some rows as a pyarrow.Table.

        raises : ReportError where the file does not have them
        """
        import pyarrow as pa

        if start < end and (not self._ends or end > self._ends[-1]):
            raise cut_short(self._path)
        parts = []
        for group, group_end in enumerate(self._ends):
            begin = self._ends[group - 1] if group else 0
            low, high = max(start, begin), min(end, group_end)
            if low < high:
                parts.append(self._of_group(group, low - begin, high - low))
        return pa.concat_tables(parts) if parts else self._file.schema_arrow.empty_table()

    def _of_group(self, group: int, start: int, count: int) -> Any:
        if group != self._group:
            # The next rows are most often of the same group.
            self._group, self._table = group, self._file.read_row_group(group)
        return self._table.slice(start, count)  # type: ignore[attr-defined]

    def close(self) -> None:
        """Close the file."""
        self._file.close()
