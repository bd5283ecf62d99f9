"""National formats: side by side components, local times to UTC, what two agencies write differently, what is refused.

The truth is the series that a file was written from, and the header as it was written.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import entry_points

import numpy as np
import obspy
import pytest

from pipeline.motions import MotionError
from pipeline.motions.formats import NAMES, FormatError
from pipeline.motions.reading import open_traces
from tests.motions.formats import national
from tests.motions.formats import specimens as hand
from tests.motions.formats.every import SPECIMENS
from tests.motions.formats.specimens import tone

SIDE_BY_SIDE = {
    # name: orientations, and the amplitude of each in gal; half the last printed digit
    "cwa": (["up", 0.0, 90.0], [100.0, -50.0, 25.0], 5e-4),
    "nsmn": ([0.0, 90.0, "up"], [100.0, -50.0, 25.0], 5e-7),
    "unam": (["up", 90.0, 180.0], [100.0, -50.0, 25.0], 5e-4),
    "jma": ([0.0, 90.0, "up"], [100.0, -50.0, 25.0], 5e-4),
}
STARTS = {
    # Taiwan is eight hours before UTC, Japan nine, Beijing eight; the others say GMT.
    "cwa": ("2018-02-06T15:50:29", "record"),
    "nsmn": ("2017-07-20T22:30:58", "record"),
    "unam": ("2004-01-02T00:00:01", "record"),
    "jma": ("2016-04-14T12:26:20", "record"),
    "csmnc": ("2013-04-20T00:02:46", "earthquake"),
    "bhrc": ("2012-08-11T12:23:16", "earthquake"),
    "film": ("1994-01-17T12:31:04.1", "record"),
    "film-usc": ("1994-01-17T12:30:00", "earthquake"),
    "csmip-usc-v2": ("1994-01-17T12:30:00", "earthquake"),
}


@pytest.fixture
def written(tmp_path):
    def writing(content: bytes, name: str = "record"):
        (tmp_path / name).write_bytes(content)
        return tmp_path / name

    return writing


def traces(content: bytes, name: str):
    import io

    return import_module(f"pipeline.motions.formats.{name}").read_format(io.BytesIO(content))


@pytest.mark.parametrize("name", SIDE_BY_SIDE)
def test_side_by_side(written, name):
    orientations, amplitudes, digit = SIDE_BY_SIDE[name]
    stream = obspy.read(str(written(SPECIMENS[name][1]())))
    assert [trace.stats.kouros.orientation for trace in stream] == orientations
    for trace, amplitude in zip(stream, amplitudes, strict=True):
        assert (trace.stats.kouros.units, trace.stats.kouros.si_factor) == ("gal", 0.01)
        assert trace.stats.kouros.processed is False
        assert trace.stats.delta == pytest.approx(0.01, rel=1e-12)
        assert np.abs(trace.data - amplitude * tone()).max() <= 1.001 * digit


@pytest.mark.parametrize("unit", [b"(cm/s^2)", b"(cm/s2)   ", b"(Gal)   "])
def test_nsmn_names_the_unit_of_its_peaks_otherwise(unit):
    """As of 1302 Bitlis, 23 October 2011: 'RAW PGA VALUES (cm/s^2) :' and an earthquake that nobody had located yet."""
    content = national.nsmn().replace(b"(gal)   ", unit).replace(b"2017/07/20 22:31:09 (GMT)", b"20/07/2017")
    north, east, _ = traces(content, "nsmn")
    assert np.abs(north.data - 100.0 * tone()).max() <= 1e-6
    assert (east.stats.kouros.units, east.stats.kouros.si_factor) == ("gal", 0.01)
    assert "event_time" not in north.stats.kouros


@pytest.mark.parametrize("unit", [b"(g)     ", b"(m/s^2) ", b"(mg)    ", b"        "])
def test_nsmn_of_another_unit_is_refused(unit):
    with pytest.raises(FormatError, match=r"line 9: expected peaks in gal or cm/s\^2, found '\(N-S\) 100"):
        traces(national.nsmn().replace(b"(gal)   ", unit), "nsmn")


@pytest.mark.parametrize("name", STARTS)
def test_times_are_utc(name):
    when, of = STARTS[name]
    for trace in traces(SPECIMENS[name][1](), SPECIMENS[name][0]):
        assert trace.stats.starttime == obspy.UTCDateTime(when)
        assert trace.stats.kouros.start == of


def test_a_record_of_before_midnight_is_of_the_earthquakes_day():
    content = national.unam(clock="23:57:50")
    assert traces(content, "unam")[0].stats.starttime == obspy.UTCDateTime("2004-01-01T23:57:50")


def test_a_clock_that_was_never_set_tells_no_time():
    content = national.volume1().replace(b"01/17/94, 12:31:04.1 UTC", b"1/1/1980 0:00:00.000 GMT")
    assert {trace.stats.kouros.start for trace in traces(content, "volume1")} == {"unknown"}


def test_film_at_irregular_times_is_resampled():
    """On the straight lines between the samples of the tone, to what three decimals leave of time and value."""
    times = np.round(np.sort(np.concatenate([np.arange(0.0, 0.59, 0.007), [0.1234, 0.5]])), 3)
    (trace,) = traces(national.volume1("usc", ("N90E",), times), "volume1")
    assert trace.stats.delta == 0.005
    assert "resampled" in trace.stats.kouros
    given = np.interp(times, 0.01 * np.arange(60), tone())
    assert np.abs(trace.data - np.interp(trace.times(), times, given)).max() <= 5.01e-4


def test_rows_after_the_announced_ones_are_told():
    (first, *_) = traces(national.unam(extra=2), "unam")
    assert first.stats.npts == 60
    assert "2 rows after" in first.stats.kouros.notes


@pytest.mark.parametrize("rate", ["SAMPLING RATE= 100Hz", "Sampling Freq= 100Hz"])
@pytest.mark.parametrize("commas", ["", ",,,,,"])
def test_jma_as_its_years_differ(rate, commas):
    stream = traces(national.jma(rate, commas=commas), "jma")
    assert [trace.stats.npts for trace in stream] == [60, 60, 60]
    assert {trace.stats.station for trace in stream} == {"93051"}


@pytest.mark.parametrize(
    ("date", "utc"),
    [
        ("20190728_160919.870", "2019-07-28T16:09:19.87"),
        ("2023/02/06 01:17:36.776285", "2023-02-06T01:17:36.776285"),
        ("14/11/2010 23:09:19.300", "2010-11-14T23:09:19.3"),
    ],
)
def test_esm_and_afad_dates(date, utc):
    (trace,) = traces(hand.esm(DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS=date), "esm")
    assert trace.stats.starttime == obspy.UTCDateTime(utc)


@pytest.mark.parametrize(("corners", "processed"), [(("", ""), False), (("0.025", "40.0"), True), (("0.1", ""), True)])
def test_a_filter_without_corners_was_not_applied(corners, processed):
    content = hand.esm(LOW_CUT_FREQUENCY_HZ=corners[0], HIGH_CUT_FREQUENCY_HZ=corners[1], LOCATION="A_PLACE_OF_AFAD")
    (trace,) = traces(content, "esm")
    assert trace.stats.kouros.processed is processed
    assert trace.stats.location == ""


@pytest.mark.parametrize(
    ("head", "units", "orientations"),
    [
        ("time,acc_NS(gal)", ["gal"], [0.0]),
        ("Time(s),NS(gal),EW(gal),UD(gal)", ["gal", "gal", "gal"], [0.0, 90.0, "up"]),
        ("Time (s) acc_EW (m/s^2)", ["m/s2"], [90.0]),
        ("t;N-S [g];U-D [g]", ["g", "g"], [0.0, "up"]),
    ],
)
def test_heads_of_tables(written, head, units, orientations):
    separator = ";" if ";" in head else "," if "," in head else "  "
    rows = [separator.join([f"{0.01 * i:.2f}", *[f"{a:.6f}"] * len(units)]) for i, a in enumerate(tone())]
    stream = obspy.read(str(written("\n".join([head, *rows]).encode())))
    assert [trace.stats.kouros.units for trace in stream] == units
    assert [trace.stats.kouros.orientation for trace in stream] == orientations
    assert all(np.abs(trace.data - tone()).max() <= 5.01e-7 for trace in stream)


@pytest.mark.parametrize("separator", ["  ", ",", ";", "\t"])
@pytest.mark.parametrize("head", ["", "# by hand"])
def test_bare_columns_say_no_unit(written, separator, head):
    stream = obspy.read(str(written(national.columns(separator, head))))
    assert [trace.stats.npts for trace in stream] == [60, 60]
    for trace, factor in zip(stream, (1.0, -0.5), strict=True):
        said = trace.stats.kouros
        assert (said.units, said.si_factor, said.orientation, said.processed) == ("", None, None, None)
        assert np.abs(trace.data - factor * tone()).max() <= 5.01e-7


@pytest.mark.parametrize(
    "content",
    [b"1 2\n" * 50, b"5 1\n3 2\n4 1\n" * 9, b"0.0 1\n0.1 2\n", b"0 1 2 3 4\n1 1 2 3 4\n" * 9],
    ids=["still", "shuffled", "short", "wide"],
)
def test_other_columns_are_none(written, content):
    with pytest.raises(TypeError, match="Unknown format"):
        obspy.read(str(written(content)))


def test_cosmos_vertical_with_the_azimuth_of_stationxml():
    """Headers that were made from StationXML give a vertical its azimuth there, 0; the code says what it is."""
    content = hand.cosmos(2, azimuths=(0,)).replace(b"| by hand", b"|<SCNL>BMR.BNZ.AK.--")
    (trace,) = traces(content, "cosmos")
    assert trace.stats.kouros.orientation == "up"
    assert "BNZ" in trace.stats.kouros.notes
    with pytest.raises(FormatError, match="azimuth of 90, and the channel's code BNZ a vertical"):
        traces(
            content.replace(b"       0\r\n", b"      90\r\n").replace(b"       0    -999", b"      90    -999"),
            "cosmos",
        )


REFUSED = {
    # name: content, line, words
    "cwa": (national.cwa(rows=59), 74, "holds 59 rows, where the header announces 60"),
    "cwa peak": (national.cwa().replace(b"100.000~", b"250.000~"), 11, "2.5 m/s2, and the samples have 1 m/s2"),
    "nsmn": (national.nsmn(61), 73, "60 rows of acceleration, and line 7 says 61"),
    "nsmn peak": (national.nsmn().replace(b"(U-D) 25.0", b"(U-D) 24500.0"), 9, "245 m/s2, and the samples have 0.25"),
    "unam": (national.unam().replace(b"/60/60/60", b"/61/61/61"), 92, "183 values of acceleration are announced"),
    "unam factor": (national.unam(factor="2"), 21, "is decimated by '2'"),
    "unam long": (national.unam(extra=60) + national.unam(extra=60)[-4000:], 92, "the file goes on for"),
    "unam peak": (national.unam().replace(b"/100.00/", b"/0.10/"), 18, "0.001 m/s2, and the samples have 1 m/s2"),
    "jma unit": (national.jma(unit="mm/s"), 5, "expected UNIT= gal(cm/s/s)"),
    "jma row": (national.jma(commas="").replace(b"100.000,", b"100.000", 1), 8, "expected 3 numbers of acceleration"),
    "csmnc": (national.csmnc(count=61), 25, "60 of the 61 values"),
    "csmnc peak": (national.csmnc(peak="1.000"), 13, "0.01 m/s2, and the samples have 1 m/s2"),
    "csmnc kind": (national.csmnc().replace(b"ED ACCELERATION", b"ED VELOCITY    "), 11, "holds velocity"),
    "bhrc": (national.bhrc().replace(b"VOL1DS", b"VOL2DS", 1), 1, "of volume 2"),
    "bhrc rate": (national.bhrc(77), 11, "no whole number of samples per second"),
    "volume1": (national.volume1().replace(b"POINTS =  60", b"POINTS =  61", 1), 15, "announces 60 points"),
    "volume1 peak": (national.volume1().replace(b"=   .100 G", b"=   .900 G", 1), 12, "8.826 m/s2, and the"),
    "volume1 wide": (national.volume1().replace(b"  0.000  1.000", b" 0.000 1.000", 1), 28, "in fields of seven"),
    "csmip peak": (hand.csmip(1).replace(b"=  1.000 g", b"=   .002 g", 1), 12, "0.01961 m/s2, and the samples have"),
    "csmip corrected": (hand.csmip().replace(b"=   100.000    cm", b"=   981.000    cm", 1), 15, "9.81 m/s2, and the"),
    "csmip spectra": (b"RESPONSE AND FOURIER AMPLITUDE SPECTRA\n" + hand.csmip(), 1, "holds response and Fourier"),
    "esm peak": (hand.esm(**{"PGA_CM/S^2": "981.0"}), 11, "9.81 m/s2, and the samples have 1 m/s2"),
    "columns": (national.columns(head="").replace(b"\n0.30 ", b"\n0.34 "), 31, "go on by 0.05 s to 0.34 s"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    content, line, words = REFUSED[case]
    with pytest.raises(FormatError) as refusal:
        traces(content, case.split()[0])
    assert str(refusal.value).startswith(f"stream: line {line}: "), str(refusal.value)
    assert words in str(refusal.value), str(refusal.value)


def test_knet_gets_what_obspy_leaves_out(written):
    for direction, orientation in (("N-S", 0.0), ("E-W", 90.0), ("U-D", "up"), ("4", 0.0), ("3", "up")):
        (trace,) = open_traces(written(national.knet(direction)), [])
        said = trace.stats.kouros
        assert (said.orientation, said.processed, said.units) == (orientation, False, "counts")
        assert said.si_factor == pytest.approx(0.01 * 3920 / 6182761, rel=1e-12)
        assert ("borehole" in said.get("notes", "")) == (direction == "3")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (national.knet()[:-90], "announces 800 samples and holds 79"),
        (national.knet(peak="3000.000"), "announces a peak of 30 m/s2"),
    ],
)
def test_knet_refused(written, content, words):
    with pytest.raises(MotionError, match=words):
        open_traces(written(content), [])


def test_every_reader_is_an_entry_point_with_a_name():
    own = {point.name for point in entry_points(group="obspy.plugin.waveform") if point.value.startswith("pipeline.")}
    assert own == set(NAMES)


def test_an_unknown_file_is_told_what_is_read(written):
    with pytest.raises(MotionError) as refusal:
        open_traces(written(b"\nSome logger, 3 channels\nx,y,z\n1,2,3\n", "logger.txt"), [])
    said = str(refusal.value)
    assert "'Some logger, 3 channels'" in said
    assert all(name in said for name in NAMES.values())
    assert "kouros motions convert FILE --columns time,ns,ew,ud --unit gal" in said
    assert "--dt" in said


@pytest.mark.parametrize(
    ("content", "words"),
    [(b"\x1f\x8b\x08\0rest", r"packed \(gzip\); unpack it"), (b"  \n", "is empty"), (b"x\0" * 99, "it is no text")],
)
def test_unknown_files_that_are_no_text(written, content, words):
    with pytest.raises(MotionError, match=words):
        open_traces(written(content), [])


@pytest.mark.parametrize("every", [(1,), (1, 2, 5), (1, 1, 1)])
@pytest.mark.parametrize("unit", [True, False])
def test_usc_volume_2_as_its_older_files_are(every, unit):
    """The unit of the printed peak, channels that nothing closes, series that are coarser than their acceleration."""
    read = traces(national.usc2(("N08W", "UP"), every, unit), "csmip")
    assert [trace.stats.kouros.orientation for trace in read] == [352.0, "up"]
    for trace in read:
        said = trace.stats.kouros
        assert np.abs(trace.data - 100.0 * tone()).max() <= 5e-4
        assert (said.units, said.processed, said.peak.acceleration) == ("cm/s2", True, 1.0)
        assert ("velocity" in said) == (every == (1, 1, 1)) == ("displacement" in said)
        assert ("longer step" in said.get("notes", "")) == (every == (1, 2, 5))


def test_usc_volume_2_without_any_word_on_its_unit():
    with pytest.raises(FormatError, match=r"does not say the unit"):
        traces(national.usc2(("UP",), (1,), unit=False).replace(b"PEAK ACC", b"HIGH ACC"), "csmip")


@pytest.mark.parametrize("write", [national.usc2, lambda names: national.volume1("usc", names)])
def test_files_of_one_channel_each_differ_by_what_they_are_called(tmp_path, write):
    """The USC's files have no number of a channel: their three are one record of a station, whatever the azimuths."""
    for azimuths in (("N08W", "S82W"), ("N45E", "N45W"), ("S30E", "N60E")):
        codes = []
        for name in (*azimuths, "UP"):
            (tmp_path / "record").write_bytes(write((name,)))
            codes += [trace.stats.channel for trace in open_traces(tmp_path / "record", [])]
        assert sorted(code[-1] for code in codes) == ["1", "2", "Z"]
