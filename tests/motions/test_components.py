"""Components of a record are of one earthquake at one instrument, oriented as their station says."""

import hashlib
from pathlib import Path

import numpy as np
import obspy
import pytest
from obspy.core.inventory import Channel, Inventory, Network, Response, Site, Station

from pipeline.motions import MotionError, read_motion
from pipeline.motions.inspection import inspect
from pipeline.motions.joining import check_together

from .conftest import tone

START = obspy.UTCDateTime(2020, 1, 1)


def refused(folder, *words):
    with pytest.raises(MotionError) as caught:
        read_motion(folder)
    for word in words:
        assert word in str(caught.value)
    assert caught.value.judgement == "mixed"


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ({"station": "OTHER"}, ("station 'TEST' and 'OTHER'",)),
        ({"network": "YY"}, ("network 'XX' and 'YY'",)),
        ({"location": "10"}, ("location code '--' and '10'",)),
        ({"channel": "BNN"}, ("band and instrument code 'HN' and 'BN'",)),
    ],
)
def test_another_instrument_is_refused_with_both_files(three, write_trace, write_manifest, header, words):
    three()
    write_trace("n.mseed", tone(amplitude=2.0), **({"channel": "HNN"} | header))
    refused(write_manifest(), "e.mseed", "n.mseed", "do not belong together", *words)
    (motion,) = read_motion(write_manifest(accept={"mixed": "the code was changed that year"}))
    assert any("accepted: the code was changed that year" in step for step in motion.steps)


def test_less_than_most_of_the_time_in_common_is_refused(three, write_trace, write_manifest):
    """Two records of 40 s, one of them 15 s later: 25 s in common may be two earthquakes."""
    three()
    write_trace("n.mseed", tone(amplitude=2.0), "HNN", starttime=obspy.UTCDateTime(15))
    refused(write_manifest(), "e.mseed", "n.mseed", "only 24.99 s in common")
    (motion,) = read_motion(write_manifest(accept={"mixed": "one clock", "cut_off": "a tone", "drift": "a part of it"}))
    assert motion.samples == 2500
    (part,) = read_motion(write_manifest(window_s=[0.0, 20.0], accept={"cut_off": "a tone", "drift": "a part of it"}))
    assert part.samples == 2001


def knet(path, direction, *, origin="2018/01/24 19:51:00", station="AOM002", height=20, data=None):
    data = np.round(10000 * tone(3000)).astype(int) if data is None else data
    head = [
        f"Origin Time       {origin}", "Lat.              41.0", "Long.             142.4", "Depth. (km)       34",
        "Mag.              6.2", f"Station Code      {station}", "Station Lat.      41.1", "Station Long.     141.0",
        f"Station Height(m) {height}", "Record Time       2018/01/24 19:51:41", "Sampling Freq(Hz) 100Hz",
        "Duration Time(s)  30", f"Dir.              {direction}", "Scale Factor      2000(gal)/2000000",
        "Max. Acc. (gal)   10.0", "Last Correction   2018/01/24 19:51:30", "Memo.",
    ]  # fmt: skip
    rows = [" ".join(f"{v:9d}" for v in data[i : i + 8]) for i in range(0, len(data), 8)]
    path.write_text("\n".join(head + rows) + "\n")


def kiknet(folder, write_manifest, *, up="6", **changes):
    for name, direction in (("a.NS2", "4"), ("a.EW2", "5")):
        knet(folder / name, direction)
    knet(folder / "a.UD", up, **changes)
    components = {
        "a.EW2": {"axis": "x", "orientation": 90},
        "a.NS2": {"axis": "y", "orientation": 0},
        "a.UD": {"axis": "z", "orientation": "up"},
    }
    return write_manifest(files=["a.EW2", "a.NS2", "a.UD"], components=components, units=None)


def test_the_borehole_does_not_join_the_surface(tmp_path, write_manifest):
    (motion,) = read_motion(kiknet(tmp_path, write_manifest))
    assert motion.acceleration[2].any()
    refused(kiknet(tmp_path, write_manifest, up="3"), "a.EW2", "a.UD", "sensor 'at the surface' and 'in the borehole'")
    refused(kiknet(tmp_path, write_manifest, height=-230), "sensor's height 20 and -230")


