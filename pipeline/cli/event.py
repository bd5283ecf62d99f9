"""The verb `kouros event`: an earthquake has just happened; where to look first."""

import json
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import aligned, printable
from pipeline.cli.shared import Options, as_json, dry_run, say_dry

if TYPE_CHECKING:
    from pipeline.tools.event import EventDone, TypedShaking

SECONDS = 4.0
"""For running models: with these a museum of 2,000 objects has both its answers within 10."""

_LISTED = 10
"""Galleries and objects that are printed."""


@click.command()
@click.argument("files", nargs=-1, type=click.Path(path_type=Path), metavar="[FILE]...")
@click.option("--at", metavar="LAT,LON", help="Where the museum is, degrees. Default: as the site's manifest says.")
@click.option("--pga", type=float, help="Peak ground acceleration there in g, where you have no file.")
@click.option("--pgv", type=float, help="Peak ground velocity there in cm/s; estimated from --pga where left out.")
@click.option("--ln-sd", "ln_sd", type=float, help="How sure these are: standard deviation of ln. Default: 0.86.")
@click.option(
    "--drill", is_flag=True, help="An exercise: the strongest level of the site, as if it had come; it is timed."
)
@click.option(
    "--report",
    type=click.Path(path_type=Path),
    help="What people found: a CSV file or a workbook, columns object and state (standing, moved 2 cm, fallen, "
    "broken, or these in another language of the pages).  Without FILE: after the earthquake answered last.",
)
@click.option(
    "--watch",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="FOLDER",
    help="Answer what comes into this folder, until it is stopped.",
)
@click.option(
    "--seconds",
    type=click.FloatRange(0.0, 86_400.0),
    default=SECONDS,
    show_default=True,
    help="Time for running models under the motions of the earthquake, those first of which most is lost; 0: none.",
)
@click.option("--once", is_flag=True, help="With --watch: answer what is there now, and end, as for cron.")
@dry_run("Say what is probably down")
@as_json
@click.pass_obj
def event(
    options: Options,
    files: tuple[Path, ...],
    at: str | None,
    pga: float | None,
    pgv: float | None,
    ln_sd: float | None,
    report: Path | None,
    drill: bool,
    watch: Path | None,
    seconds: float,
    once: bool,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Say after an earthquake what is probably down, where to look first, and what not to touch.

    FILE is what a museum gets: ShakeMap's grid.xml, stationlist.json or stationlist.xml, a ShakeAlert message (each
    may be packed by gzip), or records of the museum's own instrument in any format that is read.  Several are of one
    earthquake; the museum's own record is believed most, a first alert least.  Answers come from the newest run, and
    none is ever replaced: each has a folder under events/, and "latest" there leads to the best.

    \b
    Example: kouros event grid.xml --at 37.77,-122.47
    Example: kouros event --pga 0.144 --pgv 18.9 --ln-sd 0.3
    Example: kouros event --report found.xlsx
    Example: kouros event --drill
    Example: kouros event --watch drop

    \b
    Exit codes besides those of kouros: 0 answered, or answered before; 2 a message that cannot be used, of another
    place, cancelled, or no run to answer from: earlier answers stay; 4 a record that cannot be used; 6 another
    process watches; with --watch --once 3: something was refused; 130 and 143 stopped.
    """
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.job_monitor import tell_shaken
    from pipeline.operations.secrets import hider
    from pipeline.operations.workspace import open_workspace
    from pipeline.report.files.event_files import document_text
    from pipeline.tools.event import answer_again, answer_event, exercise

    if watch is not None:
        others = (files, pga, pgv, ln_sd, report, drill, dry_run)
        if any(one not in (None, False, ()) for one in others):
            raise click.UsageError("--watch takes what comes into its folder: leave files, numbers and the rest out")
        _watch(options, watch, _place(at), seconds, once=once, as_json=as_json)
        return
    if once:
        raise click.UsageError("--once goes with --watch FOLDER")
    began = perf_counter()
    place, typed = _place(at), _typed(pga, pgv, ln_sd)
    with rehearsed(options.settings(), dry_run) as settings:
        workspace, quake = open_workspace(settings), None
        if drill:
            if files or typed is not None:
                raise click.UsageError("--drill has a shaking of its own: leave files, --pga and --pgv out")
            typed, quake = exercise(workspace)
        alone = report is not None and not files and typed is None
        if alone:
            if place is not None:
                raise click.UsageError("--at says where a message is read for: give its FILE too, or leave --at out")
            done = answer_again(workspace, report=report, dry_run=dry_run)
        else:
            done = answer_event(
                workspace, files, at=place, typed=typed, report=report, drill=quake, seconds=seconds, dry_run=dry_run
            )
        exercised = drill or (alone and done.document["event"]["scenario"])
        if not (dry_run or done.again or exercised):
            tell_shaken(settings, done.sentence, done.document, hider(settings))
    if as_json:
        click.echo(document_text(done.document), nl=False)
    else:
        click.echo("\n".join(map(printable, _lines(done, dry=dry_run))))
        if drill:
            click.echo(f"This was an exercise.  From the question to the page it took {perf_counter() - began:.1f} s.")
    if dry_run:
        say_dry(as_json)


def _watch(
    options: Options, folder: Path, place: tuple[float, float] | None, seconds: float, *, once: bool, as_json: bool
) -> None:
    """Answer what comes into a folder; a line for each of it, or one JSON object a line."""
    from pipeline.operations.job_monitor import tell_shaken
    from pipeline.operations.secrets import hider
    from pipeline.tools.event_watch import DropFolder, Dropped, watch

    settings = options.settings()

    def tell(came: Dropped) -> None:
        names = ", ".join(file.name for file in came.files)
        done = came.done
        if as_json:
            told = {"files": [str(file) for file in came.files], "refused": came.refusal or None, "later": came.later}
            more = {} if done is None else {"again": done.again, "newest": done.newest, **_brief(done)}
            click.echo(json.dumps({**told, **more}, allow_nan=False))
        elif done is None:
            again = " (it is tried again)" if came.later else ""
            click.echo(printable(f"{names}: refused{again}: {came.refusal}"), err=True)
        else:
            said = "answered before" if done.again else str(done.folder / "index.html")
            click.echo(printable(f"{names}: {done.sentence} {said}"))
        if done is not None and not done.again:
            tell_shaken(settings, done.sentence, done.document, hider(settings))

    drop = DropFolder(settings, folder, place, seconds=seconds)
    if not once:
        click.echo(printable(f"watching {folder}; Ctrl-C ends it"), err=True)
    refused = watch(drop, tell, once=once)
    if refused:
        raise click.exceptions.Exit(3)


def _brief(done: "EventDone") -> dict[str, Any]:
    return {name: done.document[name] for name in ("event", "shaking", "expected")}


def _place(at: str | None) -> tuple[float, float] | None:
    if at is None:
        return None
    try:
        north, east = (float(part) for part in at.split(","))
    except ValueError:
        raise click.UsageError(f"--at {at!r}: give degrees north and east, such as 37.77,-122.47") from None
    if not (-90.0 <= north <= 90.0 and -180.0 <= east <= 180.0):
        raise click.UsageError(f"--at {at!r}: is no place on earth; latitude comes first")
    return north, east


def _typed(pga: float | None, pgv: float | None, ln_sd: float | None) -> "TypedShaking | None":
    from pipeline.tools.event import TypedShaking

    if pga is None:
        if pgv is not None or ln_sd is not None:
            raise click.UsageError("--pgv and --ln-sd say more of --pga: give that too")
        return None
    return TypedShaking(pga, pgv, ln_sd)


def _lines(done: "EventDone", *, dry: bool) -> list[str]:
    document = done.document
    shaking = document["shaking"]
    lines = [done.sentence] if done.taken is None else [done.taken.sentence, done.sentence]
    lines.append(
        f"Shaking at the museum: {shaking['pga_g']:.3f} g (ln sd {shaking['pga_ln_sd']:.2f}), "
        f"{shaking['pgv_cm_s']:.1f} cm/s (ln sd {shaking['pgv_ln_sd']:.2f}), from {shaking['from']}"
    )
    lines += document["event"]["notes"]
    ran, under = document["event"]["modelled"], document["event"]["modelled_under"]
    if ran:
        lines.append(f"Of {ran:,} objects of which most is lost all models were run again, under {under}.")
    rows = [
        (one["gallery"] or "no gallery recorded", f"{one['fallen']:.1f}", f"{one['low']} to {one['high']}",
         f"{one['expected_loss']:.1f}")
        for one in document["galleries"][:_LISTED]
    ]  # fmt: skip
    lines += ["", *aligned(("gallery", "fallen", "9 of 10", "loss"), rows, words={0})]
    objects = [
        (f"{one['object_number']} {one['title']}"[:60], one["gallery"][:30], f"{one['probability'] or 0.0:.0%}",
         f"{one['states'].get('falls', 0.0):.0%}", f"{one['expected_loss']:.2f}")
        for one in document["objects"][:_LISTED]
    ]  # fmt: skip
    lines += ["", *aligned(("object", "gallery", "harmed", "fallen", "loss"), objects, words={0, 1})]
    if not done.newest:
        lines += ["", "An answer that is believed more is there already: it stays the one that is shown."]
    said = "answered before, nothing was done:" if done.again else "would write" if dry else "wrote"
    return [*lines, "", f"{said} {done.folder / 'index.html'}"]
