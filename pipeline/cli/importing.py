"""The verb `import`: the museum's records into the inventory, and its earlier versions."""

import json
import os
import shlex
import sys
import textwrap
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import listed
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.quantities import counted

if TYPE_CHECKING:
    from pipeline.collection.inventory import Difference
    from pipeline.collection.reading import Reading
    from pipeline.night.importing import Imported, Proposed
    from pipeline.tools.sheet_answers import SheetTaken

_LEFT = 15
"""Columns that are listed as not read at most."""


@click.command("import")
@click.argument("source", required=False)
@click.option("--mapping", help="A preset (see --presets) or the file of your mapping; default: the settings'.")
@click.option("--shrink-limit", type=click.FloatRange(0.0, 1.0), help="Share of objects that may vanish at once.")
@dry_run("Read, and say what would change, or be refused")
@click.option("--guess", is_flag=True, help="Propose a mapping from the columns, and show ten rows as understood.")
@click.option("--table", metavar="NAME", help="With --guess: the workbook's sheet, or the database's table or SELECT.")
@click.option(
    "--choose",
    multiple=True,
    metavar="KEY=WHAT",
    help="With --guess: a field's column (gallery=Standort), its unit (height_m.unit=mm), header_row=4, records=items.",
)
@click.option("--write", type=click.Path(dir_okay=False, path_type=Path), help="With --guess: write it here, unasked.")
@click.option(
    "--sheet",
    is_flag=True,
    help="SOURCE is a survey that was filled in: its measurements go over the inventory, its rules into the settings, "
    "its decisions into their log.",
)
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
    table: str | None,
    choose: tuple[str, ...],
    write: Path | None,
    sheet: bool,
    presets: bool,
    versions: bool,
    return_to: int | None,
    as_json: bool,
) -> None:
    """Read the museum's records into Kouros's inventory, by a mapping.

    SOURCE is a file (CSV, TSV, XLSX, ODS, JSON, XML, among it LIDO, Adlib and MuseumPlus RIA, Linked Art), a folder of
    CSV files that are tables of one export, a folder of JSON or XML records, or the URL of a database; ${NAME} in a URL
    is taken from the environment.

    \b
    Example: kouros import export.csv --mapping carnegie --dry-run
    Example: kouros import export.xlsx --guess
    Example: kouros import 'postgresql://reader:${TMS_PASSWORD}@server/tms' --guess --table tms.objects
    """
    if (source is not None) + presets + versions + (return_to is not None) != 1:
        raise click.UsageError("give a SOURCE, or one of --presets, --versions, --return-to VERSION")
    if table is not None and not guess:
        raise click.UsageError("--table is for --guess; a mapping says in its [source] which sheet or table is read")
    if choose and not guess:
        raise click.UsageError("--choose is for --guess; in a mapping, change the line itself")
    if guess and sheet:
        raise click.UsageError("--sheet reads a survey's sheet by its own mapping, and --guess proposes one: give one")
    if presets:
        _presets(as_json)
    elif versions:
        _versions(options, as_json)
    elif return_to is not None:
        _return(options, return_to, dry_run, as_json)
    elif source is not None and guess:
        _guess(source, table, _choices(choose), write, dry_run, as_json)
    elif source is not None and sheet:
        _sheet(options, source, dry_run, as_json)
    elif source is not None:
        _import(options, source, mapping, shrink_limit, dry_run, as_json)
    if dry_run:
        say_dry(as_json)


def _presets(wanted_json: bool) -> None:
    from pipeline.night.importing import presets

    found = presets()
    if wanted_json:
        plain = {name: {"for": p.about, "expects": p.expects, "file": str(p.file)} for name, p in found.items()}
        click.echo(json.dumps(plain, indent=2, ensure_ascii=False))
        return
    for name, preset in found.items():
        click.echo(f"{name:<18} {preset.about}")
        click.echo(textwrap.fill(preset.expects, 100, initial_indent=" " * 19, subsequent_indent=" " * 19))
    click.echo("\ntheir files, to begin your own from:")
    for name, preset in found.items():
        click.echo(f"{name:<18} {preset.file}")
    example = next(iter(found.values())).file
    copy = "copy" if os.name == "nt" else "cp"
    click.echo(
        f"\ncopy one ({copy} {shlex.quote(str(example))} ours.toml), change what differs, "
        f'and name it: --mapping ours.toml, or mapping = "ours.toml" in kouros.toml'
    )


