"""Units as the heads of tables spell them: of accelerations, of what is none, and of time."""

from __future__ import annotations

import re

from pipeline.motions.formats.trace_headers import FACTORS

SECONDS = {
    "s": 1.0,
    "sec": 1.0,
    "secs": 1.0,
    "second": 1.0,
    "seconds": 1.0,
    "ms": 0.001,
    "msec": 0.001,
    "seg": 1.0,
    "sn": 1.0,
    "с": 1.0,
    "сек": 1.0,
    "秒": 1.0,
}
"""How many seconds one of each unit of time is."""

_OTHERS = {
    **dict.fromkeys(("m/s", "cm/s", "mm/s", "in/s", "kine", "nm/s"), "velocity"),
    **dict.fromkeys(("m", "cm", "mm", "in", "nm"), "displacement"),
    **dict.fromkeys(("count", "counts", "digitalcounts"), "counts"),
}
_ALIKE = {
    "gals": "gal",
    **{
        f"{length}{spelt}": f"{length}/s2"
        for length in ("m", "cm", "mm", "nm", "in", "ft")
        for spelt in ("/s/s", "/ss", "s-2", ".s-2", "/s-2", "/sn2")
    },
    "g's": "g",
    **dict.fromkeys(("pctg", "percentg", "percentofg", "g%", "%ofg"), "%g"),
    "м/с2": "m/s2",
    "см/с2": "cm/s2",
    "гал": "gal",
    "ガル": "gal",
    **dict.fromkeys(("milli-g", "millig"), "mg"),
}


def unit_of(word: str) -> tuple[str, str]:
    """Return what a unit is of, and how it is called here.

    Parameters
    ----------
    word : str
        Such as "cm/sec**2", "m/s²", "G", "cm/s".

    Returns
    -------
    (str, str)
        "acceleration" and one of `trace_headers.FACTORS`; "velocity", "displacement" or "counts" and the word; "" and
        "" for what is no unit.
    """
    plain = re.sub(r"\s|\^|\*+|·", "", word.strip().lower().rstrip("."))
    plain = plain.replace("²", "2").replace("⁻", "-").replace("sec", "s")
    plain = _ALIKE.get(plain, plain)
    if plain in FACTORS:
        return "acceleration", plain
    return (_OTHERS[plain], plain) if plain in _OTHERS else ("", "")


def seconds(word: str | None) -> float:
    """How many seconds one of a unit of time is; 1 for what is none, or left out."""
    return SECONDS.get((word or "").strip().lower(), 1.0)
