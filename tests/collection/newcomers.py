"""Exports as museums of several countries would make them, made by hand: no museum's own, each true to its program.

Each comes with what a person would read from it: object number -> height [m], and whether the object is on display.
"""

from __future__ import annotations

import csv
import io
import json
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import openpyxl


@dataclass(frozen=True)
class Thing:
    """An object as its museum knows it; sizes in cm, mass in kg."""

    number: str
    name: str
    title: str
    medium: str
    place: str
    shown: bool
    height: float | None
    width: float
    depth: float | None = None
    mass: float | None = None


@dataclass(frozen=True)
class Newcomer:
    """A museum: where its export is, and what is in it."""

    where: str
    things: tuple[Thing, ...]


def _number(value: float | None, mark: str = ".") -> str:
    return "" if value is None else f"{value:g}".replace(".", mark)


def _things(
    prefix: str, names: list[tuple[str, str]], rooms: list[str], store: str, many: int = 40
) -> tuple[Thing, ...]:
    out = []
    for at in range(many):
        name, medium = names[at % len(names)]
        shown = at % 5 not in (2, 4)
        flat = at % len(names) == 0
        out.append(
            Thing(
                number=f"{prefix}{1900 + at % 70}.{at + 1}",
                name=name,
                title=f"{name} ({at + 1})",
                medium=medium,
                place=rooms[at % len(rooms)] if shown else store,
                shown=shown,
                height=None if at == 7 else 12.5 + 3.7 * at,
                width=10.2 + 1.3 * at,
                depth=None if flat else 8.4 + 0.9 * at,
                mass=None if at % 3 else 1.5 + 0.25 * at,
            )
        )
    return tuple(out)


def german_workbook(folder: Path) -> Newcomer:
    """A list of MuseumPlus in Excel: titles above the head, sizes in columns, yes and no, and a sheet of notes."""
    things = _things(
        "I ",
        [("Gemälde", "Öl auf Leinwand"), ("Vase", "Porzellan"), ("Büste", "Marmor"), ("Schrank", "Eichenholz")],
        ["Saal 1", "Saal 2, Vitrine 3", "Saal 7"],
        "Depot Nord, Regal 4",
    )
    book = openpyxl.Workbook()
    notes = book.worksheets[0]
    notes.title = "Hinweise"
    notes.append(["Export vom 04.03.2024", "Museum am Markt"])
    sheet = book.create_sheet("Objektliste")
    sheet.append(["Museum am Markt"])
    sheet.append(["Objektliste für Dr. Weber", None, "Stand: März 2024"])
    sheet.append([])
    sheet.append(
        [
            *("Lfd. Nr.", "Inv.-Nr.", "Sachbegriff", "Titel", "Material/Technik", "Akt. Standort", "Ausgestellt"),
            *("Höhe (cm)", "Breite (cm)", "Tiefe (cm)", "Gewicht (kg)"),
        ]
    )
    for at, one in enumerate(things, start=1):
        sheet.append(
            [
                *(at, one.number, one.name, one.title, one.medium, one.place, "ja" if one.shown else "nein"),
                *(one.height, one.width, one.depth, one.mass),
            ]
        )
    path = folder / "Objektliste_Weber.xlsx"
    book.save(path)
    return Newcomer(str(path), things)


def italian_csv(folder: Path) -> Newcomer:
    """A catalogue saved by Excel in cp1252 with semicolons, decimal commas, sizes without a unit in their names."""
    things = _things(
        "D.",
        [("Dipinto", "olio su tela"), ("Scultura", "marmo"), ("Piatto", "maiolica"), ("Coppa", "bronzo dorato")],
        ["Sala 3", "Sala 5", "Galleria al primo piano"],
        "Deposito interrato",
    )
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=";", lineterminator="\r\n")
    writer.writerow(
        [
            *("ID", "N. inventario", "Oggetto", "Titolo", "Materia e tecnica", "Collocazione attuale", "Esposto"),
            *("Altezza", "Larghezza", "Profondità", "Unità", "Peso (kg)"),
        ]
    )
    for at, one in enumerate(things, start=1):
        writer.writerow(
            [4100 + at, one.number, one.name, one.title, one.medium, one.place, "Sì" if one.shown else "No"]
            + [_number(value, ",") for value in (one.height, one.width, one.depth)]
            + ["cm", _number(one.mass, ",")]
        )
    path = folder / "catalogo.csv"
    path.write_bytes(stream.getvalue().encode("cp1252"))
    return Newcomer(str(path), things)


