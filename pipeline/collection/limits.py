"""Limits of a museum's records: beyond them a source is refused whole, and nothing of it is written."""

from __future__ import annotations

import time
from dataclasses import dataclass

from pipeline.collection.errors import CollectionError


@dataclass(frozen=True)
class Limits:
    """How much of a source is accepted; `[limits]` in kouros.toml sets it.

    Attributes
    ----------
    bytes : int
        Of a file, as it lies on the disk.
    rows : int
        Below the header.
    seconds : float
        That reading may take, from the opening on; what a mapping says of a database counts where it is less.
    """

    bytes: int = 1 << 30
    rows: int = 5_000_000
    seconds: float = 3600.0


STANDARD = Limits()

_ROWS_BETWEEN = 256
"""Rows between two looks at the clock."""


class Meter:
    """Counts the rows of a source, and looks at the clock."""

    def __init__(self, source: str, limits: Limits) -> None:
        self._source = source
        self._limits = limits
        self._end = time.monotonic() + limits.seconds
        self._looked = -_ROWS_BETWEEN
        self.rows = 0

    def count(self, more: int = 1) -> None:
        """Count more rows.

        Parameters
        ----------
        more : int
            How many.

        Raises
        ------
        CollectionError
            Beyond the limits, naming the source, the row and the remedy.
        """
        self.rows += more
        if self.rows > self._limits.rows:
            raise CollectionError(
                f"{self._source}: more than {self._limits.rows:,} rows; export only the objects on display, "
                "or raise [limits] rows"
            )
        if self.rows - self._looked < _ROWS_BETWEEN:
            return
        self._looked = self.rows
        if time.monotonic() > self._end:
            raise CollectionError(
                f"{self._source}, row {self.rows:,}: reading took more than {self._limits.seconds:g} s; see whether "
                "the disk or the network is slow, or raise [limits] seconds"
            )
