"""Parts of a mapping that no other part hangs on: the museum, its texts, which places are no galleries, photographs."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from pipeline.collection.dimensions import languages
from pipeline.collection.image_names import pattern_keys
from pipeline.collection.sources.base import Name
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS


class MappingPart(BaseModel):
    """What all parts of a mapping have in common: unknown keys are errors, and nothing changes once it is read."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Museum(MappingPart):
    """Whose collection it is."""

    name: Name = Field(description="The museum's name, as reports show it.")
    credit: str = Field(default="", description="How the museum wants its data to be credited.")


class Texts(MappingPart):
    """Texts in which dimensions and weights stand, such as "8 1/2 x 11 in. (21.6 x 27.9 cm)"."""

    columns: tuple[Name, ...] = Field(
        min_length=1, description="The columns; what the first does not say is taken from the next."
    )
    unit: str | None = Field(
        default=None, description="Unit of numbers that have none; without it they are reported and not used."
    )
    language: str = Field(
        default="",
        description="Language of the texts (en, fr, de, nl, it, es, pt, ro, el, tr, pl, cs, hu, ru), which settles "
        "short labels, L. or D.; without it the words of each text do.",
    )
    order: tuple[Literal["height", "width", "depth", "length", "diameter"], ...] = Field(
        default=(),
        description="What numbers without a label are by their order, where it is not height, width, depth: such as "
        '["length", "width", "height"].',
    )
    framed: bool = Field(default=True, description="Whether works in frames hang in them: then the frame counts.")
    prose: tuple[Name, ...] = Field(
        default=(),
        description="Those of the columns that hold sentences: read only where the others are empty, and there only "
        "numbers that name a side or have a unit.",
    )
    optional: bool = Field(default=False, description="The source may lack these columns.")

    @model_validator(mode="after")
    def _among(self) -> Self:
        other = next((name for name in self.prose if name not in self.columns), None)
        if other is not None:
            raise InputError(f"prose names {other!r}, which is none of the columns; add it to columns")
        return self

    @field_validator("unit")
    @classmethod
    def _known(cls, unit: str | None) -> str | None:
        if unit is not None and unit not in LENGTHS:
            raise InputError(f"{unit!r} is no unit of length; use one of {', '.join(LENGTHS)}")
        return unit

    @field_validator("language")
    @classmethod
    def _spoken(cls, language: str) -> str:
        if language and language not in languages():
            raise InputError(f"{language!r} is no language of dimension texts; use one of {', '.join(languages())}")
        return language


class Display(MappingPart):
    """Which locations are no galleries."""

    not_on_display: tuple[Name, ...] = Field(
        default=(), description="Locations (such as a store) whose objects are not on display, and so not assessed."
    )
    on_display: tuple[Name, ...] = Field(
        default=(),
        description="Locations that are galleries although their names sound otherwise, such as a store that is open.",
    )


class Images(MappingPart):
    """Photographs of the objects: how a file, a URL or an address of IIIF follows from the records."""

    pattern: str = Field(
        default="",
        max_length=1000,
        description="The file or the URL of a photograph, with {object_number} where no column gives one, or with "
        "{image} for what the column gives, such as https://images.museum.org/{object_number}.jpg.",
    )
    credit: str = Field(
        default="", max_length=500, description="Licence or credit line of the photographs that have none of their own."
    )

    @field_validator("pattern")
    @classmethod
    def _filled(cls, pattern: str) -> str:
        if pattern and pattern_keys(pattern) not in ({"object_number"}, {"image"}):
            raise InputError(
                f"{pattern!r} names neither {{object_number}} nor {{image}}, or both, or something else in braces; "
                "write one of them where the number of the object, or what the column gives, stands"
            )
        return pattern


class Holds(MappingPart):
    """What holds where a source contradicts itself in most rows; without it the import stops there."""

    texts: Literal["columns", "texts"] | None = Field(
        default=None, description="Columns of sizes and masses, or the texts of dimensions that say otherwise."
    )
    sides: Literal["mapping"] | None = Field(
        default=None, description="Height, width and depth as mapped, although texts say that they are exchanged."
    )
    units: Literal["mapping"] | None = Field(
        default=None,
        description="Units as mapped, although a column of units, how the numbers are written, or what the things are "
        "say another.",
    )
    weights: Literal["mapping"] | None = Field(
        default=None, description="Masses and their unit as mapped, although they do not fit the objects' sizes."
    )
    display: Literal["flag", "location"] | None = Field(
        default=None, description="The flag, or the location that says otherwise, on whether an object is on display."
    )
