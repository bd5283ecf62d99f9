"""Linked Art records give the columns of objects; records made by hand in the shapes that museums publish."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.sources import json_records
from pipeline.collection.sources.json_records import read_values
from pipeline.collection.sources.linked_art import read_linked_art
from pipeline.collection.sources.measurements import COLUMNS

AAT = "http://vocab.getty.edu/aat/"


def concept(number: str, label: str = "") -> dict[str, Any]:
    return {"id": AAT + number, "type": "Type", "_label": label}


def size(number: str, unit: str = "300379098", **more: Any) -> dict[str, Any]:
    found: dict[str, Any] = {"type": "Dimension", "classified_as": [concept(number)], **more}
    return found | ({"unit": {"id": AAT + unit}} if unit else {})


def record(**more: Any) -> dict[str, Any]:
    return {
        "@context": "https://linked.art/ns/v1/linked-art.json",
        "id": "https://example.org/1",
        "type": "HumanMadeObject",
        "_label": "Vase",
        "identified_by": [{"type": "Identifier", "content": "A.1", "classified_as": [concept("300312355")]}],
        **more,
    }


def one(found: Any, **options: str) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """The cells of the only object that are not empty, and the faults by column."""
    _, row = read_linked_art(iter([(1, found)]), "art.json", **options)
    faults = {COLUMNS[at]: why for at, why in row.faults.items()}
    return {name: cell for name, cell in zip(COLUMNS, row.cells, strict=True) if cell}, faults


def test_values_as_texts_limits_and_the_base() -> None:
    """Limits that are close stand for their middle, those that are not are refused; a technique says the part."""
    measuring = {"type": "AttributeAssignment", "technique": [{"type": "Type", "_label": "measuring the base"}]}
    cells, faults = one(
        record(
            dimension=[
                size("300055644", value="24.1000000000"),
                size("300055647", lower_value=9.9, upper_value=10.1),
                size("300072633", lower_value=5, upper_value=9),
                size("300055647", value=7, assigned_by=[measuring]),
            ]
        )
    )
    assert (cells["height"], cells["width"], cells["base width"]) == ("24.1 cm", "10 cm", "7 cm")
    assert "depth" not in cells
    assert faults["depth"][0] == "the record gives limits only, 5 to 9"


def test_a_unit_that_is_missing_is_the_mappings_or_refused(tmp_path: Path) -> None:
    bare = record(dimension=[size("300055644", unit="", value="24.1"), size("300056240", unit="", value=3)])
    assert one(bare)[0]["height"] == "24.1"
    cells, _ = one(bare, unit="cm")
    # A length's unit says nothing of a weight.
    assert (cells["height"], cells["weight"]) == ("24.1 cm", "3")
    path = tmp_path / "art.json"
    path.write_text(json.dumps(bare), encoding="utf-8")
    (item,) = read_items(path, load_mapping("linked_art")).items
    assert item.height_m is None
    assert [p.field for p in item.problems if "no number with its unit" in p.message] == ["height_m", "mass_kg"]


def test_two_heights_without_a_part_are_refused() -> None:
    cells, faults = one(record(dimension=[size("300055644", value=115), size("300055644", value=37)]))
    assert "height" not in cells
    assert faults["height"][0] == "the record gives it twice: 115 cm and 37 cm"


def test_numbers_places_and_statements() -> None:
    cells, _ = one(
        record(
            identified_by=[
                {"type": "Identifier", "content": 70182, "classified_as": [concept("300404621")]},
                {"type": "Identifier", "content": "1987.58.6", "classified_as": [concept("300312355")]},
                {"type": "Name", "content": "Another", "classified_as": [concept("300417227")]},
                {"type": "Name", "content": "Line and Curve", "classified_as": [concept("300404670")]},
            ],
            classified_as=[concept("300133025", "Artwork"), concept("300033618", "Paintings")],
            referred_to_by=[
                {"content": "overall: 81.2 x 41.2 cm", "classified_as": [concept("300266036", "dimensions")]},
                {"content": "Oil on canvas", "classified_as": [concept("300010358", "materials")]},
                {"content": "A caption of all", "classified_as": [concept("300266036"), concept("300191074")]},
            ],
            current_location={"type": "Place", "_label": "Storage", "classified_as": [concept("300004465")]},
        )
    )
    assert cells["object_number"] == "1987.58.6"
    assert (cells["title"], cells["object_name"], cells["medium"]) == ("Line and Curve", "Paintings", "Oil on canvas")
    assert (cells["dimensions"], cells["gallery"], cells["on_display"]) == (
        "overall: 81.2 x 41.2 cm",
        "Storage",
        "false",
    )


def test_a_file_of_lines_an_array_a_page_and_a_folder_hold_the_same(tmp_path: Path) -> None:
    records = [
        record(identified_by=[{"type": "Identifier", "content": f"A.{n}"}], current_location={"_label": "Hall"})
        for n in (1, 2, 3)
    ]
    place = {"type": "Place", "_label": "Hall"}
    (tmp_path / "lines.jsonl").write_text("\n".join(map(json.dumps, [*records, place])), encoding="utf-8")
    (tmp_path / "array.json").write_text(json.dumps([*records, place], indent=1), encoding="utf-8-sig")
    (tmp_path / "page.json").write_text(json.dumps({"orderedItems": records}), encoding="utf-8")
    folder = tmp_path / "folder"
    folder.mkdir()
    for at, found in enumerate([*records, place]):
        (folder / f"{at}.json").write_text(json.dumps(found), encoding="utf-8")
    mapping = load_mapping("linked_art")
    read = [read_items(tmp_path / name, mapping).items for name in ("lines.jsonl", "array.json", "page.json", "folder")]
    assert [item.object_number for item in read[0]] == ["A.1", "A.2", "A.3"]
    assert read[0] == read[1] == read[2] == read[3]


def test_json_is_bounded_and_its_damage_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def values(content: bytes) -> list[tuple[int, Any]]:
        return list(read_values(io.BytesIO(content), "art.json"))

    assert values(b' [1, {"a": 2},\n "b"]\n') == [(1, 1), (1, {"a": 2}), (2, "b")]
    for content, said in (
        (b"", "art.json: empty"),
        (b'{"a": 1}\n{"b": ', "art.json, line 2: not JSON"),
        (b'{"a": "\xff"}', "art.json, near line 1: not UTF-8"),
        (b"[" * 100_000, "art.json, line 1: n"),
    ):
        with pytest.raises(CollectionError, match=said):
            values(content)
    monkeypatch.setattr(json_records, "RECORD_LIMIT", 1_000)
    with pytest.raises(CollectionError, match="1,000 characters without a whole value"):
        values(b'{"a": "' + b"x" * 1_000_000)
    with pytest.raises(CollectionError, match="holds no HumanMadeObject"):
        list(read_linked_art(iter([(1, {"type": "Place"})]), "art.json"))
