"""The language of the pages: phrases are English in the code, and looked up in a catalogue when shown.

Catalogues of some languages travel with Kouros, as texts (.po) that a person can read, correct and sign; the museum's
own, compiled, goes before them.  Numbers and times are written as the language's people do, by the data of Unicode's
CLDR that Babel carries.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from datetime import datetime
from functools import lru_cache
from gettext import GNUTranslations, NullTranslations, find
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.report.errors import ReportError
from pipeline.resources import resource

DOMAIN = "kouros"
"""The name of a catalogue: <folder>/<language>/LC_MESSAGES/kouros.mo."""

_RIGHT_TO_LEFT = ("ar", "fa", "he", "ur", "yi")

if TYPE_CHECKING:
    from babel import Locale

# The language holds for the rendering of one report, in the thread that renders it; nothing outlives that.
_PHRASES: ContextVar[NullTranslations | None] = ContextVar("phrases", default=None)
_TAG: ContextVar[str] = ContextVar("tag", default="en")

SIGNED = "X-Reviewed-By"
"""The header of a catalogue in which the person who reviewed it signs: a name, and a date."""


@dataclass(frozen=True, slots=True)
class Language:
    """A language of the pages; English, which needs no catalogue, where nothing is said.

    Attributes
    ----------
    code : str
        A language tag, such as "it" or "pt-BR".
    digest : str
        Of its catalogues; "" where there is none.
    reviewed : str or None
        Who signed the catalogue that travels with Kouros; "" where nobody did, None where it is not used.
    """

    code: str = "en"
    phrases: NullTranslations = field(default_factory=NullTranslations, compare=False)
    digest: str = ""
    reviewed: str | None = None

    @property
    def direction(self) -> str:
        """Which way it is written, as HTML says it."""
        return "rtl" if self.code.partition("-")[0].lower() in _RIGHT_TO_LEFT else "ltr"


def language(code: str, catalogues: Path | None) -> Language:
    """Return a language with its phrases: the museum's own, then those that travel with Kouros, and else English.

    Parameters
    ----------
    catalogues : Path or None
        The folder of the museum's catalogues; None where the settings name none.

    Returns
    -------
    Language

    Raises
    ------
    ReportError
        For a language without any catalogue, or with a damaged one.
    """
    tag = code.replace("_", "-")
    locale = tag.replace("-", "_")
    try:
        # Not by `gettext.translation`: it reads a file once in the life of a process, whatever becomes of it.
        files = find(DOMAIN, str(catalogues), [locale], all=True) if catalogues is not None else []
        contents = [Path(file).read_bytes() for file in files]
        read = [GNUTranslations(BytesIO(content)) for content in contents]
        for content in contents:
            _check(content, code)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise ReportError(
            f"the catalogue of {code!r} in {catalogues} is damaged ({error}); compile it again"
        ) from error
    shipped = _shipped(locale)
    if not read and shipped is None and locale.partition("_")[0].lower() != "en":
        if catalogues is None:
            raise ReportError(
                f"[report] language is {code!r}: no catalogue of it travels with Kouros ({', '.join(languages())} do), "
                "and [report] catalogues names no folder: name it"
            )
        raise ReportError(
            f"there is no {catalogues / locale / 'LC_MESSAGES' / f'{DOMAIN}.mo'}; compile the catalogue, "
            "or correct [report] language and catalogues"
        )
    if shipped is not None:
        contents.append(shipped)
        read.append(GNUTranslations(BytesIO(shipped)))
    phrases: NullTranslations = read[0] if read else NullTranslations()
    for more in read[1:]:
        phrases.add_fallback(more)
    reviewed = None if shipped is None else read[-1].info().get(SIGNED.lower(), "").strip()
    return Language(tag, phrases, sha256(b"".join(contents)).hexdigest() if contents else "", reviewed)


def languages() -> list[str]:
    """Return the languages whose catalogues travel with Kouros."""
    return sorted(file.parents[1].name for file in _CATALOGUES.glob(f"*/LC_MESSAGES/{DOMAIN}.po"))


_CATALOGUES = resource("templates").joinpath("catalogues")


@lru_cache
def _shipped(locale: str) -> bytes | None:
    """Return the catalogue of a language that travels with Kouros, compiled; None where there is none."""
    # Babel and its data take a third of a second, which English need not wait for.
    from babel.messages.mofile import write_mo
    from babel.messages.pofile import read_po

    for name in (locale, locale.partition("_")[0]):
        file = _CATALOGUES / name / "LC_MESSAGES" / f"{DOMAIN}.po"
        if name.isidentifier() and file.is_file():
            made = BytesIO()
            with file.open("rb") as text:
                write_mo(made, read_po(text, locale=name))
            return made.getvalue()
    return None


def parted(parts: Iterable[str]) -> str:
    """Return the parts of a sentence with what parts them in the language: in Greek ";" asks."""
    return _("; ").join(parts)


_NAMES = re.compile(r"%\((\w+)\)s|\{(\w+)\}")


def _check(content: bytes, code: str) -> None:
    # By Babel: what gettext keeps of a catalogue has no plurals, which may name what the singular does not.
    from babel.messages.mofile import read_mo

    for message in read_mo(BytesIO(content)):
        phrases, translations = (
            [text] if isinstance(text, str) else list(text or ()) for text in (message.id, message.string)
        )
        known = {name for phrase in phrases for name in _NAMES.findall(phrase)} | {("count", "")}
        for told in translations if any(phrases) else ():
            unknown = {*_NAMES.findall(told)} - known
            if unknown:
                names = ", ".join(sorted(a or b for a, b in unknown))
                raise ReportError(
                    f"the catalogue of {code!r} translates {phrases[0]!r} by {told!r}, which asks for {names}: "
                    "use only the names of the phrase itself"
                )


@contextmanager
def speaking(chosen: Language) -> Iterator[None]:
    """Look all phrases up in this language, until the end of the block."""
    phrases, tag = _PHRASES.set(chosen.phrases), _TAG.set(chosen.code)
    try:
        yield
    finally:
        _PHRASES.reset(phrases)
        _TAG.reset(tag)


def local(number: str) -> str:
    """Return a number as the reader's language writes it: "2,000.5" is "2.000,5" in Italian."""
    tag = _TAG.get()
    return number if tag == "en" else number.translate(_marks(tag))


