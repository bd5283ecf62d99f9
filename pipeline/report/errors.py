"""The one error that the report raises."""

from pathlib import Path

from pipeline.errors import InputError


class ReportError(InputError):
    """A run that cannot be shown; the message names the object, the field and the remedy."""


def cut_short(file: Path) -> ReportError:
    """Return the error for a file of an earlier report that does not hold all that the report says."""
    return ReportError(f"{file} is shorter than its report says; remove that report, and run again")
