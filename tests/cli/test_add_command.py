"""kouros motions add, as a seismologist types it: with nobody to ask, and at a terminal."""

from __future__ import annotations

import hashlib
import json
import os
import select
import subprocess
import sys
import time
import tomllib
from collections.abc import Sequence
from contextlib import chdir
from math import asin, cos, degrees, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from pipeline.cli import kouros
from pipeline.errors import KourosError
from pipeline.motions import load_manifest, read_motion
from pipeline.motions.catalogues import Catalogues
from pipeline.resources import resource
from tests.motions.conftest import tone  # it imports obspy in a way that warns of nothing

# isort: split
from obspy import Inventory, Stream, Trace, UTCDateTime
from obspy.core.event import Catalog, Event, EventDescription, Magnitude, Origin
from obspy.core.inventory import Channel, Network, Response, Station

DEMO = resource("site_motions", "demo")
SUITE = resource("site_motions", "demo_suite") / "1-records"
START = UTCDateTime(2020, 1, 2, 3, 4, 0)
ORIGIN = START - 10.0


def say(folder: Path, *words: str) -> tuple[int, str]:
    """Run the command in a folder, in this process, where nobody can be asked."""
    with chdir(folder):
        done = CliRunner().invoke(kouros, ["-q", "motions", *words])
    problem = done.exception
    if problem is None or isinstance(problem, SystemExit):
        return done.exit_code, done.output
    assert isinstance(problem, KourosError), repr(problem)
    return problem.exit_code, str(problem)


def digest(folder: Path) -> dict[str, str]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def trace(channel: str, amplitude: float = 1.0, **header: object) -> Trace:
    stats = {"network": "XX", "station": "ONE", "channel": channel, "sampling_rate": 100.0, "starttime": START} | header
    frequency = 1.0 + 0.3 * (sum(map(ord, channel)) % 7)
    return Trace(np.ascontiguousarray(tone(2000, amplitude, frequency)), stats)


def three(folder: Path, channels: Sequence[str] = ("HN1", "HN2", "HNZ"), **header: object) -> list[Path]:
    """Three files that say neither unit nor orientation nor whether they are processed."""
    folder.mkdir(exist_ok=True)
    for channel in channels:
        trace(channel, **header).write(str(folder / f"{channel}.mseed"), format="MSEED")
    return [folder / f"{channel}.mseed" for channel in channels]


def station(code: str, latitude: float, longitude: float, channels: Sequence[tuple[str, float, float]]) -> Station:
    """An instrument of 1e5 counts per m/s2, flat."""
    made = Station(code, latitude, longitude, 0.0, creation_date=UTCDateTime(2000, 1, 1))
    for name, azimuth, dip in channels:
        one = Channel(name, "", latitude, longitude, 0.0, 0.0, azimuth=azimuth, dip=dip, sample_rate=100.0,
                      start_date=UTCDateTime(2000, 1, 1))  # fmt: skip
        one.response = Response.from_paz([], [], 1e5, input_units="M/S**2", output_units="COUNTS")
        made.channels.append(one)
    return made


@pytest.mark.long("test_the_network_s_files_name_station_earthquake_and_distance")
def test_a_record_whose_files_say_all_needs_no_answer_and_is_never_doubled(tmp_path: Path) -> None:
    """The truth is the manifest that a person wrote for the same files."""
    files = [str(file) for file in sorted(DEMO.glob("CI.CLC*"))]
    code, out = say(tmp_path, "add", *files, "--site", "mine")
    assert code == 0, out
    assert "0.535" in out, "the larger horizontal peak by full removal of the response, in g"
    (record,) = load_manifest(tmp_path / "mine").level[0].record
    demo = load_manifest(DEMO).level[0].record[0]
    assert record.components == demo.components
    assert sorted(record.sha256.values()) == sorted(demo.sha256.values())
    assert (record.processed, record.units, record.vertical) == (False, None, None)
    assert record.station is not None
    assert (record.station.code, record.station.latitude) == ("CI.CLC", 35.81574)
    assert (tmp_path / "mine" / "added.html").is_file()
    before = digest(tmp_path / "mine")
    code, out = say(tmp_path, "add", *files, "--site", "mine", "--json")
    assert code == 0
    answer = json.loads(out)
    assert (answer["added"], [one["record"] for one in answer["already"]]) == ([], [record.name])
    assert digest(tmp_path / "mine") == before


