"""The verb `decide`: what people decide about an object, written down and listed."""

import json
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import printable
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.records import DecisionKind, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pipeline.records import Decision


@click.command()
@click.argument("object_number", metavar="[OBJECT]", required=False)
@click.argument("kind", required=False, type=click.Choice([kind.value for kind in DecisionKind]))
@click.argument("words", nargs=-1, metavar="[WHAT]...")
@click.option("--why", default="", help="The reason; always needed.")
@click.option("--who", default="", help="Who decides; default: KOUROS_WHO of the environment, or the account's name.")
@click.option("--on", default="", metavar="DATE", help="The day of the decision, as 2031-05-01; default: today (UTC).")
@click.option("--model", default="", help="Of accept and verdict: only this model (see `kouros models`).")
@click.option("--level", default="", help="Of accept and verdict: only this level of shaking.")
@click.option("--until", default="", metavar="DATE", help="Of accept: the last day on which the risk is accepted.")
@click.option("--list", "listing", is_flag=True, help="List the decisions in force, of OBJECT or of all.")
@click.option("--log", is_flag=True, help="With --list: all that was ever decided, withdrawals included.")
@dry_run("Say what would be written down, with all that is refused")
@as_json
@click.pass_obj
def decide(
    options: Options,
    object_number: str | None,
    kind: str | None,
    words: tuple[str, ...],
    why: str,
    who: str,
    on: str,
    model: str,
    level: str,
    until: str,
    listing: bool,
    log: bool,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Write down what a person decided about an object: who, when, why.  Nothing ever changes or drops it.

    \b
    accept                          the risk is accepted; the computed verdict stays, and the decision beside it
    verdict pass|fail --model M     the person's verdict, beside the computed one
    installed MEASURE NAME=VALUE... a measure is in place: the next run computes the object with it; numbers are in SI
                                    units, lengths and masses in others where they say so (4in, 3lb);
                                    isolator=NAME takes the numbers of an isolator from the museum's catalogue
    class CLASS                     the object is of this class: the next run takes it as such
    withdraw ID                     an earlier decision ends

    When what a decision rested on has changed, report and run say that it must be looked at again.

    \b
    Example: kouros decide 1922.9 installed clearance clearance_m=0.1 --why "moved on Monday"
    Example: kouros decide 1922.9 installed horizontal_isolator isolator="our 0.5 Hz" stroke_m=0.2 --why "bought in May"
    Example: kouros decide 1922.9 accept --model sliding --until 2032-01-01 --why "case is rebuilt next year"
    Example: kouros decide --list
    """
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import open_workspace
    from pipeline.tools.decisions import Wish, listed
    from pipeline.tools.decisions import decide as job

    if listing == (kind is not None):
        raise click.UsageError(f"give an OBJECT and one of {', '.join(DecisionKind)}, or --list")
    with rehearsed(options.settings(), dry_run) as settings:
        workspace = open_workspace(settings)
        if listing:
            _print_decisions(listed(workspace, object_number, log=log), as_json)
        else:
            wish = Wish(object_number or "", DecisionKind(str(kind)), words, why, who, on, model, level, until)
            _print_made(job(workspace, wish, dry_run=dry_run), dry_run, as_json)
    if dry_run:
        say_dry(as_json)


def _print_made(made: "Decision", dry_run: bool, wanted_json: bool) -> None:
    if wanted_json:
        click.echo(json.dumps(_plain(made), indent=2, ensure_ascii=False))
        return
    click.echo(_line(made))
    if made.kind is DecisionKind.ACCEPT and not any(b.verdict is not Verdict.PASS for b in made.basis):
        click.echo(
            "note: the last run found nothing to accept there; once it does, the decision must be looked at again"
        )
    if not dry_run and made.kind in (DecisionKind.INSTALLED, DecisionKind.CLASS, DecisionKind.WITHDRAW):
        click.echo("the next run takes it into account")


def _print_decisions(rows: "Sequence[Decision]", wanted_json: bool) -> None:
    if wanted_json:
        click.echo(json.dumps([_plain(row) for row in rows], indent=2, ensure_ascii=False))
        return
    for row in rows:
        click.echo(_line(row))
    if not rows:
        click.echo("no decision")


def _line(row: "Decision") -> str:
    return printable(f"{row.id or '':>4}  {row.object_number}: {row.matter}, {row.who}, {row.date}: {row.why}")


def _plain(row: "Decision") -> dict[str, Any]:
    from pipeline.records import Decision
    from pipeline.store import codec

    found: dict[str, Any] = codec.plain(Decision, row)
    return found
