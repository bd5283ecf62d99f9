"""Words for a file of records that no reader knows."""

from __future__ import annotations

import codecs
import re
import zipfile
from pathlib import Path

from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.formats import NAMES, columns, record_text

_SPECTRA = re.compile(rb"\b(?:response|fourier)\b[^\n]{0,60}\bspectr", re.IGNORECASE)
_LETTERS = [bytes([code]) for code in (*range(65, 91), *range(97, 123))]
_DIGITS = [bytes([code]) for code in range(48, 58)]
_BINARY = {
    b"MATLAB 5.0 MAT-file": ("a MATLAB file", "writematrix([t, ns, ew, ud], 'record.csv')"),
    b"\x93NUMPY": ("an array of numpy", "np.savetxt('record.csv', np.column_stack([t, ns, ew, ud]), delimiter=',')"),
}
_HDF5 = b"\x89HDF"
_PACKED = {b"\x1f\x8b": "gzip", b"PK\x03\x04": "ZIP", b"BZh": "bzip2", b"\xfd7zXZ": "xz", b"7z\xbc\xaf": "7-Zip"}


_PROSE = 100_000
"""Bytes of the longest text that is taken for words about records."""


def is_workbook(file: Path) -> bool:
    """Whether a file is a workbook of Excel or LibreOffice, which is a ZIP inside."""
    if not zipfile.is_zipfile(file):
        return False
    with zipfile.ZipFile(file) as archive:
        names = set(archive.namelist())
    return "xl/workbook.xml" in names or {"content.xml", "mimetype"} <= names


def is_prose(file: Path) -> bool:
    """Whether a file is a text of words, such as a licence among the records of an archive, and no damaged record."""
    if file.stat().st_size > _PROSE:
        return False
    text = file.read_bytes()
    letters, digits = sum(map(text.count, _LETTERS)), sum(map(text.count, _DIGITS))
    return b"\0" not in text and letters > 8 * digits and letters > 0.5 * len(text)


def unknown(file: Path) -> MotionError:
    """Return the refusal of a file of an unknown format.

    Parameters
    ----------
    file : Path
        The record file.

    Returns
    -------
    MotionError
        Naming the formats that are read, the file's first line, and the verb that takes any table; or of rows of
        numbers alone, what is not said.
    """
    with file.open("rb") as stream:
        start = stream.read(400)
    if is_workbook(file):
        return refusal(file, "file", "is a workbook", "save the sheet with time and accelerations as CSV")
    binary = next((said for magic, said in _BINARY.items() if start.startswith(magic)), None)
    if binary:
        remedy = (
            f"write its time and accelerations as text, such as {binary[1]}, and name unit and columns in a first line"
        )
        return refusal(file, "file", f"is {binary[0]}", remedy)
    packed = next((name for magic, name in _PACKED.items() if start.startswith(magic)), None)
    if packed:
        remedy = "unpack it: what is read is what its hash is of (kouros motions add unpacks gzip, ZIP and tar)"
        return refusal(file, "file", f"is packed ({packed})", remedy)
    if start.startswith(_HDF5):
        return refusal(
            file, "file", "is HDF5 (such as ASDF)", "export its waveforms as MiniSEED, with their StationXML"
        )
    if not start.strip(b" \t\r\n\0\x1a"):
        return refusal(file, "file", "is empty", "fetch it again")
    if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or _in_utf16(start):
        return refusal(file, "file", "is text in UTF-16", "save it as plain text (ASCII or UTF-8)")
    if b"\0" in start:
        first = "it is no text"
    else:
        line = next(line for line in start.splitlines() if line.strip())
        if _SPECTRA.search(line):
            wrong = "holds spectra, which were derived from a record: of its motion they have the peaks alone"
            remedy = "give the file of the acceleration (such as volume 1 or 2 in place of 3)"
            return record_text.OtherQuantityError(f"{file}: file: {wrong}; {remedy}")
        if (why := columns.refused(str(file))) is not None:
            return why
        first = f"its first line is {record_text.shown(_readable(line))}"
    wrong = f"is of no format that is known; {first}.  What is read: {', '.join(NAMES.values())}; MiniSEED, SAC, K-NET"
    wrong += " and KiK-net, and whatever else obspy reads"
    remedy = (
        "a table of numbers becomes a record by: kouros motions convert FILE --columns time,ns,ew,ud --unit gal --out"
    )
    return refusal(file, "file", wrong, f"{remedy} FOLDER (and --dt 0.01 where no column is the time)")


def _readable(line: bytes) -> str:
    try:
        text = line.decode("utf-8-sig")
    except UnicodeDecodeError:
        return record_text.printable(line)
    return "".join(letter if letter.isprintable() else " " for letter in text).rstrip()


def _in_utf16(start: bytes) -> bool:
    """Whether every other byte is zero and the rest are those of a text, with a line's end."""
    halves = start[0 : len(start) & ~1 : 2], start[1::2]
    return any(
        b"\n" in text and not other.strip(b"\0") and all(byte >= 32 or byte in b"\t\r\n" for byte in text)
        for text, other in (halves, halves[::-1])
    )