def french_mac_roman(folder: Path) -> Newcomer:
    """A table of FileMaker, saved on a Mac: Mac Roman, a head of two rows with merged cells, semicolons."""
    things = _things(
        "2003.",
        [
            ("Tableau", "huile sur toile"),
            ("Pâte de verre", "verre"),
            ("Commode", "chêne, marbre"),
            ("Aiguière", "étain"),
        ],
        ["Salle des États", "Salle 12 – vitrine 2", "Entrée"],
        "Réserve 2",
    )
    rows = [
        ["Musée de la Ville – récolement 2023", "", "", "", "", "", "", "", ""],
        [
            "N° d’inventaire",
            "Désignation",
            "",
            "Matière et technique",
            "Emplacement",
            "Exposé",
            "Dimensions (cm)",
            "",
            "",
        ],
        ["", "Dénomination", "Titre", "", "", "", "H", "L", "P"],
    ]
    for one in things:
        rows.append(
            [one.number, one.name, one.title, one.medium, one.place, "oui" if one.shown else "non"]
            + [_number(value, ",") for value in (one.height, one.width, one.depth)]
        )
    text = "\r".join(";".join(row) for row in rows) + "\r"
    path = folder / "récolement.csv"
    path.write_bytes(text.encode("mac-roman"))
    return Newcomer(str(path), things)