def test_what_nothing_says_is_named_all_at_once_and_nothing_is_written(tmp_path: Path) -> None:
    files = [str(file) for file in three(tmp_path / "new")]
    code, out = say(tmp_path, "add", *files, "--site", "mine")
    assert code == 2
    for option in ("--unit UNIT", "--orientation HN1=... --orientation HN2=...", "--raw or --processed", "3 answers"):
        assert option in out
    assert not (tmp_path / "mine").exists()
    words = ["--unit", "m/s2", "--orientation", "HN1=23", "--orientation", "HN2=113", "--processed"]
    code, out = say(tmp_path, "add", *files, "--site", "mine", *words, "--name", "By hand", "--level", "rare")
    assert code == 0, out
    manifest = load_manifest(tmp_path / "mine")
    (record,) = manifest.level[0].record
    assert (manifest.level[0].name, record.name, record.units, record.processed) == ("rare", "By hand", "m/s2", True)
    said = {key: (one.axis, one.orientation) for key, one in record.components.items()}
    assert said == {"HN2": ("x", 113.0), "HN1": ("y", 23.0), "HNZ": ("z", "up")}
    # The tones as they were written, turned to east and north by the azimuths that were given.
    (motion,) = read_motion(tmp_path / "mine")
    one, two, up = (trace(name).data for name in ("HN1", "HN2", "HNZ"))
    a, b = radians(23.0), radians(113.0)
    wanted = np.array([one * sin(a) + two * sin(b), one * cos(a) + two * cos(b), up])
    np.testing.assert_allclose(motion.acceleration, wanted, atol=1e-9)


@pytest.mark.long("cli/test_guess_asks::test_a_terminal_is_asked")
def test_a_terminal_is_asked_at_most_three_things(tmp_path: Path) -> None:
    files = [str(file) for file in three(tmp_path / "new")]
    ours, theirs = os.openpty()
    command = [sys.executable, "-c", "from pipeline.cli import main; main()", "-q", "motions", "add", *files]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).resolve().parents[2]), "TERM": "dumb"}
    job = subprocess.Popen(
        [*command, "--site", "mine"], cwd=tmp_path, env=environment, stdin=theirs, stdout=theirs, stderr=theirs
    )
    os.close(theirs)
    seen, answered, until = "", 0, time.monotonic() + 150.0
    answers = [
        ("or their unit", "furlong"),
        ("is not one of", "m/s2"),
        ("filtered", "processed"),
        ("oriented", "0 90"),
    ]
    while time.monotonic() < until:
        if select.select([ours], [], [], 0.2)[0]:
            try:
                more = os.read(ours, 4096).decode(errors="replace")
            except OSError:
                break
            if not more:
                break
            seen += more
            if answered < len(answers) and answers[answered][0] in seen and seen.rstrip().endswith(":"):
                seen = ""
                os.write(ours, f"{answers[answered][1]}\n".encode())
                answered += 1
    assert (job.wait(60), answered) == (0, 4), seen
    os.close(ours)
    (record,) = load_manifest(tmp_path / "mine").level[0].record
    assert (record.units, record.processed) == ("m/s2", True)
    assert {key: one.orientation for key, one in record.components.items()} == {"HN1": 0.0, "HN2": 90.0, "HNZ": "up"}


