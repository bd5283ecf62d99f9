"""A mapping: the TOML file in which a registrar says which column of the museum's file is which field of the record."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterable, Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    Field,
    PrivateAttr,
    SerializeAsAny,
    StrictBool,
    StrictFloat,
    StrictStr,
    ValidationError,
    model_validator,
)

from pipeline.collection.errors import MappingError
from pipeline.collection.image_names import pattern_keys
from pipeline.collection.mapping_parts import Display, Holds, Images, MappingPart, Museum, Texts
from pipeline.collection.record import CHOICES, KINDS, REQUIRED, units_of
from pipeline.collection.sources.base import Name, Source, SourceSettings
from pipeline.collection.sources.registry import SOURCES, source_named
from pipeline.errors import InputError, mends_toml
from pipeline.quantities import LENGTHS, MASSES
from pipeline.resources import small_text

PRESETS = Path(__file__).resolve().parent / "presets"

DIAMETER = "diameter_m"
"""The one column that is not a field of the record: it fills width_m and depth_m where they are missing."""

MAPPABLE = (*(name for name, kind in KINDS.items() if kind != "list" and name != "dimensions"), DIAMETER)
"""What a mapping may name under [columns]."""

WRITTEN = "as written"
"""The unit of a column whose cells name their own."""

Number = Annotated[StrictFloat, Field(allow_inf_nan=False)]


class SourceFaultError(InputError):
    """A section [source] that its kind of source refuses.

    Attributes
    ----------
    errors : list
        As pydantic gives them, within the section.
    """

    def __init__(self, errors: Sequence[Any]) -> None:
        super().__init__("; ".join(str(error["msg"]) for error in errors))
        self.errors = errors


def _settings_of(section: object) -> object:
    """Return the section [source] as settings of its own kind of source.

    Raises
    ------
    SourceFaultError
        For keys and values that are not that kind's.
    InputError
        For a format that no source has.
    """
    if not isinstance(section, dict) or not isinstance(section.get("format"), str):
        return section
    kind = source_named(section["format"])
    if kind is None:
        known = [source.name for source in SOURCES]
        left_out = f". {'; '.join(SOURCES.problems)}" if SOURCES.problems else ""
        raise InputError(
            f"there is no format {section['format']!r}{closest(section['format'], known)}. "
            f"Known are {', '.join(known)}{left_out}"
        )
    try:
        return kind.Settings.model_validate(section)
    except ValidationError as fault:
        raise SourceFaultError([_of_kind(kind, error) for error in fault.errors()]) from fault


def _of_kind(kind: Source, error: Any) -> dict[str, Any]:
    """Return an error within [source] in words that name the kind of source."""
    key = str(error["loc"][-1]) if error["loc"] else ""
    known = list(kind.Settings.model_fields)
    others = {name for source in SOURCES for name in source.Settings.model_fields}
    message = str(error["msg"])
    if error["type"] == "missing":
        message = f'{key} is missing; a source of format "{kind.name}" needs it'
    elif error["type"] == "extra_forbidden" and key in others:
        message = f'{key} has no meaning for format "{kind.name}"; leave it out'
    elif error["type"] == "extra_forbidden":
        message = f"there is no such key{closest(key, known)}. Known are {', '.join(known)}"
    return {"type": "source", "loc": ("source", *error["loc"]), "msg": message}


class ColumnMap(MappingPart):
    """Where one field of the record comes from."""

    constant: Name | None = Field(
        default=None, description="A text that holds for every object, where the source has no such column."
    )
    column: Name | None = Field(default=None, description="The column's name in the file's first row.")
    columns: tuple[Name, ...] = Field(
        default=(), description="Several columns, joined to one text; empty cells left out."
    )
    separator: str = Field(default=" ", description="What stands between the texts of several columns.")
    first: bool = Field(
        default=False,
        description="Of several columns only the first that says anything counts: a temporary place, else the usual; a "
        "depth, else the length.",
    )
    units: tuple[str, ...] = Field(
        default=(),
        description='Of several columns that add up, the unit of each: ["ft", "in"] for feet beside inches.',
    )
    unit: str | None = Field(
        default=None,
        description="Unit of the column's numbers; required for every length and mass, for them only. "
        f'"{WRITTEN}" where each cell holds number and unit, such as 23 cm or 8 1/2 in.',
    )
    unit_column: Name | None = Field(
        default=None,
        description="A column that names the unit of each row's number; where it is empty or no unit, unit counts.",
    )
    missing: tuple[Number | StrictStr, ...] = Field(
        default=(), description="Numbers (in the column's own unit) or texts that mean: not recorded."
    )
    values: dict[str, StrictStr | StrictBool] = Field(
        default_factory=dict,
        description="What a text of the column means; capitals and small letters count the same. An empty one is an "
        "empty cell of a flag.",
    )
    by_hand: bool = Field(
        default=False,
        description="Cells were filled in by hand: fractions, decimal commas, another unit and words such as about are "
        "read (8 1/2, 0,3, 30 cm, about 3); a number that names no unit is in that of the column.",
    )
    cases: bool = Field(
        default=False,
        description='Of the gallery: its texts name cases, plinths and shelves besides, "Gallery 1, case 3", or how a '
        'thing is held, "Atrium, hung overhead"; that part tells it, and the gallery goes without.',
    )
    opening: bool = Field(
        default=False,
        description="Of a description only its first sentence counts, which says what a thing is; a title that does "
        "not say it has the object name ahead.",
    )
    behind: tuple[Name, ...] = Field(
        default=(),
        description='Labels that its texts may have, as "Titel: Vase Beschreibung: Vase aus Porzellan" does: what '
        "stands behind the first of these that is there counts.",
    )
    optional: bool = Field(default=False, description="The file may lack this column.")

    @property
    def sources(self) -> tuple[str, ...]:
        """The names of the columns that it reads."""
        return self.columns if self.column is None else (self.column,)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.column is not None) + bool(self.columns) + (self.constant is not None) != 1:
            raise InputError('needs one of column = "name", columns = ["first", "second"] and constant = "text"')
        return self


class Mapping(MappingPart):
    """A museum's file, column by column; ``name`` is the preset's or the file's name, for messages."""

    source: Annotated[SerializeAsAny[SourceSettings], BeforeValidator(_settings_of)] = Field(
        description="How the source is read."
    )
    museum: Museum = Field(description="Whose collection it is.")
    columns: dict[str, ColumnMap] = Field(
        description="Field of the object record (or diameter_m) -> where it comes from."
    )
    dimensions: Texts | None = Field(
        default=None, description="Texts that fill heights, widths, depths and masses which no column gives."
    )
    display: Display = Field(default=Display(), description="Which locations are no galleries.")
    images: Images = Field(default=Images(), description="Photographs of the objects.")
    holds: Holds = Field(default=Holds(), description="What holds where the source contradicts itself in most rows.")
    _name: str = PrivateAttr(default="mapping")

    @property
    def name(self) -> str:
        """The preset's or the file's name."""
        return self._name

    def wanted(self) -> Iterator[tuple[str, str, bool]]:
        """Yield every column that it reads, with the key that names it and whether the source may lack it."""
        for field, column in self.columns.items():
            for source in column.sources:
                yield f"columns.{field}", source, column.optional
            if column.unit_column is not None:
                yield f"columns.{field}", column.unit_column, column.optional
        if self.dimensions is not None:
            for source in self.dimensions.columns:
                yield "dimensions", source, self.dimensions.optional

    @model_validator(mode="after")
    def _columns_fit(self) -> Self:
        unknown = [name for name in self.columns if name not in MAPPABLE]
        if unknown:
            raise InputError(
                f"columns.{unknown[0]}: there is no such field{closest(unknown[0], MAPPABLE)}. "
                f"Fields are {', '.join(MAPPABLE)}"
            )
        absent = [name for name in REQUIRED if name not in self.columns]
        if absent:
            raise InputError(f'columns.{absent[0]} is missing; add it with column = "..."')
        if "image" in pattern_keys(self.images.pattern) and "image" not in self.columns:
            raise InputError("images.pattern: has {image}, and no column gives it; add [columns.image]")
        if self.columns["gallery"].cases and "case" in self.columns:
            raise InputError(
                "columns.gallery: cases takes them from the place, and columns.case gives them; leave one out"
            )
        for field, column in self.columns.items():
            fault = _fault(field, column)
            if fault:
                raise InputError(f"columns.{field}: {fault}")
        return self


