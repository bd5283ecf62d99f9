"""What a message says of an earthquake and of its shaking at a place, and how a message is refused."""

from __future__ import annotations

import gzip
import math
import re
import zlib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from pipeline.errors import InputError
from pipeline.quantities import G

LARGEST = 64 << 20
"""Bytes of a message, unpacked: a grid of a million points has about as many."""

NINETY = 1.6448536269514722
"""Standard deviations on each side within which 9 of 10 cases lie."""

PGA_SIGMA, PGV_SIGMA = 0.70, 0.65
"""Standard deviations of ln of PGA and PGV that a relation alone tells: Boore et al. (2014), Earthquake Spectra 30(3),
1057-1085, between and within earthquakes of about magnitude 6 to 7 together, rounded."""

FIRST_SIGMA = 0.86
"""The same of a first alert, and of a number of which nobody says how sure it is: judgement, the 0.70 of a relation and
half a unit of magnitude at one of ln PGA for each; from 0.7 to 1.0."""

CORRELATION = 0.733
"""Of ln of PGA and of PGV at one place, each about what a relation says: Bradley (2012), Earthquake Spectra 28(1),
17-35."""

RATIO_SIGMA = 0.50
"""Standard deviation of ln of PGV over PGA: what the two sigmas and the correlation above come to."""

AHEAD = timedelta(minutes=5)
"""By how much clocks may differ before an earthquake lies in the future: judgement."""

_EARTH = 6371.0
_ENCODINGS = frozenset({b"utf-8", b"us-ascii", b"ascii", b"iso-8859-1", b"latin-1", b"windows-1252"})
_DECLARED = re.compile(rb"""^<\?xml[^>]*?encoding\s*=\s*["']([^"']*)["']""")
_ELEMENTS_ONLY = re.compile(rb"<!DOCTYPE\s+shakemap-data\s*\[(?:\s*<!(?:ELEMENT|ATTLIST)\s[^<>%&\[\]]*>)*\s*\]\s*>")

_CANCELLED = frozenset({"cancelled", "canceled", "cancel", "delete", "deleted"})
ACCELERATIONS: Mapping[str, float] = {
    "pctg": 0.01, "%g": 0.01, "g": 1.0, "cm/s/s": 0.01 / G, "cm/s2": 0.01 / G, "cm/s^2": 0.01 / G, "gal": 0.01 / G,
    "gals": 0.01 / G, "cm/s**2": 0.01 / G, "m/s/s": 1.0 / G, "m/s2": 1.0 / G, "m/s^2": 1.0 / G, "m/s**2": 1.0 / G,
}  # fmt: skip
"""Units of peak acceleration, in g."""
VELOCITIES: Mapping[str, float] = {"cms": 1.0, "cm/s": 1.0, "m/s": 100.0}
"""Units of peak velocity, in cm/s."""

MOST_PGA, MOST_PGV = 5.0, 1000.0
"""g and cm/s: more than was ever recorded of the ground (4.4 g at Iwate 2008, 380 cm/s at Chi-Chi 1999); it is a unit
that is not what it is called."""


class MessageError(InputError):
    """A message about an earthquake that nothing can be answered by: file, place, what is wrong, and the remedy."""


class CutOffError(MessageError):
    """A message that is not whole: it was cut off on the way, or is still being written."""


def refused(file: Path, place: str, wrong: str, remedy: str) -> MessageError:
    """Return the error of a message, so that all read alike."""
    return MessageError(f"{file}: {place}: {wrong}; {remedy}")


def cut_off(file: Path, wrong: str) -> CutOffError:
    """Return the error of a message that is not whole."""
    return CutOffError(f"{file}: file: {wrong}; it was cut off on the way, or is still being written: fetch it again")


@dataclass(frozen=True)
class ReportedEarthquake:
    """An earthquake as a message has it.

    Attributes
    ----------
    id, name : str
        Of the agency; "" where it says none.
    magnitude, latitude, longitude, depth_km : float or None
        Degrees north and east.
    time : datetime or None
        Of its origin, UTC.
    version : str
        Of the message.
    scenario : bool
        Whether it is an exercise.
    """

    id: str = ""
    name: str = ""
    magnitude: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    depth_km: float | None = None
    time: datetime | None = None
    version: str = ""
    scenario: bool = False

    def distance_km(self, latitude: float, longitude: float) -> float | None:
        """Return how far its epicentre is from a place, km; None where that is not known."""
        if self.latitude is None or self.longitude is None:
            return None
        return kilometres(self.latitude, self.longitude, latitude, longitude)

    def apart(self, other: ReportedEarthquake) -> tuple[float, float] | None:
        """Return how far another earthquake is in km and in s; None where place or time of one is not known."""
        if other.latitude is None or other.longitude is None or self.time is None or other.time is None:
            return None
        far = self.distance_km(other.latitude, other.longitude)
        return None if far is None else (far, abs((self.time - other.time).total_seconds()))

    @property
    def version_number(self) -> float:
        """The version of the message as a number, 0 where it is none."""
        try:
            return float(self.version)
        except ValueError:
            return 0.0


