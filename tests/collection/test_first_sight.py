"""What real exports of museums that nobody had seen brought to light: each would have been misread unsaid.

Layouts are those of Tate (sides exchanged), Minneapolis (a flag of some beside places of all), the Art Institute of
Chicago and a German list of several museums (sizes in lists with bullets).
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.dimensions import choose, doubts, parse
from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item, Support

TATE = "accession_number,title,dimensions,width,height,units"


def tate(path: Path, *, crossed: bool, rows: int = 10) -> Path:
    """Write works that are 30, 31, ... cm high and 50 wide, with the columns of the two sides exchanged or not."""
    lines = [TATE]
    for at in range(rows):
        high, wide = 300 + 10 * at, 500
        sides = (high, wide) if crossed else (wide, high)
        lines.append(f"A{at:05},Work {at},support: {high} x {wide} mm,{sides[0]},{sides[1]},mm")
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("crossed", [True, False])
def test_sides_that_texts_show_to_be_exchanged_are_exchanged_and_said(crossed: bool, tmp_path: Path) -> None:
    path = tate(tmp_path / "tate.csv", crossed=crossed)
    found = proposed(str(path)).guess
    items = read_items(path, found.mapping).items
    assert [item.height_m for item in items] == pytest.approx([0.30 + 0.01 * at for at in range(10)])
    assert [item.width_m for item in items] == pytest.approx([0.5] * 10)
    assert any("are exchanged" in doubt for doubt in found.doubts) is crossed


def test_a_mapping_with_exchanged_sides_stops_a_small_import_too(tmp_path: Path) -> None:
    path = tate(tmp_path / "tate.csv", crossed=True)
    found = guess(path, choices={"height_m": "height", "width_m": "width"})
    (one,) = read_items(path, found.mapping).suspicions
    assert one.holds == "sides"
    assert "exchanged in 10 of 10 rows" in one.message


def test_squares_and_texts_of_frames_do_not_hide_exchanged_sides(tmp_path: Path) -> None:
    path = tate(tmp_path / "tate.csv", crossed=True)
    with path.open("a", encoding="utf-8") as stream:
        stream.writelines(f'\nB{at},Work,"support: 300 x 300 mm",300,300,mm' for at in range(30))
    found = guess(path, choices={"height_m": "height", "width_m": "width"})
    assert [one.holds for one in read_items(path, found.mapping).suspicions] == ["sides"]


def test_an_empty_flag_does_not_hide_what_a_gallery_shows(tmp_path: Path) -> None:
    path = tmp_path / "mia.csv"
    path.write_text(
        "accession_number,title,public_access,room\n1,Bowl,,G103\n2,Jar,1,G272\n3,Cup,,Not on View\n", encoding="utf-8"
    )
    found = guess(path)
    assert [item.on_display for item in read_items(path, found.mapping).items] == [True, True, False]
    assert any("'public_access' is empty where 'room' names a gallery" in doubt for doubt in found.doubts)


def test_misspelt_columns_are_read_and_said(tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    path.write_text(
        "Acession number,Tittle,Materails,Heigth (cm),Widht (cm),Curent location\nA.1,Vase,porcelain,30,12,Room 1\n",
        encoding="utf-8",
    )
    found = guess(path)
    (item,) = read_items(path, found.mapping).items
    assert (item.object_number, item.title, item.medium, item.gallery) == ("A.1", "Vase", "porcelain", "Room 1")
    assert (item.height_m, item.width_m) == (0.3, 0.12)
    assert sum("misspelt" in doubt for doubt in found.doubts) >= 5


@pytest.mark.parametrize(
    "text",
    [
        "• Maße: o Tiefe: 17,2 cm o Breite: 29,4 cm o Höhe: 15,8 cm • Standort: Portal",
        "Kästchen aus Holz • Maße: • Tiefe: 17,2 cm • Breite: 29,4 cm • Höhe: 15,8 cm",
    ],
)
def test_bullets_part_measurements(text: str) -> None:
    chosen = choose(parse(text, decimal=","))
    assert [one and one.value for one in (chosen.height, chosen.width, chosen.depth)] == pytest.approx(
        [0.158, 0.294, 0.172]
    )


def test_a_frame_smaller_than_its_picture_is_doubted() -> None:
    read = parse("support: 472 x 296 mm\nframe: 358 x 362 x 38 mm")
    assert ["of the frame is less" in note.message for note in doubts(read, choose(read, hung=True))] == [True]
    read = parse("support: 472 x 296 mm\nframe: 558 x 362 x 38 mm")
    assert doubts(read, choose(read, hung=True)) == ()


def test_a_height_alone_takes_the_sides_of_the_same_thing() -> None:
    chosen = choose(parse("H.: 31.5 cm; 30.5 × 28.9 × 14.3 cm"))
    assert [one and one.value for one in (chosen.height, chosen.width, chosen.depth)] == pytest.approx(
        [0.315, 0.289, 0.143]
    )


def test_an_image_and_plate_is_no_whole_beside_its_sheet() -> None:
    chosen = choose(parse("Image/plate: 19.3 × 27.8 cm; Sheet: 25.2 × 32.3 cm"))
    assert [one and one.value for one in (chosen.height, chosen.width)] == pytest.approx([0.252, 0.323])


def test_what_has_a_frame_is_a_picture_whatever_its_title_names() -> None:
    text = "support: 588 x 654 mm frame: 657 x 721 x 38 mm"
    item = Item("1", "Room", title="Pistolas, Cuchillos, Cruces", height_m=0.657, width_m=0.721, depth_m=0.038)
    assert classify(item).support is not Support.HUNG
    item = Item(
        "1", "Room", title="Pistolas, Cuchillos, Cruces", dimensions=text, height_m=0.657, width_m=0.721, depth_m=0.038
    )
    assert classify(item).support is Support.HUNG


@pytest.mark.parametrize(
    ("cells", "medium"), [("oil on canvas|bronze", True), ("http://a.org/1.jpg|http://a.org/2.jpg", False)]
)
def test_media_are_materials_and_no_pictures(cells: str, medium: bool, tmp_path: Path) -> None:
    one, two = cells.split("|")
    path = tmp_path / "list.csv"
    path.write_text(f"accession_num,title,media\n1,A,{one}\n2,B,{two}\n", encoding="utf-8")
    assert ("medium" in guess(path).mapping.columns) is medium
