"""The verb `import`: the museum's records into the inventory, and its earlier versions."""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import listed
from pipeline.cli.options import Options, as_json

if TYPE_CHECKING:
    from pipeline.collection.inventory import Difference
    from pipeline.collection.reading import Reading
    from pipeline.jobs.importing import Imported


@click.command("import")
@click.argument("source", required=False)
@click.option("--mapping", help="A preset (see --presets) or the file of your mapping; default: the settings'.")
@click.option("--shrink-limit", type=click.FloatRange(0.0, 1.0), help="Share of objects that may vanish at once.")
@click.option("--dry-run", is_flag=True, help="Read, and say what would change; write nothing.")
@click.option("--guess", is_flag=True, help="Propose a mapping from the columns, and show ten rows as understood.")
@click.option("--write", type=click.Path(dir_okay=False, path_type=Path), help="With --guess: write it here, unasked.")
@click.option("--sheet", is_flag=True, help="SOURCE is a survey's sheet that was filled in: lay it over the inventory.")
@click.option("--presets", is_flag=True, help="List the mappings that come with Kouros.")
@click.option("--versions", is_flag=True, help="List the versions of the inventory, one for each import.")
@click.option("--return-to", type=int, metavar="VERSION", help="Make the inventory what it was after that import.")
@as_json
@click.pass_obj
def import_(
    options: Options,
    source: str | None,
    mapping: str | None,
    shrink_limit: float | None,
    dry_run: bool,
    guess: bool,
    write: Path | None,
    sheet: bool,
    presets: bool,
    versions: bool,
    return_to: int | None,
    as_json: bool,
) -> None:
    """Read the museum's records into Kouros's inventory, by a mapping.

    SOURCE is a file (CSV, TSV, XLSX, LIDO) or the URL of a database; ${NAME} in a URL is taken from the environment.

    Example: kouros import export.csv --mapping carnegie --dry-run
    """
    if (source is not None) + presets + versions + (return_to is not None) != 1:
        raise click.UsageError("give a SOURCE, or one of --presets, --versions, --return-to VERSION")
    if presets:
        _presets(as_json)
    elif versions:
        _versions(options, as_json)
    elif return_to is not None:
        _return(options, return_to, as_json)
    elif source is not None and guess:
        _guess(Path(source), write, as_json)
    elif source is not None and sheet:
        _sheet(options, source, as_json)
    elif source is not None:
        _import(options, source, mapping, shrink_limit, dry_run, as_json)


def _presets(wanted_json: bool) -> None:
    from pipeline.jobs.importing import presets

    found = presets()
    if wanted_json:
        click.echo(json.dumps(found, indent=2))
        return
    for name, about in found.items():
        click.echo(f"{name:<18} {about}")


def _versions(options: Options, wanted_json: bool) -> None:
    from pipeline.collection.inventory import versions
    from pipeline.jobs.workspace import open_workspace

    found = versions(open_workspace(options.settings()).engine)
    if wanted_json:
        click.echo(json.dumps([asdict(info) for info in found], indent=2))
        return
    if not found:
        click.echo("nothing was imported yet")
    for info in found:
        what = f"as version {info.returned_to}" if info.returned_to is not None else info.source
        click.echo(
            f"{info.id:>5}  {info.imported_at}  {info.items:>9,} objects  "
            f"({info.added:,} new, {info.removed:,} gone, {info.changed:,} changed)  {what}"
        )


def _guess(source: Path, target: Path | None, wanted_json: bool) -> None:
    from pipeline.jobs.importing import proposed

    found = proposed(source)
    if wanted_json:
        answer = {
            "mapping": found.guess.text,
            "doubts": found.guess.doubts,
            "rows": found.rows,
            "examples": found.examples,
        }
        click.echo(json.dumps(answer, indent=2, ensure_ascii=False))
    else:
        click.echo(found.guess.text)
        click.echo(f"{found.rows:,} rows, {found.items:,} objects; ten of them as understood:")
        for line in found.examples:
            click.echo(f"  {line}")
        listed("to look at", list(found.guess.doubts))
        listed("suspicion", [f"{s.message}; {s.remedy}" for s in found.suspicions])
    if target is None and not wanted_json and sys.stdin.isatty():
        name = source.with_suffix(".toml").name
        if click.confirm(f"Is that right? Write it to {name}?"):
            target = Path(name)
    if target is not None:
        with target.open("x", encoding="utf-8") as stream:
            stream.write(found.guess.text)
        click.echo(f"written: {target}; now: kouros import {source.name} --mapping {target} --dry-run", err=wanted_json)
    elif not wanted_json:
        click.echo("nothing was written; --write FILE writes it")


