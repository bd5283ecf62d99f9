"""The verb `kouros motions convert`: any table of numbers to a record's file."""

import json
from dataclasses import asdict
from pathlib import Path

import click

from pipeline.cli.options import as_json, dry_run, say_dry


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
