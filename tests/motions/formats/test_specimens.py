"""Every format through obspy.read, from files written here: values as printed, unit, orientation, raw or processed.

The truth is the series that the file was written from; what is left is half a digit in the last printed place.
"""

from __future__ import annotations

import copy
import io
import re
from importlib.metadata import entry_points

import numpy as np
import obspy
import pytest

from pipeline.motions.formats import trace_headers
from pipeline.motions.formats.record_text import FormatError
from tests.motions.formats import specimens as hand
from tests.motions.formats.every import SPECIMENS
from tests.motions.formats.specimens import DT, SHAPE, tone

EXPECTED = {
    # name: unit, factor to m/s2, orientations, processed, amplitude in that unit, half the last printed digit
    "at2": ("g", 9.80665, [230.0], None, 1.0, 5e-8),
    "at2-old": ("g", 9.80665, [230.0], None, 1.0, 5e-8),
    "esm": ("cm/s2", 0.01, [90.0], True, 100.0, 5e-7),
    "geonet-v1a": ("mm/s2", 0.001, [16.0, 286.0, "up"], False, 100.0, 5e-3),
    "geonet-v2a": ("mm/s2", 0.001, [16.0, 286.0, "up"], True, 100.0, 5e-3),
    "csmip-v1": ("g", 9.80665, [0.0, "up", 90.0], False, 1.0, 5e-7),
    "csmip-v2": ("cm/s2", 0.01, [0.0, "up", 90.0], True, 100.0, 5e-6),
    "smc-corrected": ("cm/s2", 0.01, [133.0], True, 100.0, 5e-3),
    "cosmos-v0": ("counts", 1e-6 / 2.0 * 9.80665, [90.0, 0.0, "up"], False, 1e6, 0.5),
    "cosmos-v1": ("cm/s2", 0.01, [90.0, 0.0, "up"], False, 100.0, 5e-6),
    "cosmos-v2": ("cm/s2", 0.01, [90.0, 0.0, "up"], True, 100.0, 5e-6),
    "film": ("g/10", 0.980665, [90.0, "up", 180.0], False, 1.0, 5e-4),
    "film-usc": ("g/10", 0.980665, [90.0], False, 1.0, 5e-4),
    "csmip-v1-narrow": ("g", 9.80665, [90.0], False, 1.0, 5e-7),
    "csmip-usc-v2": ("cm/s2", 0.01, [352.0], True, 100.0, 5e-4),
    "bhrc": ("g/10", 0.980665, [50.0, "up", 140.0], False, 1.0, 5e-7),
    "csmnc": ("cm/s2", 0.01, [90.0], False, 100.0, 5e-5),
    "itaca-1": ("cm/s2", 0.01, [90.0], False, 100.0, 5e-7),
    "series-of-words": ("m/s2", 1.0, [0.0], True, 1.0, 5e-8),
    "columns-of-words": ("cm/s2", 0.01, [0.0, "up", 90.0], None, 100.0, 5e-4),
    "columns-of-a-platform": ("cm/s2", 0.01, [0.0, 90.0, "up"], None, 100.0, 5e-4),
    "geocsv": ("m/s2", 1.0, ["up"], None, 1.0, 5e-8),
}


@pytest.fixture
def read(tmp_path):
    def reading(content: bytes, name: str = "record", **options):
        (tmp_path / name).write_bytes(content)
        return obspy.read(str(tmp_path / name), **options)

    return reading


@pytest.mark.parametrize("name", EXPECTED)
def test_as_written(read, name):
    unit, factor, orientations, processed, amplitude, digit = EXPECTED[name]
    stream = read(SPECIMENS[name][1]())
    assert [trace.stats.kouros.orientation for trace in stream] == orientations
    for trace in stream:
        said = trace.stats.kouros
        assert (said.units, said.processed) == (unit, processed)
        assert said.si_factor == pytest.approx(factor, rel=1e-12)
        assert trace.stats.delta == pytest.approx(DT, rel=1e-12)
        assert np.abs(trace.data - amplitude * tone()).max() <= 1.001 * digit
        for kind in ("velocity", "displacement"):
            if kind in said:
                scale = 0.001 if unit == "mm/s2" else 0.01
                assert np.abs(np.asarray(said[kind]) - scale * SHAPE[kind] * tone()).max() <= 1.001 * scale * digit


