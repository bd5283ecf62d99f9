"""Records proposed of files: what these say becomes a manifest's table, and what nothing says a question."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from pipeline.motions.candidates import Unusable
from pipeline.motions.catalogues import distance_km, matching
from pipeline.motions.channel_choice import chosen, described, is_velocity, left_below, one_version, saturated
from pipeline.motions.errors import MotionError
from pipeline.motions.gathering import GatheredFiles
from pipeline.motions.grouping import FileTrace, channels, grouped
from pipeline.motions.own_facts import own_event, own_station
from pipeline.motions.reading import UNITS, own_unit
from pipeline.motions.record import EventTable, Record, StationTable
from pipeline.motions.safe_names import free_name, one_line, safe_name
from pipeline.motions.station_metadata import depth, has_response, metadata, sac_direction
from pipeline.quantities import counted

_STEEP = 80.0
"""Degrees of dip from which a channel is a vertical one."""

_LEVEL = 10.0
"""Degrees of dip up to which a channel is a horizontal one."""


@dataclass(frozen=True)
class Answers:
    """What a person says of files that do not say it themselves.

    Attributes
    ----------
    name : str
        Of the one record; "" proposes one.
    units : mapping of str to str
        By file, channel id or code; "" for all that say none.
    orientations : mapping of str to float or str
        Degrees from north, "up" or "down", by file, channel id or code.
    processed : mapping of str to bool
        By file, channel id or code; "" for all that do not say.
    channels : sequence of str
        Which are taken, where there are more than three.
    source, licence : str
        "" proposes words.
    level : str
        Of shaking; "" takes the only one.
    """

    name: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    orientations: Mapping[str, float | str] = field(default_factory=dict)
    processed: Mapping[str, bool] = field(default_factory=dict)
    channels: Sequence[str] = ()
    source: str = ""
    licence: str = ""
    level: str = ""


@dataclass(frozen=True, slots=True)
class MissingAnswer:
    """What nothing says of a record.

    Attributes
    ----------
    record : str
        What it may be called.
    about : {"unit", "orientation", "processed", "channels", "level"}
        What is asked.
    text : str
        The question.
    option : str
        The words of the command line that answer it.
    handles : tuple of str
        Keys of the answer: the record's first file, or its channels.
    """

    record: str
    about: str
    text: str
    option: str
    handles: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class RecordProposal:
    """A record as it may stand in a manifest.

    Attributes
    ----------
    name : str
        What it may be called.
    files : mapping of str to Path
        The name of each file inside the record's folder, and where it is now.
    record : Record or None
        None as long as there are questions.
    questions : tuple of MissingAnswer
        What nothing says.
    told : tuple of str
        What was decided, and why.
    """

    name: str
    files: Mapping[str, Path]
    record: Record | None
    questions: tuple[MissingAnswer, ...]
    told: tuple[str, ...]


def propose(found: GatheredFiles, answers: Answers) -> tuple[list[RecordProposal], list[Unusable]]:
    """Make records of files.

    Parameters
    ----------
    found : GatheredFiles
        What the files hold.
    answers : Answers
        What a person has said.

    Returns
    -------
    list of RecordProposal
        One for each record, in the order of their files.
    list of Unusable
        What was left out, and why.
    """
    groups = _groups(found)
    inventories = list(found.catalogues.inventories.values())
    left: list[Unusable] = []
    kept: list[tuple[str, Sequence[FileTrace], list[str]]] = []
    picks = [chosen(traces, answers.channels, lambda trace: depth(inventories, trace)) for _, traces in groups]
    for (of, _), picked in zip(groups, picks, strict=True):
        if picked.refused:
            left.append(Unusable(_label(of), *left_below(picked, picks)))
        else:
            kept.append((of, picked.traces, list(picked.told)))
    out = dict(one_version([traces for _, traces, _ in kept], answers.processed.get("") is False))
    left += [Unusable(_label(kept[i][0]), why, chosen=True) for i, why in out.items()]
    made = []
    for i, (of, picked_traces, told) in enumerate(kept):
        if i in out:
            continue
        try:
            made.append(_Making(found, answers, _label(of), picked_traces, told).proposal())
        except MotionError as problem:
            left.append(Unusable(_label(of), str(problem)))
        except ValidationError as problem:
            first = problem.errors()[0]
            where = ".".join(str(part) for part in first["loc"])
            words = first["msg"].removeprefix("Value error, ")
            left.append(Unusable(_label(of), f"{where}: {words}" if where else words))
    return made, left


def _label(of: str) -> str:
    """What a group is called: a number for its folder stands before a file's name."""
    number, slash, name = of.partition("/")
    return one_line(name if slash and number.isdigit() else of).strip(".") or "record"


