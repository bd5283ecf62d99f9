"""kouros.toml -> typed, frozen settings.  Unknown keys are errors; secrets come from the environment only."""

import os
import re
import tomllib
from pathlib import Path
from typing import Literal

from pydantic import ConfigDict, Field, RootModel, ValidationError, field_validator, model_validator

from pipeline.errors import InputError
from pipeline.records import Numerics
from pipeline.resources import small_text
from pipeline.settings.operations import OPERATIONS, Hooks, Limits, Logs, Retention
from pipeline.settings.operations import Part as _Part

DATABASE_VARIABLE = "KOUROS_DATABASE"
"""Environment variable that names the database, with its password, in place of the file's."""


KEPT = ".kouros-kept"
"""Folder beside the settings in which processed motions, charts and measurements are kept between nights."""

_SECRETIVE = re.compile(r"hooks(\..*)?|inventory\.database|collection\.source")
"""Keys whose values are not repeated in messages: what stands in the wrong place may be a secret."""


_PASSWORD = re.compile(r"://[^:/@\s]*:([^@\s]+)@")
_VARIABLE = re.compile(r"\$\{[A-Za-z_][A-Za-z0-9_]*\}")


class SettingsError(InputError):
    """Settings that cannot be used: the message names file, key and remedy."""


def _without_password(where: str) -> str:
    """Refuse an address that holds a password itself and not the name of a variable."""
    password = _PASSWORD.search(where)
    if password and not _VARIABLE.fullmatch(password[1]):
        raise InputError(
            "a password stands in this file, where others can read it; put it into an environment variable "
            f"and write ${{NAME}} in its place, or put the whole address into {DATABASE_VARIABLE}"
        )
    return where


class Museum(_Part):
    """Whose collection it is."""

    name: str = Field(default="", description="shown on every page")


class Inventory(_Part):
    """Where Kouros keeps its own tables."""

    database: str = Field(default="kouros.sqlite", description="a file, or postgresql://host/name without a password")

    _open = field_validator("database")(_without_password)


class Collection(_Part):
    """The museum's own records, read again before every run; empty: the inventory as it is."""

    source: str = Field(default="", description="the file to import, or a database's address with ${NAME} for secrets")
    mapping: str = Field(default="kouros", description="a preset, or the file of a mapping")
    shrink_limit: float = Field(default=0.2, ge=0.0, le=1.0, description="share of objects that may vanish at once")
    rules: str = Field(default="", description="a CSV file of your own rules of classification, read before Kouros's")

    _open = field_validator("source")(_without_password)


class SiteFolder(_Part):
    """The site's motions."""

    folder: str = Field(default="site_motions/site", description="folder with manifest.toml, or 'demo'")


class Floors(RootModel[dict[str, tuple[str, ...]]]):
    """Which galleries stand on which floor of the site's manifest; the others stand on the ground.

    "*" among a floor's galleries stands for all that no floor names.
    """

    model_config = ConfigDict(frozen=True)

    @model_validator(mode="after")
    def _consistent(self) -> "Floors":
        named = [gallery for galleries in self.root.values() for gallery in galleries]
        twice = sorted({gallery for gallery in named if named.count(gallery) > 1})
        if twice:
            raise InputError(f"gallery {twice[0]!r} is on two floors; keep one")
        return self

    def of(self, gallery: str) -> str | None:
        """Return the floor of a gallery, or None for the ground."""
        floors = {name: floor for floor, galleries in self.root.items() for name in galleries}
        return floors.get(gallery, floors.get("*"))


class Analysis(_Part):
    """How finely to look."""

    fidelity: Literal["auto", "chart", "history", "reference"] = "auto"
    azimuth_step: float = Field(default=10.0, gt=0.0, le=90.0, description="degrees between directions (RotD100)")
    fragility: bool | Literal["auto"] = Field(
        default="auto", description="from what shaking each object on display fails; auto: unless that takes minutes"
    )
    workers: int = Field(default=0, ge=0, le=256, description="threads; 0: as many as there are cores")

    @property
    def numerics(self) -> Numerics:
        """How finely demands are found."""
        return Numerics(self.fidelity, self.azimuth_step)


