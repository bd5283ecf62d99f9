"""A LIDO record gives the columns that the module names, whatever the version, the language and the program."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources import lido, xml_records
from pipeline.collection.sources.lido import COLUMNS, read_records
from pipeline.collection.sources.rows import Row
from tests.soak import examples

from .lido_files import concept, element, measured, measurements, record, wrap


def rows(content: bytes, **options: Any) -> list[Row]:
    return list(read_records(io.BytesIO(content), "museum.xml", **options))


def one(*records: str, **options: Any) -> dict[str, str]:
    """The cells of the only record that are not empty."""
    header, row = rows(wrap(*records), **options)
    assert len(row.cells) == len(header.cells)
    return {name: cell for name, cell in zip(header.cells, row.cells, strict=True) if cell}


def refused(content: bytes, match: str) -> None:
    with pytest.raises(CollectionError, match=match) as caught:
        rows(content)
    assert str(caught.value).startswith("museum.xml")


# ---------------------------------------------------------------------------------------------------------------------
# Whole records


def test_a_record_of_a_german_museum() -> None:
    """LIDO 1.0 as the portals of German museums give it: terms without language, units and types as plain texts."""
    cells = one(
        record(
            number="Inv. 1887,12",
            title="Büste eines Mannes",
            place="Saal 3",
            classes=element(
                "objectWorkTypeWrap",
                concept("objectWorkType", "Büste", identifier="http://vocab.getty.edu/aat/300047457"),
            )
            + element(
                "classificationWrap",
                concept("classification", "IMAGE", type="europeana:type"),
                concept("classification", "Skulptur", identifier="300047090", source="AAT"),
            ),
            sizes=measurements(measured("Höhe", "47,5"), measured("Gewicht", "12", "kg"), display="H. 47,5 cm")
            + measurements(measured("Höhe", "9"), measured("Breite", "20"), extent="Sockel"),
            events=element(
                "eventSet",
                element(
                    "event",
                    concept("eventType", "Restaurierung"),
                    element("eventMaterialsTech", element("displayMaterialsTech", "Epoxidharz")),
                ),
            )
            + element(
                "eventSet",
                element(
                    "event",
                    concept("eventType", "Herstellung"),
                    element(
                        "eventMaterialsTech",
                        element("displayMaterialsTech", "Marmor, poliert"),
                        element(
                            "materialsTech",
                            concept("termMaterialsTech", "Marmor", identifier="aat:300011443", type="material"),
                            concept("termMaterialsTech", "poliert", identifier="aat:300053864", type="technique"),
                        ),
                    ),
                ),
            ),
            language="de",
        )
    )
    assert cells == {
        "object_number": "Inv. 1887,12",
        "record_id": "DE-MUS-1/lido/1",
        "title": "Büste eines Mannes",
        "object_name": "Büste",
        "object_name_aat": "300047457",
        "classification": "Skulptur",
        "classification_aat": "300047090",
        "medium": "Marmor, poliert",
        "medium_aat": "300011443",
        "gallery": "Saal 3",
        "repository": "Museum",
        "dimensions": "H. 47,5 cm",
        "height": "47,5 cm",
        "weight": "12 kg",
        "base height": "9 cm",
        "base width": "20 cm",
    }


def test_concepts_of_version_1_1() -> None:
    """SKOS concepts with labels in several languages, an address in Wikidata, materials under the object itself."""

    def skos(about: str, *labels: str) -> str:
        said = "".join(f'<skos:prefLabel xml:lang="{label[:2]}">{label[3:]}</skos:prefLabel>' for label in labels)
        return f'<skos:Concept rdf:about="{about}">{said}</skos:Concept>'

    size = element(
        "measurementsSet",
        element("measurementType", skos("https://www.wikidata.org/entity/Q208826", "de:Höhe", "en:height")),
        element("measurementUnit", skos("https://www.wikidata.org/entity/Q174728", "de:Zentimeter", "en:centimetre")),
        element("measurementValue", "2,1"),
    )
    bare = element(
        "measurementsSet",
        element("measurementType", skos("http://vocab.getty.edu/aat/300055624")),
        element("measurementUnit", skos("http://vocab.getty.edu/aat/300379098")),
        element("measurementValue", "7"),
    )
    sheet = record(
        classes=element(
            "objectWorkTypeWrap",
            element("objectWorkType", skos("http://vocab.getty.edu/aat/300132869", "de:Vase", "en:vase")),
        ),
        sizes=measurements(size, bare),
        more=element(
            "objectMaterialsTechWrap",
            element(
                "objectMaterialsTechSet",
                element(
                    "materialsTech",
                    element("termMaterialsTech", skos("http://vocab.getty.edu/aat/300010669", "en:clay", "de:Ton")),
                ),
            ),
        ),
        language="de",
    )
    english, german = one(sheet), one(sheet, languages=("de",))
    assert (english["height"], german["height"]) == ("2,1 centimetre", "2,1 Zentimeter")
    assert english["diameter"] == "7 cm"
    assert (english["medium"], german["medium"], german["medium_aat"]) == ("clay", "Ton", "300010669")
    assert (english["object_name"], english["object_name_aat"]) == ("vase", "300132869")


@pytest.mark.parametrize(
    ("identifier", "source", "number"),
    [
        ("300047090", "", "300047090"),
        ("300047090", "Getty AAT", "300047090"),
        ("300047090", "GND", ""),
        ("aat:300047090", "GND", "300047090"),
        ("http://vocab.getty.edu/aat/300047090", "", "300047090"),
        ("https://vocab.getty.edu/page/aat/300047090/", "", "300047090"),
        ("http://d-nb.info/gnd/4021845-4", "", ""),
        ("http://example.org/aat/300047090", "", ""),
        ("http://example.org/?http://vocab.getty.edu/aat/300047090", "", ""),
    ],
)
def test_numbers_of_the_thesaurus(identifier: str, source: str, number: str) -> None:
    work = concept("objectWorkType", "sculpture", identifier=identifier, source=source)
    assert one(record(classes=element("objectWorkTypeWrap", work))).get("object_name_aat", "") == number


# ---------------------------------------------------------------------------------------------------------------------
# Measurements


@pytest.mark.parametrize(
    ("kind", "column"),
    [
        ("height", "height"),
        ("Höhe", "height"),
        ("hoogte", "height"),
        ("Breite:", "width"),
        ("Largeur", "width"),
        ("profondità", "depth"),
        ("LÄNGE", "length"),
        ("halkaisija", "diameter"),
        ("Dicke", "thickness"),
        ("circonférence", "circumference"),
        ("Masse", "weight"),
    ],
)
def test_words_for_measurements(kind: str, column: str) -> None:
    assert one(record(sizes=measurements(measured(kind, "23"))))[column] == "23 cm"


def test_types_repeated_for_each_language_are_one() -> None:
    """As the German Digital Library recommends for LIDO 1.0."""
    types = element("measurementType", "Stempelstellung", lang="de") + element("measurementType", "height", lang="en")
    size = element("measurementsSet", types, element("measurementUnit", "cm"), element("measurementValue", "2,1"))
    assert one(record(sizes=measurements(size)))["height"] == "2,1 cm"


def test_nothing_that_was_measured_is_lost() -> None:
    """Unknown types and parts, second values and values without a type are joined, with what was said of them."""
    cells = one(
        record(
            sizes=measurements(
                measured("height", "23"),
                measured("height", "25"),
                measured("Höhe x Breite", "30 x 20"),
                measured("die axis", "12", "h"),
                element("measurementsSet", element("measurementValue", "5")),
                element("measurementsSet", element("measurementType", "width"), element("measurementUnit", "cm")),
            )
            + measurements(measured("width", "8"), extent="lid")
            + measurements(measured("height", "90"), extent="Gesamtmaß")
            + measurements(measured("depth", "4"), extent="depth")
            + measurements(measured("height", "99"), extent="Rahmenmaß")
        )
    )
    assert cells["height"] == "23 cm"
    assert cells["depth"] == "4 cm"
    assert cells["frame height"] == "99 cm"
    assert cells["other_measurements"] == (
        "height: 25 cm; Höhe x Breite: 30 x 20 cm; die axis: 12 h; 5; lid width: 8 cm; height: 90 cm".replace(
            "height: 90", "Gesamtmaß height: 90"
        )
    )
    assert "width" not in cells


# ---------------------------------------------------------------------------------------------------------------------
# Names, numbers and places


def repositories(*sets: str, identifier: str = "rec-1") -> str:
    inner = element("objectIdentificationWrap", element("repositoryWrap", *sets))
    return element("lido", element("lidoRecID", identifier), element("descriptiveMetadata", inner, lang="en"))


def repository(kind: str, number: str, place: str) -> str:
    names = element("namePlaceSet", element("appellationValue", place)) if place else ""
    city = element("partOfPlace", element("namePlaceSet", element("appellationValue", "Berlin")))
    return element(
        "repositorySet",
        element("workID", number) if number else "",
        element("repositoryLocation", names, city),
        **({"type": kind} if kind else {}),
    )


def test_only_where_the_object_is_now_counts() -> None:
    former, owner = repository("former", "OLD 1", "Attic"), repository("http://example.org/owner", "X 9", "Vault")
    current = repository("http://terminology.lido-schema.org/lido00475", "NEW 2", "Hall")
    cells = one(repositories(former, owner, current))
    assert (cells["object_number"], cells["gallery"]) == ("NEW 2", "Hall")
    located = repository("http://terminology.lido-schema.org/lido01018", "", "Case 4")
    cells = one(repositories(former, current, located))
    assert (cells["object_number"], cells["gallery"]) == ("NEW 2", "Case 4")
    assert one(repositories(former)) == {"object_number": "rec-1", "record_id": "rec-1"}
    assert one(repositories(repository("", "N 3", "")))["object_number"] == "N 3"
    assert "gallery" not in one(repositories(repository("", "N 3", "")))  # Berlin is what it is part of


def test_a_place_that_is_only_shown() -> None:
    shown = element("repositorySet", element("displayRepository", "Louvre, Room 711"), type="current")
    assert one(repositories(shown))["gallery"] == "Louvre, Room 711"


def test_the_inventory_number_comes_before_others() -> None:
    numbers = element("workID", "old 7", type="former number") + element(
        "workID", "2004:10", type="http://terminology.lido-schema.org/lido00113"
    )
    assert one(repositories(element("repositorySet", numbers, type="current")))["object_number"] == "2004:10"


def test_titles_by_preference_and_language() -> None:
    def title(text: str, **attributes: str) -> str:
        return element("titleSet", element("appellationValue", text, **attributes))

    titles = (
        title("The Smiler", pref="alternate")
        + title("Mona Lisa (it)", lang="it", pref="preferred")
        + title("La Joconde", lang="fra", pref="preferred")
        + title("Mona Lisa", lang="en-GB", pref="preferred")
    )
    inner = element("objectIdentificationWrap", element("titleWrap", titles))
    sheet = element("lido", element("lidoRecID", "1"), element("descriptiveMetadata", inner, lang="de"))
    assert one(sheet)["title"] == "Mona Lisa"
    assert one(sheet, languages=("fr", "en"))["title"] == "La Joconde"
    assert one(sheet, languages=())["title"] == "Mona Lisa (it)"


def test_a_description_in_two_languages_is_one_object() -> None:
    """Its measurements come from one of them; what one leaves out comes from the other."""

    def described(language: str, title: str, kind: str, more: str = "") -> str:
        return element(
            "descriptiveMetadata",
            element(
                "objectIdentificationWrap",
                element("titleWrap", element("titleSet", element("appellationValue", title))),
                more,
                element("objectMeasurementsWrap", measurements(measured(kind, "5"), display=f"{kind} 5 cm")),
            ),
            lang=language,
        )

    number = element("repositoryWrap", element("repositorySet", element("workID", "N 1")))
    sheet = element(
        "lido", element("lidoRecID", "1"), described("de", "Krug", "Höhe", number), described("en", "Jug", "height")
    )
    assert one(sheet) == {
        "object_number": "N 1",
        "record_id": "1",
        "title": "Jug",
        "dimensions": "height 5 cm",
        "height": "5 cm",
    }
    assert one(sheet, languages=("de",))["dimensions"] == "Höhe 5 cm"


def test_search_terms_are_not_names() -> None:
    work = element(
        "objectWorkType", element("term", "Brunnen"), element("term", "Skulptur", addedSearchTerm="yes")
    ) + concept("objectWorkType", "en:fountain", "de:Springbrunnen")
    assert one(record(classes=element("objectWorkTypeWrap", work)))["object_name"] == "Brunnen; fountain"


@settings(max_examples=examples(100), deadline=None)
@given(
    st.text(
        st.characters(exclude_categories=["Cc", "Cs", "Zs", "Zl", "Zp"], exclude_characters="\ufffe\uffff"), min_size=1
    ),
    st.text(
        st.characters(exclude_categories=["Cc", "Cs", "Zs", "Zl", "Zp"], exclude_characters="\ufffe\uffff"), min_size=1
    ),
)
def test_any_text_comes_back(number: str, value: str) -> None:
    """Letters of every script, signs and markup; runs of spaces count as one and are left out here."""
    cells = one(record(number=number, place=number, sizes=measurements(measured("height", escape(value)))))
    assert (cells["object_number"], cells["gallery"], cells["height"]) == (number, number, f"{value} cm")


# ---------------------------------------------------------------------------------------------------------------------
# Files


def test_rows_have_their_lines() -> None:
    first, second = record(number="A"), record(number="B")
    header, *found = rows(wrap(first, "", "", second))
    assert (header.number, header.line, tuple(header.cells)) == (0, 1, COLUMNS)
    assert [(row.number, row.line, row.cells[0]) for row in found] == [(1, 3, "A"), (2, 6, "B")]
    far = rows(wrap(first, "\n" * 70_000, second))[2]
    assert far.line == 3 + 70_000 + 2


def test_records_alone_and_in_a_harvest() -> None:
    space = 'xmlns:lido="http://www.lido-schema.org"'
    alone = record().replace("<lido:lido>", f"<lido:lido {space}>", 1).encode()
    assert rows(alone)[1].cells[0] == "A 1"
    page = '<OAI-PMH xmlns="http://www.openarchives.org/OAI/2.0/"><ListRecords>{}{}</ListRecords></OAI-PMH>'
    held = "".join(f"<record><metadata>{alone.decode()}</metadata></record>" for _ in range(2))
    last = page.format(held, '<resumptionToken completeListSize="2"/>').encode()
    assert len(rows(last)) == 3
    refused(page.format(held, "<resumptionToken>next</resumptionToken>").encode(), "one page of a harvest")


def test_comments_and_instructions_are_not_text() -> None:
    content = wrap(record(number="A")).replace(b">A<", b">A<!-- no --><?no no?> 2<")
    assert rows(content)[1].cells[0] == "A 2"


def test_other_encodings() -> None:
    content = wrap(record(title="Büste")).decode()
    for name in ("iso-8859-1", "utf-16"):
        assert rows(content.replace("UTF-8", name).encode(name))[1].cells[2] == "Büste"
    refused(content.encode("iso-8859-1"), "not well-formed XML after 0 records")


def test_a_damaged_file_raises_after_the_rows_before_the_damage() -> None:
    whole = wrap(*[record(number=f"N {n}") for n in range(200)])
    found: list[Row] = []
    with pytest.raises(CollectionError, match=r"not well-formed XML after 1\d\d records: .*cut off"):
        found.extend(read_records(io.BytesIO(whole[: len(whole) * 3 // 4]), "museum.xml"))
    assert 100 < len(found) < 200
    refused(whole.replace(b"</lido:title", b"</title", 1), "line 3: not well-formed XML after 0 records")


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (b"", "not well-formed"),
        (b"\x00\x01\x02", "not well-formed"),
        (b"number,title\n1,a\n", "not well-formed"),
        (b"<html/>", "holds no LIDO record .*its root is html"),
        (b'<lido:lidoWrap xmlns:lido="http://www.lido-schema.org"/>', "holds no LIDO record"),
        (b'<lido:lido xmlns:lido="http://example.org"/>', "holds no LIDO record"),
    ],
)
def test_what_is_no_lido_file(content: bytes, match: str) -> None:
    refused(content, match)


def test_a_record_within_a_record_is_refused() -> None:
    inner = record(number="B")
    refused(wrap(record().replace("</lido:lido>", f"{inner}</lido:lido>")), "a record within a record")


def test_a_path_is_opened(tmp_path: Path) -> None:
    path = tmp_path / "a file"
    path.write_bytes(wrap(record()))
    assert len(list(read_records(str(path), "museum.xml"))) == 2
    with pytest.raises(CollectionError, match=r"museum.xml: cannot be read: No such file"):
        list(read_records(tmp_path / "absent", "museum.xml"))


class Broken(io.RawIOBase):
    """A network share that goes away after the first bytes."""

    def __init__(self, content: bytes) -> None:
        self._content = io.BytesIO(content)

    def read(self, size: int = -1) -> bytes:
        block = self._content.read(size)
        if not block:
            raise OSError(5, "Input/output error")
        return block


def test_a_share_that_goes_away() -> None:
    content = wrap(*[record(number=f"N {n}") for n in range(50)])[:-10]
    with pytest.raises(CollectionError, match="reading stopped after 50 records: Input/output error"):
        list(read_records(Broken(content), "museum.xml"))  # type: ignore[arg-type]


# ---------------------------------------------------------------------------------------------------------------------
# Harm


@pytest.mark.parametrize(
    "declared",
    [
        "<!DOCTYPE x>",
        '<!DOCTYPE x [<!ENTITY e "text">]>',
        '<!DOCTYPE x SYSTEM "http://localhost:9/x.dtd">',
        '<!DOCTYPE x [<!ENTITY % p SYSTEM "http://localhost:9/x"> %p;]>',
    ],
)
def test_a_document_type_is_refused(declared: str) -> None:
    refused(
        wrap(record()).replace(b"<lido:lidoWrap", declared.encode() + b"<lido:lidoWrap"), "remove the line that begins"
    )


def test_entities_neither_grow_nor_fetch(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("secret")
    levels = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    outside = f'<!ENTITY e9 SYSTEM "{(tmp_path / "secret").as_uri()}">'
    for entities in (f'<!ENTITY e0 "0123456789">{levels}', outside):
        for place in (b">&e9;A 1<", b' lido:type="&e9;">A 1<'):
            content = wrap(record()).replace(b"<lido:lidoWrap", f"<!DOCTYPE x [{entities}]><lido:lidoWrap".encode())
            with pytest.raises(CollectionError) as caught:
                rows(content.replace(b' lido:type="inventory number">A 1<', place))
            assert "secret" not in str(caught.value)


def test_what_is_never_a_whole_record_does_not_fill_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml_records, "RECORD_LIMIT", 100_000)
    refused(wrap("<junk/>" * 50_000, record()), "100,000 bytes without a whole LIDO record")
    refused(wrap(record(title="x" * 200_000)), "100,000 bytes without a whole LIDO record")


def test_deep_nesting_is_refused() -> None:
    refused(wrap("<a>" * 100_000), "not well-formed")


def test_records_are_forgotten_and_large_files_read() -> None:
    """20 MB in 10,000 records, more than the parser looks at in one piece; the tree never holds more than a few."""
    sheet = record(sizes=measurements(measured("height", "1")), more=element("junk", "x" * 1_000))
    content = wrap(*[sheet] * 10_000)
    assert len(content) > 20e6
    held = [len(found.getroottree().getroot()) for found in lido._records(io.BytesIO(content), "museum.xml")]
    assert len(held) == 10_000
    assert max(held) < 50


@settings(max_examples=examples(200), deadline=None)
@given(st.data())
def test_a_damaged_file_is_refused_or_read(data: st.DataObject) -> None:
    whole = bytearray(wrap(record(sizes=measurements(measured("height", "1"))), record(number="B")))
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    try:
        seen: Any = rows(bytes(whole))
    except CollectionError as problem:
        seen = str(problem)
    assert seen[0].number == 0 if isinstance(seen, list) else seen.startswith("museum.xml")