@dataclass(frozen=True)
class SiteShaking:
    """Shaking of the ground at the museum.

    Attributes
    ----------
    pga_g : float
        Peak horizontal acceleration, median, in g.
    pgv_cm_s : float or None
        Peak horizontal velocity, median; None where the message does not say it.
    pga_ln_sd, pgv_ln_sd : float
        Standard deviations of their logarithms.
    origin : str
        What it is from.
    notes : tuple of str
        What a reader has to know of it.
    correlation : float
        Of the two logarithms, each about its median.
    """

    pga_g: float
    pgv_cm_s: float | None
    pga_ln_sd: float
    pgv_ln_sd: float
    origin: str
    notes: tuple[str, ...] = ()
    correlation: float = CORRELATION

    def pga_range(self) -> tuple[float, float]:
        """Return the peak acceleration that is passed in 95 and in 5 of 100 cases, g."""
        return _range(self.pga_g, self.pga_ln_sd)

    def with_velocity(self, ratio: float, sd: float) -> SiteShaking:
        """Return the same with a peak velocity, where the message says none: by the ratio to the acceleration.

        Parameters
        ----------
        ratio : float
            Median of PGV over PGA, cm/s for each g.
        sd : float
            Standard deviation of its logarithm.
        """
        if self.pgv_cm_s is not None:
            return self
        whole = math.hypot(self.pga_ln_sd, sd)
        note = (
            f"No PGV is told: it is estimated from PGA by the {ratio:.0f} cm/s for each g of the site's own motions, "
            f"within {sd:.2f} of ln."
        )
        return replace(
            self, pgv_cm_s=self.pga_g * ratio, pgv_ln_sd=whole, correlation=self.pga_ln_sd / whole if whole else 1.0,
            notes=(*self.notes, note),
        )  # fmt: skip

    def pgv_range(self) -> tuple[float, float]:
        """Return the same of the peak velocity, cm/s; (0, 0) where that is not known."""
        return (0.0, 0.0) if self.pgv_cm_s is None else _range(self.pgv_cm_s, self.pgv_ln_sd)


def _range(median: float, sd: float) -> tuple[float, float]:
    return median * math.exp(-NINETY * sd), median * math.exp(NINETY * sd)


@dataclass(frozen=True)
class Message(ABC):
    """A file about an earthquake.

    Attributes
    ----------
    file : Path
        Where it is.
    kind : str
        In words, such as "ShakeMap".
    rank : int
        How much it is believed beside others of the same earthquake: more is better.
    quake : Earthquake
        What it says of the earthquake.
    cancelled : bool
        Whether it takes back what was said before.
    """

    file: Path
    kind: str
    rank: int
    quake: ReportedEarthquake
    cancelled: bool = False
    notes: tuple[str, ...] = ()

    @abstractmethod
    def at(self, latitude: float, longitude: float) -> SiteShaking:
        """Return the shaking at a place.

        Raises
        ------
        MessageError
            For a place that it says nothing of, with the distance.
        """


def kilometres(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """Return the distance between two places on a sphere, degrees to km (haversine; within 0.6 % of the ellipsoid)."""
    a, b = math.radians(lat1), math.radians(lat2)
    up, along = 0.5 * (b - a), 0.5 * math.radians(lon2 - lon1)
    chord = math.sin(up) ** 2 + math.cos(a) * math.cos(b) * math.sin(along) ** 2
    return 2.0 * _EARTH * math.asin(min(1.0, math.sqrt(chord)))


def content(file: Path) -> bytes:
    """Return what is in a file, unpacked where gzip packed it.

    Raises
    ------
    MessageError
        For a file that cannot be read, is damaged, or is larger than any message.
    """
    try:
        with file.open("rb") as stream:
            packed = stream.read(2) == b"\x1f\x8b"
        with gzip.open(file) if packed else file.open("rb") as opened:
            data = opened.read(LARGEST + 1)
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise cut_off(file, f"gzip data that is cut off or damaged ({error})") from error
    except OSError as error:
        raise refused(file, "file", f"cannot be read: {error.strerror or error}", "see whether it is there") from error
    if len(data) > LARGEST:
        raise refused(file, "file", f"more than {LARGEST:,} bytes", "give the message of one earthquake")
    return data


def xml_root(file: Path, data: bytes) -> Any:
    """Return the root of an XML message; none of its declarations is ever read.

    The list of elements that USGS writes before its station lists is cut out unread.

    Raises
    ------
    MessageError
        For what is no XML, is cut off, or declares a document type or entities.
    """
    from lxml import etree

    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    declared = _DECLARED.match(text)
    if b"\0" in text or (declared and declared[1].strip().lower() not in _ENCODINGS):
        raise refused(file, "file", "is in an encoding that no such message uses", "fetch it again, as UTF-8")
    text = _ELEMENTS_ONLY.sub(b"", text, count=1)
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise refused(
            file, "file", "declares a document type or entities, which no message needs and which can hide anything",
            "fetch it again from the agency itself",
        )  # fmt: skip
    # What could grow was refused above; a large grid is one text of more than the 10 MB that are else allowed.
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True)
    try:
        return etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        wrong = f"is no whole XML, line {error.lineno or 1}: {str(error)[:200]}"
        raise cut_off(file, wrong) from error


