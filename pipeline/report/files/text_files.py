"""The exported text files, put together from sheets that are new and from an earlier report's files."""

from pathlib import Path

from pipeline.report.errors import cut_short
from pipeline.report.files.background_writer import Behind

BLOCK = 1 << 22
"""Bytes that are written at a time, about: a sheet's are too few to be worth a thread's while."""


class TextFile:
    """A file that is being written, by a thread of its own.

    earlier : the same file of an earlier report, whose bytes can be taken over
    """

    def __init__(self, path: Path, header: bytes, earlier: Path) -> None:
        self._stream = path.open("wb", buffering=0)
        self._earlier = earlier
        self._behind = Behind()
        self._waiting = [header]
        self._pending = self._size = len(header)
        # What of the earlier file goes after that, where it begins and ends: what lies together is copied together.
        self._range = (0, 0)

    def add(self, content: bytes) -> tuple[int, int]:
        """Add what is new; return where it begins and how many bytes it is."""
        self._end_range()
        self._waiting.append(content)
        self._pending += len(content)
        return self._placed(len(content))

    def take(self, start: int, length: int) -> tuple[int, int]:
        """Take bytes over from the earlier file; return where they begin here and how many they are."""
        if start != self._range[1]:
            self._end_range()
            self._range = (start, start)
        self._range = (self._range[0], start + length)
        return self._placed(length)

    def _end_range(self) -> None:
        if self._range[0] < self._range[1]:
            self._flush()

    def _placed(self, length: int) -> tuple[int, int]:
        start = self._size
        self._size += length
        if self._pending >= BLOCK or self._range[1] - self._range[0] >= BLOCK:
            self._flush()
        return start, length

    def _flush(self) -> None:
        (begin, end), self._range = self._range, (0, 0)
        waiting, held = self._waiting, self._pending
        self._waiting, self._pending = [], 0
        if waiting or begin < end:
            self._behind.do(held, self._written, waiting, begin, end)

    def _written(self, waiting: list[bytes], begin: int, end: int) -> None:
        self._all(b"".join(waiting))
        if begin == end:
            return
        with self._earlier.open("rb", buffering=0) as source:
            source.seek(begin)
            room = memoryview(bytearray(min(BLOCK, end - begin)))
            left = end - begin
            while left:
                got = source.readinto(room[:left])
                if not got:
                    raise cut_short(self._earlier)
                self._all(room[:got])
                left -= got

    def _all(self, content: bytes | memoryview) -> None:
        rest = memoryview(content)
        while rest:
            rest = rest[self._stream.write(rest) :]

    def close(self) -> None:
        """Write what is left and end the file; once more does nothing.

        raises : OSError where it cannot be written, such as a disk that is full; ReportError where the earlier file is
                 shorter than it should be
        """
        try:
            if not self._stream.closed:
                self._flush()
                self._behind.wait()
        finally:
            self._behind.close()
            self._stream.close()
