"""The manifest of a site: which records, what they are, who answers for them (contract "A site")."""

from __future__ import annotations

import hashlib
import json
import tomllib
from datetime import date
from itertools import pairwise
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError, model_validator

from pipeline.errors import InputError, mends_toml
from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.record import (
    PRINTABLE,
    BaselineTable,
    EventTable,
    FileName,
    Horizontal,
    Record,
    StationTable,
    Table,
    Text,
)
from pipeline.resources import small_text

MANIFEST = "manifest.toml"

MOST = 1000
"""Files of a site's folder that are listed at most."""

NO_RECORDS = frozenset({".md", ".toml", ".html", ".pdf", ".jpg", ".png", ".db", ".ini", ".lnk"})
"""Endings of what lies beside records and is none."""

GROUND_FLOOR = "ground"
"""What the floor is called on which a gallery stands that is assigned to no other."""


class TargetTable(Table):
    """A target response spectrum: PSA in g at periods in s, read on straight lines in log-log.

    Attributes
    ----------
    period_range_s
        Compared from here to there; left out, the whole target.
    component
        Of the motion's spectrum that is brought to the target.
    measure
        "log" fits the ratio, "linear" the difference, by least squares.
    """

    periods_s: tuple[Annotated[float, Field(gt=0.0)], ...] = Field(min_length=2)
    psa_g: tuple[Annotated[float, Field(gt=0.0)], ...] = Field(min_length=2)
    damping: float = Field(default=0.05, ge=0.0, lt=1.0)
    period_range_s: tuple[Annotated[float, Field(gt=0.0)], Annotated[float, Field(gt=0.0)]] | None = None
    component: Literal["x", "y", "rotd50", "rotd100"] = "rotd100"
    measure: Literal["log", "linear"] = "log"
    source: Text | None = None

    @property
    def compared(self) -> tuple[float, float]:
        """The periods in s between which spectra are compared."""
        return self.period_range_s or (self.periods_s[0], self.periods_s[-1])

    @model_validator(mode="after")
    def _consistent(self) -> TargetTable:
        if len(self.periods_s) != len(self.psa_g):
            raise InputError(f"{len(self.periods_s)} periods_s and {len(self.psa_g)} psa_g; give one value a period")
        if any(b <= a for a, b in pairwise(self.periods_s)):
            raise InputError("periods_s must increase")
        low, high = self.compared
        if not (self.periods_s[0] <= low < high <= self.periods_s[-1]):
            raise InputError(f"period_range_s [{low:g}, {high:g}] must increase and lie inside periods_s")
        return self


LEAST_FOR_MEAN = 7
"""Records from which building codes let the mean decide (ASCE/SEI 7-10, 16.1.4); `Level.caution` says so below it."""


