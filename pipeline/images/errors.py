"""Why a photograph is not shown."""

from pipeline.errors import InputError


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
