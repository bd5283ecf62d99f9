"""Adlib XML gives the columns of objects, grouped and unstructured; files made by hand in the shapes of its exports."""

from __future__ import annotations

import io

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.adlib import Adlib, read_adlib
from pipeline.collection.sources.measurements import COLUMNS


def one(record: str, **options: str) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """The cells of the only record that are not empty, and the faults by column."""
    content = f"<adlibXML><recordList>{record}</recordList></adlibXML>".encode()
    _, row = read_adlib(io.BytesIO(content), "museum.xml", **options)
    faults = {COLUMNS[at]: why for at, why in row.faults.items()}
    return {name: cell for name, cell in zip(COLUMNS, row.cells, strict=True) if cell}, faults


def test_an_unstructured_record_of_parallel_fields() -> None:
    """The n-th type goes with the n-th value; a length is the width where none is given, as of a chandelier here."""
    cells, _ = one(
        '<record priref="6389"><dimension.unit>cm</dimension.unit><dimension.unit>cm</dimension.unit>'
        "<dimension.type>hoogte</dimension.type><dimension.type>lengte</dimension.type>"
        "<dimension.value>77</dimension.value><dimension.value>54,5</dimension.value>"
        "<object_name>wandluster</object_name><object_number>10000</object_number><title>Vier wandlusters</title>"
        "<material>ijzer</material><material>koper</material><location>Zaal 3</location></record>"
    )
    assert cells == {
        "object_number": "10000",
        "record_id": "6389",
        "title": "Vier wandlusters",
        "object_name": "wandluster",
        "medium": "ijzer; koper",
        "gallery": "Zaal 3",
        "height": "77 cm",
        "length": "54.5 cm",
        "width": "54.5 cm",
    }


def test_words_in_several_languages_and_links() -> None:
    record = (
        '<record priref="1"><object_number>A 1</object_number><Object_name><object_name><term>vaas</term>'
        "</object_name></Object_name><Dimension><dimension.type><value lang='neutral'>HEIGHT</value>"
        "<value lang='nl-NL'>hoogte</value>"
        "</dimension.type><dimension.value>10.50</dimension.value><dimension.unit>"
        "<value lang='nl-NL'>centimeter</value>"
        "</dimension.unit></Dimension><current_location><name>Zaal 1</name></current_location></record>"
    )
    cells, _ = one(record, language="nl")
    assert (cells["object_name"], cells["height"], cells["gallery"]) == ("vaas", "10.5 cm", "Zaal 1")


def test_two_heights_of_the_whole_are_refused_and_those_of_parts_kept_apart() -> None:
    def size(part: str, value: str, unit: str = "cm") -> str:
        return (
            f"<Dimension><dimension.part>{part}</dimension.part><dimension.type>height</dimension.type>"
            f"<dimension.value>{value}</dimension.value><dimension.unit>{unit}</dimension.unit></Dimension>"
        )

    cells, faults = one(
        f"<record>{size('', '20')}{size('frame', '30')}{size('lid', '4')}{size('', '7.87', 'in')}</record>"
    )
    # 7.87 in is 20 cm, rounded.
    assert (cells["height"], cells["frame height"], faults) == ("20 cm", "30 cm", {})
    assert cells["other_measurements"] == "lid height: 4 cm"
    cells, faults = one(f"<record>{size('', '20')}{size('', '25')}</record>")
    assert "height" not in cells
    assert faults["height"][0] == "the record gives it twice: 20 cm and 25 cm"


def test_a_unit_that_nobody_names_is_the_mappings_or_none() -> None:
    record = "<record><dimension.type>height</dimension.type><dimension.value>20</dimension.value></record>"
    assert one(record)[0]["height"] == "20"
    assert one(record, unit="mm")[0]["height"] == "20 mm"
    assert "height" not in one(record.replace(">20<", ">0<"))[0]


def test_what_is_no_adlib_file_is_refused() -> None:
    for content, said in (
        (b"<adlibXML/>", "museum.xml: holds no <record>, its root is adlibXML"),
        (b"<adlibXML><record>", "museum.xml, line 1: not well-formed XML after 0 records"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a><record>&b;</record></a>', "declares a document type or entities"),
    ):
        with pytest.raises(CollectionError, match=said):
            list(read_adlib(io.BytesIO(content), "museum.xml"))
    assert Adlib().recognises("a.xml", "<?xml?><adlibXML>".encode("utf-16"))
    assert not Adlib().recognises("a.xml", b"<lido:lidoWrap>")
