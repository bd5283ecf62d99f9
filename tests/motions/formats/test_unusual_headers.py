"""Headers that are written otherwise, each after an agency's own file: read where they can be, else refused."""

from __future__ import annotations

import io
from importlib import import_module

import numpy as np
import obspy
import pytest

from pipeline.motions import MotionError
from pipeline.motions.formats import FormatError, header_facts, trace_headers
from pipeline.motions.reading import open_traces
from tests.motions.formats import national
from tests.motions.formats import specimens as hand


def traces(content: bytes, name: str):
    return import_module(f"pipeline.motions.formats.{name}").read_format(io.BytesIO(content))


def test_a_date_with_dashes():
    """Start time:  2-13-12, 21:06:45.0 UTC (GPS), as a file of Willow Creek has it."""
    content = hand.csmip().replace(b"1/01/01, 00:00:45.0", b"2-13-12, 21:06:45.0")
    first = traces(content, "csmip")[0]
    assert (first.stats.starttime, first.stats.kouros.start) == (obspy.UTCDateTime("2012-02-13T21:06:45"), "record")


@pytest.mark.parametrize(("said", "second"), [("02:33:  .0", 0.0), ("02:33:  .25", 0.25), ("02:33: 4.5", 4.5)])
def test_seconds_that_fortran_printed(said, second):
    """Start time:  8/29/18, 02:33:  .0 UTC (GPS), as a file of Pomona has it: the record had no time."""
    content = hand.csmip(1).replace(b" 1/01/01, 00:00:45.0", f" 8/29/18, {said}".encode())
    first = traces(content, "csmip")[0]
    assert first.stats.starttime == obspy.UTCDateTime("2018-08-29T02:33") + second
    assert first.stats.kouros.start == "record"
    line = f"(ORIGIN: 08/29/18, {said} GMT)"
    assert header_facts.of_text([line])["event_time"] == obspy.UTCDateTime("2018-08-29T02:33") + second


def test_a_depth_that_esm_says():
    """SENSOR_DEPTH_M of a borehole, by which it is no record of the surface."""
    assert traces(hand.esm(SENSOR_DEPTH_M="30.5"), "esm")[0].stats.kouros.sensor_depth == 30.5
    assert "sensor_depth" not in traces(hand.esm(SENSOR_DEPTH_M=""), "esm")[0].stats.kouros


def test_a_station_with_two_places_has_none():
    """40.941S in the text and 40.9406 in the numbers of one file of Willow Creek: no hemisphere is guessed."""
    numbers = hand.fortran([0.0] * 28 + [40.9406, -123.6327] + [0.0] * 20, 8, "{:10.5f}")
    zeros = hand.fortran([0.0] * 50, 8, "{:10.7f}")
    assert hand.joined(zeros) in hand.csmip(1)
    same = hand.csmip(1).replace(hand.joined(zeros), hand.joined(numbers))
    said = traces(same, "csmip")[0].stats.kouros
    assert (said.latitude, said.longitude) == (40.941, -123.633)
    said = traces(same.replace(b"40.941N", b"40.941S"), "csmip")[0].stats.kouros
    assert "latitude" not in said
    assert "longitude" not in said
    assert "two places of the station" in said.notes


@pytest.mark.parametrize(("word", "said"), [("BHZ00", "up"), ("HNE--", 90.0), ("BH100", "BH100"), ("BH1", "BH1")])
def test_a_title_of_nga_east_ends_in_a_channel_of_seed(word, said):
    """ComalTX11-10-20, 10/20/2011, CCM, BHZ00: channel and location; 1 and 2 point nowhere that a code says."""
    trace = traces(hand.at2(title=f"ComalTX11-10-20, 10/20/2011, CCM, {word}"), "peer")[0]
    assert trace.stats.kouros.orientation == said


def test_a_magnitude_of_no_kind():
    """MAGNITUD(ES) : /M=7.1, as the RACM's records of 2017-09-19 have it."""
    line = b"FECHA DEL SISMO [GMT]                  : 2004/01/01"
    content = national.unam().replace(line, b"MAGNITUD(ES)                           : /M=7.1\r\n" + line)
    said = traces(content, "unam")[0].stats.kouros
    assert said.magnitude == 7.1
    assert "magnitude_type" not in said


