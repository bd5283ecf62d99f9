"""A record of a site's manifest: its files, and what is to be done to them."""

from __future__ import annotations

import re
from datetime import datetime
from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    AwareDatetime,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StringConstraints,
    model_validator,
)

from pipeline.errors import InputError
from pipeline.motions.errors import Judgement

# A control character in a name could rewrite a terminal or break a table; nothing that people write needs one.
PRINTABLE = r"^[^\x00-\x1f\x7f]*$"
Text = Annotated[str, StringConstraints(min_length=1, max_length=500, pattern=PRINTABLE)]

# The same rule as _inside below, for validators of the schema; in Python the message can say what is wrong.
_INSIDE = r"^(?!/)(?![A-Za-z]:)(?!(.*/)?\.\.(/|$))[^\\\x00-\x1f\x7f]+$(?!\n)"


def _inside(name: str) -> str:
    drive = re.match(r"[A-Za-z]:", name)
    control = re.search(r"[\x00-\x1f\x7f]", name)
    if not name or name.startswith("/") or drive or control or "\\" in name or ".." in name.split("/"):
        raise InputError(
            f"{name!r} leaves the site's folder: name a file inside it, with / between folders and without '..'"
        )
    return name


FileName = Annotated[str, AfterValidator(_inside), Field(json_schema_extra={"pattern": _INSIDE, "minLength": 1})]
Digest = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
# Times of the manifest are in UTC, whether TOML's own or texts.
_TIME = r"^\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(\.\d{1,6})?(Z|\+00:00)?$(?!\n)"


def _a_time(text: str) -> str:
    if not re.fullmatch(_TIME.removesuffix(r"(?!\n)"), text):
        raise InputError(f"{text[:60]!r} is no time in UTC, such as 2019-07-06T03:19:53Z")
    try:
        datetime.fromisoformat(text)
    except ValueError as error:
        raise InputError(f"{text!r} is no time: {error}; give one in UTC, such as 2019-07-06T03:19:53Z") from error
    return text


Time = Annotated[str, AfterValidator(_a_time), Field(json_schema_extra={"pattern": _TIME})]
Unit = Literal["m/s2", "cm/s2", "mm/s2", "nm/s2", "gal", "g", "mg"]


NO_VERTICAL = "no vertical component was recorded: the motion has none"
"""The step of a record with vertical = "absent"."""

ESTIMATED = "no vertical component was recorded: the motion's is an estimate from the horizontals, and no recorded one"
"""The step of a record with vertical = "estimated"."""

_RAW_ONLY = ("response", "baseline", "pre_event_s", "highpass_hz", "lowpass_hz")
"""Keys of what is done to raw records only."""