def test_two_earthquakes_of_one_station_are_refused(tmp_path, write_manifest):
    refused(kiknet(tmp_path, write_manifest, origin="2018/01/24 19:49:55"), "a.EW2", "a.UD", "earthquake of 2018-01-24")


def test_a_magnitude_that_the_header_brought_raises_no_corner(tmp_path, write_manifest, monkeypatch):
    """By its magnitude of 3 a small source would take the corner up, and the motion be weaker; a person may say so."""
    monkeypatch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 2)
    files = {"a.EW": ("E-W", "x", 90), "a.NS": ("N-S", "y", 0), "a.UD": ("U-D", "z", "up")}
    for name, (direction, _, _) in files.items():
        knet(tmp_path / name, direction)
        head = (tmp_path / name).read_text()
        (tmp_path / name).write_text(head.replace("Mag.              6.2", "Mag.              3.0"))
    components = {name: {"axis": axis, "orientation": way} for name, (_, axis, way) in files.items()}
    corners = {}
    for said in (None, 3.0, 3.1):
        event = None if said is None else {"magnitude": said}
        made = {"files": list(files), "components": components, "units": None, "processed": False, "event": event}
        (looked,) = inspect(write_manifest(**made))
        corners[said] = looked.corners[0]
    assert corners[3.0] == corners[None]
    assert corners[3.1] > corners[None]


def told_otherwise(header, **changes):
    said = {"event_time": START, "event_latitude": 41.0, "event_longitude": 142.4, "event_name": "Off Aomori"} | changes
    header.stats.kouros = obspy.core.AttribDict({"units": "m/s2"} | said)
    return (None, header, header.stats.channel)


@pytest.mark.parametrize(
    ("changes", "differs"),
    [
        # Two solutions of one earthquake, 30 s and, by the length of a degree of 111 km, 11 km apart.
        ({"event_time": START + 30.0, "event_latitude": 41.1, "event_name": "AOMORI-KEN TOHO-OKI"}, ""),
        ({"event_time": START + 59.0, "event_name": ""}, ""),
        ({"event_time": START + 61.0}, "earthquake of"),
        # 1 degree of latitude: another earthquake of the same minute.
        ({"event_latitude": 42.0}, "epicentre's latitude"),
        # Without a time on both sides, the names are all there is.
        ({"event_time": None, "event_name": "Off Iwate"}, "earthquake 'Off Aomori'"),
    ],
)
def test_earthquakes_are_compared_by_time_and_place_and_not_by_their_names(changes, differs):
    made = [obspy.Trace(tone(), {"network": "XX", "station": "S", "channel": c}) for c in ("HNE", "HNN")]
    rows = {"x": told_otherwise(made[0]), "y": told_otherwise(made[1], **changes)}
    rows = {axis: (Path(f"{axis}.asc"), trace, key) for axis, (_, trace, key) in rows.items()}
    steps = []
    if differs:
        with pytest.raises(MotionError, match=differs):
            check_together(rows, None, {}, steps)
        return
    check_together(rows, None, {}, steps)
    assert any("tell one earthquake in two ways" in step for step in steps), "by other names, or other seconds"


def at2(path, title, data):
    rows = "\n".join(" ".join(f"{v: .7E}" for v in data[i : i + 5]) for i in range(0, len(data), 5))
    head = f"PEER NGA STRONG MOTION DATABASE RECORD\n{title}\nACCELERATION TIME SERIES IN UNITS OF G\n"
    path.write_text(f"{head}NPTS=  {len(data)}, DT=   .0100 SEC\n{rows}\n")


def test_two_earthquakes_by_the_titles_of_their_files(tmp_path, write_manifest):
    """AT2 files tell no time; their titles end in the component's direction, and say the earthquake before it."""
    for name, way in (("a", "090"), ("b", "000"), ("c", "UP")):
        at2(tmp_path / f"{name}.at2", f"Imperial Valley-06, 10/15/1979, El Centro Array #6, {way}", 0.1 * tone(3000))
    components = {f"{n}.at2": {"axis": a} for n, a in (("a", "x"), ("b", "y"), ("c", "z"))}
    wanted = {"files": list(components), "components": components, "units": None}
    assert read_motion(write_manifest(**wanted))
    at2(tmp_path / "b.at2", "Imperial Valley-07, 10/15/1979, El Centro Array #6, 000", 0.1 * tone(3000))
    refused(write_manifest(**wanted), "a.at2", "b.at2", "title 'Imperial Valley-06", "'Imperial Valley-07")