def test_version_one_of_cosmos_is_refused_as_such():
    """Its headers have the step and the time in other places: 'a time step of -0.999 s' was what was said."""
    with pytest.raises(
        FormatError, match=r"line 1: is of version 01\.00 of the format.*give the file of version 01\.20"
    ):
        traces(hand.cosmos().replace(b"Format v01.20", b"Format v01.00"), "cosmos")


@pytest.mark.parametrize(
    "line", ["Sta Chan   1  90    HNE           Location:   00", "Sta Cha: 1    90 deg (Rcrdr Chan  1)"]
)
def test_a_channel_s_number_without_a_colon(line):
    """The azimuth of the text, where the integer header has none."""
    content = hand.cosmos(azimuths=(-999,))
    (old,) = [one for one in content.splitlines() if one.startswith(b"Sta Chan   1:")]
    first = traces(content.replace(old, line.encode()), "cosmos")[0]
    assert first.stats.kouros.orientation == 90.0
    assert first.stats.location == "01"


def test_a_latitude_is_no_station_s_code():
    """STATION NO.         20.252S   70.125W  ETNA, as RENADIC has it: it was station 20."""
    line = b"STATION NO. 00001   33.929N, 118.260W  SMA-1"
    content = national.volume1().replace(line, b"STATION NO.         20.252S   70.125W  ETNA")
    first = traces(content, "volume1")[0]
    assert first.stats.station == ""
    assert (first.stats.kouros.latitude, first.stats.kouros.longitude) == (-20.252, -70.125)
    assert first.stats.kouros.station_name == "NOWHERE"


@pytest.mark.parametrize(
    "title",
    [
        "Response spectra          (Format v01.20 with 13 text lines)",
        "RESPONSE AND FOURIER AMPLITUDE SPECTRA (86 periods, .04 - 10.0 sec)",
        "Response and Fourier amplitude spectra (86 periods,  .04 - 10.0 sec)   for",
        "Fourier amplitude spectrum of acceleration",
    ],
)
def test_spectra_are_refused_as_such(tmp_path, title):
    """Volume 3 of any agency: derived from a record, and no motion can be made of it."""
    (tmp_path / "a.v3").write_text(f"{title}\nmore\n")
    with pytest.raises(MotionError, match=r"holds (?:response and Fourier )?spectra.*give the file of"):
        open_traces(tmp_path / "a.v3", [])


def test_the_first_sample_of_itaca_is_of_the_next_day():
    """An earthquake at 23:59:09, and a clock of 00:00:10.5."""
    assert traces(national.itaca(), "esm")[0].stats.starttime == obspy.UTCDateTime("1997-10-15T00:00:10.5")


def test_geocsv_says_station_and_time():
    first = traces(national.geocsv(), "columns")[0]
    assert (first.id, first.stats.starttime) == ("XX.TEST.00.HNZ", obspy.UTCDateTime("2001-01-01T00:00:59.5"))


def test_a_series_behind_its_number_and_step():
    """eqsig and DEEPSOIL: "60 0.01", then values, or times and values; neither says a unit."""
    rows = [f"{a:.7f}" for a in hand.tone()]
    pairs = [f"{hand.DT * i:.2f} {row}" for i, row in enumerate(rows)]
    for lines in (["Kobe, 1995", "60 0.01", *rows], ["60 0.01", *pairs]):
        (trace,) = traces(hand.joined(lines), "columns")
        assert (trace.stats.npts, trace.stats.delta, trace.stats.kouros.units) == (60, 0.01, "")
        assert abs(trace.data - hand.tone()).max() < 1e-7


def test_a_table_with_decimal_commas():
    rows = [f"{hand.DT * i:.2f};{a:.5f}".replace(".", ",") for i, a in enumerate(hand.tone())]
    (trace,) = traces("\n".join(["Zeit [s];Acc NS [m/s\u00b2]", *rows]).encode(), "columns")
    assert (trace.stats.kouros.units, trace.stats.kouros.orientation) == ("m/s2", 0.0)
    assert abs(trace.data - hand.tone()).max() < 6e-6