def _versions(options: Options, wanted_json: bool) -> None:
    from pipeline.collection.inventory import versions
    from pipeline.operations.workspace import open_workspace

    found = versions(open_workspace(options.settings()).engine)
    if wanted_json:
        click.echo(json.dumps([asdict(info) for info in found], indent=2))
        return
    if not found:
        click.echo("nothing was imported yet")
    for info in found:
        what = f"as version {info.returned_to}" if info.returned_to is not None else info.source
        click.echo(
            f"{info.id:>5}  {info.imported_at}  {info.items:>9,} {'object ' if info.items == 1 else 'objects'}  "
            f"({info.added:,} new, {info.removed:,} gone, {info.changed:,} changed)  {what}"
        )


def _choices(given: tuple[str, ...]) -> dict[str, str]:
    found = {}
    for one in given:
        key, sign, what = one.partition("=")
        if not (key.strip() and sign and what.strip()):
            raise click.UsageError(f"--choose {one!r}: needs KEY=WHAT, such as gallery=Standort or height_m.unit=mm")
        found[key.strip()] = what.strip()
    return found


def _guess(
    source: str, table: str | None, choices: dict[str, str], target: Path | None, dry_run: bool, wanted_json: bool
) -> None:
    from pipeline.night.importing import proposed

    if dry_run and target is not None:
        raise click.UsageError("--write writes the mapping, and --dry-run writes nothing: leave one of them out")
    found = proposed(source, table, choices=choices)
    asking = target is None and not (wanted_json or dry_run) and sys.stdin.isatty()
    if asking and found.guess.questions:
        found = proposed(source, table, choices=choices | _answers(found))
    if wanted_json:
        answer = {
            "mapping": found.guess.text,
            "doubts": found.guess.doubts,
            "questions": [asdict(question) for question in found.guess.questions],
            "sure": found.guess.sure,
            "left": found.guess.left,
            "unknown": found.unknown,
            "rows": found.reading.rows,
            "examples": found.examples,
            "rejected": [asdict(r) for r in found.reading.rejected],
            "problems": _problems(found.reading),
        }
        click.echo(json.dumps(answer, indent=2, ensure_ascii=False))
    else:
        _show(found)
    if asking:
        name = f"{found.name}.toml"
        if click.confirm(f"Is that right? Write it to {name}?"):
            target = Path(name)
    if target is not None:
        with target.open("x", encoding="utf-8") as stream:
            stream.write(found.guess.text)
        now = shlex.join(["kouros", "import", found.shown, "--mapping", str(target), "--dry-run"])
        click.echo(f"written: {target}; now: {now}", err=wanted_json)
    elif not (wanted_json or dry_run):
        click.echo("nothing was written; --write FILE writes it")


def _answers(found: "Proposed") -> dict[str, str]:
    """Ask a person at a terminal what the source does not tell; an empty answer takes what was guessed."""
    answers = {}
    for question in found.guess.questions:
        for number, option in enumerate(question.options, start=1):
            click.echo(f"  {number}  {option}")
        at = question.options.index(question.taken) + 1 if question.taken in question.options else 1
        chosen = click.prompt(question.text, type=click.IntRange(1, len(question.options)), default=at)
        answers[question.key] = question.options[chosen - 1]
    return answers


