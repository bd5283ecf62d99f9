"""Options that verbs share: where the settings are, how much is said, --dry-run; and words that they share."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import click

from pipeline.cli.console import Console

if TYPE_CHECKING:
    from pipeline.settings import Settings
    from pipeline.tools.compare_motions import Pair, Swap


_Function = TypeVar("_Function", bound=Callable[..., Any])

as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")


def dry_run(told: str) -> Callable[[_Function], _Function]:
    """Give a verb the option --dry-run, with what it says instead of doing it."""
    return click.option("--dry-run", is_flag=True, help=f"{told}; write nothing.")


def say_dry(wanted_json: bool) -> None:
    """End a dry run with the words that nothing was written: beside JSON on standard error."""
    from pipeline.operations.dry_run import NOTHING

    click.echo(NOTHING, err=wanted_json)


@dataclass(frozen=True)
class Options:
    """The options that all commands share."""

    config: str = "kouros.toml"
    quiet: bool = False
    verbose: bool = False
    debug: bool = False
    log_json: bool = False

    def console(self) -> Console:
        """Return where progress goes: with JSON on standard error, nothing else does."""
        return Console(quiet=self.quiet or self.log_json, verbose=self.verbose)

    def settings(self) -> "Settings":
        """Read the settings file."""
        from pipeline.settings import load_settings

        return load_settings(self.config)


SAID = {
    ("-q", "--quiet"): "Say nothing but errors and results.",
    ("-v", "--verbose"): "Plain progress lines even on a terminal, and what takes its time.",
    ("--log-json",): "Say what happens as JSON on standard error, one object a line.",
    ("--debug",): "Show the traceback of an error, and all that Kouros's modules say.",
}
"""Options of all verbs, with their help."""

_NO_DRY_RUN: Mapping[str, str] = {
    "kouros": "it stands after the verb, as in `kouros run --dry-run`",
    "check": "it only looks; it brings the database's tables up to date, and with --numerics keeps the result",
    "report": "it draws a run that is stored into a folder of its own, and changes no run; --help says more",
    "diff": "it only compares",
    "motions": "it stands after the verb, as in `kouros motions process --dry-run`",
    "list": "it only lists",
    "entries": "it only prints",
    "show": "it writes one page, which --out names, and nothing else",
    "compare": "it only compares",
    "models": "it only lists",
    "scan": "it only measures",
    "serve": "it writes what people say to it, and nothing else",
    "respond": "it writes nothing but charts for another time",
    "tradeoff": "it measures, and keeps the result for the next report",
}


def with_shared(command: click.Command) -> click.Command:
    """Let a verb and those below it take the options of all verbs too, and answer a --dry-run that they do not have."""
    if not any(parameter.name == "dry_run" for parameter in command.params):
        command.params.append(
            click.Option(["--dry-run"], is_flag=True, hidden=True, expose_value=False, callback=_no_dry_run)
        )
    for names, told in SAID.items():
        command.params.append(click.Option(list(names), is_flag=True, help=told, expose_value=False, callback=_also))
    if isinstance(command, click.Group):
        for one in command.commands.values():
            with_shared(one)
    return command


def _also(context: click.Context, option: click.Parameter, value: bool) -> None:
    if value:
        context.obj = replace(context.obj or Options(), **{str(option.name): True})


def _no_dry_run(context: click.Context, _option: click.Parameter, value: Any) -> None:
    if value:
        why = _NO_DRY_RUN[str(context.command.name)]
        raise click.UsageError(f"{context.command_path} has no --dry-run: {why}; leave --dry-run out", context)


def swap_lines(swap: "Swap", most: int = 20) -> list[str]:
    """Return what a swap changes as lines: the measures of each motion, then the verdicts, of which most are listed."""
    lines = [f"from {swap.old}", f"to   {swap.new}"]
    for pair in swap.pairs:
        lines += ["", f"{pair.level}: {pair.before or 'nothing'} -> {pair.after or 'nothing'}"]
        lines += ["  the same samples"] if pair.same else _measure_lines(pair)
    lines += ["", f"Verdicts: {swap.basis}"]
    lines += [f"  {number:>6,}  {words}" for words, number in swap.moved.items()]
    lines += [
        f"  {v.object_number} ({v.gallery}) {v.model}, {v.level}: {v.before or 'none'} -> {v.after or 'none'}"
        for v in swap.verdicts[:most]
    ]
    if len(swap.verdicts) > most:
        lines.append(f"  and {len(swap.verdicts) - most:,} more (--json lists all)")
    if not swap.verdicts and swap.basis.startswith("the "):
        lines.append("  none changes")
    return lines


def _measure_lines(pair: "Pair") -> list[str]:
    from pipeline.report import Units

    units = {"pga": "m/s2", "pgv": "m/s", "pgd": "m", "duration": "s", "pulse_period": "s", "pulse_pgv": "m/s"}
    lines = []
    for name, (before, after) in pair.measures.items():
        unit = next((u for stem, u in units.items() if name.startswith(stem)), "")
        told = [
            ("-" if value is None else Units().text(value, unit) if unit else f"{value:.3g}")
            for value in (before, after)
        ]
        change = f"{after / before - 1:+.1%}" if before and after is not None else ""
        lines.append(f"  {name:<16}{told[0]:>14} -> {told[1]:<14}{change}".rstrip())
    return lines
