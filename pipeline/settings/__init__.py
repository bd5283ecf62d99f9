"""kouros.toml -> typed, frozen settings.  Unknown keys are errors; secrets come from the environment only."""

import os
import re
import tomllib
from datetime import date
from difflib import get_close_matches
from pathlib import Path
from typing import Literal
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError, available_timezones

from pydantic import ConfigDict, Field, RootModel, ValidationError, field_validator, model_validator

from pipeline.analysis.house.rule import HouseRule
from pipeline.errors import InputError, mends_toml
from pipeline.records import Numerics, Sampling
from pipeline.resources import small_text
from pipeline.settings.operations import (
    Hooks,
    ImageSettings,
    LimitSettings,
    Logs,
    Retention,
    ServeSettings,
    SurveySettings,
)
from pipeline.settings.operations import SettingsPart as _Part

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


class MuseumSettings(_Part):
    """Whose collection it is."""

    name: str = Field(default="", description="shown on every page")
    time_zone: str = Field(
        default="UTC",
        description="in which the landing page tells times, by its name in the IANA database, such as "
        '"America/Los_Angeles" or "Europe/Athens"',
    )
    value_per_c: float = Field(
        default=0.0,
        ge=0.0,
        le=1e12,
        allow_inf_nan=False,
        description="what an object of its class of value C is worth in its own money, where values are recorded; 0: "
        "as Kouros's stakes.csv takes it",
    )

    @field_validator("time_zone")
    @classmethod
    def _known_zone(cls, name: str) -> str:
        try:
            ZoneInfo(name)
        except (ZoneInfoNotFoundError, ValueError, OSError):
            close = get_close_matches(name[:64], available_timezones(), 3, 0.5)
            hint = f"; close to it: {', '.join(close)}" if close else ""
            raise InputError(f'there is no time zone {name!a}; name one such as "Europe/Rome"{hint}') from None
        return name


class Inventory(_Part):
    """Where Kouros keeps its own tables."""

    database: str = Field(
        default="kouros.sqlite",
        description='a file, or an address without a password, such as "postgresql://server/kouros"',
    )

    _open = field_validator("database")(_without_password)


class Collection(_Part):
    """The museum's own records, read again before every run."""

    source: str = Field(
        default="",
        description="the museum's export, or the address of its database with ${NAME} for secrets; empty: what was "
        "imported last",
    )
    mapping: str = Field(default="kouros", description="a preset (carnegie, kouros), or the file of your own mapping")
    shrink_limit: float = Field(
        default=0.2,
        ge=0.0,
        le=1.0,
        description="a night that finds fewer objects than the last one, by more than this share, publishes nothing",
    )
    rules: str = Field(
        default="",
        description="a CSV file of your own rules of classification, with the columns of Kouros's table; they are read "
        "before it",
    )

    _open = field_validator("source")(_without_password)


class SiteFolder(_Part):
    """The site's motions."""

    folder: str = Field(
        default="site_motions/site",
        description="the folder with manifest.toml and the records of your site; bundled are 'demo', one record, and "
        "'demo_suite', eleven motions of one level",
    )


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

    fidelity: Literal["auto", "chart", "history", "reference"] = Field(
        default="auto",
        description='"auto" climbs from bounds over charts to histories only as far as each verdict needs, with the '
        'verdicts of "history", which integrates everything; "reference" does so eight times finer, and "chart" looks '
        "up whatever is on a chart",
    )
    azimuth_step: float = Field(
        default=10.0,
        gt=0.0,
        le=90.0,
        description="degrees between the directions tried for an object whose orientation is not recorded (RotD100)",
    )
    fragility: bool | Literal["auto"] = Field(
        default="auto",
        description='from what shaking each object on display fails: true, false, or "auto", which leaves it out of a '
        "collection where it would take minutes; the report says so then",
    )
    workers: int = Field(default=0, ge=0, le=256, description="threads; 0 means as many as there are cores")

    @property
    def numerics(self) -> Numerics:
        """How finely demands are found."""
        return Numerics(self.fidelity, self.azimuth_step)