OWN = """# Who looks after this site.

[site]   # the museum
name = "Museum"
latitude = 35.0  # by the map
longitude = -117.0

# The level that the engineer chose.
[[level]]
name = "design"  # 475 years
combine = "max"
approved_by = "A. Engineer"  # by letter
approved_on = 2026-01-02

# The first record.
[[level.record]]
name = "first"
files = ["first/HN1.mseed", "first/HN2.mseed", "first/HNZ.mseed"]  # as they came
units = "m/s2"
processed = true
source = "a test"
licence = "none"
[level.record.components]
HN1 = { axis = "x", orientation = 90 }  # by compass
HN2 = { axis = "y", orientation = 0 }
HNZ = { axis = "z", orientation = "up" }
[level.record.sha256]
FIRST

[[floor]]  # upstairs
name = "1"
height_ratio = 0.5
# The end.
"""


def own(folder: Path) -> Path:
    folder.mkdir()
    files = three(folder / "first", station="OLD")
    sums = "\n".join(f'"first/{f.name}" = "{hashlib.sha256(f.read_bytes()).hexdigest()}"' for f in files)
    (folder / "manifest.toml").write_text(OWN.replace("FIRST", sums), encoding="utf-8")
    load_manifest(folder)
    return folder


KNOWN = ("--unit", "m/s2", "--orientation", "HN1=90", "--orientation", "HN2=0", "--processed")


def test_comments_stay_and_an_approval_does_not(tmp_path: Path) -> None:
    folder = own(tmp_path / "mine")
    before = (folder / "manifest.toml").read_text(encoding="utf-8")
    files = [str(file) for file in three(tmp_path / "new")]
    code, out = say(tmp_path, "add", *files, "--site", "mine", *KNOWN)
    assert code == 0, out
    assert "No longer approved (A. Engineer, 2026-01-02)" in out
    assert "as it was" in out, "what it was is compared"
    after = (folder / "manifest.toml").read_text(encoding="utf-8")
    comments = [line.partition("#")[2] for line in before.splitlines() if "#" in line and "by letter" not in line]
    left = iter(after.splitlines())
    assert all(any(comment in line for line in left) for comment in comments), "each, and in their order"
    manifest = load_manifest(folder)
    (level,) = manifest.level
    assert [record.name for record in level.record] == ["first", "XX.ONE 2020-01-02 03:04"]
    assert (level.approved_by, level.approved_on, manifest.floor[0].name) == ("", None, "1")
    # Another level keeps its approval; where there are two, nobody guesses which is meant.
    more = [str(file) for file in three(tmp_path / "more", station="TWO")]
    assert say(tmp_path, "add", *more, "--site", "mine", *KNOWN, "--level", "rare", "--no-compare")[0] == 0
    last = [str(file) for file in three(tmp_path / "last", station="LAST")]
    code, out = say(tmp_path, "add", *last, "--site", "mine", *KNOWN)
    assert (code, "--level NAME" in out, "(design, rare)" in out) == (2, True, True)
    code, out = say(tmp_path, "add", *more, "--site", "mine", *KNOWN, "--level", "design")
    assert (code, "has this record already" in out) == (4, True)


def test_a_record_that_is_refused_leaves_everything_as_it_was(tmp_path: Path) -> None:
    folder = own(tmp_path / "mine")
    files = [str(file) for file in three(tmp_path / "new")]
    dead = trace("HN1", station="DEAD")
    dead.data[:] = 1.0
    broken = three(tmp_path / "dead", station="DEAD")
    dead.write(str(broken[0]), format="MSEED")
    before = digest(tmp_path)
    code, out = say(tmp_path, "add", *files, *map(str, broken), "--site", "mine", *KNOWN)
    assert (code, "is dead" in out, digest(tmp_path) == before) == (4, True, True), out
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]
    code, out = say(tmp_path, "add", *files, *map(str, broken), "--site", "mine", *KNOWN, "--guess", "--no-compare")
    assert (code, "left: " in out, "is dead" in out) == (0, True, True)
    assert len(load_manifest(folder).level[0].record) == 2


