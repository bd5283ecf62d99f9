"""The verb `kouros motions select`: a suite of motions for a target spectrum."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click
import numpy as np

from pipeline.cli.console import aligned
from pipeline.cli.shared import as_json, dry_run, say_dry
from pipeline.quantities import G, counted

if TYPE_CHECKING:
    from pipeline.motions.choosing import Suite
    from pipeline.tools.selecting import SitePlace

_FOLDER = click.Path(file_okay=False, path_type=Path)


@click.command()
@click.argument("folders", type=_FOLDER, nargs=-1, required=True, metavar="FOLDER...")
@click.option(
    "--target",
    required=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="The target: the JSON of the USGS design web service (asce7-22.json) as saved, or a CSV of period_s, sa_g [g] "
    "and, for a conditional spectrum, ln_sd.",
)
@click.option("--spectrum", type=click.Choice(["design", "mcer"]), default="design", help="Of the service's answer.")
@click.option(
    "--component",
    type=click.Choice(["rotd50", "rotd100"]),
    help="Horizontal measure of the target; default: rotd100 (maximum direction) of ASCE 7, rotd50 of a CSV.",
)
@click.option(
    "--periods",
    metavar="LOW,HIGH",
    default="0.1,2",
    show_default=True,
    help="Range in s that is compared: from furniture and what bends to what slides and rocks.",
)
@click.option("--count", default=11, show_default=True, type=click.IntRange(1), help="Motions of the suite.")
@click.option(
    "--max-scale", default=4.0, show_default=True, help="No record is scaled by more, or by less than 1/this."
)
@click.option("--per-event", type=click.IntRange(1), help="Most motions of one earthquake, by the time of the files.")
@click.option("--per-station", type=click.IntRange(1), help="Most motions of one station.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Of the search's draws.")
@click.option("--best", is_flag=True, help="Take the best suite there is, where none meets the target.")
@click.option("--out", type=_FOLDER, help="Folder of the new site; without it nothing is written.")
@click.option("--name", default="Selected site", show_default=True, help="What the new site is called.")
@click.option("--level", help="What its level of shaking is called; default: what the target says.")
@click.option("--return-period", type=click.FloatRange(0.0, min_open=True), help="Of the level, in years.")
@click.option("--combine", type=click.Choice(["mean", "max"]), help="Default: the mean from seven motions on.")
@click.option("--latitude", type=click.FloatRange(-90.0, 90.0), help="Of the site, where the target does not say it.")
@click.option("--longitude", type=click.FloatRange(-180.0, 180.0), help="Of the site, likewise.")
@dry_run("Choose, and say what would be written")
@as_json
def select(
    folders: tuple[Path, ...],
    target: Path,
    spectrum: Literal["design", "mcer"],
    component: Literal["rotd50", "rotd100"] | None,
    periods: str,
    count: int,
    max_scale: float,
    per_event: int | None,
    per_station: int | None,
    seed: int,
    best: bool,
    out: Path | None,
    name: str,
    level: str | None,
    return_period: float | None,
    combine: Literal["mean", "max"] | None,
    latitude: float | None,
    longitude: float | None,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Choose and scale three-component records of FOLDER for a target spectrum, and write them as a site.

    FOLDER holds record files of any format that is read, or is a site's folder.  What cannot be used is listed with the
    reason.  The suite's mean must be within 10 % of the target over the whole range of periods, and its spread match
    the target's where that has one; else it is said what is lacking, and nothing is written.  Nothing is fetched.

    Example: kouros motions select records --target asce7-22.json --out site_motions/design
    """
    from pipeline.motions.choosing import SuiteWish
    from pipeline.tools import selecting as job

    wish = SuiteWish(_range(periods), count, max_scale, per_event, per_station, seed)
    place = job.SitePlace(name, level, latitude, longitude, return_period, combine)
    suite = job.select(folders, target, wish, choice=spectrum, component=component)
    if as_json:
        click.echo(json.dumps(job.described(suite), indent=2, allow_nan=False))
    else:
        click.echo("\n".join(_lines(suite, job.combined(suite, place))))
    if suite.lacking and not (best and suite.motions):
        raise job.refused(suite, folders)
    if out is not None:
        _write(suite, target, out, place, dry=dry_run, quiet=as_json)
    if dry_run:
        say_dry(as_json)


def _range(text: str) -> tuple[float, float]:
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError as problem:
        raise click.UsageError(f"--periods {text!r}: give two periods in s, such as 0.1,2") from problem
    return low, high


def _write(suite: "Suite", target: Path, out: Path, place: "SitePlace", *, dry: bool, quiet: bool) -> None:
    from pipeline.tools.selecting import write

    file = write(suite, target, out, place, dry_run=dry)
    click.echo(f"{'would write' if dry else 'wrote'} {file}", err=quiet)


def _lines(suite: "Suite", combined: str) -> list[str]:
    target, wish = suite.target, suite.wish
    lines = [
        f"target: {target.name}",
        f"  {target.component.replace('rotd', 'RotD')} ({target.why_component}), 5 % damping, compared from "
        f"{wish.periods[0]:g} to {wish.periods[1]:g} s",
        f"records: {len(suite.found.candidates)} can be used, {len(suite.found.unusable)} cannot",
        # Most reasons name the file themselves.
        *(
            f"  not used: {'' if one.name in one.reason else f'{one.name}: '}{one.reason}"
            for one in suite.found.unusable
        ),
    ]
    if not suite.motions:
        return lines
    cells = [
        [
            one.candidate.record.name,
            f"{one.scale:.4g}",
            f"{one.pga / G:.3f}",
            f"{100 * one.pgv:.1f}",
            f"{one.misfit:.2f}",
            one.why,
        ]
        for one in suite.motions
    ]
    lines += ["", *aligned(["motion", "scale", "PGA g", "PGV cm/s", "misfit ln", "why"], cells, words={0, 5}), ""]
    off = suite.ratio - 1.0
    worst = int(np.argmax(np.abs(off)))
    plain = suite.arithmetic_ratio
    lines.append(
        f"mean: {'not ' if np.abs(off).max() > 0.1 else ''}within 10 %: at most {100 * off[worst]:+.1f} %, at "
        f"{suite.periods[worst]:.2g} s; the arithmetic mean is {plain.min():.2f} to {plain.max():.2f} of the target"
    )
    spread, spread_off = suite.spread, suite.spread_off
    told = f"spread of ln sa: {spread.min():.2f} to {spread.max():.2f}"
    if spread_off is None:
        told += "; the target has none"
    else:
        at = int(np.argmax(np.abs(spread_off)))
        told += f", at most {spread_off[at]:+.2f} off the target's, at {suite.periods[at]:.2g} s"
    lines += [
        told,
        f"together: the {'mean' if combined == 'mean' else 'worst'} of {counted(len(suite.motions), 'motion')} decides",
    ]
    return lines + [f"lacking: {one}" for one in suite.lacking]
