"""Heads of tables in more of the words that programs and agencies use; what only looks like a record is refused."""

import io
import zipfile

import numpy as np
import pytest

from pipeline.motions.converting import convert
from pipeline.motions.doubts import doubts
from pipeline.motions.errors import MotionError
from pipeline.motions.formats import FormatError
from pipeline.motions.formats.trace_headers import FACTORS
from pipeline.motions.formats.unit_words import unit_of
from pipeline.motions.gathering import gather
from pipeline.motions.proposing import Answers, propose
from pipeline.motions.reading import open_traces
from tests.motions.formats import specimens as hand

ROWS = 200
SHARES = (1.0, 2.0, 4.0)


def rows(separator: str = ",", number: str = "{:.5f}", first: str = "time") -> list[str]:
    """A tone, half and a quarter of it, behind times, a counter and times, or nothing."""
    made = []
    for i, a in enumerate(hand.tone(ROWS)):
        front = {"time": [f"{hand.DT * i:.2f}"], "counted": [f"{i}", f"{hand.DT * i:.2f}"], "ms": [f"{10 * i}"]}
        front["clock"] = [f"09:59:{59 + hand.DT * i:05.2f}" if i < 100 else f"10:00:{hand.DT * (i - 100):05.2f}"]
        made.append(separator.join([*front.get(first, []), *(number.format(a / share) for share in SHARES)]))
    return made


HEADS = {
    # head, rows, unit, orientations
    "label and value in cells": ("Sampling rate (Hz),100\nUnits,gal\nN-S,E-W,U-D", rows(first=""), "gal"),
    "a step with its unit": ("DT 0.01 SEC, UNIT: GAL\nNS EW UD", rows(" ", first=""), "gal"),
    "quotes around every cell": ('"Time (s)","NS (gal)","EW (gal)","UD (gal)"',
                                 [",".join(f'"{cell}"' for cell in row.split(",")) for row in rows()], "gal"),
    "a counter without a name": (",time,acc_ns (gal),acc_ew (gal),acc_ud (gal)", rows(first="counted"), "gal"),
    "a counter": ("No.  Time(s)  NS(gal)  EW(gal)  UD(gal)", rows(" ", first="counted"), "gal"),
    "units behind names": ("time_s,acc_ns_g,acc_ew_g,acc_ud_g", rows(), "g"),
    "milliseconds behind a name": ("time_ms,acc_ns_m_s2,acc_ew_m_s2,acc_ud_m_s2", rows(first="ms"), "m/s2"),
    "a label before the columns": ("# units: cm/s/s\n# columns: time N E Z", rows("  "), "cm/s2"),
    "one unit for all": ("SAMPLING INTERVAL (SN) : 0.01\n\n   N-S        E-W        U-D   (gal)",
                         rows("  ", "{:11.5f}", first=""), "gal"),
    "a clock": ("time,NS,EW,UD\nhh:mm:ss,gal,gal,gal", rows(first="clock"), "gal"),
    "in another language": ("Intervalo de muestreo (s): 0.01\nAceleraciones en cm/s2 (gal), sin corregir\nNS EW UD",
                            rows(" ", first=""), "cm/s2"),
    "upright exponents": ("time [s],acc_N [m·s⁻²],acc_E [m·s⁻²],acc_Z [m·s⁻²]", rows(), "m/s2"),
    "inches": ("Time (sec),NS (in/sec/sec),EW (in/sec/sec),UP (in/sec/sec)", rows(), "in/s2"),
    "feet": ("Time (sec),NS (ft/s^2),EW (ft/s^2),UP (ft/s^2)", rows(), "ft/s2"),
    "thousandths of a gal": ("Time(s) NS(mGal) EW(mGal) UD(mGal)", rows(" "), "mgal"),
}  # fmt: skip


@pytest.mark.parametrize("name", HEADS)
def test_heads(tmp_path, name):
    head, body, unit = HEADS[name]
    (tmp_path / "record.txt").write_text("\n".join([*head.split("\n"), *body, ""]), encoding="utf-8")
    stream = open_traces(tmp_path / "record.txt", [])
    assert [trace.stats.kouros.orientation for trace in stream] == [0.0, 90.0, "up"]
    assert {(trace.stats.kouros.units, trace.stats.kouros.si_factor) for trace in stream} == {(unit, FACTORS[unit])}
    for trace, share in zip(stream, SHARES, strict=True):
        assert (trace.stats.npts, trace.stats.delta) == (ROWS, pytest.approx(hand.DT, rel=1e-9))
        assert np.abs(share * trace.data - hand.tone(ROWS)).max() <= share * 5.01e-6


def test_units_by_hand():
    """Of a foot, an inch and Galileo's unit by their definitions."""
    found = {word: FACTORS[unit_of(word)[1]] for word in ("ft/s^2", "in/sec/sec", "mGal", "cm s-2", "ms⁻²", "%g")}
    assert found == {"ft/s^2": 0.3048, "in/sec/sec": 0.0254, "mGal": 1e-5, "cm s-2": 0.01, "ms⁻²": 1.0,
                     "%g": 0.0980665}  # fmt: skip
    assert unit_of("cm/s") == ("velocity", "cm/s")


