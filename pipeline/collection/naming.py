"""What a thing is called: its title, behind what it is where the title alone does not say so."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from pipeline.collection.dimensions.structured import words_of
from pipeline.collection.mapping import ColumnMap
from pipeline.tables.material_words import begins_with_material, folded, material_words
from pipeline.tables.rows import UNSPACED
from pipeline.tables.word_lists import names_of_things

_WORD = re.compile(r"[^\W\d_]+")
_DATED = re.compile(r"\W*(?:(?:c|ca|circa|um|vers|about|verso|hacia)\b\W*)?\d{1,4}\b[^,;:]{0,40}\Z", re.IGNORECASE)
"""A title that is no more than a year or a century: "1812", "c. 1690", "17th century"."""
_HEAD = re.compile(
    r"[,;:(\u2013]|\s-\s|(?<=\w)\s+(?:with|without|for|from|by|in|showing|made|decorated|painted|mit|ohne|aus|für|avec|sans"
    r"|pour|con|senza|per|sin|para|com|sem|met|zonder|voor|med|uten|utan|za|ze|se|bez)\s",
    re.IGNORECASE,
)
"""What ends the part of a title in which its thing is named."""

_COUNTED = re.compile(
    r"\A(?:(?:an?|the|one|two|three|four|pair|set|of|ein|eine|un|une|uno|una|um|uma|een|ett)\s+)+", re.IGNORECASE
)
"""What stands before its name: "a pair of"."""

_TECHNIQUE = re.compile(
    r"\A\W*(?:oil|oils|acrylic|tempera|gouache|watercolou?rs?|pastel|ink|graphite|charcoal|pencil|crayon|olio|óleo|huile|öl"
    r"|olieverf|olej|aquarelle?|acquerello|acuarela|aquarela|tempera|ulei|масло|λάδι|油彩)\s+(?:\w+\s+){0,2}?"
    r"(?:on|su|sobre|sur|auf|op|na|pe|на|σε|à)\s+[^;.]{2,30}\Z",
    re.IGNORECASE,
)
"""A title that is no more than how a picture is made: "Oil on canvas"."""

_SHORT = 4
"""Words of such a part at the most (judgement)."""
_COMPOUND = 4
"""Letters from which the end of a word is one that its thing is called by: Teekanne, a Kanne."""


def titled(values: dict[str, Any], columns: dict[str, ColumnMap]) -> None:
    """Put what a thing is ahead of a title that does not say it: "Teapot: Silver, London 1812".

    Those are the opening of a description that names the thing in none of its words, a bare material or technique, and
    a bare date.

    Parameters
    ----------
    values : dict
        Of the record, changed in place.
    columns : dict of str to ColumnMap
        Of the mapping.
    """
    name, title = values.get("object_name") or "", values.get("title") or ""
    if not name or not title:
        return
    opening = columns["title"].opening and columns["title"].sources != columns["object_name"].sources
    technique = _TECHNIQUE.match(title) is not None
    said = re.search(rf"(?<!\w){re.escape(folded(name))}(?!\w)", folded(title)) is not None
    bare = not said and (begins_with_material(title) or technique or _DATED.match(title) is not None)
    if (technique or not _says(title, name)) if opening else bare:
        values["title"] = f"{name}: {title}"


def _says(title: str, name: str) -> bool:
    """Whether a text names a thing, or has a word by which a name calls its own; what it is made of is none."""
    if begins_with_material(title):
        return False
    if names_thing(title):
        return True
    words = [word for word in _WORD.findall(folded(name)) if word not in material_words()]
    calling = [word for word in words if word in _things()[0]] or words
    return any(
        word.startswith(one) or one.startswith(word) or (len(one) >= _COMPOUND and word.endswith(one))
        for word in calling
        for one in _WORD.findall(folded(title))
        if min(len(word), len(one)) >= _COMPOUND or word == one
    )


def names_thing(text: str) -> bool:
    """Say whether a text is a short name of a thing that is no picture: its first or its last word is one.

    Parameters
    ----------
    text : str
        A title or the opening of a description.
    """
    words, endings = _things()
    gloss = _GLOSS.fullmatch(text)
    if gloss:
        return names_thing(gloss[1]) or names_thing(gloss[2])
    said = _COUNTED.sub("", words_of(text).strip(), count=1)
    if UNSPACED.match(said):
        return folded(said).startswith(_unspaced_things())
    head = _WORD.findall(folded(_HEAD.split(said, maxsplit=1)[0]))
    if not 0 < len(head) <= _SHORT:
        return False
    return not words.isdisjoint((head[0], head[-1], " ".join(head))) or head[-1].endswith(endings)


@cache
def _unspaced_things() -> tuple[str, ...]:
    """Return the names of things in languages that put no spaces between words, and a thing's name first."""
    return tuple(word for word in _things()[0] if UNSPACED.match(word))


_GLOSS = re.compile(r"([^()]+)\(([^()]+)\)\s*")
"""A name with what it means: "Kete (basket)"."""


@cache
def _things() -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the names of things that hang flat neither on nor as a wall, and the endings of such names."""
    entries = {
        folded(entry)
        for object_class, entry in names_of_things()
        if object_class not in ("framed", "wall_painting", "installation")
    }
    endings = tuple(entry[1:] for entry in entries if entry[0] == "*")
    return frozenset(entry for entry in entries if entry[0] != "*"), endings
