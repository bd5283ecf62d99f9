"""Messages about earthquakes: what they say of a place, and what is refused."""

import gzip
import math
import re
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from pipeline.event.message import NINETY, MessageError, SiteShaking, kilometres
from pipeline.event.reading import EventFiles, read_files
from pipeline.event.stations import StationList
from tests.event.messages import ALERT_MAP, DATA, NOW, PARK, alert


def told(*files: Path) -> EventFiles:
    return read_files(files, NOW)


def shaking(name: str, place: tuple[float, float] = PARK) -> SiteShaking:
    return told(DATA / name).messages[0].at(*place)


def written(folder: Path, name: str, change: Callable[[str], str]) -> Path:
    """A real message with something else in it."""
    text = (DATA / name).read_text("utf-8")
    changed = change(text)
    assert changed != text
    file = folder / name
    file.write_text(changed, encoding="utf-8")
    return file


def test_a_map_is_interpolated_between_its_points() -> None:
    """At a point it is what is printed there; half way between two, their geometric mean."""
    at_point = shaking("loma_prieta_grid.xml", (37.7632, -122.48))
    # Printed for this point: 14.37 %g and 18.93 cm/s, STDPGA 0.10.  The printed place has four decimals of a degree.
    assert (at_point.pga_g, at_point.pgv_cm_s) == pytest.approx((0.1437, 18.93), rel=1e-3)
    assert at_point.pga_ln_sd == pytest.approx(0.10, abs=1e-3)
    half = shaking("loma_prieta_grid.xml", (37.7632, -122.4675))
    assert half.pga_g == pytest.approx(math.sqrt(0.1437 * 0.1379), rel=1e-3)
    assert any("PGV" in note and "judgement" in note for note in half.notes)


def test_versions_of_the_map_agree_on_their_units() -> None:
    """ShakeMap 3 (pctg, cms) and 4 (%g, cm/s, other columns) of one earthquake, within the spread that they state."""
    place = (19.43, -155.28)
    third, fourth = shaking("hawaii_v3_grid.xml", place), shaking("hawaii_v4_grid.xml", place)
    spread = math.hypot(third.pga_ln_sd, fourth.pga_ln_sd)
    assert abs(math.log(third.pga_g / fourth.pga_g)) < NINETY * spread
    assert third.pgv_ln_sd == 0.531195
    assert (fourth.pga_ln_sd, fourth.pgv_ln_sd) == (0.70, 0.65)
    assert sum("Boore" in note for note in fourth.notes) == 2
    quakes = [told(DATA / f"hawaii_v{version}_grid.xml").quake for version in (3, 4)]
    assert [quake.time for quake in quakes] == [datetime(2018, 5, 4, 22, 32, second, tzinfo=UTC) for second in (55, 54)]


def test_a_packed_map_reads_the_same(tmp_path: Path) -> None:
    packed = tmp_path / "grid.xml.gz"
    packed.write_bytes(gzip.compress((DATA / "loma_prieta_grid.xml").read_bytes()))
    assert told(packed).messages[0].at(*PARK) == shaking("loma_prieta_grid.xml")


def test_hindcast_the_first_message_contains_what_the_map_says() -> None:
    """Loma Prieta at Golden Gate Park: first 3.9 % of g, then 14.4 % and 18.9 cm/s."""
    file = DATA / "loma_prieta_grid.xml"
    later = told(file).messages[0].at(*PARK)
    assert later.pga_g == pytest.approx(0.144, abs=0.002)
    low, high = later.pgv_range()
    assert low < 18.9 < high


def test_a_first_alert_is_wide_enough(tmp_path: Path) -> None:
    file = tmp_path / "alert.xml"
    file.write_text(alert(), encoding="utf-8")
    first = told(file).messages[0].at(*PARK)
    assert first.pga_g == pytest.approx(0.039, rel=0.01)
    low, high = first.pga_range()
    assert low < 0.144 < high
    low, high = first.pgv_range()
    assert low < 18.9 < high
    assert "ShakeAlert" in first.origin
    with pytest.raises(MessageError, match=r"lies [\d,]+ km outside of the alert's weakest contour"):
        told(file).messages[0].at(45.0, -100.0)


def test_napa_stations_lie_within_what_the_others_say_of_their_place() -> None:
    """Each station left out: 9 of 10 recorded peaks lie within the range that the others give for its place.

    Of 60 stations 90 % lie within 0.9 -+ 0.076 in 19 of 20 cases; 4 more of them may share their errors with others.
    """
    stations = told(DATA / "napa_stationlist.xml").messages[0]
    assert isinstance(stations, StationList)
    off: dict[str, list[float]] = {"pga": [], "pgv": []}
    for one in stations.stations:
        found = stations.without(one.code).at(one.latitude, one.longitude)
        if one.pga_g and one.pgv_cm_s and found.pgv_cm_s:
            off["pga"].append(math.log(one.pga_g / found.pga_g) / found.pga_ln_sd)
            off["pgv"].append(math.log(one.pgv_cm_s / found.pgv_cm_s) / found.pgv_ln_sd)
    for scores in off.values():
        assert len(scores) > 50
        assert np.mean(np.abs(scores) < NINETY) > 0.76
        # Nor are the ranges so wide that they say nothing: a deviation of half would put 99.9 % inside.
        assert np.std(scores) > 0.5


