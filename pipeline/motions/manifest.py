"""The manifest of a site: which records, what they are, who answers for them (contract "A site")."""

from __future__ import annotations

import hashlib
import json
import re
import tomllib
from datetime import date
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from pipeline.motions.errors import MotionError, refusal

MANIFEST = "manifest.toml"

# A control character in a name could rewrite a terminal or break a table; nothing that people write needs one.
_PRINTABLE = r"^[^\x00-\x1f\x7f]*$"
Text = Annotated[str, StringConstraints(min_length=1, max_length=500, pattern=_PRINTABLE)]

# The same rule as _inside below, for validators of the schema; in Python the message can say what is wrong.
_INSIDE = r"^(?!/)(?![A-Za-z]:)(?!(.*/)?\.\.(/|$))[^\\\x00-\x1f\x7f]+$(?!\n)"


def _inside(name: str) -> str:
    drive = re.match(r"[A-Za-z]:", name)
    control = re.search(r"[\x00-\x1f\x7f]", name)
    if not name or name.startswith("/") or drive or control or "\\" in name or ".." in name.split("/"):
        raise ValueError(
            f"{name!r} leaves the site's folder: name a file inside it, with / between folders and without '..'"
        )
    return name


FileName = Annotated[str, AfterValidator(_inside), Field(json_schema_extra={"pattern": _INSIDE, "minLength": 1})]
Digest = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
Unit = Literal["m/s2", "cm/s2", "mm/s2", "gal", "g", "mg"]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Horizontal(_Table):
    """A horizontal channel and its azimuth in degrees clockwise from north; left out, the file's header says it.

    The two axes only tell the channels apart: the azimuths decide what is turned into east and north.
    """

    axis: Literal["x", "y"]
    orientation: float | None = Field(default=None, ge=0.0, le=360.0)


class Vertical(_Table):
    """A vertical channel: positive up or positive down; left out, the file's header says it."""

    axis: Literal["z"]
    orientation: Literal["up", "down"] | None = None


Component = Annotated[Horizontal | Vertical, Discriminator("axis")]


class Record(_Table):
    """One three-component record and what is to be done to it.

    files      : paths inside the site's folder; `response` is their StationXML, where they hold counts
    components : file name, channel code or full channel id -> axis and orientation; x, y and z once each
    units      : only where the file itself does not say
    processed  : whether the agency has filtered it already; such a record is never filtered again.  Left out, the
                 files' headers say it
    scale, scale_to_pga_g : one factor for all three components, or the PGA in g that the larger recorded horizontal
                 component shall have; neither leaves the record as it was recorded
    window_s   : start and end in s from the first common sample
    sha256     : of every file named, the response included
    """

    model_config = ConfigDict(
        json_schema_extra={
            "allOf": [
                {"not": {"required": ["scale", "scale_to_pga_g"]}},
                {"not": {"required": ["units", "response"]}},
                {
                    "if": {"properties": {"processed": {"const": True}}, "required": ["processed"]},
                    "then": {
                        "not": {
                            "anyOf": [
                                {"required": ["highpass_hz"]},
                                {"required": ["lowpass_hz"]},
                                {"required": ["response"]},
                            ]
                        }
                    },
                },
            ]
        }
    )

    name: Text
    files: tuple[FileName, ...] = Field(min_length=1)
    response: FileName | None = None
    components: dict[Text, Component] = Field(min_length=3, max_length=3)
    units: Unit | None = None
    processed: bool | None = None
    scale: float | None = Field(default=None, gt=0.0)
    scale_to_pga_g: float | None = Field(default=None, gt=0.0, le=20.0)
    highpass_hz: float | None = Field(default=None, gt=0.0)
    lowpass_hz: float | None = Field(default=None, gt=0.0)
    window_s: tuple[Annotated[float, Field(ge=0.0)], Annotated[float, Field(gt=0.0)]] | None = None
    source: Text
    licence: Text
    sha256: dict[FileName, Digest]

    @property
    def all_files(self) -> tuple[str, ...]:
        """Every file that the record is made of, the response included."""
        return self.files if self.response is None else (*self.files, self.response)

    @model_validator(mode="after")
    def _consistent(self) -> Record:
        if len(set(self.all_files)) < len(self.all_files):
            raise ValueError("files: a file is named twice; name each file once")
        axes = sorted(c.axis for c in self.components.values())
        if axes != ["x", "y", "z"]:
            raise ValueError(f"components: the axes are {', '.join(axes)}; give each of x, y and z exactly once")
        given = {key for key in ("scale", "scale_to_pga_g") if getattr(self, key) is not None}
        if len(given) > 1:
            raise ValueError("scale and scale_to_pga_g are both given; keep one of them")
        if self.response is not None and self.units is not None:
            raise ValueError("units and response are both given; counts with a response have no other unit, drop units")
        again = [key for key in ("response", "highpass_hz", "lowpass_hz") if getattr(self, key) is not None]
        if self.processed and again:
            raise ValueError(
                f"{', '.join(again)}: a processed record is never processed again; drop it, or give raw files"
            )
        if self.highpass_hz is not None and self.lowpass_hz is not None and self.highpass_hz >= self.lowpass_hz:
            raise ValueError(f"highpass_hz {self.highpass_hz:g} must be below lowpass_hz {self.lowpass_hz:g}")
        if self.window_s is not None and self.window_s[0] >= self.window_s[1]:
            raise ValueError(f"window_s {list(self.window_s)} must be [start, end] with start before end")
        return self