class LevelTable(Table):
    """A level of shaking: its records, how several are combined, and the engineer who answers for it.

    Attributes
    ----------
    combine
        "max" (the worst record decides) or "mean" (an object overturns when half the records overturn it), which codes
        allow for seven records and more.
    target : TargetTable or None
        The spectrum that records with `scale_to_target` are brought to.
    approved_by, approved_on
        Both or neither; reports say so when nobody answers.
    """

    name: Text
    return_period_years: float | None = Field(default=None, gt=0.0)
    combine: Literal["max", "mean"]
    target: TargetTable | None = None
    approved_by: Annotated[str, StringConstraints(max_length=500, pattern=PRINTABLE)] = ""
    approved_on: date | None = None
    record: tuple[Record, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _consistent(self) -> LevelTable:
        if bool(self.approved_by) != (self.approved_on is not None):
            raise InputError("approved_by and approved_on belong together; give both, or leave both out")
        without = [record.name for record in self.record if record.scale_to_target]
        if without and self.target is None:
            raise InputError(f"record {without[0]!r} has scale_to_target, but the level has no target; add its table")
        return self


class FloorRecord(Record):
    """A record made on the floor itself, and the level of shaking that it belongs to (all levels where left out)."""

    level: Text | None = None


_MODAL = ("damping", "stiffness_ratio", "modes")


class FloorTable(Table):
    """A floor above the ground, by one of three methods.

    record : made on that floor; one, or several that name their levels
    method "factor" : the ground's horizontals times the factor of ASCE/SEI 7-22, 13.3.1.1, from height_ratio (0 base to
        1 roof) and, where it is known, the building's period_s
    method "modal"  : modes of a shear-flexural beam (Miranda and Taghavi 2005) from height_ratio, period_s, damping (a
        ratio), stiffness_ratio (alpha0: 0 bends as a shear wall, 20 and more shears as a frame) and number of modes
    """

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["height_ratio"], "not": {"required": ["record"]}},
                {
                    "required": ["record"],
                    "not": {"anyOf": [{"required": [key]} for key in ("height_ratio", "period_s", "method", *_MODAL)]},
                },
            ],
            "if": {"properties": {"method": {"const": "modal"}}, "required": ["method"]},
            "then": {"required": ["period_s", *_MODAL]},
            "else": {"not": {"anyOf": [{"required": [key]} for key in _MODAL]}},
        }
    )

    name: Text
    height_ratio: float | None = Field(default=None, ge=0.0, le=1.0)
    period_s: float | None = Field(default=None, gt=0.0)
    method: Literal["factor", "modal"] | None = None
    damping: float | None = Field(default=None, gt=0.0, lt=1.0)
    stiffness_ratio: float | None = Field(default=None, ge=0.0, le=650.0)
    modes: int | None = Field(default=None, ge=1, le=30)
    record: FloorRecord | Annotated[tuple[FloorRecord, ...], Field(min_length=1)] | None = None

    @property
    def records(self) -> tuple[FloorRecord, ...]:
        """The records made on this floor; none where it is computed."""
        if self.record is None:
            return ()
        return self.record if isinstance(self.record, tuple) else (self.record,)

    @model_validator(mode="after")
    def _consistent(self) -> FloorTable:
        if self.name == GROUND_FLOOR:
            raise InputError(f"the name {GROUND_FLOOR!r} is the ground's own; call the floor otherwise")
        computed = [key for key in ("height_ratio", "period_s", "method", *_MODAL) if getattr(self, key) is not None]
        if self.records:
            if computed:
                raise InputError(f"record and {', '.join(computed)} exclude each other; keep one of them")
            return self
        if self.height_ratio is None:
            raise InputError("give height_ratio (with period_s where the building's period is known), or record alone")
        modal = [key for key in ("period_s", *_MODAL) if getattr(self, key) is None]
        if self.method == "modal" and modal:
            raise InputError(f"the method modal needs {', '.join(modal)}")
        extra = [key for key in _MODAL if getattr(self, key) is not None]
        if self.method != "modal" and extra:
            raise InputError(f'{", ".join(extra)}: only of method = "modal"; name it, or drop them')
        return self


class SiteTable(Table):
    """Where the site is: degrees north and east, and the shear-wave velocity of the upper 30 m in m/s where known.

    Attributes
    ----------
    x_azimuth : float
        Degrees clockwise from north of the x axis that motions are turned to; east where left out, else an axis of the
        building.
    hazard : FileName or None
        CSV file beside the manifest with the hazard curve of the ground, see `hazard_file`; it takes the place of the
        curve through the levels' return periods.
    """

    name: Text
    latitude: float = Field(ge=-90.0, le=90.0)
    longitude: float = Field(ge=-180.0, le=180.0)
    vs30: float | None = Field(default=None, gt=0.0)
    x_azimuth: float = Field(default=90.0, ge=0.0, lt=360.0)
    hazard: FileName | None = None


