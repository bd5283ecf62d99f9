"""Options of all commands: where the settings are, and how much is said."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from pipeline.cli.console import Console

if TYPE_CHECKING:
    from pipeline.settings import Settings

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
