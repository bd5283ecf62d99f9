"""Tables as spreadsheets and loggers of other countries write them, and the CSV of K-NET; spectra are no records."""

import codecs

import numpy as np
import obspy
import pytest

from pipeline.motions.formats import FormatError
from pipeline.motions.reading import open_traces
from tests.motions.formats import national
from tests.motions.formats import specimens as hand

LONG = 700
"""Rows, more than the 8 kB that deciding on a format may read."""

HEADS = {
    # head, separator, whether commas are decimal, unit, orientations
    "spanish": ("Tiempo (s);Acel. N-S (cm/s2);Acel. E-O (cm/s2);Acel. Vertical (cm/s2)", True, "cm/s2", [0, 90, "up"]),
    "french": ("Temps (s);Accélération NS (m/s²);Accélération EO (m/s²);Accélération Z (m/s²)", True, "m/s2",
               [0, 90, "up"]),
    "german": ("Zeit [s];Beschleunigung X [m/s²];Beschleunigung Y [m/s²];Beschleunigung Z [m/s²]", True, "m/s2",
               ["X", "Y", "up"]),
    "turkish": ("Zaman(s)\tK-G(cm/s^2)\tD-B(cm/s^2)\tDüşey(cm/s^2)", False, "cm/s2", [0, 90, "up"]),
    "chinese": ("时间(s),东西向加速度(cm/s2),南北向加速度(cm/s2),竖向加速度(cm/s2)", False, "cm/s2", [90, 0, "up"]),
    "russian": ("Время (с);Ускорение С-Ю (g);Ускорение В-З (g);Вертикаль (g)", True, "g", [0, 90, "up"]),
    "italian": ("Tempo [s]\tAccelerazione NS [gal]\tAccelerazione EO [gal]\tAccelerazione Verticale [gal]", False,
                "gal", [0, 90, "up"]),
    "portuguese": ("Tempo (s);Aceleração N-S (m/s²);Aceleração L-O (m/s²);Aceleração Vertical (m/s²)", True, "m/s2",
                   [0, 90, "up"]),
    "greek": ("Χρόνος (s);Επιτάχυνση Β-Ν (cm/s2);Επιτάχυνση Α-Δ (cm/s2);Επιτάχυνση Κατακόρυφη (cm/s2)", True, "cm/s2",
              [0, 90, "up"]),
    "japanese": ("時間(s),加速度NS(gal),加速度EW(gal),加速度UD(gal)", False, "gal", [0, 90, "up"]),
    "units in a row of their own": ("Time,NS,EW,UD\ns,gal,gal,gal", False, "gal", [0, 90, "up"]),
    "an opposite order is asked for": ("t (s);O-E (g);S-N (g);V (g)", True, "g", [None, None, "up"]),
}  # fmt: skip


@pytest.mark.parametrize("end", ["\n", "\r\n"], ids=["unix", "windows"])
@pytest.mark.parametrize("name", HEADS)
def test_heads_in_other_languages(tmp_path, name, end):
    """Long files and short ones, with the ends of lines of either system."""
    head, comma, unit, orientations = HEADS[name]
    separator = next(one for one in ";\t," if one in head)
    for count in (60, LONG):
        rows = [
            separator.join(f"{x:.5f}" for x in (hand.DT * i, a, a / 2, a / 4)) for i, a in enumerate(hand.tone(count))
        ]
        text = end.join([*head.split("\n"), *(row.replace(".", ",") if comma else row for row in rows), ""])
        (tmp_path / "record.csv").write_bytes(codecs.BOM_UTF8 + text.encode())
        stream = open_traces(tmp_path / "record.csv", [])
        assert [trace.stats.kouros.orientation for trace in stream] == orientations
        assert {trace.stats.kouros.units for trace in stream} == {unit}
        assert {trace.stats.npts for trace in stream} == {count}
        for trace, share in zip(stream, (1.0, 2.0, 4.0), strict=True):
            assert trace.stats.delta == pytest.approx(hand.DT, rel=1e-9)
            assert np.abs(share * trace.data - hand.tone(count)).max() <= share * 5.01e-6


@pytest.mark.parametrize("zone", ["Z", ""])
@pytest.mark.parametrize("dash", ["-", "/"])
def test_times_of_the_calendar_say_the_step(tmp_path, zone, dash):
    """Over midnight; whose clock it was is known with a Z only."""
    start = obspy.UTCDateTime("2019-12-31T23:59:59.8")
    when = [str(start + hand.DT * i)[:23].replace("T", " ").replace("-", dash) for i in range(60)]
    rows = [f"{at}{zone},{a:.5f}" for at, a in zip(when, hand.tone(), strict=True)]
    (tmp_path / "phone.csv").write_text("\n".join(["timestamp,acc_EW (g)", *rows, ""]))
    (trace,) = open_traces(tmp_path / "phone.csv", [])
    assert (trace.stats.npts, trace.stats.kouros.orientation) == (60, 90.0)
    assert trace.stats.delta == pytest.approx(hand.DT)
    assert trace.stats.kouros.start == ("record" if zone else "unknown")
    assert not zone or trace.stats.starttime == start
    rows[30] = rows[30].replace(when[30], str(start + hand.DT * 34)[:23].replace("T", " ").replace("-", dash))
    (tmp_path / "phone.csv").write_text("\n".join(["timestamp,acc_EW (g)", *rows, ""]))
    with pytest.raises(Exception, match=r"times go on by 0\.05 s to 0\.34 s, .* samples are missing"):
        open_traces(tmp_path / "phone.csv", [])