SERIES = {
    "a direction without a colon": ("INCERC  COMP. N-S\nACCELERATII [cm/s2]  DT=0.01 s", 0.0, "cm/s2", None),
    "in words": ("Component: East-West\nSampling Frequency: 100 Hz\nAcceleration (gal)", 90.0, "gal", None),
    "not corrected": ("COMPONENTE: NS\nACCELEROGRAMMA NON CORRETTO\nACCELERAZIONI IN CM/S**2\nDT=0.01", 0.0, "cm/s2",
                      False),
    "points per line": ("El Centro 1940\nACCELERATION IN G, 8 POINTS PER LINE, EQUALLY SPACED AT 0.01 SEC", None, "g",
                        None),
    "a format of Fortran": ("COMPONENT N-S  UNIT: GAL  DT 0.01 SEC\n(8F9.6)", 0.0, "gal", None),
    "the letter D": ("ACCELERATION IN CM/SEC/SEC\nNPTS= 200 DT= .01000", None, "cm/s2", None),
}  # fmt: skip


@pytest.mark.parametrize("name", SERIES)
def test_series(tmp_path, name):
    head, orientation, unit, processed = SERIES[name]
    body = hand.fortran(hand.tone(ROWS), 8 if name in {"points per line", "a format of Fortran"} else 1, "{:9.6f}")
    if name == "the letter D":
        body = [line.replace("E", "D") for line in hand.fortran(hand.tone(ROWS), 8, "{:14.6E}")]
    (tmp_path / "record.txt").write_text("\n".join([*head.split("\n"), *body, ""]))
    (trace,) = open_traces(tmp_path / "record.txt", [])
    said = trace.stats.kouros
    assert (said.units, said.orientation, said.processed) == (unit, orientation, processed)
    assert (trace.stats.npts, trace.stats.delta) == (ROWS, pytest.approx(hand.DT))
    assert np.abs(trace.data - hand.tone(ROWS)).max() <= 1e-6


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("Velocity time history, cm/sec, dt = 0.01 sec", "holds velocity, no acceleration"),
        ("DISPLACEMENT (CM)\nDT=0.01", "holds displacement, no acceleration"),
        ("PEER NGA\nVELOCITY TIME SERIES IN UNITS OF CM/S\nNPTS= 200, DT= .0100 SEC", "holds velocity"),
        ("Ground velocity\nSampling rate: 100 Hz", "holds velocity"),
    ],
)
def test_a_title_may_say_that_it_is_no_acceleration(tmp_path, head, words):
    body = hand.fortran(hand.tone(ROWS), 5, "{:15.7E}")
    (tmp_path / "record.txt").write_text("\n".join([*head.split("\n"), *body, ""]))
    with pytest.raises(FormatError, match=words):
        open_traces(tmp_path / "record.txt", [])
    with pytest.raises(FormatError, match="no acceleration"):
        convert(tmp_path / "record.txt", ["ns"], "g", tmp_path / "out", dt=0.01)


def test_a_title_with_both_is_no_title(tmp_path):
    """What a head says of a velocity beside its acceleration, or of that of the ground's shear waves."""
    head = ["Velocity (Vs30): 300", "Acceleration (gal)", "Peak acceleration (g): 0.0010197", "DT=0.01"]
    (tmp_path / "one.txt").write_text("\n".join([*head, *(f"{a:.5f}" for a in hand.tone(ROWS)), ""]))
    (trace,) = open_traces(tmp_path / "one.txt", [])
    assert trace.stats.kouros.units == "gal"


@pytest.mark.parametrize(
    "head",
    ["Frequency (Hz), Fourier Amplitude (g-s)", "Period,NS (g)", "T [s],Se [g]", "T (s),Sa_NS (g)",
     "T (s),Pseudo-Spectral Acceleration (g)"],
)  # fmt: skip
def test_spectra_by_their_columns(tmp_path, head):
    body = [f"{0.01 * i:.2f},{np.exp(-0.01 * i):.5f}" for i in range(1, 200)]
    (tmp_path / "spectrum.csv").write_text("\n".join([head, *body, ""]))
    with pytest.raises(FormatError, match="spectr"):
        open_traces(tmp_path / "spectrum.csv", [])


def test_numbers_of_rows_are_no_samples(tmp_path):
    """Files for SHAKE: (8F9.6, I7)."""
    body = [f"{line:<72}{i:7d}" for i, line in enumerate(hand.fortran(hand.tone(ROWS), 8, "{:9.6f}"), start=1)]
    (tmp_path / "DIAM.ACC").write_text("\n".join([*body, ""]))
    done = convert(tmp_path / "DIAM.ACC", ["ns"], "gal", tmp_path / "out", dt=0.01)
    assert (done.samples, done.peaks) == (ROWS, (pytest.approx(0.01),))
    assert any("counts the rows" in step for step in done.steps)
    (tmp_path / "counted.txt").write_text("\n".join(f"{i} {a:.6f}" for i, a in enumerate(hand.tone(ROWS), start=1)))
    with pytest.raises(FormatError, match="counts the rows, and nothing says the time step"):
        open_traces(tmp_path / "counted.txt", [])


