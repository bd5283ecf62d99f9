"""Rows of the tables of what is assumed: classes.csv, materials.csv, friction.csv and damping.csv."""

from collections.abc import Collection
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.records import Support
from pipeline.tables import Range
from pipeline.tables.rows import Entries, Number, Optional, RangeRow, TableRow, Text, YesNo, in_order

_JUDGEMENT = "judgement"

NO_MODEL, WHEN_HELD = "none", "held"
"""In the column models of classes.csv: no generic model applies; none does until it is recorded how it is held."""

Above0 = Annotated[Number, Field(gt=0.0)]


def _share(value: float | None) -> float | None:
    if value is not None and not 0.0 < value <= 1.0:
        raise InputError(f"is a share: it must be above 0 and at most 1, not {value:g}")
    return value


Share = Annotated[Optional, AfterValidator(_share)]
"""A cell that holds a number above 0 and up to 1, or nothing."""


def _held(support: Support) -> Support:
    if support is Support.ISOLATED:
        raise InputError("is 'isolated', which measures make of an object; say how it stands or hangs without them")
    return support


class AssumedRow(TableRow):
    """A row of a table of what is assumed, Kouros's own or the museum's.

    Validators take from the context: ``own``, the name of the museum's file, "" where the row is Kouros's own.
    """

    printed: ClassVar[str]
    """What notes call Kouros's own table."""

    named: ClassVar[str]
    """The column by which messages name a row."""

    _own: str = PrivateAttr("")

    def model_post_init(self, context: Any) -> None:
        """Note whose row it is."""
        self._own = (context or {}).get("own", "")

    @property
    def key(self) -> str:
        """What makes it the row that it is: of two with the same key one takes the place of the other."""
        return str(getattr(self, "name", ""))

    @property
    def own(self) -> str:
        """The name of the museum's file; "" for a row of Kouros's."""
        return self._own

    @property
    def table(self) -> str:
        """Which table says so, in the words of a report."""
        return f"the museum's {self._own}" if self._own else self.printed

    @property
    def aside(self) -> str:
        """What is added to words about a row of the museum's own; "" for one of Kouros's."""
        return f" ({self.table})" if self._own else ""


