"""The seismologist's verbs: kouros motions add, export, list, show, process, compare, synthesise, select, convert."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pipeline.cli.adding import add, export
from pipeline.cli.console import aligned
from pipeline.cli.selecting import select
from pipeline.cli.shared import Options, as_json, dry_run, say_dry, swap_lines

if TYPE_CHECKING:
    from pipeline.settings import Settings
    from pipeline.tools.strong_motion import MotionRow


@click.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--columns",
    required=True,
    metavar="NAME,...",
    help="What each column is: time (s) or time_ms, ns, ew, ud, a name of your own with --orientation, - for none.",
)
@click.option(
    "--unit", required=True, help="Of the accelerations: m/s2, cm/s2, mm/s2, gal, mgal, g, mg, %g, g/10, in/s2, ft/s2."
)
@click.option("--dt", type=float, help="Step in s, where no column is the time, or times are irregular.")
@click.option("--orientation", metavar="WORD,...", help="Of each component in order: up, down or degrees from north.")
@click.option(
    "--processed", type=click.Choice(["yes", "no"]), help="Whether it was filtered; else the manifest must say."
)
@click.option("--out", required=True, type=click.Path(file_okay=False, path_type=Path), help="Folder of the new file.")
@dry_run("Read and check the table")
@as_json
def convert(
    file: Path,
    columns: str,
    unit: str,
    dt: float | None,
    orientation: str | None,
    processed: str | None,
    out: Path,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Make any text table a record's file: CSV that says unit, orientation and step by itself.

    For a file that no reader knows.  Lines before the first row of numbers are passed over.

    Example: kouros motions convert shake.txt --columns time,ns,ew,ud --unit gal --out site_motions/site
    """
    from pipeline.motions.converting import convert as job

    done = job(
        file,
        columns.split(","),
        unit.strip().lower(),
        out,
        dt=dt,
        orientation=orientation.split(",") if orientation else (),
        processed=None if processed is None else processed == "yes",
        dry_run=dry_run,
    )
    if as_json:
        click.echo(json.dumps(asdict(done) | {"file": str(done.file)}, indent=2))
    else:
        click.echo(f"{done.samples} samples at {done.dt:g} s")
        for (name, turn), peak in zip(done.components, done.peaks, strict=True):
            click.echo(f"  {name}: {turn if isinstance(turn, str) else f'{turn:g} degrees'}, peak {peak:.4g} m/s2")
        for step in done.steps:
            click.echo(f"  {step}")
        click.echo(f"{'would write' if dry_run else 'wrote'} {done.file}")
    if dry_run:
        say_dry(as_json)


@click.group()
def motions() -> None:
    """Site motions: what there is, what was done to it, and what another would change.

    SITE is a site's folder or its manifest.toml, or 'demo'; left out, the settings' own.

    Example: kouros motions show demo
    """


def _settings(options: Options) -> "Settings | None":
    """The settings where there are any: a seismologist may work without a museum."""
    return options.settings() if Path(options.config).exists() else None


def _folder(options: Options, site: str | None) -> Path:
    from pipeline.operations.workspace import folder_of_site

    return folder_of_site(_settings(options), site)


@motions.command("list")
@click.argument("site", required=False)
@as_json
@click.pass_obj
def list_(options: Options, site: str | None, as_json: bool) -> None:
    """List the motions of a site with their peaks.

    Example: kouros motions list demo
    """
    from pipeline.tools.strong_motion import listed

    rows = listed(_folder(options, site))
    if as_json:
        click.echo(json.dumps([asdict(row) for row in rows], indent=2))
        return
    click.echo("\n".join(_table(rows)))
    click.echo("\nWhat topples an object is the peak velocity (PGV) more than the peak acceleration (PGA).")


@motions.command()
@click.argument("site", required=False)
@click.pass_obj
def entries(options: Options, site: str | None) -> None:
    """Print the manifest's entries of record files that lie in the site's folder and are not named in it.

    Each is TOML to be pasted into manifest.toml, with files, components and sha256; what no file says is asked there.

    Example: kouros motions entries site_motions/site
    """
    from pipeline.tools.strong_motion import entries as job

    found = job(_folder(options, site))
    click.echo("\n\n".join(found) if found else "the manifest names every record file of the folder")


