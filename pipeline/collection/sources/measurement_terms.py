"""Meanings of words and concept addresses in files: kinds of measurements, parts of an object, units."""

from __future__ import annotations

from functools import lru_cache
from unicodedata import normalize

from pipeline.collection.dimensions.lexicon import ALIKE, meanings, unit_words


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


KINDS: dict[str, frozenset[str]] = {
    "height": _words(
        "height h höhe hauteur altezza altura alto hoogte korkeus höjd højde høyde hojde hoejde înălțime înălţime "
        "inaltime 高さ 高"
    ),
    "width": _words(
        "width w breadth breite largeur larghezza anchura ancho largura breedte leveys bredd bredde "
        "lățime lăţime latime 幅 横 巾"
    ),
    "depth": _words(
        "depth tiefe profondeur profondità profundidad fondo profundidade diepte syvyys djup dybde "
        "adâncime adancime 奥行 奥行き"
    ),
    "length": _words(
        "length länge longueur lunghezza longitud largo comprimento lengte pituus längd længde lengde lungime 長さ 縦"
    ),
    "diameter": _words(
        "diameter diam ø durchmesser diamètre diametro diámetro diâmetro doorsnede doorsnee halkaisija diametru 径 直径"
    ),
    "thickness": _words(
        "thickness dicke stärke épaisseur spessore grosor espesor espessura dikte paksuus tjocklek tykkelse "
        "grosime 厚さ"
    ),
    "circumference": _words(
        "circumference umfang circonférence circonferenza circunferencia omtrek ympärysmitta omkrets omkreds "
        "circunferência circumferință 周"
    ),
    "weight": _words("weight mass gewicht masse poids peso massa paino vikt vægt vekt greutate 重さ 重量"),
}
"""Kind of measurement -> its names: English, German, French, Italian, Spanish, Portuguese, Dutch, Finnish, Swedish,
Danish, Norwegian, Romanian, Japanese. One letter that means two things (L, D, B) is left out."""

KIND_CONCEPTS: dict[str, str] = {
    "300055644": "height",
    "300055647": "width",
    "300072633": "depth",
    "300055645": "length",
    "300055624": "diameter",
    "300055646": "thickness",
    "300055623": "circumference",
    "300056240": "weight",
    "Q208826": "height",
    "Q35059": "width",
    "Q36253": "length",
    "Q37221": "diameter",
    "Q25288": "weight",
    "Q11423": "weight",
}
"""Concept of the Art & Architecture Thesaurus or of Wikidata -> kind of measurement."""

UNIT_CONCEPTS: dict[str, str] = {
    "300379097": "mm",
    "300379098": "cm",
    "300379100": "in",
    "300379101": "ft",
    "300379225": "g",
    "300379226": "kg",
    "Q174789": "mm",
    "Q174728": "cm",
    "Q11573": "m",
    "Q218593": "in",
    "Q41803": "g",
    "Q11570": "kg",
}
"""Concept -> unit, for files that give no word for it."""

PARTS: dict[str, frozenset[str]] = {
    "": _words(
        "overall total whole complete object gesamt gesamtmaß gesamtmaße objekt objektmaß ensemble totale complessivo "
        "volledig geheel totaal compleet helhet kokonaisuus conjunto todo ansamblu sheet blatt blattmaß blad bladmål "
        "bladmaal feuille foglio hoja folha canvas leinwand doek doekmaat paneel netto nettomål nettomaal 全体 本体"
    ),
    "base": _words("base plinth pedestal sockel sockelmaß socle basamento peana pedestal sokkel jalusta"),
    "frame": _words("frame rahmen rahmenmaß rahmenaußenmaß cadre cornice marco moldura lijst ram ramme kehys"),
}
"""Part that is measured ("" the object itself) -> its names in extentMeasurements."""

