"""The verb `kouros plan`: what to do with the hours and the money there are."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import aligned, printable
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.quantities import counted

if TYPE_CHECKING:
    from pipeline.planning.choice import EffortLimits
    from pipeline.planning.efforts import EffortSpan
    from pipeline.planning.plan import ErrandPlan
    from pipeline.tools.planning import Planned

_LISTED = 40
"""Lines of errands that are printed."""

_NAMED = 4
"""Objects that a line names."""


@click.command()
@click.option(
    "--hours",
    "hours",
    multiple=True,
    metavar="[TRADE=]HOURS",
    help="Hours of work there are, of all or of one trade (handler, mount-maker, engineer); may be repeated. "
    "Default: [plan] hours.",
)
@click.option("--cost", type=float, help="What material and outside work may cost. Default: [plan] cost.")
@click.option("--gallery", "galleries", multiple=True, help="Only this gallery; may be repeated.")
@click.option("--removals", is_flag=True, help="Let objects be taken from view too, where nothing else is enough.")
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write it: .xlsx a sheet to print and tick off, .csv all errands, .html a page.",
)
@dry_run("Say what to do")
@as_json
@click.pass_obj
def plan(
    options: Options,
    hours: tuple[str, ...],
    cost: float | None,
    galleries: tuple[str, ...],
    removals: bool,
    out: Path | None,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Choose, of all that the newest run advises, what avoids the most expected loss for the hours and cost there are.

    Errands are listed in walking order: galleries as on the report's first page, then cases, then objects.  The report
    has a page of the plan for [plan] hours and cost; this asks for others.  Nothing is computed again.

    \b
    Example: kouros plan --hours 40 --cost 5000
    Example: kouros plan --hours mount-maker=20 --hours handler=10 --gallery "Gallery 12" --out plan.xlsx
    """
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.workspace import open_workspace
    from pipeline.tools.planning import plan_museum

    limits = _limits(hours, cost, removals=removals)
    with rehearsed(options.settings(), dry_run) as settings:
        found = plan_museum(open_workspace(settings), limits, galleries=galleries, path=out, dry_run=dry_run)
    if as_json:
        click.echo(json.dumps(_document(found), indent=2, allow_nan=False))
    else:
        click.echo("\n".join(map(printable, _lines(found, dry=dry_run))))
    if dry_run:
        say_dry(as_json)


def _limits(hours: tuple[str, ...], cost: float | None, *, removals: bool) -> "EffortLimits":
    from pipeline.planning.choice import EffortLimits
    from pipeline.planning.efforts import TRADES

    whole: float | None = None
    trades: dict[str, float] = {}
    for text in hours:
        trade, given, number = text.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            raise click.UsageError(
                f"--hours {text!r}: give a number, such as 40, or one of a trade, such as mount-maker=20"
            ) from None
        if not given:
            whole = value
        elif trade.strip() in TRADES:
            trades[trade.strip()] = value
        else:
            raise click.UsageError(f"--hours {text!r}: there is no such trade; use one of {', '.join(TRADES)}")
    return EffortLimits(whole, cost, trades, removals)


def _lines(found: "Planned", *, dry: bool) -> list[str]:
    from pipeline.report.pages.errand_views import plan_view
    from pipeline.report.units import percent

    plan = found.plan
    view = plan_view(plan)
    lines = [f"Plan by run {found.head.run_id}", "", view.lede]
    lines += [line for line in (view.takes, view.half, view.gap) if line]
    if plan.by_trade:
        lines += ["", *aligned(("trade", "errands", "hours"), [tuple(row) for row in view.trades], words={0})]
    gallery: str | None = None
    together = _together(plan)
    for name, line in together[:_LISTED]:
        lines += ["", name or "no gallery recorded"] if name != gallery else []
        lines.append(f"  {line}")
        gallery = name
    if len(together) > _LISTED:
        lines += ["", f"{len(together) - _LISTED:,} more lines: --json has all, and --out writes them"]
    if plan.away:
        what = counted(len(plan.away), "errand")
        share = plan.share_of(sum(plan.errands[at].avoided for at in plan.away))
        lines += ["", f"To decide with a curator: {what} that take objects from view, {percent(share, 1)} (--removals)"]
    if found.path is not None:
        lines.append(f"{'would write' if dry else 'wrote'} {found.path}")
    return lines


def _together(plan: "ErrandPlan") -> list[tuple[str, str]]:
    """Return what to do as lines with their galleries: in walking order, or best first where nothing is limited.

    What is done in one gallery, or in one case of it, by one measure is one line.
    """
    from pipeline.report.pages.errand_views import number, priced, title_of
    from pipeline.report.units import percent

    ranked = plan.best_first
    lines = []
    for places in plan.together(ranked if plan.terms.limits.open else sorted(ranked)):
        some = [plan.errands[at] for at in places]
        one = some[0]
        numbers = [object_.object_number for one in some for object_ in one.objects]
        more = f" and {len(numbers) - _NAMED:,} more" if len(numbers) > _NAMED else ""
        hours, cost = sum(one.hours.value for one in some), sum(one.cost.value for one in some)
        avoids = percent(plan.share_of(sum(one.avoided for one in some)), 2)
        first = "" if one.needs is None else f", after: {plan.errands[one.needs].title}"
        where = f"case {one.case}: " if one.case else ""
        effort = f"{number(hours)} h {one.trade}, cost {priced(number(cost), plan.terms.currency)}; avoids {avoids}"
        lines.append((one.gallery, f"{where}{title_of(one)}{first}: {', '.join(numbers[:_NAMED])}{more}; {effort}"))
    return lines


def _document(found: "Planned") -> dict[str, Any]:
    from pipeline.report.files.plan_files import errand_row

    plan = found.plan
    limits = plan.terms.limits
    return {
        "run_id": found.head.run_id,
        "limits": {
            "hours": limits.hours,
            "cost": limits.cost,
            "trades": dict(limits.trades),
            "removals": limits.away,
        },
        "expected_loss": plan.loss,
        "avoided": plan.choice.avoided,
        "share": plan.share,
        "gap": plan.choice.gap,
        "hours": _span(plan.hours),
        "cost": _span(plan.cost),
        "trades": {trade: _span(span) for trade, span in plan.by_trade.items()},
        "errands": [errand_row(plan, at, plan.errands[at]) for at in sorted(plan.choice.chosen)],
        "from_view": [errand_row(plan, at, plan.errands[at]) for at in plan.away],
        "curve": [{"hours": corner.hours, "cost": corner.cost, "avoided": corner.avoided} for corner in plan.curve],
        "path": None if found.path is None else str(found.path),
    }


def _span(span: "EffortSpan") -> dict[str, float]:
    return {"value": span.value, "low": span.low, "high": span.high}
