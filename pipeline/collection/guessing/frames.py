"""Names of columns of sizes that say whether the frame counts: "Framed H (in)", "Image width", "Höhe mit Rahmen"."""

from __future__ import annotations

import re

_FRAMED = re.compile(
    r"(?:^|[\s(\[,_-])(?:(?:with|in|incl\.?|including|mit|inkl\.?|avec|con|com|met|med|z|s|в|с|με) )?"
    r"(?:framed?|outer frame|Rahmen|gerahmt|cadre|encadrée?|cornice|incorniciat[oa]|marco|enmarcad[oa]"
    r"|moldura|emoldurad[oa]|lijst|ingelijst|ramme|ramą|rámem|раме|рамой|рамкой|çerçeveli|κορνίζα|額寸?|額装|フレーム)(?=$|[\s)\],_-])",
    re.IGNORECASE,
)
_UNFRAMED = re.compile(
    r"(?:^|[\s(\[,_-])(?:(?:without|w/o|excl\.?|ohne|sans|senza|sin|sem|zonder|uden|uten|utan|bez|без|χωρίς) "
    r"(?:the )?(?:frame|Rahmen|cadre|cornice|marco|moldura|lijst|ramme|ram|ramy|rámu|рамы|рамки|κορνίζα)"
    r"|unframed|image|sheet|sight|canvas|support|plate|ungerahmt|Blatt|Bild|Leinwand|toile|feuille|tela|foglio|lienzo"
    r"|hoja|çerçevesiz|画面|本紙)(?=$|[\s)\],_-])",
    re.IGNORECASE,
)
"""What a picture is without its frame, which is looked for first: "without frame" has the frame in it."""
_LETTERS = {"h": "height", "w": "width", "b": "width", "d": "depth", "t": "depth", "p": "depth"}


def without_frame(name: str) -> tuple[str, bool] | None:
    """Return the name of a size without what it says of a frame, and whether the frame counts.

    Parameters
    ----------
    name : str
        Of a column, without its unit: "Framed H", "Image Height", "Largeur avec cadre".

    Returns
    -------
    (str, bool) or None
        ("height", True); None for a name that says nothing of frames, or nothing else.
    """
    for pattern, framed in ((_UNFRAMED, False), (_FRAMED, True)):
        found = pattern.search(name)
        if found is not None:
            rest = f"{name[: found.start()]} {name[found.end() :]}".strip(" ()[],_-.")
            return (_LETTERS.get(rest.casefold(), rest), framed) if rest else None
    return None


def frame_counts(name: str) -> bool | None:
    """Return whether sizes of a column are with the frame; None where its name says nothing of that.

    Parameters
    ----------
    name : str
        Of a column: "Framed (cm)".

    Returns
    -------
    bool or None
    """
    return False if _UNFRAMED.search(name) else True if _FRAMED.search(name) else None