def tms_like_database(folder: Path) -> Newcomer:
    """Tables with the names of TMS, in SQLite: dimensions as rows of a type and a unit, places behind components."""
    things = _things(
        "1998.",
        [("Painting", "Oil on canvas"), ("Vase", "Porcelain"), ("Figure", "Bronze"), ("Chest", "Oak")],
        ["Gallery 101", "Gallery 204", "Rotunda"],
        "Storage B2",
    )
    path = folder / "tms.sqlite"
    with sqlite3.connect(path) as db:
        db.executescript("""
            CREATE TABLE Objects (ObjectID INTEGER PRIMARY KEY, ObjectNumber TEXT, ObjectName TEXT, Medium TEXT,
                Dimensions TEXT, ClassificationID INTEGER, OnView INTEGER);
            CREATE TABLE Classifications (ClassificationID INTEGER PRIMARY KEY, Classification TEXT);
            CREATE TABLE ObjTitles (TitleID INTEGER PRIMARY KEY, ObjectID INTEGER, Title TEXT, DisplayOrder INTEGER);
            CREATE TABLE ObjComponents (ComponentID INTEGER PRIMARY KEY, ObjectID INTEGER, ComponentNumber TEXT,
                CurrentObjLocID INTEGER, HomeLocationID INTEGER);
            CREATE TABLE ObjLocations (ObjLocationID INTEGER PRIMARY KEY, ComponentID INTEGER, LocationID INTEGER);
            CREATE TABLE Locations (LocationID INTEGER PRIMARY KEY, Site TEXT, Room TEXT, UnitType TEXT,
                UnitNumber TEXT, UnitPosition TEXT);
            CREATE TABLE DimItemElemXrefs (DimItemElemXrefID INTEGER PRIMARY KEY, TableID INTEGER, ID INTEGER,
                ElementID INTEGER, DisplayDimensions TEXT);
            CREATE TABLE DimensionElements (ElementID INTEGER PRIMARY KEY, Element TEXT);
            CREATE TABLE Dimensions (DimensionID INTEGER PRIMARY KEY, DimItemElemXrefID INTEGER,
                DimensionTypeID INTEGER, Dimension NUMERIC, PrimaryUnitID INTEGER);
            CREATE TABLE DimensionTypes (DimensionTypeID INTEGER PRIMARY KEY, DimensionType TEXT);
            CREATE TABLE DimensionUnits (UnitID INTEGER PRIMARY KEY, UnitName TEXT);
            INSERT INTO Classifications VALUES (1, 'Works'), (2, 'Furniture');
            INSERT INTO DimensionElements VALUES (1, 'Overall'), (2, 'Frame'), (3, 'Image');
            INSERT INTO DimensionTypes VALUES (1, 'Height'), (2, 'Width'), (3, 'Depth'), (4, 'Weight');
            INSERT INTO DimensionUnits VALUES (1, 'centimeters'), (2, 'inches'), (3, 'kilograms');
            """)
        places = sorted({one.place for one in things})
        for at, place in enumerate(places, start=1):
            db.execute("INSERT INTO Locations VALUES (?, 'Main Building', ?, 'Case', ?, '')", (at, place, str(at)))
        for at, one in enumerate(things, start=1):
            db.execute(
                "INSERT INTO Objects VALUES (?, ?, ?, ?, ?, 1, ?)",
                (at, one.number, one.name, one.medium, "", int(one.shown)),
            )
            db.execute("INSERT INTO ObjTitles VALUES (?, ?, ?, 1)", (at, at, one.title))
            db.execute("INSERT INTO ObjComponents VALUES (?, ?, ?, ?, 1)", (at, at, one.number, 1000 + at))
            # Where it was before, and where it is.
            db.execute("INSERT INTO ObjLocations VALUES (?, ?, 1)", (at, at))
            db.execute("INSERT INTO ObjLocations VALUES (?, ?, ?)", (1000 + at, at, places.index(one.place) + 1))
            db.execute("INSERT INTO DimItemElemXrefs VALUES (?, 108, ?, 1, '')", (at, at))
            db.execute("INSERT INTO DimItemElemXrefs VALUES (?, 108, ?, 3, '')", (2000 + at, at))
            sizes = ((1, one.height, 1), (2, one.width, 1), (3, one.depth, 1), (4, one.mass, 3))
            for kind, value, unit in sizes:
                if value is not None:
                    db.execute(
                        "INSERT INTO Dimensions (DimItemElemXrefID, DimensionTypeID, Dimension, PrimaryUnitID) "
                        "VALUES (?, ?, ?, ?)",
                        (at, kind, value, unit),
                    )
            # The image alone, which is not the object.
            db.execute(
                "INSERT INTO Dimensions (DimItemElemXrefID, DimensionTypeID, Dimension, PrimaryUnitID) "
                "VALUES (?, 1, 3, 1)",
                (2000 + at,),
            )
    return Newcomer(f"sqlite:///{path}", things)


def own_database(folder: Path) -> Newcomer:
    """A database of a museum's own making, in German: no key declared, a list of places with a flag for the current."""
    things = _things(
        "VII ",
        [("Bild", "Öl auf Holz"), ("Krug", "Steinzeug"), ("Figur", "Lindenholz")],
        ["Raum 1", "Raum 2", "Treppenhaus"],
        "Magazin 3",
    )
    path = folder / "sammlung.sqlite"
    with sqlite3.connect(path) as db:
        db.executescript("""
            CREATE TABLE Objekte (id INTEGER PRIMARY KEY, Inventarnummer TEXT, Bezeichnung TEXT, Titel TEXT,
                Material TEXT, Notiz TEXT);
            CREATE TABLE Masse (id INTEGER PRIMARY KEY, objekt_id INTEGER, Massart TEXT, Wert REAL, Einheit TEXT);
            CREATE TABLE Standorte (id INTEGER PRIMARY KEY, Name TEXT, Gebaeude TEXT);
            CREATE TABLE Objektstandorte (id INTEGER PRIMARY KEY, objekt_id INTEGER, standort_id INTEGER,
                aktuell INTEGER);
            """)
        places = sorted({one.place for one in things})
        for at, place in enumerate(places, start=1):
            db.execute("INSERT INTO Standorte VALUES (?, ?, 'Altbau')", (at, place))
        for at, one in enumerate(things, start=1):
            db.execute(
                "INSERT INTO Objekte VALUES (?, ?, ?, ?, ?, '')", (at, one.number, one.name, one.title, one.medium)
            )
            other = places.index(one.place) % len(places)
            db.execute("INSERT INTO Objektstandorte VALUES (?, ?, ?, 0)", (2 * at, at, (other + 1) % len(places) + 1))
            db.execute("INSERT INTO Objektstandorte VALUES (?, ?, ?, 1)", (2 * at + 1, at, other + 1))
            sizes = (
                ("Höhe", one.height, "cm"),
                ("Breite", one.width, "cm"),
                ("Tiefe", one.depth, "cm"),
                ("Gewicht", one.mass, "kg"),
            )
            for kind, value, unit in sizes:
                if value is not None:
                    db.execute(
                        "INSERT INTO Masse (objekt_id, Massart, Wert, Einheit) VALUES (?, ?, ?, ?)",
                        (at, kind, value, unit),
                    )
    return Newcomer(f"sqlite:///{path}", things)