UNITS: dict[str, str] = {
    "mm": "mm",
    "millimetre": "mm",
    "millimeter": "mm",
    "millimètre": "mm",
    "millimetro": "mm",
    "milímetro": "mm",
    "cm": "cm",
    "cms": "cm",
    "centimetre": "cm",
    "centimeter": "cm",
    "zentimeter": "cm",
    "centimètre": "cm",
    "centimetro": "cm",
    "centímetro": "cm",
    "centimetru": "cm",
    "m": "m",
    "metre": "m",
    "meter": "m",
    "mètre": "m",
    "metro": "m",
    "metru": "m",
    "in": "in",
    "inch": "in",
    "inche": "in",
    '"': "in",
    "zoll": "in",
    "pouce": "in",
    "pollice": "in",
    "pulgada": "in",
    "ft": "ft",
    "foot": "ft",
    "feet": "ft",
    "kg": "kg",
    "kilogram": "kg",
    "kilogramm": "kg",
    "kilogramme": "kg",
    "kilo": "kg",
    "chilogrammo": "kg",
    "kilogramo": "kg",
    "g": "g",
    "gr": "g",
    "gram": "g",
    "gramm": "g",
    "gramme": "g",
    "grammo": "g",
    "gramo": "g",
    "lb": "lb",
    "pound": "lb",
    "libra": "lb",
    "oz": "oz",
    "ounce": "oz",
    "センチ": "cm",
    "ミリ": "mm",
}
"""Word -> unit; a plural's last letter does not count."""

KIND_OF = {name.casefold(): kind for kind, names in KINDS.items() for name in names}
"""Word -> kind, in small letters."""

PART_OF = {name.casefold(): part for part, names in PARTS.items() for name in names}
"""Word -> part, in small letters."""

_SHOWN = _words("display displayed overall total gesamt totale max maximum maximal (x) (y) (z)")


def plain_word(text: str) -> str:
    """Return a word as the tables here have it: no capitals, no marks around it."""
    return normalize("NFC", text).casefold().strip(" .:;,()[]")


def kind_of(text: str) -> str | None:
    """Return the kind of measurement that a text names, such as "Höhe" or "overall height"; None for none.

    Parameters
    ----------
    text : str
        In any of the languages of KINDS.

    Returns
    -------
    str or None
        A key of KINDS.
    """
    whole = plain_word(text)
    if whole in KIND_OF:
        return KIND_OF[whole]
    words = [word for word in map(plain_word, whole.split()) if word and word not in _SHOWN and word not in "xyz"]
    return KIND_OF.get(words[0]) or _spoken(words[0]) if len(words) == 1 else None


def kind_within(text: str) -> tuple[str, str] | None:
    """Return the kind of measurement that a text names, and what else it says: "Sheet Height" as ("height", "sheet").

    Parameters
    ----------
    text : str
        In any of the languages of KINDS.

    Returns
    -------
    (str, str) or None
        None where neither the whole, nor its last or first word, names a kind.
    """
    whole = kind_of(text)
    if whole is not None:
        return whole, ""
    words = [word for word in map(plain_word, text.split()) if word]
    if len(words) < 2:
        return None
    for word, others in ((words[-1], words[:-1]), (words[0], words[1:])):
        kind = kind_of(word)
        if kind is not None:
            return kind, " ".join(others)
    return None


def _spoken(word: str) -> str | None:
    """Return the kind that a word names in dimension texts of any language; a letter may name anything."""
    meant, kind = meanings().get(word.translate(ALIKE).casefold(), ("", ""))
    return kind if meant == "dimension" and len(word) > 1 and kind in KINDS else None


def part_of(text: str) -> str | None:
    """Return the part that a text names: "" the object itself, "base", "frame"; None for any other.

    Parameters
    ----------
    text : str
        In any of the languages of PARTS; an empty one is the object itself.

    Returns
    -------
    str or None
        A key of PARTS.
    """
    whole = plain_word(text)
    return "" if not whole else PART_OF.get(whole)


@lru_cache(maxsize=1024)
def unit_of(text: str) -> str | None:
    """Return the unit that a text names, such as "Centimeters (Measurements)"; None for none.

    Parameters
    ----------
    text : str
        A word or a sign.

    Returns
    -------
    str or None
        A key of LENGTHS or MASSES.
    """
    whole = normalize("NFC", text).casefold().partition("(")[0].strip(" .:;,[])")
    known = UNITS.get(whole) or UNITS.get(whole.rstrip("s")) or UNITS.get(whole.removesuffix("i") + "o")
    if known is None and (unit := unit_words().get(whole.translate(ALIKE))) is not None and unit.name in UNITS:
        return unit.name
    length, slash, _ = whole.partition("/")
    if known is None and slash and length:
        return unit_of(length)  # "Inches/ounces": of lengths and of weights, in this order
    return known
