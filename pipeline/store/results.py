"""Results in the database, each under the key of everything that it depends on: sealed, compressed, never changed.

What is assessed together is a unit, one object or all in one case; a row holds a result for each of its objects, in
their order.  Neither numbers nor places of the objects are in it, so that objects that are alike share a row.
"""

import hashlib
import zlib
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

from sqlalchemy import Connection, Engine, Table, delete, insert, select

from pipeline.analysis.stakes import to_check
from pipeline.collection.sealing import damaged_rows, sealed, sound_rows
from pipeline.records import (
    Assessment,
    Brief,
    Item,
    MeasurementRequest,
    Outline,
    Result,
    Scene,
    Spacing,
    Verdict,
    standing,
)
from pipeline.store import codec
from pipeline.store.codec import StoreError, deflated, explained, inflated
from pipeline.store.tables import RESULT

NAMED = 500
"""Keys in one statement: databases bound the number of parameters."""

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}


class DamagedRunError(StoreError):
    """An earlier run cannot be compared with: something of it is not what was written."""


@dataclass(frozen=True, slots=True)
class Stored:
    """What is kept under a key, ready to be written; a worker makes it, so that whoever writes only writes.

    Attributes
    ----------
    key
        Digest of everything that the results depend on.
    outline
        Of each result what comparisons need, as JSON.
    found
        The results, as compressed JSON.
    """

    key: str
    outline: str
    found: bytes


@dataclass(frozen=True, slots=True)
class KeptResult:
    """What is there under a key: the run that found it, when that began (ISO 8601, UTC), and what it found."""

    run: str
    made: str
    outline: str
    found: bytes


class Made(NamedTuple):
    """When something was found (ISO 8601, UTC), and by which run."""

    made: str
    run: str


Digests = tuple[str, str, tuple[tuple[str, str, str], ...], Brief]
"""Of a result: floor, digest of what else its object was run with, model, level and worst verdict of each, in short."""

_OUTLINES = tuple[Digests, ...]
_WITHOUT_BRIEF = tuple[tuple[str, str, tuple[tuple[str, str, str], ...]], ...]
"""The same as earlier versions kept it: nothing in short."""

_RESULTS = tuple[Result, ...]
_SPACINGS = tuple[tuple[Spacing, ...], dict[str, str]]


def anonymous(assessment: Assessment, needing: dict[str, int], wishes: tuple[MeasurementRequest, ...] | None) -> Result:
    """Return what was found about an object without its number, its place and its title.

    Parameters
    ----------
    assessment
        Of the object.
    needing
        By name of the model, for how many of its analyses any history was run.
    wishes
        What is worth measuring on it; None where the run did not ask.
    """
    scene = assessment.scene
    return Result(
        scene.object_class,
        scene.rule,
        scene.support,
        scene.models,
        scene.parameters,
        scene.assumptions,
        scene.missing,
        scene.skipped,
        scene.floor,
        scene.hanging,
        scene.furniture,
        scene.statements,
        tuple(replace(one, object_number="", gallery="") for one in assessment.findings),
        tuple(replace(one, object_number="", gallery="") for one in assessment.recommendations),
        tuple(replace(one, object_number="") for one in assessment.fragilities),
        needing,
        None if wishes is None else tuple(replace(w, object_number="", gallery="", title="") for w in wishes),
        assessment.fault,
        assessment.aside,
        scene.furniture_origin,
        scene.anchorage,
        assessment.likelihoods,
        scene.chances,
        scene.mount,
        scene.mount_origin,
        to_check(assessment),
    )


def of_object(result: Result, item: Item) -> Assessment:
    """Return a result as what was found about an object."""
    number, gallery = item.object_number, item.gallery
    scene = Scene(
        item,
        result.object_class,
        result.rule,
        result.support,
        result.models,
        result.parameters,
        result.assumptions,
        result.missing,
        result.skipped,
        result.floor,
        result.hanging,
        result.furniture,
        result.statements,
        result.furniture_origin,
        result.anchorage,
        result.chances,
        result.mount,
        result.mount_origin,
    )
    return Assessment(
        scene,
        _owned(result.findings, number, gallery),
        _owned(result.recommendations, number, gallery),
        _owned(result.fragilities, number),
        result.fault,
        result.aside,
        result.likelihoods,
    )


def _owned(found: Iterable[Any], *names: str) -> tuple[Any, ...]:
    """Return records with the names of their object, which are their first fields: `replace` takes thrice as long."""
    return tuple(one.__class__(*names, *_rest(one.__class__, len(names))(one)) for one in found)


