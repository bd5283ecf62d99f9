"""What all commands share: where the settings are, and how much is said."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from pipeline.cli.console import Console

if TYPE_CHECKING:
    from pipeline.settings import Settings

as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")


@dataclass(frozen=True)
class Options:
    """The options that all commands share."""

    config: str
    quiet: bool
    verbose: bool
    debug: bool
    log_json: bool = False

    def console(self) -> Console:
        """Return where progress goes: with JSON on standard error, nothing else does."""
        return Console(quiet=self.quiet or self.log_json, verbose=self.verbose)

    def settings(self) -> "Settings":
        """Read the settings file."""
        from pipeline.settings import load_settings

        return load_settings(self.config)