def test_of_acceleration_velocity_and_displacement_the_first_is_taken():
    """SeismoSignal's export; a velocity alone is refused."""
    rows = [f"{hand.DT * i:.2f}\t{a:.6f}\t{9 * a:.6f}\t{a:.6f}" for i, a in enumerate(hand.tone())]
    head = "Time [sec]\tAcceleration [g]\tVelocity [cm/sec]\tDisplacement [cm]"
    (trace,) = traces(hand.joined([head, *rows]), "columns")
    assert (trace.stats.kouros.units, trace.data[0]) == ("g", 1.0)


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        (national.platform("cm/s"), 2, "holds velocity (cm/s), no acceleration"),
        (national.geocsv("M/S"), 3, "holds velocity (m/s), no acceleration"),
        (
            national.series().replace(b"Data                : 60", b"Data                : 61"),
            7,
            "announces 61 samples",
        ),
        (national.series().replace(b"1.0000000E+00\n", b"9.8100000E+00\n", 1), 8, "9.81 m/s2, and the samples have 1"),
        (national.worded().replace(b"Laboratorio", b"dt = 0.02"), 3, "says '0.01' for step, and line 1 '0.02'"),
        (
            national.platform().replace(b"# Sim", b"# dt: 0.02, sim"),
            1,
            "step of 0.02 s, and the times have one of 0.01",
        ),
    ],
)
def test_what_a_head_says_is_held_against_the_numbers(content, line, words):
    with pytest.raises(FormatError) as refusal:
        traces(content, "columns")
    assert str(refusal.value).startswith(f"stream: line {line}: "), str(refusal.value)
    assert words in str(refusal.value)


def test_a_smc_of_unknown_kind_says_no_unit():
    """PEA2SMC: fields of fourteen, and "0 UNKNOWN" for a title."""
    lines = hand.smc().decode().splitlines()
    data = [f"{a: .7E}".replace("E+0", "E+").replace("E-0", "E-").rjust(14) for a in hand.tone()]
    lines = ["0 UNKNOWN", *lines[1:16], lines[16][:60] + f"{8:10d}" + lines[16][70:], *lines[17:29]]
    content = hand.joined([*lines, *("".join(data[i : i + 5]) for i in range(0, 60, 5))])
    (trace,) = traces(content, "smc")
    said = trace.stats.kouros
    assert (said.units, said.si_factor, said.processed) == ("", None, None)
    assert abs(trace.data - hand.tone()).max() < 1e-7


@pytest.mark.parametrize("word", ["%g", "% g", "%G", "percent g", "pct g"])
def test_percent_of_g(word):
    rows = [f"{100.0 * a:.5f}" for a in hand.tone()]
    (trace,) = traces(hand.joined([f"Units: {word}", "NPTS= 60, DT= .01 SEC", *rows]), "columns")
    assert trace.stats.kouros.units == "%g"
    assert abs(trace.stats.kouros.si_factor * trace.data - 9.80665 * hand.tone()).max() < 1e-5


@pytest.mark.parametrize("width", [2, 3, 5, 8, 10])
def test_a_wrapped_series_without_a_count_is_told_by_its_numbers(width):
    """Quiet at first, as a record is; the last row is full."""
    count = 1000 // width * width
    truth = np.sin(np.arange(count) / 9.0) * np.linspace(0.0, 1.0, count)
    rows = ["".join(f"{a:12.6f}" for a in truth[i : i + width]) for i in range(0, count, width)]
    head = ["Accelerations in units of g", "time step: 0.01"]
    (trace,) = traces(hand.joined([*head, *rows]), "columns")
    assert (trace.stats.npts, trace.stats.delta, trace.stats.kouros.units) == (count, 0.01, "g")
    assert abs(trace.data - truth).max() < 1e-6


