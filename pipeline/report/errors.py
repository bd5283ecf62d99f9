"""The one error that the report raises, and what it warns of."""

from pipeline.errors import InputError


class ReportError(InputError):
    """A run that cannot be shown; the message names the object, the field and the remedy."""


class ReportWarning(UserWarning):
    """A file of an earlier report, or a page of another package, cannot be used; the report is whole without it."""
