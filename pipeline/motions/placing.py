"""Records put into a site: their files copied, the manifest changed with every comment kept; all of it, or nothing."""

from __future__ import annotations

import hashlib
import json
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import ValidationError

from pipeline.motions.doubts import doubts
from pipeline.motions.errors import Judgement, MotionError, refusal, unwritten
from pipeline.motions.manifest import MANIFEST, LevelTable, Manifest, load_manifest
from pipeline.motions.processing import EAST, Processed
from pipeline.motions.proposing import RecordProposal
from pipeline.motions.record import Record, StationTable
from pipeline.motions.safe_names import one_line, safe_name
from pipeline.motions.site import prepare
from pipeline.resources import aside_of, replacing, small_text, sweep

DESIGN = "design"
"""What the first level of a site is called where nobody says it."""


@dataclass(frozen=True, eq=False)
class PlacedRecords:
    """A record in its site.

    Attributes
    ----------
    name : str
        What it is called there.
    level : str
        Its level of shaking.
    record : Record
        The manifest's table of it.
    told : tuple of str
        What was decided, and why; what is doubtful of its motion too.
    doubts : tuple of str
        What is doubtful of its motion.
    done : Processed or None
        The record as it was tried, of the first ones, whose files are called in the site as they were where they came
        from: the same bytes would give the same once more.
    """

    name: str
    level: str
    record: Record
    told: tuple[str, ...]
    doubts: tuple[str, ...] = ()
    done: Processed | None = None


@dataclass(eq=False)
class PlacingPlan:
    """What is to be put into a site.

    Attributes
    ----------
    folder : Path
        Of the site.
    before : str or None
        Its manifest's text as it is; None where there is none.
    level : str
        Where the records belong.
    placed : list of PlacedRecords
        The records.
    already : list of (str, str)
        Names of proposals that the site has, and the records that they are.
    refused : list of (str, MotionError)
        Proposals that cannot be used, and why.
    copies : dict of str to Path
        Files inside the site's folder, and where each is copied from.
    withdrawn : str
        Who had approved the level, and when; "" where nobody had, or nothing is added.
    """

    folder: Path
    before: str | None
    level: str
    placed: list[PlacedRecords] = field(default_factory=list)
    already: list[tuple[str, str]] = field(default_factory=list)
    refused: list[tuple[str, MotionError]] = field(default_factory=list)
    copies: dict[str, Path] = field(default_factory=dict)
    withdrawn: str = ""


def opened(folder: Path) -> tuple[str | None, Manifest | None]:
    """Return the text of a site's manifest and what it says; None for a folder that has none.

    Parameters
    ----------
    folder : Path
        Of the site, whether or not it is there.

    Returns
    -------
    (str or None, Manifest or None)

    Raises
    ------
    MotionError
        For a manifest that cannot be used: nothing is added to a site that is not valid.
    """
    file = folder / MANIFEST
    if folder.exists() and not folder.is_dir():
        raise refusal(folder, "site", "is no folder", "name the folder of a site, or a new one")
    if not file.exists():
        return None, None
    manifest = load_manifest(file, begun=True)
    return small_text(file), manifest