@pytest.mark.parametrize("head", ["T (s),Sa (g)", "Time (s),PSA (g)", "t;SA(5%) (g)", "Periodo (s),aceleracion (g)"])
def test_spectra_are_no_records(tmp_path, head):
    """Their periods rise at even steps, as times do, and their values are in g."""
    separator = ";" if ";" in head else ","
    rows = [f"{0.01 * i:.2f}{separator}{np.exp(-0.01 * i):.5f}" for i in range(1, 200)]
    (tmp_path / "spectrum.csv").write_text("\n".join([head, *rows, ""]))
    with pytest.raises(Exception, match=r"no acceleration|of no format that is known|spectr"):
        open_traces(tmp_path / "spectrum.csv", [])


@pytest.mark.parametrize("head", ["time,displacement", "t;Vitesse NS", "Tiempo,velocidad", "時間,変位"])
def test_what_is_no_acceleration_by_its_name_is_refused(tmp_path, head):
    """Without a unit; a person who is asked for one could not know."""
    rows = [f"{hand.DT * i:.2f}{';' if ';' in head else ','}{a:.5f}" for i, a in enumerate(hand.tone())]
    (tmp_path / "record.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    with pytest.raises(FormatError, match="no acceleration"):
        open_traces(tmp_path / "record.csv", [])


def test_an_older_head_of_the_cwa_has_no_zone(tmp_path):
    """StationCode first, no earthquake, times of a clock that nobody names."""
    lines = national.cwa().decode().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("#StationCode"))
    text = "\r\n".join(lines[first:]).replace("#StartTime(GMT+08)", "#StartTime") + "\r\n"
    (tmp_path / "record.txt").write_bytes(text.encode())
    stream = open_traces(tmp_path / "record.txt", [])
    assert {trace.stats.kouros.format for trace in stream} == {"CWA"}
    assert {trace.stats.kouros.start for trace in stream} == {"unknown"}


def test_a_standard_file_of_the_uam_has_exponents(tmp_path):
    """Red Acelerografica UAM, 2013: "16 campos/dato", 3E16.7, and exponents of three digits."""
    text = national.unam().decode("latin-1")
    top = next(i for i, line in enumerate(text.splitlines()) if line.startswith("FORMATO DATOS"))
    lines = text.splitlines()
    lines[top] = "FORMATO DATOS (FORTRAN,16 campos/dato) : 3E16.7"
    rows = [
        i for i, line in enumerate(lines) if i > top and len(line.split()) == 3 and line.strip()[0] in "-.0123456789"
    ]
    for i in rows:
        cells = [f"{float(cell):.7e}" for cell in lines[i].split()]
        lines[i] = "".join(f"{cell[:-2]}0{cell[-2:]}".rjust(16) for cell in cells)
    (tmp_path / "a").write_bytes(text.encode("latin-1"))
    (tmp_path / "b").write_bytes("\r\n".join([*lines, ""]).encode("latin-1"))
    for one, other in zip(open_traces(tmp_path / "a", []), open_traces(tmp_path / "b", []), strict=True):
        assert np.abs(one.data - other.data).max() < 1e-6
        assert one.stats.kouros.orientation == other.stats.kouros.orientation


def test_knet_csv(tmp_path):
    (tmp_path / "k.csv").write_bytes(national.knet_csv())
    stream = open_traces(tmp_path / "k.csv", [])
    turned = {trace.stats.channel: trace.stats.kouros.orientation for trace in stream}
    assert turned == {"NS": 0.0, "EW": 90.0, "UD": "up"}
    for trace in stream:
        share = {"NS": 1.0, "EW": 2.0, "UD": 3.0}[trace.stats.channel]
        said = trace.stats.kouros
        assert (said.units, said.si_factor, said.processed, trace.stats.station) == ("gal", 0.01, False, "HKD004")
        assert np.abs(share * (trace.data + 2.9) - 100 * hand.tone()).max() < 0.02
        assert trace.stats.starttime == obspy.UTCDateTime("2026-01-12T16:58:43")
        assert (said.magnitude, said.event_latitude, said.latitude) == (5.2, 45.048, 45.2149)
        assert said.event_time == obspy.UTCDateTime("2026-01-12T16:58:00")


def test_kiknet_csv_tells_borehole_from_surface(tmp_path):
    (tmp_path / "k.csv").write_bytes(national.knet_csv(kik=True))
    stream = open_traces(tmp_path / "k.csv", [])
    assert {trace.stats.channel for trace in stream} == {"NS1", "EW1", "UD1", "NS2", "EW2", "UD2"}
    for trace in stream:
        assert ("borehole" in trace.stats.kouros.get("notes", "")) == trace.stats.channel.endswith("1")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (national.knet_csv(seconds="0.7"), "line 12: announces 70 samples, and 60 are there"),
        (national.knet_csv().replace(b"E-W(gal),U-D", b"E-W(cm/s),U-D"), "expected the columns N-S"),
        (national.knet_csv().replace(b",0.30,", b",0.34,"), "0.34 s is off the even step"),
        (national.knet_csv().replace(b"#100\r\n", b"#many\r\n"), "the header ends without SamplingFrequency"),
    ],
)
def test_knet_csv_that_contradicts_itself(tmp_path, content, words):
    (tmp_path / "k.csv").write_bytes(content)
    with pytest.raises(FormatError, match=words):
        open_traces(tmp_path / "k.csv", [])