def station(path, ways, *, depth=None):
    """A StationXML of accelerometers of 1,000 counts in 1 m/s2; ways: code -> list of (azimuth, dip, from year)."""
    made = []
    for code, epochs in ways.items():
        for azimuth, dip, year in epochs:
            response = Response.from_paz(
                zeros=[], poles=[], stage_gain=1000.0, input_units="M/S**2", output_units="COUNTS"
            )
            made.append(
                Channel(
                    code, "", 34.0, -118.0, 0.0, (depth or {}).get(code, 0.0), azimuth=azimuth, dip=dip,
                    sample_rate=100.0, response=response, start_date=obspy.UTCDateTime(year, 1, 1),
                    end_date=obspy.UTCDateTime(year + 10, 1, 1),
                )
            )  # fmt: skip
    one = Station("TEST", 34.0, -118.0, 0.0, channels=made, site=Site("test"))
    Inventory([Network("XX", [one])], "test").write(str(path), format="STATIONXML")


def counts(tmp_path, write_trace, write_manifest, ways, *, orientations=None, depth=None, **changes):
    """A record in counts, x of amplitude 1 and y of amplitude 2, whose manifest states only what is given."""
    given = orientations or {}
    codes = dict(zip("xyz", ways, strict=True))
    for axis, code in codes.items():
        data = 1000.0 * tone(amplitude={"x": 1.0, "y": 2.0, "z": 0.5}[axis])
        write_trace(f"{axis}.mseed", data, code, starttime=START)
    station(tmp_path / "s.xml", ways, depth=depth)
    components = {code: {"axis": axis} | given.get(axis, {}) for axis, code in codes.items()}
    files = [f"{axis}.mseed" for axis in "xyz"]
    sums = {n: hashlib.sha256((tmp_path / n).read_bytes()).hexdigest() for n in (*files, "s.xml")}
    wanted = {"files": files, "components": components, "response": "s.xml", "units": None, "processed": False}
    return write_manifest(**wanted, sha256=sums, baseline={"method": "none"}, highpass_hz="none", **changes)


def epoch(*rows):
    return {code: [(azimuth, dip, 2015)] for code, azimuth, dip in rows}


def test_the_stationxml_orients_what_the_manifest_does_not(tmp_path, write_trace, write_manifest):
    """Sensors at 23 and 113 degrees: east is the sum of what both see of it, by geometry."""
    ways = epoch(("HN1", 23.0, 0.0), ("HN2", 113.0, 0.0), ("HNZ", 0.0, -90.0))
    (motion,) = read_motion(counts(tmp_path, write_trace, write_manifest, ways))
    east = np.sin(np.radians(23)) * tone() + np.sin(np.radians(113)) * tone(amplitude=2.0)
    # The taper of the removal leaves a 1 Hz tone alone to 1e-3.
    np.testing.assert_allclose(motion.acceleration[0], east, atol=5e-3)
    assert "HN1: orientation 23.0, by the StationXML" in motion.steps
    assert "HNZ: orientation up, by the StationXML" in motion.steps
    ways["HNZ"] = [(0.0, 90.0, 2015)]
    (down,) = read_motion(counts(tmp_path, write_trace, write_manifest, ways))
    np.testing.assert_allclose(down.acceleration[2], -motion.acceleration[2], atol=1e-9)


def test_the_epoch_is_that_of_the_record(tmp_path, write_trace, write_manifest):
    ways = epoch(("HN1", 23.0, 0.0), ("HN2", 113.0, 0.0), ("HNZ", 0.0, -90.0))
    ways["HN1"] = [(0.0, 0.0, 2000), (23.0, 0.0, 2015)]
    (motion,) = read_motion(counts(tmp_path, write_trace, write_manifest, ways))
    assert "HN1: orientation 23.0, by the StationXML" in motion.steps
    ways["HN1"] = [(0.0, 0.0, 2000)]
    with pytest.raises(MotionError, match="says nothing about"):
        read_motion(counts(tmp_path, write_trace, write_manifest, ways))
    ways["HN1"] = [(0.0, 0.0, 2014), (23.0, 0.0, 2015)]
    with pytest.raises(MotionError, match=r"says different things about .*azimuth 0\.0, dip 0\.0 and azimuth 23\.0"):
        read_motion(counts(tmp_path, write_trace, write_manifest, ways))


