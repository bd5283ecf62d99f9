"""The languages that travel with Kouros: complete, with every placeholder, and signed or said to be unreviewed."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po
from lxml import html

from pipeline.report.language import DOMAIN, language, languages
from pipeline.report.render import render
from pipeline.resources import resource

from . import builder
from .test_language import phrases

NAMES = re.compile(r"%\(\w+\)s|\{\w+\}|</?\w+[^>]*>")
LETTERS = {"el": "[Α-Ωα-ω]", "es": "[áéíóúñ]", "it": "[àèéìòù]", "ja": "[ぁ-んァ-ン]"}
"""Letters without which no page of a language is."""
FIRST = "el"
WHOLE = pytest.mark.long("test_a_catalogue_has_every_phrase_and_no_other")
LONG = pytest.mark.long("test_a_report_is_in_the_language_and_says_that_nobody_reviewed_it")


@cache
def catalogue_of(code: str) -> Catalog:
    file = resource("templates").joinpath("catalogues", code, "LC_MESSAGES", f"{DOMAIN}.po")
    with file.open("rb") as stream:
        return read_po(stream, locale=code)


def test_which_languages_there_are() -> None:
    assert languages() == sorted(LETTERS)


@pytest.mark.parametrize("code", [FIRST, *(pytest.param(code, marks=WHOLE) for code in LETTERS if code != FIRST)])
def test_a_catalogue_has_every_phrase_and_no_other(code: str) -> None:
    """Where this fails, `make catalogues` puts the new phrases into the files, and they are to be translated."""
    made = catalogue_of(code)
    there = {message.id if isinstance(message.id, str) else message.id[0] for message in made if message.id}
    assert {phrase for phrase, _plural in phrases("desk")} == there
    assert not made.obsolete
    for message in made:
        told = [message.string] if isinstance(message.string, str) else list(message.string)
        assert all(told), message.id
        assert not message.fuzzy, message.id
        if not message.id:
            continue
        ids = [message.id] if isinstance(message.id, str) else list(message.id)
        assert len(told) == (made.num_plurals if len(ids) > 1 else 1), ids
        known = set(NAMES.findall(" ".join(ids)))
        for text in told:
            names = set(NAMES.findall(text))
            # One of a thing may be said without its number, many of it never.
            assert names <= known, text
            assert len(ids) > 1 or names == known, text
        assert set(NAMES.findall(told[-1])) == known, told[-1]


@pytest.mark.parametrize("code", [FIRST, *(pytest.param(code, marks=LONG) for code in LETTERS if code != FIRST)])
def test_a_report_is_in_the_language_and_says_that_nobody_reviewed_it(code: str, tmp_path: Path) -> None:
    chosen = language(code, None)
    assert chosen.reviewed == ""
    report = render(builder.record(), tmp_path / code, language=chosen)
    unsigned = chosen.phrases.gettext(
        "These words were translated by a machine, and nobody has reviewed them yet. In doubt the English report holds."
    )
    for file in report.parent.glob("*.html"):
        page = html.fromstring(file.read_bytes().decode())
        assert page.get("lang") == code
        words = page.text_content()
        assert unsigned in words
        assert len(re.findall(LETTERS[code], words)) > 5, file


def test_numbers_are_written_as_the_languages_people_do(tmp_path: Path) -> None:
    text = render(builder.record(), tmp_path / "it", language=language("it", None)).parent
    every = "\n".join(file.read_text() for file in text.glob("*.html"))
    assert re.search(r"\d,\d+\u202f(cm|s|kg|g)\b", every)
    assert not re.search(r"(?<![\d.])\d\.\d{1,2}\u202f(cm|kg)\b", every)


@pytest.mark.parametrize("code", [FIRST, *(pytest.param(code, marks=WHOLE) for code in LETTERS if code != FIRST)])
def test_a_number_in_a_phrase_is_not_parted_from_its_unit(code: str) -> None:
    """Where a line breaks between them, "45" is followed by nothing and "min" begins the next line."""
    parted = re.compile(r"(?:\)s|\}) (?:h|min|s|km|cm|mm|m|kg|g|Hz|cm/s)(?!\w)")
    told = [text for one in catalogue_of(code) for text in (one.id, one.string)]
    texts = [text for one in told for text in ([one] if isinstance(one, str) else one)]
    assert [text for text in texts if parted.search(text)] == []
