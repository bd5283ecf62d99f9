"""A mapping guessed from databases of schemas that museums made for themselves: one object, however it is told."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items

SCHEMAS = {
    "places by dates, sizes by rows": (
        "CREATE TABLE artworks (id INTEGER PRIMARY KEY, accession TEXT, name TEXT, kind TEXT, material TEXT)",
        "CREATE TABLE measures (artwork_id INTEGER, what TEXT, value REAL, uom TEXT)",
        "CREATE TABLE places (id INTEGER PRIMARY KEY, label TEXT, is_gallery INTEGER)",
        "CREATE TABLE whereabouts (artwork_id INTEGER, place_id INTEGER, date_from TEXT, date_to TEXT)",
        "INSERT INTO artworks VALUES (1, '1990.4', 'Fayencevase', 'Vase', 'Fayence')",
        "INSERT INTO artworks VALUES (2, '1991.1', 'Pot', 'Jar', 'Clay')",
        "INSERT INTO measures VALUES (1, 'height', 45, 'cm'), (1, 'width', 22, 'cm'), (1, 'weight', 3.4, 'kg')",
        "INSERT INTO measures VALUES (2, 'height', 18, 'cm'), (2, 'width', 10, 'cm'), (2, 'weight', 1.2, 'kg')",
        "INSERT INTO places VALUES (1, 'Room 3', 1), (2, 'Depot 2', 0), (3, 'Room 9', 1)",
        "INSERT INTO whereabouts VALUES (1, 3, '2010-01-01', '2018-12-31'), (1, 1, '2019-01-01', NULL)",
        "INSERT INTO whereabouts VALUES (2, 2, '2019-01-01', NULL)",
    ),
    "tables named after an application": (
        "CREATE TABLE collection_person (id INTEGER PRIMARY KEY, name TEXT)",
        "CREATE TABLE collection_objecttype (id INTEGER PRIMARY KEY, name TEXT)",
        "CREATE TABLE collection_room (id INTEGER PRIMARY KEY, name TEXT, floor INTEGER)",
        "CREATE TABLE collection_museumobject (id INTEGER PRIMARY KEY, inv_no TEXT, title TEXT, materials TEXT, "
        "object_type_id INTEGER REFERENCES collection_objecttype(id), maker_id INTEGER REFERENCES "
        "collection_person(id), room_id INTEGER REFERENCES collection_room(id), height_mm REAL, width_mm REAL, "
        "weight_kg REAL)",
        "CREATE TABLE django_migrations (id INTEGER PRIMARY KEY, app TEXT, name TEXT, applied TEXT)",
        "INSERT INTO collection_person VALUES (1, 'Veit Stoss')",
        "INSERT INTO collection_objecttype VALUES (1, 'Vase'), (2, 'Jar')",
        "INSERT INTO collection_room VALUES (1, 'Room 3', 0), (2, 'Depot 2', -1)",
        "INSERT INTO collection_museumobject VALUES (1, '1990.4', 'Fayencevase', 'Fayence', 1, 1, 1, 450, 220, 3.4)",
        "INSERT INTO collection_museumobject VALUES (2, '1991.1', 'Pot', 'Clay', 2, 1, 2, 180, 100, 1.2)",
    ),
    "German, with words and units in tables": (
        "CREATE TABLE tblPerson (PersonID INTEGER PRIMARY KEY, Name TEXT)",
        "CREATE TABLE tblObjektart (ArtID INTEGER PRIMARY KEY, Bezeichnung TEXT)",
        "CREATE TABLE tblStandort (StandortID INTEGER PRIMARY KEY, Bezeichnung TEXT, IstDepot INTEGER)",
        "CREATE TABLE tblEinheit (EinheitID INTEGER PRIMARY KEY, Kuerzel TEXT)",
        "CREATE TABLE tblMasstyp (MasstypID INTEGER PRIMARY KEY, Bezeichnung TEXT)",
        "CREATE TABLE tblObjekt (ObjektID INTEGER PRIMARY KEY, InvNr TEXT, Titel TEXT, Material TEXT, ArtID INTEGER, "
        "KuenstlerID INTEGER, StandortID INTEGER)",
        "CREATE TABLE tblMass (MassID INTEGER PRIMARY KEY, ObjektID INTEGER, MasstypID INTEGER, Wert REAL, EinheitID "
        "INTEGER)",
        "INSERT INTO tblPerson VALUES (1, 'Veit Stoss')",
        "INSERT INTO tblObjektart VALUES (1, 'Vase'), (2, 'Gefäß')",
        "INSERT INTO tblStandort VALUES (1, 'Saal 3', 0), (2, 'Depot 2', 1)",
        "INSERT INTO tblEinheit VALUES (1, 'mm'), (2, 'kg')",
        "INSERT INTO tblMasstyp VALUES (1, 'Höhe'), (2, 'Breite'), (3, 'Gewicht')",
        "INSERT INTO tblObjekt VALUES (1, '1990.4', 'Fayencevase', 'Fayence', 1, 1, 1)",
        "INSERT INTO tblObjekt VALUES (2, '1991.1', 'Pot', 'Ton', 2, 1, 2)",
        "INSERT INTO tblMass VALUES (1, 1, 1, 450, 1), (2, 1, 2, 220, 1), (3, 1, 3, 3.4, 2)",
        "INSERT INTO tblMass VALUES (4, 2, 1, 180, 1), (5, 2, 2, 100, 1), (6, 2, 3, 1.2, 2)",
    ),
    "French, with a flag of its own": (
        "CREATE TABLE auteurs (id INTEGER PRIMARY KEY, nom TEXT, prenom TEXT)",
        "CREATE TABLE salles (id INTEGER PRIMARY KEY, nom TEXT, etage INTEGER)",
        "CREATE TABLE oeuvres (id INTEGER PRIMARY KEY, num_inventaire TEXT, titre TEXT, domaine TEXT, matiere TEXT, "
        "hauteur_cm REAL, largeur_cm REAL, poids_kg REAL, salle_id INTEGER, auteur_id INTEGER, expose INTEGER)",
        "INSERT INTO auteurs VALUES (1, 'Stoss', 'Veit')",
        "INSERT INTO salles VALUES (1, 'Salle 3', 0), (2, 'Salle 4', 0)",
        "INSERT INTO oeuvres VALUES (1, '1990.4', 'Fayencevase', 'vase', 'faïence', 45, 22, 3.4, 1, 1, 1)",
        "INSERT INTO oeuvres VALUES (2, '1991.1', 'Pot', 'pot', 'terre', 18, 10, 1.2, 2, 1, 0)",
    ),
    "Spanish, of one table, whose numbers are codes": (
        "CREATE TABLE users (id INTEGER PRIMARY KEY, name TEXT, email TEXT)",
        "CREATE TABLE piezas (codigo TEXT, nombre TEXT, material TEXT, alto REAL, ancho REAL, peso REAL, sala TEXT)",
        "INSERT INTO users VALUES (1, 'Ana', 'ana@museo.example')",
        "INSERT INTO piezas VALUES ('1990.4', 'Fayencevase', 'loza', 45, 22, 3.4, 'Sala 3')",
        "INSERT INTO piezas VALUES ('1991.1', 'Pot', 'barro', 18, 10, 1.2, 'Depósito 2')",
    ),
}  # fmt: skip


@pytest.mark.parametrize("schema", SCHEMAS)
def test_a_museums_own_tables_are_joined_and_read(schema: str, tmp_path: Path) -> None:
    """Number, name, room, sizes and whether it is shown; the name of an artist, or of a user, is no title."""
    with closing(sqlite3.connect(tmp_path / "own.sqlite")) as connection:
        for statement in SCHEMAS[schema]:
            connection.execute(statement)
        connection.commit()
    url = f"sqlite:///{tmp_path / 'own.sqlite'}"
    first, second = read_items(url, guess(url).mapping).items
    assert (first.object_number, second.object_number) == ("1990.4", "1991.1")
    assert "Fayencevase" in (first.title, first.object_name)
    assert (first.height_m, first.width_m, first.mass_kg) == pytest.approx((0.45, 0.22, 3.4))
    assert (second.height_m, second.width_m, second.mass_kg) == pytest.approx((0.18, 0.1, 1.2))
    assert first.gallery.split()[-1] == "3"
    assert (first.on_display, second.on_display) == (True, False)
