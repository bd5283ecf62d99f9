"""What was found about the objects of a sheet, into the database and out of it: compressed JSON, never changed."""

import hashlib
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Engine, insert, select

from pipeline.records import Assessment, Finding, Found, Fragility, Item, Outline, Recommendation, Tally, Verdict
from pipeline.store import codec
from pipeline.store.codec import StoreError
from pipeline.store.speaking import speaking
from pipeline.store.tables import RESULT

NAMED = 500
"""Keys in one statement: databases bound the number of parameters."""

WISHES = "wishes"
"""Counted only where the run asked what is worth measuring: nothing asked is not the same as nothing found."""

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}
_TITLE = 80
"""Characters of a title that a comparison shows."""


@dataclass(frozen=True, slots=True)
class Encoded:
    """A result as it is kept; a worker makes it, so that whoever writes only writes.

    basis : the digest of what it depends on besides its objects
    """

    key: str
    basis: str
    counts: Mapping[str, int]
    tally: Tally
    outline: bytes
    found: bytes


def encode(key: str, basis: str, found: Found, tally: Callable[[Found], Tally]) -> Encoded:
    """Make a result ready to be kept.

    basis  : the digest of what it depends on besides its objects
    tally  : what it adds to the totals of a run

    raises : StoreError naming the object, for a value of the wrong type, for text that is not Unicode, and for a
             finding that stands with another object
    """
    for assessment in found.assessments:
        _check_numbers(assessment)
    _check_twins(found)
    try:
        everything = _packed(Found, found)
    except StoreError:
        # All at once is quicker; one by one says which object it is.
        for assessment in found.assessments:
            check_type(_where(assessment), Assessment, assessment)
        raise
    outline = _packed(tuple[Outline, ...], outlines(found))
    return Encoded(key, basis, counts(found), tally(found), outline, everything)


def keep(engine: Engine, run_id: str, made: str, results: Iterable[Encoded]) -> None:
    """Write results that no run has yet, in one transaction; one that is there already is left as it is.

    run_id, made : the run that found them, and when it began
    raises       : StoreError for a database that refuses
    """
    with speaking(engine, "results were not stored"), engine.begin() as connection:
        add(connection, run_id, made, results)


def add(connection: Connection, run_id: str, made: str, results: Iterable[Encoded]) -> None:
    """Write results as a part of a transaction, as `keep` does in one of its own."""
    wanted = {result.key: result for result in results}
    there = known(connection, list(wanted))
    rows = [
        {
            "key": key,
            "basis": result.basis,
            "run_id": run_id,
            "made": made,
            "counts": dict(result.counts),
            "tally": result.tally,
            "outline": result.outline,
            "found": result.found,
        }
        for key, result in wanted.items()
        if key not in there
    ]
    if rows:
        connection.execute(insert(RESULT), rows)


@dataclass(frozen=True, slots=True)
class Kept:
    """A result that is there: the run that found it, when that began, what it adds to the totals."""

    run: str
    made: str
    counts: Mapping[str, int]
    tally: Tally


def known(connection: Connection, keys: Sequence[str]) -> dict[str, Kept]:
    """Return those of the keys that there are results for, with what is known of them."""
    found: dict[str, Kept] = {}
    columns = (RESULT.c.key, RESULT.c.run_id, RESULT.c.made, RESULT.c.counts, RESULT.c.tally)
    for start in range(0, len(keys), NAMED):
        some = RESULT.c.key.in_(keys[start : start + NAMED])
        found |= {row.key: Kept(*tuple(row)[1:]) for row in connection.execute(select(*columns).where(some))}
    return found


def known_to(engine: Engine, keys: Sequence[str]) -> dict[str, Kept]:
    """Return those of the keys that the database has results for, with what is known of them.

    raises : StoreError for a database that refuses
    """
    with speaking(engine, "the results of earlier runs could not be read"), engine.connect() as connection:
        return known(connection, keys)


def on_same_basis(engine: Engine, keys: Sequence[str], basis: str) -> list[str]:
    """Return those of the keys whose results rest on a basis."""
    found: list[str] = []
    with engine.connect() as connection:
        for start in range(0, len(keys), NAMED):
            some = RESULT.c.key.in_(keys[start : start + NAMED])
            found += connection.execute(select(RESULT.c.key).where(some, RESULT.c.basis == basis)).scalars()
    return found


def copy(source: Engine, target: Engine, key: str) -> None:
    """Copy a result from one database to another, where the other does not have it."""
    with target.begin() as into:
        if known(into, [key]):
            return
        with source.connect() as out:
            row = out.execute(select(RESULT).where(RESULT.c.key == key)).mappings().one()
        into.execute(insert(RESULT), [dict(row)])


