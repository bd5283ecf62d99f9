"""The same real records through CSV, XLSX, LIDO, SQLite and PostgreSQL are the same items, byte for byte."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import escape

import pytest
from openpyxl import Workbook
from sqlalchemy import Column, Double, Integer, MetaData, Table, Text, create_engine, insert

from pipeline.collection.mapping import PRESETS, load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.record import to_records
from pipeline.collection.sources.rows import as_text

TEXTS = ("object_number", "title", "classification", "medium", "gallery")
SIDES = ("height", "width", "depth")
COLUMNS = f"""
[museum]
name = "Test"
[columns]
{"".join(f'{name} = {{ column = "{name}" }}' + chr(10) for name in TEXTS)}
{"".join(f'{side}_m = {{ column = "{side}", unit = "UNIT" }}' + chr(10) for side in SIDES)}
"""

Record = Mapping[str, str | float | None]


@pytest.fixture(scope="module")
def records() -> list[Record]:
    """400 of the bundled Carnegie records; numbers as numbers, nothing where nothing was measured."""
    with (PRESETS.parent / "data" / "carnegie_2000.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))[:400]
    names = dict(
        zip(TEXTS, ("accession_number", "title", "classification", "medium", "physical_location"), strict=True)
    )
    return [
        # XML has no control characters, and folds line ends.
        {name: " ".join(row[column].split()) for name, column in names.items()}
        | {side: float(row[f"item_{side}"]) or None for side in SIDES}
        for row in rows
    ]


def write_csv(folder: Path, records: list[Record]) -> str:
    with (folder / "items.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, [*TEXTS, *SIDES])
        writer.writeheader()
        writer.writerows(records)
    return str(folder / "items.csv")


def write_xlsx(folder: Path, records: list[Record]) -> str:
    book = Workbook(write_only=True)
    sheet = book.create_sheet("objects")
    sheet.append([*TEXTS, *SIDES])
    for record in records:
        sheet.append([record[name] for name in (*TEXTS, *SIDES)])
    book.save(folder / "items.xlsx")
    return str(folder / "items.xlsx")


def write_lido(folder: Path, records: list[Record]) -> str:
    (folder / "items.xml").write_text(
        '<lido:lidoWrap xmlns:lido="http://www.lido-schema.org">'
        + "".join(_lido(record) for record in records)
        + "</lido:lidoWrap>",
        encoding="utf-8",
    )
    return str(folder / "items.xml")


def _lido(record: Record) -> str:
    text = {name: escape(str(record[name])) for name in TEXTS}
    measures = "".join(
        f"<lido:measurementsSet><lido:measurementType>{side}</lido:measurementType>"
        f"<lido:measurementUnit>in</lido:measurementUnit><lido:measurementValue>{as_text(record[side])}</lido:measurementValue>"
        "</lido:measurementsSet>"
        for side in SIDES
        if record[side] is not None
    )
    return f"""<lido:lido><lido:lidoRecID lido:type="local">{text["object_number"]}</lido:lidoRecID>
      <lido:descriptiveMetadata xml:lang="en"><lido:objectClassificationWrap>
      <lido:objectWorkTypeWrap/><lido:classificationWrap><lido:classification><lido:term>{text["classification"]}
      </lido:term></lido:classification></lido:classificationWrap></lido:objectClassificationWrap>
      <lido:objectIdentificationWrap><lido:titleWrap><lido:titleSet><lido:appellationValue>{text["title"]}
      </lido:appellationValue></lido:titleSet></lido:titleWrap>
      <lido:repositoryWrap><lido:repositorySet lido:type="current"><lido:workID lido:type="inventory number">
      {text["object_number"]}</lido:workID><lido:repositoryLocation><lido:namePlaceSet><lido:appellationValue>
      {text["gallery"]}</lido:appellationValue></lido:namePlaceSet></lido:repositoryLocation></lido:repositorySet>
      </lido:repositoryWrap>
      <lido:objectMeasurementsWrap><lido:objectMeasurementsSet><lido:objectMeasurements>{measures}
      </lido:objectMeasurements></lido:objectMeasurementsSet></lido:objectMeasurementsWrap>
      <lido:objectMaterialsTechWrap><lido:objectMaterialsTechSet><lido:displayMaterialsTech>{text["medium"]}
      </lido:displayMaterialsTech></lido:objectMaterialsTechSet></lido:objectMaterialsTechWrap>
      </lido:objectIdentificationWrap></lido:descriptiveMetadata>
      <lido:administrativeMetadata xml:lang="en"/></lido:lido>"""


def write_table(url: str, records: list[Record]) -> str:
    table = Table(
        "objects; --",
        MetaData(),
        Column("row", Integer(), primary_key=True),
        *(Column(name, Text()) for name in TEXTS),
        *(Column(side, Double()) for side in SIDES),
    )
    engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    table.metadata.drop_all(engine)
    table.metadata.create_all(engine)
    with engine.begin() as connection:
        connection.execute(insert(table), [{"row": at, **record} for at, record in enumerate(records)])
    engine.dispose()
    return url


def items(folder: Path, where: str, source: str, unit: str = "in") -> bytes:
    (folder / "m.toml").write_text(source + COLUMNS.replace("UNIT", unit), encoding="utf-8")
    reading = read_items(where, load_mapping(folder / "m.toml"))
    assert reading.rejected == ()
    inside = sorted(reading.items, key=lambda item: item.object_number)
    return json.dumps(to_records(inside), sort_keys=True).encode()


DATABASE = '[source]\nformat = "sql"\ntable = "objects; --"\n'


def test_every_source_gives_the_same_items(
    records: list[Record], tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """Also the characters that every number was read from are the same: 79.0 inches are 79 in."""
    text = items(
        tmp_path, write_csv(tmp_path, records), '[source]\nformat = "csv"\nencoding = "utf-8"\ndelimiter = ","\n'
    )
    assert len(json.loads(text)) == 400
    assert items(tmp_path, write_xlsx(tmp_path, records), '[source]\nformat = "xlsx"\n') == text
    assert items(tmp_path, write_lido(tmp_path, records), '[source]\nformat = "lido"\n', "as written") == text
    sqlite = write_table(f"sqlite:///{tmp_path / 'museum.sqlite'}", records)
    assert items(tmp_path, sqlite, DATABASE) == text
    server = write_table(request.getfixturevalue("postgresql_url"), records)
    assert items(tmp_path, server, DATABASE) == text
