"""Whole files of agencies: what obspy.read gives, against the numbers that the agency printed in the file.

Peaks are the agency's own (in g, cm/s and cm, as its header or its processing report has them).  The tolerance of
0.2 % is that of the printed digits (three or four) plus, for resampled records, what a straight line cuts off a peak.
"""

from __future__ import annotations

import numpy as np
import obspy
import pytest
from scipy.integrate import cumulative_trapezoid

from pipeline.quantities import G
from tests.motions.formats.conftest import RECORDS as FOLDER

UP = "up"
EVENT_1989 = "1989-10-18T00:04:00"
RECORDS = [
    # file, channel, orientation, processed, unit, samples, step, PGA in g
    ("np01002p_4225a_a.smc", 0, 133.0, True, "cm/s2", 7183, 0.005, 0.226887),
    ("np01002p_4225b_a.smc", 0, UP, True, "cm/s2", 7165, 0.005, 0.086166),
    ("np01002p_4225c_a.smc", 0, 43.0, True, "cm/s2", 7184, 0.005, 0.277669),
    ("np01002r_4225a_u.smc", 0, 133.0, False, "cm/s2", 7193, 0.005, 0.232903),
    ("np01002r_4225b_u.smc", 0, UP, False, "cm/s2", 7175, 0.005, 0.122162),
    ("np01002r_4225c_u.smc", 0, 43.0, False, "cm/s2", 7194, 0.005, 0.296635),
    ("0111a.smc", 0, 0.0, True, "cm/s2", 6001, 0.005, 0.106458),
    ("0111b.smc", 0, UP, True, "cm/s2", 6002, 0.005, 0.0492523),
    ("0111c.smc", 0, 270.0, True, "cm/s2", 6004, 0.005, 0.071788),
    ("CHAN14.V2", 0, UP, True, "cm/s2", 5696, 0.01, 0.229528),
    ("CHAN15.V2", 0, 0.0, True, "cm/s2", 5690, 0.01, 0.311034),
    ("CHAN24.V2", 0, 270.0, True, "cm/s2", 5694, 0.01, 0.298461),
    # volume 1 prints three decimals of g; its real header has the seven that stand here
    ("CE89146.V1", 0, 0.0, False, "g", 13200, 0.005, 0.0791795),
    ("CE89146.V1", 1, UP, False, "g", 13200, 0.005, 0.021055),
    ("CE89146.V1", 2, 90.0, False, "g", 13200, 0.005, 0.04529),
    ("CE89146.V2", 0, 0.0, True, "cm/s2", 12000, 0.005, 0.0788037),
    ("CE89146.V2", 1, UP, True, "cm/s2", 12000, 0.005, 0.0209338),
    ("CE89146.V2", 2, 90.0, True, "cm/s2", 12000, 0.005, 0.0450715),
    ("ce36456p_CE36456.V2", 0, 90.0, True, "cm/s2", 3251, 0.02, 0.27324),
    ("ce36456p_CE36456.V2", 1, UP, True, "cm/s2", 3250, 0.02, 0.0966742),
    ("ce36456p_CE36456.V2", 2, 0.0, True, "cm/s2", 3250, 0.02, 0.261283),
    # S16W is 196 degrees, S74E is 106; peaks of 41.6, 194.0 and 27.3 mm/s2
    ("20180212_211557_WPWS_20.V2A", 0, 196.0, True, "mm/s2", 5800, 0.02, 0.0416 / G),
    ("20180212_211557_WPWS_20.V2A", 1, 106.0, True, "mm/s2", 5800, 0.02, 0.1940 / G),
    ("20180212_211557_WPWS_20.V2A", 2, UP, True, "mm/s2", 5800, 0.02, 0.0273 / G),
    # 985881, 1341667 and 2378684 counts; 0.794729 microvolts a count, 1.2 volts a g
    ("NP1795-n.305.v0c", 0, 90.0, False, "counts", 20000, 0.005, 985881 * 0.794729e-6 / 1.2),
    ("NP1795-n.305.v0c", 1, 0.0, False, "counts", 20000, 0.005, 1341667 * 0.794729e-6 / 1.2),
    ("NP1795-n.305.v0c", 2, UP, False, "counts", 20000, 0.005, 2378684 * 0.794729e-6 / 1.2),
]


@pytest.mark.parametrize(("name", "channel", "orientation", "processed", "unit", "samples", "step", "pga"), RECORDS)
def test_what_the_agency_says(agency_file, name, channel, orientation, processed, unit, samples, step, pga):
    trace = obspy.read(str(agency_file(name)))[channel]
    said = trace.stats.kouros
    assert (said.orientation, said.processed, said.units) == (orientation, processed, unit)
    assert trace.stats.npts == len(trace.data) == samples
    assert trace.stats.delta == pytest.approx(step, rel=1e-12)
    assert np.abs(trace.data).max() * said.si_factor / G == pytest.approx(pga, rel=2e-3)
    if said.format != "COSMOS V0":
        # The file's own line; the coarsest prints the peak to a tenth of a cm/s2 or a thousandth of a g.
        assert abs(said.peak.acceleration) == pytest.approx(pga * G, abs=0.0005 * G)


