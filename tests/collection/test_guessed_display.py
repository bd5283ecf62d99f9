"""A flag of display is found in nine languages or its absence is said; the museum's own number goes before a key."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import pytest

from pipeline.collection.guess import Guess, guess
from pipeline.collection.reading import read_items


def file(folder: Path, header: Sequence[str], rows: Sequence[Sequence[str]]) -> Path:
    with (folder / "x.csv").open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows([header, *rows])
    return folder / "x.csv"


def shown(path: Path, found: Guess) -> list[bool]:
    return [item.on_display for item in read_items(path, found.mapping).items]


@pytest.mark.parametrize(
    ("header", "yes", "no"),
    [
        (("Object Number", "Location", "On View"), "Yes", "No"),
        (("Inventarnummer", "Standort", "Ausgestellt"), "ja", "nein"),
        (("Numéro d'inventaire", "Emplacement", "En exposition"), "oui", "non"),
        (("Numero di inventario", "Ubicazione", "Esposto"), "sì", "no"),
        (("Número de inventario", "Ubicación", "Expuesto"), "sí", "no"),
        (("Object number", "Location", "Em exposição"), "sim", "não"),
        (("Inventarisnummer", "Standplaats", "Tentoongesteld"), "ja", "nee"),
        (("Object number", "Location", "Expus"), "da", "nu"),
        (("Object number", "Location", "展示中"), "はい", "いいえ"),
        # By what they say, whatever the column is called.
        (("Inventarnummer", "Standort", "Status"), "ausgestellt", "im Depot"),
        (("Numéro d'inventaire", "Emplacement", "Situation"), "exposé", "en réserve"),
        (("Object Number", "Location", "Notes 3"), "On view", "Not on view"),
    ],
)
def test_a_flag_is_found(header: Sequence[str], yes: str, no: str, tmp_path: Path) -> None:
    rows = [[f"A {n}", f"R {n % 3}", yes if n % 4 else no] for n in range(40)]
    path = file(tmp_path, header, rows)
    found = guess(path)
    assert found.mapping.columns["on_display"].column == header[2]
    assert shown(path, found) == [bool(n % 4) for n in range(40)]
    assert not any("nothing tells what is on display" in doubt for doubt in found.doubts)


def test_where_there_is_none_the_locations_are_asked_and_it_is_said(tmp_path: Path) -> None:
    rows = [[f"A {n}", "Réserve 2" if n % 4 == 0 else "Salle 1"] for n in range(40)]
    path = file(tmp_path, ("Numéro d'inventaire", "Emplacement"), rows)
    found = guess(path)
    assert found.mapping.display.not_on_display == ("Réserve 2",)
    assert shown(path, found) == [bool(n % 4) for n in range(40)]
    assert any("1 place counted as stores, by their names: 'Réserve 2'" in d for d in found.doubts)
    path = file(tmp_path, ("Numéro d'inventaire", "Emplacement"), [[f"A {n}", f"Salle {n % 3}"] for n in range(40)])
    found = guess(path)
    assert any("nothing tells what is on display: all objects that have a place are" in d for d in found.doubts)


def test_a_flag_of_other_words_asks_what_they_mean(tmp_path: Path) -> None:
    rows = [[f"A {n}", "Saal 1", "Dauerschau" if n % 4 else "gesperrt"] for n in range(40)]
    found = guess(file(tmp_path, ("Inventarnummer", "Standort", "Ausstellungsstatus"), rows))
    assert "on_display" not in found.mapping.columns
    (said,) = [doubt for doubt in found.doubts if "it may be on_display" in doubt]
    assert "'Dauerschau'" in said
    assert "'gesperrt'" in said
    assert "[columns.on_display] values" in said


@pytest.mark.parametrize(
    ("header", "number"),
    [
        (("id", "Object ID", "Accession Number"), 2),
        (("Accession No", "ObjectID", "identifier"), 0),
        (("record id", "Inventory number", "object_id"), 1),
        (("workid", "idno", "id"), 1),
    ],
)
def test_the_museums_number_goes_before_a_key_of_its_database(
    header: Sequence[str], number: int, tmp_path: Path
) -> None:
    rows = [[f"{n}", f"{9000 + n}", f"{70000 + n}", "Hall"] for n in range(30)]
    found = guess(file(tmp_path, (*header, "Location"), rows))
    assert found.mapping.columns["object_number"].column == header[number]
    assert any(f"object numbers are taken from {header[number]!r}, and not from" in doubt for doubt in found.doubts)


def test_a_number_that_hardly_any_object_has_is_not_taken(tmp_path: Path) -> None:
    rows = [[f"{n}", f"1913.{n}" if n < 5 else "", "Hall"] for n in range(30)]
    found = guess(file(tmp_path, ("Object ID", "Accession Number", "Location"), rows))
    assert found.mapping.columns["object_number"].column == "Object ID"
    some = [[f"{n}", f"1913.{n % 20}" if n < 25 else "", "Hall"] for n in range(30)]
    found = guess(file(tmp_path, ("Object ID", "Accession Number", "Location"), some))
    # It is theirs only where it tells most of them apart.
    assert found.mapping.columns["object_number"].column == "Object ID"
    assert any("'Accession Number' gives many objects one number" in doubt for doubt in found.doubts)
    few = [[f"{n}", f"1913.{min(n, 27)}", "Hall"] for n in range(30)]
    found = guess(file(tmp_path, ("Object ID", "Accession Number", "Location"), few))
    assert found.mapping.columns["object_number"].column == "Accession Number"
    assert any("'Accession Number' repeats 2 object numbers" in doubt for doubt in found.doubts)