def number(file: Path, place: str, text: Any) -> float:
    """Return a number of a message.

    Raises
    ------
    MessageError
        For what is none.
    """
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise refused(file, place, f"{str(text)[:40]!r} is no number", "fetch the message again")
    return value


def position(file: Path, place: str, latitude: Any, longitude: Any) -> tuple[float, float]:
    """Return degrees north and east.

    Raises
    ------
    MessageError
        For what is no place on earth.
    """
    north, east = number(file, f"{place} lat", latitude), number(file, f"{place} lon", longitude)
    if not (-90.0 <= north <= 90.0 and -360.0 <= east <= 360.0):
        raise refused(file, place, f"{north:g}, {east:g} is no place on earth", "fetch the message again")
    return north, east


def in_unit(file: Path, place: str, unit: Any, known: Mapping[str, float]) -> float:
    """Return by what a unit of a message is multiplied.

    Raises
    ------
    MessageError
        For a unit that is empty or not known.
    """
    said = str(unit or "").strip().lower()
    if not said:
        raise refused(
            file, place, "has no unit, so that its numbers may be anything",
            f"take grid.xml of the event's ShakeMap, which says it ({', '.join(known)})",
        )  # fmt: skip
    if said not in known:
        raise refused(file, place, f"the unit {said[:20]!r} is not known", f"it should be one of {', '.join(known)}")
    return known[said]


def check_peaks(file: Path, place: str, pga_g: float, pgv_cm_s: float | None) -> None:
    """Refuse peaks that no shaking has.

    Raises
    ------
    MessageError
        For peaks beyond `MOST_PGA` and `MOST_PGV`.
    """
    if pga_g > MOST_PGA or (pgv_cm_s or 0.0) > MOST_PGV:
        wrong = f"{pga_g:.3g} g and {pgv_cm_s or 0.0:.3g} cm/s at the museum, more than was ever recorded"
        raise refused(file, place, wrong, "its units are not what they are called: fetch it again")


def moment(file: Path, place: str, text: str) -> datetime:
    """Return a time of a message; without a zone it is UTC, as agencies write it.

    Raises
    ------
    MessageError
        For what is no time.
    """
    said = text.strip().removesuffix("UTC").removesuffix("GMT").removesuffix("Z").strip()
    try:
        found = datetime.fromisoformat(said)
    except ValueError:
        raise refused(file, place, f"{text[:40]!r} is no time", "fetch the message again") from None
    return found.replace(tzinfo=UTC) if found.tzinfo is None else found.astimezone(UTC)


def cancelled(word: str | None) -> bool:
    """Say whether a message's status takes back the earthquake."""
    return (word or "").strip().lower() in _CANCELLED


def check_quake(file: Path, quake: ReportedEarthquake, now: datetime) -> None:
    """Refuse an earthquake that cannot be what it says.

    Raises
    ------
    MessageError
        For magnitude 0, which agencies send where they know none, and for one that has not happened yet.
    """
    if quake.magnitude is not None and not 0.0 < quake.magnitude <= 10.0:
        raise refused(
            file, "magnitude", f"{quake.magnitude:g}, which is sent where none was found",
            "wait for the next version of the message",
        )  # fmt: skip
    if quake.time is not None and quake.time > now + AHEAD and not quake.scenario:
        raise refused(
            file, "time", f"{quake.time:%Y-%m-%d %H:%M:%S} UTC is later than this machine's clock ({now:%H:%M:%S} UTC)",
            "set the clock right, or fetch the message again",
        )  # fmt: skip
