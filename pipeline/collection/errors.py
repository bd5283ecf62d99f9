"""Errors between a museum's records and the inventory; each carries the command's exit code."""

from pipeline.errors import InputError


class CollectionError(InputError):
    """A source that cannot be read at all, or holds no object: the message names the file and the remedy."""

    exit_code = 5


class NoRowsError(CollectionError):
    """A source that has a header and no rows."""


class MappingError(InputError):
    """A mapping that cannot be used: the message names the mapping's file, the field and the remedy."""


class ShrunkError(InputError):
    """A source that lost suspiciously many objects since the last import; nothing was written."""

    exit_code = 7
