"""What heads an entry of the report: what people call a thing, never a bare material, or a place and a date."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.naming import names_thing
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.tables.material_words import begins_with_material, is_material


def called(folder: Path, *lines: str) -> list[str]:
    file = folder / "list.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [item.called for item in read_items(file, proposed(str(file)).guess.mapping).items]


def test_a_description_is_no_heading_by_itself(tmp_path: Path) -> None:
    assert called(
        tmp_path,
        "Accession No;Name;Description;Height (cm);Location",
        "1;Teapot;Silver, London 1812. Bright-cut.;15;Gallery 1",
        "2;Longcase clock;Walnut, marquetry, about 1690. Month-going.;205;Gallery 1",
        "3;Bowl;China, Ming dynasty. Porcelain.;12;Gallery 2",
        "4;Painting;Oil on canvas, 1760. Barges.;60;Gallery 1",
        "5;Vase;A blue vase with a gilt rim. Bristol.;22;Gallery 2",
        "6;Ur;Moraklocka. Verk av AAS.;200;Gallery 2",
    ) == [
        "Teapot: Silver, London 1812",
        "Longcase clock: Walnut, marquetry, about 1690",
        "Bowl: China, Ming dynasty",
        "Painting: Oil on canvas, 1760",
        "A blue vase with a gilt rim",
        "Moraklocka",
    ]


def test_a_title_stays_but_for_a_bare_material_or_date(tmp_path: Path) -> None:
    assert called(
        tmp_path,
        "Accession No;Object Name;Title;Height (cm);Location",
        "1;Teapot;Silver, London 1812;15;Gallery 1",
        "2;Chair;c. 1770;98;Gallery 1",
        "3;Bust;Silver Lake;52;Gallery 2",
        "4;Statue;Dancer;60;Gallery 2",
        "5;Glass;Glass;12;Gallery 2",
        "6;Print;17 rue de Rivoli, Paris;60;Gallery 1",
    ) == ["Teapot: Silver, London 1812", "Chair: c. 1770", "Silver Lake", "Dancer", "Glass", "17 rue de Rivoli, Paris"]


def test_the_shortest_of_several_descriptions_is_the_title(tmp_path: Path) -> None:
    long = "This chair was made in Philadelphia for a house that no longer stands"
    said = called(
        tmp_path,
        "Accession No;Object;Full description;Short description;Height (cm);Location",
        f"1;Chair;{long};Side chair;98;Gallery 1",
        f"2;Chair;{long};Armchair with a pierced splat;98;Gallery 1",
    )
    assert said == ["Side chair", "Armchair with a pierced splat"]


@pytest.mark.parametrize(
    ("text", "bare"),
    [
        ("gilt bronze", True),
        ("Eiche bemalt", True),
        ("terre cuite", True),
        ("bronze figure", False),
        ("painted", False),
        ("Silver Lake", False),
    ],
)
def test_bare_materials(text: str, bare: bool) -> None:
    assert is_material(text) is bare


def test_what_a_text_begins_with() -> None:
    assert begins_with_material("Silver, London 1812")
    assert not begins_with_material("Silver Lake, 1812")
    assert names_thing("A pair of candlesticks, silver")
    assert not names_thing("View of the Thames")
