"""What the desk refuses, in words for whoever sits at it."""

from pipeline.errors import InputError


class DeskError(InputError):
    """The desk cannot do what it was asked to."""


class StaleError(DeskError):
    """Somebody else changed what a form was made of: it is told, and nothing of either is lost."""


class NotThereError(DeskError):
    """There is no such object, gallery or errand."""


class BodyTooLongError(DeskError):
    """More is sent than is taken."""
