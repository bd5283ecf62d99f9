"""Floors of a manifest: computed from the ground's motions, or recorded there, level by level."""

import numpy as np
import pytest

from pipeline.motions import MotionError, read_site
from pipeline.motions.site import levels_at
from pipeline.supports.floor import carried

FLOORS = """
[[floor]]
name = "2"
height_ratio = 0.5
period_s = 0.8

[[floor]]
name = "attic"
height_ratio = 1.0
period_s = 0.8
method = "modal"
damping = 0.05
stiffness_ratio = 5.0
modes = 3

[[floor]]
name = "old wing"
height_ratio = 0.5
"""


def test_computed_floors(three, write_manifest, tmp_path):
    three()
    site = read_site(write_manifest(extra=FLOORS), kept=tmp_path / "kept")
    assert site.floors == ("2", "attic", "old wing")
    (ground,) = site.levels[0].motions
    (second,) = levels_at(site, "2")[0].motions
    # ASCE 7-22 by hand: a1 = 1 / 0.8 = 1.25; a2 = 1 - 0.25 = 0.75; H = 1 + 0.625 + 0.75 / 1024.
    factor = 1.0 + 0.625 + 0.75 * 0.5**10
    np.testing.assert_allclose(second.motion.acceleration[:2], factor * ground.motion.acceleration[:2], rtol=1e-12)
    assert np.array_equal(second.motion.acceleration[2], ground.motion.acceleration[2])
    assert second.motion.name == "hand-made, floor 2"
    assert second.measures["pga"] == pytest.approx(factor * ground.measures["pga"], rel=1e-12)
    (attic,) = levels_at(site, "attic")[0].motions
    assert np.array_equal(attic.motion.acceleration, carried(ground.motion, 1.0, 0.8, 0.05, 5.0, 3).acceleration)
    (old,) = levels_at(site, "old wing")[0].motions
    np.testing.assert_allclose(old.motion.acceleration[:2], 2.25 * ground.motion.acceleration[:2], rtol=1e-12)
    # Kept between nights, and the same from there.
    (again,) = levels_at(read_site(tmp_path, kept=tmp_path / "kept"), "attic")[0].motions
    assert again.motion.hash == attic.motion.hash
    assert again.measures == attic.measures
    assert levels_at(site, "ground") is site.levels
    with pytest.raises(ValueError, match="there is no floor 'cellar'; it has ground, 2, attic, old wing"):
        levels_at(site, "cellar")


def recorded(folder, *levels):
    """A manifest whose floor has the ground's own record, under other names, for the levels named."""
    text = (folder / "manifest.toml").read_text(encoding="utf-8")
    body = text.split("[[level.record]]\n")[1]
    text += '\n[[floor]]\nname = "2"\n'
    for level in levels:
        own = body.replace('"hand-made"', f'"on the floor, {level}"') + "\nscale = 2.0\n"
        text += f"\n[[floor.record]]\n{own}" + (f'level = "{level}"\n' if level else "")
    (folder / "manifest.toml").write_text(text, encoding="utf-8")
    return folder


def test_a_recorded_floor(three, write_manifest):
    three()
    site = read_site(recorded(write_manifest(), "design"))
    (floor,) = levels_at(site, "2")[0].motions
    assert floor.motion.name == "on the floor, design"
    np.testing.assert_allclose(floor.motion.acceleration, 2.0 * site.levels[0].motions[0].motion.acceleration)


def test_a_recorded_floor_must_serve_every_level(three, write_manifest):
    three()
    with pytest.raises(MotionError, match="there is no level 'rare'; use design"):
        read_site(recorded(write_manifest(), "design", "rare"))
    site = read_site(recorded(write_manifest(), ""))
    assert len(levels_at(site, "2")[0].motions) == 1


def test_errors_of_a_floors_record_name_its_key(three, write_manifest):
    three()
    folder = recorded(write_manifest(), "design")
    file = folder / "manifest.toml"
    file.write_text(file.read_text().replace("scale = 2.0", "scale = -2.0"))
    with pytest.raises(MotionError, match=r"floor\[0\]\.record\[0\]\.scale: "):
        read_site(folder)
