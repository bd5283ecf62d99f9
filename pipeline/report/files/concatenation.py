"""The exports of a whole report, put together from the parts of its pages."""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from pipeline.report.files.exports import HEADERS, schema_of
from pipeline.report.files.manifest import FileSum, sum_of

GROUP = 20_000
"""Rows of a row group, about: page by page they would be a thousand, which costs their reader time and room."""

_BLOCK = 1 << 20
"""Bytes that are copied at a time."""


def concatenate(target: Path, parts: Sequence[Path]) -> FileSum:
    """Write one export of a report from the parts of its pages, in their order.

    Parameters
    ----------
    target : Path
        The file, named as in `exports.EXPORTS`.
    parts : sequence of Path
        Whole files of the same kind; of several headers the first stays.

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
        _tables(target, parts)
        return sum_of(target)
    return _texts(target, HEADERS.get(target.name, b""), parts)


def _texts(target: Path, header: bytes, parts: Iterable[Path]) -> FileSum:
    digest = hashlib.sha256(header)
    with target.open("wb", buffering=_BLOCK) as out:
        out.write(header)
        for part in parts:
            with part.open("rb", buffering=0) as source:
                source.seek(len(header))
                while block := source.read(_BLOCK):
                    digest.update(block)
                    out.write(block)
        return FileSum(out.tell(), digest.hexdigest())


def _tables(target: Path, parts: Iterable[Path]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    schema = schema_of(target.stem)
    waiting: list[Any] = []
    rows = 0
    with pq.ParquetWriter(target, schema, compression="zstd") as out:

        def write() -> None:
            # What comes from a Parquet file calls the parts of its lists by another name.
            out.write_table(pa.concat_tables(waiting).cast(schema), row_group_size=rows)

        for part in parts:
            with pq.ParquetFile(part) as file:
                waiting.append(file.read())
            rows += waiting[-1].num_rows
            if rows >= GROUP:
                write()
                waiting, rows = [], 0
        if rows:
            write()
