"""The columns of the programs that museums run are known by the names that these programs give them."""

from __future__ import annotations

import pytest

from pipeline.collection.guessing.columns import columns_of
from pipeline.collection.guessing.likeness import misspelt
from pipeline.collection.guessing.long_rows import long_form_of
from pipeline.collection.guessing.names import named

NAMES = {
    "TMS": "ObjectNumber=object_number CurLocationString=gallery DisplayDimensions=dimensions OnView=on_display",
    "MuseumPlus": "ObjObjectNumberVrt=object_number ObjObjectTitleGrp.TitleTxt=title ObjTechnicalTermClb=object_name "
    "ObjMaterialTechniqueGrp.ExportClb=medium ObjDimAllGrp.HeightNum=height_m ObjDimAllGrp.WeightNum=mass_kg "
    "ObjCurrentLocationVrt=gallery ObjDimensionVrt=dimensions",
    "EMu": "TitAccessionNo=object_number TitMainTitle=title PhyMedium=medium PhyHeight=height_m PhyWeight=mass_kg "
    "LocCurrentLocationRef.SummaryData=gallery LocCurrentSummaryData=gallery",
    "Axiell": "object_number=object_number object_name=object_name dimension.free=dimensions "
    "object_category=classification current_location.name=gallery",
    "Mimsy": "ID_NUMBER=object_number ITEM_NAME=object_name MATERIALS=medium MEASUREMENTS=dimensions",
    "PastPerfect": "OBJECTID=object_number OBJNAME=object_name HEIGHTIN=height_m DIAMETERIN=diameter_m HOMELOC=gallery "
    "DIMNOTES=dimensions",
    "CollectiveAccess": "ca_objects.idno=object_number ca_objects.preferred_labels=title "
    "ca_storage_locations.preferred_labels=gallery ca_objects.dimensions.dimensions_height=height_m",
    "Omeka": "Dublin~Core:Title=title Dublin~Core:Identifier=object_number dcterms:medium=medium "
    "dcterms:extent=dimensions",
    "CollectionSpace": "objectNumber=object_number dimensionSummary=dimensions computedCurrentLocation=gallery",
    "ArchivesSpace": "component_id=object_number extent_dimensions=dimensions",
    "Joconde (France)": "INV=object_number DENO=object_name TITR=title DIMS=dimensions",
    "Palissy (France)": "TICO=title DENO=object_name DIMS=dimensions",
    "Sarpur (Iceland)": "Heiti=object_name Stærð=dimensions Efni=medium Staðsetning=gallery",
}


@pytest.mark.parametrize(
    ("program", "column", "field"),
    [(program, *pair.replace("~", " ").split("=")) for program, pairs in NAMES.items() for pair in pairs.split(" ")],
)
def test_columns_of_programs(program: str, column: str, field: str) -> None:
    found = named(column)
    assert found is not None, program
    assert found.field == field, program


@pytest.mark.parametrize("column", ["extent", "WEIGHTIN?", "measuredPart", "ObjectStatus", "Höhe:"])
def test_columns_that_say_none_of_it(column: str) -> None:
    """An archive's extent is boxes or feet of shelf, and no size of a thing."""
    found = named(column)
    assert found is None or found.field == ("height_m" if column == "Höhe:" else "")


def test_what_looks_like_a_column_and_is_none() -> None:
    assert misspelt("Auteur") is None
    # Of the Metropolitan Museum's file: blanks between separators are no kinds of measurements.
    rows = [["1", " | ", "1800|1810"], ["2", " | ", "1820|1830"]]
    assert long_form_of(columns_of(["Object Number", "Artist Suffix", "Artist Begin Date"], rows)) is None