def test_a_place_outside_is_refused_with_the_distance() -> None:
    """New York is 4,130 km from San Francisco by any almanac."""
    for name in ("loma_prieta_grid.xml", "napa_stationlist.xml"):
        with pytest.raises(MessageError) as refusal:
            shaking(name, (40.71, -74.01))
        found = re.search(r"([\d,]+) km", str(refusal.value))
        assert found is not None
        assert int(found[1].replace(",", "")) == pytest.approx(4130, rel=0.02)
        assert "--at" in str(refusal.value) or "near the museum" in str(refusal.value)
    assert kilometres(0.0, 0.0, 0.0, 90.0) == pytest.approx(10_007.5, rel=1e-4)


def test_a_map_across_the_date_line_is_one(tmp_path: Path) -> None:
    """The same map 57.6 degrees further west lies on both sides of 180 degrees."""

    def moved(text: str) -> str:
        head, data = text.split("<grid_data>")
        rows = re.sub(r"^(-122\.\d+)", lambda m: f"{float(m[1]) - 57.53:.4f}", data, flags=re.MULTILINE)
        return f"{head}<grid_data>{rows}"

    file = written(tmp_path, "loma_prieta_grid.xml", moved)
    there = told(file).messages[0].at(37.77, 180.0 - 0.0)
    assert there.pga_g == pytest.approx(shaking("loma_prieta_grid.xml").pga_g, rel=1e-6)


