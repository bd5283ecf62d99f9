"""What is assumed where a record is silent: classes, materials, friction and damping, each with range and source."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import TypeVar

from pipeline.records import Furniture
from pipeline.tables import Range, Row, TableError, read_table, table
from pipeline.tables.assumed_rows import AssumedRow, Friction, Material, ObjectClass, PairRow, WallDamping
from pipeline.tables.furniture_rows import FurnitureRow
from pipeline.tables.ideographs import shortened_signs
from pipeline.tables.rows import any_of, checked
from pipeline.tables.surface_rows import met_on, surfaces_in

UNKNOWN = "unknown"
"""The material of an object whose record names none that the table knows."""

READ = 10_000
"""Characters of a text that are searched for what a thing is, and what it is made of or stands on."""

_Assumed = TypeVar("_Assumed", bound=AssumedRow)
_Pair = TypeVar("_Pair", bound=PairRow)


@dataclass(frozen=True, eq=False)
class AssumedValues:
    """The tables of what is assumed, with the museum's rows in place of Kouros's.

    Attributes
    ----------
    classes, materials, furniture : mapping
        Rows by name, in the order of the table.
    friction, damping : tuple
        Rows in the order of the table.
    """

    classes: Mapping[str, ObjectClass]
    materials: Mapping[str, Material]
    friction: tuple[Friction, ...]
    damping: tuple[WallDamping, ...]
    furniture: Mapping[str, FurnitureRow]

    @cached_property
    def _words(self) -> tuple[tuple[re.Pattern[str], Material], ...]:
        return tuple((_named(one.words), one) for one in self.materials.values() if one.words)

    @property
    def own(self) -> dict[str, int]:
        """How many rows are the museum's, by table; those without any are left out."""
        tables = {name: getattr(self, name).values() for name in ("classes", "materials", "furniture")}
        pairs = {"friction": self.friction, "damping": self.damping}
        counts = {name: sum(bool(row.own) for row in rows) for name, rows in (tables | pairs).items()}
        return {name: count for name, count in counts.items() if count}

    def material_in(self, text: str) -> Material | None:
        """Return the material that stands first in a text.

        Parameters
        ----------
        text : str
            In the museum's words.

        Returns
        -------
        Material or None
            None where there is none.
        """
        return (_known_material if len(text) <= _SHORT else _material_in)(self, text[:READ])

    def materials_in(self, text: str) -> tuple[Material, ...]:
        """Return all materials that a text names, in the museum's words; none where there is none."""
        bare = shortened_signs(_FINISH.sub("", text))
        return tuple(one for pattern, one in self._words if pattern.search(bare))

    def friction_of(
        self, object_material: str = "", surface_material: str = "", furniture: Furniture | None = None
    ) -> tuple[Friction, ...]:
        """Return the frictions that a pair may have: all rows that are not ruled out.

        Parameters
        ----------
        object_material, surface_material : str
            An empty name rules nothing out; a name that the table does not know leaves the other one to decide.  The
            surface is told in the museum's words (surfaces.csv).
        furniture : Furniture, optional
            What it stands on or in: where no surface is told, only those count that are met there by chance.

        Returns
        -------
        tuple of Friction
            Never empty; `span` makes one range of them.

        References
        ----------
        Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage
        mitigation methods for museum objects. Studies in Conservation 36. Table 3.
        """
        told = surfaces_in(surface_material, of_surface=True)
        if surface_material.strip() and not told:
            told = (surface_material.strip().lower(),)
        rows = _matching(self.friction, (object_material.strip().lower(),) if object_material.strip() else (), told)
        if not surface_material.strip():
            by_chance = [row for row in rows if row.pair[1] in met_on()]
            there = [row for row in by_chance if row.pair[1] in met_on(furniture)]
            rows = there or by_chance
        if not object_material.strip():
            rows = [row for row in rows if row.pair[0] != "teflon"]
        return tuple(rows)

    def damping_of(self, wall_surface: str = "", back_surface: str = "") -> tuple[WallDamping, ...]:
        """Return the dampings that a painting against its wall may have: all rows that are not ruled out.

        Parameters
        ----------
        wall_surface, back_surface : str
            As in `friction_of`.

        Returns
        -------
        tuple of WallDamping
            Never empty.

        References
        ----------
        Agbabian et al. (1991), as in `friction_of`, Table 4.
        """
        wall, back = ((text.strip().lower(),) if text.strip() else () for text in (wall_surface, back_surface))
        return tuple(_matching(self.damping, wall, back))


