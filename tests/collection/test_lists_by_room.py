"""Lists as registrars hand them over: a heading for each room, kinds by a letter, numbers of several kinds.

The objects are invented, and their sizes were written down before anything was read.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from openpyxl import Workbook
from sqlalchemy import create_engine, make_url, text

from pipeline.collection.database import database_url
from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.mapping import Mapping, load_mapping
from pipeline.collection.reading import Reading, read_items
from tests.collection.test_preset_samples import check, tms_like_database

HEAD = "N. inv.;Oggetto;Materia;H cm;L cm;P cm;Collocazione nella sala\n"
BY_ROOM = (
    HEAD + "SALA 1;;;;;;\nA 1;Anfora;ceramica;45,2;28;28;vetrina 2\nA 2;Testa;marmo;52;24;26;su base, non fissata\n"
    "SALA 2;;;;;;\nA 3;Cassettone;noce;92;128;58;a terra\nDEPOSITO;;;;;;\nA 4;Cratere;ceramica;61;55;55;scaffale 3\n"
    "Totale;;;4;;;\n"
)


def read(path: Path, written: str) -> tuple[Mapping, Reading]:
    path.write_text(written, encoding="utf-8")
    told = guess(path)
    return told.mapping, read_items(path, told.mapping)


def test_headings_of_rooms_are_the_places_of_what_stands_below_them(tmp_path: Path) -> None:
    mapping, reading = read(tmp_path / "list.csv", BY_ROOM)
    assert mapping.columns["gallery"].column == "heading"
    assert {one.object_number: (one.gallery, one.on_display) for one in reading.items} == {
        "A 1": ("SALA 1", True), "A 2": ("SALA 1", True), "A 3": ("SALA 2", True), "A 4": ("DEPOSITO", False),
    }  # fmt: skip
    assert [one.message.partition(": ")[2] for one in reading.rejected] == [
        "'Totale' has no figure in it and nothing but numbers beside it: a heading, or a sum"
    ]
    assert {one.object_number: one.displayed for one in reading.items}["A 2"] == "su base, non fissata"


def test_a_heading_with_nothing_below_it_is_told(tmp_path: Path) -> None:
    _, reading = read(tmp_path / "list.csv", BY_ROOM.replace("Totale;;;4;;;", "SALA 3;;;;;;"))
    assert [(one.row, "'SALA 3' stands alone" in one.message) for one in reading.rejected] == [(8, True)]
    assert len(reading.items) == 4


def test_an_object_of_which_nothing_is_known_is_no_heading(tmp_path: Path) -> None:
    _, reading = read(tmp_path / "list.csv", BY_ROOM.replace("A 3;", "A 9;;;;;;\nA 3;"))
    assert {one.object_number: one.gallery for one in reading.items}["A 3"] == "SALA 2"
    assert {one.object_number: one.gallery for one in reading.items}["A 9"] == "SALA 2"


def test_headings_that_name_no_places_are_none(tmp_path: Path) -> None:
    classes = BY_ROOM.replace("SALA 1", "CERAMICHE").replace("SALA 2", "MOBILI").replace("DEPOSITO", "VARIE")
    mapping, reading = read(tmp_path / "list.csv", classes)
    assert mapping.columns["gallery"].column == "Collocazione nella sala"
    assert [one.message.split("'")[1] for one in reading.rejected] == ["CERAMICHE", "MOBILI", "VARIE", "Totale"]


def test_a_column_of_that_name_is_no_heading(tmp_path: Path) -> None:
    told = guess_of(tmp_path / "list.csv", "Inv. no.;heading;H cm;W cm;D cm\n1;Room;3;4;5\n2;Room;3;4;5\n")
    file = tmp_path / "own.toml"
    file.write_text(told.replace("[source]", "[source]\nheadings = true"), encoding="utf-8")
    with pytest.raises(CollectionError, match="'heading' of its own"):
        read_items(tmp_path / "list.csv", load_mapping(str(file)))


def guess_of(path: Path, written: str) -> str:
    path.write_text(written, encoding="utf-8")
    return guess(path).text


def test_a_heading_merged_across_a_sheet_is_no_object(tmp_path: Path) -> None:
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    rows = (
        ("Inv. no.", "Object", "Height (cm)", "Room"),
        ("Room 1: Antiquity",),
        ("1922.1", "amphora", 45.2, "1"),
        ("1922.2", "bust", 52, "1"),
        ("Room 2: Sail",),
        ("1940.1", "model", 110, "2"),
    )
    for row in rows:
        sheet.append(row)
        if len(row) == 1:
            sheet.merge_cells(start_row=sheet.max_row, end_row=sheet.max_row, start_column=1, end_column=4)
    path = tmp_path / "list.xlsx"
    book.save(path)
    told = guess(path)
    reading = read_items(path, told.mapping)
    assert [(one.object_number, one.gallery) for one in reading.items] == [
        ("1922.1", "1"), ("1922.2", "1"), ("1940.1", "2"),
    ]  # fmt: skip
    assert not reading.rejected
    plain = Mapping.model_validate(told.mapping.model_dump(exclude_defaults=True) | {"source": {"format": "xlsx"}})
    reading = read_items(path, plain)
    assert [one.object_number for one in reading.items] == ["1922.1", "1922.2", "1940.1"]
    assert [one.message.partition(": ")[2] for one in reading.rejected] == [
        "'Room 1: Antiquity' is merged across all columns: a heading",
        "'Room 2: Sail' is merged across all columns: a heading",
    ]


GERMAN = (
    '<?xml version="1.0"?><Sammlung><Raum bezeichnung="Saal I">'
    '<Werk nr="P 12"><Bezeichnung>Büste</Bezeichnung><Werkstoff>Marmor</Werkstoff>'
    '<Mass art="B" einheit="cm">40</Mass><Mass art="H" einheit="cm">58,5</Mass><Mass art="T" einheit="cm">27</Mass>'
    '</Werk></Raum><Raum bezeichnung="Saal II"><Werk nr="K 101"><Bezeichnung>Vase</Bezeichnung>'
    '<Werkstoff>Porzellan</Werkstoff><Mass art="H" einheit="mm">412</Mass><Mass art="Dm" einheit="mm">195</Mass></Werk>'
    '<Werk nr="K 102"><Bezeichnung>Schale</Bezeichnung><Werkstoff>Fayence</Werkstoff>'
    '<Mass art="H" einheit="mm">96</Mass><Mass art="Dm" einheit="mm">310</Mass></Werk></Raum></Sammlung>'
)
SIZES = {"P 12": (0.585, 0.40, 0.27), "K 101": (0.412, 0.195, 0.195), "K 102": (0.096, 0.31, 0.31)}


def sizes(reading: Reading) -> dict[str, tuple[float | None, ...]]:
    found = {}
    for one in reading.items:
        assert not [problem for problem in one.problems if problem.field in ("height_m", "mass_kg")]
        assert one.mass_kg is None
        found[one.object_number] = tuple(side and round(side, 9) for side in (one.height_m, one.width_m, one.depth_m))
    return found


def test_letters_of_attributes_are_sides_beside_each_other(tmp_path: Path) -> None:
    _, reading = read(tmp_path / "export.xml", GERMAN)
    assert sizes(reading) == SIZES
    assert {one.object_number: (one.gallery, one.object_name) for one in reading.items} == {
        "P 12": ("Saal I", "Büste"), "K 101": ("Saal II", "Vase"), "K 102": ("Saal II", "Schale"),
    }  # fmt: skip


def test_rows_of_letters_are_gathered(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "own.sqlite")) as database:
        database.execute(
            "CREATE TABLE masse (inventarnummer TEXT, bezeichnung TEXT, saal TEXT, mass TEXT, wert REAL, e)"
        )
        for number, name, room, told in (
            ("P 12", "Büste", "Saal I", {"B": 400, "H": 585, "T": 270}),
            ("K 101", "Vase", "Saal II", {"H": 412, "Dm": 195}),
            ("K 102", "Schale", "Saal II", {"H": 96, "Dm": 310}),
        ):
            for kind, value in told.items():
                database.execute("INSERT INTO masse VALUES (?, ?, ?, ?, ?, 'mm')", (number, name, room, kind, value))
        database.commit()
    where = f"sqlite:///{tmp_path}/own.sqlite"
    assert sizes(read_items(where, guess(where).mapping)) == SIZES


def test_a_dump_of_an_api_gives_the_accession_number_and_sizes_as_people_write_them(tmp_path: Path) -> None:
    def one(number: str, former: str, name: str, told: dict[str, str]) -> dict[str, object]:
        return {
            "identifiers": [{"type": "accession number", "value": number}, {"type": "old number", "value": former}],
            "classification": {"objectType": name},
            "measurements": [{"kind": kind, "amount": said, "unit": None} for kind, said in told.items()],
            "location": {"current": {"code": "G2", "name": "Gallery 2", "since": "2024-01-05"}},
        }

    clock = one("2012.4", "X3", "clock", {"height": "7 ft 2 in", "width": "19 1/2 in", "depth": "10 in"})
    bowl = one("2012.5", "X4", "bowl", {"height": "11.2 cm", "diameter": "24 cm"})
    _, reading = read(tmp_path / "dump.json", json.dumps({"data": {"results": [clock, bowl]}}))
    assert {item.object_number: item.gallery for item in reading.items} == {
        "2012.4": "Gallery 2", "2012.5": "Gallery 2",
    }  # fmt: skip
    height, width, depth = sizes(reading)["2012.4"]
    assert (height, width, depth) == pytest.approx((86 * 0.0254, 19.5 * 0.0254, 0.254), abs=1e-9)
    assert sizes(reading)["2012.5"] == pytest.approx((0.112, 0.24, 0.24), abs=1e-9)


def test_small_objects_with_a_list_in_each_are_no_pages(tmp_path: Path) -> None:
    objects = [
        {
            "number": f"B {at}",
            "name": "box",
            "room": "R 1",
            "sizes": [{"type": "height", "value": at, "unit": "cm"}] * 2,
        }
        for at in (1, 2, 3)
    ]
    _, reading = read(tmp_path / "objects.json", json.dumps(objects))
    assert {one.object_number: one.height_m for one in reading.items} == {"B 1": 0.01, "B 2": 0.02, "B 3": 0.03}


def test_the_tables_of_tms_on_a_server_that_folds_names(
    tmp_path: Path, postgresql_databases: Callable[[], str]
) -> None:
    museum = tms_like_database(tmp_path)
    where = postgresql_databases()
    server = create_engine(database_url(str(make_url(where).render_as_string(False))))
    with closing(sqlite3.connect(tmp_path / "tms.sqlite")) as database, server.begin() as copy:
        for name, made in database.execute("SELECT name, sql FROM sqlite_master WHERE type = 'table'").fetchall():
            copy.execute(text(made))
            for row in database.execute(f"SELECT * FROM {name}"):  # noqa: S608
                copy.exec_driver_sql(f"INSERT INTO {name} VALUES ({', '.join(['%s'] * len(row))})", row)  # noqa: S608
    server.dispose()
    check(museum, read_items(where, guess(where).mapping))


@pytest.mark.parametrize("cell", ["18 ca.", "18 approx", "18 kg circa", "ca. 18"])
def test_about_may_stand_behind_a_number(cell: str) -> None:
    found = of_hand(cell, "kg")
    assert (found.value, found.about) == (18.0, True)
