"""kouros motions add of what obspy reads, and of a borehole beside a record of the surface."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest

from pipeline.motions import load_manifest
from pipeline.motions.reading import read_record
from tests.cli.test_add_command import DEMO, say
from tests.motions.test_components import knet

# isort: split
import obspy  # after what imports it in a way that warns of nothing
from obspy.io.sac import SACTrace

from tests.soak import SOAK, some

SENSITIVITY = 213807.0
"""Counts per m/s2 of the demonstration's instrument, about: the samples below are in m/s2."""

SAID = ("--unit", "m/s2", "--processed")

DEPTHS = pytest.mark.long("test_of_two_depths_by_stationxml_the_surface_is_taken")


@pytest.fixture(scope="module")
def real() -> list[obspy.Trace]:
    """40 s of the demonstration's record in m/s2: east, north, up."""
    made = []
    for one in "ENZ":
        (trace,) = obspy.read(str(DEMO / f"CI.CLC..HN{one}.mseed"))
        trace.trim(trace.stats.starttime + 20.0, trace.stats.starttime + 60.0)
        trace.data = ((trace.data - np.median(trace.data)) / SENSITIVITY).astype(np.float32)
        del trace.stats.mseed
        made.append(trace)
    return made


def turned(folder: Path) -> list[float | str | None]:
    record = load_manifest(folder).level[0].record[0]
    return [one.orientation for one in sorted(record.components.values(), key=lambda one: one.axis)]


@pytest.mark.parametrize("form", some(["SAC", "SLIST", "TSPAIR", "GSE2", "SH_ASC", "AH"], 3))
def test_what_says_no_unit_is_asked(tmp_path: Path, real: list[obspy.Trace], form: str) -> None:
    """GSE2 holds integers: mm/s2 here."""
    new = tmp_path / "new"
    new.mkdir()
    for one in real:
        trace = one.copy()
        if form == "GSE2":
            trace.data = np.round(1000.0 * trace.data).astype(np.int32)
        trace.write(str(new / f"{trace.stats.channel}.dat"), format=form)
    code, out = say(tmp_path, "add", "new", "--site", "mine")
    assert (code, "--unit UNIT" in out, "--raw or --processed" in out) == (2, True, True), out
    said = ("--unit", "mm/s2", "--processed") if form == "GSE2" else SAID
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", *said)
    assert code == 0, out
    peak = max(float(np.abs(one.data).max()) for one in real[:2]) / 9.80665
    assert f" {peak:.3g} " in out, "that of the larger horizontal, in g"
    assert turned(tmp_path / "mine") == [90.0, 0.0, "up"]


def sac(folder: Path, real: list[obspy.Trace], kind: str) -> None:
    folder.mkdir()
    for trace, name, azimuth, inclination in zip(
        real, ("HN1", "HN2", "HN3"), (120.0, 30.0, 0.0), (90.0, 90.0, 0.0), strict=True
    ):
        one = SACTrace.from_obspy_trace(trace)
        one.kcmpnm, one.cmpaz, one.cmpinc, one.idep = name, azimuth, inclination, kind
        one.write(str(folder / f"{name}.sac"))


def test_the_direction_of_a_sac_header_is_taken(tmp_path: Path, real: list[obspy.Trace]) -> None:
    sac(tmp_path / "new", real, "iacc")
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", *SAID)
    assert code == 0, out
    assert turned(tmp_path / "mine") == [120.0, 30.0, "up"]


@pytest.mark.parametrize(("kind", "word"), [("ivel", "a velocity"), ("idisp", "a displacement")])
def test_what_a_sac_header_calls_no_acceleration_is_refused(
    tmp_path: Path, real: list[obspy.Trace], kind: str, word: str
) -> None:
    sac(tmp_path / "new", real, kind)
    code, out = say(tmp_path, "add", "new", "--site", "mine", *SAID)
    assert (code, f"its header says that it holds {word} (IDEP), no acceleration" in out) == (4, True), out


@pytest.mark.filterwarnings("ignore:CREATING TRACE HEADER")
def test_traces_without_names_are_numbered(tmp_path: Path, real: list[obspy.Trace]) -> None:
    """SEG-Y: three were all called "...", and no answer could tell them apart."""
    obspy.Stream([one.copy() for one in real]).write(str(tmp_path / "a.segy"), format="SEGY", data_encoding=5)
    code, out = say(tmp_path, "add", "a.segy", "--site", "mine", *SAID)
    assert (code, "How are HN1, HN2, HN3 oriented" in out) == (2, True), out
    said = [w for n, way in enumerate(("90", "0", "up"), 1) for w in ("--orientation", f"HN{n}={way}")]
    code, out = say(tmp_path, "add", "a.segy", "--site", "mine", "--no-compare", *SAID, *said)
    assert code == 0, out
    assert turned(tmp_path / "mine") == [90.0, 0.0, "up"]