REFUSED = {
    "cut off": (lambda t: t[:2500], "no whole XML"),
    "numbers missing": (lambda t: re.sub(r"\n[^\n]*\n</grid_data>", "\n</grid_data>", t), "in place of 6 x 6 x 11"),
    "no number": (lambda t: t.replace(" 14.37 ", " ****** "), "no number"),
    "magnitude 0": (lambda t: t.replace('magnitude="6.9"', 'magnitude="0.0"'), "wait for the next version"),
    "in the future": (lambda t: t.replace("1989-10-18T00", "2027-10-18T00"), "later than this machine's clock"),
    "unit not known": (lambda t: t.replace('"pctg"', '"furlong"'), "'furlong' is not known"),
    "no PGA": (lambda t: t.replace('name="PGA"', 'name="PGX"'), "has no PGA"),
    "an entity": (
        lambda t: t.replace("<shakemap_grid", '<!DOCTYPE g [<!ENTITY a "b">]><shakemap_grid', 1),
        "document type or entities",
    ),
    "a document type from elsewhere": (
        lambda t: t.replace("<shakemap_grid", '<!DOCTYPE g SYSTEM "http://example.org/g.dtd"><shakemap_grid', 1),
        "document type or entities",
    ),
    "hidden in another encoding": (lambda t: t.replace('encoding="UTF-8"', 'encoding="UTF-7"'), "encoding"),
    "no event": (lambda t: re.sub(r"<event [^>]*/>", "", t), "event: is missing"),
    "a grid of too many": (lambda t: t.replace('nlon="6"', 'nlon="600000000"'), "make no map"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_bad_map_is_refused_with_file_and_remedy(what: str, tmp_path: Path) -> None:
    change, message = REFUSED[what]
    file = written(tmp_path, "loma_prieta_grid.xml", change)
    with pytest.raises(MessageError, match=re.escape(message)) as refusal:
        told(file)
    assert str(refusal.value).startswith(f"{file}: ")
    assert "; " in str(refusal.value)


def test_empty_units_are_refused_with_the_remedy() -> None:
    with pytest.raises(MessageError, match=r"has no unit.*take grid.xml of the event's ShakeMap"):
        told(DATA / "loma_prieta_groundfailure_grid.xml")


def test_entities_among_the_elements_of_a_station_list_are_refused(tmp_path: Path) -> None:
    for more in ('<!ENTITY a "b">', '<!ENTITY % a "b">', "%a;"):
        file = written(tmp_path, "napa_stationlist.xml", lambda t, more=more: t.replace("]>", f"{more}\n]>", 1))
        with pytest.raises(MessageError, match="document type or entities"):
            told(file)


def test_damaged_packing_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "grid.xml.gz"
    file.write_bytes(gzip.compress((DATA / "loma_prieta_grid.xml").read_bytes())[:500])
    with pytest.raises(MessageError, match="cut off or damaged"):
        told(file)
    with pytest.raises(MessageError, match="cannot be read"):
        told(tmp_path / "absent.xml")


def test_alerts_say_their_units_and_may_be_taken_back(tmp_path: Path) -> None:
    file = tmp_path / "alert.xml"
    file.write_text(alert(unit=""), encoding="utf-8")
    with pytest.raises(MessageError, match="contour PGA: has no unit"):
        told(file)
    file.write_text(alert(kind="delete"), encoding="utf-8")
    with pytest.raises(MessageError, match="takes the earthquake back: it is cancelled; earlier answers stay"):
        told(file)
    # Beside a map, which is believed more: a person says which of them holds.
    with pytest.raises(MessageError, match=r"alert.xml: takes the earthquake back.*leave it out if the other files"):
        told(DATA / "loma_prieta_grid.xml", file)
    file.write_text(re.sub("<gm_info>.*</gm_info>", "", alert(), flags=re.DOTALL), encoding="utf-8")
    with pytest.raises(MessageError, match="says no shaking"):
        told(file).messages[0].at(*PARK)


def test_the_map_of_an_alert_is_interpolated_between_its_points(tmp_path: Path) -> None:
    """Half way between 0.1 and 0.025 g lies 0.05 g in the logarithm, and between 10 and 2.5 cm/s 5 cm/s."""
    file = tmp_path / "alert.xml"
    text = alert().replace("<gm_info>", f"<gm_info>{ALERT_MAP}")
    file.write_text(text, encoding="utf-8")
    found = told(file).messages[0].at(37.7, -122.5)
    assert (found.pga_g, found.pgv_cm_s) == pytest.approx((0.05, 5.0), rel=1e-3)
    assert "points of its map" in found.origin
    at_point = told(file).messages[0].at(37.8, -122.4)
    assert at_point.pga_g == pytest.approx(0.025, rel=1e-3)
    with pytest.raises(MessageError, match=r"lies [\d,]+ km from the nearest point of the alert's map"):
        told(file).messages[0].at(36.0, -122.5)
    for old, new, message in (
        ('name="PGV"', 'name="PGX"', "has no field PGV"),
        ('units="cm/s/s"/>', 'units=""/>', "grid_field PGA: has no unit"),
        ("98.0665 10.0 5.0", "98.0665", "too short lines"),
        ("98.0665 10.0 5.0", "-98.0665 10.0 5.0", "what is no peak"),
        ("98.0665 10.0 5.0", "nan 10.0 5.0", "'nan' is no number"),
    ):
        file.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(MessageError, match=re.escape(message)):
            told(file)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace(" 14.37 ", " nan "), "no number at the museum"),
        (lambda t: t.replace(" 14.37 ", " -14.37 "), "no number at the museum"),
        (lambda t: t.replace('"pctg"', '"g"'), "more than was ever recorded"),
        (lambda t: t.replace(" 0.1 0.21 425", " -0.1 0.21 425"), "is no standard deviation"),
        (lambda t: t.replace(" 0.1 0.21 425", " 90 0.21 425"), "is no standard deviation"),
    ],
)
def test_cells_that_no_shaking_has_are_refused_where_they_are_needed(
    change: Callable[[str], str], message: str, tmp_path: Path
) -> None:
    file = written(tmp_path, "loma_prieta_grid.xml", change)
    with pytest.raises(MessageError, match=message):
        told(file).messages[0].at(37.7632, -122.48)


def test_bombs_are_refused_before_they_are_unpacked(tmp_path: Path) -> None:
    """200 MB of spaces, which gzip packs into 200 kB."""
    file = tmp_path / "grid.xml.gz"
    with gzip.open(file, "wb", compresslevel=1) as stream:
        for _ in range(200):
            stream.write(b" " * (1 << 20))
    with pytest.raises(MessageError, match="more than 67,108,864 bytes"):
        told(file)


def test_of_several_messages_the_map_is_believed_and_strangers_are_refused(tmp_path: Path) -> None:
    first = tmp_path / "alert.xml"
    first.write_text(alert(), encoding="utf-8")
    both = told(first, DATA / "loma_prieta_grid.xml")
    assert [one.kind for one in both.messages] == ["ShakeMap", "ShakeAlert"]
    assert both.quake.magnitude == 6.9
    with pytest.raises(MessageError, match="different earthquakes"):
        told(first, DATA / "hawaii_v3_grid.xml")


def test_a_map_without_pgv_is_completed_and_says_so(tmp_path: Path) -> None:
    file = written(tmp_path, "loma_prieta_grid.xml", lambda t: t.replace('name="PGV"', 'name="OTHER"'))
    bare = told(file).messages[0].at(*PARK)
    assert bare.pgv_cm_s is None
    whole = bare.with_velocity(100.0, 0.5)
    assert whole.pgv_cm_s == pytest.approx(100.0 * bare.pga_g)
    assert whole.pgv_ln_sd == pytest.approx(math.hypot(bare.pga_ln_sd, 0.5))
    assert "estimated from PGA" in whole.notes[-1]
