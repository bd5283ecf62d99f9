"""The objects of a MuseumPlus RIA export (module XML of its web service, namespace http://www.zetcom.com/ria/ws/module).

Fields are known by the names of the standard data model; a museum's own fields are not read. The names are those of
public clients of the service (museumpy, MIT; mpapi) and of published exports.

| column | where it comes from |
|---|---|
| object_number, record_id | ObjObjectNumberTxt or its group or preview; the item's id |
| title, object_name | ObjObjectTitleVrt or its group; ObjTechnicalTermClb or its group |
| classification | ObjSystematicVrt or its group, ObjCategoryVoc |
| medium | ObjMaterialTechniqueVrt or its group, ObjMaterialTxt and ObjTechniqueTxt |
| gallery | ObjCurrentLocationVrt, its group, its vocabulary |
| image | ObjMultimediaRef or an attachment whose name is that of an image file |
| dimensions | ObjDimAllVrt, ObjDimensionTxt, the previews of ObjDimAllGrp |
| height, ... other_measurements | HeightNum, ..., FirstNum, ... as TypeVoc orders them, of ObjDimAllGrp, UnitDdiVoc |
"""

from __future__ import annotations

from collections.abc import Iterator
from io import BufferedReader
from typing import Any, BinaryIO, ClassVar, Literal

from pydantic import Field

from pipeline.collection.image_names import is_image_name
from pipeline.collection.sources.base import HEAD, FileSource, Request, SourceSettings
from pipeline.collection.sources.measurement_terms import kind_of, part_of
from pipeline.collection.sources.measurements import COLUMNS, MeasuredSettings, Measurements, joined, row_of
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xml_records import XML_FILES, XmlRecords

_RIA = "{http://www.zetcom.com/ria/ws/module}"

# What a path names: fields by their names, a group's field after a full stop. The first that says anything counts.
_PATHS: dict[str, tuple[str, ...]] = {
    "object_number": ("ObjObjectNumberTxt", "ObjObjectNumberVrt", "ObjObjectNumberGrp.InventarNrSTxt"),
    "title": ("ObjObjectTitleVrt", "ObjObjectTitleGrp.TitleTxt", "ObjTitleTxt"),
    "object_name": (
        "ObjTechnicalTermClb",
        "ObjTechnicalTermVrt",
        "ObjTechnicalTermGrp.TechnicalTermVoc",
        "ObjTechnicalTermGrp.TechnicalTermTxt",
        "ObjObjectNameVrt",
        "ObjObjectNameTxt",
        "ObjObjectNameGrp.NameTxt",
        "ObjObjectTypeTxt",
        "ObjObjectTypeVoc",
    ),
    "classification": (
        "ObjSystematicVrt",
        "ObjSystematicGrp.SystematicVoc",
        "ObjClassificationVoc",
        "ObjCategoryVoc",
        "ObjCategoryTxt",
    ),
    "gallery": (
        "ObjCurrentLocationVrt",
        "ObjCurrentLocationHierarchicalVrt",
        "ObjCurrentLocationGrpVrt",
        "ObjCurrentLocationVoc",
        "ObjCurrentLocationGrp.LocationVoc",
        "ObjCurrentLocationGrp.PreviewVrt",
        "ObjCurrentLocationTxt",
    ),
    "dimensions": ("ObjDimAllVrt", "ObjDimensionTxt", "ObjDimAllGrp.PreviewVrt", "ObjDimAllGrp.PreviewENVrt"),
}
_MEDIUM = (
    ("ObjMaterialTechniqueVrt",),
    ("ObjMaterialTechniqueGrp.ExportClb",),
    ("ObjMaterialTechniqueGrp.DetailsTxt",),
    ("ObjMaterialTxt", "ObjTechniqueTxt"),
    ("ObjMaterialTechniqueGrp.MaterialVoc", "ObjMaterialTechniqueGrp.TechniqueVoc"),
)
_KINDS = {
    "HeightNum": "height",
    "WidthNum": "width",
    "DepthNum": "depth",
    "LengthNum": "length",
    "DiameterNum": "diameter",
    "ThicknessNum": "thickness",
    "CircumferenceNum": "circumference",
    "WeightNum": "weight",
}


def read_museumplus(stream: BinaryIO, file: str, *, unit: str | None = None) -> Iterator[Row]:
    """Yield the header and then every object as a row, with the line where it begins.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : str
        Its name in messages.
    unit : str or None
        The unit of lengths that name none.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        For a file that is damaged, holds no object, or declares a document type.
    """
    yield Row(0, 1, list(COLUMNS))
    found = XmlRecords(
        file,
        tag=f"{_RIA}moduleItem",
        what="moduleItem",
        none="holds no moduleItem of http://www.zetcom.com/ria/ws/module, its root is {root}; export the module Object "
        "as XML",
    )
    number = 0
    for item in found.read(stream):
        module = item.getparent()
        if module is not None and module.get("name") not in (None, "Object"):
            continue
        number += 1
        cells = {
            column: next(filter(None, (joined(_texts(item, path)) for path in paths)), "")
            for column, paths in _PATHS.items()
        }
        cells["record_id"] = str(item.get("id") or "")
        cells["medium"] = next(
            filter(None, (joined(text for path in paths for text in _texts(item, path)) for paths in _MEDIUM)), ""
        )
        cells["image"] = next(filter(is_image_name, _pictures(item)), "")
        # Previews write a hierarchy with arrows, which begin it where the uppermost place has no name.
        cells["gallery"] = cells["gallery"].strip(" ->")
        yield row_of(number, item.sourceline, cells, _measured(item, unit))