def _show(found: "Proposed") -> None:
    click.echo(found.guess.text)
    reading = found.reading
    click.echo(
        f"{counted(reading.rows, 'row')}, {counted(len(reading.items), 'object')}, {len(reading.rejected):,} refused, "
        f"{_doubtful(reading):,} doubtful; {counted(len(found.examples), 'of them', 'of them')} as understood:"
    )
    for line in found.examples:
        click.echo(f"  {line}")
    listed("refused", [f"{r.message}; {r.remedy}" for r in reading.rejected], most=3)
    listed("doubtful", _kinds(reading), most=5)
    listed("sure", list(found.guess.sure))
    if left := found.guess.left:
        more = f" and {len(left) - _LEFT} more" if len(left) > _LEFT else ""
        listed(
            "not read", [f"{', '.join(repr(name[:60]) for name in left[:_LEFT])}{more}: no field takes these columns"]
        )
    listed("to look at", [*found.guess.doubts, *filter(None, [found.unknown])])
    listed(
        "to choose",
        [
            f"{question.text} {question.taken!r} is taken; --choose {question.key}="
            f"{'|'.join(option for option in question.options if option != question.taken) or 'NAME'} takes another"
            for question in found.guess.questions
        ],
    )
    listed("suspicion", [f"{s.message}; {s.remedy}" for s in reading.suspicions])


def _doubtful(reading: "Reading") -> int:
    return sum(1 for item in reading.items if item.problems)


def _sheet(options: Options, source: str, dry_run: bool, wanted_json: bool) -> None:
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import locked, open_workspace
    from pipeline.tools.sheet_answers import take_sheet

    with rehearsed(options.settings(), dry_run) as settings, locked(settings):
        taken = take_sheet(open_workspace(settings), Path(options.config), Path(source), dry_run=dry_run)
    reading, changes = taken.reading, taken.changes
    problems = [] if reading is None else _problems(reading)
    refused = () if reading is None else reading.rejected
    if wanted_json:
        from pipeline.records import Decision
        from pipeline.store import codec

        rejected = [asdict(r) for r in refused]
        found: dict[str, Any] = {"changes": None if changes is None else asdict(changes), "unknown": taken.unknown}
        found |= {"problems": problems, "rejected": rejected, "rules": taken.rules}
        found |= {"decisions": [codec.plain(Decision, one) for one in taken.decisions], "known_decisions": taken.known}
        found |= {"refused": [asdict(fault) for fault in taken.faults], "marked": taken.marked and str(taken.marked)}
        click.echo(json.dumps(found, indent=2))
        _not_empty(taken, source)
        return
    listed("refused", [str(fault) for fault in taken.faults])
    listed("not in the inventory", taken.unknown)
    listed("decided", [f"{one.object_number}: {one.matter}, {one.by}" for one in taken.decisions])
    if changes is not None:
        _changed(changes)
        given = counted(len(changes.changed), "object")
        was = "would be" if dry_run else "was" if len(changes.changed) == 1 else "were"
        click.echo(f"{Path(source).name}: {given} {was} given measurements")
    if taken.known:
        click.echo(f"{counted(taken.known, 'decision')} had been written down before")
    if taken.marked is not None:
        cells = counted(len(taken.faults), "refused cell")
        click.echo(f"{cells} {'would be' if dry_run else 'marked, with what mends each,'} in {taken.marked}")
    if taken.rules:
        click.echo(f"{'would be added' if dry_run else 'added'} to {options.config}:\n\n{taken.rules}")
    _not_empty(taken, source)


def _not_empty(taken: "SheetTaken", source: str) -> None:
    """Raise where all was refused: who calls this in a script must learn of it."""
    if taken.empty:
        from pipeline.collection.errors import CollectionError

        raise CollectionError(
            f"{Path(source).name}: no row fills in anything for an object of the inventory; "
            "correct what is refused, and lay it over again"
        )


