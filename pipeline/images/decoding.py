"""Photographs to small pictures, in a process of its own that is bounded in time and memory."""

import hashlib
import json
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Timer
from typing import IO, Any

from pipeline.images.limits import ImageError
from pipeline.records import Photo

VERSION = 1
"""Of what `decoder` makes of a photograph: pictures of another one are made again."""

_HEAD = struct.Struct("<Q")
_LARGEST = 1 << 22
"""Bytes of a small picture at most."""

_KNOWN = {
    b"\xff\xd8\xff": "jpeg", b"\x89PNG\r\n\x1a\n": "png", b"GIF8": "gif", b"BM": "bmp", b"II*\x00": "tiff",
    b"MM\x00*": "tiff",
}  # fmt: skip

_FORMATS = "save it as JPEG, PNG, WebP, TIFF, GIF or BMP"


def check_kind(data: bytes) -> None:
    """Refuse what is no photograph by its first bytes, whatever its name says.

    Parameters
    ----------
    data : bytes
        Its beginning, 1 kB of it.

    Raises
    ------
    ImageError
        Naming what it seems to be.
    """
    start = data[:1024].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    if not data:
        raise ImageError("is empty", "put the photograph there again")
    if any(data.startswith(mark) for mark in _KNOWN) or (data.startswith(b"RIFF") and data[8:12] == b"WEBP"):
        return
    if start.startswith(b"<") and (b"<svg" in start or b"<!doctype svg" in start):
        raise ImageError("is SVG, which may hold programs", _FORMATS)
    if start.startswith((b"<!doctype html", b"<html", b"<head", b"<!--")):
        raise ImageError("is a web page and no photograph", "give the address of the photograph itself")
    kinds = {b"%pdf": "PDF", b"%!ps": "PostScript", b"pk\x03\x04": "an archive", b"<?xml": "XML", b"{": "JSON"}
    found = next((kind for mark, kind in kinds.items() if start.startswith(mark)), "")
    raise ImageError(f"is {found} and no photograph" if found else "is of a kind that is not read", _FORMATS)


class Decoder:
    """Makes small pictures, one after the other; leaving the block ends its process.

    Parameters
    ----------
    side : int
        Pixels of a side of a picture at most.
    most_pixels : int
        Of a photograph.
    seconds : float
        For one photograph.
    """

    def __init__(self, side: int, most_pixels: int, seconds: float) -> None:
        self._side, self._most, self._seconds = side, most_pixels, seconds
        self._process: subprocess.Popen[bytes] | None = None

    def picture(self, data: bytes) -> Photo:
        """Return the small picture of a photograph.

        Parameters
        ----------
        data : bytes
            The whole file.

        Returns
        -------
        Photo
            Its name is a digest of what it shows.

        Raises
        ------
        ImageError
            For what is no photograph, is damaged, or takes too many pixels, too much memory or time.
        """
        check_kind(data)
        process = self._started()
        late = []

        def end() -> None:
            late.append(True)
            process.kill()

        with _after(self._seconds, end):
            said, content = _asked(process, data, self._side, self._most)
        if said is None:
            self.close()
            if late:
                raise ImageError(f"takes more than {self._seconds:g} s to decode", "save it anew, not progressively")
            raise ImageError(
                "ends the program that decodes it: it is damaged or hostile", "save it anew, or leave it out"
            )
        if "why" in said:
            raise ImageError(f"cannot be decoded: {said['why']}", "save it anew, and smaller where it is very large")
        return Photo(hashlib.sha256(content).hexdigest()[:32], int(said["width"]), int(said["height"]), content)

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is None or self._process.poll() is not None:
            self.close()
            # Isolated: neither the folder it is started in nor the environment says what it imports.
            self._process = subprocess.Popen(  # noqa: S603 - our own file, by this interpreter
                [sys.executable, "-I", str(Path(__file__).with_name("decoder.py"))],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
        return self._process

    def close(self) -> None:
        """End its process."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()
        process.wait()


@contextmanager
def _after(seconds: float, do: Callable[[], None]) -> Iterator[None]:
    timer = Timer(seconds, do)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _asked(process: subprocess.Popen[bytes], data: bytes, side: int, most: int) -> tuple[dict[str, Any] | None, bytes]:
    """Return what the process says of a photograph, and the picture; None where it ended, or says what it may not."""
    source, target = process.stdout, process.stdin
    if source is None or target is None:
        return None, b""
    try:
        target.write(b"".join(_HEAD.pack(n) for n in (len(data), side, most)) + data)
        target.flush()
        said = json.loads(_read(source, 1 << 16))
        content = _read(source, _LARGEST)
    except (OSError, ValueError, EOFError):
        return None, b""
    if not isinstance(said, dict) or ("why" not in said and not _is_picture(said, content, side)):
        return None, b""
    return said, content


def _is_picture(said: dict[str, Any], content: bytes, side: int) -> bool:
    sizes = (said.get("width"), said.get("height"))
    return content.startswith(b"\xff\xd8\xff") and all(isinstance(one, int) and 0 < one <= side for one in sizes)


def _read(stream: IO[bytes], most: int) -> bytes:
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size:
        raise EOFError
    (length,) = _HEAD.unpack(head)
    if length > most:
        raise ValueError("more than it may say")
    content = stream.read(length)
    if len(content) < length:
        raise EOFError
    return content