class LikelihoodSettings(_Part):
    """How likely each object comes to harm: everything that is uncertain about it is drawn together, again and again.

    The words for a probability begin at the values given here.
    """

    samples: int = Field(
        default=512,
        ge=0,
        le=8192,
        description="joint samples at most, a power of two from 64 on; 0: no probabilities are found",
    )
    band_certainty: float = Field(
        default=0.9,
        ge=0.5,
        lt=1.0,
        description="probability that the word for a probability is the right one, from which on no more are drawn",
    )
    almost_certain: float = Field(default=0.9, gt=0.0, lt=1.0, description="almost certain from here on")
    likely: float = Field(default=0.5, gt=0.0, lt=1.0, description="likely from here on")
    possible: float = Field(default=0.1, gt=0.0, lt=1.0, description="possible from here on")
    unlikely: float = Field(default=0.01, gt=0.0, lt=1.0, description="unlikely from here on, and very unlikely below")

    @field_validator("samples")
    @classmethod
    def _power_of_two(cls, value: int) -> int:
        if value and (value < 64 or value & (value - 1)):
            raise InputError(f"{value} samples are not balanced: write 0, or a power of two such as 64, 256, 512, 1024")
        return value

    @model_validator(mode="after")
    def _falling(self) -> "LikelihoodSettings":
        if not self.almost_certain > self.likely > self.possible > self.unlikely:
            raise InputError("the words do not follow each other: almost_certain > likely > possible > unlikely")
        return self

    @property
    def sampling(self) -> Sampling:
        """How probabilities are found."""
        edges = (self.almost_certain, self.likely, self.possible, self.unlikely)
        return Sampling(self.samples, self.band_certainty, edges)


class DisplaySettings(_Part):
    """What of the collection is assessed: what is on display.

    What is not, because the museum's records say so, is counted and named.
    """

    stores: bool = Field(
        default=False,
        description="assess what is not on display too, with totals of its own; there is no model of the shelves and "
        "cabinets that it stands on",
    )


class Execution(_Part):
    """Where the work is done."""

    processes: int = Field(
        default=0,
        ge=0,
        le=1024,
        description="processes of this machine that share a large night; 0 means as many as there are cores",
    )
    cluster: str = Field(
        default="",
        pattern=r"^$|^(tcp|tls|ucx|ws|wss)://[^\s@]+$",
        description='the address of a Dask cluster that works instead, such as "tcp://scheduler:8786"; its workers '
        "have Kouros installed, and here `pip install 'kouros[cluster]'` brings Dask",
    )


class Mitigation(_Part):
    """What the museum can do about what fails."""

    measures: str = Field(
        default="",
        description="a CSV file with columns of Kouros's measures.csv: rows of the same name replace Kouros's words, "
        "order and limits; a row of another name says in a column 'like' of which measure it is a kind",
    )
    catalogue: str = Field(
        default="",
        description="a CSV file with the columns of Kouros's isolators.csv: the isolators that you have or can buy, in "
        "place of Kouros's generic ones",
    )


class PlanSettings(_Part):
    """What there is for mounts and other measures until the next look at the plan; the report chooses within it."""

    hours: float = Field(default=0.0, ge=0.0, le=1e7, description="hours of work, of all trades together; 0: no limit")
    cost: float = Field(
        default=0.0, ge=0.0, le=1e12, description="material and outside work, in your currency; 0: no limit"
    )
    currency: str = Field(
        default="",
        max_length=8,
        pattern=r"^[^\s<>&\"']*$",
        description='in which costs are told, such as "EUR"; empty: none is named',
    )
    efforts: str = Field(
        default="",
        description="a CSV file with the columns of Kouros's efforts.csv: what a measure takes you of hours and cost, "
        "and whose work it is; a row takes the place of Kouros's of the same name",
    )


class OwnTables(_Part):
    """Your own rows of what Kouros assumes where a record is silent; each takes the place of Kouros's of the same name.

    A file has the columns of Kouros's table, and the rows that you know better.
    """

    classes: str = Field(default="", description="a CSV file with the columns of Kouros's classes.csv")
    materials: str = Field(default="", description="a CSV file with the columns of Kouros's materials.csv")
    friction: str = Field(
        default="",
        description="a CSV file with the columns of Kouros's friction.csv: a row is known by its pair",
    )
    damping: str = Field(
        default="", description="a CSV file with the columns of Kouros's damping.csv: a row is known by its pair"
    )
    furniture: str = Field(default="", description="a CSV file with the columns of Kouros's furniture.csv")


class Charts(_Part):
    """How long response charts, histories, motions and their pictures are kept, and how much room each may take."""

    unused_days: float = Field(
        default=30.0, ge=1.0, le=3650.0, description="days after the last use of their motion, or of a history itself"
    )
    megabytes: float = Field(default=200.0, ge=0.0, le=1e6, description="room for all; the oldest are removed first")


