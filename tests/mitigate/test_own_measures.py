"""Measures that Kouros does not have: a row of a museum's table, and a class of another package, as documented."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pipeline.mitigate import measure_catalogue
from pipeline.mitigate.measures import checked
from pipeline.motions import read_motion
from pipeline.settings import template
from pipeline.tables import TableError
from tests.museum import in_common, small
from tests.packages import install
from tests.warm import kouros_process

COLLECTION = """\
object_number,gallery,title,object_name,medium,support,hanging,height_m,width_m,depth_m,mass_kg,friction,furniture
1,A,Portrait,Painting,,hung,wire,0.8,0.6,0.03,8,,
2,A,Vase,Vase,bronze,freestanding,,0.5,0.1,0.1,3,0.5,floor
3,A,Plate,Plate,,freestanding,,0.03,0.3,0.3,1,,floor
"""

HOOK = """\
measure,like,order,title,limit,limit_unit,limit_high,classes,what,sentence,source
museum_hook,restrain,1,Our own hook,,,,,,Hang it on two of our hooks: they must hold {force}.,"M. Rossi, conservator"
"""

STRAP = '''
"""A strap around an object that holds it like a clamp, and is made for a force."""

from pipeline.mitigate.measures import Measure
from pipeline.mitigate.proposals import Candidate, Proposal, refused
from pipeline.mitigate.trials import Trial
from pipeline.quantities import Quantity
from pipeline.records import Support


class Strap(Measure):
    name = "strap"
    gives = ("force", "width")
    limits = 1
    limit_unit = "m"
    parameters = (Quantity("width", "m", "width of the strap", 0.0, 1.0, exclusive=True),)
    own_row = {
        "measure": "strap", "order": "2", "title": "Strap", "limit": "0.05", "limit_unit": "m", "limit_high": "",
        "classes": "", "what": "width of the strap", "sentence": "Strap it {width} wide, for {force}.", "source": "us",
    }

    def change(self, scene, parameters):
        from pipeline.mitigate.measures.base import held

        return held(scene)

    def propose(self, one, runner):
        if one.scene.support is not Support.FREESTANDING:
            return refused("it does not stand free")
        force = one.scene.parameters["mass"].high * runner.push
        numbers = {"force": (force, "N"), "width": (self.row.limit, "m")}
        return Proposal((Candidate(numbers, (Trial(self.in_place(one, numbers)),)),))
'''

POINTS = "[kouros.measures]\nstrap = museum_strap:Strap\n"


@pytest.fixture
def museum(tmp_path: Path) -> Path:
    """Three objects under one strong sine: the picture swings, the vase rocks, the plate stays where it is."""
    folder = tmp_path / "museum"
    folder.mkdir()
    in_common(folder)
    (folder / "collection.csv").write_text(COLLECTION, encoding="utf-8")
    sine = ("motions", "synthesise", "sine", "amplitude=5", "frequency=1", "cycles=3", "--out", "site")
    assert kouros(folder, *sine).returncode == 0
    text = small(template(museum="M", source="collection.csv", mapping="kouros", site="site"), sampled=False)
    (folder / "kouros.toml").write_text(text, encoding="utf-8")
    return folder


def kouros(folder: Path, *words: str, packages: Path | None = None) -> subprocess.CompletedProcess[str]:
    """The command, as another process with packages of others beside Kouros."""
    there = [str(packages), *sys.path] if packages else sys.path
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, there))}
    return kouros_process(words, folder, environment)


def ran(folder: Path, packages: Path | None = None) -> dict[str, dict[str, str]]:
    """The recommendations of a night by object number."""
    done = kouros(folder, "run", packages=packages)
    assert done.returncode == 0, done.stderr
    with (folder / "reports" / "latest" / "recommendations.csv").open(encoding="utf-8", newline="") as stream:
        return {row["object_number"]: row for row in csv.DictReader(stream)}


def test_a_row_of_a_museums_table_is_recommended_in_its_own_words(museum: Path) -> None:
    """It does what the measure does that it is like; installed, it keeps the picture from swinging."""
    (museum / "ours.csv").write_text(HOOK, encoding="utf-8")
    file = museum / "kouros.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace('measures = ""', 'measures = "ours.csv"'), encoding="utf-8")
    picture = ran(museum)["1"]
    (motion,) = read_motion(museum / "site")
    force = 8.0 * float(np.hypot(*motion.acceleration[:2]).max())
    assert (picture["measure"], picture["title"]) == ("museum_hook", "Our own hook")
    assert picture["sentence"].startswith("Hang it on two of our hooks: they must hold ")
    assert picture["parameters"] == f"force={force!r} N"
    page = next((museum / "reports" / "latest").glob("a-*.html")).read_text(encoding="utf-8")
    assert "M. Rossi, conservator" in page
    done = kouros(museum, "decide", "1", "installed", "museum_hook", "--why", "hung", "--who", "A")
    assert done.returncode == 0, done.stderr
    assert "1" not in ran(museum)
    # The row is gone: what is installed is not computed any more, and the picture swings again.
    (museum / "ours.csv").write_text(HOOK.replace("museum_hook", "other_hook"), encoding="utf-8")
    assert ran(museum)["1"]["measure"] == "other_hook"


@pytest.mark.long("test_a_row_of_a_museums_table_is_recommended_in_its_own_words")
def test_a_measure_of_another_package_is_recommended_as_if_it_were_our_own(museum: Path, tmp_path: Path) -> None:
    """With its own row, between room, which does not help a vase that rocks, and all others; it can be installed."""
    packages = tmp_path / "packages"
    packages.mkdir()
    before = ran(museum)["2"]
    assert before["measure"] != "strap"
    install(packages, "museum_strap", STRAP, POINTS)
    vase = ran(museum, packages)["2"]
    (motion,) = read_motion(museum / "site")
    force = 3.0 * float(np.hypot(*motion.acceleration[:2]).max())
    assert (vase["measure"], vase["title"]) == ("strap", "Strap")
    assert vase["parameters"] == f"force={force!r} N; width=0.05 m"
    words = ("decide", "2", "installed", "strap", "width_m=0.05", "--why", "strapped", "--who", "A")
    assert kouros(museum, *words).returncode == 2, "without the package there is no such measure"
    assert kouros(museum, *words, packages=packages).returncode == 0
    assert "2" not in ran(museum, packages)
    # Uninstalled again, the vase is what it was.
    assert ran(museum)["2"]["measure"] == before["measure"]


@pytest.mark.long("models/test_other_packages::test_a_broken_one_is_said_and_left_out")
def test_a_measure_that_cannot_be_used_is_said_and_left_out(museum: Path, tmp_path: Path) -> None:
    packages = tmp_path / "packages"
    packages.mkdir()
    install(packages, "museum_strap", STRAP.replace('"limit": "0.05"', '"limit": "wide"'), POINTS)
    done = kouros(museum, "run", packages=packages)
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stderr.split())
    assert "museum_strap 1.0 offers 'strap' (kouros.measures: museum_strap:Strap), which cannot be used" in said
    assert "column 'limit': input should be a valid number, unable to parse string as a number, not 'wide'" in said
    looked = kouros(museum, "check", packages=packages)
    assert "museum_strap 1.0 offers 'strap'" in " ".join(looked.stdout.split())


def test_what_is_no_measure_is_refused_with_its_remedy() -> None:
    scope: dict[str, type] = {"__name__": "museum_strap"}
    exec(STRAP, scope)  # noqa: S102
    strap = scope["Strap"]
    assert checked(strap) is strap
    row = dict(strap.own_row)  # type: ignore[attr-defined]

    def another(**more: object) -> type:
        return type("Another", (strap,), more)

    for value, wrong in (
        (strap.__base__, "is no class of a measure; derive one"),
        ("strap", "is no class of a measure; derive one"),
        (another(own_row=None), "it has no own_row; give it the cells"),
        (another(last_resort=True), "last_resort is for Kouros's own"),
        (another(own_row={**row, "order": "99"}), "must be below 99, that of 'remove'"),
        (another(own_row={**row, "measure": "belt", "like": "strap"}), "its own_row is of 'belt'"),
        (another(own_row={**row, "sentence": "{weight}"}), r"asks for {weight}; there is {force}, {width}"),
        (another(own_row={**row, "colour": "red"}), "column 'colour' is not known"),
    ):
        with pytest.raises(ValueError, match=re.escape(wrong)):
            checked(value)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("museum_hook,,1,T,,,,,,S,s", "line 2, measure 'museum_hook': column 'like': is empty, and nothing is known"),
        (
            "museum_hook,hook,1,T,,,,,,S,s",
            "column 'like': must be the measure that it is a kind of, one of chock",
        ),
        (
            "museum_hook,remove,1,T,,,,,,S,s",
            "column 'like': is 'remove', of which there is one only; give the row",
        ),
        ("fasten,restrain,1,T,,,,,,S,s", "column 'like': must be empty: fasten is a measure by itself; give the row a"),
        ("Museum hook,restrain,1,T,,,,,,S,s", "column 'measure': must be a name of small letters, digits and _, such"),
        (
            "store_lower,restrain,1,T,,,,,,S,s",
            "column 'measure': is 'store_lower', which Kouros advises of itself",
        ),
        ("=1+1,restrain,1,T,,,,,,S,s", "column 'measure': must be a name of small letters"),
        ("museum_hook,restrain,99.5,T,,,,,,S,s", "measure 'museum_hook': column 'order' must be below 99, that of 're"),
        ("museum_hook,restrain,1,T,,,,,,{mass},s", r"column 'sentence': asks for {mass}; there is {force}"),
        ("our_pad,grip_pad,1,T,,-,,,,S,s", "measure 'our_pad': column 'limit': is empty; write the number"),
        ("our_pad,grip_pad,1,T,0.6,m,,,,S,s", "measure 'our_pad': column 'limit_unit': must be '-', not 'm'"),
    ],
)
def test_a_row_that_cannot_be_used_is_named_with_its_remedy(tmp_path: Path, row: str, message: str) -> None:
    file = tmp_path / "ours.csv"
    file.write_text(HOOK.splitlines()[0] + f"\n{row}\n", encoding="utf-8")
    with pytest.raises(TableError) as told:
        measure_catalogue(measures=file)
    assert str(told.value).startswith("ours.csv, ")
    assert message in str(told.value)