class LevelTable(_Table):
    """A level of shaking: its records, how several are combined, and the engineer who answers for it.

    combine : "max" (the worst record decides) or "mean" (an object overturns when half the records overturn it)
    approved_by, approved_on : both or neither; reports say so when nobody answers
    """

    name: Text
    return_period_years: float | None = Field(default=None, gt=0.0)
    combine: Literal["max", "mean"]
    approved_by: Annotated[str, StringConstraints(max_length=500, pattern=_PRINTABLE)] = ""
    approved_on: date | None = None
    record: tuple[Record, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _consistent(self) -> LevelTable:
        if bool(self.approved_by) != (self.approved_on is not None):
            raise ValueError("approved_by and approved_on belong together; give both, or leave both out")
        return self


class FloorTable(_Table):
    """A floor above the ground: a height ratio with the building's period in s, or a record made on that floor."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["height_ratio", "period_s"], "not": {"required": ["record"]}},
                {
                    "required": ["record"],
                    "not": {"anyOf": [{"required": ["height_ratio"]}, {"required": ["period_s"]}]},
                },
            ]
        }
    )

    name: Text
    height_ratio: float | None = Field(default=None, ge=0.0, le=1.0)
    period_s: float | None = Field(default=None, gt=0.0)
    record: Record | None = None

    @model_validator(mode="after")
    def _consistent(self) -> FloorTable:
        building = (self.height_ratio is not None, self.period_s is not None)
        if building != ((True, True) if self.record is None else (False, False)):
            raise ValueError("give either height_ratio with period_s, or record alone")
        return self


class SiteTable(_Table):
    """Where the site is: degrees north and east, and the shear-wave velocity of the upper 30 m in m/s where known."""

    name: Text
    latitude: float = Field(ge=-90.0, le=90.0)
    longitude: float = Field(ge=-180.0, le=180.0)
    vs30: float | None = Field(default=None, gt=0.0)


class Manifest(_Table):
    """A site's manifest.toml."""

    site: SiteTable
    level: tuple[LevelTable, ...] = Field(min_length=1)
    floor: tuple[FloorTable, ...] = ()

    def records(self) -> list[tuple[str, Record]]:
        """Return every record with its key path, those of the floors included."""
        found = [
            (f"level[{i}].record[{j}]", record)
            for i, level in enumerate(self.level)
            for j, record in enumerate(level.record)
        ]
        return found + [(f"floor[{i}].record", f.record) for i, f in enumerate(self.floor) if f.record is not None]

    @model_validator(mode="after")
    def _consistent(self) -> Manifest:
        for key, names in (
            ("level", [level.name for level in self.level]),
            ("record", [record.name for _, record in self.records()]),
            ("floor", [floor.name for floor in self.floor]),
        ):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise ValueError(f"two {key}s are called {twice[0]!r}; give each {key} its own name")
        return self


_TABLES: dict[str, type[BaseModel]] = {
    "": Manifest,
    "site": SiteTable,
    "level": LevelTable,
    "record": Record,
    "floor": FloorTable,
    "components": Horizontal,
}


def manifest_schema() -> dict[str, Any]:
    """Return the JSON Schema of a manifest, as schemas/site-manifest.schema.json holds it.

    Rules that span several tables (names that differ, each axis once, hashes that agree) are checked on loading only.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Manifest.model_json_schema(),
        "title": "Kouros site manifest",
    }


def manifest_file(path: str | Path) -> Path:
    """Return the manifest of a site's folder, or the manifest file itself.

    raises : MotionError if there is none
    """
    path = Path(path)
    file = path / MANIFEST if path.is_dir() else path
    if not file.is_file():
        remedy = f"give a site's folder that holds a {MANIFEST}, or that file itself"
        raise refusal(file, "manifest", "there is no such file", remedy)
    return file


def load_manifest(folder: str | Path) -> Manifest:
    """Read and check a site's manifest, with the presence and the hash of every file that it names.

    folder  : the site's folder, or its manifest.toml
    raises  : MotionError naming the manifest, the key path and the remedy
    """
    file = manifest_file(folder)
    try:
        data = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise refusal(file, "TOML", str(error), "mend the line; the file is TOML in UTF-8") from error
    try:
        # Through JSON, so that the strict rules of the model are those of the JSON Schema.
        manifest = Manifest.model_validate_json(json.dumps(data, default=_as_json))
    except ValidationError as error:
        raise _explained(file, error) from error
    for key, record in manifest.records():
        _check_files(file, key, record)
    return manifest


def _as_json(value: Any) -> str:
    return str(value.isoformat())


def _explained(file: Path, error: ValidationError) -> MotionError:
    told = [_told(problem) for problem in error.errors(include_url=False)]
    more = f" (and {len(told) - 5} more)" if len(told) > 5 else ""
    return MotionError(f"{file}: " + "\n  ".join(told[:5]) + more)


def _told(problem: Any) -> str:
    loc = list(problem["loc"])
    if "components" in loc:
        # The third element after the table is the tag that chose the model, not a key of the file.
        tag = loc.index("components") + 2
        if tag < len(loc) and loc[tag] in {"x", "y", "z"}:
            del loc[tag]
    path = ""
    for part in loc:
        path += f"[{part}]" if isinstance(part, int) else f"{'.' if path else ''}{part}"
    kind = problem["type"]
    if kind in {"extra_forbidden", "missing"}:
        tables = [part for part in loc[:-1] if part in _TABLES]
        allowed = ", ".join(_TABLES[tables[-1] if tables else ""].model_fields)
        if kind == "missing":
            return f"{path}: missing; add it (the table's keys: {allowed})"
        return f"{path}: unknown key; remove or correct it (allowed: {allowed})"
    message = problem["msg"].removeprefix("Value error, ")
    given = "" if kind == "value_error" else f"; correct the value {str(problem['input'])[:80]!r}"
    return f"{path or 'manifest'}: {message}{given}"


def _check_files(file: Path, key: str, record: Record) -> None:
    folder = file.parent.resolve()
    names = record.all_files
    stray = sorted(set(record.sha256) - set(names))
    if stray:
        raise refusal(
            file, f"{key}.sha256.{stray[0]!r}", "hash of a file that the record does not name", "remove it, or name it"
        )
    for name in names:
        path = folder / PurePosixPath(name)
        where = f"{key}.{'response' if name == record.response else 'files'}"
        if not path.resolve().is_relative_to(folder):
            raise refusal(file, where, f"{name!r} is a link out of the site's folder", "copy the file into the folder")
        if not path.is_file():
            raise refusal(file, where, f"there is no file {name!r}", "put it into the site's folder or mend its name")
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        place = f"{key}.sha256.{name!r}"
        if name not in record.sha256:
            raise refusal(file, place, "the file has no hash", f"once you have checked the file, give it {digest}")
        if record.sha256[name] != digest:
            raise refusal(
                file,
                place,
                f"the file has changed: it has {digest}, the manifest says {record.sha256[name]}",
                "restore the file, or, if the change is meant, give the new hash here",
            )
