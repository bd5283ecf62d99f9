"""The one error that the report raises."""


class ReportError(ValueError):
    """A run that cannot be shown; the message names the object, the field and the remedy."""
