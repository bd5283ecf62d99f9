"""Where photographs may be, how much is spent on them, and why one is not shown."""

from dataclasses import dataclass
from pathlib import Path

from pipeline.errors import InputError


@dataclass(frozen=True)
class ImageLimits:
    """Where photographs may be, and how much is spent on them.

    Attributes
    ----------
    folder : Path or None
        Of the files; None: files are not looked for.
    hosts : tuple of str
        See `pipeline.images.fetching.Hosts`.
    side : int
        Pixels of a side of a picture.
    most_bytes, most_pixels : int
        Of a photograph.
    seconds : float
        For one photograph.
    minutes : float
        For all that is new in one night.
    ask_again_days : float
        After which a host is asked whether a photograph has changed.
    """

    folder: Path | None = None
    hosts: tuple[str, ...] = ()
    side: int = 240
    most_bytes: int = 30_000_000
    most_pixels: int = 100_000_000
    seconds: float = 10.0
    minutes: float = 30.0
    ask_again_days: float = 30.0


class ImageError(InputError):
    """A photograph that cannot be shown: what is wrong, and what mends it.

    Attributes
    ----------
    what, remedy : str
        In words.
    lasting : bool
        Whether it is the same tomorrow unless somebody mends it; else it is tried again every night.
    """

    def __init__(self, what: str, remedy: str, *, lasting: bool = True) -> None:
        super().__init__(f"{what}; {remedy}")
        self.what, self.remedy, self.lasting = what, remedy, lasting
