"""The log of the nights for programs: one JSON object a line, by the standard library's logging.

A formatter of the standard library does it: a further library would format, while rotation, threads and the warnings of
other libraries are the standard library's in any case.
"""

import json
import logging
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from logging.handlers import RotatingFileHandler
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pipeline.settings import Settings

_LOG = logging.getLogger("kouros")
_LOG.propagate = False
_LOG.addHandler(logging.NullHandler())

_FIELDS = "kouros_fields"
_OWN = ("time", "level", "event", "pid")


class _LineFormatter(logging.Formatter):
    """A record as one line of JSON, with nothing secret in it."""

    def __init__(self, hide: Callable[[str], str]) -> None:
        super().__init__()
        self._hide = hide

    def format(self, record: logging.LogRecord) -> str:
        """Return one line: time (UTC), level, event, pid, and the fields that were given."""
        fields = getattr(record, _FIELDS, {})
        line = {
            "time": f"{datetime.fromtimestamp(record.created, UTC):%Y-%m-%dT%H:%M:%S.%f}"[:-3] + "Z",
            "level": record.levelname.lower(),
            "event": record.getMessage(),
            "pid": record.process,
            **{name: self._plain(value) for name, value in fields.items() if name not in _OWN},
        }
        # All but ASCII is escaped, so that no text can end a line or steer a terminal.
        return json.dumps(line, ensure_ascii=True, allow_nan=False)

    def _plain(self, value: Any) -> Any:
        if value is None or isinstance(value, bool | int):
            return value
        if isinstance(value, float):
            return value if abs(value) < float("inf") else str(value)
        if isinstance(value, Mapping):
            return {self._hide(str(name)): self._plain(one) for name, one in value.items()}
        if isinstance(value, list | tuple):
            return [self._plain(one) for one in value]
        return self._hide(str(value))


class _File(RotatingFileHandler):
    """A file of lines: where one cannot be written, the others are tried, and it is said once."""

    _said = False

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: ARG002, N802 - as the standard library calls it
        """Say in a sentence what the standard library would print a traceback for."""
        if not self._said:
            self._said = True
            print(f"kouros: the log cannot be written: {sys.exc_info()[1]}; mend [logs] file", file=sys.stderr)

    def close(self) -> None:
        """Close the file; what could not be written is lost, and was told."""
        with suppress(OSError):
            super().close()


@contextmanager
def journal(settings: "Settings | None", hide: Callable[[str], str], *, to_stderr: bool = False) -> Iterator[None]:
    """Write what is noted in the block to the file of the settings, to standard error, to both or to neither.

    Parameters
    ----------
    settings : Settings or None
        Say the file; None where they could not be read.
    hide : callable
        Takes the secrets out of a text, see `pipeline.operations.secrets.hider`.
    to_stderr : bool
        Whether the lines go to standard error too.

    Yields
    ------
    None
    """
    handlers: list[logging.Handler] = [logging.StreamHandler(sys.stderr)] if to_stderr else []
    refused: OSError | None = None
    if settings is not None and settings.logs.file:
        wanted = settings.logs
        try:
            path = settings.path(wanted.file)
            path.parent.mkdir(parents=True, exist_ok=True)
            handlers.append(
                _File(path, maxBytes=round(1e6 * wanted.megabytes), backupCount=wanted.keep, encoding="utf-8")
            )
        except OSError as problem:
            refused = problem
    before = _LOG.level
    _LOG.setLevel(logging.INFO)
    for handler in handlers:
        handler.setFormatter(_LineFormatter(hide))
        _LOG.addHandler(handler)
    try:
        if refused is not None:
            # A night is not lost for want of a log.
            print(f"kouros: the log cannot be written: {refused}; mend [logs] file", file=sys.stderr)
            note("log.refused", level=logging.ERROR, message=str(refused))
        yield
    finally:
        _LOG.setLevel(before)
        for handler in handlers:
            _LOG.removeHandler(handler)
            handler.close()


def note(event: str, /, *, level: int = logging.INFO, **fields: Any) -> None:
    """Write an event into the log, wherever `journal` keeps it; nowhere, where none is kept.

    Parameters
    ----------
    event : str
        What happened, by its lasting name, such as "run.finished".
    level : int
        Of the standard library's logging.
    **fields : Any
        JSON-ready values; what is not, is written as text.
    """
    _LOG.log(level, "%s", event, extra={_FIELDS: fields})
