"""The language of the pages: phrases are English in the code, and looked up in the museum's catalogue when shown."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from gettext import GNUTranslations, NullTranslations, find
from hashlib import sha256
from io import BytesIO
from pathlib import Path

from pipeline.report.errors import ReportError

DOMAIN = "kouros"
"""The name of a catalogue: <folder>/<language>/LC_MESSAGES/kouros.mo."""

_RIGHT_TO_LEFT = ("ar", "fa", "he", "ur", "yi")

# The language holds for the rendering of one report, in the thread that renders it; nothing outlives that.
_PHRASES: ContextVar[NullTranslations | None] = ContextVar("phrases", default=None)


@dataclass(frozen=True, slots=True)
class Language:
    """A language of the pages; English, which needs no catalogue, where nothing is said.

    code   : a language tag, such as "it" or "pt-BR"
    digest : of its catalogues; "" where there is none
    """

    code: str = "en"
    phrases: NullTranslations = field(default_factory=NullTranslations, compare=False)
    digest: str = ""

    @property
    def direction(self) -> str:
        """Which way it is written, as HTML says it."""
        return "rtl" if self.code.partition("-")[0].lower() in _RIGHT_TO_LEFT else "ltr"


def language(code: str, catalogues: Path | None) -> Language:
    """Return a language with its phrases; what a catalogue lacks stays English.

    catalogues : the folder of the catalogues; None where the settings name none
    raises     : ReportError for another language than English without a catalogue, or with a damaged one
    """
    tag = code.replace("_", "-")
    if catalogues is None:
        if tag.partition("-")[0].lower() == "en":
            return Language(tag)
        raise ReportError(f"[report] language is {code!r}, and [report] catalogues names no folder: name it")
    locale = tag.replace("-", "_")
    try:
        # Not by `gettext.translation`: it reads a file once in the life of a process, whatever becomes of it.
        contents = [Path(file).read_bytes() for file in find(DOMAIN, str(catalogues), [locale], all=True)]
        read = [GNUTranslations(BytesIO(content)) for content in contents]
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise ReportError(
            f"the catalogue of {code!r} in {catalogues} is damaged ({error}); compile it again"
        ) from error
    if not read and locale != "en":
        raise ReportError(
            f"there is no {catalogues / locale / 'LC_MESSAGES' / f'{DOMAIN}.mo'}; compile the catalogue, "
            "or correct [report] language and catalogues"
        )
    phrases: NullTranslations = read[0] if read else NullTranslations()
    for more in read[1:]:
        phrases.add_fallback(more)
    _check(phrases, code)
    return Language(tag, phrases, sha256(b"".join(contents)).hexdigest() if contents else "")


_NAMES = re.compile(r"%\((\w+)\)s|\{(\w+)\}")


def _check(phrases: NullTranslations, code: str) -> None:
    # gettext offers no other way to look at a whole catalogue; NullTranslations has none.
    catalogue: dict[str | tuple[str, int], str] = getattr(phrases, "_catalog", {})
    for key, told in catalogue.items():
        phrase = key if isinstance(key, str) else key[0]
        unknown = {*_NAMES.findall(told)} - {*_NAMES.findall(phrase), ("count", "")} if phrase else set()
        if unknown:
            names = ", ".join(sorted(a or b for a, b in unknown))
            raise ReportError(
                f"the catalogue of {code!r} translates {phrase!r} by {told!r}, which asks for {names}: "
                "use only the names of the phrase itself"
            )


@contextmanager
def speaking(chosen: Language) -> Iterator[None]:
    """Look all phrases up in this language, until the end of the block."""
    token = _PHRASES.set(chosen.phrases)
    try:
        yield
    finally:
        _PHRASES.reset(token)


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
    return " ".join(said(part, parts[1:]) for part in parts[0].split(text))