def plan(
    folder: Path,
    level: str,
    proposals: Sequence[RecordProposal],
    reasons: Mapping[str, str],
    before: str | None,
    known: Manifest | None,
    *,
    keep: int = 0,
) -> PlacingPlan:
    """Read and process each record that is to be added, and say where its files go; nothing is written.

    Parameters
    ----------
    folder : Path
        Of the site.
    level : str
        Of shaking.
    proposals : sequence of RecordProposal
    reasons : mapping of str to str
        Why refusals that are a matter of judgement are overruled, by their names; under "" that of all others.
    before, known : str or None, Manifest or None
        As of `opened`.
    keep : int
        Of how many records the processed motion is kept in the plan.

    Returns
    -------
    PlacingPlan

    Raises
    ------
    MotionError
        For a proposal with questions; a record that is refused is told in the plan.
    """
    made = PlacingPlan(folder, before, level)
    there = [] if known is None else [(record, _level_of(known, record)) for _, record in known.records()]
    table = next((one for one in known.level if one.name == level), None) if known is not None else None
    names = {record.name for record, _ in there}
    digests = {digest: name for record, _ in there for name, digest in record.sha256.items()}
    folders = {path.name.casefold() for path in folder.iterdir()} if folder.is_dir() else set[str]()
    for proposal in proposals:
        record = proposal.record
        if record is None:
            asked = "; ".join(f"{one.text}: {one.option}" for one in proposal.questions)
            raise refusal(
                folder, f"record {proposal.name!r}", f"has unanswered questions ({asked})", "answer them first"
            )
        twin = next((r for r in [*(r for r, _ in there), *(p.record for p in made.placed)] if _same(r, record)), None)
        if twin is not None:
            made.already.append((proposal.name, twin.name))
            continue
        name = _unused(record.name, names, " ({})")
        where = _unused(safe_name(name).strip(".") or "record", folders, "-{}")
        final: dict[str, str] = {}
        copies: dict[str, Path] = {}
        for local, path in proposal.files.items():
            inside = _inside(folder, path)
            digest = record.sha256[local]
            known_as = inside or digests.get(digest)
            if known_as is None or known_as in final.values():
                known_as = f"{where}/{local}"
                copies[known_as] = path
            final[local] = known_as
        try:
            accepted, tried = _tried(record, proposal.files, table, reasons, known)
        except MotionError as problem:
            made.refused.append((proposal.name, unwritten(problem)))
            continue
        doubtful = doubts(tried.motion.steps)
        # Its steps name it, its files, and its response by the whole path.
        called = name == record.name and record.response is None
        called &= all(local == path.name for local, path in proposal.files.items())
        named = _renamed(record.model_copy(update={"name": name, "accept": accepted}), final)
        told = [
            *proposal.told,
            *(
                f"{one_line(path.name)} is called {final[local]}"
                for local, path in proposal.files.items()
                if local != path.name and final[local] in copies
            ),
        ]
        told += [f"overruled {what}: {why}" for what, why in accepted.items()]
        told += [f"doubtful: {doubt}" for doubt in doubtful]
        done = tried if called and len(made.placed) < keep else None
        made.placed.append(PlacedRecords(name, level, named, tuple(told), doubtful, done))
        made.copies |= copies
        digests |= {record.sha256[local]: at for local, at in final.items()}
        names.add(name)
        folders.add(where.casefold())
    if table is not None and table.approved_by and made.placed:
        made.withdrawn = f"{table.approved_by}, {table.approved_on}"
    return made


def _level_of(manifest: Manifest, record: Record) -> str:
    return next((level.name for level in manifest.level if record in level.record), "")


def _same(one: Record, other: Record) -> bool:
    """Whether two records are the same channels of the same bytes, whatever their files are called."""
    if {one.sha256[name] for name in one.files} != {other.sha256[name] for name in other.files}:
        return False
    if any(key in record.files for record in (one, other) for key in record.components):
        return len(one.files) > 1
    # A channel's full id, or its code alone.
    whole = all("." in key for record in (one, other) for key in record.components)
    keys = [{key if whole else key.rpartition(".")[2] for key in record.components} for record in (one, other)]
    return keys[0] == keys[1]


def _unused(name: str, taken: set[str], suffix: str) -> str:
    lower = {one.casefold() for one in taken}
    if name.casefold() not in lower:
        return name
    return next(one for n in range(2, len(lower) + 3) if (one := name + suffix.format(n)).casefold() not in lower)