def test_the_manifest_may_overrule_the_stationxml_and_says_so(tmp_path, write_trace, write_manifest):
    ways = epoch(("HN1", 23.0, 0.0), ("HN2", 113.0, 0.0), ("HNZ", 0.0, -90.0))
    own = {"x": {"orientation": 90}, "y": {"orientation": 0}, "z": {"orientation": "up"}}
    folder = counts(tmp_path, write_trace, write_manifest, ways, orientations=own)
    with pytest.raises(MotionError, match=r"manifest orients it 90\.0, the StationXML 23\.0") as told:
        read_motion(folder)
    assert told.value.judgement == "orientation"
    accept = {"orientation": "turned in 2019, and the station's file is late"}
    (motion,) = read_motion(counts(tmp_path, write_trace, write_manifest, ways, orientations=own, accept=accept))
    assert "HN1: the manifest's orientation 90.0 overrules the StationXML's 23.0" in motion.steps
    np.testing.assert_allclose(motion.acceleration[0], tone(), atol=5e-3)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ((("HN1", 23.0, 0.0), ("HN2", 82.0, 0.0), ("HNZ", 0.0, -90.0)), "23 and 82 are 31 degrees off a right angle"),
        ((("HN1", 23.0, -60.0), ("HN2", 113.0, 0.0), ("HNZ", 0.0, -90.0)), "a dip of -60 degrees"),
        ((("HN1", 23.0, 0.0), ("HN2", 113.0, 0.0), ("HNZ", 0.0, -54.7)), "a dip of -54.7 degrees"),
        (
            (("HN1", 23.0, 0.0), ("HN2", 0.0, -90.0), ("HNZ", 0.0, -90.0)),
            "a dip of -90 degrees, which is no component y",
        ),
    ],
)
def test_what_is_no_component_is_refused(tmp_path, write_trace, write_manifest, rows, words):
    with pytest.raises(MotionError, match=words):
        read_motion(counts(tmp_path, write_trace, write_manifest, epoch(*rows)))


@pytest.mark.parametrize("second", [91.0, 98.0, 81.0, 279.0])
def test_a_skew_is_undone_and_told(tmp_path, write_trace, write_manifest, second):
    """Sensors at 0 degrees and another azimuth that see a shaking along north alone."""
    ways = epoch(("HN1", 0.0, 0.0), ("HN2", second, 0.0), ("HNZ", 0.0, -90.0))
    folder = counts(tmp_path, write_trace, write_manifest, ways)
    for axis, seen in (("x", 1.0), ("y", np.cos(np.radians(second)))):
        write_trace(f"{axis}.mseed", 1000.0 * seen * tone(), "HN1" if axis == "x" else "HN2", starttime=START)
    text = (folder / "manifest.toml").read_text()
    old = [text.split(f'"{axis}.mseed" = "')[1][:64] for axis in "xy"]
    for axis, digest in zip("xy", old, strict=True):
        text = text.replace(digest, hashlib.sha256((tmp_path / f"{axis}.mseed").read_bytes()).hexdigest())
    (folder / "manifest.toml").write_text(text)
    (motion,) = read_motion(folder)
    np.testing.assert_allclose(motion.acceleration[1], tone(), atol=5e-3)
    assert np.abs(motion.acceleration[0]).max() < 2e-3  # counts are whole, and a skew makes more of them
    told = any("degrees off a right angle" in step for step in motion.steps)
    assert told == (second != 91.0)


def test_the_depths_of_the_stationxml_must_agree(tmp_path, write_trace, write_manifest):
    ways = epoch(("HN1", 0.0, 0.0), ("HN2", 90.0, 0.0), ("HNZ", 0.0, -90.0))
    refused(
        counts(tmp_path, write_trace, write_manifest, ways, depth={"HNZ": 100.0}), "x.mseed", "z.mseed",
        "sensor's depth 0 and 100",
    )  # fmt: skip