def test_names_from_outside_stay_inside_and_overwrite_nothing(tmp_path: Path) -> None:
    """Files of one name from two folders, a link, and names that steer a terminal or climb out."""
    for number, parent in enumerate(("a", "b")):
        three(tmp_path / parent, station=f"S{number}")
    bad = tmp_path / "bad"
    files = three(bad, station="S9")
    evil = [bad / "..\\..\\x\x1b[31m.mseed", bad / "-rf .mseed", bad / f"{'long' * 40}.mseed"]
    for file, name in zip(files, evil, strict=True):
        file.rename(name)
    (tmp_path / "links").mkdir()
    for name in ("HN1", "HN2", "HNZ"):
        trace(name, station="S5").write(str(tmp_path / "links" / f"real{name}"), format="MSEED")
        (tmp_path / "links" / f"{name}.mseed").symlink_to(tmp_path / "links" / f"real{name}")
    given = [str(p) for folder in ("a", "b") for p in sorted((tmp_path / folder).iterdir())]
    given += [*map(str, evil), *(str(p) for p in sorted((tmp_path / "links").glob("*.mseed")))]
    code, out = say(tmp_path, "add", *given, "--site", "mine", *KNOWN, "--no-compare")
    assert code == 0, out
    assert "\x1b" not in out
    records = load_manifest(tmp_path / "mine").level[0].record
    assert len(records) == 4
    for record in records:
        for name, wanted in record.sha256.items():
            file = tmp_path / "mine" / name
            assert file.resolve().is_relative_to((tmp_path / "mine").resolve())
            assert not file.is_symlink()
            assert hashlib.sha256(file.read_bytes()).hexdigest() == wanted
            assert len(file.name) <= 120
    assert not (tmp_path / "x").exists()


def test_the_network_s_files_name_station_earthquake_and_distance(tmp_path: Path) -> None:
    """Two stations in one MiniSEED with velocity sensors, one StationXML, QuakeML and ComCat's GeoJSON among them."""
    east, down = ("HN1", 80.0, 0.0), ("HNZ", 0.0, 90.0)
    seismometers = [("HHE", 90.0, 0.0), ("HHN", 0.0, 0.0), ("HHZ", 0.0, -90.0)]
    places = {"ONE": (35.0, -117.0), "TWO": (36.0, -118.0)}
    channels = [east, ("HN2", 350.0, 0.0), down, *seismometers]
    network = Network("XX", [station(code, *at, channels) for code, at in places.items()], description="Test network")
    Inventory([network], source="a test").write(str(tmp_path / "anything.dat"), format="STATIONXML")
    stream = Stream()
    for code in places:
        for channel, _, _ in channels:
            one = trace(channel, station=code)
            one.data = np.round(1e5 * one.data).astype(np.int32)
            stream.append(one)
    stream.write(str(tmp_path / "all.mseed"), format="MSEED")
    right = Event(event_descriptions=[EventDescription("Right one")])
    right.origins = [Origin(time=ORIGIN, latitude=35.5, longitude=-117.5, depth=8000.0)]
    right.magnitudes = [Magnitude(mag=6.1, magnitude_type="Mw")]
    Catalog([right]).write(str(tmp_path / "e.xml"), format="QUAKEML")
    wrong = {"mag": 8.0, "magType": "mww", "place": "elsewhere", "time": (ORIGIN - 86_400.0).timestamp * 1000.0}
    feature = {"type": "Feature", "id": "us1", "properties": wrong,
               "geometry": {"type": "Point", "coordinates": [-117.0, 35.0, 5.0]}}  # fmt: skip
    (tmp_path / "q.json").write_text(json.dumps(feature), encoding="utf-8")
    words = ["all.mseed", "anything.dat", "e.xml", "q.json", "--site", "mine", "--no-compare"]
    code, out = say(tmp_path, "add", *words)
    assert code == 0, out
    records = load_manifest(tmp_path / "mine").level[0].record
    assert [record.name for record in records] == ["Right one M6.1, XX.ONE", "Right one M6.1, XX.TWO"]
    for record, (latitude, longitude) in zip(records, places.values(), strict=True):
        assert set(record.components) == {f"{record.station.code}..{c}" for c in ("HN1", "HN2", "HNZ")}
        assert [one.orientation for one in record.components.values()] == [80.0, 350.0, "down"]
        assert (record.event.magnitude, record.event.depth_km, record.processed) == (6.1, 8.0, False)
        # Haversine on a sphere: within 0.6 % of the ellipsoid.
        a, b = radians(latitude), radians(35.5)
        h = sin((a - b) / 2) ** 2 + cos(a) * cos(b) * sin(radians(longitude + 117.5) / 2) ** 2
        assert record.distance_km == pytest.approx(2 * degrees(asin(sqrt(h))) * 111.19493, rel=0.006)
        assert "Test network" in record.source
    assert len({name for record in records for name in record.files}) == 1, "the file of both is there once"
    assert all(f"left: XX.{code}..HH: another instrument of the same station" in out for code in places)
    # Out again, and in: what the manifest says is what comes back.
    code, out = say(tmp_path, "export", "mine", "--quakeml", "out.xml", "--geojson", "out.geojson")
    assert code == 0, out
    for name in ("out.xml", "out.geojson"):
        back = Catalogues()
        assert back.take(tmp_path / name)
        (event,) = back.events
        for key in ("time", "latitude", "longitude", "depth_km", "magnitude", "magnitude_type", "name"):
            assert getattr(event, key) == getattr(records[0].event, key), key
    assert {code: (s.latitude, s.longitude) for code, s in back.stations.items()} == {
        f"XX.{code}": at for code, at in places.items()
    }
    # Nobody has said where the site is: zero north, zero east would come back as if somebody had.
    assert back.site == []
    manifest = tmp_path / "mine" / "manifest.toml"
    manifest.write_text(
        manifest.read_text(encoding="utf-8").replace("latitude = 0.0", "latitude = -0.2", 1), encoding="utf-8"
    )
    code, out = say(tmp_path, "export", "mine", "--geojson", "said.geojson")
    assert code == 0, out
    back = Catalogues()
    assert back.take(tmp_path / "said.geojson")
    assert (back.site[0].name, back.site[0].latitude, back.site[0].longitude) == ("mine", -0.2, 0.0)