@cache
def _rest(record: Any, names: int) -> Callable[[Any], tuple[Any, ...]]:
    """Return what gives the fields of a record behind the first ones."""
    return attrgetter(*(one.name for one in fields(record)[names:]))


def encode(key: str, results: Sequence[Result]) -> Stored:
    """Make results ready to be kept.

    Raises
    ------
    StoreError
        For a value of the wrong type, and for text that is not Unicode.
    """
    found = _packed(_RESULTS, tuple(results))
    return Stored(key, codec.to_json(_OUTLINES, tuple(_digests(one) for one in results)), found)


def encode_spacings(key: str, spacings: Sequence[Spacing], faults: dict[str, str]) -> Stored:
    """Make the gaps between the neighbours of a gallery ready to be kept.

    Parameters
    ----------
    key
        Digest of everything that they depend on, the objects' numbers among it.
    spacings
        The gaps.
    faults
        By object number, what Kouros itself failed on.
    """
    return Stored(key, "[]", _packed(_SPACINGS, (tuple(spacings), faults)))


def decode(found: bytes) -> tuple[Result, ...]:
    """Read results as they are kept.

    Raises
    ------
    StoreError
        Where they are damaged.
    """
    results: tuple[Result, ...] = _unpacked(_RESULTS, found)
    return results


def decode_spacings(found: bytes) -> tuple[tuple[Spacing, ...], dict[str, str]]:
    """Read what `encode_spacings` encoded: the gaps, and what Kouros failed on by object number."""
    spacings: tuple[tuple[Spacing, ...], dict[str, str]] = _unpacked(_SPACINGS, found)
    return spacings


def keep(engine: Engine, run_id: str, made: str, stored: Iterable[Stored]) -> None:
    """Write results that are not there yet, in one transaction; one that is there is left as it is.

    Parameters
    ----------
    engine
        The database.
    run_id, made
        The run that found them, and when it began.
    stored
        The results.

    Raises
    ------
    StoreError
        For a database that refuses.
    """
    with explained(engine, "results were not stored"), engine.begin() as connection:
        add(connection, run_id, made, stored)


def add(connection: Connection, run_id: str, made: str, stored: Iterable[Stored]) -> None:
    """Write results as a part of a transaction, as `keep` does in one of its own."""
    wanted = {one.key: one for one in stored}
    there = _known(connection, wanted)
    rows = [
        sealed(RESULT, {"key": key, "run_id": run_id, "made": made, "outline": one.outline, "found": one.found})
        for key, one in wanted.items()
        if key not in there
    ]
    if rows:
        connection.execute(insert(RESULT), rows)


def known(engine: Engine, keys: Collection[str]) -> tuple[dict[str, Made], list[str]]:
    """Return when those of the results that there are were made, by key, and the keys of those that are damaged.

    Raises
    ------
    StoreError
        For a database that refuses.
    """
    with explained(engine, "the results of earlier runs could not be read"), engine.connect() as connection:
        return made_of(connection, RESULT, keys, NAMED)


def made_of(
    connection: Connection, table: Table, keys: Collection[str], most: int
) -> tuple[dict[str, Made], list[str]]:
    """Return when those rows of a table that are sound were made, by key, and the keys of the others.

    Parameters
    ----------
    connection
        To the database.
    table
        RESULT or PAGE.
    keys
        Of the rows.
    most
        How many are read at a time: all of a row is, for its seal.
    """
    found: dict[str, Made] = {}
    damaged: list[str] = []
    same: dict[Made, Made] = {}
    for some in named(keys, most):
        rows, broken = sound_rows(connection, table, table.c.key.in_(some))
        for row in rows:
            made = Made(row.made, row.run_id)
            found[row.key] = same.setdefault(made, made)
        damaged += broken
    return found, damaged


def _known(connection: Connection, keys: Collection[str]) -> set[str]:
    found: set[str] = set()
    for some in named(keys):
        found.update(connection.execute(select(RESULT.c.key).where(RESULT.c.key.in_(some))).scalars())
    return found


def fetch(database: Engine | Connection, keys: Collection[str]) -> tuple[dict[str, KeptResult], list[str]]:
    """Return what is kept under some keys, and those of the keys whose rows are damaged.

    What is not there is in neither of them.
    """
    if isinstance(database, Engine):
        with explained(database, "the results of earlier runs could not be read"), database.connect() as connection:
            return fetch(connection, keys)
    found: dict[str, KeptResult] = {}
    damaged: list[str] = []
    for some in named(keys):
        rows, broken = sound_rows(database, RESULT, RESULT.c.key.in_(some))
        found |= {row.key: KeptResult(row.run_id, row.made, row.outline, bytes(row.found)) for row in rows}
        damaged += broken
    return found, damaged