def _return(options: Options, version: int, dry_run: bool, wanted_json: bool) -> None:
    from pipeline.night.importing import go_back
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import locked, open_workspace

    with rehearsed(options.settings(), dry_run) as settings, locked(settings):
        changes = go_back(open_workspace(settings), version, dry_run=dry_run)
    if wanted_json:
        click.echo(json.dumps(asdict(changes), indent=2))
        return
    c = changes.counts
    click.echo(
        f"inventory: {counted(c.after, 'object')}, as after import {version} "
        f"({c.added:,} new, {c.removed:,} gone, {c.changed:,} changed). Nights leave it so until the source changes."
    )


def _import(
    options: Options, source: str, mapping: str | None, shrink_limit: float | None, dry_run: bool, wanted_json: bool
) -> None:
    from pipeline.night.importing import import_collection
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import locked, open_workspace

    with rehearsed(options.settings(), dry_run) as settings, locked(settings):
        wanted = settings.collection
        limit = wanted.shrink_limit if shrink_limit is None else shrink_limit
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
        "doubtful": _doubtful(reading),
        "display_said": done.display_said,
        "unknown": done.unknown,
        "suspicions": [asdict(s) for s in reading.suspicions],
        "choices": [asdict(s) for s in reading.choices],
        "problems": [{"object_number": item.object_number, **asdict(p)} for item, p in done.problems],
        "counts": None if done.changes is None else asdict(done.changes.counts),
        "changes": None if done.changes is None else asdict(done.changes),
        "log": None if done.log is None else str(done.log),
    }


def _tell(done: "Imported", *, dry_run: bool) -> None:
    from pipeline.night.reading_summary import unsaid

    reading = done.reading
    click.echo(
        f"{reading.source}: {counted(reading.rows, 'row')}, {counted(len(reading.items), 'object')}, "
        f"{len(reading.rejected):,} rejected"
    )
    listed("rejected", [f"{r.message}; {r.remedy}" for r in reading.rejected])
    listed("suspicion", [f"{s.message}; {s.remedy}" for s in reading.suspicions])
    listed("choice", [f"{s.message}; {s.remedy}" for s in reading.choices])
    listed("problem", _kinds(reading))
    if done.changes is None:
        return
    c = done.changes.counts
    if c.added < c.after:
        listed("new", list(done.changes.added))
    listed("gone", list(done.changes.removed))
    said = "the same name, place and sizes; what was decided of the old number does not follow it"
    listed("renumbered", [f"{new} is likely what was {old}: {said}" for old, new in done.changes.renumbered])
    _changed(done.changes)
    click.echo(f"inventory: {counted(c.after, 'object')} ({c.added:,} new, {c.removed:,} gone, {c.changed:,} changed)")
    chosen = f", {len(reading.choices):,} settled by choice" if reading.choices else ""
    click.echo(
        f"read: {counted(reading.rows, 'row')}, {len(reading.rejected):,} refused, {_doubtful(reading):,} doubtful"
        f"{chosen}; the next report names each"
    )
    if not done.display_said:
        click.echo(unsaid(sum(item.on_display for item in reading.items)))
    if done.unknown:
        click.echo(done.unknown)
    if dry_run:
        return
    if done.log is not None:
        click.echo(f"log: {done.log}")
    else:
        click.echo("nothing has changed since the last import")


def _problems(reading: "Reading") -> list[str]:
    return [
        f"row {place[0]}, {item.object_number}: {p.field}: {p.message}; {p.remedy}"
        for item, place in zip(reading.items, reading.places, strict=True)
        for p in item.problems
    ]


def _kinds(reading: "Reading") -> list[str]:
    """Return the doubts by what mends them, the most frequent first, each with how many they are and one of them."""
    count: Counter[tuple[str, str]] = Counter()
    first: dict[tuple[str, str], str] = {}
    for item, (row, _) in zip(reading.items, reading.places, strict=True):
        for one in item.problems:
            kind = (one.field, one.remedy)
            count[kind] += 1
            first.setdefault(kind, f"row {row}, {item.object_number}: {one.field}: {one.message}; {one.remedy}")
    return [first[kind] + (f" ({n:,} such)" if n > 1 else "") for kind, n in count.most_common()]


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
