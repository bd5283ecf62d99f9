"""Rows of the tables of what objects stand on or in, or hang from: furniture.csv and usual_furniture.csv."""

from functools import cache
from typing import Annotated, Literal

from pydantic import AfterValidator, ConfigDict, Field, ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.records import Anchorage, Furniture, Support
from pipeline.tables import Range, TableError, table
from pipeline.tables.assumed_rows import AssumedRow
from pipeline.tables.rows import Number, Optional, TableRow, Text, YesNo, checked, in_order

ANY = "*"
"""In the column object_class of usual_furniture.csv: of every class that no other row names."""

STANDING = "standing"
"""In the column support of usual_furniture.csv: whatever is neither hung nor suspended."""

_STEEPEST = 5.0

_LARGEST = 10.0

_ROUGHEST = 2.0


def _shaking(hertz: float | None) -> float | None:
    if hertz is not None and not 0.1 <= hertz <= 50.0:
        raise InputError(f"must be from 0.1 to 50 Hz, not {hertz:g}")
    return hertz


def _damped(share: float | None) -> float | None:
    if share is not None and not 0.0 < share < 1.0:
        raise InputError(f"is a share of the critical damping: it must be above 0 and below 1, not {share:g}")
    return share


Hertz = Annotated[Optional, AfterValidator(_shaking)]
"""A cell that holds a frequency, or nothing."""

Damping = Annotated[Optional, AfterValidator(_damped)]
"""A cell that holds a damping ratio, or nothing."""


def _long(metres: float | None) -> float | None:
    if metres is not None and not 0.0 < metres <= _LARGEST:
        raise InputError(f"must be above 0 and at most {_LARGEST:g} m, not {metres:g}")
    return metres


def _rough(friction: float | None) -> float | None:
    if friction is not None and not 0.0 < friction <= _ROUGHEST:
        raise InputError(
            f"is a coefficient of friction: it must be above 0 and at most {_ROUGHEST:g}, not {friction:g}"
        )
    return friction


Length = Annotated[Optional, AfterValidator(_long)]
"""A cell that holds a size of furniture, or nothing."""

FloorFriction = Annotated[Optional, AfterValidator(_rough)]
"""A cell that holds the friction of furniture on its floor, or nothing."""


def _above_0(cell: float | None) -> float | None:
    if cell is not None and not cell > 0.0:
        raise InputError(f"must be above 0, not {cell:g}")
    return cell


Above0 = Annotated[Optional, AfterValidator(_above_0)]
"""A cell that holds a mass or a force, or nothing."""

_RANGES = ("frequency", "damping", "half_width", "cg_height", "friction", "bears", "takes")

_BODY = ("half_width", "cg_height", "friction", "shelf_height")