def closest(word: str, words: Iterable[str]) -> str:
    """Return a question after the most similar of some words.

    Parameters
    ----------
    word : str
        The one that is not known.
    words : iterable of str
        Those that are.

    Returns
    -------
    str
        " (did you mean 'x'?)", or "" where none is similar.
    """
    folded = {w.casefold(): w for w in words}
    near = get_close_matches(word.casefold(), folded, n=1)
    return f" (did you mean {folded[near[0]]!r}?)" if near else ""


def preset_names() -> list[str]:
    """Return the names of the mappings that come with Kouros."""
    return sorted(path.stem for path in PRESETS.glob("*.toml"))


def preset_file(name: str) -> Path:
    """Return the file of a preset, which a mapping of one's own may begin from."""
    return PRESETS / f"{name}.toml"


def load_mapping(path_or_preset_name: str | Path) -> Mapping:
    """Read a mapping.

    Parameters
    ----------
    path_or_preset_name : str or Path
        The path of a TOML file, or the name of a preset such as "carnegie".

    Returns
    -------
    Mapping
        Checked.

    Raises
    ------
    MappingError
        For neither, naming the presets, and for a file that cannot be used, naming the file, the key and the remedy.
    """
    wanted = str(path_or_preset_name)
    path = preset_file(wanted) if wanted in preset_names() else Path(wanted)
    name = wanted if path.parent == PRESETS else path.name
    if not path.is_file():
        raise MappingError(
            f"mapping {wanted!r} is neither a file nor a preset ({', '.join(preset_names())})"
            f"{closest(wanted, preset_names())}"
        )
    try:
        data = tomllib.loads(small_text(path))
    except UnicodeDecodeError as fault:
        raise MappingError(f"{name}: byte {fault.start} is not UTF-8; save the mapping as UTF-8") from fault
    except (tomllib.TOMLDecodeError, RecursionError) as fault:
        raise MappingError(f"{name}: not TOML: {fault}; {mends_toml(fault)}") from fault
    except OSError as fault:
        raise MappingError(f"{name}: cannot be read: {fault.strerror}; check its permissions and its size") from fault
    try:
        mapping = Mapping.model_validate(data)
    except ValidationError as fault:
        raise MappingError("\n".join(f"{name}: {_say(error)}" for error in _expanded(fault))) from fault
    mapping._name = name
    return mapping