class ObjectClass(AssumedRow):
    """A row of classes.csv: what is assumed of the objects of one class.

    Attributes
    ----------
    name, title : str
        In tables and decisions, and in words.
    support : Support
        How it is held.
    round : bool
        Whether its plan is a circle; else a rectangle.
    section : str
        Which section is critical; "" for none.
    models : tuple of str
        Those that are tried on it, or `NO_MODEL` or `WHEN_HELD` alone.
    rocking_harms : bool
        Whether rocking itself harms it; else it fails if it falls over.
    why, source : str
        Why an object of this class is treated so, and who says so.
    base_source : str
        Who says so of its base in Kouros's own table; "" where that is who says the rest.
    """

    printed, named = "classes.csv", "class"

    name: Text = Field(alias="class")
    title: Text
    support: Annotated[Support, AfterValidator(_held)]
    round: YesNo
    cg_ratio: Share
    cg_low: Share
    cg_high: Share
    base_ratio: Share
    base_low: Share
    base_high: Share
    section: Literal["", "stem", "ankles", "foot", "legs", "ring", "plan"]
    section_ratio: Share
    section_low: Share
    section_high: Share
    fill: Share
    fill_low: Share
    fill_high: Share
    clearance: Annotated[Optional, Field(gt=0.0)]
    clearance_low: Annotated[Optional, Field(gt=0.0)]
    clearance_high: Annotated[Optional, Field(gt=0.0)]
    models: Entries
    rocking_harms: YesNo = True
    why: Text
    source: Text
    base_source: str = ""

    @field_validator("cg_high", "base_high", "section_high", "fill_high", "clearance_high")
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        kind = (info.field_name or "").removesuffix("_high")
        value = f"{kind}_ratio" if f"{kind}_ratio" in cls.model_fields else kind
        three = (info.data.get(f"{kind}_low"), info.data.get(value), high)
        if any(cell is not None for cell in three) and None in three:
            raise InputError(f"{value}, {kind}_low and {kind}_high go together: fill all three, or none")
        if kind == "section" and bool(info.data.get("section")) is not (high is not None):
            raise InputError("a critical section and its size go together: fill section and the three sizes, or none")
        return in_order(high, info, f"{kind}_low", value)

    @field_validator("models")
    @classmethod
    def _known(cls, models: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        known: Collection[str] | None = (info.context or {}).get("models")
        if not models:
            raise InputError(f"is empty; name models parted by |, or write {NO_MODEL} or {WHEN_HELD}")
        if set(models) & {NO_MODEL, WHEN_HELD} and len(models) > 1:
            raise InputError(f"{NO_MODEL} and {WHEN_HELD} stand alone; remove them or the models")
        strange = [name for name in models if known is not None and name not in {*known, NO_MODEL, WHEN_HELD}]
        if strange:
            raise InputError(f"there is no model {strange[0]!r}; use some of {', '.join(sorted(known or ()))}")
        return models

    @cached_property
    def cg(self) -> Range | None:
        """Height of the centre of gravity over its height [-]."""
        return self._range(self.cg_ratio, self.cg_low, self.cg_high)

    @cached_property
    def base(self) -> Range | None:
        """Width of its base over its largest width [-]."""
        return self._range(self.base_ratio, self.base_low, self.base_high, "" if self.own else self.base_source)

    @cached_property
    def critical(self) -> Range | None:
        """Size of its critical section over its narrower side, or that of its base [-]."""
        return self._range(self.section_ratio, self.section_low, self.section_high)

    @cached_property
    def filled(self) -> Range | None:
        """Volume of its material over that of its outline [-]."""
        return self._range(self.fill, self.fill_low, self.fill_high)

    @cached_property
    def room(self) -> Range | None:
        """Free distance to neighbour, wall or edge [m]."""
        return self._range(self.clearance, self.clearance_low, self.clearance_high)

    @property
    def told(self) -> str:
        """The class in words, with the table where that is the museum's."""
        return f"{self.title.lower()}{self.aside}"

    def _range(self, value: float | None, low: float | None, high: float | None, source: str = "") -> Range | None:
        if value is None or low is None or high is None:
            return None
        return Range(value, low, high, f"{self.table}, {self.name} ({source or self.source})")


class Material(AssumedRow):
    """A row of materials.csv.

    Attributes
    ----------
    name : str
        What tables call it.
    words : tuple of str
        By which it is found in a record; one after = is all there is between two marks (=石).
    friction_as : str
        The row of friction.csv whose friction it has; "" for any.
    density, tensile : float
        [kg/m3] and [Pa], with the ends of their ranges.
    modulus : float or None
        Young's modulus [Pa] of what is slender of it, with the ends of its range; None where a museum's row leaves it
        to Kouros's.
    ductile : bool or None
        Whether it yields before it breaks; None as of the modulus.
    source : str
        Who says so.
    """

    printed, named = "materials.csv", "material"

    name: Text = Field(alias="material")
    words: Entries
    friction_as: str
    density: Above0
    density_low: Above0
    density_high: Above0
    tensile: Above0
    tensile_low: Above0
    tensile_high: Above0
    # Museums have rows from before there were these columns.
    modulus: Annotated[Optional, Field(gt=0.0)] = None
    modulus_low: Annotated[Optional, Field(gt=0.0)] = None
    modulus_high: Annotated[Optional, Field(gt=0.0)] = None
    ductile: Annotated[YesNo | None, BeforeValidator(lambda cell: None if cell == "" else cell)] = None
    source: Text

    @field_validator("density_high", "tensile_high", "modulus_high")
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        kind = (info.field_name or "").removesuffix("_high")
        three = (info.data.get(f"{kind}_low"), info.data.get(kind), high)
        if None in three and any(cell is not None for cell in three):
            raise InputError(f"{kind}, {kind}_low and {kind}_high go together: fill all three, or none")
        return in_order(high, info, f"{kind}_low", kind)

    @property
    def where(self) -> str:
        """Its row, in the words of a report."""
        return f"{self.table}, {self.name}"

    @property
    def told(self) -> str:
        """The material in words, with the table where that is the museum's."""
        return f"{self.name}{self.aside}"

    @cached_property
    def density_range(self) -> Range:
        """Density [kg/m3]."""
        return Range(self.density, self.density_low, self.density_high, self.where)

    @cached_property
    def tensile_range(self) -> Range:
        """Stress that it bears [Pa]."""
        return Range(self.tensile, self.tensile_low, self.tensile_high, self._said)

    @cached_property
    def modulus_range(self) -> Range | None:
        """Young's modulus [Pa]; None where the row leaves it to Kouros's."""
        if self.modulus is None or self.modulus_low is None or self.modulus_high is None:
            return None
        return Range(self.modulus, self.modulus_low, self.modulus_high, self._said)

    @property
    def _said(self) -> str:
        return f"{self.where} ({self.source})" if self.own else self.source


class PairRow(AssumedRow, RangeRow):
    """A row about two surfaces that touch: a value with its range."""

    @field_validator("low")
    @classmethod
    def _not_negative(cls, low: float) -> float:
        if low < 0.0:
            raise InputError(f"must be 0 or more, not {low:g}")
        return low

    @property
    def pair(self) -> tuple[str, str]:
        """The two surfaces, in small letters."""
        raise NotImplementedError

    @property
    def key(self) -> str:
        """The pair in words."""
        return " on ".join(self.pair)

    @property
    def said(self) -> str:
        """Who says so, in short."""
        if self.own:
            return f"{self.table} ({self.source})"
        return _JUDGEMENT if self.source.startswith(_JUDGEMENT) else self.source.split(" (")[0]


class Friction(PairRow):
    """A row of friction.csv: the static coefficient of friction of a pair [-]."""

    printed, named = "Table 3", "object_material"

    object_material: Text
    surface_material: Text

    @property
    def table(self) -> str:
        """Which table says so: the paper's, or Kouros's own where the paper has no such pair."""
        return super().table if self.own or self.source.startswith("Agbabian") else "friction.csv"

    @property
    def pair(self) -> tuple[str, str]:
        """What slides, and on what, in small letters."""
        return self.object_material.lower(), self.surface_material.lower()


class WallDamping(PairRow):
    """A row of damping.csv: the damping ratio of a painting's back against its wall [-]."""

    printed, named = "Table 4", "wall_surface"

    wall_surface: Text
    back_surface: Text

    @property
    def pair(self) -> tuple[str, str]:
        """Wall and back, in small letters."""
        return self.wall_surface.lower(), self.back_surface.lower()

    @field_validator("high")
    @classmethod
    def _below_critical(cls, high: float) -> float:
        if high >= 1.0:
            raise InputError(f"is a ratio of critical damping: it must be below 1 (0.02 is 2 %), not {high:g}")
        return high
