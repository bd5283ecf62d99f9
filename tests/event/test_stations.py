"""stationlist.json of ShakeMap 4 in the form that its manual gives: units, flags, and what falls off with distance."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.event.message import NINETY, MessageError
from pipeline.event.reading import read_files
from pipeline.event.stations import StationList
from tests.event.messages import DATA, NOW, amplitude, station, station_list

HERE = (37.312901, -122.007835)


def read(file: Path) -> StationList:
    found = read_files([file], NOW).messages[0]
    assert isinstance(found, StationList)
    return found


def peaks(tmp_path: Path, *channels: dict[str, list[dict[str, object]]], **more: object) -> list[float | None]:
    """PGA of stations with these channels."""
    those = [station(f"NC.J{at:03d}", HERE, one, **more) for at, one in enumerate(channels)]
    return [one.pga_g for one in read(station_list(tmp_path, *those)).stations]


def test_the_example_of_the_manual_is_its_larger_horizontal_peak(tmp_path: Path) -> None:
    """NC.J051: 0.4807 and 0.4429 % of g along the ground, 0.2743 upwards; 0.7679 cm/s."""
    channels = {
        "01.HNE": [
            amplitude("pgv", 0.7679, "cm/s"),
            amplitude("sa(3.0)", 0.2444, "%g"),
            amplitude("pga", 0.4807, "%g"),
        ],
        "01.HNZ": [amplitude("pgv", 0.329, "cm/s"), amplitude("pga", 0.9743, "%g")],
        "01.HNN": [amplitude("pgv", 0.5312, "cm/s"), amplitude("pga", 0.4429, "%g")],
    }
    (one,) = read(station_list(tmp_path, station("NC.J051", HERE, channels))).stations
    assert (one.code, one.latitude, one.longitude) == ("NC.J051", *HERE)
    assert (one.pga_g, one.pgv_cm_s) == pytest.approx((0.004807, 0.7679))


@pytest.mark.parametrize(
    ("value", "units"),
    [
        (5.0, "%g"), (0.05, "g"), (math.log(0.05), "ln(g)"), (49.03325, "cm/s^2"), (49.03325, "gals"),
        (0.4903325, "m/s^2"),
    ],
)  # fmt: skip
def test_amplitudes_are_in_their_own_units(value: float, units: str, tmp_path: Path) -> None:
    """The units that ShakeMap's own reader knows."""
    assert peaks(tmp_path, {"HNE": [amplitude("pga", value, units)]}) == [pytest.approx(0.05)]


@pytest.mark.parametrize(("value", "units"), [(18.9, "cm/s"), (0.189, "m/s"), (math.log(18.9), "ln(cm/s)")])
def test_velocities_are_in_their_own_units(value: float, units: str, tmp_path: Path) -> None:
    (one,) = read(station_list(tmp_path, station("NC.A", HERE, {"HNE": [amplitude("pgv", value, units)]}))).stations
    assert one.pgv_cm_s == pytest.approx(18.9)


def test_what_is_flagged_never_comes_back_by_the_peak_of_the_station(tmp_path: Path) -> None:
    """properties.pga says 0.4807; the only horizontal amplitude is flagged, or there is a vertical one alone."""
    flagged = {"HNE": [amplitude("pga", 0.4807, "%g", "G")], "HNZ": [amplitude("pga", 0.3, "%g")]}
    sound = {"HNE": [amplitude("pga", 2.0, "%g", "")]}
    vertical = {"HNZ": [amplitude("pga", 0.4807, "%g")]}
    third = {f"HN{at}": [amplitude("pga", float(at), "%g")] for at in (1, 2, 3)}
    found = peaks(tmp_path, flagged, sound, vertical, {"UP": [amplitude("pga", 1.0, "%g")]}, third)
    assert found == [None, pytest.approx(0.02), None, None, pytest.approx(0.02)]