def test_velocities_are_there_where_they_were_written(read):
    with_them = {name for name in EXPECTED if "velocity" in read(SPECIMENS[name][1]())[0].stats.kouros}
    assert with_them == {"geonet-v2a", "csmip-v2", "cosmos-v2", "csmip-usc-v2"}


def test_csv(read):
    stream = read(hand.csv(comments="# processed: no\n# station: XX.TEST\n# start: 2019-07-06T03:19:53Z"))
    assert [(t.stats.kouros.units, t.stats.kouros.orientation) for t in stream] == [
        ("cm/s2", 90.0), ("g", 0.0), ("m/s2", "up"),
    ]  # fmt: skip
    assert [trace.id for trace in stream] == ["XX.TEST.01.HNE", "XX.TEST.02.HNN", "XX.TEST.03.HNZ"]
    assert {trace.stats.kouros.processed for trace in stream} == {False}
    assert stream[0].stats.starttime == obspy.UTCDateTime("2019-07-06T03:19:53")
    for trace, amplitude in zip(stream, (100.0, 1.0, 9.0), strict=True):
        assert np.abs(trace.data - amplitude * tone()).max() <= 5.01e-7


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_csv_separators(read, separator):
    stream = read(hand.csv("time (s),A (g),B (g)", separator))
    assert [trace.stats.kouros.orientation for trace in stream] == [None, None]
    assert {trace.stats.kouros.processed for trace in stream} == {None}


def test_csv_times_may_be_rounded_as_printed(read):
    """128 samples a second, printed to the millisecond: the step is 1/128 s, not 0.008 s."""
    rows = "\n".join(f"{i / 128:.3f},{i % 7}" for i in range(500))
    (trace,) = read(f"time (s),HNE (g)\n{rows}\n".encode())
    assert trace.stats.delta == pytest.approx(1 / 128, rel=1e-12)


def test_smc_irregular_times(read):
    """Pairs on straight lines, with one time given twice: between 0 and 60 ms the line is 10,000 cm/s2 a second."""
    (trace,) = read(hand.smc(corrected=False))
    assert trace.stats.delta == 0.005
    assert trace.stats.npts == 21
    up, down = 10_000 * trace.times()[:13], 600 - 15_000 * (trace.times()[12:] - 0.06)
    assert np.allclose(trace.data[:13], up, atol=1e-9)
    assert np.allclose(trace.data[12:], down, atol=1e-9)
    (finer,) = read(hand.smc(corrected=False), resample=0.001)
    assert finer.stats.npts == 101


@pytest.mark.parametrize(("vertical", "azimuth", "said"), [(0, -32768, "up"), (180, -32768, "down"), (90, 360, 0.0)])
def test_smc_orientations(read, vertical, azimuth, said):
    assert read(hand.smc(vertical=vertical, azimuth=azimuth))[0].stats.kouros.orientation == said


def test_csmip_step_that_its_text_rounds(read):
    """400 samples a second come as .003 sec in the line of data; the real header has .0025."""
    assert read(hand.csmip(dt=0.0025))[0].stats.delta == pytest.approx(0.0025, rel=1e-12)


def test_cosmos_velocity_in_channels_of_its_own(read):
    stream = read(hand.cosmos(2, apart=True))
    assert len(stream) == 3
    for trace in stream:
        assert np.abs(np.asarray(trace.stats.kouros.velocity) - 0.09 * tone()).max() <= 5.01e-8


def test_cosmos_without_a_sensitivity_has_no_factor(read):
    content = hand.cosmos(0).replace(b"       2.000000", b"    -999.000000")
    assert read(content)[0].stats.kouros.si_factor is None


@pytest.mark.parametrize(
    ("title", "said"),
    [
        ("A, 1/1/1999, B, UP", "up"),
        ("A, B, DWN", "down"),
        ("A, N60W", 300.0),
        ("A, VER", "up"),
        ("A, --V", "up"),
        ("A, -UP", "up"),
        ("PACOIMA DAM, 164 (CDMG STATION 279)", 164.0),
        ("A, LONG", "LONG"),
        ("nothing", None),
    ],
)
def test_at2_orientations(read, title, said):
    assert read(hand.at2(title=title))[0].stats.kouros.orientation == said


