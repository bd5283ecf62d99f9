"""Plain JSON of any museum is read without a format of its own: arrays, lines, pages of an API, folders of records.

The shapes are those of public records (Walters Art Museum, SMK, Rijksmuseum, Minneapolis), the objects are invented.
"""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import Guess, guess
from pipeline.collection.reading import read_items
from pipeline.collection.sources.json_shapes import list_in
from pipeline.collection.sources.nested import flat
from pipeline.records import Item

THINGS = (("1913.20", "Vase", 30.5, 12), ("1913.2", "Jar", 22, 15), ("b-3", "Bust", 61, 40))


def record(number: str, name: str, high: float, wide: float) -> dict[str, Any]:
    """Return an object with what makes JSON of museums hard: sizes of pictures, numbers of other objects, ids."""
    return {
        "ObjectID": f"77{len(name)}",
        "ObjectNumber": number,
        "ObjectName": name,
        "Dimensions": [
            {"type": "hoogte", "value": str(high).replace(".", ","), "unit": "cm", "part": None},
            {"type": "breedte", "value": str(wide), "unit": "cm", "part": "geheel"},
            {"type": "hoogte", "value": "99", "unit": "cm", "part": "lijst"},
        ],
        "Images": [{"ID": 5, "width": 2500, "height": 1800, "url": f"https://example.org/{number}.jpg"}],
        "RelatedObjects": [{"ObjectNumber": "other", "Title": "Another"}],
        "MuseumLocation": {"DisplayCurrentLocation": "Room 3" if wide > 12 else "Not on view"},
        "OnView": wide > 12,
    }


RECORDS = [record(*thing) for thing in THINGS]


def as_array(home: Path) -> Path:
    return written(home / "all.json", RECORDS)


def as_page(home: Path) -> Path:
    return written(home / "page.json", {"offset": 0, "found": 3, "items": RECORDS})


def as_deep_page(home: Path) -> Path:
    return written(home / "deep.json", {"data": {"hits": {"total": 3, "hits": RECORDS}}})


def as_lines(home: Path) -> Path:
    path = home / "lines.jsonl"
    path.write_text("".join(json.dumps(one) + "\n" for one in RECORDS), encoding="utf-8")
    return path


def as_packed_lines(home: Path) -> Path:
    path = home / "lines.jsonl.gz"
    path.write_bytes(gzip.compress(as_lines(home).read_bytes()))
    return path


def as_folder(home: Path) -> Path:
    for at, one in enumerate(RECORDS):
        written(home / "objects" / str(at) / f"{at}.json", one)
    return home / "objects"


def as_wrapped(home: Path) -> Path:
    for at, one in enumerate(RECORDS):
        written(home / "wrapped" / f"{at}.json", {"elapsedMilliseconds": 0, "artObject": one})
    return home / "wrapped"


def written(path: Path, value: object) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(value), encoding="utf-8")
    return path


def read(path: Path) -> tuple[Guess, list[Item]]:
    found = guess(path)
    reading = read_items(path, found.mapping)
    assert reading.rejected == ()
    return found, list(reading.items)


@pytest.mark.parametrize("made", [as_array, as_page, as_deep_page, as_lines, as_packed_lines, as_folder, as_wrapped])
def test_json_of_every_shape_is_read_by_its_guess(made: Any, tmp_path: Path) -> None:
    found, items = read(made(tmp_path))
    assert found.mapping.source.format == "json"
    # The number keeps its noughts; the picture's size, the frame's and the other object's number are not the object's.
    assert [(i.object_number, i.object_name, i.height_m, i.width_m) for i in items] == [
        (number, name, pytest.approx(high / 100), pytest.approx(wide / 100)) for number, name, high, wide in THINGS
    ]
    assert [i.on_display for i in items] == [False, True, True]
    assert [i.gallery for i in items] == ["Not on view", "Room 3", "Room 3"]


def test_numbers_keep_their_characters(tmp_path: Path) -> None:
    path = tmp_path / "n.json"
    path.write_text('[{"object_number": 1913.20, "title": "A"}, {"object_number": 1913.2, "title": "B"}]', "utf-8")
    assert [i.object_number for i in read(path)[1]] == ["1913.20", "1913.2"]


def test_two_measurements_that_contradict_each_other_are_refused() -> None:
    one = {"kind": "height", "unit": "cm"}
    cells, faults = flat({"size": [one | {"value": "30"}, one | {"value": "50"}]})
    assert cells["size.height"] == ""
    assert "30 cm and 50 cm" in faults["size.height"][0]


def test_an_object_with_lists_of_its_own_is_no_page() -> None:
    assert list_in(RECORDS[0]) == ""
    assert list_in({"artObjects": RECORDS}) == "artObjects"
    assert list_in(RECORDS) == ""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1, 2]", "JSON that holds no object with names"),
        ('{"items": [{"a": 1}]} {"other": 3}', r"line 1: no list 'items' of objects"),
        ('[{"a": 1}, "b"]', r"no object, which has names and values.*\[source\] records"),
        ('[{"object_number": "1"', "not JSON"),
        ('[{"object_number": "1"}] [{"object_number": "2"}]', "behind the end of the list"),
    ],
)
def test_what_is_no_list_of_objects_is_refused_with_the_remedy(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "odd.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CollectionError, match=message):
        read(path)


def test_a_name_that_stands_twice_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "twice.json"
    path.write_text('[{"object_number": "1", "title": "Jar", "title": "Lid", "height": NaN}]', encoding="utf-8")
    (item,) = read(path)[1]
    assert (item.title, item.height_m) == ("Jar; Lid", None)


def test_a_file_of_a_folder_that_holds_no_object_is_named(tmp_path: Path) -> None:
    home = as_folder(tmp_path)
    written(home / "z" / "index.json", ["1", "2"])
    with pytest.raises(CollectionError, match=r"z/index\.json, line 1: no object"):
        read(home)


def test_json_in_utf_16_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "wide.json"
    path.write_text(json.dumps(RECORDS), encoding="utf-16")
    with pytest.raises(CollectionError, match="save it as UTF-8"):
        read(path)
