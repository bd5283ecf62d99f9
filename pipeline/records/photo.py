"""A small picture of an object, ready to be shown."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Photo:
    """A small picture.

    Attributes
    ----------
    name : str
        A digest of its content, which is its name in a report.
    width, height : int
        In pixels.
    content : bytes
        JPEG; b"" where it is not at hand.
    """

    name: str
    width: int
    height: int
    content: bytes = b""