def portuguese_long_form(folder: Path) -> Newcomer:
    """A table in long form as UTF-16 with tabs, which Excel calls Unicode text: a row for each dimension."""
    things = _things(
        "MNA ",
        [("Pintura", "óleo sobre tela"), ("Jarra", "faiança"), ("Escultura", "madeira policromada")],
        ["Sala 4", "Sala 9", "Capela"],
        "Reservas",
    )
    rows = [["N.º de Inventário", "Denominação", "Matéria", "Localização", "Tipo de medida", "Valor", "Unidade"]]
    for one in things:
        sizes = (
            ("Altura", one.height, "cm"),
            ("Largura", one.width, "cm"),
            ("Profundidade", one.depth, "cm"),
            ("Peso", one.mass, "kg"),
        )
        for kind, value, unit in sizes:
            if value is not None:
                rows.append([one.number, one.name, one.medium, one.place, kind, _number(value, ","), unit])
    path = folder / "matriz.txt"
    path.write_bytes("\r\n".join("\t".join(row) for row in rows).encode("utf-16"))
    return Newcomer(str(path), things)


_AAT = "http://vocab.getty.edu/aat/"


def linked_art_lines(folder: Path) -> Newcomer:
    """Linked Art, one record a line: values as strings, places classed as galleries and stores."""
    things = _things(
        "84.",
        [("Paintings", "Oil on canvas"), ("Vessels", "Terracotta"), ("Sculpture", "Marble")],
        ["Gallery N104", "Gallery S112"],
        "Storage",
    )

    def concept(number: str, label: str) -> dict[str, str]:
        return {"id": _AAT + number, "type": "Type", "_label": label}

    def dimension(value: float, number: str, unit: str, label: str) -> dict[str, Any]:
        return {
            "type": "Dimension",
            "value": f"{value:.10f}",
            "classified_as": [concept(number, "")],
            "unit": concept(unit, label),
        }

    lines = []
    for at, one in enumerate(things):
        sizes = [dimension(one.width, "300055647", "300379098", "centimeters")]
        if one.height is not None:
            sizes.append(dimension(one.height, "300055644", "300379098", "centimeters"))
        if one.depth is not None:
            sizes.append(dimension(one.depth, "300072633", "300379098", "centimeters"))
        if one.mass is not None:
            sizes.append(dimension(one.mass, "300056240", "300379226", "kilograms"))
        record = {
            "@context": "https://linked.art/ns/v1/linked-art.json",
            "id": f"https://example.org/object/{at}",
            "type": "HumanMadeObject",
            "_label": one.title,
            "identified_by": [
                {"type": "Identifier", "content": f"{at}", "classified_as": [concept("300404621", "Local Number")]},
                {"type": "Identifier", "content": one.number, "classified_as": [concept("300312355", "Accession")]},
                {"type": "Name", "content": one.title},
            ],
            "classified_as": [concept("300133025", "Artwork"), concept("300191086", one.name)],
            "referred_to_by": [
                {
                    "type": "LinguisticObject",
                    "content": one.medium,
                    "classified_as": [concept("300435429", "Materials")],
                }
            ],
            "current_location": {
                "type": "Place",
                "_label": one.place,
                "classified_as": [concept("300240057" if one.shown else "300004465", "")],
            },
            "dimension": sizes,
        }
        lines.append(json.dumps(record))
    path = folder / "objects.jsonl"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return Newcomer(str(path), things)


