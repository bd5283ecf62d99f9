"""The verb `survey`: what is worth measuring, on the terminal or as a workbook to fill in."""

import json
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pipeline.cli.console import listed
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.quantities import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pipeline.analysis.house.questions import RuleQuestion


@click.command()
@click.option("--gallery", "galleries", multiple=True, help="Only this gallery; may be repeated.")
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), help="The workbook; default: survey-<date>.xlsx."
)
@dry_run("Say what is worth measuring")
@as_json
@click.pass_obj
def survey(options: Options, galleries: tuple[str, ...], out: Path | None, dry_run: bool, as_json: bool) -> None:
    """Write a workbook of what is worth measuring: which missing numbers may change what is decided.

    What one house rule answers for many objects is asked for first, as text for kouros.toml and on a sheet "Rules".
    Print it, fill it in, and read it back with `kouros import FILE --sheet`.

    Example: kouros survey --gallery "Gallery 12"
    """
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import locked, open_workspace
    from pipeline.tools.survey import survey as job

    with rehearsed(options.settings(), dry_run) as settings, locked(settings), options.console() as console:
        found = job(open_workspace(settings), console, galleries=galleries, path=out)
    if as_json:
        click.echo(json.dumps(asdict(found), indent=2, default=str))
    else:
        _print_rules(found.rules)
        what = counted(found.quantities, "measurement")
        click.echo(
            f"{what} on {counted(found.objects, 'object')} {'is' if found.quantities == 1 else 'are'} worth making: "
            f"{found.path}"
        )
        others = "1 other would settle nothing wherever in its range it falls, and is left out"
        many = f"{found.waste:,} others would settle nothing wherever in their range they fall, and are left out"
        click.echo(others if found.waste == 1 else many)
        first = [
            f"{w.object_number} ({w.gallery}): {w.field}: {w.reason}" for w in found.wishes if not w.settles_nothing
        ]
        listed("first", first)
        failed = [f"{one.object_number}: {one.words}; please tell its makers" for one in found.faults]
        listed("Kouros failed on", failed)
    if dry_run:
        say_dry(as_json)


def _print_rules(questions: "Sequence[RuleQuestion]") -> None:
    from pipeline.tools.house_answers import to_paste

    if not questions:
        return
    told = [
        f"one answer for {counted(q.objects, 'object')}: {q.field} of {', '.join(map(' '.join, q.criteria.items()))}"
        for q in questions
    ]
    listed("house rule", told)
    click.echo('To answer, mend and sign these lines and add them to kouros.toml, or fill in the sheet "Rules":\n')
    click.echo(to_paste(questions, datetime.now().date()))