def _sheet(options: Options, source: str, wanted_json: bool) -> None:
    from pipeline.jobs.survey import add_measurements
    from pipeline.jobs.workspace import locked, open_workspace

    settings = options.settings()
    with locked(settings):
        reading, changes, unknown = add_measurements(open_workspace(settings), Path(source))
    problems = _problems(reading)
    if wanted_json:
        rejected = [asdict(r) for r in reading.rejected]
        found = {"changes": asdict(changes), "unknown": unknown, "problems": problems, "rejected": rejected}
        click.echo(json.dumps(found, indent=2))
        return
    listed("rejected", [f"{r.message}; {r.remedy}" for r in reading.rejected])
    listed("problem", problems)
    listed("not in the inventory", unknown)
    _changed(changes)
    click.echo(f"{reading.source}: {len(changes.changed):,} objects were given measurements")


def _return(options: Options, version: int, wanted_json: bool) -> None:
    from pipeline.jobs.importing import go_back
    from pipeline.jobs.workspace import locked, open_workspace

    settings = options.settings()
    with locked(settings):
        changes = go_back(open_workspace(settings), version)
    if wanted_json:
        click.echo(json.dumps(asdict(changes), indent=2))
        return
    c = changes.counts
    click.echo(
        f"inventory: {c.after:,} objects, as after import {version} "
        f"({c.added:,} new, {c.removed:,} gone, {c.changed:,} changed). Nights leave it so until the source changes."
    )


def _import(
    options: Options, source: str, mapping: str | None, shrink_limit: float | None, dry_run: bool, wanted_json: bool
) -> None:
    from pipeline.jobs.importing import import_collection
    from pipeline.jobs.workspace import locked, open_workspace

    settings = options.settings()
    wanted = settings.collection
    limit = wanted.shrink_limit if shrink_limit is None else shrink_limit
    with locked(settings):
        workspace = open_workspace(settings)
        done = import_collection(workspace, source, mapping or wanted.mapping, shrink_limit=limit, dry_run=dry_run)
    if wanted_json:
        click.echo(json.dumps(_plain(done), indent=2))
    else:
        _tell(done, dry_run=dry_run)


def _plain(done: "Imported") -> dict[str, Any]:
    reading = done.reading
    return {
        "source": reading.source,
        "rows": reading.rows,
        "items": len(reading.items),
        "rejected": [asdict(r) for r in reading.rejected],
        "doubtful": sum(1 for item in reading.items if item.problems),
        "display_said": done.display_said,
        "suspicions": [asdict(s) for s in reading.suspicions],
        "problems": [{"object_number": item.object_number, **asdict(p)} for item, p in done.problems],
        "counts": None if done.changes is None else asdict(done.changes.counts),
        "changes": None if done.changes is None else asdict(done.changes),
        "log": None if done.log is None else str(done.log),
    }


def _tell(done: "Imported", *, dry_run: bool) -> None:
    from pipeline.jobs.readings import unsaid

    reading = done.reading
    click.echo(
        f"{reading.source}: {reading.rows:,} rows, {len(reading.items):,} objects, {len(reading.rejected):,} rejected"
    )
    listed("rejected", [f"{r.message}; {r.remedy}" for r in reading.rejected])
    listed("suspicion", [f"{s.message}; {s.remedy}" for s in reading.suspicions])
    listed("problem", _problems(reading))
    if done.changes is None:
        return
    c = done.changes.counts
    listed("new", list(done.changes.added))
    listed("gone", list(done.changes.removed))
    _changed(done.changes)
    click.echo(f"inventory: {c.after:,} objects ({c.added:,} new, {c.removed:,} gone, {c.changed:,} changed)")
    doubtful = sum(1 for item in reading.items if item.problems)
    click.echo(
        f"read: {reading.rows:,} rows, {len(reading.rejected):,} refused, {doubtful:,} doubtful; "
        "the next report names each"
    )
    if not done.display_said:
        click.echo(unsaid(sum(item.on_display for item in reading.items)))
    if dry_run:
        click.echo("dry run: nothing was written")
    elif done.log is not None:
        click.echo(f"log: {done.log}")
    else:
        click.echo("nothing has changed since the last import")


def _problems(reading: "Reading") -> list[str]:
    return [
        f"row {place[0]}, {item.object_number}: {p.field}: {p.message}; {p.remedy}"
        for item, place in zip(reading.items, reading.places, strict=True)
        for p in item.problems
    ]


def _changed(changes: "Difference") -> None:
    listed(
        "changed",
        [
            f"{number}: {field}: {_short(old)} -> {_short(new)}"
            for number, fields in changes.changed.items()
            for field, (old, new) in fields.items()
            if field != "provenance"
        ],
    )


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 80 else f"{text[:80]}..."
