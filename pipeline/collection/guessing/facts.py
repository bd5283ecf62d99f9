"""Whether a table has one row for each fact of an object, told from its first rows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from pipeline.collection.guessing.long_rows import VALUES
from pipeline.collection.guessing.names import named, plain, unit_in
from pipeline.collection.sources.facts import FactRows

_FEWEST_FIELDS, _FEWEST_OBJECTS = 3, 2
"""Known fields and objects from which rows are taken for facts (judgement)."""
_MOST_OF = 0.5
"""Share of the names of fields that must be known (judgement)."""
_ONCE = 0.9
"""Share of the rows that must be the first of their object and field (judgement)."""
_SIZES = frozenset({"height_m", "width_m", "depth_m", "length_m", "diameter_m", "mass_kg"})
_VALUES = VALUES | {"content", "text", "data", "inhalt", "contenu", "contenuto", "contenido", "conteudo", "inhoud"}
_LONGEST = 60
"""Characters of the name of a field."""


def facts_of(rows: Sequence[Sequence[str]], head: int) -> FactRows | None:
    """Return which columns tell the facts of objects, where each has a row.

    That is where the texts of one column are names of fields, not of sizes alone, each again with other objects, and
    the column before it says of which object.

    Parameters
    ----------
    rows : sequence of sequence of str
        The first ones of the table.
    head : int
        Which of them names the columns.

    Returns
    -------
    FactRows or None
    """
    if not head < len(rows) - 1:
        return None
    names = [cell.strip() for cell in rows[head]]
    below = [[cell.strip() for cell in row] for row in rows[head + 1 :] if len(row) >= len(names)]
    if len(names) < 3 or len(set(names)) < len(names):
        return None
    for at in range(1, len(names) - 1):
        said = [row[at] for row in below]
        if not _names_fields(said):
            continue
        for of in range(at):
            pairs = Counter(zip(_filled_down([row[of] for row in below]), said, strict=True))
            objects = {number for number, _ in pairs}
            if "" not in objects and len(objects) >= _FEWEST_OBJECTS and len(pairs) >= _ONCE * len(below):
                behind = names[at + 1 :]
                value = next((name for name in behind if plain(name) in _VALUES), behind[0])
                return FactRows(object=names[of], field=names[at], value=value)
    return None


def _names_fields(texts: Sequence[str]) -> bool:
    """Whether texts are names of fields that come again, some of them of more than sizes."""
    names = {*texts} - {""}
    unnamed = texts.count("") > (1.0 - _ONCE) * len(texts)
    if unnamed or not _FEWEST_FIELDS <= len(names) <= _MOST_OF * len(texts) + 1:
        return False
    meant = [named(unit_in(name)[0]) for name in names if len(name) <= _LONGEST]
    known = {one.field for one in meant if one is not None}
    return (
        len(known) >= _FEWEST_FIELDS
        and sum(one is not None for one in meant) >= _MOST_OF * len(names)
        and bool(known - _SIZES)
    )


def _filled_down(cells: Sequence[str]) -> list[str]:
    above = ""
    return [above := cell or above for cell in cells]
