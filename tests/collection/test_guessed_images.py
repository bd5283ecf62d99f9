"""Which column names photographs: found by name or by what is in it, and said, with those that may be meant instead."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomlkit

from pipeline.collection.guess import guess

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
