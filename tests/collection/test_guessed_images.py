"""Which column names photographs: found by name or by what is in it, and said, with those that may be meant instead."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import tomlkit

from pipeline.collection.guess import guess
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items

HEAD = "Object Number,Title,Gallery,Height cm"


def guessed(folder: Path, names: str, cells: list[str], choices: dict[str, str] | None = None) -> tuple[str, str]:
    """Return the column that is taken for photographs, "" for none, and what is said of it."""
    rows = [f"{n},Vase,East,{30 + n},{cell}" for n, cell in enumerate(cells)]
    file = folder / "ours.csv"
    file.write_text("\n".join([f"{HEAD},{names}", *rows]) + "\n", encoding="utf-8")
    found = guess(str(file), choices=choices or {})
    columns = tomlkit.parse(found.text)["columns"]
    said = [one for one in found.doubts if "photographs" in one]
    return (str(columns["image"]["column"]) if "image" in columns else ""), " ".join(said)  # type: ignore[index,operator]


@pytest.mark.parametrize(
    ("name", "cell"),
    [
        ("Image file", "img/{}.jpg"),
        ("Foto", "{}.TIF"),
        ("zz1", "https://images.museum.org/{}.png?size=2"),
        ("zz2", "https://iiif.museum.org/{}/info.json"),
        ("zz3", "https://iiif.museum.org/{}/manifest.json"),
    ],
)
def test_a_column_of_photographs_is_found_and_said(name: str, cell: str, tmp_path: Path) -> None:
    column, said = guessed(tmp_path, name, [cell.format(n) for n in range(6)])
    assert column == name
    assert f"column {name!r} is taken to name photographs, such as {cell.format(0)!r}" in said
    assert "--choose" not in said


def test_another_that_may_be_meant_is_named_and_can_be_chosen(tmp_path: Path) -> None:
    cells = [f"img/{n}.jpg,https://x.org/thumb/{n}.jpg,https://x.org/object/{n}" for n in range(6)]
    column, said = guessed(tmp_path, "Photo file,Thumb,Record page", cells)
    assert column == "Photo file"
    assert said.endswith("so may 'Thumb': --choose image=COLUMN takes another")
    assert guessed(tmp_path, "Photo file,Thumb,Record page", cells, {"image": "Thumb"})[0] == "Thumb"


@pytest.mark.parametrize("cell", ["a bowl of fruit", "https://museum.org/object/{}", "yes", "{}", "report {}.pdf"])
def test_what_names_no_photographs_is_not_taken_whatever_it_is_called(cell: str, tmp_path: Path) -> None:
    assert guessed(tmp_path, "Image", [cell.format(n) for n in range(6)]) == ("", "")


def test_a_mapping_as_its_page_shows_it(tmp_path: Path) -> None:
    """The column names a photograph; where it is empty the pattern does, and a number is one step of its path."""
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "photographs.md").read_text(encoding="utf-8")
    shown = tomllib.loads(page.split("```toml\n")[1].split("```")[0])
    file = tmp_path / "ours.csv"
    file.write_text(
        "No,Room,Image file,Photo credit\n1,East,img/1.jpg,Ann\n2/3 b,East,,\n3,East,a.jpg|b.jpg,\n", encoding="utf-8"
    )
    assert set(shown) == {"columns", "images"}
    columns = {"object_number": {"column": "No"}, "gallery": {"column": "Room"}, **shown["columns"]}
    whole = {
        "source": {"format": "csv", "encoding": "utf-8", "delimiter": ","},
        "museum": {"name": "Ours"},
        "columns": columns,
        "images": shown["images"],
    }
    (tmp_path / "ours.toml").write_text(tomlkit.dumps(whole), encoding="utf-8")
    found = read_items(file, load_mapping(str(tmp_path / "ours.toml"))).items
    assert [(item.object_number, item.image, item.image_credit) for item in found] == [
        ("1", "img/1.jpg", "Ann"),
        ("2/3 b", "https://images.museum.example/2%2F3%20b.jpg", ""),
        ("3", "a.jpg", ""),
    ]
