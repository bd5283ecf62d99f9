"""A spreadsheet of LibreOffice gives what it shows: the XML is as LibreOffice 7.4 writes it, shortened."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xlsx import first_rows, read_sheet, visible_sheets
from tests.soak import SOAK

SPACES = " ".join(
    f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"' for name in ("office", "table", "text", "style")
)
TYPE = "application/vnd.oasis.opendocument.spreadsheet"


def cell(text: str, **more: str) -> str:
    said = "".join(f' table:{name.replace("_", "-")}="{value}"' for name, value in more.items())
    return f'<table:table-cell office:value-type="string"{said}><text:p>{text}</text:p></table:table-cell>'


def number(value: str, shown: str, kind: str = "float") -> str:
    return (
        f'<table:table-cell office:value-type="{kind}" office:value="{value}"><text:p>{shown}</text:p>'
        "</table:table-cell>"
    )


BLANK = "<table:table-cell/>"
END = (
    '<table:table-row table:number-rows-repeated="1048570"><table:table-cell table:number-columns-repeated="16384"/>'
    "</table:table-row>"
)


def row(*cells: str, many: int = 1) -> str:
    repeated = f' table:number-rows-repeated="{many}"' if many > 1 else ""
    rest = '<table:table-cell table:number-columns-repeated="16370"/>'
    return f"<table:table-row{repeated}>{''.join(cells)}{rest}</table:table-row>"


def sheet(name: str, *rows: str, style: str = "ta1") -> str:
    return f'<table:table table:name="{name}" table:style-name="{style}">{"".join(rows)}{END}</table:table>'


def book(*sheets: str, head: str = "", manifest: str = "<m/>") -> io.BytesIO:
    content = (
        f'<?xml version="1.0" encoding="UTF-8"?>{head}<office:document-content {SPACES}><office:automatic-styles>'
        '<style:style style:name="ta2" style:family="table"><style:table-properties table:display="false"/>'
        f"</style:style></office:automatic-styles><office:body><office:spreadsheet>{''.join(sheets)}"
        "</office:spreadsheet></office:body></office:document-content>"
    )
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("mimetype", TYPE, zipfile.ZIP_STORED)
        archive.writestr("content.xml", content)
        archive.writestr("META-INF/manifest.xml", manifest)
    return out


HEAD = row(*map(cell, ("Inventarnummer", "Titel", "Höhe cm", "Breite cm", "Standort", "ausgestellt")))
OBJECTS = sheet(
    "Objekte",
    row(cell("Inventar der Sammlung")),
    row(BLANK),
    HEAD,
    row(
        number("1913.2", "1913.20"),
        cell("Vase"),
        number("30.5", "30,5"),
        number("12", "12"),
        cell("Saal 3"),
        cell("ja"),
    ),
    row(BLANK, many=2),
    row(number("1913.2", "1913.2"), cell("Krug"), number("22", "22"), number("15", "15"), cell("Saal 3"), cell("ja")),
    row(cell("b-3"), cell("Büste"), number("61", "61,0"), number("40", "40"), cell("Depot 2"), cell("nein")),
)


def read(stream: io.BytesIO, **options: object) -> list[Row]:
    return list(read_sheet(stream, "museum.ods", **options))  # type: ignore[arg-type]


def test_objects_are_read_by_what_the_sheet_shows(tmp_path: Path) -> None:
    path = tmp_path / "objekte.ods"
    path.write_bytes(book(sheet("Versteckt", row(cell("x")), style="ta2"), OBJECTS).getvalue())
    assert visible_sheets(path) == ("Objekte",)
    assert first_rows(path, None, 3)[2][:2] == ["Inventarnummer", "Titel"]
    made = guess(path)
    assert made.mapping.source.format == "xlsx"
    items = read_items(path, made.mapping).items
    assert [(i.object_number, i.title, i.height_m, i.width_m, i.gallery, i.on_display) for i in items] == [
        ("1913.20", "Vase", 0.305, 0.12, "Saal 3", True),
        ("1913.2", "Krug", 0.22, 0.15, "Saal 3", True),
        ("b-3", "Büste", 0.61, 0.4, "Depot 2", False),
    ]


def test_lines_are_those_of_the_sheet() -> None:
    told = read(book(OBJECTS), header_row=3)
    assert [(one.number, one.line) for one in told] == [(0, 3), (1, 4), (2, 7), (3, 8)]


def test_texts_keep_their_spaces_and_lose_their_notes() -> None:
    note = "<office:annotation><text:p>ask Ana</text:p></office:annotation>"
    text = (
        f'<table:table-cell office:value-type="string">{note}<text:p>a<text:s text:c="2"/>b<text:tab/>'
        "<text:span>c</text:span></text:p><text:p>d</text:p></table:table-cell>"
    )
    told = read(book(sheet("s", row(cell("n")), row(text))))
    assert told[1].cells == ["a  b\tc\nd"]


def test_what_was_never_typed_has_a_fault() -> None:
    formula = (
        '<table:table-cell table:formula="of:=[.B2]*2" office:value-type="float" office:value="4"><text:p>4</text:p>'
        "</table:table-cell>"
    )
    covered = "<table:covered-table-cell/>"
    merged = cell("Saal 3", number_columns_spanned="1", number_rows_spanned="2")
    told = read(
        book(
            sheet(
                "s",
                row(*map(cell, ("n", "a", "place"))),
                row(cell("1"), formula, merged),
                row(cell("2"), number("7.5", "7,5"), covered),
            )
        ),
        key="n",
    )
    assert told[1].faults[1][0] == "holds a formula"
    # Words that are merged down a column hold for each of its rows.
    assert told[2].cells == ["2", "7.5", "Saal 3"]


def test_a_date_in_the_column_of_numbers_has_a_fault() -> None:
    said = 'office:value-type="date" office:date-value="2024-04-03"'
    day = f"<table:table-cell {said}><text:p>3.4</text:p></table:table-cell>"
    told = read(book(sheet("s", row(cell("n"), cell("seen")), row(day, day))), key="n")
    assert "date" in told[1].faults[0][0]
    assert told[1].cells[1] == "2024-04-03"


@pytest.mark.parametrize(
    ("stream", "said"),
    [
        (book(OBJECTS, manifest="<m><manifest:encryption-data/></m>"), "protected by a password"),
        (book(OBJECTS, head='<!DOCTYPE x [<!ENTITY e "x">]>'), "document type"),
        (book(OBJECTS.replace("</table:table-row>", "", 1)), "damaged"),
        (book(sheet("a", row(cell("x"))), sheet("b", row(cell("x")))), "2 visible sheets"),
        (book(sheet("a", row(*[cell("x")] * 1001))), "more than 1,000 columns"),
    ],
)
def test_what_cannot_be_read_is_said(stream: io.BytesIO, said: str) -> None:
    with pytest.raises(CollectionError, match=said):
        read(stream)


def test_a_million_repeated_rows_that_hold_nothing_cost_nothing() -> None:
    many = 1_000_000 if SOAK else 100_000
    told = read(book(sheet("s", row(cell("n")), row(BLANK, many=many), row(cell("5")))))
    assert [one.line for one in told] == [1, many + 2]