def test_of_kiknet_the_surface_is_taken_and_the_borehole_told(tmp_path: Path) -> None:
    """Channels 1 to 3 stood at -230 m, 4 to 6 at 20 m."""
    new = tmp_path / "new"
    new.mkdir()
    for number, name in enumerate(("NS1", "EW1", "UD1", "NS2", "EW2", "UD2"), start=1):
        knet(new / f"A.{name}", str(number), height=-230 if number < 4 else 20)
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", "--accept", "a tone")
    assert code == 0, out
    assert "in the borehole, left: " in out
    (record,) = load_manifest(tmp_path / "mine").level[0].record
    assert sorted(record.components) == ["EW2", "NS2", "UD2"]
    assert all(name[-1] == "2" for name in record.files)


@pytest.mark.parametrize(
    ("surface", "guess"),
    [("00", ()), pytest.param("10", ("--guess",), marks=DEPTHS), *(SOAK * [("00", ("--guess",)), ("10", ())])],
)
def test_of_two_depths_by_stationxml_the_surface_is_taken(tmp_path: Path, surface: str, guess: tuple[str, ...]) -> None:
    """The same instrument under two location codes, 120 m below one another; the folder is given as one."""
    new = tmp_path / "new"
    new.mkdir()
    inventory = obspy.read_inventory(str(next(DEMO.glob("*.xml"))))
    station, channels = inventory[0][0], []
    for location in ("00", "10"):
        for one in "ENZ":
            (trace,) = obspy.read(str(DEMO / f"CI.CLC..HN{one}.mseed"))
            trace.stats.location = location
            trace.write(str(new / f"{trace.id}.mseed"), format="MSEED")
        for channel in copy.deepcopy(station.channels):
            channel.location_code, channel.depth = location, 0.0 if location == surface else 120.0
            channels.append(channel)
    station.channels = channels
    inventory.write(str(new / "station.xml"), format="STATIONXML")
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", "--dry-run", "--json", *guess)
    assert code == 0, out
    files = [f"CI.CLC_2019-07-06_03_19/CI.CLC.{surface}.HN{one}.mseed" for one in "ENZ"]
    assert all(f'"{name}"' in out for name in files)
    assert out.count('.mseed",') + out.count('.mseed"\n') == 3, "no other file is part of a record"
    below = "10" if surface == "00" else "00"
    assert f"CI.CLC.{below}.HNZ: in a borehole, and a museum stands on the surface, where its other record stood" in out


def sensitivity_alone(file: Path, unit: str) -> None:
    """The demonstration's StationXML as level=channel has it: each channel's sensitivity, and no stages."""
    inventory = obspy.read_inventory(str(DEMO / "CI.CLC.xml"))
    for channel in inventory[0][0]:
        channel.response.response_stages = []
        channel.response.instrument_sensitivity.input_units = unit
    inventory.write(str(file), format="STATIONXML")


def test_counts_with_their_sensitivity_alone_are_read_and_doubted(tmp_path: Path) -> None:
    """By the same numbers as a division by hand."""
    new = tmp_path / "new"
    new.mkdir()
    for file in DEMO.glob("CI.CLC..HN?.mseed"):
        (trace,) = obspy.read(str(file))
        trace.trim(trace.stats.starttime + 20.0, trace.stats.starttime + 60.0)
        trace.write(str(new / file.name), format="MSEED")
    sensitivity_alone(new / "CI.CLC.xml", "M/S**2")
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare")
    assert code == 0, out
    assert " ".join(out.split()).count("CI.CLC.xml, which has no response: what the instrument does") == 1
    record = load_manifest(tmp_path / "mine").level[0].record[0]
    found = read_record(tmp_path / "mine", record)
    for row, letter in enumerate("EN"):
        (trace,) = obspy.read(str(new / f"CI.CLC..HN{letter}.mseed"))
        response = obspy.read_inventory(str(DEMO / "CI.CLC.xml")).get_response(trace.id, trace.stats.starttime)
        assert found.data[row] == pytest.approx(trace.data / response.instrument_sensitivity.value, rel=1e-12)


def test_the_sensitivity_of_a_velocity_sensor_is_no_response(tmp_path: Path) -> None:
    new = tmp_path / "new"
    new.mkdir()
    for file in DEMO.glob("CI.CLC..HN?.mseed"):
        (new / file.name).write_bytes(file.read_bytes())
    sensitivity_alone(new / "CI.CLC.xml", "M/S")
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare")
    assert (code, "level=response" in out) == (2, True), out


def test_what_is_processed_keeps_its_unit_beside_a_stationxml(tmp_path: Path, real: list[obspy.Trace]) -> None:
    """A response that was removed already is not removed again; who does not say the unit is asked for it."""
    new = tmp_path / "new"
    new.mkdir()
    for one in real:
        one.write(str(new / f"{one.id}.mseed"), format="MSEED")
    (new / "CI.CLC.xml").write_bytes((DEMO / "CI.CLC.xml").read_bytes())
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", "--processed")
    assert code == 2, out
    assert "what is processed has no response left that a StationXML could remove; say the unit" in " ".join(
        out.split()
    )
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare", *SAID, "--accept", "an excerpt")
    assert code == 0, out
    record = load_manifest(tmp_path / "mine").level[0].record[0]
    assert record.response is None
    found = read_record(tmp_path / "mine", record)
    assert found.data[0] == pytest.approx(real[0].data.astype(float), rel=1e-6)