class FurnitureRow(AssumedRow):
    """A row of furniture.csv: one kind of furniture.

    Attributes
    ----------
    furniture, title : Furniture, str
        Which kind, and in words with its article.
    frequency, damping : float or None, with _low and _high
        Of its lowest mode [Hz] and [-]; None for what moves as the floor does.
    level_error : float
        By how much its top may be off level at most, in any direction [degrees].
    source : str
        Who says so.
    anchorage : Anchorage
        Whether it is taken as fastened where nobody says it.
    half_width, cg_height, friction : float or None, with _low and _high
        Of one that is not fastened: from the middle of its base to the nearest edge [m], height of its centre of
        gravity with what stands in it [m], and friction on its floor [-].
    shelf_height : float or None
        At which objects stand in it or on it [m].
    bears, takes : float or None, with _low and _high
        Mass that it mostly bears [kg]: what is heavier is doubted.  Force that fixings on it may bring into it [N]: of
        what asks for more that is said, and of what asks for more than the low end that it may be.
    """

    # Columns that a museum's own table leaves out are checked as if they were empty.
    model_config = ConfigDict(validate_default=True)

    printed, named = "furniture.csv", "furniture"

    furniture: Furniture
    title: Text
    frequency: Hertz
    frequency_low: Hertz
    frequency_high: Hertz
    damping: Damping
    damping_low: Damping
    damping_high: Damping
    level_error: Annotated[Number, Field(ge=0.0, le=_STEEPEST)]
    source: Text
    anchorage: Anchorage = Anchorage.ANCHORED
    half_width: Length = None
    half_width_low: Length = None
    half_width_high: Length = None
    cg_height: Length = None
    cg_height_low: Length = None
    cg_height_high: Length = None
    friction: FloorFriction = None
    friction_low: FloorFriction = None
    friction_high: FloorFriction = None
    shelf_height: Length = None
    bears: Above0 = None
    bears_low: Above0 = None
    bears_high: Above0 = None
    takes: Above0 = None
    takes_low: Above0 = None
    takes_high: Above0 = None

    @field_validator(*(f"{name}_high" for name in _RANGES))
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        kind = str(info.field_name).removesuffix("_high")
        three = (info.data.get(f"{kind}_low"), info.data.get(kind), high)
        if any(cell is not None for cell in three) and None in three:
            raise InputError(f"{kind}, {kind}_low and {kind}_high go together: fill all three, or none")
        if kind == "damping" and (high is None) is not (info.data.get("frequency") is None):
            raise InputError("what shakes has a frequency and a damping: fill both, or neither")
        return in_order(high, info, f"{kind}_low", kind)

    @field_validator("anchorage")
    @classmethod
    def _can_be_loose(cls, anchorage: Anchorage, info: ValidationInfo) -> Anchorage:
        if anchorage is Anchorage.UNANCHORED and info.data.get("frequency") is None:
            raise InputError("what moves as the floor does is fastened to it: write anchored")
        return anchorage

    @field_validator("shelf_height")
    @classmethod
    def _whole(cls, height: float | None, info: ValidationInfo) -> float | None:
        cells = {name: info.data.get(name) for name in _BODY[:-1]} | {_BODY[-1]: height}
        given = [name for name, cell in cells.items() if cell is not None]
        lost = [name for name in cells if name not in given]
        if given and lost:
            raise InputError(f"what is not fastened slides or rocks by {', '.join(_BODY)}: fill {', '.join(lost)} too")
        if given and info.data.get("frequency") is None:
            raise InputError(f"what moves as the floor does is fastened to it: leave {', '.join(given)} empty")
        return height

    @property
    def key(self) -> str:
        """Its kind."""
        return self.furniture.value

    def range(self, column: str) -> Range | None:
        """Return value, low and high of a column that has them; None where its cells are empty."""
        low, value, high = (getattr(self, name) for name in (f"{column}_low", column, f"{column}_high"))
        return None if value is None else Range(value, low, high, f"{self.table} ({self.source})")


class UsualFurniture(TableRow):
    """A row of usual_furniture.csv: what objects of a class usually stand on or hang from.

    Attributes
    ----------
    object_class : str
        Row of classes.csv; "*" for every one that no other row of the same support names.
    support : str
        How it is held: hung, suspended, or standing for all others.
    taller_than : float
        Height from which it holds [m]; of several rows that hold the one of the largest counts.
    unsized : bool
        Whether it is what holds where no size is recorded, in place of the row from 0 m on.
    furniture : Furniture
        What it stands on or hangs from.
    source : str
        Who says so.
    """

    object_class: Text
    support: Literal["standing", "hung", "suspended"]
    taller_than: Annotated[Number, Field(ge=0.0)]
    unsized: YesNo
    furniture: Furniture
    source: Text


@cache
def usual_furniture() -> tuple[UsualFurniture, ...]:
    """Return what objects of each class usually stand on or hang from.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it, and where there is no row for what no other row names.
    """
    rows = checked(UsualFurniture, table("usual_furniture"), "usual_furniture.csv", named="object_class")
    for held in (STANDING, Support.HUNG, Support.SUSPENDED):
        if not any((row.object_class, row.support, row.taller_than) == (ANY, held, 0.0) for row in rows):
            raise TableError(f"usual_furniture.csv: has no row of class {ANY} and support {held} from 0 m on; add it")
    return rows
