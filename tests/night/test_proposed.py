"""What a guess says beyond its columns: sides that texts say are exchanged, and words that name no class."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.night.importing import proposed, unknown_names
from pipeline.records import Item


def export(folder: Path, crossed: int) -> Path:
    """Forty works whose texts say height x width; of the first, the columns height and width say it the other way."""
    lines = ["accession_number,title,medium,dimensions,height,width,units,location"]
    for at in range(40):
        high, wide = 400 + 10 * at, 300 + 7 * at
        sides = (wide, high) if at < crossed else (high, wide)
        lines.append(f"N{at:05d},View {at},oil on canvas,support: {high} x {wide} mm,{sides[0]},{sides[1]},mm,Room 1")
    path = folder / "works.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_columns_that_texts_say_are_exchanged_are_taken_the_other_way_round(tmp_path: Path) -> None:
    found = proposed(str(export(tmp_path, 40)))
    columns = found.guess.mapping.columns
    assert (columns["height_m"].column, columns["width_m"].column) == ("width", "height")
    assert not found.reading.suspicions
    assert found.guess.doubts[0].startswith("height and width are exchanged in 40 of 40 rows")
    assert "--choose height_m=height --choose width_m=width takes them as they are called" in found.guess.doubts[0]


@pytest.mark.parametrize("choices", [{"height_m": "height"}, {"height_m": "height", "width_m": "width"}])
def test_what_a_person_chose_is_not_exchanged(tmp_path: Path, choices: dict[str, str]) -> None:
    found = proposed(str(export(tmp_path, 40)), choices=choices)
    assert found.guess.mapping.columns["height_m"].column == "height"
    assert [one.holds for one in found.reading.suspicions] == ["sides"]


def test_a_few_exchanged_sides_are_the_rows_own(tmp_path: Path) -> None:
    found = proposed(str(export(tmp_path, 5)))
    assert found.guess.mapping.columns["height_m"].column == "height"


def named(names: list[str]) -> list[Item]:
    return [Item(str(at), "Hall", object_name=name, height_m=0.3, width_m=0.2) for at, name in enumerate(names)]


def test_a_museum_hears_that_its_words_are_of_a_language_that_is_not_known() -> None:
    unknown = ["Argizaiola", "Kirnu", "Uztarria"] * 10
    said = unknown_names(named([*unknown, *["Vase"] * 10]))
    assert said.startswith(
        "75% of the objects are called what names no class here, such as 'Argizaiola', 'Kirnu', 'Uztarria'"
    )
    assert "[collection] rules" in said
    assert unknown_names(named([*unknown[:10], *["Vase"] * 30])) == ""
    assert unknown_names(named(["Kirnu"] * 19)) == ""
    assert unknown_names([]) == ""


@pytest.mark.parametrize(
    ("case", "display", "place"),
    [
        ("Case 7", "Case 7, shelf 2", "Hall, Case 7, shelf 2"),
        ("Case 7", "case 7", "Hall, Case 7, case 7"),
        ("Case 1", "Case 12, shelf 2", "Hall, Case 1, Case 12, shelf 2"),
        ("Case 7", "on shelf 2", "Hall, Case 7, on shelf 2"),
        ("", "", "Hall"),
    ],
)
def test_a_row_as_understood_says_its_place_once_and_parts_name_and_material(
    case: str, display: str, place: str, tmp_path: Path
) -> None:
    path = tmp_path / "works.csv"
    path.write_text(
        "Object number;Object name;Material;Height cm;Room;Case;How displayed\n"
        f"1;Telescope;brass, glass;62;Hall;{case};{display}\n"
        "2;Globe;wood, paper;90;Hall;Case 3;free on plinth\n",
        encoding="utf-8",
    )
    (line, _other) = proposed(
        str(path), choices={"gallery": "Room", "case": "Case", "displayed": "How displayed"}
    ).examples
    assert line.split(" | ")[1:3] == [place, "Telescope, brass, glass"]