def spanish_csv(folder: Path) -> Newcomer:
    """A list of DOMUS: titles above the head, UTF-8 with its mark, sizes as a text with semicolons in it."""
    things = _things(
        "CE",
        [("Cuadro", "Lienzo"), ("Ánfora", "Cerámica"), ("Busto", "Bronce"), ("Arca", "Madera de nogal")],
        ["Sala 1", "Sala 2 - Edad del Hierro", "Sala 5 Vitrina 3"],
        "Almacén 2, estantería 4",
    )
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=";", lineterminator="\r\n")
    writer.writerow(["Museo Provincial", *[""] * 10])
    writer.writerow(["Listado de bienes culturales", *[""] * 10])
    writer.writerow(["Fecha: 12/03/2024", *[""] * 10])
    writer.writerow([""] * 11)
    writer.writerow(
        [
            *("Museo", "Nº Inventario", "Clasificación Genérica", "Objeto/Documento", "Título", "Materia/Soporte"),
            *("Técnica", "Dimensiones", "Datación", "Ubicación actual", "Expuesto"),
        ]
    )
    for one in things:
        sizes = ("Altura", one.height), ("Anchura", one.width), ("Profundidad", one.depth)
        text = "; ".join(f"{kind} = {_number(value, ',')} cm" for kind, value in sizes if value is not None)
        writer.writerow(
            [
                *("Museo Provincial", one.number, "", one.name, one.title, one.medium, "", text, "s. XVIII", one.place),
                "Sí" if one.shown else "No",
            ]
        )
    path = folder / "listado.csv"
    path.write_bytes(stream.getvalue().encode("utf-8-sig"))
    return Newcomer(str(path), things)


def dutch_adlib(folder: Path) -> Newcomer:
    """Adlib XML, grouped: a dimension is an element of part, type, value and unit."""
    things = _things(
        "1931-",
        [("schilderij", "olieverf op doek"), ("vaas", "aardewerk"), ("kast", "eikenhout"), ("kan", "tin")],
        ["Zaal 1.03", "Zaal 2.11 vitrine 4"],
        "Depot A rek 3",
    )
    records = []
    for at, one in enumerate(things):
        sizes = ("hoogte", one.height, "cm"), ("breedte", one.width, "cm"), ("diepte", one.depth, "cm")
        dimensions = "".join(
            "<Dimension><dimension.part>geheel</dimension.part>"
            f"<dimension.type>{kind}</dimension.type><dimension.value>{value:g}</dimension.value>"
            f"<dimension.unit>{unit}</dimension.unit></Dimension>"
            for kind, value, unit in (*sizes, ("gewicht", one.mass, "kg"))
            if value is not None
        )
        records.append(
            f'<record priref="{4000 + at}" created="2011-02-01T10:00:00"><priref>{4000 + at}</priref>'
            f"<object_number>{one.number}</object_number><Object_name><object_name>{one.name}</object_name>"
            f"</Object_name><Title><title>{one.title}</title></Title><Material><material>{one.medium}</material>"
            f"</Material>{dimensions}<current_location>{one.place}</current_location></record>"
        )
    path = folder / "adlib.xml"
    path.write_text(
        '<?xml version="1.0" encoding="utf-8"?>\n<adlibXML><recordList>'
        + "\n".join(records)
        + "</recordList><diagnostic><hits>40</hits><xmltype>Grouped</xmltype></diagnostic></adlibXML>",
        encoding="utf-8",
    )
    return Newcomer(str(path), things)


ALL: tuple[Callable[[Path], Newcomer], ...] = (
    german_workbook,
    italian_csv,
    french_mac_roman,
    tms_like_database,
    own_database,
    portuguese_long_form,
    linked_art_lines,
    spanish_csv,
    dutch_adlib,
)
