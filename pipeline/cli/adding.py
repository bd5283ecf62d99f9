"""The verbs `kouros motions add` and `export`: records into a site, and what it says of them out."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import aligned
from pipeline.cli.shared import Options, as_json, dry_run, say_dry

if TYPE_CHECKING:
    from pipeline.motions.proposing import Answers, MissingAnswer
    from pipeline.tools.adding import Addition


def _keyed(words: Sequence[str], option: str) -> dict[str, str]:
    """VALUE, or NAME=VALUE for one record, file or channel."""
    made = {}
    for word in words:
        name, equals, value = word.rpartition("=")
        if (equals and not name) or not value:
            raise click.BadParameter(f"{word!r}: write VALUE, or CHANNEL=VALUE", param_hint=option)
        made[name] = value
    return made


def _accepted(words: Sequence[str]) -> dict[str, str]:
    """REASON for every check that refuses, or CHECK=REASON for one; a reason may hold "=" itself behind a blank."""
    from pipeline.errors import near
    from pipeline.motions.errors import JUDGEMENTS

    made = {}
    for word in words:
        check, equals, reason = word.partition("=")
        name = check.strip().replace("-", "_")
        if not equals or " " in check.strip():
            name, reason = "", word
        elif name not in JUDGEMENTS:
            wrong = f"{check!r} is no check that may be overruled{near(name, JUDGEMENTS)}"
            raise click.BadParameter(
                f"{wrong}; write REASON, or CHECK=REASON for one of {', '.join(JUDGEMENTS)}", param_hint="--accept"
            )
        if not reason.strip().isprintable() or not reason.strip() or len(reason) > 500:
            raise click.BadParameter("give the reason, at most 500 printable characters", param_hint="--accept")
        made[name] = reason.strip()
    return made


def _unit(value: str) -> str:
    from pipeline.motions.reading import UNITS

    if value not in UNITS:
        raise click.BadParameter(f"{value!r} is not one of {', '.join(UNITS)}", param_hint="--unit")
    return value


def _direction(value: str) -> float | str:
    word = value.strip().lower()
    if word in {"up", "down"}:
        return word
    try:
        degrees = float(word)
    except ValueError:
        degrees = -1.0
    if not 0.0 <= degrees <= 360.0:
        wrong = f"{value!r} is neither degrees from 0 to 360, nor up, nor down"
        raise click.BadParameter(wrong, param_hint="--orientation")
    return degrees % 360.0


@click.command()
@click.argument("files", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="FILES...")
@click.option(
    "--site", metavar="FOLDER", help="Folder of the site; it is made where there is none.  Default: your own."
)
@click.option("--name", default="", help="Of the record; left out, station and time, or the earthquake, name it.")
@click.option("--level", default="", help="Level of shaking; left out, the site's only one, or 'design'.")
@click.option("--unit", "units", multiple=True, metavar="[CHANNEL=]UNIT", help="What no file says: m/s2, cm/s2, g, ...")
@click.option(
    "--orientation",
    "orientations",
    multiple=True,
    metavar="CHANNEL=DIRECTION",
    help="What no file says: degrees clockwise from north, up or down; CHANNEL is a code, a full id or a file.",
)
@click.option("--processed/--raw", "processed", default=None, help="Whether the source has filtered it already.")
@click.option("--channels", metavar="CHANNEL,...", default="", help="Which are taken, where there are more than three.")
@click.option("--source", default="", help="Whose record it is.")
@click.option("--licence", default="", help="Under which licence it may be used.")
@click.option("--latitude", type=click.FloatRange(-90.0, 90.0), help="Of a site that is new, degrees north.")
@click.option("--longitude", type=click.FloatRange(-180.0, 180.0), help="Of a site that is new, degrees east.")
@click.option(
    "--accept",
    "accepted",
    multiple=True,
    metavar="[CHECK=]REASON",
    help="Overrule what is refused as a matter of judgement, all of it or the check that is named; the manifest keeps "
    "the reason.  What is corrupt stays refused.",
)
@click.option("--guess", is_flag=True, help="Add what can be used, and say of the rest why not: for whole folders.")
@click.option("--page", type=click.Path(dir_okay=False, path_type=Path), help="Page of before and after to write.")
@click.option("--compare/--no-compare", default=True, help="Say what changes for the museum, as `motions compare`.")
@dry_run("Read and try the records, and say what would be added")
@as_json
@click.pass_obj
def add(
    options: Options, /, files: tuple[Path, ...], site: str | None, dry_run: bool, as_json: bool, **said: Any
) -> None:
    """Add records to a site: copy their files, write the manifest, show what was done to them and what changes.

    FILES are the files of one or more records, or folders of them, with StationXML, QuakeML and GeoJSON (of ComCat, or
    of site and stations), and the table of a PEER search, wherever they lie among them, also packed (gzip, ZIP, tar).
    What no file says is asked at a terminal; elsewhere every missing answer is named with its option, and nothing is
    written.  Nothing is ever overwritten, and whoever had approved the level has to look again.

    Example: kouros motions add CI.CLC..HN?.mseed CI.CLC.xml --site site_motions/site
    """
    from pipeline.motions.proposing import Answers
    from pipeline.operations.workspace import UsageError, folder_of_site
    from pipeline.report import Units
    from pipeline.resources import BUNDLED
    from pipeline.tools.adding import AddWish, described
    from pipeline.tools.adding import add as job

    settings = options.settings() if Path(options.config).exists() else None
    folder = folder_of_site(settings, site)
    named = site if site is not None or settings is None else settings.site.folder
    if named in BUNDLED:
        raise UsageError(f"the site {named!r} comes with Kouros and stays as it is; name a folder with --site")
    answers = Answers(
        name=said["name"],
        level=said["level"],
        units={key: _unit(value) for key, value in _keyed(said["units"], "--unit").items()},
        orientations={key: _direction(v) for key, v in _keyed(said["orientations"], "--orientation").items()},
        processed={} if said["processed"] is None else {"": said["processed"]},
        channels=[word.strip() for word in said["channels"].split(",") if word.strip()],
        source=said["source"],
        licence=said["licence"],
    )
    if "" in answers.orientations:
        raise click.BadParameter("write CHANNEL=DIRECTION, such as HN1=23", param_hint="--orientation")
    for key in ("name", "level", "source", "licence"):
        if not said[key].isprintable() or len(said[key]) > 500:
            raise click.BadParameter("at most 500 printable characters", param_hint=f"--{key}")
    accepted = _accepted(said["accepted"])
    wish = AddWish(answers, accepted, said["latitude"], said["longitude"], said["guess"], said["compare"])
    with options.console() as console:
        asking = sys.stdin.isatty() and not as_json
        done = job(
            files,
            folder,
            wish,
            settings=settings,
            units=Units(length=settings.report.length) if settings else Units(),
            page=said["page"],
            ask=_ask if asking else None,
            progress=console,
            dry_run=dry_run,
        )
    if as_json:
        click.echo(json.dumps(described(done), indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join(_lines(done, guess=wish.guess, dry=dry_run)))
    if dry_run:
        say_dry(as_json)


def _ask(questions: "Sequence[MissingAnswer]", answers: "Answers") -> "Answers":
    """Put questions to a person at a terminal, one after the other."""
    for question in questions:
        click.echo(f"\n{question.record}")
        units, directions, processed = dict(answers.units), dict(answers.orientations), dict(answers.processed)
        if question.about == "unit":
            units |= dict.fromkeys(question.handles, click.prompt(question.text, value_proc=_unit))
        elif question.about == "orientation":
            number = len(question.handles)
            told = click.prompt(f"{question.text} ({number}, with spaces)", value_proc=_several(number))
            directions |= dict(zip(question.handles, told, strict=True))
        elif question.about == "processed":
            kind = click.prompt(question.text, type=click.Choice(["raw", "processed"]))
            processed |= dict.fromkeys(question.handles, kind == "processed")
        elif question.about == "channels":
            ids = click.prompt(f"{question.text}\nTheir ids, with commas", type=str).split(",")
            answers = replace(answers, channels=[*answers.channels, *(word.strip() for word in ids)])
        else:
            answers = replace(answers, level=click.prompt(question.text, type=click.Choice(question.handles)))
        answers = replace(answers, units=units, orientations=directions, processed=processed)
    return answers


def _several(number: int) -> Callable[[str], list[float | str]]:
    def directions(value: str) -> list[float | str]:
        words = value.replace(",", " ").split()
        if len(words) != number:
            raise click.BadParameter(f"{number} are asked for, and {len(words)} were given")
        return [_direction(word) for word in words]

    return directions


def _lines(done: "Addition", *, guess: bool, dry: bool) -> list[str]:
    from pipeline.cli.shared import swap_lines
    from pipeline.quantities import G, counted

    would = "would be " if dry else ""
    rows = []
    for one in done.placed:
        found = done.measures.get(one.name)
        peaks = [f"{found['pga'] / G:.3g}", f"{100.0 * found['pgv']:.3g}"] if found else ["-", "-"]
        event = one.record.event
        size = "-" if event is None or event.magnitude is None else f"{event.magnitude:g}"
        far = "-" if one.record.distance_km is None else f"{one.record.distance_km:g}"
        rows.append([one.name, one.level, size, far, *peaks, f"{would}added"])
    rows += [[name, "-", "-", "-", "-", "-", f"there already: {record}"] for name, record in done.already]
    if guess:
        rows += [[one.name, "-", "-", "-", "-", "-", f"left: {one.reason}"] for one in done.left]
    lines = aligned(["record", "level", "M", "km", "PGA g", "PGV cm/s", "what was made of it"], rows, words={0, 1, 6})
    if guess:
        lines += [f"{one.name}: doubtful: {doubt}" for one in done.placed for doubt in one.doubts]
    else:
        for one in done.placed:
            lines += ["", f"{one.name}: {', '.join(one.record.all_files)}", *(f"  {told}" for told in one.told)]
        lines += [f"left: {one.name}: {one.reason}" for one in done.left]
    lines += [f"not looked into: {name}" for name in done.passed_over[:20]]
    if len(done.passed_over) > 20:
        lines.append(f"and {len(done.passed_over) - 20:,} more were not looked into")
    lines += ["", *done.told]
    if done.withdrawn:
        lines.append(f"No longer approved ({done.withdrawn}): there are new records to look at")
    if done.placed:
        lines.append(f"{'Would write' if dry else 'Wrote'} {done.file}: {counted(len(done.placed), 'record')}")
    else:
        lines.append(f"Nothing to add: {done.file} is as it was")
    if done.page is not None:
        lines.append(f"Before and after: {done.page}")
    if done.swap is not None:
        lines += ["", *swap_lines(done.swap)]
    if done.placed and not dry:
        lines += ["", "Nobody has approved it yet: approved_by and approved_on of the level are a person's to write"]
    return lines


@click.command()
@click.argument("site", required=False)
@click.option("--quakeml", type=click.Path(dir_okay=False, path_type=Path), help="File for the records' earthquakes.")
@click.option("--geojson", type=click.Path(dir_okay=False, path_type=Path), help="File for site, stations, epicentres.")
@dry_run("Read the manifest, and say what would be written")
@click.pass_obj
def export(options: Options, site: str | None, quakeml: Path | None, geojson: Path | None, dry_run: bool) -> None:
    """Write the earthquakes of a site's records as QuakeML, and its place and stations as GeoJSON.

    `kouros motions add` reads both.

    Example: kouros motions export demo_suite --geojson places.geojson --quakeml events.xml
    """
    from pipeline.operations.workspace import folder_of_site
    from pipeline.tools.strong_motion import export as job

    settings = options.settings() if Path(options.config).exists() else None
    for path in job(folder_of_site(settings, site), quakeml, geojson, dry_run=dry_run):
        click.echo(f"{'would write' if dry_run else 'wrote'} {path}")
    if dry_run:
        say_dry(wanted_json=False)
