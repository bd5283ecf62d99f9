"""Words for materials in names and titles: which there are, and whether a text names nothing else."""

from __future__ import annotations

import re
from functools import cache

from pipeline.tables import table
from pipeline.tables.rows import unmarked

_WORD = re.compile(r"[^\W_]+")
_PART = re.compile(r"[,;:.()\[\]|/]|\s[-\u2013\u2014]\s")
_BESIDE = frozenset(
    {
        *("and", "on", "with", "over", "und", "auf", "mit", "et", "sur", "avec", "e", "ed", "su", "con", "y", "sobre"),
        *("en", "op", "met", "com", "i", "z", "na", "s", "a", "и", "на", "с", "και", "σε", "of", "in", "de", "di", "d"),
        *(
            "aus",
            "em",
            "van",
            "made",
            "cast",
            "carved",
            "gilt",
            "gilded",
            "painted",
            "glazed",
            "turned",
            "blown",
            "cut",
        ),
        *("polychrome", "polychromed", "patinated", "enamelled", "enameled", "lacquered", "solid", "sheet", "wrought"),
        *("parcel", "plate", "plated", "sterling", "white", "black", "red", "blue", "green", "grey", "gray", "brown"),
        *("vergoldet", "bemalt", "gefasst", "geschnitzt", "glasiert", "gegossen", "weiss", "schwarz", "rot"),
        *("dore", "doree", "peint", "peinte", "sculpte", "patine", "polychrome", "blanc", "noir", "argente", "moule"),
        *("dorato", "dorata", "dipinto", "dipinta", "intagliato", "policromo", "scolpito", "bianco", "nero"),
        *("dorado", "dorada", "pintado", "pintada", "tallado", "tallada", "policromado", "policromada", "blanco"),
        *("verguld", "beschilderd", "gesneden", "dourado", "dourada", "entalhado", "entalhada"),
    }
)
"""Words, folded, that stand beside a material and say how it was worked, which colour it has, or that there are two."""

_SHORT = 3
"""Letters up to which a word without its accents is rather another one."""
_OTHERWISE = frozenset({"baker", "leter", "vang"})
"""Longer ones that are names, or other words."""


def folded(text: str) -> str:
    """Return a text without capitals and accents."""
    return unmarked(text).casefold()


@cache
def material_words() -> dict[str, str]:
    """Return the words for materials, folded, with the row of materials.csv of each.

    Phrases are left out, and what without its accents is another word or a name: sứ, lụa, āda, bakër.
    """
    return {
        plain: row["material"]
        for row in table("materials")
        for word in row["words"].split("|")
        if word
        and " " not in word
        and word[0] != "="
        and ((plain := folded(word)) == word.casefold() or (len(plain) > _SHORT and plain not in _OTHERWISE))
    }


@cache
def _phrases() -> re.Pattern[str]:
    words = {folded(word) for row in table("materials") for word in row["words"].split("|") if re.search(r"[ -]", word)}
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, sorted(words, key=len, reverse=True)))})\b")


def is_material(text: str) -> bool:
    """Say whether a text names materials and nothing else: "gilt bronze", "Eiche, bemalt", and not "bronze figure".

    Parameters
    ----------
    text : str
        A part of a name or title, without the marks that part it from others.
    """
    plain = folded(text)
    rest = _phrases().sub(" ", plain)
    words = _WORD.findall(rest)
    named = rest != plain or not material_words().keys().isdisjoint(words)
    return named and all(word in _BESIDE or word in material_words() for word in words)


def begins_with_material(text: str) -> bool:
    """Say whether the first part of a text names a material and no thing: "Silver, London 1812"."""
    return is_material(_PART.split(text.strip(), maxsplit=1)[0])
