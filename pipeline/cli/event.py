"""The verb `kouros event`: an earthquake has just happened; where to look first."""

import json
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import aligned, printable
from pipeline.cli.options import Options, as_json, dry_run, say_dry

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pipeline.tools.event import EventDone, TypedShaking

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
    help="What people found: a CSV file, columns object and state (standing, moved, fallen, broken).",
)
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
    Example: kouros event --drill
    """
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.job_monitor import tell_shaken
    from pipeline.operations.secrets import hider
    from pipeline.operations.workspace import open_workspace
    from pipeline.tools.event import answer_event, exercise

    began = perf_counter()
    place, typed = _place(at), _typed(pga, pgv, ln_sd)
    with rehearsed(options.settings(), dry_run) as settings:
        workspace, quake = open_workspace(settings), None
        if drill:
            if files or typed is not None:
                raise click.UsageError("--drill has a shaking of its own: leave files, --pga and --pgv out")
            typed, quake = exercise(workspace)
        done = answer_event(workspace, files, at=place, typed=typed, report=report, drill=quake, dry_run=dry_run)
        if not (dry_run or done.again or drill):
            tell_shaken(settings, _sentence(done.document), done.document, hider(settings))
    if as_json:
        click.echo(json.dumps(done.document, indent=2, allow_nan=False))
    else:
        click.echo("\n".join(map(printable, _lines(done, dry=dry_run))))
        if drill:
            click.echo(f"This was an exercise.  From the question to the page it took {perf_counter() - began:.1f} s.")
    if dry_run:
        say_dry(as_json)


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


def _sentence(document: "Mapping[str, Any]") -> str:
    down, quake = document["expected"], document["event"]
    name = quake["name"] or quake["id"] or "an earthquake"
    return (
        f"After {name}: of {len(document['objects']):,} objects on display about {down['fallen']:,.0f} have probably "
        f"fallen ({down['low']:,} to {down['high']:,} in 9 of 10 cases)."
    )


def _lines(done: "EventDone", *, dry: bool) -> list[str]:
    document = done.document
    shaking = document["shaking"]
    lines = [_sentence(document)]
    lines.append(
        f"Shaking at the museum: {shaking['pga_g']:.3f} g (ln sd {shaking['pga_ln_sd']:.2f}), "
        f"{shaking['pgv_cm_s']:.1f} cm/s (ln sd {shaking['pgv_ln_sd']:.2f}), from {shaking['from']}"
    )
    lines += document["event"]["notes"]
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