def _inside(folder: Path, path: Path) -> str | None:
    """The name of a file that lies in the site's folder already, None for any other."""
    if path.is_symlink() or not folder.is_dir() or not path.resolve().is_relative_to(folder.resolve()):
        return None
    name = path.resolve().relative_to(folder.resolve()).as_posix()
    plain = "\\" not in name and name.isprintable() and not any(part.startswith(".") for part in name.split("/"))
    return name if plain else None


def _renamed(record: Record, names: Mapping[str, str]) -> Record:
    """A record with its files under other names."""
    return record.model_copy(
        update={
            "files": tuple(dict.fromkeys(names[name] for name in record.files)),
            "response": record.response and names[record.response],
            "components": {names.get(key, key): one for key, one in record.components.items()},
            "sha256": {names[name]: digest for name, digest in record.sha256.items()},
        }
    )


def _tried(
    record: Record,
    files: Mapping[str, Path],
    table: LevelTable | None,
    reasons: Mapping[str, str],
    known: Manifest | None,
) -> tuple[dict[Judgement, str], Processed]:
    """Process a record from where its files are now; return why refusals are overruled, and what came of it."""
    now = _renamed(record, {local: str(path.absolute()) for local, path in files.items()})
    azimuth = EAST if known is None else known.site.x_azimuth
    accepted: dict[Judgement, str] = {}
    while True:
        try:
            granted = now.model_copy(update={"accept": accepted})
            # What is wrong is in the record's files: there is no manifest yet that could be looked into.
            done = prepare(Path(now.files[0]), "", granted, None if table is None else table.target, azimuth)
        except MotionError as problem:
            reason = reasons.get(problem.judgement) or reasons.get("")
            if not reason or not problem.judgement or problem.judgement in accepted:
                raise
            accepted[problem.judgement] = reason
        else:
            return accepted, done


def changed(made: PlacingPlan, site: StationTable) -> str:
    """Return the manifest's text with the records of a plan.

    Parameters
    ----------
    made : PlacingPlan
        What is added.
    site : StationTable
        What a new site is called, and where it is.

    Returns
    -------
    str
        TOML; every comment of the one before is in it.

    Raises
    ------
    MotionError
        Where a manifest cannot be changed without touching anything else in it.
    """
    file = made.folder / MANIFEST
    text = _new(site, made.folder) if made.before is None else made.before
    document = tomlkit.parse(text)
    wanted = tomllib.loads(text)
    tables = [_table(one) for one in made.placed]
    plain = [tomllib.loads(tomlkit.dumps(table)) for table in tables]
    level = next((one for one in document.get("level", ()) if one.get("name") == made.level), None)
    if level is None:
        level = tomlkit.table()
        level.update({"name": made.level, "combine": "max"})
        level["combine"].comment('the worst record decides; with seven records and more "mean" may')
        records = tomlkit.aot()
        level.append("record", records)
        for table in tables:
            records.append(table)
        _append(document, "level", level)
        wanted.setdefault("level", []).append({"name": made.level, "combine": "max", "record": plain})
    else:
        of = next(one for one in wanted["level"] if one["name"] == made.level)
        if made.withdrawn:
            level["approved_by"] = tomlkit.string("").comment(f"was {made.withdrawn}, before records were added")
            level.pop("approved_on")
            of.pop("approved_on")
            of["approved_by"] = ""
        for table in tables:
            _append(level, "record", table)
        of["record"] += plain
    done = tomlkit.dumps(document)
    try:
        now = tomllib.loads(done)
        Manifest.model_validate_json(json.dumps(now, default=lambda value: value.isoformat()))
    except (tomllib.TOMLDecodeError, ValidationError) as error:
        raise refusal(file, "TOML", f"cannot be added to ({error!s:.300})", "mend the manifest") from error
    if now != wanted:
        remedy = "write the levels as [[level]] and the records as [[level.record]]"
        raise refusal(file, "TOML", "is written so that nothing can be added without changing the rest", remedy)
    return done