def _table(rows: "Sequence[MotionRow]") -> list[str]:
    from pipeline.quantities import G

    head = ["level", "floor", "motion", "s", "dt", "PGA g", "PGV cm/s", "PGD cm", "D5-95 s", "pulse s", "approved by"]
    cells = [
        [
            row.level,
            row.floor or "ground",
            row.name,
            f"{row.duration:.1f}",
            f"{row.dt:g}",
            f"{row.pga / G:.3f}",
            f"{100 * row.pgv:.1f}",
            f"{100 * row.pgd:.1f}",
            f"{row.duration_5_95:.1f}",
            "-" if row.pulse_period is None else f"{row.pulse_period:.2f}",
            row.approved_by or "nobody",
        ]
        for row in rows
    ]
    return aligned(head, cells, words={0, 1, 2, len(head) - 1})


@motions.command()
@click.argument("site", required=False)
@click.option("--record", default="", help="Only the record of this name.")
@click.option(
    "--out",
    default="kouros-motions.html",
    show_default=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="The page to write.",
)
@as_json
@click.pass_obj
def show(options: Options, site: str | None, record: str, out: Path, as_json: bool) -> None:
    """Summarise what was done to each record, and write a page: before and after, spectra, pulse.

    Example: kouros motions show demo --out motions.html
    """
    from pipeline.report import Units
    from pipeline.report.pages.record_words import summary_lines
    from pipeline.tools.strong_motion import described, show

    settings = _settings(options)
    units = Units(length=settings.report.length) if settings else Units()
    found, page = show(_folder(options, site), record, out, units)
    if as_json:
        click.echo(json.dumps({"page": str(page), "records": [described(one) for one in found]}, indent=2))
        return
    for one in found:
        click.echo("\n".join(summary_lines(one, units)))
        click.echo()
    click.echo(f"Page: {page}")


@motions.command()
@click.argument("site", required=False)
@click.option("--record", default="", help="Only the record of this name.")
@click.option("--out", type=click.Path(file_okay=False, path_type=Path), help="Folder to write the processed site to.")
@click.option(
    "--accept",
    "reason",
    metavar="REASON",
    help="Overrule what was refused as a matter of judgement (clipping, a record cut off, an odd size, an orientation "
    "against the station's, components that do not belong together, several earthquakes) for --record; the manifest "
    "keeps the reason.  What is corrupt stays refused.",
)
@dry_run("Process, and say what would be written or overruled")
@as_json
@click.pass_obj
def process(
    options: Options, site: str | None, record: str, out: Path | None, reason: str | None, dry_run: bool, as_json: bool
) -> None:
    """Process a site's records, and with --out write them as CSV with a manifest of their own.

    Example: kouros motions process demo --out processed
    """
    from pipeline.operations.workspace import UsageError
    from pipeline.tools.strong_motion import listed, overrule
    from pipeline.tools.strong_motion import process as job

    folder = _folder(options, site)
    overruled: Sequence[str] = ()
    if reason is not None:
        if not record or not reason.strip():
            raise UsageError("--accept needs a reason, and --record with the name of the one record that it is for")
        overruled = overrule(folder, record, reason.strip(), dry_run=dry_run)
    # What a dry run overrules is refused yet.
    known = [] if dry_run and overruled else listed(folder)
    rows = [row for row in known if record in {"", row.name}]
    file = None if out is None or (dry_run and overruled) else job(folder, out, record, dry_run=dry_run)
    if as_json:
        answer = {"overruled": overruled, "manifest": file and str(file), "motions": [asdict(row) for row in rows]}
        click.echo(json.dumps(answer, indent=2))
    else:
        for text in overruled:
            click.echo(f"{'would be overruled' if dry_run else 'overruled'}: {text}")
        if reason is not None and not overruled:
            click.echo("nothing was refused: the manifest stays as it was")
        if rows:
            click.echo("\n".join(_table(rows)))
        if file is not None:
            click.echo(f"{'would write' if dry_run else 'wrote'} {file}")
    if dry_run:
        say_dry(as_json)


