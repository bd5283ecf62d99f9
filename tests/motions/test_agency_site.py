"""Processed records of an agency as a site: the headers say what they are, the agency's own numbers come out."""

import hashlib
from pathlib import Path

import obspy
import pytest

from pipeline.motions import read_site
from pipeline.motions.errors import MotionError
from pipeline.quantities import G
from tests.motions.formats.conftest import agency_file

__all__ = ["agency_file"]

MELOLAND = ("CHAN14.V2", "CHAN15.V2", "CHAN24.V2")
"""Imperial Valley 1979, El Centro, Meloland overpass: up, 360 and 270 degrees (CESMD)."""


def site(folder: Path, unpack: object, extra: str = "") -> Path:
    lines = []
    for name in MELOLAND:
        data = unpack(name).read_bytes()  # type: ignore[operator]
        (folder / name).write_bytes(data)
        lines.append(f'"{name}" = "{hashlib.sha256(data).hexdigest()}"')
    components = 'CHAN14.V2" = { axis = "z" }\n"CHAN15.V2" = { axis = "y" }\n"CHAN24.V2" = { axis = "x" }'
    (folder / "manifest.toml").write_text(
        '[site]\nname = "El Centro"\nlatitude = 32.77\nlongitude = -115.45\n'
        '[[level]]\nname = "design"\ncombine = "max"\n[[level.record]]\nname = "Meloland"\n'
        f"files = {list(MELOLAND)}\n{extra}\n"
        'source = "CESMD"\nlicence = "with credit"\n'
        f'[level.record.components]\n"{components}\n[level.record.sha256]\n' + "\n".join(lines) + "\n",
        encoding="utf-8",
    )
    return folder


def test_the_agencys_peaks_from_its_own_velocity(tmp_path: Path, agency_file: object) -> None:
    """CESMD prints PGA 0.311034 / 0.298461 / 0.229528 g and PGV 71.65 / 90.94 / 29.34 cm/s (360, 270, up).

    PGA within 0.2 %, PGV within 2 %: integrating the acceleration from rest is 3.5 % off.
    """
    (one,) = read_site(site(tmp_path, agency_file)).levels[0].motions
    assert one.measures["pga_y"] / G == pytest.approx(0.311034, rel=2e-3)
    assert one.measures["pga_x"] / G == pytest.approx(0.298461, rel=2e-3)
    assert one.measures["pga_z"] / G == pytest.approx(0.229528, rel=2e-3)
    assert 100 * one.measures["pgv_y"] == pytest.approx(71.65, rel=2e-2)
    assert 100 * one.measures["pgv_x"] == pytest.approx(90.94, rel=2e-2)
    assert 100 * one.measures["pgv_z"] == pytest.approx(29.34, rel=2e-2)
    assert "processed by its source: no baseline correction, no filter" in one.motion.steps


@pytest.mark.parametrize(
    ("name", "components", "x_azimuth"),
    [
        ("CE89146.V2", {"HNE": "x", "HNN": "y", "HNZ": "z"}, 90.0),
        ("ce36456p_CE36456.V2", {"BNE": "x", "BNN": "y", "BNZ": "z"}, 90.0),
        # Its channels look to 196 and 106 degrees: with x along 106 nothing is mixed by turning.
        ("20180212_211557_WPWS_20.V2A", {"BN2": "x", "BN1": "y", "BNZ": "z"}, 106.0),
    ],
)
def test_the_pgv_is_the_peak_of_the_agencys_own_velocity(
    tmp_path: Path, agency_file: object, name: str, components: dict[str, str], x_azimuth: float
) -> None:
    """The agency prints the peaks beside its series: PGA within 0.2 %, PGV within 0.4 %, the last digit printed.

    Integrating the acceleration instead is up to 1.6 % off for Coalinga, and 4.9 % for Waipawa.
    """
    data = agency_file(name).read_bytes()  # type: ignore[operator]
    (tmp_path / name).write_bytes(data)
    axes = ", ".join(f'{channel} = {{ axis = "{axis}" }}' for channel, axis in components.items())
    (tmp_path / "manifest.toml").write_text(
        f'[site]\nname = "s"\nlatitude = 0.0\nlongitude = 0.0\nx_azimuth = {x_azimuth}\n'
        f'[[level]]\nname = "design"\ncombine = "max"\n[[level.record]]\nname = "r"\nfiles = ["{name}"]\n'
        f'components = {{ {axes} }}\nsource = "the agency"\nlicence = "with credit"\n'
        f'sha256 = {{ "{name}" = "{hashlib.sha256(data).hexdigest()}" }}\n',
        encoding="utf-8",
    )
    (one,) = read_site(tmp_path).levels[0].motions
    printed = {t.stats.channel: t.stats.kouros.peak for t in obspy.read(str(tmp_path / name))}
    for channel, axis in components.items():
        assert one.measures[f"pga_{axis}"] == pytest.approx(abs(printed[channel].acceleration), rel=2e-3)
        assert one.measures[f"pgv_{axis}"] == pytest.approx(abs(printed[channel].velocity), rel=4e-3)


def test_the_starting_velocity_is_scaled_and_cut_with_its_motion(tmp_path: Path, agency_file: object) -> None:
    whole = read_site(site(tmp_path, agency_file)).levels[0].motions[0].measures
    twice = read_site(site(tmp_path, agency_file, "scale = 2.0")).levels[0].motions[0].measures
    late = (
        read_site(site(tmp_path, agency_file, "window_s = [3.0, 40.0]\naccept.cut_off = 'a test'"))
        .levels[0]
        .motions[0]
        .measures
    )
    assert twice["pgv_x"] == pytest.approx(2.0 * whole["pgv_x"], rel=1e-12)
    # The printed velocities have a resolution of a few 0.01 cm/s, and the cut is at a sample.
    assert late["pgv_x"] == pytest.approx(whole["pgv_x"], rel=1e-2)


def test_a_processed_record_is_never_filtered_again(tmp_path: Path, agency_file: object) -> None:
    with pytest.raises(MotionError, match=r"the files say that the record is processed"):
        read_site(site(tmp_path, agency_file, "highpass_hz = 0.1"))
