"""Names that are nearly those of fields: misspelt ones of columns, and those of tables by their stems."""

from __future__ import annotations

from difflib import get_close_matches

from pipeline.collection.guessing.name_words import ABOUT, ELSEWHERE, OF_KEYS
from pipeline.collection.guessing.names import ColumnMeaning, column_names, plain, unit_in

_LONG = 5
"""Letters from which a name that is nearly another one is hardly a name of its own."""
_ALMOST = 0.9
"""Likeness of two such names, 1 being the same: one letter in ten."""


def misspelt(name: str) -> tuple[ColumnMeaning, str] | None:
    """Return what the name of a column would say if a letter or two of it were others, and the name that it has then.

    Parameters
    ----------
    name : str
        Of a column that says nothing as it stands: "acession_number", "dimesions".

    Returns
    -------
    (ColumnMeaning, str) or None
        None where no long name is so near.
    """
    form = plain(unit_in(name)[0])
    # "measurement_tickness": what stands before the side is no part of its name.
    words = form.split()
    form = " ".join(words[1:]) if len(words) == 2 and words[0] in ABOUT else form
    if len(form) < _LONG or ELSEWHERE.intersection(form.split()):
        return None  # "Auteur" is no "hauteur"
    # A key is no misspelt word: "classification_id" is no classification.
    last = form.split()[-1]
    known = [one for one in column_names() if len(one) >= _LONG and (last not in OF_KEYS or one.split()[-1] == last)]
    # Two letters exchanged leave the same letters, and the first one: "heigth".
    near = [one for one in known if one[0] == form[0] and sorted(one) == sorted(form)]
    near += get_close_matches(form, known, n=1, cutoff=_ALMOST)
    return (column_names()[near[0]], near[0]) if near else None


def same_stem(word: str, table: str) -> bool:
    """Whether a word is the name of a table, but for its ending and what stands before it.

    "objekt" of "tblObjekte", "category" of "categories", "room" of "collection_rooms".
    """
    words = plain(table).split()
    return any(_same("".join(words[at:]).removeprefix("tbl"), word) for at in range(len(words)) if len(words) - at <= 3)


def _same(name: str, word: str) -> bool:
    short, long = sorted((word.removesuffix("y"), name.removesuffix("ies")), key=len)
    return len(short) >= 3 and long.startswith(short) and len(long) - len(short) <= 2


def of_table(table: str, field: str) -> bool:
    """Whether the name of a table is that of a field, in the plural perhaps: "Standorte" of the gallery."""
    return any(
        found.field == field and same_stem(name.replace(" ", ""), table) for name, found in column_names().items()
    )