_DAY = len("2026-03-01")


def moment(text: str) -> str:
    """Return a time, ISO 8601, to the minute, or a day, as the reader's language writes it; in English as it is."""
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        return text
    tag = _TAG.get()
    if _locale(tag) is None or tag.partition("-")[0] == "en":
        return text if len(text) == _DAY else f"{when:%Y-%m-%d %H:%M}"
    from babel.dates import format_date, get_datetime_format

    day = str(format_date(when, "medium", locale=_locale(tag)))
    if len(text) == _DAY:
        return day
    # "{1}, {0}" in most languages, "{1} {0}" in Japanese.
    return str(get_datetime_format("medium", locale=_locale(tag))).replace("{1}", day).replace("{0}", f"{when:%H:%M}")


@lru_cache
def _locale(tag: str) -> "Locale | None":
    """Return what Babel knows of a language; None where it does not know it."""
    from babel import Locale, UnknownLocaleError

    try:
        return Locale.parse(tag, sep="-")
    except (UnknownLocaleError, ValueError):
        return None


@lru_cache
def _marks(tag: str) -> dict[int, str]:
    """Return what stands for the decimal point, and for the comma between thousands."""
    from babel.numbers import get_decimal_symbol, get_group_symbol

    locale = _locale(tag)
    if locale is None:
        return {}
    return {ord("."): get_decimal_symbol(locale), ord(","): get_group_symbol(locale)}


def _(phrase: str) -> str:
    """Return a phrase in the reader's language; "" stays "" (a catalogue keeps its own header there)."""
    phrases = _PHRASES.get()
    return phrase if phrases is None or not phrase else phrases.gettext(phrase)


def ngettext(one: str, many: str, number: int) -> str:
    """Return the phrase for a number of things in the reader's language."""
    phrases = _PHRASES.get()
    return (one if number == 1 else many) if phrases is None else phrases.ngettext(one, many, number)


_PARTS = (re.compile(r"(?<=[.!?]) "), re.compile(r"(?<=[;:]) "))
"""Where texts are put together: of sentences, and these of clauses."""

_TOGETHER = 3
"""Sentences, or clauses, that one phrase of a catalogue has at most."""


def said(text: str, parts: Sequence[re.Pattern[str]] = _PARTS) -> str:
    """Return a text of the run (a title, sentences with placeholders) in the reader's language.

    The whole text is looked up first, then sentence by sentence, for the models put theirs together, then their
    clauses.
    """
    if type(_PHRASES.get()) in (NullTranslations, type(None)):
        # English: nothing to look up in the many texts of a page.
        return text
    whole = _(text)
    if whole != text or not parts:
        return whole
    left, told = parts[0].split(text), []
    while left:
        # A phrase may have several sentences: the longest that a catalogue has is said as one.
        for many in range(min(len(left), _TOGETHER), 1, -1):
            phrase = " ".join(left[:many])
            if (known := _(phrase)) != phrase:
                told.append(known)
                del left[:many]
                break
        else:
            told.append(said(left.pop(0), parts[1:]))
    return " ".join(told)
