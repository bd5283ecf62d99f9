"""The exports of a whole report are the rows of its parts, one behind the other."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from pipeline.report.files import concatenation
from pipeline.report.files.concatenation import concatenate
from pipeline.report.files.exports import HEADERS, TEXTS, schema_of, table_part
from pipeline.report.files.manifest import sum_of

SCHEMA = schema_of("recommendations")
SIZES = (0, 1, *range(44), 0, 53)
"""Rows of the parts: a thousand together."""


def _cell(field: pa.Field, n: int) -> object:
    if pa.types.is_list(field.type):
        return [str(n)] * (n % 3)
    if pa.types.is_boolean(field.type):
        return n % 2 == 0
    return float(n) if pa.types.is_floating(field.type) else f"<{n}>"


def rows(first: int, count: int) -> list[dict[str, object]]:
    return [
        {field.name: _cell(field, n) for field in SCHEMA} | {"source": None if n % 5 == 0 else "table"}
        for n in range(first, first + count)
    ]


def table(first: int, count: int) -> pa.Table:
    return pa.Table.from_pylist(rows(first, count), schema=SCHEMA)


def part(first: int, count: int) -> bytes:
    return table_part("recommendations", rows(first, count))


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("block", [1 << 20, 7])
def test_texts_follow_each_other_under_one_header(
    name: str, block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of random bytes and of none, so that nothing but bytes is assumed; also where a part is many blocks."""
    monkeypatch.setattr(concatenation, "_BLOCK", block)
    numbers = np.random.default_rng(1)
    header = HEADERS.get(name, b"")
    bodies = [numbers.bytes(int(size)) for size in numbers.integers(0, 60, 200)]
    parts = [tmp_path / f"{at}.{name}" for at in range(len(bodies))]
    for file, body in zip(parts, bodies, strict=True):
        file.write_bytes(header + body)
    written = concatenate(tmp_path / name, parts)
    assert (tmp_path / name).read_bytes() == header + b"".join(bodies)
    assert written == sum_of(tmp_path / name)
    assert concatenate(tmp_path / name, []).size == len(header)


def test_row_groups_hold_many_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(concatenation, "GROUP", 100)
    starts = np.cumsum([0, *SIZES[:-1]])
    parts = [tmp_path / f"{at}.arrow" for at in range(len(SIZES))]
    for file, start, size in zip(parts, starts, SIZES, strict=True):
        file.write_bytes(part(int(start), size))
    target = tmp_path / "recommendations.parquet"
    assert concatenate(target, parts) == sum_of(target)
    assert pq.read_table(target) == table(0, 1_000)
    sizes = [pq.read_metadata(target).row_group(n).num_rows for n in range(pq.read_metadata(target).num_row_groups)]
    assert all(100 <= size < 154 for size in sizes[:-1])


@pytest.mark.parametrize("parts", [0, 3])
def test_a_table_without_rows(parts: int, tmp_path: Path) -> None:
    files = [tmp_path / f"{at}.arrow" for at in range(parts)]
    for file in files:
        file.write_bytes(part(0, 0))
    target = tmp_path / "recommendations.parquet"
    concatenate(target, files)
    assert pq.read_table(target) == table(0, 0)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("name", ["findings.jsonl", "recommendations.parquet"])
def test_a_full_disk_is_said(name: str, tmp_path: Path) -> None:
    file = tmp_path / name
    file.write_bytes(part(0, 5_000) if file.suffix == ".parquet" else b"x" * (1 << 23))
    full = tmp_path / "full" / name
    full.parent.mkdir()
    full.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        concatenate(full, [file])
