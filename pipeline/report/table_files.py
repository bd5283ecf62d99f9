"""The exported tables as Parquet files, row by row from sheets that are new and from an earlier report's file."""

from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from pipeline.report.errors import ReportError

GROUP = 20_000
"""Rows of a row group, about: sheet by sheet they would be a thousand, which costs their reader time and room."""


class TableFile:
    """A Parquet file that is being written, by a thread of its own: it compresses while the rest goes on.

    schema : pyarrow.Schema
    """

    def __init__(self, path: Path, schema: Any) -> None:
        import pyarrow.parquet as pq

        self._schema = schema
        self._writer = pq.ParquetWriter(path, schema, compression="zstd")
        self._hand = ThreadPoolExecutor(1)
        self._last: Future[None] | None = None
        self._waiting: list[Any] = []
        self._pending = 0
        self._rows = 0

    def add_stream(self, content: bytes) -> tuple[int, int]:
        """Add the rows of a table in Arrow's own format; return where they begin and how many they are."""
        import pyarrow as pa

        return self.add(pa.ipc.open_stream(content).read_all())

    def add(self, table: Any) -> tuple[int, int]:
        """Add the rows of a pyarrow.Table; return where they begin and how many they are."""
        start, rows = self._rows, table.num_rows
        if rows:
            # What comes from a Parquet file calls the parts of its lists by another name.
            self._waiting.append(table.cast(self._schema))
            self._rows += rows
            self._pending += rows
            if self._pending >= GROUP:
                self._write()
        return start, rows

    def _write(self) -> None:
        # One row group waits at most: the memory is bounded, and what went wrong is said here.
        self._wait()
        if self._waiting:
            self._last = self._hand.submit(self._written, self._waiting, self._pending)
        self._waiting, self._pending = [], 0

    def _written(self, tables: list[Any], rows: int) -> None:
        import pyarrow as pa

        self._writer.write_table(pa.concat_tables(tables), row_group_size=rows)

    def _wait(self) -> None:
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def close(self) -> None:
        """Write what is left and end the file; once more does nothing.

        raises : OSError where it cannot be written, such as a disk that is full
        """
        try:
            if self._writer.is_open:
                self._write()
                self._wait()
        finally:
            self._hand.shutdown()
            self._writer.close()


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

    def rows(self, start: int, count: int) -> Any:
        """Return some rows as a pyarrow.Table.

        raises : ReportError where the file does not have them
        """
        import pyarrow as pa

        end = start + count
        if count and (not self._ends or end > self._ends[-1]):
            raise ReportError(f"{self._path} is shorter than its report says; remove that report, and run again")
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
