"""The verb `kouros validate`: how often the models are right about bodies that really fell or stood."""

import json
from dataclasses import asdict
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pipeline.cli.console import aligned
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.quantities import counted

if TYPE_CHECKING:
    from pipeline.verification.validation import Validation


@click.command()
@click.argument("folder", required=False, type=click.Path(path_type=Path))
@click.option(
    "--fit-on", type=click.Path(path_type=Path), help="Fit on this experiment alone, not on the folder's other motions."
)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), help="The page; default: validation-<date>.html."
)
@click.option("--published", is_flag=True, help="Against published medians of overturning instead (FEMA P-58).")
@click.option("--friction", type=click.FloatRange(0.0, 2.0), help="Of the published bodies; default: none slides.")
@dry_run("Say what is found")
@as_json
@click.pass_obj
def validate(
    options: Options,
    folder: Path | None,
    fit_on: Path | None,
    out: Path | None,
    published: bool,
    friction: float | None,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Hold the models against an experiment: a folder with experiment.toml, its runs and their motions.

    Beside each body: how often the models are right with nothing fitted, with two numbers fitted on other motions, and
    what "it always stands" and a threshold of the peak velocity achieve.  The page shows how reliable the stated
    probabilities are.

    With --published: the overturning medians of nine bookcases and cabinets, from the motions of FEMA P695 (which
    pip install 'kouros[published]' brings).  It writes nothing.

    Example: kouros validate shake-table-2021
    """
    if published:
        if folder is not None or fit_on is not None or out is not None:
            raise click.UsageError("--published goes with no folder, no --fit-on and no --out")
        _published(options, friction, as_json)
        return
    if friction is not None:
        raise click.UsageError("--friction goes with --published")
    from pipeline.verification.validation import validate as job
    from pipeline.verification.validation_report import document, page

    if folder is None:
        raise click.UsageError("name the folder of an experiment")
    with options.console() as console:
        found = job(folder, console, fit_on=fit_on)
    if as_json:
        click.echo(json.dumps(document(found), indent=2, allow_nan=False))
    else:
        click.echo("\n".join(_lines(found)))
    if dry_run:
        say_dry(as_json)
        return
    file = out or Path(f"validation-{datetime.now(UTC):%Y-%m-%d}.html")
    try:
        file.write_text(page(found), encoding="utf-8")
    except OSError as problem:
        raise click.UsageError(
            f"{file}: cannot be written: {problem.strerror}; name another file by --out"
        ) from problem
    click.echo(f"page: {file}", err=as_json)


def _published(options: Options, friction: float | None, as_json: bool) -> None:
    from pipeline.verification.published import FRICTION, far_field, overturning_medians

    with options.console() as console:
        found = overturning_medians(far_field(), console, friction=FRICTION if friction is None else friction)
    if as_json:
        # JSON has no infinity: a body that half of the motions do not overturn has no median.
        told = [
            {k: None if isinstance(v, float) and not isfinite(v) else v for k, v in asdict(m).items()} for m in found
        ]
        click.echo(json.dumps({"published": told}, indent=2, allow_nan=False))
        return
    rows = []
    for one in found:
        ratios = (median / one.published for median in (one.one_direction, one.both_directions, one.stronger))
        rows.append([one.name, f"{one.published:.3f}", *(f"{r:.2f}" for r in ratios), f"{one.dispersion:.2f}"])
    heads = ["", "median m/s", "one direction", "both", "both, by the stronger", "dispersion"]
    click.echo("\n".join(["Found over published:", *aligned(heads, rows, words={0})]))


def _lines(found: "Validation") -> list[str]:
    from pipeline.verification.validation_report import predictions

    said = found.experiment.said
    lines = [
        f"{said.title}: {counted(len(found.experiment.runs), 'run')}; fitted on {found.trained_on}",
        f"source: {said.source}; {said.licence}",
    ]
    for body in found.bodies:
        rows = [
            [name, f"{s.accuracy:.3f}", f"{s.brier:.3f}", f"{s.coverage:.3f}", f"{s.stated:.3f}",
             *map(str, (s.fell_as_said, s.fell_unsaid, s.stood_as_said, s.stood_unsaid))]
            for name, s in predictions(body)
        ]  # fmt: skip
        heads = ["", "accuracy", "Brier", "coverage", "stated", "fell, said", "unsaid", "stood, said", "unsaid"]
        fitted = body.parameters
        lines += [
            "",
            f"{body.name}: fitted half width {1000.0 * fitted.half_width:.1f} mm, restitution {fitted.restitution:.2f} "
            "of Housner's",
            *aligned(heads, rows, words={0}),
            *(f"Note: {note}" for note in body.notes),
        ]
    return lines