VELOCITIES = [
    # file, channel, PGV in cm/s and half its last digit, PGD in cm and half its last digit
    ("CHAN14.V2", 0, 29.34, 0.005, 8.93, 0.005),
    ("CHAN15.V2", 0, 71.65, 0.005, 21.53, 0.005),
    ("CHAN24.V2", 0, 90.94, 0.005, 32.57, 0.005),
    ("CE89146.V2", 0, 3.15, 0.0005, 0.165, 0.0005),
    ("CE89146.V2", 1, 0.984, 0.0005, 0.078, 0.0005),
    ("CE89146.V2", 2, 2.783, 0.0005, 0.334, 0.0005),
    ("ce36456p_CE36456.V2", 0, 28.253, 0.0005, 5.449, 0.0005),
    ("ce36456p_CE36456.V2", 1, 11.377, 0.0005, 3.82, 0.0005),
    ("ce36456p_CE36456.V2", 2, 34.298, 0.0005, 8.911, 0.0005),
    ("20180212_211557_WPWS_20.V2A", 0, 0.165, 0.0005, 0.0131, 0.00005),
    ("20180212_211557_WPWS_20.V2A", 1, 0.509, 0.0005, 0.0279, 0.00005),
    ("20180212_211557_WPWS_20.V2A", 2, 0.091, 0.0005, 0.0042, 0.00005),
]


@pytest.mark.parametrize(("name", "channel", "pgv", "digit_v", "pgd", "digit_d"), VELOCITIES)
def test_velocity_and_displacement_are_the_agencys(agency_file, name, channel, pgv, digit_v, pgd, digit_d):
    """The peaks are those printed, and each series is the integral of the one before, at the same samples.

    Agencies filter each series by itself, so that the integrals agree only nearly: over a second they correlate by
    0.9978 at the least, and by less as soon as one series is moved by a sample.
    """
    trace = obspy.read(str(agency_file(name)))[channel]
    said = trace.stats.kouros
    velocity, displacement = np.asarray(said.velocity), np.asarray(said.displacement)
    assert np.abs(velocity).max() == pytest.approx(0.01 * pgv, abs=0.0101 * digit_v)
    assert np.abs(displacement).max() == pytest.approx(0.01 * pgd, abs=0.0101 * digit_d)
    assert abs(said.peak.velocity) == pytest.approx(0.01 * pgv, abs=1e-12)
    second = round(1.0 / trace.stats.delta)
    for rate, level in ((said.si_factor * trace.data, velocity), (velocity, displacement)):
        grown = cumulative_trapezoid(rate, dx=trace.stats.delta, initial=0.0)
        gain, gained = grown[second:] - grown[:-second], level[second:] - level[:-second]
        together = np.corrcoef(gain, gained)[0, 1]
        assert together > 0.997
        assert together > np.corrcoef(gain[1:], gained[:-1])[0, 1]
        assert together > np.corrcoef(gain[:-1], gained[1:])[0, 1]


def test_initial_velocity_of_meloland(agency_file):
    """The header prints 2.482 cm/s; integrating from rest would lose it (3.5 % of the PGV)."""
    said = obspy.read(str(agency_file("CHAN15.V2")))[0].stats.kouros
    assert abs(np.asarray(said.velocity)[0]) == pytest.approx(0.02482, abs=1e-5)


def test_irregular_times_are_told(agency_file):
    """The digitised pairs of the file, read here by their columns, lie on the resampled line."""
    path = agency_file("np01002r_4225a_u.smc")
    trace = obspy.read(str(path))[0]
    assert "24879 pairs at irregular times" in trace.stats.kouros.resampled
    rows = path.read_bytes().split(b"\r\n")[39:]
    values = [float(row[i : i + 10]) for row in rows for i in range(0, 80, 10) if row[i : i + 10].strip(b" \0")]
    t, a = np.array(values[::2]), np.array(values[1::2])
    expected = np.interp(trace.times(), t, a)
    assert np.abs(trace.data - expected).max() <= 1e-9 * np.abs(a).max()


def test_stale_records_and_nul_bytes(agency_file):
    """The system that wrote these files left NUL bytes behind one, and a stale record behind another."""
    assert b"\0" in agency_file("np01002r_4225a_u.smc").read_bytes()
    said = obspy.read(str(agency_file("np01002r_4225c_u.smc")))[0].stats.kouros
    assert said.notes.startswith("line 6236")


TIMES = {
    "CE89146.V1": ("2012-02-13T21:06:45", "record"),
    "ce36456p_CE36456.V2": ("1983-05-02T23:42:48.2", "record"),  # 16:42:48.2 PDT
    "CHAN14.V2": ("1979-10-15T23:17", "earthquake"),
    "0111a.smc": (EVENT_1989, "earthquake"),
    "20180212_211557_WPWS_20.V2A": ("2018-02-12T21:15:17", "record"),
    "NP1795-n.305.v0c": ("2019-05-05T06:47:39.93249", "record"),
}


@pytest.mark.parametrize("name", TIMES)
def test_start(agency_file, name):
    when, what = TIMES[name]
    for trace in obspy.read(str(agency_file(name))):
        assert trace.stats.starttime == obspy.UTCDateTime(when)
        assert trace.stats.kouros.start == what


def test_channels_of_a_file_have_their_own_ids(agency_file):
    stream = obspy.read(str(agency_file("CE89146.V2")))
    assert [trace.id for trace in stream] == [".89146.01.HNN", ".89146.02.HNZ", ".89146.03.HNE"]
    assert [t.id for t in obspy.read(str(agency_file("NP1795-n.305.v0c")))] == [f"NP.1795..HN{c}" for c in "ENZ"]


def test_headonly_and_gzip(agency_file):
    """obspy unpacks what is packed, and leaves the samples out where only the header is wanted."""
    path = str(agency_file("CE89146.V1"))
    heads = obspy.read(path, headonly=True)
    assert [trace.stats.npts for trace in heads] == [13200] * 3
    assert all(len(trace.data) == 0 for trace in heads)
    packed = obspy.read(str(FOLDER / "CE89146.V1.gz"))
    assert [trace.data.tolist() for trace in packed] == [trace.data.tolist() for trace in obspy.read(path)]