def _expanded(fault: ValidationError) -> Iterator[Any]:
    """Yield all errors of a mapping, those of [source] one by one."""
    for error in fault.errors():
        cause = error.get("ctx", {}).get("error")
        yield from cause.errors if isinstance(cause, SourceFaultError) else [error]


def mapping_schema() -> dict[str, Any]:
    """Return the JSON Schema of a mapping, as schemas/mapping.schema.json holds it."""
    schema = Mapping.model_json_schema()
    schema["properties"]["columns"]["propertyNames"] = {"enum": list(MAPPABLE)}
    schema["properties"]["columns"]["required"] = list(REQUIRED)
    schema["properties"]["columns"]["properties"] = {
        field: {
            "$ref": "#/$defs/ColumnMap",
            "required": ["unit"],
            "properties": {"unit": {"enum": [*units_of(field), WRITTEN]}},
        }
        if units_of(field)
        else {"$ref": "#/$defs/ColumnMap", "not": {"required": ["unit"]}}
        for field in MAPPABLE
    }
    schema["$defs"]["ColumnMap"]["oneOf"] = [
        {"required": ["column"]},
        {"required": ["columns"]},
        {"required": ["constant"]},
    ]
    # Of another package's kind of source nothing but its name is known here.
    own = [source.Settings.model_json_schema() for source in SOURCES.own]
    for one in own:
        # References are to what the whole schema defines.
        schema["$defs"].update(one.pop("$defs", {}))
    others = {"not": {"enum": [source.name for source in SOURCES.own]}, "type": "string"}
    schema["$defs"]["SourceSettings"] = {
        "description": "How the museum's file or database is read.",
        "oneOf": [*own, {"properties": {"format": others}, "required": ["format"], "type": "object"}],
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def check_header(mapping: Mapping, file: str, header: Sequence[str]) -> None:
    """Refuse a file that lacks a column of the mapping, has one twice, or has unmapped ones that must not be.

    Parameters
    ----------
    mapping : Mapping
        What is asked for.
    file : str
        The file's name in messages.
    header : sequence of str
        The columns that are there.

    Raises
    ------
    MappingError
        Naming the mapping, the field, the column, the columns that are there and the closest of them.
    """
    there = ", ".join(repr(name[:60]) for name in header[:80]) + (", ..." if len(header) > 80 else "")
    for key, source, optional in mapping.wanted():
        if source not in header and not optional:
            raise MappingError(
                f"{mapping.name}: {key}: {file} has no column {source!r}{closest(source, header)}. "
                f"Its columns are {there}. Name one of them in the mapping"
            )
        if header.count(source) > 1:
            raise MappingError(
                f"{mapping.name}: {key}: {file} has {header.count(source)} columns named {source!r}; "
                "rename all but the one that is meant"
            )
    if mapping.source.unmapped_columns == "refuse":
        known = [source for _, source, _ in mapping.wanted()]
        for name in header:
            if name not in known:
                raise MappingError(
                    f"{mapping.name}: {file} has a column {name[:60]!r} that the mapping does not know"
                    f"{closest(name[:60], known)}. Rename or delete it"
                )


def _fault(field: str, column: ColumnMap) -> str:
    kind, units = KINDS.get(field, "number"), units_of(field)
    if column.cases and field != "gallery":
        return "cases is for the column of the gallery; leave it out"
    if column.constant is not None:
        return _constant_fault(field, kind, column)
    if (column.units or column.first) and ((fault := _several_fault(kind, units, column)) or column.units):
        return fault
    if units and column.unit not in units and column.unit != WRITTEN:
        given = "has no unit" if column.unit is None else f"cannot be in {column.unit!r}"
        return f'a {"length" if units is LENGTHS else "mass"} {given}; add unit = "..." with one of {", ".join(units)}'
    if column.unit_column is not None and (not units or column.unit == WRITTEN or kind != "number"):
        return f"unit_column is for lengths and masses whose unit is not {WRITTEN!r}; leave it out"
    if not units and column.unit is not None:
        return f"unit is for lengths ({', '.join(LENGTHS)}) and masses ({', '.join(MASSES)}) only; leave it out"
    if column.columns and not column.first and kind != "text" and column.unit != WRITTEN:
        return f"only texts can be joined from several columns, this is a {kind}; name one column"
    if column.opening and kind != "text":
        return f"opening is for texts, this is a {kind}; leave it out"
    if kind == "polygon" and (column.values or column.unit == WRITTEN):
        return f"a polygon needs a unit of {', '.join(LENGTHS)}, and no values; leave out {WRITTEN!r} and values"
    if field in REQUIRED and column.optional:
        return "every object needs it; leave out optional"
    if kind in ("number", "integer"):
        return "values translate texts, this is a number; use missing instead" if column.values else ""
    if any(not isinstance(value, str) for value in column.missing):
        return "missing must hold texts, in quotes: this field is no number"
    allowed: list[Any] | None = [True, False] if kind == "flag" else None
    if kind == "choice":
        allowed = [one.value for one in CHOICES[field]]
    for text, meaning in column.values.items():
        if allowed is not None and meaning not in allowed:
            one_of = ", ".join(str(a).lower() for a in allowed)
            return f"values: {text!r} cannot mean {meaning!r}; it must be one of {one_of}"
        if allowed is None and not isinstance(meaning, str):
            return f"values: {text!r} must mean a text, in quotes, not {meaning!r}"
    if len({text.casefold() for text in column.values}) < len(column.values):
        return "values: two texts differ in capitals only, which count the same; leave one out"
    return ""


def _several_fault(kind: str, units: Collection[str], column: ColumnMap) -> str:
    if column.first:
        return (
            ""
            if kind in ("text", "number") and len(column.columns) > 1 and not column.units
            else "first is for texts and numbers of columns"
        )
    if not units or len(column.columns) != len(column.units) or not set(column.units) <= set(units):
        return f"units needs one of {', '.join(units) or 'none'} for each of its columns, of a length or a mass"
    if column.unit is not None or column.unit_column is not None or column.values or column.by_hand:
        return "units says all of units; leave out unit, unit_column, values and by_hand"
    return ""


def _constant_fault(field: str, kind: str, column: ColumnMap) -> str:
    if kind == "flag" and column.constant not in ("true", "false"):
        return 'the constant of a flag is "true" or "false"'
    if kind not in ("text", "flag") or field == "object_number":
        return "a constant is for texts that all objects share, such as the gallery; name a column"
    if column.unit is not None or column.unit_column or column.missing or column.values or column.optional:
        return "a constant needs no unit, missing, values or optional; leave them out"
    return ""


_SECTIONS: dict[str, type[BaseModel]] = {
    "source": SourceSettings,
    "museum": Museum,
    "columns": ColumnMap,
    "dimensions": Texts,
    "display": Display,
    "holds": Holds,
}


def _say(error: Any) -> str:
    where = ".".join(str(part) for part in error["loc"])
    if error["type"] == "extra_forbidden":
        key, section = str(error["loc"][-1]), str(error["loc"][0])
        known = (
            list(_SECTIONS[section].model_fields) if section in _SECTIONS and len(error["loc"]) > 1 else list(_SECTIONS)
        )
        return f"{where}: there is no such key{closest(key, known)}. Known are {', '.join(known)}"
    message = error["msg"].removeprefix("Value error, ")
    return f"{where}: {message}" if where else message