def outlines(connection: Connection, keys: Collection[str]) -> dict[str, tuple[Digests, ...]]:
    """Return the outlines of the results that are kept under some keys.

    Raises
    ------
    DamagedRunError
        Where one of them is gone, or is not what was written.
    """
    told: dict[str, tuple[Digests, ...]] = {}
    for some in named(keys):
        found, broken = fetch(connection, some)
        lost = set(some) - found.keys()
        if lost:
            why = "changed in the database since it was written" if broken else "is gone"
            raise DamagedRunError(f"result {min(lost)[:12]} {why}")
        told |= {key: _outlines(one.outline) for key, one in found.items()}
    return told


def _outlines(text: str) -> tuple[Digests, ...]:
    try:
        told: tuple[Digests, ...] = codec.of_json(_OUTLINES, text)
    except StoreError:
        return tuple((*one, Brief()) for one in codec.of_json(_WITHOUT_BRIEF, text))
    return told


def damaged(engine: Engine) -> Iterator[str]:
    """Yield the keys of all rows that are not what was written."""
    with engine.connect() as connection:
        yield from damaged_rows(connection, RESULT)


def forget(engine: Engine, keys: Collection[str]) -> None:
    """Remove what is kept under some keys, so that it is made again."""
    with engine.begin() as connection:
        for some in named(keys):
            connection.execute(delete(RESULT).where(RESULT.c.key.in_(some)))


def copy(source: Engine, target: Engine, keys: Collection[str]) -> None:
    """Copy results from one database to another, where the other does not have them."""
    with target.begin() as into:
        there = _known(into, keys)
        wanted = [key for key in dict.fromkeys(keys) if key not in there]
        with source.connect() as out:
            for some in named(wanted):
                rows = out.execute(select(RESULT).where(RESULT.c.key.in_(some))).mappings().all()
                into.execute(insert(RESULT), [dict(row) for row in rows])


def named(keys: Collection[str], most: int = NAMED) -> Iterator[list[str]]:
    """Yield keys, as many at a time as one statement may name."""
    listed = list(keys)
    for start in range(0, len(listed), most):
        yield listed[start : start + most]


def _digests(result: Result) -> Digests:
    worst: dict[tuple[str, str], Verdict] = {}
    for finding in result.findings:
        key = (finding.model, finding.level)
        if key not in worst or _SEVERITY[finding.verdict] > _SEVERITY[worst[key]]:
            worst[key] = finding.verdict
    held = (result.support, result.hanging, result.furniture, result.furniture_origin, result.anchorage)
    run_with = (held, result.object_class, result.models, dict(result.parameters))
    verdicts = tuple((model, level, verdict.value) for (model, level), verdict in worst.items())
    return result.floor, _digest(_RunWith, run_with), verdicts, _brief(result)


def _brief(result: Result) -> Brief:
    found = max(result.likelihoods, key=lambda one: one.probability, default=None)
    state = standing(result.findings, found, complete=not result.missing, aside=result.aside)
    # As the report names it first: what is advised where harm is likeliest, or else at another level.
    mine = [one for one in result.recommendations if found is not None and one.level == found.level]
    advice = next(iter([*mine, *result.recommendations]), None)
    return Brief(
        state,
        "" if found is None else found.band.value,
        *(("", "") if advice is None else (advice.measure, advice.title)),
        next(iter(result.missing), ""),
        result.check,
    )


_RunWith = tuple[tuple[Any, Any, Any, Any, Any], str, tuple[str, ...], dict[str, Any]]


def _digest(hint: Any, value: Any) -> str:
    return hashlib.blake2b(codec.to_json(hint, value).encode(), digest_size=12).hexdigest()


def outline_of(number: str, gallery: str, digest: str, found: Digests) -> Outline:
    """Return an object in as much as two runs are compared by.

    Parameters
    ----------
    number, gallery, digest
        Of its record.
    found
        Of its result.
    """
    floor, scene, verdicts, brief = found
    return Outline(number, gallery, floor, digest, scene, verdicts, brief)


def _packed(hint: Any, value: Any) -> bytes:
    return deflated(codec.to_json(hint, value).encode())


def _unpacked(hint: Any, content: bytes) -> Any:
    try:
        text = inflated(content).decode()
    except (zlib.error, UnicodeDecodeError) as error:
        raise StoreError(f"a result is damaged: {error}; the database was changed by hand or is broken") from error
    return codec.of_json(hint, text)