_FINISH = re.compile(
    r"\b(?:\w+-|(?:tin|lead|salt|silver|copper|iron)\s+)(?=glaze)"
    r"|\b\w+-(?:plated|coated|painted|leafed|fired|colou?red|toned|inlaid|trimmed|mounted|lined)\b"
    r"|\b(?:gold|silver|metal|copper|aluminium)\s+(?:leaf|paint|ground|dust|foil|powder|thread|lacquer|gelatin|prints?)\b"
    r"|\b(?:glass|enamel|ceramic|porcelain)\s+eyes\b|\b(?:Blattgold|Glasaugen|feuille d'or|foglia d'oro|pan de oro)\b"
    # What is drawn or painted with lies on what the thing is made of: "ink and gold on paper".
    r"|\b(?:gold|silver|oro|argento|or|argent|plata|Silber)\b(?=\s+(?:paper|silk)\b"
    r"|(?:\W+\w+){0,4}?\W+(?:on|over|su|sur|auf|sobre)\W+(?:gold\W+|silver\W+)?(?:paper|silk|canvas|panel|wood|vellum|"
    r"parchment|linen|cotton|cloth|lacquer|Papier|Seide|Holz|Leinwand|papier|soie|bois|toile|carta|seta|legno|tela|"
    r"tavola|papel|seda|madera|lienzo)\b)"
    r"|\b(?:yeux|occhi|ojos)\s+(?:de|en|di|in)\s+(?:verre|vetro|vidrio|cristal)\b|金箔|金泥|玉眼",
    re.IGNORECASE,
)


@lru_cache(maxsize=65536)
def _named(words: Sequence[str]) -> re.Pattern[str]:
    """Return what finds any of the words for a material; one after = is all that there is between two marks: 石、木."""
    alone = [re.escape(shortened_signs(word[1:])) for word in words if word.startswith("=")]
    within = any_of(shortened_signs(word) for word in words if not word.startswith("="))
    if not alone:
        return within
    marks = r"\s、，,;；・/+と"
    return re.compile(rf"{within.pattern}|(?:(?<=[{marks}])|^)(?:{'|'.join(alone)})(?=[{marks}(（]|$)", re.IGNORECASE)


_SHORT = 200
"""Characters up to which a text is remembered: of hundreds of thousands of objects most say "oil on canvas"."""


@lru_cache(maxsize=16384)
def _known_material(values: AssumedValues, text: str) -> Material | None:
    return _material_in(values, text)


def _material_in(values: AssumedValues, text: str) -> Material | None:
    # What something is only glazed or plated with is not what it is made of: "tin-glazed earthenware" is no tin.
    bare = shortened_signs(_FINISH.sub("", text))
    found = [(match.start(), -len(match[0]), one) for pattern, one in values._words if (match := pattern.search(bare))]
    # Of two that begin there the longer one: papier-mâché is no paper.
    return min(found, key=lambda each: each[:2])[2] if found else None


def _matching(rows: Sequence[_Pair], first: Sequence[str], second: Sequence[str]) -> list[_Pair]:
    """Return the rows of the pairs; where the table lacks them, those of either partner, so that the span says so."""
    asked = [(at, names) for at, names in enumerate((first, second)) if names]
    found = [{row.pair for row in rows if row.pair[at] in names} for at, names in asked]
    known = [pairs for pairs in found if pairs]
    pair = [row for row in rows if all(row.pair in pairs for pairs in known)]
    return pair or [row for row in rows if any(row.pair in pairs for pairs in known)]


