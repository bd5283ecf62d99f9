"""The letters of the sheets to walk with: which font has each, how wide a text is, and how it is drawn.

Latin, Greek, Cyrillic, Arabic and Hebrew are set in DejaVu Sans, which comes with matplotlib and goes into the file.
Chinese, Japanese and Korean are set in a font of this machine that may go into the file, where it has one with all the
letters (`_OF_MACHINES`); else in one that PDF only names (ISO 32000-1, 9.7.5.2): a reader shows its own font of that
script, and one that has none shows nothing.  A letter that none has is a box.
"""

import re
from collections.abc import Iterator
from functools import cache, lru_cache
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from typing import Any

from pipeline.report.errors import ReportError

LACKING = "□"
"""Stands for a letter that the fonts lack."""

SANS, BOLD = "KourosSans", "KourosSans-Bold"
_FILES = {SANS: "DejaVuSans.ttf", BOLD: "DejaVuSans-Bold.ttf"}

_NAMED = {
    "HeiseiKakuGo-W5": "shift_jis",
    "HYGothic-Medium": "euc_kr",
    "STSong-Light": "gb2312",
    "MSung-Light": "big5",
}
"""Fonts that are named only, and the letters that each has."""

_OF_MACHINES = (
    "ipaexg.ttf", "ipagp.ttf", "ipag.ttf", "TakaoPGothic.ttf", "VL-PGothic-Regular.ttf", "YuGothM.ttc", "meiryo.ttc",
    "msgothic.ttc", "NanumGothic.ttf", "malgun.ttf", "wqy-microhei.ttc", "wqy-zenhei.ttc", "msyh.ttc", "simhei.ttf",
    "DroidSansFallbackFull.ttf", "arialuni.ttf", "Arial Unicode.ttf",
)  # fmt: skip
"""Fonts with TrueType outlines, which go into a file, as Debian, Windows and macOS name them: Japanese ones first."""

_FOLDERS = ("/usr/share/fonts", "/usr/local/share/fonts", "/Library/Fonts", "/System/Library/Fonts", "C:/Windows/Fonts")
_AT_HOME = (".local/share/fonts", ".fonts", "Library/Fonts", "AppData/Local/Microsoft/Windows/Fonts")

_ARABIC = re.compile("[\u0600-\u06ff\u0750-\u077f]")
_TURNED = re.compile("[\u0590-\u08ff\ufb1d-\ufdff\ufe70-\ufeff]")


@cache
def ready() -> frozenset[int]:
    """Register the fonts, and return the letters that those have which go into the file.

    Raises
    ------
    ReportError
        Where they are not there.
    """
    from reportlab import rl_config
    from reportlab.pdfbase.cidfonts import UnicodeCIDFont
    from reportlab.pdfbase.pdfmetrics import registerFont
    from reportlab.pdfbase.ttfonts import TTFont

    # Bytes need not be printable since nobody mails sheets by a seven-bit line: a fifth of a file, and of its time.
    rl_config.useA85 = 0
    # Found and not imported: of matplotlib nothing but its fonts is wanted.
    found = find_spec("matplotlib")
    folder = Path(found.origin or "").parent / "mpl-data" / "fonts" / "ttf" if found else Path()
    letters: frozenset[int] | None = None
    for name, file in _FILES.items():
        if not (folder / file).is_file():
            raise ReportError(f"{folder / file} is missing, the font of the sheets: install matplotlib again")
        font: Any = TTFont(name, str(folder / file), asciiReadable=False, shapable=False)
        registerFont(font)
        mine = frozenset(font.face.charToGlyph)
        letters = mine if letters is None else letters & mine
    for name in _NAMED:
        registerFont(UnicodeCIDFont(name))
    return letters or frozenset()


def fonts_here() -> list[Path]:
    """Return the fonts of Chinese, Japanese and Korean that this machine has and that may go into a file."""
    folders = [*map(Path, _FOLDERS), *(Path.home() / name for name in _AT_HOME)]
    there = {file.name.lower(): file for folder in folders for file in sorted(folder.rglob("*.tt[cf]"))}
    return [there[name.lower()] for name in _OF_MACHINES if name.lower() in there]


_found_here = cache(fonts_here)


@cache
def _letters_in(file: Path) -> frozenset[str]:
    """Register a font, and return its letters; none where it cannot go into a file."""
    from reportlab.pdfbase.pdfmetrics import registerFont
    from reportlab.pdfbase.ttfonts import TTFError, TTFont

    try:
        font: Any = TTFont(file.stem, str(file), asciiReadable=False, shapable=False)
    except (TTFError, OSError):
        return frozenset()
    registerFont(font)
    return frozenset(map(chr, font.face.charToGlyph))


@lru_cache(maxsize=8192)
def _named(letters: str) -> str:
    """Return the first font that has all of the letters, of this machine's or else a named one; "" where none has."""
    if letters < "\u1100":
        return ""
    for file in _found_here():
        if _letters_in(file).issuperset(letters):
            return file.stem
    for name, held in _NAMED.items():
        try:
            letters.encode(held)
        except UnicodeEncodeError:
            continue
        return name
    return ""


def shown_letters(text: str) -> str:
    """Return a text in letters that the fonts have, Arabic ones joined, a box for each of the others."""
    if text.isascii():
        return text
    if _ARABIC.search(text):
        from arabic_reshaper import reshape

        text = reshape(text)
    letters = ready()
    return "".join(one if ord(one) in letters or _named(one) else LACKING for one in text)


def _runs(text: str, font: str) -> Iterator[tuple[str, str]]:
    """Yield the pieces of a text, each with its font."""
    if text.isascii():
        yield text, font
        return
    letters = ready()
    others = "".join(one for one in text if ord(one) not in letters)
    # One font for the whole of a name, where one has it.
    whole = _named(others)
    for name, piece in groupby(text, key=lambda one: "" if ord(one) in letters else whole or _named(one)):
        yield "".join(piece), name or font


@lru_cache(maxsize=16_384)
def width_of(text: str, font: str, size: float) -> float:
    """Return how wide a text is, in points."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    return float(sum(stringWidth(piece, name, size) for piece, name in _runs(text, font)))


def draw_text(pdf: Any, at: tuple[float, float], text: str, font: str, size: float, share: float = 0.0) -> None:
    """Draw a line of text in the order in which its letters stand from left to right.

    Parameters
    ----------
    pdf : Canvas
        Of reportlab, on which it is drawn.
    at : (float, float)
        Where, in points.
    text : str
        As it is read.
    font : {SANS, BOLD}
        For what is in no script of its own font.
    size : float
        In points.
    share : float
        Which part of its width lies left of that point: 0.0, 0.5 for one that is centred, or 1.0.
    """
    from reportlab.pdfbase.pdfmetrics import stringWidth

    line = shown_letters(text)
    if _TURNED.search(line):
        from bidi import get_display

        line = str(get_display(line))
    x, y = at[0] - (share and share * width_of(line, font, size)), at[1]
    *before, (last, of) = list(_runs(line, font)) or [("", font)]
    for piece, name in before:
        pdf.setFont(name, size)
        pdf.drawString(x, y, piece)
        x += stringWidth(piece, name, size)
    pdf.setFont(of, size)
    pdf.drawString(x, y, last)