@pytest.mark.parametrize(
    ("unit", "dt", "words"),
    [("g", 0.01, "says cm/s2 .* and --unit g"), ("cm/s2", 0.02, "says a step of 0.01 s, and --dt 0.02 s")],
)
def test_convert_does_not_overrule_a_head(tmp_path, unit, dt, words):
    (tmp_path / "a.txt").write_text(
        "\n".join(["ACCELERATION IN CM/S/S, DT=0.01 s", *(f"{a:.5f}" for a in hand.tone(ROWS)), ""])
    )
    with pytest.raises(FormatError, match=words):
        convert(tmp_path / "a.txt", ["ns"], unit, tmp_path / "out", dt=dt)
    assert convert(tmp_path / "a.txt", ["ns"], "gal", tmp_path / "out", dt=0.01).samples == ROWS


def test_at2_in_other_units(tmp_path):
    """As programs write the form; New Zealand's names the file where the component stands."""
    (tmp_path / "a.AT2").write_bytes(
        hand.at2(title="1, 2001-01-01, TEST, 1_TEST_090.AT2").replace(b"OF G", b"OF CM/S/S")
    )
    (trace,) = open_traces(tmp_path / "a.AT2", [])
    assert (trace.stats.kouros.units, trace.stats.kouros.si_factor) == ("cm/s2", 0.01)
    assert trace.stats.kouros.orientation == 90.0


def workbook() -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("xl/workbook.xml", "<workbook/>")
    return made.getvalue()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (workbook(), "is a workbook; save the sheet"),
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(100), "is a MATLAB file; .*writematrix"),
        (b"\x93NUMPY\x01\x00v\x00" + bytes(100), "is an array of numpy; .*savetxt"),
        (
            b"0.1 0.2 0.3 0.4 0.3 0.2\n" * 100,
            "neither names of columns, nor a count.*convert FILE --columns ns --dt 0.01",
        ),
    ],
)
def test_what_no_reader_knows_is_named(tmp_path, content, words):
    (tmp_path / "record.bin").write_bytes(content)
    with pytest.raises(MotionError, match=words):
        open_traces(tmp_path / "record.bin", [])
    (found,) = gather([tmp_path / "record.bin"], scratch=tmp_path / "out").unusable
    assert "name the folder" not in found.reason


def test_words_in_an_archive_are_passed_over(tmp_path):
    """A licence beside the records, but no damaged record, and not where it was named itself."""
    with zipfile.ZipFile(tmp_path / "records.zip", "w") as archive:
        archive.writestr("a.AT2", hand.at2())
        archive.writestr("DISCLAIMER.TXT", "These records may be used by whoever cites them.\n" * 5)
        archive.writestr("damaged.dat", "0.12 0.34 0.56\nx\n0.1 0.2\n" * 5)
    (tmp_path / "scratch").mkdir()
    found = gather([tmp_path / "records.zip"], scratch=tmp_path / "scratch")
    assert [name.rpartition("/")[2] for name, _ in found.traces] == ["a.AT2"]
    assert [one.name.rpartition("/")[2] for one in found.unusable] == ["damaged.dat"]
    assert [said.rpartition("/")[2] for said in found.passed_over] == ["DISCLAIMER.TXT: words"]


@pytest.mark.parametrize(
    "said",
    ["dt = 1/100 s", "Sampling interval: 1/100 s", "Sampling interval (s): 0,01", "Sampling rate: 0.01 sec",
     "Sampling rate: 0.1 kHz", "Sampling rate (Hz): 100,00", "Sampling period: 10 ms", "Sampling rate 100 Hz"],
)  # fmt: skip
def test_steps(tmp_path, said):
    (tmp_path / "record.txt").write_text("\n".join([said, "Units: gal", "NS EW UD", *rows(" ", first=""), ""]))
    assert [t.stats.delta for t in open_traces(tmp_path / "record.txt", [])] == pytest.approx([hand.DT] * 3)


def test_a_factor_in_a_head_is_doubtful(tmp_path):
    """Whether the numbers have it nobody can know."""
    head = ["Sampling rate: 100 Hz", "Units: gal", "Scale factor: 10", "NS EW UD"]
    (tmp_path / "record.txt").write_text("\n".join([*head, *rows(" ", first=""), ""]))
    told = [f"HN{i}: {trace.stats.kouros.notes}" for i, trace in enumerate(open_traces(tmp_path / "record.txt", []))]
    (doubt,) = doubts(told)
    assert doubt.startswith("its head names a factor of 10, and does not say whether")


def test_a_unit_that_is_none_is_quoted(tmp_path):
    (tmp_path / "record.txt").write_text(
        "\n".join(["Sampling rate: 100 Hz", "Units: 10-3 g", "NS EW UD", *rows(" ", first=""), ""])
    )
    (proposal,), _ = propose(gather([tmp_path / "record.txt"]), Answers())
    (unit,) = (one for one in proposal.questions if one.about == "unit")
    assert unit.text.startswith("Its file says '10-3 g' for the unit, which is none that is known")