def _pictures(item: Any) -> Iterator[str]:
    """Yield the names of files that a record names among its media."""
    for reference in item.findall(f"{_RIA}moduleReference"):
        if reference.get("name") == "ObjMultimediaRef":
            yield from (" ".join((e.text or "").split()) for e in reference.iter(f"{_RIA}formattedValue"))
    yield from (one.get("name") or "" for one in item.findall(f"{_RIA}attachment"))


def _texts(item: Any, path: str) -> Iterator[str]:
    group, _, name = path.rpartition(".")
    places = [item]
    if group:
        places = [
            one
            for found in item.findall(f"{_RIA}repeatableGroup")
            if found.get("name") == group
            for one in _in_order(found)
        ]
    for place in places:
        for field in place:
            if field.get("name") == name:
                yield _said(field)


def _in_order(group: Any) -> list[Any]:
    """Return the items of a repeatable group in the museum's own order."""

    def order(item: Any) -> float:
        sort = next((_said(f) for f in item if f.get("name") == "SortLnu"), "")
        return float(sort) if sort.isdecimal() else 1e9

    return sorted(group.findall(f"{_RIA}repeatableGroupItem"), key=order)


def _said(field: Any) -> str:
    """Return what a field says: its value, or the words of what it refers to."""
    value = field.findtext(f"{_RIA}value") or field.findtext(f"{_RIA}formattedValue")
    if value is None:
        value = next((e.text or "" for e in field.iter(f"{_RIA}formattedValue")), "")
    if not value:
        value = next((e.get("name") or "" for e in field.iter(f"{_RIA}vocabularyReferenceItem")), "")
    return " ".join(value.split())


_ORDERED = ("FirstNum", "SecondNum", "ThirdNum", "FourthNum")
"""Numbers that the kind of measuring names by their order: "Höhe x Breite x Tiefe"."""
_KIND_SAID = ("TypeDimRef", "TypeDimRefVoc", "TypeVoc", "TypeDimVoc")
"""Where a measurement may say of what it is."""


def _measured(item: Any, unit: str | None) -> Measurements:
    out = Measurements(unit)
    groups = [g for g in item.findall(f"{_RIA}repeatableGroup") if g.get("name") in ("ObjDimAllGrp", "ObjDimensionGrp")]
    for one in (one for group in groups for one in _in_order(group)):
        said = {field.get("name"): _said(field) for field in one}
        preview = said.get("PreviewVrt", "")
        # A preview that is no text of sizes says of what they are: Objektmass, Rahmenmass.
        told = "" if any(map(str.isnumeric, preview)) else preview
        kind_said = next((said[name] for name in _KIND_SAID if said.get(name)), told)
        # What no table has is a kind of measuring ("Höhe x Breite") of the whole, unless it says what else.
        part = part_of(kind_said.partition("(")[0])
        if part is None and not _names_a_part(kind_said):
            part = ""
        numbers: list[tuple[str, str | None]] = [(field, kind) for field, kind in _KINDS.items() if said.get(field)]
        ordered = [field for field in _ORDERED if said.get(field)]
        sides = _sides(kind_said)
        # An order that names as many sides is believed; other numbers are kept as what nobody could name.
        numbers += zip(ordered, sides if len(sides) == len(ordered) else [None] * len(ordered), strict=True)
        for field, kind in numbers:
            mass = kind == "weight"
            named = said.get("UnitWeightVoc" if mass else "UnitDdiVoc") or said.get("UnitVoc") or ""
            if mass and not named:
                named = said.get("UnitDdiVoc", "") if said.get("UnitDdiVoc") in ("g", "kg") else ""
            out.take(kind, said[field], named, part, said=f"{kind_said} {kind or ''}".strip())
    return out


def _sides(text: str) -> list[str | None]:
    """Return which sides a kind of measuring names, in its order: of "Rahmenmaß (Höhe x Breite)" height and width."""
    inner = text.partition("(")[2].rpartition(")")[0] or text
    words = inner.replace("×", " x ").replace("/", " x ").replace(",", " x ").split(" x ")
    sides = [kind_of(word.strip()) for word in words]
    return sides if all(sides) else []


def _names_a_part(text: str) -> bool:
    """Whether words say that something else than the object was measured: of which kinds there are many."""
    words = text.replace("×", " x ").replace("/", " ").replace(",", " ").partition("(")[0].split()
    return any(word.casefold() not in ("x", "und", "and", "et") and kind_of(word) is None for word in words)


class MuseumPlusSettings(MeasuredSettings):
    """How a MuseumPlus RIA export is read."""

    format: Literal["museumplus"] = Field(description="The kind of source.")


class MuseumPlus(FileSource):
    """An export of the module Object of MuseumPlus RIA as XML."""

    name = "museumplus"
    title = "a MuseumPlus RIA file"
    Settings: ClassVar[type[SourceSettings]] = MuseumPlusSettings
    folder = XML_FILES

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether the format's namespace is named at its beginning."""
        return b"zetcom.com/ria/ws/module" in head[:HEAD]

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the objects.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.
        """
        return read_museumplus(binary, file, unit=request.settings.unit)
