"""Options that every verb takes besides its own: how much is said, before the verb or after it; and --dry-run."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import click

from pipeline.cli.options import Options

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
