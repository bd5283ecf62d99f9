"""Catalogue of a museum's measures, least intrusive first, and of its isolators."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from pipeline.mitigate.measures import MEASURES, Measure
from pipeline.mitigate.rows import Isolator, MeasureRow, read_isolators, read_measure_rows
from pipeline.records import Scene
from pipeline.tables import TableError, read_table, table
from pipeline.tables.assumed import AssumedValues, assumed


@dataclass(frozen=True)
class MeasureCatalogue:
    """The measures, least intrusive first, and the isolators that there are.

    Parameters
    ----------
    measures : tuple of Measure
        Each with its row; the last is always possible.
    isolators : tuple of Isolator
        In the order of their table.
    values : AssumedValues
        What is assumed of materials, and of surfaces that an object may be put on.

    Raises
    ------
    TableError
        Where the last measure is not always possible.
    """

    measures: tuple[Measure, ...]
    isolators: tuple[Isolator, ...]
    values: AssumedValues = field(default_factory=assumed, repr=False)

    def __post_init__(self) -> None:
        if not self.measures or not self.measures[-1].last_resort:
            raise TableError("measures.csv: the last measure must always be possible (remove)")

    def named(self, name: str) -> Measure:
        """Return the measure that is called so.

        Raises
        ------
        KeyError
            Where there is none.
        """
        found = next((measure for measure in self.measures if measure.row.name == name), None)
        if found is None:
            raise KeyError(name)
        return found

    @property
    def installable(self) -> dict[str, Measure]:
        """The measures that can be said to be installed, by name."""
        return {measure.row.name: measure for measure in self.measures if not measure.last_resort}


@cache
def own_catalogue() -> MeasureCatalogue:
    """Return the measures and isolators of Kouros's own tables, and the measures of other packages."""
    rows = [dict(row) for row in table("measures")]
    tabled = {row["measure"] for row in rows}
    rows += [{**one.own_row} for one in MEASURES if one.own_row is not None and one.name not in tabled]
    listed = _measures(read_measure_rows(rows, "measures.csv", _known()))
    return MeasureCatalogue(
        _ordered(listed, listed, "measures.csv"), read_isolators(table("isolators"), "isolators.csv")
    )


def measure_catalogue(
    measures: Path | None = None, isolators: Path | None = None, values: AssumedValues | None = None
) -> MeasureCatalogue:
    """Return what a museum can do.

    Parameters
    ----------
    measures : Path, optional
        A CSV file with the columns of tables/measures.csv.  A row of the name of one of Kouros's takes its place; one
        of another name is added, of the kind that its column ``like`` names.
    isolators : Path, optional
        A CSV file with the columns of tables/isolators.csv, which takes the place of that table.
    values : AssumedValues, optional
        What is assumed of materials and surfaces; Kouros's own tables where it is left out.

    Returns
    -------
    MeasureCatalogue

    Raises
    ------
    TableError
        Naming file, line, column and remedy.
    FileNotFoundError
    """
    own = own_catalogue()
    listed, have = own.measures, own.isolators
    if measures is not None:
        theirs = _measures(read_measure_rows(read_table(measures), measures.name, _known()))
        merged = {one.row.name: one for one in (*own.measures, *theirs)}
        listed = _ordered(merged.values(), theirs, measures.name)
    if isolators is not None:
        have = read_isolators(read_table(isolators), isolators.name)
    return MeasureCatalogue(listed, have, values or assumed())


def changed(
    scene: Scene, measure: str, parameters: Mapping[str, float], catalogue: MeasureCatalogue | None = None
) -> Scene:
    """Return a scene with a measure in place.

    Parameters
    ----------
    scene : Scene
    measure : str
        Its name in the catalogue.
    parameters : mapping of str to float
        Those of its recommendation [SI].
    catalogue : MeasureCatalogue, optional
        Kouros's own where it is left out.

    Raises
    ------
    KeyError
        For a measure that there is not or that changes nothing, and where a parameter of the measure or the scene is
        missing.
    """
    return (catalogue or own_catalogue()).named(measure).change(scene, parameters)


def _known() -> dict[str, type[Measure]]:
    return {one.name: one for one in MEASURES}


def _measures(rows: Sequence[MeasureRow]) -> list[Measure]:
    known = _known()
    return [known[row.like](row) for row in rows]


def _ordered(measures: Iterable[Measure], theirs: Sequence[Measure], file: str) -> tuple[Measure, ...]:
    """Return measures by their order; ``theirs`` are those of the file, which is to blame where one comes too late."""
    ordered = tuple(sorted(measures, key=lambda measure: measure.row.order))
    last = next(measure for measure in ordered if measure.last_resort)
    if last is ordered[-1]:
        return ordered
    if last in theirs:
        raise TableError(
            f"{file}, measure {last.row.name!r}: column 'order' must be the largest of all: nothing comes after it"
        )
    raise TableError(
        f"{file}, measure {ordered[-1].row.name!r}: column 'order' must be below {last.row.order:g}, that of "
        f"{last.row.name!r}: nothing comes after it"
    )
