"""Tasks of workers that find: response charts, the results of units, the gaps between neighbours.

Nothing of the report is asked here: what is found does not depend on how it is shown.  A `RunContext` holds what all
tasks share and goes once to each worker; a task is the rest.  What comes back depends on these two alone: the same on
this machine and on another, whoever did what before.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

from pipeline.analysis.chart_runs import deciding, response_chart
from pipeline.analysis.classify import furniture_kind
from pipeline.analysis.faults import Fault, each_apart, fault, unassessed
from pipeline.analysis.neighbours import neighbours
from pipeline.collection.object_index import read_packed
from pipeline.execute.workers import give_back
from pipeline.night.assessment import Assessed, assess_objects, by_object, decided_class, left_aside
from pipeline.records import Decision, Item, Motion
from pipeline.store.pages import NEIGHBOURS, Members, found_of
from pipeline.store.results import Stored, anonymous, encode, encode_spacings

if TYPE_CHECKING:
    from pipeline.night.context import RunContext


@dataclass(frozen=True)
class ChartTask:
    """A response chart to be built.

    Attributes
    ----------
    model
        Its name.
    motion
        That it is of.
    angle
        Degrees that what asks for it is shaken along; None for the worst direction, or for both at once.
    alike
        The parameters that all who ask for it share.
    """

    model: str
    motion: Motion
    angle: float | None
    alike: Mapping[str, float]


def build_chart(context: "RunContext", task: ChartTask) -> None:
    """Build a response chart, where it is not kept yet, so that all who work find it."""
    given: dict[str, Any] = {name: value for name, value in task.alike.items() if value == value}  # noqa: PLR0124 - NaN: not given
    response_chart(
        task.model,
        task.motion,
        angle=task.angle,
        numerics=deciding(task.model, context.analysis.numerics),
        charts=context.charts,
        **given,
    )


@dataclass(frozen=True)
class FurnitureTask:
    """Units of which it is to be known what they stand in, hang from or stand on.

    Attributes
    ----------
    records
        Of the first object of each, packed.
    decisions
        Those in force about them.
    """

    records: bytes
    decisions: tuple[Decision, ...] = ()


def furniture_of_units(context: "RunContext", task: FurnitureTask) -> tuple[str, ...]:
    """Return the kind of furniture of each unit; "" for one that Kouros fails on, which is told when it is assessed."""
    about = by_object(task.decisions)
    out = []
    for item in read_packed(task.records):
        try:
            decided = decided_class(about.get(item.object_number, ()))
            kind = furniture_kind(item, context.rules, decided, context.house).value
        except (MemoryError, OSError):
            raise
        except Exception:  # noqa: BLE001 - whatever it is, it is of this object, which is met again
            kind = ""
        out.append(kind)
    return tuple(out)


@dataclass(frozen=True)
class UnitTask:
    """Units on one floor that are assessed together.

    Attributes
    ----------
    floor
        That they stand on.
    assessed
        Whether they are; else they are left aside, and only classed.
    keys, sizes
        Of each unit its key, and how many objects it is.
    records
        Of all objects, unit by unit, packed.
    decisions
        Those in force about them.
    batch
        What the histories that are run are kept under from night to night; None where they are not kept.
    """

    floor: str
    assessed: bool
    keys: tuple[str, ...]
    sizes: tuple[int, ...]
    records: bytes
    decisions: tuple[Decision, ...] = ()
    batch: tuple[object, ...] | None = None


@dataclass(frozen=True)
class Assessments:
    """What came of a `UnitTask`.

    Attributes
    ----------
    stored
        The results of each unit.
    seconds
        What finding out what is worth measuring cost [s].
    faults
        The objects that Kouros failed on.
    failed
        Keys of the units that these are in.
    """

    stored: tuple[Stored, ...]
    seconds: float = 0.0
    faults: tuple[Fault, ...] = ()
    failed: frozenset[str] = frozenset()


def assess_units(context: "RunContext", task: UnitTask) -> Assessments:
    """Assess units; what Kouros fails on costs the object its answer, and is told."""
    items, floor = read_packed(task.records), context.floors[task.floor]
    if not task.assessed:
        every, seconds, faults = left_aside(context, floor, items, task.decisions)
    else:
        with context.working(task.batch) as working:
            every, seconds, faults = assess_objects(context, floor, items, task.decisions, working)
    ends = [0, *accumulate(task.sizes)]
    units = [(key, slice(*ends)) for key, ends in zip(task.keys, pairwise(ends), strict=True)]
    stored = tuple(_encoded(key, every[mine], items[mine], faults) for key, mine in units)
    # One that is like an object that failed has its fault, and none of its own.
    bad = {one.object_number for one in faults}
    failed = frozenset(
        key
        for key, mine in units
        if any(a.assessment.fault or i.object_number in bad for a, i in zip(every[mine], items[mine], strict=True))
    )
    number = len(items)
    del every, items
    # What follows takes far less.
    give_back(number)
    return Assessments(stored, seconds, tuple(faults), failed)


def _encoded(key: str, mine: Sequence[Assessed], items: Sequence[Item], faults: list[Fault]) -> Stored:
    try:
        return encode(key, [anonymous(one.assessment, dict(one.needing), one.wishes) for one in mine])
    except (MemoryError, OSError):
        raise
    except Exception as problem:  # noqa: BLE001 - whatever it is, it is of what was found of these, and told
        met = [fault(item, problem) for item in items]
        faults += met
        told = [
            replace(one, assessment=unassessed(item, told_of))
            for one, item, told_of in zip(mine, items, met, strict=True)
        ]
        return encode(key, [anonymous(one.assessment, {}, () if one.wishes is not None else None) for one in told])


@dataclass(frozen=True)
class GalleryTask:
    """The neighbours of a gallery.

    Attributes
    ----------
    key
        That the gaps between them are kept under.
    floor
        That they stand on.
    pages
        The objects of its pages.
    results
        Theirs by key, as they are kept.
    """

    key: str
    floor: str
    pages: tuple[Members, ...]
    results: Mapping[str, bytes]


def find_neighbours(context: "RunContext", task: GalleryTask) -> Assessments:
    """Find the gaps between the neighbours of a gallery."""
    floor = context.floors[task.floor]
    assessments = tuple(one for page in task.pages for one in found_of(page, task.results).assessments)
    faults: list[Fault] = []
    _, gaps = each_apart(
        assessments, lambda scenes, found: neighbours(scenes, found, floor.shaking), NEIGHBOURS, faults
    )
    stored = encode_spacings(task.key, gaps, {one.object_number: one.words for one in faults})
    return Assessments((stored,), faults=tuple(faults), failed=frozenset([task.key] if faults else []))