class Report(_Part):
    """How the report is written."""

    folder: str = Field(default="reports", description='one folder a run, and "latest"')
    length: Literal["cm", "mm", "m", "in", "ft"] = Field(
        default="cm", description="the unit of lengths: cm, mm, m, in or ft"
    )
    survey: bool | Literal["auto"] = Field(
        default="auto",
        description="find out which missing measurements may change what is decided, and print what that costs: true, "
        'false, or "auto", which leaves it out of a collection where it would take minutes',
    )
    language: str = Field(
        default="en",
        pattern=r"^[A-Za-z]{2,3}([-_][A-Za-z0-9]{2,8})*$",
        description="the language of the pages: en, el, es, it, ja, or one of which `catalogues` has a translation",
    )
    catalogues: str = Field(
        default="",
        description="a folder with translations of your own, <language>/LC_MESSAGES/kouros.mo, which go before ours",
    )
    paper: Literal["A4", "Letter"] = Field(
        default="A4", description="of the sheets to walk a gallery with (PDF): A4 or Letter"
    )


class Settings(_Part):
    """All settings of one museum, as kouros.toml gives them; paths are relative to that file."""

    museum: MuseumSettings = MuseumSettings()
    inventory: Inventory = Inventory()
    collection: Collection = Collection()
    site: SiteFolder = SiteFolder()
    floors: Floors = Field(default=Floors({}), examples=[{"2": ["Hall of Sculpture", "Gallery 12"]}])
    house: tuple[HouseRule, ...] = Field(
        default=(),
        max_length=500,
        description="Your house rules: what is so of all objects that a rule matches, stated once. One table [[house]] "
        "a rule; a quantity is a number, or a table of low, best and high. For each quantity the most particular rule "
        "that matches is taken, and what an object's record says before any rule.",
        examples=[
            {
                "class": "framed",
                "gallery": ["Gallery 3", "Gallery 4"],
                "hanging": "two_hooks",
                "clearance_m": {"low": 0.1, "best": 0.2, "high": 0.3},
                "said_by": "A. Smith, mount-maker",
                "said_on": date(2031, 5, 1),
            }
        ],
    )
    display: DisplaySettings = DisplaySettings()
    analysis: Analysis = Analysis()
    likelihood: LikelihoodSettings = LikelihoodSettings()
    execution: Execution = Execution()
    tables: OwnTables = OwnTables()
    mitigation: Mitigation = Mitigation()
    plan: PlanSettings = PlanSettings()
    charts: Charts = Charts()
    report: Report = Report()
    images: ImageSettings = ImageSettings()
    survey: SurveySettings = SurveySettings()
    hooks: Hooks = Hooks()
    logs: Logs = Logs()
    retention: Retention = Retention()
    limits: LimitSettings = LimitSettings()
    serve: ServeSettings = ServeSettings()
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
        """The folder of the cache, in which motions, charts, histories and measurements are kept between nights."""
        return (self.rehearsal or self.home) / KEPT

    @property
    def database(self) -> str:
        """Where the database is: the environment's word first, else a URL or a file."""
        where = os.environ.get(DATABASE_VARIABLE) or self.inventory.database
        return where if "://" in where else str(self.path(where))


def load_settings(file: str | Path) -> Settings:
    """Read kouros.toml.

    Parameters
    ----------
    file : str or Path
        Its folder becomes the home of relative paths.

    Returns
    -------
    Settings
        Checked; defaults where the file is silent.

    Raises
    ------
    SettingsError
        Naming the file, the key and the remedy.
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
        raise SettingsError(f"{where}: is not valid TOML ({problem}); {mends_toml(problem)}") from problem
    for key in ("home", "rehearsal"):
        if key in data:
            raise SettingsError(f"{where}: key {key!r} is not a setting; remove it")
    try:
        return Settings(**data, home=where.resolve().parent)
    except ValidationError as problem:
        first = problem.errors()[0]
        key = _key_of(first["loc"])
        shown = "" if _SECRETIVE.fullmatch(key) else f" (is {first.get('input')!r})"
        # Not chained: pydantic would repeat the input.
        raise SettingsError(f"{where}: {key}: {first['msg']}{shown}; see `kouros init`") from None


def _key_of(where: tuple[int | str, ...]) -> str:
    """Return the name of a key in messages; house rules are counted from 1, as people count."""
    parts = [str(part) for part in where]
    if len(where) > 1 and where[0] == "house" and isinstance(where[1], int):
        parts[:2] = [f"[[house]] {where[1] + 1}"]
    return ".".join(parts)


_HEAD = (
    "Settings of Kouros.  Paths are relative to this file.  Passwords never stand here: put the whole database address "
    f"into the environment variable {DATABASE_VARIABLE}."
)


def template(*, museum: str, source: str, mapping: str, site: str) -> str:
    """Return a commented kouros.toml: every setting with its default.

    Parameters
    ----------
    museum, source, mapping, site : str
        The values of [museum] name, [collection] source and mapping, and [site] folder.
    """
    from pipeline.settings.commented import commented

    given = {
        ("museum", "name"): museum,
        ("collection", "source"): source,
        ("collection", "mapping"): mapping,
        ("site", "folder"): site,
    }
    return commented(Settings, given, _HEAD)