@pytest.mark.parametrize(
    ("words", "processed"),
    [
        (b" FILTER POINTS: HP=0.06 Hz LP=40.0 Hz", True),  # HWA002, Chi-Chi 1999, of the older PEER database
        (b" Filter points: HP=.2 Hz LP=null", True),
        (b" FILTER POINTS: HP=0.00 Hz LP=40.0 Hz", None),
        (b" FILTER POINTS: HP=null LP=40.0 Hz", None),
        (b"", None),
    ],
)
def test_an_at2_that_names_its_filter_is_processed(read, words, processed):
    content = hand.at2().replace(b"UNITS OF G", b"UNITS OF G." + words)
    assert read(content)[0].stats.kouros.processed is processed


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("360 Deg", 0.0), ("90", 90.0), ("South", 180.0), ("w", 270.0), ("N16E", 16.0), ("S16W", 196.0),
        ("S74E", 106.0), ("N 45 W", 315.0), ("Up", "up"), (" DOWN ", "down"), ("361", "361"), ("N91E", "N91E"),
        ("", None), ("H1", "H1"),
    ],
)  # fmt: skip
def test_orientation_in_words(text, said):
    assert trace_headers.orientation(text) == said


@pytest.mark.parametrize("name", SPECIMENS)
def test_one_reader_claims_each(name):
    """Of all the plugins of obspy and Kouros exactly one takes a file, and it is the one that wrote its description."""
    content = SPECIMENS[name][1]()
    claims = set()
    for plugin in entry_points(group="obspy.plugin.waveform"):
        if plugin.value.startswith("pipeline."):
            is_format = next(iter(entry_points(group=f"obspy.plugin.waveform.{plugin.name}", name="isFormat"))).load()
            if is_format(io.BytesIO(content)):
                claims.add(plugin.value)
    assert claims == {f"pipeline.motions.formats.{SPECIMENS[name][0]}"}


@pytest.mark.parametrize("form", ["MSEED", "SAC", "SLIST", "TSPAIR", "GSE2", "PICKLE", "WAV"])
def test_files_of_others_are_left_alone(tmp_path, form):
    stream = obspy.Stream([obspy.Trace((1e4 * tone()).astype(np.int32), {"station": "TEST"})])
    path = tmp_path / "file"
    stream.write(str(path), format=form)
    for plugin in entry_points(group="obspy.plugin.waveform"):
        if plugin.value.startswith("pipeline."):
            is_format = next(iter(entry_points(group=f"obspy.plugin.waveform.{plugin.name}", name="isFormat"))).load()
            assert not is_format(str(path))
            assert not is_format(io.BytesIO(path.read_bytes()))
            assert not is_format(str(tmp_path))
            assert not is_format(str(tmp_path / "none"))


@pytest.mark.parametrize("name", SPECIMENS)
def test_any_line_ends_and_streams(read, name):
    content = SPECIMENS[name][1]().replace(b"\r\n", b"\n")
    first = read(content)
    assert read(content.replace(b"\n", b"\r\n"), "crlf")[0].data.tolist() == first[0].data.tolist()
    # Mails and editors put blank lines before the first.
    assert read(b"\r\n \n" + content, "padded")[0].data.tolist() == first[0].data.tolist()
    assert obspy.read(io.BytesIO(content))[0].data.tolist() == first[0].data.tolist()


def test_headers_compare_and_copy(read):
    """obspy compares the headers of streams; the series in them must stand that."""
    stream = read(hand.csmip())
    assert stream == stream.copy()
    other = copy.deepcopy(stream)
    np.asarray(other[0].stats.kouros.velocity.values)[0] += 1.0
    assert stream != other


@pytest.mark.parametrize(
    ("comment", "words"),
    [
        ("# dt = 0.005 s", "line 1: says a step of 0.005 s, and the times have one of 0.01 s"),
        ("# Sampling frequency (Hz): 200", "line 1: says a step of 0.005 s, and the times have one of 0.01 s"),
        ("# number of samples: 61", "line 1: announces 61 samples, and 60 are there"),
        ("# PGA: 981 cm/s2", ""),
        ("# PGA: 1.5 g", "line 1: says a peak acceleration of 14.71 m/s2"),
        ("# units: mg", "line 1: says mg for the unit, and the names of the columns say"),
        ("# dt = 0.01 s; number of samples: 60; PGA: 1 g", ""),
        ("# units: g", ""),
    ],
)
def test_comments_of_a_csv_are_held_against_its_numbers(read, comment, words):
    """They were passed over: a step of twice the times' halves every velocity."""
    content = hand.csv(comments=comment)
    if words:
        with pytest.raises(FormatError, match=re.escape(words)):
            read(content)
    else:
        assert read(content)[0].stats.delta == 0.01
