"""Faults of Kouros itself: one costs one object its answer, never the night.

Many objects are worked on together, which is quicker.  Where that fails, they are worked on in ever smaller parts until
what fails is single objects: those cannot be assessed, and it is said why; all others are assessed as ever, to the same
digits, for what is found of an object does not hang on which others it is worked on with.
"""

import traceback
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar, get_type_hints

from pipeline.analysis.classify import unclassified
from pipeline.errors import fault_words
from pipeline.records import Assessment, Finding, Found, Item, Scene
from pipeline.records import phrases as say

Some = TypeVar("Some")
Made = TypeVar("Made")

LIKE = 20
"""Objects of one class and support that fail one by one before the others of them that failed together are given up."""

_LONGEST = 4000
"""Characters of a traceback that are kept."""


@dataclass(frozen=True)
class Fault:
    """An object that Kouros failed on.

    Attributes
    ----------
    words : str
        What went wrong and where, for people.
    traceback : str
        For who mends it.
    """

    object_number: str
    words: str
    traceback: str


def fault(item: Item, problem: Exception) -> Fault:
    """Return what is told of an object that an error came of."""
    # An error may quote the record: what is no letter could not be stored.
    words = fault_words(problem).encode("utf-8", "replace").decode()
    steps = "".join(traceback.format_tb(problem.__traceback__))
    return Fault(item.object_number, words, f"{steps[-_LONGEST:]}{words}")