def test_what_is_left_out_is_said(tmp_path: Path) -> None:
    good = {"HNE": [amplitude("pga", 2.0, "%g"), amplitude("pgv", 3.0, "cm/s")]}
    odd = {"HNE": [amplitude("pga", 0.05, "furlong"), amplitude("pgv", 3.0, "cm/s")]}
    none = {"HNE": [amplitude("pga", 0.05, ""), amplitude("pgv", "null", "cm/s")]}
    mad = {"HNE": [amplitude("pga", 900.0, "g")]}
    file = station_list(tmp_path, *(station(f"NC.{at}", HERE, one) for at, one in enumerate((good, odd, none, mad))))
    told = " ".join(read(file).at(*HERE).notes)
    assert "pga in the unit 'furlong', which is not known (NC.1)" in told
    assert "pga without a unit (NC.2)" in told
    assert "pga of 900 g, more than was ever recorded (NC.3)" in told
    with pytest.raises(MessageError, match=r"stations: no amplitude can be used: pga without a unit \(NC.0\); take"):
        read(station_list(tmp_path, station("NC.0", HERE, {"HNE": [amplitude("pga", 0.05, "")]})))


def test_a_station_without_channels_is_taken_as_the_manual_has_it_and_said(tmp_path: Path) -> None:
    (one,) = (found := read(station_list(tmp_path, station("NC.A", HERE, {})))).stations
    assert one.pga_g == pytest.approx(0.004807)
    assert "1 stations name no channels" in found.notes[0]


def test_what_people_felt_counts_for_nothing(tmp_path: Path) -> None:
    felt = station("DYFI.87", HERE, {}, station_type="macroseismic", pga=6.8063)
    other = station("DYFI.88", HERE, {}, pga=6.8063)
    sound = station("NC.A", HERE, {"HNE": [amplitude("pga", 2.0, "%g")]})
    assert [one.code for one in read(station_list(tmp_path, felt, other, sound)).stations] == ["NC.A"]


def napa(tmp_path: Path) -> tuple[Path, StationList]:
    """The stations of Napa 2014 as a list of ShakeMap 4, which does not say where the earthquake was."""
    old = read(DATA / "napa_stationlist.xml")
    those = [
        station(one.code, (one.latitude, one.longitude),
                {"HNE": [amplitude("pga", 100.0 * (one.pga_g or 0.0), "%g"), amplitude("pgv", one.pgv_cm_s, "cm/s")]})
        for one in old.stations
    ]  # fmt: skip
    return station_list(tmp_path, *those), old


def test_a_list_that_is_cut_off_is_refused(tmp_path: Path) -> None:
    file, _ = napa(tmp_path)
    file.write_text(file.read_text("utf-8")[:5000], encoding="utf-8")
    with pytest.raises(MessageError, match="no whole JSON"):
        read(file)


def test_stations_fall_off_from_the_earthquake_that_another_file_names(tmp_path: Path) -> None:
    """Beside a message of the same earthquake the list says what that of version 3 says, which names it itself."""
    file, old = napa(tmp_path)
    quake = old.quake
    assert quake.time is not None
    first = tmp_path / "alert.xml"
    first.write_text(
        f"""<event_message message_type="new" version="0"><core_info id="1"><mag>{quake.magnitude}</mag>
        <lat>{quake.latitude}</lat><lon>{quake.longitude}</lon><depth>{quake.depth_km}</depth>
        <orig_time>{quake.time:%Y-%m-%dT%H:%M:%SZ}</orig_time></core_info></event_message>""", "utf-8",
    )  # fmt: skip
    place = (38.3, -122.3)
    alone = read(file).at(*place)
    beside = read_files([file, first], NOW).messages[0].at(*place)
    assert beside.pga_g == pytest.approx(old.at(*place).pga_g, rel=1e-6)
    assert any("how the shaking falls off with distance is not fitted; give a message" in note for note in alone.notes)
    assert not any("falls off" in note for note in beside.notes)


def test_each_station_of_napa_lies_in_the_range_of_the_others(tmp_path: Path) -> None:
    """Left out in turn: of 60 with a chance of 0.9 each, 49 to 59 lie inside in 99 of 100 cases."""
    _, old = napa(tmp_path)
    inside = []
    for one in old.stations:
        found = old.without(one.code).at(one.latitude, one.longitude)
        low, high = found.pga_range()
        assert one.pga_g is not None
        assert found.pga_ln_sd == pytest.approx(math.log(high / low) / 2.0 / NINETY)
        inside.append(low <= one.pga_g <= high)
    assert 49 <= np.sum(inside) <= 60