def _groups(found: GatheredFiles) -> list[tuple[str, list[FileTrace]]]:
    groups = grouped(found.traces)
    single = [one for _, part in groups for one in part]
    # Two or three files without a station, given by themselves, are one record whatever they are called.
    if len(groups) > 1 and 2 <= len(single) <= 3 and len({name for name, _ in single}) == len(single):
        alone = not any(trace.stats.station for _, trace in single)
        if alone and len({round(trace.stats.delta, 9) for _, trace in single}) == 1:
            return [(single[0][0], single)]
    return groups


class _Making:
    """One record in the making."""

    def __init__(
        self, found: GatheredFiles, answers: Answers, of: str, traces: Sequence[FileTrace], told: list[str]
    ) -> None:
        self.found, self.answers, self.of, self.traces, self.told = found, answers, of, traces, told
        self.questions: list[MissingAnswer] = []
        names = list(dict.fromkeys(name for name, _ in traces))
        self.local = _local([found.paths[name] for name in names])
        self.by_name = dict(zip(names, self.local, strict=True))
        self.first = traces[0][1]
        self.start = min(trace.stats.starttime for _, trace in traces)
        self.timed = bool(self.start.timestamp) and self._said("start") != {"unknown"}
        every = [trace for name, traces in found.traces if name in self.by_name for trace in traces]
        self.codes, self.ids = [t.stats.channel for t in every], [t.id for t in every]
        self.search = next((row for n in names if (row := found.searches.get(Path(n).name.upper()))), None)

    def _said(self, word: str) -> set[Any]:
        return {trace.stats.get("kouros", {}).get(word) for _, trace in self.traces}

    def _handles(self, one: FileTrace) -> tuple[str, ...]:
        name, trace = one
        path, file = self.found.paths[name], Path(name).name
        return f"{path}#{trace.id}", str(path), f"{file}#{trace.id}", file, trace.id, trace.stats.channel

    def _answer(self, said: Mapping[str, Any], *, plain: bool) -> Any:
        """The answer for the record: by one of its channels, or by nothing where that is meant."""
        for one in self.traces:
            for handle in self._handles(one):
                if handle and handle in said:
                    return said[handle]
        return said.get("") if plain else None

    def _ask(self, about: str, text: str, option: str, handles: Sequence[str]) -> None:
        self.questions.append(MissingAnswer(self.of, about, text, option, tuple(handles)))

    def proposal(self) -> RecordProposal:
        """Return the record, or what has to be asked first."""
        if len(self.traces) > 3:
            return self._which()
        if missing := self._missing():
            remedy = f"give the files of the other components of {_label(self.of)} as well"
            raise MotionError(f"{self._held()}, and lacks {missing}; {remedy}")
        response = self._response()
        processed = self._processed(response)
        components = self._components()
        station, event, distance = self._where()
        name = self._name(station, event)
        if self.questions:
            return RecordProposal(name, self.local, None, tuple(self.questions), tuple(self.told))
        files = dict(self.local)
        table: dict[str, Any] = {"name": name, "files": tuple(files), "components": components}
        if response is not None:
            table["response"] = free_name(safe_name(response.name), files)
            files[table["response"]] = response
            if is_velocity(self.traces):
                if full := saturated(self.traces):
                    raise MotionError(f"{full}; give the accelerometer of the station")
                self.told.append("a velocity sensor: look whether the strong shaking has clipped it")
        unit = self._unit(response)
        table |= {} if len(components) == 3 else {"vertical": "absent"}
        if self.search is not None and self.search.scale is not None:
            table["scale"] = self.search.scale
            self.told.append(f"scale {self.search.scale:g}, as the search has it")
        said = {"units": unit, "processed": processed, "event": event, "station": station, "distance_km": distance}
        table |= {key: value for key, value in said.items() if value is not None}
        table |= {"source": self._source(station), "licence": self.answers.licence or _LICENCE}
        table["sha256"] = {local: hashlib.sha256(path.read_bytes()).hexdigest() for local, path in files.items()}
        if "vertical" in table:
            self.told.append("no vertical component: none will shake anything")
        return RecordProposal(name, files, Record(**table), (), tuple(self.told))

    def _missing(self) -> str:
        """Which horizontals a record lacks; without a vertical it is one."""
        flat = sum(channel.axis != "z" for channel in self._by_trace())
        return "" if flat >= 2 else "the other horizontal component" if flat else "both horizontal components"

    def _held(self) -> str:
        """What files say of channels that are no record by themselves."""
        told = []
        for (_, trace), channel in zip(self.traces, self._by_trace(), strict=True):
            towards = "" if channel.orientation is None else _degrees(channel.orientation)
            unit = own_unit(trace.stats)[0]
            kind = {True: "processed", False: "raw"}.get(trace.stats.get("kouros", {}).get("processed"), "")
            told.append(", ".join(word for word in (channel.code, towards, unit and f"in {unit}", kind) if word))
        named = ", ".join(path.name for path in self.local.values())
        return f"{named} holds {counted(len(told), 'channel')} ({'; '.join(told)})"

    def _which(self) -> RecordProposal:
        every = zip(self.traces, self._by_trace(), strict=True)
        there = "; ".join(described(trace, one.orientation) for (_, trace), one in every)
        text = f"It has {len(self.traces)} channels: {there}.  Which three stood on the ground, or in the free field?"
        self._ask("channels", text, "--channels ID,ID,ID", [str(self.found.paths[self.traces[0][0]])])
        return RecordProposal(self.of, self.local, None, tuple(self.questions), tuple(self.told))

    def _by_trace(self) -> list[Any]:
        return [channels([trace])[0] for _, trace in self.traces]

    def _response(self) -> Path | None:
        """The StationXML that turns counts into an acceleration; asks for a unit where there is neither."""
        silent = [one for one in self.traces if self._silent(one[1])]
        if not silent or self._answer(self.answers.units, plain=False):
            return None
        # Of what is called processed the instrument was removed: a response would remove it again.
        done = self._answer(self.answers.processed, plain=True)
        partly = []
        for path, inventory in self.found.catalogues.inventories.items():
            known = [has_response(inventory, trace) for _, trace in self.traces]
            if all(known) and not done:
                return path
            if any(known) and not done:
                partly.append(path.name)
        if self.answers.units.get(""):
            return None
        unit, stats = own_unit(silent[0][1].stats)[0], silent[0][1].stats
        what = "are counts" if unit == "counts" else "may be counts" if silent[0][1].data.dtype.kind == "i" else "?"
        text = "No file says the unit of its samples"
        if word := stats.get("kouros", {}).get("unit_said"):
            text = f"Its file says {one_line(word)!r} for the unit, which is none that is known: say what one of it is"
        elif done and self.found.catalogues.inventories:
            text += ": what is processed has no response left that a StationXML could remove; say the unit, or --raw"
        elif what != "?" or stats.network:
            text += "" if what == "?" else f", which {what}"
            text += f": give the station's StationXML (level=response, network {stats.network or '?'}, station "
            text += f"{stats.station or '?'}) among the files, or their unit"
        if partly:
            text += f" ({', '.join(partly)} knows some of its channels only)"
        option = "STATION.xml, or --unit UNIT" if what != "?" else f"--unit UNIT (one of {', '.join(UNITS)})"
        self._ask("unit", text, option, [str(self.found.paths[silent[0][0]])])
        return None

    @staticmethod
    def _silent(trace: Any) -> bool:
        unit, factor = own_unit(trace.stats)
        return unit in {"", "counts"} and not factor

    def _unit(self, response: Path | None) -> str | None:
        if response is not None:
            return None
        keyed = self._answer(self.answers.units, plain=False)
        if keyed or any(self._silent(trace) for _, trace in self.traces):
            return keyed or self.answers.units.get("")
        plain, own = self.answers.units.get(""), own_unit(self.first.stats)
        sensitivity = " with their sensitivity" if own[0] == "counts" else ""
        self.told.append(f"{own[0]}{sensitivity}, by its files")
        if plain and UNITS[plain] != own[1]:
            self.told.append(f"its files say {own[0]}, so that --unit {plain} was not needed")
        return None

    def _processed(self, response: Path | None) -> bool | None:
        given = self._answer(self.answers.processed, plain=True)
        said = self._said("processed")
        if len(said) == 1 and None not in said:
            (own,) = said
            words = {True: "processed", False: "raw"}
            if given is not None and given != own:
                self.told.append(f"its files say {words[own]}, and you {words[given]}: that is what the manifest says")
                return bool(given)
            self.told.append(f"{words[own]}, by its files")
            return None
        if given is not None:
            return bool(given)
        if response is not None or all(trace.stats._format == "KNET" for _, trace in self.traces):
            self.told.append("raw: counts, as the instrument wrote them")
            return False
        if self.search is not None or all(_from_peer(self.found.paths[name]) for name, _ in self.traces):
            self.told.append("processed: so are all records of the PEER NGA database")
            return True
        text = "No file says whether it is raw, or was filtered and corrected by its source"
        self._ask("processed", text, "--raw or --processed", [str(self.found.paths[self.traces[0][0]])])
        return None

    def _components(self) -> dict[str, dict[str, Any]]:
        known = [self._orientation(one, channel) for one, channel in zip(self.traces, self._by_trace(), strict=True)]
        lost = [one for one, direction in zip(self.traces, known, strict=True) if direction is None]
        if lost:
            called = [self._handle(one) for one in lost]
            named = [f"{name}{_word(one)}" for name, one in zip(called, lost, strict=True)]
            one_or_more = "How is" if len(lost) == 1 else "How are"
            text = f"{one_or_more} {', '.join(named)} oriented: degrees clockwise from north, or up, or down"
            option = " ".join(f"--orientation {self._own_handle(one)}=..." for one in lost)
            self._ask("orientation", text, option, [self._handles(one)[0] for one in lost])
            return {}
        flat = [(one, d) for one, d in zip(self.traces, known, strict=True) if isinstance(d, float)]
        # East before north, as x before y; the axes only tell the channels apart.
        flat.sort(key=lambda each: (abs(each[1] % 180.0 - 90.0), each[0][1].id))
        made = {
            self._key(one): {"axis": axis, "orientation": direction}
            for axis, (one, direction) in zip(("x", "y", "?"), flat, strict=False)
        }
        steep = [(one, d) for one, d in zip(self.traces, known, strict=True) if isinstance(d, str)]
        return made | {self._key(one): {"axis": "z", "orientation": direction} for one, direction in steep}

    def _handle(self, one: FileTrace) -> str:
        """What a person calls a channel: its code, where that is its own, else its file, else its full id."""
        code = one[1].stats.channel
        if code and [trace.stats.channel for _, trace in self.traces].count(code) == 1:
            return str(code)
        names = [name for name, _ in self.traces]
        return Path(one[0]).name if names.count(one[0]) == 1 else str(one[1].id)

    def _own_handle(self, one: FileTrace) -> str:
        """What no other channel of all the files is called, so that an answer is for none of another record."""
        called = self._handle(one)
        every = [trace for _, traces in self.found.traces for trace in traces]
        if called != one[1].stats.channel or [trace.stats.channel for trace in every].count(called) == 1:
            return called
        return f"{Path(one[0]).name}#{one[1].id}"

    def _key(self, one: FileTrace) -> str:
        """What a manifest calls it, so that no other channel of the files is meant."""
        code, own = one[1].stats.channel, one[1].id
        if code and self.codes.count(code) == 1:
            return str(code)
        return str(own) if self.ids.count(own) == 1 else self.by_name[one[0]]

    def _orientation(self, one: FileTrace, channel: Any) -> float | str | None:
        for handle in self._handles(one):
            if handle in self.answers.orientations:
                return self.answers.orientations[handle]
        own = None if channel.by_code else channel.orientation
        if isinstance(own, float) or own in {"up", "down"}:
            return own
        said = metadata(self.found.catalogues.inventories.values(), one[1])
        by = "its StationXML" if said is not None else "its header"
        dip, azimuth = (said.get("dip"), said.get("azimuth")) if said is not None else sac_direction(one[1])
        if dip is not None and abs(dip) >= _STEEP:
            return "up" if dip < 0.0 else "down"
        if azimuth is not None and dip is not None and abs(dip) <= _LEVEL:
            if not (channel.by_code and isinstance(channel.orientation, float) and channel.orientation == azimuth):
                self.told.append(f"{self._handle(one)}: {azimuth:g} degrees, by {by}")
            return float(azimuth) % 360.0
        if channel.by_code:
            self.told.append(f"{self._handle(one)}: {_degrees(channel.orientation)}, by its code")
        return channel.orientation if channel.by_code else None

    def _where(self) -> tuple[StationTable | None, EventTable | None, float | None]:
        stats, row = self.first.stats, self.search
        station = own_station(self.first)
        known = self.found.catalogues.stations
        for code in (f"{stats.network}.{stats.station}", str(stats.station)):
            if stats.station and code in known:
                station = known[code]
        if station is None and row is not None and row.station:
            station = StationTable(name=one_line(row.station))
        event = own_event(self.first)
        end = max(trace.stats.endtime for _, trace in self.traces)
        if self.timed:
            fitting = matching(self.found.catalogues.events, self.start.timestamp, end.timestamp, station)
            event = fitting[0] if fitting else event
            if len(fitting) > 1:
                self.told.append(f"{len(fitting)} earthquakes fit its time; the largest is named")
        elif self.found.catalogues.events and row is None:
            self.told.append("its files do not say when it was made: no earthquake of the catalogue was named")
        if event is None and row is not None:
            event = EventTable(name=one_line(row.event) or None, magnitude=row.magnitude)
        if row is not None and row.rupture_km is not None:
            return station, event, row.rupture_km
        far = distance_km(event, station)
        if far is None and event is not None and event == own_event(self.first):
            far = self.first.stats.get("kouros", {}).get("distance_km")
        return station, event, far

    def _name(self, station: StationTable | None, event: EventTable | None) -> str:
        if self.answers.name:
            return self.answers.name
        code = "" if station is None else station.code or ""
        # A number tells nobody where it is, with or without its network.
        tells = "." in code and not code.rpartition(".")[2].isdigit()
        where = code if tells or station is None else station.name or code
        if self.search is not None:
            return one_line(f"{self.search.event}, {self.search.station} (RSN {self.search.number})")
        if event is not None and event.name:
            size = "" if event.magnitude is None or "M" in event.name else f" M{event.magnitude:g}"
            return one_line(f"{event.name}{size}, {where or self.of}")
        title = str(self.first.stats.get("kouros", {}).get("title", ""))
        if "," in title:
            return one_line(title.rpartition(",")[0])
        when = f" {self.start.strftime('%Y-%m-%d %H:%M')}" if self.timed else ""
        size = "" if event is None or event.magnitude is None else f", M{event.magnitude:g}"
        return one_line(f"{where or self.of}{when}{size}")

    def _source(self, station: StationTable | None) -> str:
        if self.answers.source:
            return self.answers.source
        if self.search is not None:
            return f"PEER NGA-West2 database, RSN {self.search.number}"
        networks = {network.code: network for i in self.found.catalogues.inventories.values() for network in i}
        network = networks.get(self.first.stats.network)
        of = one_line(network.description or "") if network is not None else ""
        code = "" if station is None else station.code or station.name or ""
        where = f"station {code}" if code else ", ".join(self.local)
        when = f", {self.start.strftime('%Y-%m-%d %H:%M:%S')} UTC" if self.timed else ""
        whose = f"{of}, " if of else ""
        return f"{whose}{where}{when}, by its files; say whose record it is"[:500]


_LICENCE = "its files do not say: ask before you pass it on"


def _degrees(direction: float | str) -> str:
    return f"{direction:g} degrees" if isinstance(direction, float) else direction


def _word(one: FileTrace) -> str:
    """What a header says of a direction in a word that tells none, such as L; "" where it says nothing."""
    said = one[1].stats.get("kouros", {}).get("orientation")
    return f" (its header says {one_line(said)!r})" if isinstance(said, str) and one_line(said) else ""


def _from_peer(file: Path) -> bool:
    with file.open("rb") as stream:
        return stream.read(100).upper().startswith(b"PEER NGA STRONG MOTION DATABASE RECORD")


def _local(paths: Sequence[Path]) -> dict[str, Path]:
    """Names for files in one folder: their own, where that is no trap and not taken."""
    made: dict[str, Path] = {}
    for path in paths:
        made[free_name(safe_name(path.name), made)] = path
    return made