def _append(holder: Any, key: str, table: Any) -> None:
    """Append a table to a list of tables, whichever way that is written."""
    there = holder.get(key)
    if there is None:
        there = tomlkit.aot()
        there.append(table)
        holder.append(key, there)
    elif isinstance(there, tomlkit.items.AoT):
        there.append(table)
    else:
        inline = tomlkit.inline_table()
        inline.update(tomllib.loads(tomlkit.dumps(table)))
        there.append(inline)


def _new(site: StationTable, folder: Path) -> str:
    document = tomlkit.document()
    document.add(tomlkit.comment("The motions of a site; written by `kouros motions add`."))
    table = tomlkit.table()
    table.add("name", site.name or folder.resolve().name or "Site")
    for key, value in (("latitude", site.latitude), ("longitude", site.longitude)):
        table.add(key, 0.0 if value is None else value)
        if value is None:
            table[key].comment("nobody has said it: put the museum's here")
    document.add("site", table)
    return tomlkit.dumps(document)


def _table(one: PlacedRecords) -> Any:
    record, table = one.record, tomlkit.table()
    for line in one.told:
        table.add(tomlkit.comment(one_line(line)))
    said = record.model_dump(exclude_none=True, exclude={"components", "sha256", "accept"}, exclude_defaults=True)
    for key, value in said.items():
        if isinstance(value, dict):
            inline = tomlkit.inline_table()
            inline.update(value)
            table.add(key, inline)
        else:
            table.add(key, list(value) if isinstance(value, tuple) else value)
    if record.accept:
        accept = tomlkit.inline_table()
        accept.update(record.accept)
        table.add("accept", accept)
    components = tomlkit.table()
    for name, component in record.components.items():
        inline = tomlkit.inline_table()
        inline.update(component.model_dump(exclude_none=True, exclude_defaults=True) | {"axis": component.axis})
        components.add(name, inline)
    table.add("components", components)
    digests = tomlkit.table()
    digests.update(record.sha256)
    table.add("sha256", digests)
    return table


def commit(made: PlacingPlan, text: str) -> Path:
    """Copy the files of a plan into the site and replace its manifest; what fails on the way leaves all as it was.

    Parameters
    ----------
    made : PlacingPlan
        What is added.
    text : str
        The new manifest.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    MotionError
        Where a file or the manifest has changed in the meantime.
    """
    folder = made.folder
    fresh = _fresh(folder)
    folder.mkdir(parents=True, exist_ok=True)
    sweep(folder)
    aside, moved = aside_of(folder / "added"), list[Path]()
    try:
        digests = {name: digest for one in made.placed for name, digest in one.record.sha256.items()}
        for name, original in made.copies.items():
            target = aside / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(original, target)
            if hashlib.sha256(target.read_bytes()).hexdigest() != digests[name]:
                raise refusal(
                    original, "file", "has changed while it was read", "wait until it is whole, and try again"
                )
        file = folder / MANIFEST
        if (small_text(file) if file.exists() else None) != made.before:
            raise refusal(file, "manifest", "somebody has changed it in the meantime", "try again")
        for top in sorted({name.partition("/")[0] for name in made.copies}):
            if (folder / top).exists():
                raise refusal(folder / top, "folder", "somebody has made it in the meantime", "try again")
            (aside / top).rename(folder / top)
            moved.append(folder / top)
        ending = "\r\n" if file.exists() and b"\r\n" in file.read_bytes() else "\n"
        with replacing(file) as partial:
            partial.write_text(text, encoding="utf-8", newline=ending)
    except BaseException:
        for path in moved:
            shutil.rmtree(path, ignore_errors=True)
        shutil.rmtree(aside, ignore_errors=True)
        for path in fresh:
            with suppress(OSError):
                path.rmdir()
        raise
    shutil.rmtree(aside, ignore_errors=True)
    return file


def _fresh(folder: Path) -> list[Path]:
    """The folders that have to be made for a path, the innermost first."""
    return [path for path in (folder, *folder.parents) if not path.exists()]
