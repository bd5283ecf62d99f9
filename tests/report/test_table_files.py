"""Parquet files from new rows and from an earlier file's are those that were written at once."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from pipeline.report.errors import ReportError
from pipeline.report.files import table_files
from pipeline.report.files.table_files import TableFile

SCHEMA = pa.schema([("n", pa.float64()), ("words", pa.list_(pa.string())), ("text", pa.string())])


def table(first: int, count: int) -> pa.Table:
    numbers = range(first, first + count)
    rows = [{"n": n / 7, "words": [str(n)] * (n % 3), "text": None if n % 5 == 0 else f"<{n}>"} for n in numbers]
    return pa.Table.from_pylist(rows, schema=SCHEMA)


def stream(part: pa.Table) -> bytes:
    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, SCHEMA) as out:
        out.write_table(part)
    return bytes(sink.getvalue().to_pybytes())


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, list[tuple[int, int]]]:
    """A file of 1,000 rows in parts of 0 to 53, in groups of a hundred or so, and where each part is."""
    monkeypatch.setattr(table_files, "GROUP", 100)
    out = TableFile(tmp_path / "old.parquet", SCHEMA, tmp_path / "none.parquet")
    places, first = [], 0
    for size in [0, 1, *range(44), 0, 53]:
        places.append(out.add(stream(table(first, size))))
        first += size
    out.close()
    out.close()
    return tmp_path / "old.parquet", places


def test_row_groups_hold_many_parts(written: tuple[Path, list[tuple[int, int]]]) -> None:
    path, places = written
    assert pq.read_table(path).cast(SCHEMA) == table(0, 1_000)
    assert sum(count for _, count in places) == 1_000
    sizes = [pq.read_metadata(path).row_group(n).num_rows for n in range(pq.read_metadata(path).num_row_groups)]
    assert all(100 <= size < 154 for size in sizes[:-1])


def test_what_is_taken_over_is_what_was_written(written: tuple[Path, list[tuple[int, int]]], tmp_path: Path) -> None:
    """All parts but one, which is new, and one more at the end; also across the ends of row groups."""
    path, places = written
    out = TableFile(tmp_path / "new.parquet", SCHEMA, path)
    expected = []
    for at, (start, count) in enumerate(places):
        part = table(5_000, 33) if at == 20 else table(start, count)
        expected.append(part)
        assert (out.add(stream(part)) if at == 20 else out.take(start, count))[1] == part.num_rows
    assert out.take(950, 50) == (sum(part.num_rows for part in expected), 50)
    out.close()
    whole = pa.concat_tables([*expected, table(950, 50)])
    assert pq.read_table(tmp_path / "new.parquet").cast(SCHEMA) == whole


def test_what_the_earlier_file_lacks_is_an_error(written: tuple[Path, list[tuple[int, int]]], tmp_path: Path) -> None:
    out = TableFile(tmp_path / "new.parquet", SCHEMA, written[0])
    out.take(990, 11)
    with pytest.raises(ReportError, match=r"old\.parquet is shorter than its report says"):
        out.close()
    out.close()


def test_a_table_without_rows(tmp_path: Path) -> None:
    out = TableFile(tmp_path / "none.parquet", SCHEMA, tmp_path / "nothing.parquet")
    assert out.add(stream(table(0, 0))) == (0, 0)
    out.close()
    assert pq.read_table(tmp_path / "none.parquet").num_rows == 0
    again = TableFile(tmp_path / "again.parquet", SCHEMA, tmp_path / "none.parquet")
    assert again.take(0, 0) == (0, 0)
    again.close()
    assert pq.read_table(tmp_path / "again.parquet").num_rows == 0