class Display(_Part):
    """What of the collection is assessed."""

    stores: bool = Field(default=False, description="assess what is not on display too, with totals of its own")


class Execution(_Part):
    """Where the work is done."""

    processes: int = Field(default=0, ge=0, le=1024, description="of this machine; 0: as many as there are cores")
    cluster: str = Field(
        default="", pattern=r"^$|^(tcp|tls|ucx|ws|wss)://[^\s@]+$", description="address of a Dask scheduler"
    )


class Mitigation(_Part):
    """What the museum can do about what fails."""

    measures: str = Field(default="", description="a CSV file whose rows replace Kouros's measures of the same name")
    catalogue: str = Field(
        default="", description="a CSV file of your own isolators, in place of Kouros's generic ones"
    )


class Charts(_Part):
    """How long response charts are kept, and how much room they may take."""

    unused_days: float = Field(default=30.0, ge=1.0, le=3650.0, description="after the last use of their motion")
    megabytes: float = Field(default=200.0, ge=0.0, le=1e6, description="of all of them; the oldest are removed first")


class Report(_Part):
    """How the report is written."""

    folder: str = Field(default="reports", description="one folder a run, and 'latest'")
    length: Literal["cm", "mm", "m", "in", "ft"] = "cm"
    survey: bool | Literal["auto"] = Field(
        default="auto", description="find out what is worth measuring; auto: unless that takes minutes"
    )
    language: str = Field(default="en", pattern=r"^[A-Za-z]{2,3}([-_][A-Za-z0-9]{2,8})*$", description="of the pages")
    catalogues: str = Field(default="", description="folder of translations: <language>/LC_MESSAGES/kouros.mo")


class Settings(_Part):
    """All settings of one museum, as kouros.toml gives them; paths are relative to that file."""

    museum: Museum = Museum()
    inventory: Inventory = Inventory()
    collection: Collection = Collection()
    site: SiteFolder = SiteFolder()
    floors: Floors = Floors({})
    display: Display = Display()
    analysis: Analysis = Analysis()
    execution: Execution = Execution()
    mitigation: Mitigation = Mitigation()
    charts: Charts = Charts()
    report: Report = Report()
    hooks: Hooks = Hooks()
    logs: Logs = Logs()
    retention: Retention = Retention()
    limits: Limits = Limits()
    home: Path = Field(default=Path(), exclude=True)
    rehearsal: Path | None = Field(
        default=None, exclude=True, description="folder of a dry run, which writes there only"
    )
    demonstration: bool = Field(default=False, description="say on every page that this is a demonstration")

    def path(self, text: str) -> Path:
        """Return a path of the file, relative to the file's own folder."""
        return self.home / Path(text).expanduser()

    @property
    def kept(self) -> Path:
        """The folder in which processed motions, charts and measurements are kept between nights."""
        return (self.rehearsal or self.home) / KEPT

    @property
    def database(self) -> str:
        """Where the database is: the environment's word first, else a URL or a file."""
        where = os.environ.get(DATABASE_VARIABLE) or self.inventory.database
        return where if "://" in where else str(self.path(where))


