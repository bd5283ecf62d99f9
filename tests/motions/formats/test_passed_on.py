"""Tables as colleagues pass them on: what is written of one record in other forms is read as the same numbers.

What cannot be read says what is wrong in words that lead to the mending.
"""

import numpy as np
import pytest

from pipeline.motions.errors import MotionError
from pipeline.motions.reading import open_traces
from tests.motions.formats.specimens import DT, tone
from tests.motions.test_components import knet

EW, NS, UD = (amplitude * tone() for amplitude in (1.0, 2.0, -0.5))
T = DT * np.arange(len(EW))
HEAD = "time (s),EW (m/s2),NS (m/s2),UD (m/s2)"


def table(head, columns=(T, EW, NS, UD), form="%.8f", separator=","):
    rows = [
        separator.join(one if isinstance(one, str) else form % one for one in row) for row in zip(*columns, strict=True)
    ]
    return "\n".join([head, *rows, ""])


def traces(tmp_path, text):
    (tmp_path / "passed_on.csv").write_text(text, encoding="utf-8")
    return open_traces(tmp_path / "passed_on.csv", [])


@pytest.mark.parametrize(
    ("head", "separator"),
    [
        ("Χρόνος (s)\tΑνατολή-Δύση (m/s2)\tΒορράς-Νότος (m/s2)\tΚατακόρυφη (m/s2)", "\t"),
        ("Timp (s);Accelerație E-V (m/s2);Accelerație N-S (m/s2);Accelerație verticală (m/s2)", ";"),
        ("Timp (s);Acceleratie E-V (m/s2);Acceleratie N-S (m/s2);Acceleratie verticala (m/s2)", ";"),
        ("زمان (s),شرق-غرب (m/s2),شمال-جنوب (m/s2),قائم (m/s2)", ","),
        ("Время (с);В-З (м/с2);С-Ю (м/с2);Верт. (м/с2)", ";"),
        ("time (s),EW (m.s-2),NS (m.s-2),UD (m.s-2)", ","),
        ("time (s),EW (m/s-2),NS (m/s-2),UD (m/s-2)", ","),
        ("Zaman (sn);D-B (m/sn2);K-G (m/sn2);Düşey (m/sn2)", ";"),
    ],
)
def test_heads_of_more_languages_and_spellings(tmp_path, head, separator):
    found = traces(tmp_path, table(head, separator=separator))
    assert [trace.stats.kouros.orientation for trace in found] == [90.0, 0.0, "up"]
    for trace, values in zip(found, (EW, NS, UD), strict=True):
        assert trace.stats.kouros.si_factor * trace.data == pytest.approx(values, abs=6e-9)
        assert trace.stats.delta == pytest.approx(DT)


@pytest.mark.parametrize(
    "head",
    [
        "Pas de timp (s): {dt}\nNumar de puncte: {n}\nUnitati: cm/s2\nComponenta: E-V",
        "Pas de timp (s): {dt}\nNumărul de puncte: {n}\nUnități: cm/s2\nComponenta: E-V",
        "Βήμα χρόνου (s): {dt}\nΑριθμός σημείων: {n}\nΜονάδες: cm/s2",
    ],
)
def test_one_series_over_rows_under_a_head_of_romania_or_greece(tmp_path, head):
    rows = [" ".join(f"{100 * a:9.3f}" for a in EW[i : i + 8]) for i in range(0, len(EW), 8)]
    (trace,) = traces(tmp_path, "\n".join([head.format(dt=DT, n=len(EW)), *rows, ""]))
    assert trace.stats.delta == pytest.approx(DT)
    assert trace.stats.kouros.si_factor * trace.data == pytest.approx(EW, abs=6e-6)
    assert trace.stats.kouros.orientation in {90.0, None}


def test_exponents_of_double_precision(tmp_path):
    found = traces(tmp_path, table(HEAD, form="%.9E").replace("E+", "D+").replace("E-", "D-"))
    assert found[1].data == pytest.approx(NS, rel=1e-9)


@pytest.mark.parametrize("form", ["2019-07-06T03:19:{:06.3f}Z", "03:19:{:06.3f}"])
def test_clocks_where_a_time_was_named(tmp_path, form):
    stamps = [form.format(t) for t in T]
    found = traces(tmp_path, table("time,EW (m/s2),NS (m/s2),UD (m/s2)", (stamps, EW, NS, UD)))
    assert found[0].stats.delta == pytest.approx(DT)
    assert found[1].data == pytest.approx(NS, abs=6e-9)


def test_several_columns_in_volts_are_no_verticals(tmp_path):
    """Of one column alone (V) is the vertical."""
    found = traces(tmp_path, table("time (s),EW (V),NS (V),UD (V)"))
    assert {trace.stats.kouros.get("unit_said") for trace in found} == {"V"}
    assert [trace.stats.kouros.orientation for trace in found] == [90.0, 0.0, "up"]
    one = traces(tmp_path, table("unit: m/s2\ntime (s),Ch1 (E),Ch2 (N),Ch3 (V)"))
    assert [trace.stats.kouros.orientation for trace in one] == [90.0, 0.0, "up"]


GAP = np.where(np.arange(len(T)) < 30, T, T + 2.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (table(HEAD, (GAP, EW, NS, UD)), "line 32: its times go on by 2.01 s to 2.3 s, and by 0.01 s elsewhere; samp"),
        (table(HEAD, [np.repeat(one, 3) for one in (T, EW, NS, UD)]), "have the time of the row before them; rows"),
        # Accelerations without a time, whose first column would be one.
        (table("%", (EW, NS, UD), separator=" "), "goes back and forth, as no time does; name the columns: kouros"),
        (table(f"# Duration: {0.5 * DT * len(T):g} s\n{HEAD}"), "says a length of 0.3 s, and 60 samples with a"),
        (table(f"Duration (s): {2 * DT * len(T):g}\nTime step (s): {DT}\nUnits: m/s2\nEW NS UD", (EW, NS, UD),
               separator=" "), "line 1: says a length of 1.2 s, and 60 samples with a step of 0.01 s have 0.6 s"),
    ],
    ids=["gap", "rows twice", "no time", "half as long", "twice as long"],
)  # fmt: skip
def test_what_is_wrong_is_said_so_that_it_can_be_mended(tmp_path, text, said):
    with pytest.raises(MotionError) as refused:
        traces(tmp_path, text)
    assert said in str(refused.value)


def test_a_duration_of_the_strong_part_contradicts_nothing(tmp_path):
    assert len(traces(tmp_path, table(f"# Duration: 0.37 s\n# Duration: 0.6 s\n# Length: 23 km\n{HEAD}"))) == 3


def test_blank_lines_before_the_first_are_counted_in_messages(tmp_path):
    with pytest.raises(MotionError, match=r"line 35: its times go on by 2\.01 s"):
        traces(tmp_path, "\n \n\t\n" + table(HEAD, (GAP, EW, NS, UD)))


@pytest.mark.parametrize("before", ["\ufeff", "\n", " \n\n"])
def test_knet_behind_a_mark_or_blank_lines_is_no_table_without_a_unit(tmp_path, before):
    """Its counts would be taken for whatever unit is answered."""
    knet(tmp_path / "a.EW", "E-W")
    (tmp_path / "a.EW").write_text(before + (tmp_path / "a.EW").read_text(), encoding="utf-8")
    with pytest.raises(
        MotionError, match=r"a header of K-NET that does not begin with .* delete what stands before it"
    ):
        open_traces(tmp_path / "a.EW", [])
