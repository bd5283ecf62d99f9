"""A house rule as settings and workbooks of surveys have it: what it is for, what it states, and who says so."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from enum import StrEnum
from functools import cached_property
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, StrictFloat, model_validator

from pipeline.errors import InputError
from pipeline.records import Anchorage, Furniture, Hanging, Mount, Support, SurfaceMaterial

STANDING = frozenset({Support.FREESTANDING, Support.FASTENED, Support.ISOLATED})
ABOVE = frozenset({Support.HUNG, Support.SUSPENDED})
"""Ways to be held, of what stands and of what hangs."""

QUANTITIES: Mapping[str, tuple[str, frozenset[Support]]] = {
    "friction": ("-", STANDING),
    "clearance_m": ("m", STANDING | ABOVE),
    "cg_height_m": ("m", STANDING),
    "cg_ratio": ("-", STANDING),
    "base_ratio": ("-", STANDING),
    "suspension_length_m": ("m", ABOVE),
    "suspension_ratio": ("-", ABOVE),
    "damping": ("-", STANDING | ABOVE),
    "frequency_hz": ("Hz", STANDING),
}
"""What a rule may state as a number: its unit, and of objects that are held how it can be."""

WORDS = ("hanging", "furniture", "furniture_anchorage", "surface", "held", "mount")
"""What a rule may state as a word of a vocabulary."""

SLOTS = {"cg_ratio": "cg_height_m", "suspension_ratio": "suspension_length_m"}
"""Two ways to state one thing: the more particular rule decides which of them is taken."""

SHARES = {"cg_ratio": (0.0, 1.0), "base_ratio": (0.0, 1.0), "suspension_ratio": (0.0, 50.0)}
"""What a share may be; a cord from a rail may be longer than the work is high."""

CRITERIA = ("number", "object_class", "gallery", "medium", "support")

TAKEN_BACK = ("taken_back_by", "taken_back_on", "taken_back_why")
"""Who took a rule back, when and why: all of them, or none."""

_LISTED = 3
"""Names of one criterion that the words for a rule repeat."""


class Span(BaseModel):
    """A value, or three: the lowest that may be, the best, the highest."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    low: StrictFloat = Field(allow_inf_nan=False, description="the lowest that may be")
    best: StrictFloat = Field(allow_inf_nan=False, description="the likeliest")
    high: StrictFloat = Field(allow_inf_nan=False, description="the highest that may be")

    @model_validator(mode="after")
    def _in_order(self) -> Span:
        if not self.low <= self.best <= self.high:
            raise InputError(f"low <= best <= high does not hold: {self.low:g}, {self.best:g}, {self.high:g}")
        return self


def _spanned(given: object) -> object:
    if isinstance(given, int | float) and not isinstance(given, bool):
        return {"low": given, "best": given, "high": given}
    if isinstance(given, str):
        raise InputError("write a number, or a table of low, best and high")
    return given


def _several(given: object) -> object:
    return given if isinstance(given, list | tuple) else (given,)