class Manifest(Table):
    """A site's manifest.toml; one without a level is a beginning, which names no records yet."""

    site: SiteTable
    level: tuple[LevelTable, ...] = ()
    floor: tuple[FloorTable, ...] = ()

    def records(self) -> list[tuple[str, Record]]:
        """Return every record with its key path, those of the floors included."""
        found: list[tuple[str, Record]] = [
            (f"level[{i}].record[{j}]", record)
            for i, level in enumerate(self.level)
            for j, record in enumerate(level.record)
        ]
        for i, floor in enumerate(self.floor):
            several = isinstance(floor.record, tuple)
            found += [(f"floor[{i}].record{f'[{j}]' if several else ''}", r) for j, r in enumerate(floor.records)]
        return found

    @model_validator(mode="after")
    def _consistent(self) -> Manifest:
        for key, names in (
            ("level", [level.name for level in self.level]),
            ("record", [record.name for _, record in self.records()]),
            ("floor", [floor.name for floor in self.floor]),
        ):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise InputError(f"two {key}s are called {twice[0]!r}; give each {key} its own name")
        levels = [level.name for level in self.level]
        for floor in self.floor:
            named = [r.level for r in floor.records]
            for level in named:
                if level is not None and level not in levels:
                    raise InputError(f"floor {floor.name!r}: there is no level {level!r}; use {', '.join(levels)}")
            for level in levels:
                if floor.records and level not in named and None not in named:
                    raise InputError(f"floor {floor.name!r} has no record for level {level!r}; add one")
            if any(r.scale_to_target for r in floor.records):
                raise InputError(f"floor {floor.name!r}: scale_to_target is for records of the ground; use scale")
        return self


_TABLES: dict[str, type[BaseModel]] = {
    "": Manifest,
    "site": SiteTable,
    "level": LevelTable,
    "record": Record,
    "floor": FloorTable,
    "components": Horizontal,
    "baseline": BaselineTable,
    "target": TargetTable,
    "event": EventTable,
    "station": StationTable,
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

    Parameters
    ----------
    path : str or Path
        The site's folder, or its manifest.toml.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    MotionError
        If there is none.
    """
    path = Path(path)
    file = path / MANIFEST if path.is_dir() else path
    if not file.is_file():
        remedy = f"give a site's folder that holds a {MANIFEST}, or that file itself"
        raise refusal(file, "manifest", "there is no such file", remedy)
    return file


def load_manifest(folder: str | Path, *, begun: bool = False) -> Manifest:
    """Read and check a site's manifest, with the presence and the hash of every file that it names.

    Parameters
    ----------
    folder : str or Path
        The site's folder, or its manifest.toml.
    begun : bool
        Whether a manifest that names no records yet will do.

    Returns
    -------
    Manifest
        What it says.

    Raises
    ------
    MotionError
        Naming the manifest, the key path and the remedy.
    """
    file = manifest_file(folder)
    try:
        data = tomllib.loads(small_text(file))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise refusal(file, "TOML", str(error), f"{mends_toml(error)}; the file is TOML in UTF-8") from error
    except OSError as error:
        why = f"cannot be read: {error.strerror or error}"
        raise refusal(file, "file", why, "check its permissions and its size") from error
    try:
        # Through JSON, so that the strict rules of the model are those of the JSON Schema.
        manifest = Manifest.model_validate_json(json.dumps(data, default=_as_json))
    except ValidationError as error:
        raise _explained(file, error) from error
    for key, record in manifest.records():
        _check_files(file, key, record)
    if not (manifest.level or begun):
        there = unlisted(file, manifest)
        found = f"; beside it {'lies' if len(there) == 1 else 'lie'} {', '.join(there[:5])}" if there else ""
        more = f" and {len(there) - 5} more" if len(there) > 5 else ""
        whole = sorted(one.parent.name for one in file.parent.glob("*/manifest.toml"))
        remedy = (
            f"{whole[0]!r} in it is a site of its own: name that folder in its place, or move its files up"
            if whole
            else "add a record's files with `kouros motions add`"
        )
        raise refusal(file, "level", f"it names no records yet{found}{more}", remedy)
    return manifest


def unlisted(file: Path, manifest: Manifest) -> list[str]:
    """Return the files of a site's folder that its manifest does not name, sorted; words about it are none.

    Parameters
    ----------
    file : Path
        The manifest.
    manifest : Manifest
        What it says.

    Returns
    -------
    list of str
        Paths inside the folder, with / between folders; at most MOST.
    """
    named = {name for _, record in manifest.records() for name in record.all_files} | {manifest.site.hazard}
    folder = file.parent
    there = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink() and path != file)
    names = (path.relative_to(folder).as_posix() for path in there if path.suffix.lower() not in NO_RECORDS)
    return sorted(n for n in names if n not in named and not any(part.startswith(".") for part in n.split("/")))[:MOST]


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
    # Where a table or a list of them is allowed, the names of both stand in the place as well.
    loc = [part for part in loc if part != "FloorRecord" and not str(part).startswith("tuple[")]
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
        with path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
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