def load_settings(file: str | Path) -> Settings:
    """Read kouros.toml.

    raises : SettingsError naming the file, the key and the remedy
    """
    where = Path(file)
    try:
        data = tomllib.loads(small_text(where))
    except FileNotFoundError as problem:
        raise SettingsError(
            f"{where}: there is no such file; make one with `kouros init`, or name it by --config"
        ) from problem
    except (OSError, UnicodeDecodeError) as problem:
        raise SettingsError(
            f"{where}: cannot be read ({problem}); check its permissions, its size, and that it is UTF-8"
        ) from problem
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        raise SettingsError(f"{where}: is not valid TOML ({problem}); mend that line") from problem
    for key in ("home", "rehearsal"):
        if key in data:
            raise SettingsError(f"{where}: key {key!r} is not a setting; remove it")
    try:
        return Settings(**data, home=where.resolve().parent)
    except ValidationError as problem:
        first = problem.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        shown = "" if _SECRETIVE.fullmatch(key) else f" (is {first.get('input')!r})"
        # Not chained: pydantic would repeat the input.
        raise SettingsError(f"{where}: {key}: {first['msg']}{shown}; see `kouros init`") from None


TEMPLATE = """\
# Settings of Kouros.  Paths are relative to this file.  Passwords never stand here: put the whole database address
# into the environment variable KOUROS_DATABASE.

[museum]
name = {museum}

[inventory]
# A file, or an address such as "postgresql://server/kouros".
database = "kouros.sqlite"

[collection]
# The museum's own export, read again before every run.  Leave it empty to use what was imported last.
source = {source}
# A preset (carnegie, kouros) or the file of your own mapping.
mapping = {mapping}
# A CSV file of your own rules of classification, with the columns of Kouros's table; they are read before it.
rules = ""
# A night that finds this share of objects fewer than the last one publishes nothing.
shrink_limit = 0.2

[site]
# The folder with manifest.toml and the records of your site; "demo" is the bundled record.
folder = {site}

[floors]
# Which galleries stand on which floor of the site's manifest; the others stand on the ground.  "*": all the others.
# "2" = ["Hall of Sculpture", "Gallery 12"]

[display]
# What is on display is assessed.  What is not, because the museum's records say so, is counted and named; true assesses
# it too, with totals of its own.  There is no model of the shelves and cabinets that it stands on.
stores = false

[analysis]
# "auto" climbs from bounds over charts to histories only as far as each verdict needs, with the verdicts of "history",
# which integrates everything; "reference" does so eight times finer, and "chart" looks up whatever is on a chart.
fidelity = "auto"
# Degrees between the directions tried for an object whose orientation is not recorded.
azimuth_step = 10.0
# From what shaking each object on display fails: true, false, or "auto", which leaves it out of a collection where it
# would take minutes; the report says so then.
fragility = "auto"
# Threads; 0 means as many as there are cores.
workers = 0

[execution]
# Processes of this machine that share a large night; 0 means as many as there are cores.
processes = 0
# The address of a Dask cluster that works instead, such as "tcp://scheduler:8786"; its workers have Kouros installed.
cluster = ""

[mitigation]
# A CSV file with columns of Kouros's measures.csv: rows of the same name replace Kouros's words, order and limits.
measures = ""
# A CSV file with the columns of Kouros's isolators.csv: the isolators that you have or can buy.
catalogue = ""

[charts]
# Response charts are kept until their motion was unused for so many days, and in this much room; single histories
# until they were unused for so many days, and in as much room again.
unused_days = 30
megabytes = 200

[report]
folder = "reports"
# cm, mm, m, in or ft
length = "cm"
# Each night also finds out which missing measurements would settle a verdict, and prints what that costs: true, false,
# or "auto", which leaves it out of a collection where it would take minutes.
survey = "auto"
# The language of the pages; other than English, it needs <language>/LC_MESSAGES/kouros.mo in the folder of catalogues.
language = "en"
catalogues = ""
"""


def template(*, museum: str, source: str, mapping: str, site: str) -> str:
    """Return a commented kouros.toml."""
    quoted = {key: _quoted(value) for key, value in {"museum": museum, "source": source, "mapping": mapping}.items()}
    return TEMPLATE.format(site=_quoted(site), **quoted) + OPERATIONS


def _quoted(text: str) -> str:
    import json

    # A JSON string is a TOML basic string.
    return json.dumps(text, ensure_ascii=False)
