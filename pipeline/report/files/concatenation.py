"""The exports of a whole report, put together from the parts of its pages."""

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pipeline.report.files.exports import HEADERS, OBJECT_COLUMNS, RANK, TABLES, schema_of
from pipeline.report.files.manifest import FileSum, sum_of

GROUP = 20_000
"""Rows of a row group, about: page by page they would be a thousand, which costs their reader time and room."""

_BLOCK = 1 << 20
"""Bytes that are copied at a time."""

Ranks = Sequence[npt.NDArray[np.int64]]
"""Of the rows of each part; 0 for none."""


def ranked(name: str) -> bool:
    """Say whether an export has a column that no part of it has: the rank among all."""
    return RANK in TABLES[name.partition(".")[0]]


def concatenate(target: Path, parts: Sequence[Path], ranks: Ranks | None = None) -> FileSum:
    """Write one export of a report from the parts of its pages, in their order.

    Parameters
    ----------
    target : Path
        The file, named as in `exports.EXPORTS`.
    parts : sequence of Path
        What the pages add to it (`exports.part_of`); of several headers the first stays.
    ranks : Ranks, optional
        Of an export that is `ranked`: written behind each row.

    Returns
    -------
    FileSum
        Of what was written.

    Raises
    ------
    OSError
        Where it cannot be written, such as a disk that is full.
    """
    if target.suffix == ".parquet":
        _tables(target, parts, ranks)
        return sum_of(target)
    header = HEADERS.get(target.name, b"")
    if ranks is None:
        return _written(target, header, _blocks(parts, len(header)))
    whole = (",".join(OBJECT_COLUMNS) + "\n").encode() if header else b""
    return _written(target, whole, _rows(target, parts, len(header), ranks))


def _written(target: Path, header: bytes, blocks: Iterable[bytes]) -> FileSum:
    digest = hashlib.sha256(header)
    with target.open("wb", buffering=_BLOCK) as out:
        out.write(header)
        for block in blocks:
            digest.update(block)
            out.write(block)
        return FileSum(out.tell(), digest.hexdigest())


def _blocks(parts: Iterable[Path], begin: int) -> Iterator[bytes]:
    for part in parts:
        with part.open("rb", buffering=0) as source:
            source.seek(begin)
            while block := source.read(_BLOCK):
                yield block


def _rows(target: Path, parts: Sequence[Path], begin: int, ranks: Ranks) -> Iterator[bytes]:
    """Yield the rows of each part with their ranks behind them."""
    ends = (b', "rank": %b}\n', b"null") if target.suffix == ".jsonl" else (b",%b\n", b"")
    for part, own in zip(parts, ranks, strict=True):
        rows = _records(part.read_bytes()[begin:], quoted=target.suffix != ".jsonl")
        form, none = ends
        yield b"".join(
            row + form % (b"%d" % rank if rank else none) for row, rank in zip(rows, own.tolist(), strict=True)
        )


def _records(text: bytes, *, quoted: bool) -> Iterator[bytes]:
    """Yield the rows of a text without their ends; in CSV a line may end within quotation marks, which are paired."""
    if not quoted:
        yield from (line[:-1] for line in text.split(b"\n")[:-1])
        return
    begun: list[bytes] = []
    marks = 0
    for line in text.split(b"\n")[:-1]:
        begun.append(line)
        marks += line.count(b'"')
        if marks % 2 == 0:
            yield b"\n".join(begun)
            begun = []


def _tables(target: Path, parts: Iterable[Path], ranks: Ranks | None) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    schema = schema_of(target.stem)
    waiting: list[Any] = []
    rows = 0
    with pq.ParquetWriter(target, schema, compression="zstd") as out:

        def write() -> None:
            out.write_table(pa.concat_tables(waiting), row_group_size=rows)

        for at, part in enumerate(parts):
            with pa.OSFile(str(part)) as source, pa.ipc.open_file(source) as file:
                waiting.append(file.read_all())
            if ranks is not None:
                column = pa.array(ranks[at], pa.int64(), mask=ranks[at] == 0)
                waiting[-1] = waiting[-1].append_column(schema.field(RANK), column)
            rows += waiting[-1].num_rows
            if rows >= GROUP:
                write()
                waiting, rows = [], 0
        if rows:
            write()