class Table(BaseModel):
    """A table of the manifest: no key that is not known, no value that is not finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Horizontal(Table):
    """A horizontal channel and its azimuth in degrees clockwise from north; left out, the file's header says it.

    The two axes only tell the channels apart: the azimuths decide what is turned into east and north.
    silent : the channel is zero and meant to be, as in a test signal of one direction; otherwise it would be dead
    """

    axis: Literal["x", "y"]
    orientation: float | None = Field(default=None, ge=0.0, le=360.0)
    silent: bool = False


class Vertical(Table):
    """A vertical channel: positive up or positive down; left out, the file's header says it.

    Attributes
    ----------
    silent : bool
        As of `Horizontal`.
    """

    axis: Literal["z"]
    orientation: Literal["up", "down"] | None = None
    silent: bool = False


Component = Annotated[Horizontal | Vertical, Discriminator("axis")]


class BaselineTable(Table):
    """How the baseline of a raw record is corrected (see `baseline`); left out, a straight line is removed.

    Attributes
    ----------
    method
        "none"; "mean"; "pre-event" (the mean of the first `pre_event_s`); "linear"; "polynomial"; "two-segment" (Iwan
        et al. 1985, Boore 2001), which keeps a permanent displacement, so that no corner is chosen for it.
    degree, of
        Of the polynomial, and whether it is fitted to the acceleration or the velocity.
    t1_s, t2_s, fit_from_s : float or None
        Of the two segments; left out, they follow from the record.
    """

    method: Literal["none", "mean", "pre-event", "linear", "polynomial", "two-segment"]
    degree: int | None = Field(default=None, ge=0, le=6)
    of: Literal["acceleration", "velocity"] | None = None
    t1_s: float | None = Field(default=None, ge=0.0)
    t2_s: float | None = Field(default=None, gt=0.0)
    fit_from_s: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _consistent(self) -> BaselineTable:
        belongs = {"degree": "polynomial", "of": "polynomial"} | dict.fromkeys(
            ("t1_s", "t2_s", "fit_from_s"), "two-segment"
        )
        for key, method in belongs.items():
            if getattr(self, key) is not None and self.method != method:
                raise InputError(f"{key} belongs to method {method!r}, not {self.method!r}; drop it")
        if self.method == "polynomial" and self.degree is None:
            raise InputError("a polynomial baseline needs its degree, 0 to 6")
        return self


class EventTable(Table):
    """The earthquake of a record, as a catalogue or the record's own file has it.

    Attributes
    ----------
    time : AwareDatetime or None
        Of its origin, with the offset of its zone.
    latitude, longitude, depth_km : float or None
        Of its hypocentre, degrees north and east.
    magnitude_type : Text or None
        Such as "Mw".
    """

    name: Text | None = None
    id: Text | None = None
    time: AwareDatetime | None = None
    latitude: float | None = Field(default=None, ge=-90.0, le=90.0)
    longitude: float | None = Field(default=None, ge=-180.0, le=180.0)
    depth_km: float | None = Field(default=None, ge=-10.0, le=800.0)
    magnitude: float | None = Field(default=None, ge=-5.0, le=10.0)
    magnitude_type: Text | None = None


class StationTable(Table):
    """The station of a record: its code with that of its network, and where it stands, degrees north and east."""

    code: Text | None = None
    name: Text | None = None
    latitude: float | None = Field(default=None, ge=-90.0, le=90.0)
    longitude: float | None = Field(default=None, ge=-180.0, le=180.0)


class Record(Table):
    """One record of three components, or of two and no vertical, and what is to be done to it.

    Attributes
    ----------
    files : tuple of FileName
        Paths inside the site's folder; `response` is their StationXML, where they hold counts.
    components : mapping of Text to Component
        File name, channel code or full channel id -> axis and orientation; x, y and z once each.
    vertical
        "absent" where no vertical was recorded: components are x and y then, and the motion has no vertical;
        "estimated", one is made from the larger horizontal by the ratio of vertical to horizontal spectra of EN 1998-1
        (see `vertical`), or the z that is given was made so.
    units : Unit or None
        Only where the file itself does not say.
    processed : bool or None
        Whether the agency has filtered it already; such a record is never filtered again.  Left out, the files' headers
        say it.
    baseline : BaselineTable or None
        Of a raw record; pre_event_s: s of noise before the event at its start.
    highpass_hz
        Of a raw record: a corner; "auto" or left out, one is chosen from length, noise and tail (see
        `corners.choose_corner`); "none", it is not filtered.
    resample_s : float or None
        Another time step.
    scale, scale_to_pga_g, scale_to_target
        One factor for all three components; the PGA in g that the larger recorded horizontal component shall have; or
        the factor that fits the level's target spectrum best.  None of them leaves the record as it was recorded.
    v_max_cm_s : float or None
        The velocity for the overturning criterion, after scaling, where it is not to be the PGV.
    window_s
        Start and end in s from the first common sample, or from origin_time.  It goes first: what lies more than 300 s
        outside of it is not read, and only filters see what lies nearer.
    origin_time : Time or None
        Of the earthquake, in UTC, where the files hold more than one: from it window_s is counted; without window_s it
        is that of the earthquake found there.
    start_m_s : (float, float, float) or None
        Of a processed record, the velocity in m/s that x, y and z begin with, which the samples do not tell.
    event, station, distance_km
        The earthquake, the station, and how far from each other they are: PGA and PGV are held against what these let
        expect, and nothing else is computed of them.  The distance is the epicentral one, or as the record's source
        gives it.
    accept : mapping of Judgement to Text
        Refusals that a person has judged and overruled, each with the reason.
    sha256 : mapping of FileName to Digest
        Of every file named, the response included.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "allOf": [
                {"not": {"required": ["scale", "scale_to_pga_g"]}},
                {"not": {"required": ["scale", "scale_to_target"]}},
                {"not": {"required": ["scale_to_pga_g", "scale_to_target"]}},
                {"not": {"required": ["units", "response"]}},
                {
                    "if": {"properties": {"vertical": {"const": "absent"}}, "required": ["vertical"]},
                    "then": {"properties": {"components": {"maxProperties": 2}}},
                },
                {
                    "if": {"not": {"required": ["vertical"]}},
                    "then": {"properties": {"components": {"minProperties": 3}}},
                },
                {
                    "if": {"not": {"required": ["origin_time"]}},
                    "then": {"properties": {"window_s": {"prefixItems": [{"minimum": 0}]}}},
                },
                {
                    "if": {"required": ["start_m_s"]},
                    "then": {"properties": {"processed": {"const": True}}, "required": ["processed"]},
                },
                {
                    "if": {"properties": {"processed": {"const": True}}, "required": ["processed"]},
                    "then": {"not": {"anyOf": [{"required": [key]} for key in _RAW_ONLY]}},
                },
            ]
        }
    )

    name: Text
    files: tuple[FileName, ...] = Field(min_length=1)
    response: FileName | None = None
    components: dict[Text, Component] = Field(min_length=2, max_length=3)
    vertical: Literal["absent", "estimated"] | None = None
    units: Unit | None = None
    processed: bool | None = None
    scale: float | None = Field(default=None, gt=0.0)
    scale_to_pga_g: float | None = Field(default=None, gt=0.0, le=20.0)
    scale_to_target: Literal[True] | None = None
    baseline: BaselineTable | None = None
    pre_event_s: float | None = Field(default=None, gt=0.0)
    highpass_hz: Annotated[float, Field(gt=0.0)] | Literal["auto", "none"] | None = None
    lowpass_hz: float | None = Field(default=None, gt=0.0)
    resample_s: float | None = Field(default=None, gt=0.0)
    window_s: tuple[float, Annotated[float, Field(gt=0.0)]] | None = None
    origin_time: Time | None = None
    start_m_s: tuple[float, float, float] | None = None
    v_max_cm_s: float | None = Field(default=None, gt=0.0)
    accept: dict[Judgement, Text] = Field(default_factory=dict)
    event: EventTable | None = None
    station: StationTable | None = None
    distance_km: float | None = Field(default=None, ge=0.0, le=20_040.0)
    source: Text
    licence: Text
    sha256: dict[FileName, Digest]

    @property
    def all_files(self) -> tuple[str, ...]:
        """Every file that the record is made of, the response included."""
        return self.files if self.response is None else (*self.files, self.response)

    def inside(self, folder: str) -> Record:
        """Return the record with its files in a folder below."""
        files = set(self.all_files)
        return self.model_copy(
            update={
                "files": tuple(f"{folder}/{name}" for name in self.files),
                "response": self.response and f"{folder}/{self.response}",
                "components": {f"{folder}/{key}" if key in files else key: one for key, one in self.components.items()},
                "sha256": {f"{folder}/{name}": digest for name, digest in self.sha256.items()},
            }
        )

    @property
    def corner_hz(self) -> float | None:
        """The high-pass corner that the manifest gives as a number, else None."""
        return self.highpass_hz if isinstance(self.highpass_hz, float) else None

    @property
    def raw_only(self) -> tuple[str, ...]:
        """The keys given here that a processed record must not have."""
        return tuple(key for key in _RAW_ONLY if getattr(self, key) is not None)

    @model_validator(mode="after")
    def _consistent(self) -> Record:
        if len(set(self.all_files)) < len(self.all_files):
            raise InputError("files: a file is named twice; name each file once")
        axes = sorted(c.axis for c in self.components.values())
        three, two = ["x", "y", "z"], ["x", "y"]
        if axes not in {None: [three], "absent": [two], "estimated": [two, three]}[self.vertical]:
            remedy = "give each of x, y and z exactly once"
            if self.vertical == "absent":
                remedy = 'with vertical = "absent" they are x and y; drop that key, or the vertical component'
            elif axes == two:
                remedy += ', or say vertical = "absent" where no vertical was recorded ("estimated": make one)'
            raise InputError(f"components: the axes are {', '.join(axes)}; {remedy}")
        given = [key for key in ("scale", "scale_to_pga_g", "scale_to_target") if getattr(self, key) is not None]
        if len(given) > 1:
            raise InputError(f"{' and '.join(given)} exclude each other; keep one")
        if self.units is not None and self.response is not None:
            raise InputError("units and response exclude each other: the response turns counts into m/s2; drop one")
        if self.processed and self.raw_only:
            raise InputError(
                f"{', '.join(self.raw_only)}: a processed record is never processed again; drop it, or give raw files"
            )
        if self.corner_hz is not None and self.lowpass_hz is not None and self.corner_hz >= self.lowpass_hz:
            raise InputError(f"highpass_hz {self.corner_hz:g} must be below lowpass_hz {self.lowpass_hz:g}")
        if self.window_s is not None and self.window_s[0] < 0.0 and self.origin_time is None:
            raise InputError(
                f"window_s {list(self.window_s)} begins before the record; only from an origin_time it may"
            )
        if self.processed is not True and self.start_m_s is not None:
            raise InputError("start_m_s is for a record with processed = true; drop it, or say so")
        if self.window_s is not None and self.window_s[0] >= self.window_s[1]:
            raise InputError(f"window_s {list(self.window_s)} must be [start, end] with start before end")
        if self.baseline is not None and self.baseline.method == "pre-event" and self.pre_event_s is None:
            raise InputError("baseline: the method pre-event needs pre_event_s, the seconds of noise at the start")
        return self
