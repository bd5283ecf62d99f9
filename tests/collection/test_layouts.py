"""The same objects in many layouts, by the guess alone: what one layout taught must not be needed for the next."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item

NAMES = ("accession_number", "title", "material", "location", "on_display", "height", "width", "depth")
THINGS = (
    ("1913.20", "Red-figure amphora", "terracotta", "Gallery 3", "yes", 42.5, 28.0, 28.0),
    ("1921.7.2", "Walnut armchair", "walnut", "Gallery 4", "yes", 98.0, 61.5, 55.0),
    ("1950.112", "Bust of a lady", "marble", "Gallery 3", "yes", 61.0, 40.0, 27.5),
    ("1977.3", "Celadon jar", "porcelain", "Store 2", "no", 18.4, 14.2, 14.2),
    ("1988.45a", "Bronze mortar", "bronze", "Gallery 4", "yes", 12.3, 15.1, 15.1),
)
SIDES = NAMES[5:]
Row = dict[str, object]


def rows(sizes: Callable[[Row], Row]) -> list[Row]:
    whole = [dict(zip(NAMES, thing, strict=True)) for thing in THINGS]
    return [{name: one for name, one in row.items() if name not in SIDES} | sizes(row) for row in whole]


def in_cm(row: Row) -> Row:
    return {f"{side}_cm": row[side] for side in SIDES}


FLAT = rows(in_cm)
ROOMS = ("Gallery 3", "Gallery 4", "Store 2")


def apart(room: str) -> list[Row]:
    return [{name: one for name, one in row.items() if name != "location"} for row in FLAT if row["location"] == room]


JSONS: dict[str, object] = {
    "pairs": {"objects": [{"fields": [{"name": key, "value": one} for key, one in row.items()]} for row in FLAT]},
    "pairs of IIIF": [
        {"id": at, "metadata": [{"label": {"en": [key]}, "value": {"en": [str(one)]}} for key, one in row.items()]}
        for at, row in enumerate(FLAT)
    ],
    "pairs by number": [
        {"id": at, "fields": {str(k): {"slug": key, "value": one} for k, (key, one) in enumerate(row.items())}}
        for at, row in enumerate(FLAT)
    ],
    "pairs within": [
        {
            "id": at,
            "element_texts": [{"text": str(one), "element": {"id": 50, "name": key}} for key, one in row.items()],
        }
        for at, row in enumerate(FLAT)
    ],
    "valued": [{key: {"value": one, "lang": "en"} for key, one in row.items()} for row in FLAT],
    "rooms": {"rooms": [{"room": room, "objects": apart(room)} for room in ROOMS]},
    "floors": {"floors": [{"floor": 1, "rooms": [{"roomName": room, "shown": apart(room)} for room in ROOMS]}]},
    "rooms by name": {room: apart(room) for room in ROOMS},
    "a frame": {key: {str(at): row[key] for at, row in enumerate(FLAT)} for key in FLAT[0]},
    "lists of cells": [list(FLAT[0]), *(list(row.values()) for row in FLAT)],
    "cells of a sheet": {"range": "A1:H6", "values": [list(FLAT[0]), *(list(row.values()) for row in FLAT)]},
    "sides with units": rows(lambda row: {"measurements": {s: {"value": row[s], "unit": "cm"} for s in SIDES}}),
    "letters with units": rows(lambda row: {"size": {s[0]: {"v": row[s], "u": "cm"} for s in SIDES}}),
    "a list in words": rows(lambda row: {"extent": [{"art": s, "wert": f"{row[s]} cm"} for s in SIDES]}),
    "pictures beside": [row | {"images": [{"id": 1, "title": "a", "width": 900, "height": 700}]} for row in FLAT],
}
CELLS = [list(FLAT[0]), *([str(one) for one in row.values()] for row in FLAT)]


def _yaml() -> str:
    return "".join("- " + "\n  ".join(f"{key}: {one}" for key, one in row.items()) + "\n" for row in FLAT)


def _documents() -> str:
    return "".join("---\n" + "\n".join(f":{key}: {one}" for key, one in row.items()) + "\n" for row in FLAT)


def _page() -> str:
    lines = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in CELLS)
    return f"<!DOCTYPE html><html><body><table><tr><td>Menu</td></tr></table><table>{lines}</table></body></html>"


def _workbook() -> str:
    lines = "".join("<Row>" + "".join(f"<Cell><Data>{c}</Data></Cell>" for c in row) + "</Row>" for row in CELLS)
    space = "urn:schemas-microsoft-com:office:spreadsheet"
    return f'<?xml version="1.0"?><Workbook xmlns="{space}"><Worksheet><Table>{lines}</Table></Worksheet></Workbook>'


def _dump() -> str:
    names = ", ".join(f"`{name}` varchar(80) DEFAULT 'a, b'" for name in FLAT[0])
    values = ",\n".join("(" + ",".join(f"'{one}'" for one in row.values()) + ")" for row in FLAT)
    made = f"CREATE TABLE `objects` ({names}, PRIMARY KEY (`title`));"
    return f"-- MySQL dump\n{made}\nINSERT INTO `objects` VALUES {values};"


def _postgres() -> str:
    lines = "\n".join("\t".join(map(str, row.values())) for row in FLAT)
    return f"-- PostgreSQL database dump\nCOPY public.objects ({', '.join(FLAT[0])}) FROM stdin;\n{lines}\n\\.\n"


def _headless() -> str:
    texts = rows(lambda row: {"sizes": f"H {row['height']} cm x W {row['width']} cm x D {row['depth']} cm"})
    return "\n".join(";".join(map(str, row.values())) for row in texts)


def _decimal_commas() -> str:
    texts = rows(lambda row: {"sizes": f"H {row['height']} cm, W {row['width']} cm, D {row['depth']} cm"})
    return "\n".join(
        ";".join(map(str, row.values())).replace(".0 cm", ",0 cm").replace(".5 cm", ",5 cm") for row in texts
    )


def _facts(number: Callable[[int, int], str]) -> str:
    lines = [
        f"{number(at, place)};{key};2024-01-01T10:{at % 60}:{place};{one}"
        for at, row in enumerate(FLAT, start=7001)
        for place, (key, one) in enumerate(row.items())
    ]
    return "\n".join(("record;field;changed;content", *lines))


TEXTS = {
    "facts.csv": lambda: _facts(lambda at, _: str(at)),
    "facts_below.csv": lambda: _facts(lambda at, place: "" if place else str(at)),
    "list.yaml": _yaml,
    "documents.yml": _documents,
    "page.html": _page,
    "page.xls": _page,
    "workbook.xml": _workbook,
    "mysql.sql": _dump,
    "postgres.sql": _postgres,
    "headless.csv": _headless,
    "commas.csv": _decimal_commas,
}


def read(path: Path) -> dict[str, Item]:
    found = proposed(str(path))
    assert [one.message for one in found.reading.suspicions if one.holds] == []
    return {item.object_number: item for item in read_items(path, found.guess.mapping).items}


def check(items: dict[str, Item]) -> None:
    assert sorted(items) == [thing[0] for thing in THINGS]
    for number, title, _, room, shown, *sides in THINGS:
        item = items[number]
        assert title in (item.title, item.object_name)
        assert (item.gallery, item.on_display) == (room, shown == "yes")
        found = [item.height_m, item.width_m, item.depth_m]
        assert found == pytest.approx([side / 100 for side in sides])


@pytest.mark.parametrize("name", JSONS)
def test_objects_in_json_are_found_by_what_they_are(name: str, tmp_path: Path) -> None:
    path = tmp_path / "export.json"
    path.write_text(json.dumps(JSONS[name]), encoding="utf-8")
    check(read(path))


@pytest.mark.parametrize("name", TEXTS)
def test_objects_in_other_texts_are_read(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(TEXTS[name](), encoding="utf-8")
    check(read(tmp_path / name))


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.yml", "- &a {number: 1, name: x}\n- *a\n", "stands for what another place says"),
        ("b.yml", "- number: 1\n  name: [x\n", "no YAML"),
        ("c.yml", "x: " + "[" * 200 + "]" * 200, "nested more than"),
        ("d.sql", "CREATE TABLE a (x int, y int);\nINSERT INTO a VALUES (1, 2), (3);\n", "1 values for 2 columns"),
        ("e.sql", "-- a dump\nCREATE TABLE a (x int);\n", "without a row"),
        ("f.html", "<!DOCTYPE html><html><body><p>No list.</p></body></html>", "without a table"),
        ("h.html", "<table><tr><td>" * 3000 + "x", "without a table"),
        (
            "i.html",
            "<table><tr><td rowspan=100000 colspan=100000>x</td></tr>" + "<tr><td>1<td colspan=9999999>2</tr>" * 200,
            "no column looks like object numbers",
        ),
        ("j.sql", "INSERT INTO t VALUES (1,'" + "x" * 100_000, "never closed"),
        ("k.sql", "/*" * 100_000, "without a row"),
        ("g.js", "// the museum\nexport const objects = [{ number: '1' }];\n", "a program of JavaScript"),
    ],
)
def test_what_cannot_be_read_so_is_refused_with_what_helps(name: str, text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(CollectionError, match=message):
        read(tmp_path / name)


def test_texts_of_dumps_are_as_they_were_written(tmp_path: Path) -> None:
    (tmp_path / "a.sql").write_text(
        "/*!40101 SET NAMES utf8 */;\nINSERT INTO `objects` (`inv_no`, `title`, `height_cm`) VALUES\n"
        "('A 1', 'Priest\\'s chair; \"low\"', 91.5),\n('A 2', 'It''s (a) cup, -- no comment', NULL),\n"
        "('A 3', N'Line\\nbreak', +12);\n",
        encoding="utf-8",
    )
    items = read(tmp_path / "a.sql")
    assert {number: (item.title, item.height_m) for number, item in items.items()} == {
        "A 1": ('Priest\'s chair; "low"', pytest.approx(0.915)),
        "A 2": ("It's (a) cup, -- no comment", None),
        "A 3": ("Line break", pytest.approx(0.12)),
    }


def test_cells_over_several_rows_of_a_page_hold_for_each_of_them(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        "<html><table><tr><th rowspan=2>Room<th rowspan=2>Inv. no.<th rowspan=2>Object<th colspan=2>Size (cm)</tr>"
        "<tr><th>H<th>W</tr><tr><td rowspan=2>Hall<td>A 1<td>Vase<td>30<td>12</tr><tr><td>A 2<td>Chair<td>92<td>50</tr>"
        "<tr><td>Store<td>A 3<td>Bust<td>61,5<td>40</tr></table></html>",
        encoding="utf-8",
    )
    items = read(tmp_path / "a.html")
    assert {n: (item.gallery, item.height_m, item.width_m) for n, item in items.items()} == {
        "A 1": ("Hall", pytest.approx(0.3), pytest.approx(0.12)),
        "A 2": ("Hall", pytest.approx(0.92), pytest.approx(0.5)),
        "A 3": ("Store", pytest.approx(0.615), pytest.approx(0.4)),
    }


def test_facts_that_name_no_field_are_refused_and_those_told_twice_are_joined(tmp_path: Path) -> None:
    facts = [
        *("1,Object name,Vase", "1,Material,glass", "1,Material,bronze", "1,Room,Hall", "1,Height,40 cm", "1,,lost"),
        *("2,Object name,Bust", "2,Material,marble", "2,Room,Hall", "2,Height,60 cm"),
        *("3,Object name,Chest", "3,Material,oak", "3,Room,Hall", "3,Height,70 cm"),
        *("4,Object name,Urn", "4,Material,marble", "4,Room,Hall", "4,Height,80 cm"),
    ]
    path = tmp_path / "facts.csv"
    path.write_text("\n".join(("number,attribute,value", *facts)), encoding="utf-8")
    reading = proposed(str(path)).reading
    assert {one.object_number: (one.object_name, one.medium, one.height_m) for one in reading.items} == {
        "1": ("Vase", "glass; bronze", 0.4),
        "2": ("Bust", "marble", 0.6),
        "3": ("Chest", "oak", 0.7),
        "4": ("Urn", "marble", 0.8),
    }
    assert [one.line for one in reading.rejected] == [7]
    assert "a fact without the name of its field, or of no object" in reading.rejected[0].message


def test_a_row_for_each_measurement_is_no_row_for_each_fact(tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    lines = [
        f"{at},{kind},{size},cm" for at in (1, 2, 3) for kind, size in (("Height", 40), ("Width", 30), ("Depth", 20))
    ]
    path.write_text("\n".join(("number,dimension,value,unit", *lines)), encoding="utf-8")
    assert [one.height_m for one in proposed(str(path)).reading.items] == [0.4] * 3


def test_ranks_of_measurements_are_no_sizes(tmp_path: Path) -> None:
    """1 and 2 were read as centimetres, and nothing said so."""

    def part(rank: int, kind: str, size: str) -> str:
        return (
            f"<Part><DimRank>{rank}</DimRank><DimensionType>{kind}</DimensionType><Dimension>{size}</Dimension></Part>"
        )

    def record(number: int, height: str, width: str) -> str:
        sizes = f"<UnitLabel> cm</UnitLabel>{part(1, 'Height', height)}{part(2, 'Width', width)}"
        return f"<Object><ObjectID>{number}</ObjectID><Dimensions><D>{sizes}</D></Dimensions></Object>"

    text = f"<Root>{record(155, '29.9000', '24.1000')}{record(333, '8.5000', '12.0000')}</Root>"
    (tmp_path / "a.xml").write_text(text, encoding="utf-8")
    items = read(tmp_path / "a.xml")
    assert [item.height_m for item in items.values()] == pytest.approx([0.299, 0.085])


def test_a_date_is_no_object_number_and_texts_of_sizes_are_no_kinds_of_them(tmp_path: Path) -> None:
    records = [
        {
            "key": f"urn:x:{at}",
            "made": str(1840 + at),
            "years": f"-{70 + at}; -31",
            "dims": f"L: 1{at}.4 cm; H: {at}.5 cm",
        }
        for at in range(1, 6)
    ]
    (tmp_path / "a.json").write_text(json.dumps(records), encoding="utf-8")
    items = read(tmp_path / "a.json")
    assert list(items) == [f"urn:x:{at}" for at in range(1, 6)]
    assert [item.height_m for item in items.values()] == pytest.approx([0.015, 0.025, 0.035, 0.045, 0.055])
