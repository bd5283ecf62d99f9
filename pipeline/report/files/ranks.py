"""Ranks of objects among all of a report: every page keeps the keys that sort its own, and all are sorted together."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pipeline.records import Urgency

KEYS = "keys.arrow"
"""The part of a page that says where its objects come among others; no export."""

_NAMES = ("state", "settled", "check", "loss", "ease", "size", "object_number", "gallery")
"""Of the parts of a key, in their order."""


@cache
def _schema() -> Any:
    import pyarrow as pa

    kinds = (pa.int8(), pa.bool_(), pa.bool_(), *[pa.float64()] * 3, *[pa.string()] * 2)
    return pa.schema(list(zip(_NAMES, kinds, strict=True)))


def keys_part(keys: Sequence[Urgency | None]) -> bytes:
    """Return the keys of the objects of a page as a file.

    Parameters
    ----------
    keys : sequence of Urgency or None
        In the order of the exports' rows; None for an object that has no rank.

    Returns
    -------
    bytes
        A table in Arrow's format of files, with a row for each.
    """
    import pyarrow as pa

    schema = _schema()
    rows = [key or (None,) * len(_NAMES) for key in keys]
    columns = [pa.array([row[at] for row in rows], field.type) for at, field in enumerate(schema)]
    sink = pa.BufferOutputStream()
    with pa.ipc.new_file(sink, schema) as out:
        out.write_table(pa.Table.from_arrays(columns, schema=schema))
    return bytes(sink.getvalue().to_pybytes())


def ranks_of(parts: Sequence[Path]) -> list[npt.NDArray[np.int64]]:
    """Return the ranks of the objects of all pages: 1 is the most urgent of the museum.

    Parameters
    ----------
    parts : sequence of Path
        The files with the keys of each page.

    Returns
    -------
    list of array of int
        For each part, of its objects in their order; 0 of one that has no rank.

    Raises
    ------
    OSError
        Where one cannot be read.
    """
    import pyarrow as pa
    import pyarrow.compute as pc

    if not parts:
        return []
    tables = []
    for part in parts:
        with pa.OSFile(str(part)) as source, pa.ipc.open_file(source) as file:
            tables.append(file.read_all())
    every = pa.concat_tables(tables)
    order = pc.sort_indices(every, sort_keys=[(name, "ascending") for name in _NAMES]).to_numpy()
    ranks = np.empty(len(order), dtype=np.int64)
    ranks[order] = np.arange(1, len(order) + 1)
    # Nulls are sorted to the end, so that those without a rank take none from others.
    ranks[pc.is_null(every["state"]).to_numpy()] = 0
    return np.split(ranks, np.cumsum([table.num_rows for table in tables])[:-1])
