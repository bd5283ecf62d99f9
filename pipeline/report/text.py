"""Text that came from outside, made fit for a page, a file name or a sentence."""

import hashlib
import re
import unicodedata
from collections.abc import Callable
from functools import lru_cache

import markupsafe

from pipeline.report.language import _, local

_UNFIT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_BIDI = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")
BREAKS = re.compile(r"[^\S\u00a0\u202f]+")
"""Where a line may break: not between a number and its unit."""

_UNIT_SUFFIX = re.compile(r"_(m|kg|hz|pa|deg|s|g|rad)$")


escaped: Callable[[str], str] = getattr(markupsafe, "_escape_inner", markupsafe.escape)
"""Escapes a text for a page: what `markupsafe.escape` makes a Markup of, which takes three times as long."""


def clean(text: str) -> str:
    """Replace what no page or file may carry (control characters, lone surrogates) by the replacement character."""
    return text if text.isprintable() else _UNFIT.sub("\ufffd", text)


def plain(text: str) -> str:
    """Return the text for places without markup (a page title, a text alternative): no direction marks, one line."""
    return " ".join(BREAKS.split(_BIDI.sub("", clean(text)))).strip()


_BARE = re.compile(r"\S{1,6}")
"""What is no more than the sign of a case, such as 3, 12b or IV."""


def cased(text: str) -> str:
    """Return what a case is called: "case 3" of a bare 3, and anything else, such as "vitrine 3", as it is."""
    return f"{_('case')} {text}" if _BARE.fullmatch(text.strip()) else text


def short(text: str, limit: int = 90) -> str:
    """Cut a long text at a word where possible, with an ellipsis.

    Parameters
    ----------
    limit : int, optional
        The largest number of characters that is returned.

    Returns
    -------
    str
    """
    flat = " ".join(clean(text).split())
    if len(flat) <= limit:
        return flat
    cut = flat[: limit - 1]
    at = cut.rfind(" ")
    return (cut[:at] if at > limit // 2 else cut).rstrip() + "…"


def count(number: int) -> str:
    """Write how many there are, such as "2,000"."""
    return local(f"{number:,}")


def words(name: str) -> str:
    """Say a field or parameter in plain words: "base_width_m" becomes "base width"."""
    return _(bare(name))


@lru_cache(maxsize=4096)
def bare(name: str) -> str:
    """Return the plain words in English: what a catalogue is asked for."""
    plainly = _UNIT_SUFFIX.sub("", name)
    plainly = "height of the centre of gravity" if plainly == "cg_height" else plainly
    return plainly.replace("_", " ").strip() or name


def digest(text: str, length: int = 8) -> str:
    """Return the first hexadecimal digits of the text's SHA-256."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:length]


def slug(name: str) -> str:
    """Return a file name stem for any text: at most 60 of a-z, 0-9 and "-", then 8 hex digits that tell twins apart."""
    ascii_name = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii").lower()
    stem = re.sub(r"[^a-z0-9]+", "-", ascii_name).strip("-")[:60].strip("-")
    return f"{stem or 'gallery'}-{digest(name)}"


_BEGINS = frozenset("=+-@\t\r\n\uff1d\uff0b\uff0d\uff20")
_INSIDE = re.compile("([;\t\r\n])(?=[=+\\-@\uff1d\uff0b\uff0d\uff20])")
"""Where a formula begins for programs that cut the line of a CSV file at other separators than the comma, whatever its
quotation marks say: spreadsheets of countries that write decimal commas cut at semicolons."""


def safe_cell(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula: an apostrophe goes before = + - @ tab and return.

    The same goes for signs of full width, and after a semicolon, a tab or a line end within the text.
    """
    fit = encodable(text)
    if _INSIDE.search(fit):
        fit = _INSIDE.sub(r"\1'", fit)
    return "'" + fit if fit[:1] in _BEGINS else fit


def encodable(text: str) -> str:
    """Return a text that UTF-8 can hold."""
    # A lone surrogate, as a badly decoded file leaves behind, cannot be written as UTF-8 at all.
    return text if text.isascii() else text.encode("utf-8", "replace").decode("utf-8")
