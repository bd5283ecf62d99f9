"""Greek and Cyrillic words in Latin letters, as they stand where a system takes no others: "vysota", "ypsos"."""

from unicodedata import normalize

_PASSPORT = {
    **dict(zip("абвгдеёзийклмнопрстуфыэіґўјћ", "abvgdeeziyklmnoprstufyeigujc", strict=True)),
    **{
        "ж": "zh",
        "х": "kh",
        "ц": "ts",
        "ч": "ch",
        "ш": "sh",
        "щ": "shch",
        "ъ": "",
        "ь": "",
        "ю": "yu",
        "я": "ya",
        "ї": "yi",
        "є": "ye",
        "ђ": "dj",
        "љ": "lj",
        "њ": "nj",
        "џ": "dz",
        "ѓ": "gj",
        "ќ": "kj",
        "ѕ": "dz",
    },
}
"""As passports and the names of columns mostly have it."""
_SCHOLARS = {**_PASSPORT, "х": "h", "ц": "c", "й": "j", "ю": "ju", "я": "ja", "щ": "sc", "ж": "z", "ч": "c", "ш": "s"}
"""As libraries have it, without the marks of its letters."""
_GREEK = {**dict(zip("αβγδεζηικλμνξοπρσςτυφω", "avgdeziiklmnxoprsstyfo", strict=True)), "θ": "th", "χ": "ch", "ψ": "ps"}
_FEWEST = 3
"""Letters from which a word in Latin letters is hardly one of another language."""


def romanized(word: str) -> tuple[str, ...]:
    """Return how a word is written in Latin letters, in each of the ways that are usual; () where it is so already.

    Parameters
    ----------
    word : str
        In small letters; with Chinese or Arabic ones it is left.
    """
    # Accents of Greek vowels go; the short i and the io of Russian are letters of their own.
    word = "".join(one if one in _PASSPORT else normalize("NFD", one)[0] for one in normalize("NFC", word))
    out = []
    for letters in (_PASSPORT, _SCHOLARS, _GREEK):
        if any(one in letters for one in word):
            latin = "".join(letters.get(one, one) for one in word)
            if latin.isascii() and sum(map(str.isalpha, latin)) >= _FEWEST:
                # Without its mark the short i of Russian is an i: "inventarnyj", "inventarnyy", "inventarny".
                out += [latin, *(latin.replace("yi", ending) for ending in ("yj", "yy", "y"))]
    return tuple(dict.fromkeys(out))