def packed(database: Engine | Connection, key: str) -> bytes:
    """Return everything that was found, as it is kept.

    raises : StoreError where there is no such result
    """
    wanted = select(RESULT.c.found).where(RESULT.c.key == key)
    if isinstance(database, Engine):
        with database.connect() as connection:
            content = connection.execute(wanted).scalar()
    else:
        content = database.execute(wanted).scalar()
    if content is None:
        raise StoreError(f"there is no result {key[:12]}; it was pruned while it was read: choose another run")
    return bytes(content)


def load_found(database: Engine | Connection, key: str) -> Found:
    """Return everything that was found about the objects of a sheet.

    raises : StoreError where there is no such result, or where it is damaged
    """
    return unpacked(packed(database, key))


def unpacked(content: bytes) -> Found:
    """Read a result as it is kept.

    raises : StoreError where it is damaged
    """
    found: Found = _unpacked(Found, content)
    return found


def load_outlines(connection: Connection, keys: Sequence[str]) -> Iterator[Outline]:
    """Yield the outlines of all objects of some results."""
    for start in range(0, len(keys), NAMED):
        some = RESULT.c.key.in_(keys[start : start + NAMED])
        for row in connection.execute(select(RESULT.c.outline).where(some)):
            yield from _unpacked(tuple[Outline, ...], row.outline)


def outlines_of(engine: Engine, keys: Sequence[str]) -> list[Outline]:
    """Return the outlines of all objects of some results."""
    with engine.connect() as connection:
        return list(load_outlines(connection, keys))


def outlines(found: Found) -> tuple[Outline, ...]:
    """Return the outline of each object."""
    return tuple(_outline(assessment) for assessment in found.assessments)


def _outline(assessment: Assessment) -> Outline:
    scene = assessment.scene
    worst: dict[tuple[str, str], Verdict] = {}
    for finding in assessment.findings:
        key = (finding.model, finding.level)
        if key not in worst or _SEVERITY[finding.verdict] > _SEVERITY[worst[key]]:
            worst[key] = finding.verdict
    run_with = (scene.support, scene.object_class, scene.models, dict(scene.parameters))
    return Outline(
        scene.item.object_number,
        (scene.item.title or scene.item.object_name)[:_TITLE],
        scene.item.gallery,
        scene.floor,
        _digest(Item, scene.item),
        _digest(_RunWith, run_with),
        tuple((model, level, verdict.value) for (model, level), verdict in worst.items()),
    )


_RunWith = tuple[Any, str, tuple[str, ...], dict[str, Any]]


def _digest(hint: Any, value: Any) -> str:
    return hashlib.blake2b(codec.to_json(hint, value).encode(), digest_size=12).hexdigest()


def counts(found: Found) -> dict[str, int]:
    """Count what a result holds."""
    verdicts = [finding.verdict for assessment in found.assessments for finding in assessment.findings]
    return {
        "objects": len(found.assessments),
        "assessed": sum(assessment.assessed for assessment in found.assessments),
        "findings": len(verdicts),
        **{verdict.value: verdicts.count(verdict) for verdict in Verdict},
        "recommendations": sum(len(assessment.recommendations) for assessment in found.assessments),
        **({} if found.wishes is None else {WISHES: len(found.wishes)}),
    }


def _packed(hint: Any, value: Any) -> bytes:
    # Level 1: five times as fast as the usual 6, for a tenth more.
    return zlib.compress(codec.to_json(hint, value).encode(), 1)


def _unpacked(hint: Any, content: bytes) -> Any:
    try:
        text = zlib.decompress(content).decode()
    except (zlib.error, UnicodeDecodeError) as error:
        raise StoreError(f"a result is damaged: {error}; the database was changed by hand or is broken") from error
    return codec.of_json(hint, text)


def _where(assessment: Assessment) -> str:
    item = assessment.scene.item
    return f"object {item.object_number!a} in gallery {item.gallery!a}"


def _check_numbers(assessment: Assessment) -> None:
    number = assessment.scene.item.object_number
    judged: tuple[Finding | Recommendation | Fragility, ...] = (
        *assessment.findings,
        *assessment.recommendations,
        *assessment.fragilities,
    )
    for one in judged:
        if one.object_number != number:
            kind = type(one).__name__.lower()
            raise StoreError(
                f"{_where(assessment)} has a {kind} of object {one.object_number!a}; keep each with its object"
            )


def _check_twins(found: Found) -> None:
    times = Counter(assessment.scene.item.object_number for assessment in found.assessments)
    twice = sorted(number for number, often in times.items() if often > 1)
    if twice:
        listed = ", ".join(map(ascii, twice[:5])) + (f" and {len(twice) - 5} more" if len(twice) > 5 else "")
        raise StoreError(
            f"it has more than one object {listed}; give each object its own number in the museum's records"
        )


def check_type(where: str, hint: Any, value: Any) -> None:
    """Refuse a value that is not of a type, saying where it is.

    raises : StoreError
    """
    try:
        codec.to_json(hint, value)
    except StoreError as error:
        raise StoreError(f"{where}: {error}") from error