def test_a_place_on_the_equator_or_the_meridian_is_a_place(tmp_path: Path) -> None:
    code, out = say(
        tmp_path,
        "add",
        str(DEMO),
        "--site",
        "mine",
        "--no-compare",
        "--latitude",
        "51.5",
        "--longitude",
        "0",
        "--dry-run",
    )
    assert code == 0, out
    assert "nobody has said where the site is" not in out


def at2(file: Path, title: str, data: np.ndarray) -> None:
    head = ["PEER NGA STRONG MOTION DATABASE RECORD", title, "ACCELERATION TIME SERIES IN UNITS OF G"]
    lines = [*head, f"NPTS=  {data.size}, DT=   .0100 SEC", *(" ".join(f"{v:.7E}" for v in data[i : i + 5])
                                                            for i in range(0, data.size, 5))]  # fmt: skip
    file.write_text("\n".join(lines) + "\n", encoding="ascii")


def test_a_download_of_peer_is_a_site_with_a_word_for_each_record(tmp_path: Path) -> None:
    folder = tmp_path / "PEERNGARecords_Unscaled"
    folder.mkdir()
    rows = []
    for number, (event, scale) in enumerate([("Loma Prieta", 1.5), ("Kobe, Japan", 1.0), ("Landers", 2.0)], start=700):
        names = []
        for direction in ("090", "360", "UP"):
            name = f"RSN{number}_X_ST{number}{direction}.AT2"
            at2(folder / name, f"{event}, 1/1/1990, Station {number}, {direction.lstrip('0') or 0}", 0.1 * tone(1500))
            names.append(name)
        (folder / names[0]).with_suffix(".VT2").write_text("velocity", encoding="ascii")
        rows.append(f'{number},1,{scale},-,1,5,10,"{event}",1990,"Station {number}",6.{number % 10},reverse,'
                    f"10.0,1{number % 10}.5,300.0,0.1, {names[0]}, {names[1]}, {names[2]}")  # fmt: skip
    head = ("Record Sequence Number, MSE, Scale Factor, Tp-Pulse (sec), Arias Intensity (m/sec), 5-75% Duration (sec),"
            "5-95% Duration (sec), Earthquake Name, Year, Station Name, Magnitude, Mechanism, Rjb (km), Rrup (km),"
            "Vs30 (m/sec), Lowest Useable Frequency (Hz), Horizontal-1 Acc. Filename, Horizontal-2 Acc. Filename,"
            "Vertical Acc. Filename")  # fmt: skip
    table = ["PEER NGA West2 search", "", " -- Summary of Metadata --", head, *rows, "", "These records are unscaled"]
    (folder / "_SearchResults.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
    (folder / "RSN702_X_ST702090.AT2").write_text("cut off", encoding="ascii")
    code, out = say(tmp_path, "add", str(folder), "--site", "mine", "--guess")
    assert code == 0, out
    records = load_manifest(tmp_path / "mine").level[0].record
    assert [(r.name, r.scale, r.event.magnitude, r.distance_km, r.processed, r.vertical) for r in records] == [
        ("Loma Prieta 1990, Station 700 (RSN 700)", 1.5, 6.0, 10.5, True, None),
        ("Kobe, Japan 1990, Station 701 (RSN 701)", None, 6.1, 11.5, True, None),
        # Of the third, one horizontal cannot be read.
    ]
    assert "RSN702_X_ST702090.AT2" in out
    assert "a velocity; the acceleration is what is read" in out
    tables = tomllib.loads((tmp_path / "mine" / "manifest.toml").read_text(encoding="utf-8"))
    assert [[c["orientation"] for c in r["components"].values()] for r in tables["level"][0]["record"]] == [
        [90.0, 0.0, "up"]
    ] * 2


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.zip", b"PK\x05\x06" + bytes(18), "is an archive: unpack it"),
        ("e.xml", b'<!DOCTYPE q [<!ENTITY a "b">]><quakeml>&a;</quakeml>', "declares entities"),
        ("e.xml", b'<?xml version="1.0"?><quakeml><', "is no QuakeML"),
        ("s.xml", b'<?xml version="1.0"?><FDSNStationXML><', "is no StationXML"),
        ("q.json", b'{"type": "Feature", "properties": {', "is no JSON"),
        ("q.json", b'{"type":"Feature","properties":{"mag":99,"time":1},'
         b'"geometry":{"type":"Point","coordinates":[1,2]}}',
         "features[0].magnitude: Input should be less than or equal to 10"),
        ("x.bin", b"\x00\x01", "is of no format that is known; it is no text"),
    ],
)  # fmt: skip
def test_what_is_no_record_is_named_with_its_reason(tmp_path: Path, name: str, content: bytes, told: str) -> None:
    (tmp_path / name).write_bytes(content)
    code, out = say(tmp_path, "add", name, "--site", "mine")
    assert (code, told in out, (tmp_path / "mine").exists()) == (4, True, False), out


def test_an_agency_s_record_brings_all_that_it_needs(tmp_path: Path) -> None:
    """Files of three formats at once; what the agency prints of Coalinga 1983 (CE36456) is 0.27 g."""
    files = [SUITE / "0111a.smc", SUITE / "0111b.smc", SUITE / "0111c.smc", SUITE / "ce36456p_CE36456.V2"]
    code, out = say(tmp_path, "add", *map(str, files), "--site", "mine", "--json", "--dry-run")
    assert code == 0, out
    assert not (tmp_path / "mine").exists()
    code, out = say(tmp_path, "add", *map(str, files), "--site", "mine", "--json", "--no-compare")
    assert code == 0, out
    added = {one["name"]: one for one in json.loads(out)["added"]}
    # Named as the headers name the earthquake and the station.
    coalinga = "Coalinga Earthquake M6.5, PARKFIELD FAULT ZONE 14"
    assert set(added) == {"Loma Prieta, CA M7.1, San Francisco, 1295 Shafter, F", coalinga}
    assert added[coalinga]["pga"] / 9.80665 == pytest.approx(0.273, abs=0.005)
    motions = read_motion(tmp_path / "mine")
    assert len(motions) == 2