@motions.command()
@click.argument("old")
@click.argument("new", required=False)
@click.option(
    "--corner",
    metavar="FACTOR",
    type=float,
    help="Multiply the high-pass corners of NEW, or of OLD where no NEW is given, by this: 0.5 and 2 show what hangs "
    "on a choice that another seismologist would have made otherwise.  What its source processed stays as it is.",
)
@as_json
@click.pass_obj
def compare(options: Options, old: str, new: str | None, corner: float | None, as_json: bool) -> None:
    """Say which measures, and which verdicts of the last run, change when NEW takes the place of OLD.

    Example: kouros motions compare site_motions/site site_motions/proposed

    Example: kouros motions compare site_motions/site --corner 0.5
    """
    from pipeline.operations.workspace import UsageError
    from pipeline.tools.compare_motions import compare_sites

    if new is None and corner is None:
        raise UsageError("compare needs a second site, or --corner FACTOR")
    settings = _settings(options)
    with options.console() as console:
        swap = compare_sites(
            _folder(options, old), _folder(options, old if new is None else new), settings, console, corner=corner
        )
    if as_json:
        click.echo(json.dumps(asdict(swap), indent=2))
        return
    click.echo("\n".join(swap_lines(swap)))


@motions.command(context_settings={"ignore_unknown_options": True})
@click.argument("kind", default="")
@click.argument("parameters", nargs=-1, metavar="NAME=VALUE...")
@click.option(
    "--from",
    "records",
    type=click.Path(file_okay=False, path_type=Path),
    help="Only spectrum: start from each three-component record of this folder, not from noise; with --target.",
)
@click.option("--target", type=click.Path(dir_okay=False, path_type=Path), help="The spectrum, as of motions select.")
@click.option("--compact", is_flag=True, help="Write what is made of records as small MiniSEED files, to 1 mm/s2.")
@click.option("--out", type=click.Path(file_okay=False, path_type=Path), help="Folder of the new site.")
@dry_run("Make the signal, and say what was done")
def synthesise(
    kind: str,
    parameters: tuple[str, ...],
    records: Path | None,
    target: Path | None,
    compact: bool,
    out: Path | None,
    dry_run: bool,
) -> None:
    """Make a test signal for the virtual shake table and write it as a site; SI units.

    KIND is sine, swept_sine, random, rectangular, half_sine, ricker, mavroeidis_papageorgiou, or spectrum: an
    accelerogram that matches a response spectrum.  Without parameters it says which there are.  Shake any model by it
    with `kouros respond --site FOLDER`, also through supports.

    With --from, the horizontals of each record are changed until they match; the vertical is scaled.  Each is named
    spectrum-compatible.

    Example: kouros motions synthesise sine amplitude=2 frequency=1.5 cycles=10 --out shake
    """
    from pipeline.operations.workspace import UsageError
    from pipeline.tools.synthetic import SIGNALS, describe, synthesise_from
    from pipeline.tools.synthetic import synthesise as job

    if kind and kind not in SIGNALS:
        raise UsageError(f"there is no signal {kind!r}; the signals are {', '.join(SIGNALS)}")
    if (records is None) != (target is None) or (records is not None and kind != "spectrum"):
        raise UsageError("--from and --target belong together, and to spectrum")
    if not parameters and records is None:
        for name in [kind] if kind else SIGNALS:
            click.echo(f"{name:<24}{describe(name)}")
        return
    if out is None:
        raise UsageError("--out FOLDER: say where the new site shall lie")
    if records is not None and target is not None:
        file, made, left = synthesise_from(records, target, parameters, out, compact=compact, dry_run=dry_run)
        steps = [f"{motion.name}: {motion.steps[-1]}" for motion in made]
        steps += [f"not made: {one.name}: {one.reason}" for one in left]
    else:
        file, motion = job(kind, parameters, out, dry_run=dry_run)
        steps = list(motion.steps)
    for step in steps:
        click.echo(step)
    if dry_run:
        click.echo(f"would write {file}")
        say_dry(wanted_json=False)
        return
    click.echo(f"wrote {file}; try: kouros respond sliding friction_static=0.1,0.2 --site {out}")


motions.add_command(add)
motions.add_command(export)
motions.add_command(select)
motions.add_command(convert)