def apart(
    work: Callable[[Sequence[Some]], Sequence[Made]],
    objects: Sequence[Some],
    kind: Callable[[Some], Hashable],
    company: Callable[[Some], Hashable | None] = lambda _: None,
) -> list[Made | Exception]:
    """Return what comes of work on each object, or the error that it comes to.

    Parameters
    ----------
    work : Callable[[Sequence[Some]], Sequence[Made]]
        On many together; gives one for each.
    kind : Callable[[Some], Hashable]
        Those that may well fail alike; after LIKE failures of one kind those that failed together with others of it,
        and with nothing else, are not tried one by one.
    company : Callable[[Some], Hashable | None], optional
        Those that must be worked on together where they can; None: the object stands for itself.

    Returns
    -------
    list of Made | Exception

    Raises
    ------
    MemoryError
    OSError
        What is full or gone is not an object's doing.
    """
    found: dict[int, Made | Exception] = {}
    failed: Counter[Hashable] = Counter()
    kinds = [kind(one) for one in objects]

    def each(units: Sequence[Sequence[int]]) -> None:
        places = [at for unit in units for at in unit]
        try:
            found.update(zip(places, work([objects[at] for at in places]), strict=True))
        except (MemoryError, OSError):
            raise
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is one object's, and told
            alike = all(kinds[at] == kinds[places[0]] for at in places)
            if len(places) == 1 or (alike and failed[kinds[places[0]]] >= LIKE):
                failed[kinds[places[0]]] += len(places)
                found.update((at, problem) for at in places)
                return
            parts = units if len(units) > 1 else [[at] for at in places]
            each(parts[: len(parts) // 2])
            each(parts[len(parts) // 2 :])

    groups: dict[Hashable, list[int]] = {}
    for at, one in enumerate(objects):
        beside = company(one)
        groups.setdefault((at,) if beside is None else ("beside", beside), []).append(at)
    first = {one: at for at, one in reversed(list(enumerate(kinds)))}
    if objects:
        each(sorted(groups.values(), key=lambda unit: (first[kinds[unit[0]]], unit[0])))
    return [found[at] for at in range(len(objects))]


def sound(work: Callable[[Sequence[Some]], Sequence[Made]], objects: Sequence[Some]) -> list[Made]:
    """Return what comes of work on each object that it does not fail with, for what only needs many of them.

    Parameters
    ----------
    work : callable
        On many together; gives one for each.
    objects : sequence
        What is worked on.

    Returns
    -------
    list

    Raises
    ------
    MemoryError, OSError
        As `apart`.
    """
    return [one for one in apart(work, objects, lambda _: None) if not isinstance(one, Exception)]


def without_failing(work: Callable[[Sequence[Some]], Made], objects: Sequence[Some]) -> Made:
    """Return what comes of work on many objects together, or, where that fails, on those that it does not fail with.

    Raises
    ------
    MemoryError, OSError
        As `apart`; what the work raises even on those, besides.
    """
    try:
        return work(objects)
    except (MemoryError, OSError):
        raise
    except Exception:  # noqa: BLE001 - whatever it is, it is some objects', each of which is told where it is assessed
        return work(sound(lambda some: (work(some), some)[1], objects))


def unassessed(scene: Scene | Item, told: Fault) -> Assessment:
    """Return what is said of an object that Kouros failed on: nothing but that."""
    known = scene if isinstance(scene, Scene) else unclassified(scene)
    why = f"Kouros failed on it, which is not your fault: {told.words}; please tell its makers"
    return Assessment(replace(known, models=(), parameters={}, missing=(why,), skipped={}), (), (), fault=told.words)


def each_apart(
    assessments: tuple[Assessment, ...],
    work: Callable[[Sequence[Scene], Sequence[Sequence[Finding]]], Iterable[Made]],
    without: str,
    faults: list[Fault],
) -> tuple[tuple[Assessment, ...], list[Made]]:
    """Do work on all objects together, without those that it fails with; these say so among their assumptions.

    Parameters
    ----------
    work
        On scenes and their findings.
    without : str
        What is not known of an object then, in words.
    faults : list of Fault
        What it fails with is added.

    Returns
    -------
    tuple[tuple[Assessment, ...], list[Made]]
    """
    bad: dict[int, Fault] = {}

    def done(places: Sequence[int]) -> list[Made]:
        # In company: what an object has to do with it may only show beside others.
        return list(work([assessments[at].scene for at in places], [assessments[at].findings for at in places]))

    def sound(kept: list[int], more: Sequence[int]) -> list[int]:
        try:
            done([*kept, *more])
        except (MemoryError, OSError):
            raise
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is one object's, and told
            if len(more) == 1:
                bad[more[0]] = fault(assessments[more[0]].scene.item, problem)
                return kept
            half = len(more) // 2
            return sound(sound(kept, more[:half]), more[half:])
        return [*kept, *more]

    every = range(len(assessments))
    try:
        return assessments, done(every)
    except (MemoryError, OSError):
        raise
    except Exception:  # noqa: BLE001 - as above
        kept = sorted(sound([], every))
    faults.extend(bad.values())
    told = tuple(with_fault(a, bad[at].words, without) if at in bad else a for at, a in enumerate(assessments))
    return told, done(kept)


def with_fault(assessment: Assessment, words: str, without: str) -> Assessment:
    """Return what was found about an object, saying what of it is not known because Kouros failed."""
    said = f"{say.FAILED(without=without, words=words)}; {say.TELL_MAKERS()}"
    scene = replace(assessment.scene, assumptions=(*assessment.scene.assumptions, said))
    return replace(assessment, scene=scene, fault=words)


def fitting(found: Found, work: Callable[[Found], Made], faults: list[Fault]) -> tuple[Found, Made]:
    """Do work on what was found, in which objects that it fails with are told as such.

    Returns
    -------
    (Found, Made)
        What was found as it was worked on, and what came of it.

    Raises
    ------
    MemoryError, OSError
        As `apart`; what the work raises even without those objects, besides.
    """
    try:
        return found, work(found)
    except (MemoryError, OSError):
        raise
    except Exception:
        alone = apart(
            lambda some: [work(_of(found, some))] * len(some),
            found.assessments,
            lambda one: (one.scene.object_class, one.scene.support),
        )
        bad = {at: one for at, one in enumerate(alone) if isinstance(one, Exception)}
        if not bad:
            raise
    several = list(found.assessments)
    for at, problem in bad.items():
        told = fault(several[at].scene.item, problem)
        faults.append(told)
        several[at] = unassessed(_plain(several[at].scene.item), told)
    rest = _of(found, [one for at, one in enumerate(found.assessments) if at not in bad])
    rest = replace(rest, assessments=tuple(several))
    return rest, work(rest)


def _of(found: Found, some: Sequence[Assessment]) -> Found:
    """Return what was found about some of the objects alone."""
    numbers = {one.scene.item.object_number for one in some}
    return Found(
        tuple(some),
        None if found.wishes is None else tuple(w for w in found.wishes if w.object_number in numbers),
        tuple(s for s in found.spacings if s.first in numbers and s.second in numbers),
        {number: counts for number, counts in found.needing.items() if number in numbers},
    )


def _plain(item: Item) -> Item:
    """Return an item that can be kept and shown, whatever its texts hold: what is no text or no letter is replaced."""
    texts: dict[str, Any] = {
        name: str(value).encode("utf-8", "replace").decode()
        for name, kind in get_type_hints(Item).items()
        if kind is str and (value := getattr(item, name)) is not None
    }
    return replace(item, **texts, provenance=(), problems=())
