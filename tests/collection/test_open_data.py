"""Exports with the columns of museums' open data, from files to objects with no step but the guess.

The columns are those that the National Gallery of Art (objects, objects_dimensions, locations), MoMA and Te Papa
publish; the objects are invented, and what is asserted is what was written into the files.
"""

from __future__ import annotations

import csv
import stat
from collections.abc import Sequence
from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import Guess, guess
from pipeline.collection.reading import read_items
from pipeline.collection.sources import tables
from pipeline.records import Item

INCH = 2.54
PLACES = ((1, "Main Floor, Gallery 55", 1), (2, "Ground Floor, Gallery 12", 1), (3, "Print study room", 0))
KINDS = ("Painting", "Sculpture", "Print")


def write(path: Path, head: str, rows: Sequence[Sequence[object]]) -> Path:
    path.parent.mkdir(exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(head.split(","))
        writer.writerows(rows)
    return path


def nga(folder: Path) -> Path:
    """Three tables: 30 objects, of which every third has no place; heights of 30, 31, ... cm."""
    objects, sizes = [], []
    for at in range(30):
        place = ("", *(one[0] for one in PLACES))[at % 4]
        kind, height, width = KINDS[at % 3], 30 + at, 20.5 + at
        text = f"overall: {height} x {width} cm ({height / INCH:.2f} x {width / INCH:.2f} in.)"
        objects.append([500 + at, 1, f"1937.1.{at}", place, f"Work {at}", "oil", text, kind])
        for name, value in (("height", height), ("width", width)):
            sizes.append([500 + at, "overall", name, f"{value:.10f}", "centimeters"])
    home = folder / "nga"
    write(home / "objects.csv", "objectid,accessioned,accessionnum,locationid,title,medium,dimensions,classification",
          objects)  # fmt: skip
    write(home / "objects_dimensions.csv", "objectid,element,dimensiontype,dimension,unitname", sizes)
    write(home / "locations.csv", "locationid,site,room,publicaccess,description,unitposition",
          [[number, "West Building", f"M-{number}", public, name, ""] for number, name, public in PLACES])  # fmt: skip
    return home


def read(path: Path) -> tuple[Guess, dict[str, Item]]:
    found = guess(path)
    reading = read_items(path, found.mapping)
    assert reading.rejected == ()
    return found, {item.object_number: item for item in reading.items}


def test_a_folder_of_tables_is_joined(tmp_path: Path) -> None:
    found, items = read(nga(tmp_path))
    assert found.mapping.source.format == "tables"
    assert len(found.questions) <= 1
    assert set(items) == {f"1937.1.{at}" for at in range(30)}
    for at in range(30):
        item = items[f"1937.1.{at}"]
        assert item.height_m == pytest.approx(0.01 * (30 + at), rel=1e-12)
        assert item.width_m == pytest.approx(0.01 * (20.5 + at), rel=1e-12)
        place = (None, *PLACES)[at % 4]
        assert item.on_display == (place is not None and place[2] == 1)
        assert place is None or item.gallery == place[1]


def test_the_folder_is_only_read_and_nothing_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = nga(tmp_path)
    before = {path: path.read_bytes() for path in home.iterdir()}
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    home.chmod(stat.S_IRUSR | stat.S_IXUSR)
    try:
        read(home)
    finally:
        home.chmod(stat.S_IRWXU)
    assert {path: path.read_bytes() for path in home.iterdir()} == before
    assert list((tmp_path / "temporary").iterdir()) == []


def test_a_broken_row_of_a_table_is_named(tmp_path: Path) -> None:
    home = nga(tmp_path)
    sizes = home / "objects_dimensions.csv"
    lines = sizes.read_text("utf-8").splitlines()
    lines[3] = lines[3].rsplit(",", 1)[0]
    sizes.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(CollectionError, match=r"objects_dimensions.csv, line 4: 4 cells, the header has 5"):
        guess(home)


def test_folders_that_hold_no_tables(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(CollectionError, match="a folder without CSV, JSON or XML files"):
        guess(tmp_path / "empty")
    with pytest.raises(CollectionError, match="0 CSV files"), tables.as_database(tmp_path, "utf-8", ","):
        pass
    for at in range(tables.MOST + 1):
        write(tmp_path / "many" / f"t{at}.csv", "id,name", [[1, "x"]])
    with pytest.raises(CollectionError, match="201 CSV files"):
        guess(tmp_path / "many")


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("Id,ID,", ["Id", "ID (2)", "column 3"]),
        ('a"; DROP TABLE t; --,b', ['a"; DROP TABLE t; --', "b"]),
    ],
)
def test_names_that_a_database_would_not_take(head: str, names: list[str], tmp_path: Path) -> None:
    from pipeline.collection.sources.schema import tables_of

    home = tmp_path / "what? 100 % #1"  # such as means something in an address
    write(home / 'odd "name.csv', head, [["1"] * len(names), ["2"] * len(names)])
    with tables.as_database(home, "utf-8", ",") as url:
        (table,) = tables_of(url)
    assert table.name == 'odd "name'
    assert list(table.columns) == names