def _beside(kind):
    t = np.arange(400) / 9.0
    return {
        "components": np.column_stack([np.sin(t), np.sin(1.3 * t + 1.0), 0.3 * np.sin(2.1 * t)]),
        "sensors that move alike": np.column_stack([np.sin(t), 1.01 * np.sin(t), 1.02 * np.sin(t)]),
        "noise": np.random.default_rng(7).normal(size=(400, 3)),
        "too few": np.sin(np.arange(60) / 9.0).reshape(-1, 3),
    }[kind]


@pytest.mark.parametrize("kind", ["components", "sensors that move alike", "noise", "too few"])
def test_columns_without_a_name_are_never_taken_for_a_series(kind):
    rows = ["".join(f"{a:12.6f}" for a in row) for row in _beside(kind)]
    with pytest.raises(FormatError, match="line 3: neither names of columns, nor a count, nor the numbers say"):
        traces(hand.joined(["Units: g", "time step: 0.01", *rows]), "columns")


@pytest.mark.parametrize(
    ("unit", "scaled", "factor"),
    [("counts", "M/S**2", 1.0 / 213807.0), ("counts", "M/S", None), ("M/S**2", "M/S**2", 1.0)],
)
def test_the_scale_of_geocsv_is_of_counts_and_of_an_acceleration_alone(unit, scaled, factor):
    """A velocity sensor's scale makes no acceleration of its counts, and what is in m/s2 was scaled before."""
    told = f"# scale_factor: 2.13807E5\n# scale_frequency_hz: 1.0\n# scale_units: {scaled}\n# azimuth_deg"
    (trace,) = traces(national.geocsv(unit).replace(b"# azimuth_deg", told.encode()), "columns")
    assert trace.stats.kouros.si_factor == pytest.approx(factor)
    assert ("213807 counts for 1 m/s2" in trace.stats.kouros.get("notes", "")) == (factor == 1.0 / 213807.0)
    assert abs(trace.data - hand.tone()).max() < 1e-6


@pytest.mark.parametrize(
    ("said", "azimuth"), [("N129E", 129.0), ("N 155 E", 155.0), ("N360E", 0.0), ("N361E", "N361E"), ("35°", 35.0)]
)
def test_azimuths_beyond_a_right_angle(said, azimuth):
    """As PESMOS and ITSAK write the second component."""
    assert trace_headers.orientation(said) == azimuth


@pytest.mark.parametrize(("peak", "fits"), [("50.0", True), ("98.0", True), ("512.3", False)])
def test_the_peak_of_a_table_is_that_of_one_of_its_columns(tmp_path, peak, fits):
    rows = [f"{100 * a:.3f} {-50 * a:.3f} {25 * a:.3f}" for a in hand.tone()]
    head = ["Station: ABC", "Sampling rate: 100 Hz", f"PGA: {peak} cm/s2", "Unit: cm/s2", "NS EW UD"]
    (tmp_path / "a.txt").write_text("\n".join([*head, *rows, ""]))
    if fits:
        assert len(obspy.read(str(tmp_path / "a.txt"))) == 3
    else:
        with pytest.raises(FormatError, match=r"line 3: says a peak acceleration of 5\.123 m/s2"):
            obspy.read(str(tmp_path / "a.txt"))


@pytest.mark.parametrize("head", ["Time (s),NS (gal)", "Tiempo,NS (gal),EW (gal)\ns,gal,gal"])
def test_times_that_are_printed_more_coarsely_than_their_step(tmp_path, head):
    """200 samples a second in a sheet that shows hundredths; one sample less in the middle is no longer even."""
    count = head.split("\n")[0].count("NS") + head.split("\n")[0].count("EW")
    rows = [f"{0.005 * i:.2f}" + f",{a:.4f}" * count for i, a in enumerate(hand.tone(700))]
    (tmp_path / "a.csv").write_text("\n".join([head, *rows, ""]))
    (first, *_) = obspy.read(str(tmp_path / "a.csv"))
    assert (first.stats.npts, first.stats.delta) == (700, 0.005)
    for gone in (1, 2):
        (tmp_path / "a.csv").write_text("\n".join([head, *rows[:350], *rows[350 + gone :], ""]))
        with pytest.raises(Exception, match=r"even|known|step"):
            obspy.read(str(tmp_path / "a.csv"))
