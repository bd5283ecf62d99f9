"""Meanings of words and concept addresses in LIDO files: kinds of measurements, parts of an object, units, events."""

from __future__ import annotations


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


KINDS: dict[str, frozenset[str]] = {
    "height": _words("height h höhe hauteur altezza altura alto hoogte korkeus höjd højde høyde"),
    "width": _words("width w breadth breite largeur larghezza anchura ancho largura breedte leveys bredd bredde"),
    "depth": _words("depth tiefe profondeur profondità profundidad fondo profundidade diepte syvyys djup dybde"),
    "length": _words("length länge longueur lunghezza longitud largo comprimento lengte pituus längd længde lengde"),
    "diameter": _words("diameter diam ø durchmesser diamètre diametro diámetro diâmetro doorsnede halkaisija"),
    "thickness": _words(
        "thickness dicke stärke épaisseur spessore grosor espesor espessura dikte paksuus tjocklek tykkelse"
    ),
    "circumference": _words(
        "circumference umfang circonférence circonferenza circunferencia omtrek ympärysmitta omkrets omkreds"
    ),
    "weight": _words("weight mass gewicht masse poids peso massa paino vikt vægt vekt"),
}
"""Kind of measurement -> its names: English, German, French, Italian, Spanish, Portuguese, Dutch, Finnish, Swedish,
Danish, Norwegian. One letter that means two things (L, D, B) is left out."""

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
        "volledig geheel totaal helhet kokonaisuus"
    ),
    "base": _words("base plinth pedestal sockel sockelmaß socle basamento peana pedestal sokkel jalusta"),
    "frame": _words("frame rahmen rahmenmaß rahmenaußenmaß cadre cornice marco moldura lijst ram ramme kehys"),
}
"""Part that is measured ("" the object itself) -> its names in extentMeasurements."""

PRODUCTION = _words(
    "production creation making herstellung schöpfung anfertigung création fabrication produzione creazione producción "
    "creación vervaardiging valmistus tillverkning fremstilling lido00007 lido00012"
)
"""Events in which an object was made."""

FORMER = _words("former previous ehemalig früher ancien")
"""What marks a repository that an object has left."""

LANGUAGES = {
    "eng": "en",
    "deu": "de",
    "ger": "de",
    "fra": "fr",
    "fre": "fr",
    "ita": "it",
    "spa": "es",
    "por": "pt",
    "nld": "nl",
    "dut": "nl",
    "fin": "fi",
    "swe": "sv",
    "dan": "da",
    "nor": "no",
}
"""Languages by three letters -> by two."""
