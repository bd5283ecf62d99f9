"""A unit that cannot be: the real sizes of the bundled museum, told to be in another unit than they are."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from pipeline.collection.mapping import Mapping, load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.source_audit import ContradictionError, require_settled
from pipeline.night.importing import bundled_collection, import_collection, proposed
from pipeline.night.usual_sizes import unfit_sizes
from pipeline.operations.workspace import open_workspace
from pipeline.records import Item
from tests.museum import carnegie, workspace

HOUSE = Path(__file__).parents[1] / "data" / "collections" / "whole_exports" / "learn" / "house.csv"
SIDES = ("HEIGHTIN", "WIDTHIN", "LENGTHIN", "DEPTHIN", "DIAMIN")


@cache
def _read_in(unit: str) -> tuple[Item, ...]:
    """The bundled museum, whose columns are in inches, read as if they were in another unit."""
    right = load_mapping("carnegie")
    columns = {
        name: one.model_copy(update={"unit": unit}) if one.unit == "in" else one for name, one in right.columns.items()
    }
    wrong: Mapping = right.model_copy(update={"columns": columns})
    return tuple(read_items(bundled_collection(), wrong).items)


def test_sizes_in_their_own_unit_are_not_doubted() -> None:
    assert unfit_sizes(carnegie().items) == ()


@pytest.mark.parametrize(("unit", "much"), [("mm", "small"), ("m", "large")])
def test_a_unit_that_makes_all_things_too_large_or_too_small_stops_the_import(unit: str, much: str) -> None:
    (one,) = unfit_sizes(_read_in(unit))
    does, could = map(int, re.findall(r"\d+", one.message)[:2])
    assert could >= 200
    assert does >= 0.95 * could
    assert f"far too {much}" in one.message
    assert one.message.endswith("they would fit in cm")  # inches are nearer to centimetres than to what was said
    assert one.holds == "units"
    with pytest.raises(ContradictionError, match=r"\[holds\] units"):
        require_settled("export.csv", [one])


def _as(folder: Path, unit: str, factor: float) -> Path:
    """Write the rows of a house with its sizes in metres or millimetres, and a unit in the head of each column."""
    with HOUSE.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    path = folder / "export.csv"
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow([f"{name.removesuffix('IN').title()} ({unit})" if name in SIDES else name for name in rows[0]])
        for row in rows:
            writer.writerow([f"{float(row[n]) * factor:.4g}" if n in SIDES and row[n] else row[n] for n in row])
    return path


@pytest.mark.parametrize(
    ("unit", "factor", "fits"),
    [("cm", 0.0254, "m"), ("cm", 25.4, "mm"), ("mm", 2.54, "cm"), ("cm", 2.54, ""), ("m", 0.0254, "")],
)
def test_columns_whose_heads_name_the_wrong_unit(unit: str, factor: float, fits: str, tmp_path: Path) -> None:
    reading = proposed(str(_as(tmp_path, unit, factor))).reading
    said = [one.message for one in reading.suspicions if one.holds == "units"]
    assert [message.rpartition(" ")[2] for message in said] == [fits] * bool(fits)


def test_an_import_stops_and_the_mapping_settles_it(tmp_path: Path) -> None:
    """Vases of 3 mm: what is said of the unit stops the import, writes nothing, and is a choice once it is settled."""
    place = open_workspace(workspace(tmp_path, [f"{n},A,Vase,0.{n},0.2,0.2" for n in range(11, 41)]))
    mapping = tmp_path / "mapping.toml"
    mapping.write_text(mapping.read_text(encoding="utf-8").replace('"m"', '"cm"'), encoding="utf-8")
    before = (tmp_path / "kouros.sqlite").read_bytes()
    with pytest.raises(ContradictionError, match="30 of 30 things whose sizes are read in cm are far too small"):
        import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    assert (tmp_path / "kouros.sqlite").read_bytes() == before
    text = mapping.read_text(encoding="utf-8")
    mapping.write_text(text + '[holds]\nunits = "mapping"\n', encoding="utf-8")
    done = import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    assert len(done.reading.items) == 30
    assert any('settled by the mapping, [holds] units = "mapping"' in one.message for one in done.reading.choices)


def test_too_few_things_and_things_of_no_usual_size_say_nothing() -> None:
    items = [one for one in _read_in("m") if "chair" in one.title.casefold()]
    assert unfit_sizes(items[:5]) == ()
    assert unfit_sizes([]) == ()


@pytest.mark.parametrize(("times", "doubted"), [(4.0, False), (10.0, True)])
def test_of_things_of_one_class_more_is_asked(times: float, doubted: bool) -> None:
    """Floor vases of a metre are six times as large as vessels are (0.17 m); a wrong unit makes it ten times."""
    vases = [
        one for one in _read_in("cm") if one.object_name == "vase" or one.title.lower() in ("vase", "covered vase")
    ]
    assert len(vases) >= 20
    # In inches, which no unit of the audit is: as centimetres they are 2.54 times too small.
    large = [
        replace(
            one,
            **{
                side: 2.54 * times * size for side in ("height_m", "width_m", "depth_m") if (size := getattr(one, side))
            },
        )
        for one in vases
    ]
    assert bool(unfit_sizes(large)) is doubted
