"""What headers say of earthquake and station, against the lines that agencies print."""

from __future__ import annotations

from io import BytesIO

import obspy
import pytest

from pipeline.motions.formats import header_facts
from tests.motions.formats import national
from tests.motions.formats import specimens as hand


def said(agency_file, name):
    return obspy.read(str(agency_file(name)))[0].stats.kouros


def test_of_the_usgs_in_csmip_s_format(agency_file):
    """IMPERIAL VALLEY, CA  EARTHQUAKE; 15 OCT 1979 - 2317 UTC; HYPOCENTER(USGS):32.640N, 115.330W, H=  KM. ML=."""
    found = said(agency_file, "CHAN14.V2")
    assert found.event_name == "Imperial Valley, CA Earthquake"
    assert found.event_time == obspy.UTCDateTime("1979-10-15T23:17")
    assert (found.event_latitude, found.event_longitude) == (32.64, -115.33)
    assert "magnitude" not in found


def test_of_cosmos(agency_file):
    """Record of  Fort Bragg, CA Earthquake of Sun May 05, 2019; the real header has ML 3.33 and a distance."""
    found = said(agency_file, "NP1795-n.305.v0c")
    assert found.event_name == "Fort Bragg, CA Earthquake"
    assert (found.magnitude, found.magnitude_type, found.event_latitude) == (3.33, "Ml", 39.561501)


def test_of_geonet_the_hemispheres_stand_in_the_text(agency_file):
    """Reals 10 to 14: 39.944 176.584 40.06 176.55 4.17, beside '39 56 38S  176 35 04E' and '40 03 27S 176 32 45E'."""
    found = said(agency_file, "20180212_211557_WPWS_20.V2A")
    assert (found.latitude, found.longitude) == (-39.944, 176.584)
    assert (found.event_latitude, found.event_longitude, found.magnitude) == (-40.06, 176.55, 4.17)
    assert (found.event_name, found.distance_km) == ("6 km south of Waipukurau", 13.0)


def test_of_csmnc_in_its_lines():
    """EPICENTER  30.300N 103.000E DEPTH 13 KM; MAGNITUDE  7.0(Ms); STATION: 051XXX 30.400N 102.800E; 8:2:46 BTM."""
    found = obspy.read(BytesIO(national.csmnc()), format="CSMNC")[0].stats.kouros
    assert (found.event_latitude, found.event_longitude, found.event_depth_km) == (30.3, 103.0, 13.0)
    assert (found.magnitude, found.magnitude_type) == (7.0, "Ms")
    assert (found.latitude, found.longitude) == (30.4, 102.8)
    assert found.event_time == obspy.UTCDateTime("2013-04-20T00:02:46")
    west = national.csmnc().replace(b"30.300N 103.000E DEPTH 13 KM", b"30.300S 103.000W           ")
    found = obspy.read(BytesIO(west), format="CSMNC")[0].stats.kouros
    assert (found.event_latitude, found.event_longitude) == (-30.3, -103.0)
    assert "event_depth_km" not in found


def test_of_the_usc_in_degrees_minutes_and_seconds():
    lines = ["NORTHRIDGE EARTHQUAKE                                                   21", "JAN 17, 1994 -1230 GMT  22",
             "STATION USC# 0061   34 17 11N, 118 13 31W                               39",
             "EPICENTER -   34 12 48N, 118 32 13W                                     35"]  # fmt: skip
    found = header_facts.of_text(lines)
    assert found["latitude"] == pytest.approx(34.0 + 17.0 / 60.0 + 11.0 / 3600.0)
    assert found["event_longitude"] == pytest.approx(-(118.0 + 32.0 / 60.0 + 13.0 / 3600.0))
    assert found["event_time"] == obspy.UTCDateTime("1994-01-17T12:30")
    assert header_facts.earthquake_name(lines) == "Northridge Earthquake"


@pytest.mark.parametrize(
    ("line", "when"),
    [
        ("15 OCT 1979 - 2317 UTC", "1979-10-15T23:17"),
        ("OCTOBER 15, 1979 16:17 PDT", "1979-10-15T23:17"),
        ("JANUARY 17, 1994 04:31 PST", "1994-01-17T12:31"),
        ("Record of Mon Feb 13, 2012 13:06 PST", None),  # when it began, of which earthquake nobody has said
        ("31 FEB 1979 - 2317 UTC", None),
        ("15 OCT 1979 - 2399 UTC", None),
        ("15 OCT 1979", None),
    ],
)
def test_a_time_to_the_minute(line, when):
    found = header_facts.earthquake_minute([line])[1]
    assert found == (None if when is None else obspy.UTCDateTime(when))


def test_a_name_in_turkish(tmp_path):
    """0xFD is a dotless i in Turkey's code, ISO 8859-9."""
    raw = national.nsmn()
    place = next(line for line in raw.splitlines() if line.startswith(b"PLACE"))
    (tmp_path / "a.txt").write_bytes(raw.replace(place, b"PLACE                   : AYD\xfdN"))
    assert obspy.read(str(tmp_path / "a.txt"))[0].stats.kouros.station_name == "AYD\N{LATIN SMALL LETTER DOTLESS I}N"


def test_a_header_of_esm_names_its_earthquake(tmp_path):
    changes = {
        "EVENT_NAME": "CENTRAL_ITALY",
        "MAGNITUDE_W": "6.0",
        "MAGNITUDE_L": "6.2",
        "EPICENTRAL_DISTANCE_KM": "12.5",
    }
    (tmp_path / "a.asc").write_bytes(hand.esm(**changes))
    found = obspy.read(str(tmp_path / "a.asc"))[0].stats.kouros
    assert (found.magnitude, found.magnitude_type, found.distance_km) == (6.0, "Mw", 12.5)