def test_two_files_that_would_be_one_table(tmp_path: Path) -> None:
    for name in ("Objects.csv", "objects.tsv"):
        write(tmp_path / name, "id", [["1"]])
    message = r"Objects.csv and objects.tsv would be one table; rename"
    with pytest.raises(CollectionError, match=message), tables.as_database(tmp_path, "utf-8", ","):
        pass


def test_a_column_on_view_that_names_galleries_is_the_place(tmp_path: Path) -> None:
    """MoMA's OnView holds the gallery of what is on view, and nothing else."""
    gallery = "MoMA, Floor 5, 502, The Alfred H. Barr, Jr. Galleries"
    rows = [
        [f"Work {at}", "Bronze", f"{at}.1951", 3000 + at, gallery if at % 3 == 0 else "", 40 + at, 20 + at]
        for at in range(30)
    ]
    head = "Title,Medium,AccessionNumber,ObjectID,OnView,Height (cm),Width (cm)"
    found, items = read(write(tmp_path / "Artworks.csv", head, rows))
    assert any("'OnView' is taken to name the place" in doubt for doubt in found.doubts)
    shown = {number for number, item in items.items() if item.on_display}
    assert shown == {f"{at}.1951" for at in range(0, 30, 3)}
    assert {items[number].gallery for number in shown} == {gallery}


def test_a_flag_of_being_on_view_stays_a_flag(tmp_path: Path) -> None:
    rows = [[f"{at}.1", "x", "yes" if at % 2 else "", 40 + at] for at in range(30)]
    found, items = read(write(tmp_path / "a.csv", "Accession Number,Title,On View,Height (cm)", rows))
    assert found.mapping.columns["on_display"].column == "On View"
    assert {number for number, item in items.items() if item.on_display} == {f"{at}.1" for at in range(1, 30, 2)}


def test_a_column_that_says_the_same_of_all_names_no_object(tmp_path: Path) -> None:
    """Te Papa's type is "Object" throughout; what a thing is stands in isTypeOf."""
    names = ("teapot", "vase", "chest")
    rows = [
        [f"GH00{at}", "Object", names[at % 3], "kauri", f"Overall: {150 + at}mm (width), {220 + at}mm (height)", "true"]
        for at in range(30)
    ]
    _, items = read(
        write(tmp_path / "t.csv", "identifier,type,isTypeOf,isMadeOfSummary,observedDimension,onDisplay", rows)
    )
    for at in range(30):
        item = items[f"GH00{at}"]
        assert (item.object_name, item.medium) == (names[at % 3], "kauri")
        assert (item.height_m, item.width_m) == (pytest.approx(0.22 + 0.001 * at), pytest.approx(0.15 + 0.001 * at))
