"""The command `kouros`: parse, call, print; decides nothing."""

import atexit
import gc
import logging
import sys
import warnings
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TextIO, cast

import click

import pipeline
from pipeline import __version__
from pipeline.cli import commands
from pipeline.cli.console import Guarded
from pipeline.cli.shared import Options, with_shared
from pipeline.execute.workers import RARELY
from pipeline.operations.event_log import note
from pipeline.operations.stopping import Stopped, stoppable


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.option(
    "--config", default="kouros.toml", show_default=True, type=click.Path(dir_okay=False), help="Settings file."
)
@click.version_option(__version__, prog_name="kouros")
@click.pass_context
def kouros(context: click.Context, config: str) -> None:
    """Which objects of a museum an earthquake would rock, slide, swing, break or throw down, and what to do.

    \b
    Exit codes: 0 done; 1 unexpected; 2 usage or settings; 3 with `run --strict` only: done, some objects
    could not be assessed; 4 a motion was refused; 5 collection unreachable; 6 another run holds the lock;
    7 input shrank suspiciously, nothing published; 130 and 143 stopped by Ctrl-C and SIGTERM.

    Example: kouros demo
    """
    context.obj = replace(context.obj or Options(), config=config)


for command in commands.ALL:
    kouros.add_command(command)
with_shared(kouros)


def main() -> None:
    """Run the command; errors name file, row, field and remedy, and become exit codes."""
    # Loading modules makes objects by the hundred thousand, and all stay: to look for garbage among them every 700 took
    # an eighth of a short command.
    gc.set_threshold(*RARELY)
    # And at the end all goes at once: to look for garbage before that, as Python does, takes half a second.
    atexit.register(gc.freeze)
    debug = "--debug" in sys.argv
    # Whatever prints, a museum's texts must not steer the terminal.
    sys.stdout, sys.stderr = cast(TextIO, Guarded(sys.stdout)), cast(TextIO, Guarded(sys.stderr))
    with ExitStack() as stack:
        if "--log-json" in sys.argv:
            _log(stack)
        else:
            warnings.formatwarning = _warned
            _show_modules(sys.argv)
        try:
            with stoppable(lambda _problem: None):
                code = kouros.main(standalone_mode=False, prog_name="kouros")
        except click.exceptions.Exit as leaving:
            code = leaving.exit_code
        except click.Abort as leaving:
            # Who is stopped by a signal has said so at once.
            if not isinstance(leaving.__cause__, Stopped):
                print("kouros: stopped", file=sys.stderr)
            code = getattr(leaving.__cause__, "exit_code", 130)
        except click.ClickException as problem:
            problem.show()
            code = 2
        except Exception as problem:
            if debug:
                raise
            code = _tell(problem, as_json="--log-json" in sys.argv)
    sys.exit(code if isinstance(code, int) else 0)


def _log(stack: ExitStack) -> None:
    """Write JSON lines to standard error from now on, warnings included."""
    from pipeline.operations.event_log import journal
    from pipeline.operations.secrets import hider

    stack.enter_context(journal(None, hider(None), to_stderr=True))
    warnings.showwarning = lambda message, category, *_where: note(
        "warning", level=logging.WARNING, kind=category.__name__, message=str(message)
    )


def _show_modules(words: Sequence[str]) -> None:
    """Write to standard error what the modules say to their loggers: with -v what takes its time, with --debug all."""
    level = logging.DEBUG if "--debug" in words else logging.INFO if {"-v", "--verbose"} & set(words) else None
    if level is not None:
        handler = logging.StreamHandler(sys.stderr)
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s", "%H:%M:%S"))
        logger = logging.getLogger(pipeline.__name__)
        logger.addHandler(handler)
        logger.setLevel(level)


def _tell(problem: Exception, *, as_json: bool) -> int:
    """Tell an error without its secrets, as a sentence or as a line of the log, and return the exit code."""
    from pipeline.operations.run_summary import exit_code_of, words_of
    from pipeline.operations.secrets import hider

    code, said = exit_code_of(problem), hider(None)(words_of(problem))
    if as_json:
        note("error", level=logging.ERROR, kind=type(problem).__name__, message=said, exit_code=code)
    else:
        print(f"kouros: {said}", file=sys.stderr)
    return code


def _warned(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    line: str | None = None,  # noqa: ARG001 - as the standard library calls it
) -> str:
    # What Kouros itself warns of is for the user; where it says so in the code is not.
    own = category.__module__.startswith("pipeline.")
    return f"kouros: {message}\n" if own else f"{category.__name__}: {message} ({filename}:{lineno})\n"
