"""Meanings of words in LIDO files: events, former repositories, languages."""

from __future__ import annotations


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


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