def span(rows: Sequence[PairRow]) -> Range:
    """Return the median and the span of some rows, with all their sources.

    Parameters
    ----------
    rows : sequence of PairRow
        At least one.

    Returns
    -------
    Range
    """
    values = sorted(row.value for row in rows)
    sources = "; ".join(dict.fromkeys(row.said for row in rows))
    return Range(values[(len(values) - 1) // 2], min(row.low for row in rows), max(row.high for row in rows), sources)


def tables_of(rows: Sequence[AssumedRow]) -> str:
    """Return which tables say so, in the words of a report."""
    return " and ".join(dict.fromkeys(row.table for row in rows))


@cache
def assumed() -> AssumedValues:
    """Return Kouros's own tables.

    Raises
    ------
    TableError
        For a row that cannot be used.
    """
    return assumed_with({})


def assumed_with(own: Mapping[str, Path], models: Collection[str] | None = None) -> AssumedValues:
    """Return the tables with the museum's rows in place of Kouros's of the same name, or of the same pair.

    Parameters
    ----------
    own : mapping of str to Path
        CSV files by the name of the table: "classes", "materials", "friction", "damping", "furniture".
    models : collection of str, optional
        Names of the models that a class may ask for; None: whatever is there is taken.

    Returns
    -------
    AssumedValues

    Raises
    ------
    TableError
        Naming file, line, column and remedy: for a row that Kouros's table has no counterpart of, a value that cannot
        be, two rows of one name, a word of two materials.
    OSError
        For a file that cannot be read.
    """
    friction = _merged(Friction, "friction", own)
    bases = {row.object_material.lower(): row.object_material for row in friction.values()}
    materials = _merged(Material, "materials", own)
    _check_materials(materials.values(), bases)
    return AssumedValues(
        _merged(ObjectClass, "classes", own, models),
        materials,
        tuple(friction.values()),
        tuple(_merged(WallDamping, "damping", own).values()),
        _merged(FurnitureRow, "furniture", own),
    )


def _merged(
    model: type[_Assumed], name: str, own: Mapping[str, Path], models: Collection[str] | None = None
) -> dict[str, _Assumed]:
    """Return the rows of a table by what makes each the row that it is, the museum's in place of Kouros's."""
    out = _by_key(model, table(name), f"{name}.csv", {"own": ""})
    path = own.get(name)
    if path is None:
        return out
    rows = read_table(path)
    if not rows:
        raise TableError(
            f"{path.name}: has no rows; write the header of Kouros's {name}.csv and a row, or name no file"
        )
    theirs = _by_key(model, rows, path.name, {"own": path.name, "models": models})
    for line, (key, row) in enumerate(theirs.items(), start=2):
        if key not in out:
            near = get_close_matches(key, out, n=3) or list(out)
            raise TableError(
                f"{path.name}, line {line}: Kouros's {name}.csv has no row {key!r} that this one could take the place "
                f"of; write one of {', '.join(near)}"
            )
        out[key] = row
    return out


def _by_key(
    model: type[_Assumed], rows: Sequence[Row], file: str, context: Mapping[str, object]
) -> dict[str, _Assumed]:
    out: dict[str, _Assumed] = {}
    for line, row in enumerate(checked(model, rows, file, named=model.named, context=context), start=2):
        if row.key in out:
            raise TableError(f"{file}, line {line}: {row.key!r} is there twice; keep one row of it")
        out[row.key] = row
    return out


def _check_materials(materials: Collection[Material], bases: Mapping[str, str]) -> None:
    """Refuse a material that slides as one that friction.csv does not have, and a word of two materials."""
    whose: dict[str, str] = {}
    # The museum's rows come last, and so are those to blame.
    for one in sorted(materials, key=lambda one: bool(one.own)):
        where = f"{one.own or 'materials.csv'}, material {one.name!r}"
        if one.friction_as and one.friction_as.lower() not in bases:
            raise TableError(
                f"{where}: column 'friction_as': friction.csv has no {one.friction_as!r}; leave it empty or write one "
                f"of {', '.join(sorted(bases.values()))}"
            )
        for word in one.words:
            other = whose.setdefault(word.lower(), one.name)
            if other != one.name:
                raise TableError(
                    f"{where}: column 'words': {word!r} is a word of {other!r} too; leave it to one of them"
                )