def _printable(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise InputError("write words on one line")
    return text


_Quantity = Annotated[Span | None, BeforeValidator(_spanned, json_schema_input_type=float | Span | None)]
_Name = Annotated[str, Field(max_length=200), AfterValidator(_printable)]
_Reason = Annotated[str, Field(max_length=2_000), AfterValidator(_printable)]
_Names = Annotated[
    tuple[_Name, ...], Field(max_length=10_000), BeforeValidator(_several, json_schema_input_type=str | tuple[str, ...])
]


class HouseRule(BaseModel):
    """What the museum states once for all objects that a rule matches; the most particular rule that matches is taken.

    The record of an object is taken before any rule.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    number: _Names = Field(
        default=(), description='object numbers, or patterns of them in which * stands for anything: "1922.*"'
    )
    object_class: _Names = Field(
        default=(), alias="class", description="classes of objects, rows of the table of classes"
    )
    gallery: _Names = Field(default=(), description="galleries as the records name them")
    medium: _Names = Field(default=(), description="words one of which stands in material or medium")
    support: Annotated[
        tuple[Support, ...], BeforeValidator(_several, json_schema_input_type=Support | tuple[Support, ...])
    ] = Field(
        default=(), description="how they are held, by their records, by `held` of a rule, or else by their class"
    )
    hanging: Hanging | None = Field(default=None, description="how they hang")
    furniture: Furniture | None = Field(default=None, description="what they stand on or in, or hang from")
    furniture_anchorage: Anchorage | None = Field(
        default=None, description="whether that furniture is fastened to its floor or a wall"
    )
    surface: SurfaceMaterial | None = Field(
        default=None, description="what lies under them, from which their friction is found where nobody measured it"
    )
    held: Support | None = Field(default=None, description="how they are held, where their records do not say it")
    mount: Mount | None = Field(
        default=None, description="how things are held that lie in a case or cannot stand by themselves"
    )
    friction: _Quantity = Field(default=None, description="friction between footing and surface")
    clearance_m: _Quantity = Field(default=None, description="room to the nearest neighbour or edge, in m")
    cg_height_m: _Quantity = Field(default=None, description="height of the centre of gravity above the base, in m")
    cg_ratio: _Quantity = Field(default=None, description="the same as a share of the height")
    base_ratio: _Quantity = Field(
        default=None, description="width of the footing as a share of the largest width, and depth likewise"
    )
    suspension_length_m: _Quantity = Field(
        default=None, description="length from the hook to the centre of gravity, in m"
    )
    suspension_ratio: _Quantity = Field(default=None, description="the same as a share of the height")
    damping: _Quantity = Field(default=None, description="ratio to critical damping")
    frequency_hz: _Quantity = Field(default=None, description="lowest natural frequency, in Hz")
    said_by: _Name = Field(description="who says so")
    said_on: date = Field(description="when, as 2031-05-01")
    taken_back_by: _Name | None = Field(default=None, description="who took it back: it holds for nothing any more")
    taken_back_on: date | None = Field(default=None, description="when")
    taken_back_why: _Reason | None = Field(default=None, description="why")

    @model_validator(mode="after")
    def _whole(self) -> HouseRule:
        if not any(getattr(self, name) for name in CRITERIA):
            raise InputError('name what it is for: class, gallery, medium, number or support (number = "*" is all)')
        back = [name for name in TAKEN_BACK if getattr(self, name) is not None]
        if back and len(back) < len(TAKEN_BACK):
            lost = next(name for name in TAKEN_BACK if name not in back)
            raise InputError(f"a rule that is taken back says {', '.join(TAKEN_BACK)}: {lost} is missing")
        if not self.states:
            raise InputError(f"states nothing: say one of {', '.join((*WORDS, *QUANTITIES))}")
        if self.mount is Mount.UNKNOWN:
            raise InputError("mount: 'unknown' is what holds without a rule; say how they are held")
        for share, length in SLOTS.items():
            if getattr(self, share) is not None and getattr(self, length) is not None:
                raise InputError(f"states one thing twice: keep {length} or {share}")
        for name in QUANTITIES:
            span = getattr(self, name)
            if span is not None:
                _believable(name, span)
        return self

    @property
    def holds(self) -> bool:
        """Whether nobody took it back."""
        return self.taken_back_by is None

    @cached_property
    def states(self) -> Mapping[str, tuple[str, Span | StrEnum]]:
        """What it states, by what it is about: the field, and the value."""
        given = {name: getattr(self, name) for name in (*WORDS, *QUANTITIES)}
        return {SLOTS.get(name, name): (name, value) for name, value in given.items() if value is not None}

    @cached_property
    def words(self) -> str:
        """What it is for, in words: "class framed, gallery East or West"."""
        said = []
        for name in CRITERIA:
            values: tuple[str, ...] = getattr(self, name)
            shown = list(map(str, values[:_LISTED]))
            shown += [f"{len(values) - _LISTED:,} more"] if len(values) > _LISTED else []
            if values:
                said.append(f"{'class' if name == 'object_class' else name} {' or '.join(shown)}")
        return ", ".join(said)

    @property
    def source(self) -> str:
        """Who says so, and when."""
        return f"{self.said_by}, {self.said_on.isoformat()}"

    def told(self) -> dict[str, Any]:
        """Return what a run keeps of it for the news: its words and source as notes have them, and of what they are."""
        others = ("gallery", "number", "medium", "support")
        return {
            "words": self.words,
            "source": self.source,
            "who": self.said_by,
            "date": self.said_on.isoformat(),
            "classes": list(self.object_class),
            "about": [str(one) for name in others for one in getattr(self, name)[:_LISTED]],
            "states": {name: str(value) if isinstance(value, StrEnum) else "" for name, value in self.states.values()},
            "back": [str(getattr(self, name)) for name in TAKEN_BACK] if not self.holds else [],
        }

    def plain(self) -> dict[str, Any]:
        """Return what it says as the keys and values of TOML."""
        out: dict[str, Any] = {}
        for name, info in type(self).model_fields.items():
            value = getattr(self, name)
            if value in (None, ()):
                continue
            if isinstance(value, tuple):
                value = [str(one) for one in value] if len(value) > 1 else str(value[0])
            elif isinstance(value, Span):
                value = value.best if value.low == value.high else value.model_dump()
            out[info.alias or name] = str(value) if isinstance(value, StrEnum) else value
        return out


def _believable(name: str, span: Span) -> None:
    # Settings are read at every start of the command, which need not wait for tables that most do not need.
    from pipeline.collection.record import plausible

    limits = plausible().get(name)
    low, high, unit = (*SHARES[name], "-") if limits is None else (limits.low, limits.high, limits.unit)
    if not low <= span.low <= span.high <= high:
        of = "" if unit == "-" else f" {unit}"
        raise InputError(f"{name} must lie within {low:g} and {high:g}{of}, not {span.low:g} to {span.high:g}")
