"""Lists of farms, houses and loans: rooms by what they are, names in descriptions, techniques in names."""

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.night.importing import Proposed, proposed
from pipeline.records import Item, Support

FARM = """Nr;Gegenstand;Material;H;B;T;Ort;Bemerkung
1;Butterfass;Holz;95;32;32;Stube;
2;Bauernschrank;Fichte;178;125;48;Schlafkammer;
3;Pflug;Eisen, Holz;90;70;210;Scheune;
4;Milchkanne;Blech;52;30;30;Stall;
5;Kachelofen;Keramik;195;90;80;Stube;eingebaut
6;Wanduhr;Holz;65;34;18;Küche;hängt an der Wand
"""
LOAN = """Lender,Lender's number,Description,Dimensions (framed),Insurance value,Installation requirements,Gallery
Museo X,123,"Madonna and Child, oil on panel","92 x 71 x 8 cm",EUR 400000,"security plates, 4 points",Gallery 5
Kunsthaus Y,K 44,"Bronze statuette of Hercules","H. 41 x W. 18 x D. 16 cm",EUR 120000,"case with museum gel",Gallery 5
Collection Z,Z-9,"Ivory casket","14 x 22 x 12 cm",EUR 80000,"case, on low deck",Gallery 6
Private,P.1,"Marble bust of a Roman lady","H. 65 cm incl. socle",EUR 350000,"plinth, bolted",Gallery 6
"""


def listed(folder: Path, text: str) -> tuple[Proposed, list[Item]]:
    file = folder / "list.csv"
    file.write_text(text, encoding="utf-8")
    read = proposed(str(file))
    return read, list(read.reading.items)


def test_rooms_of_a_farm_are_places(tmp_path: Path) -> None:
    _, items = listed(tmp_path, FARM)
    assert [one.gallery for one in items] == ["Stube", "Schlafkammer", "Scheune", "Stall", "Stube", "Küche"]
    assert classify(items[5]).support is Support.HUNG


def test_a_loan_is_named_by_its_description_and_not_by_its_lender(tmp_path: Path) -> None:
    _, items = listed(tmp_path, LOAN)
    assert [one.object_number for one in items] == ["123", "K 44", "Z-9", "P.1"]
    assert not any("Kunsthaus" in f"{one.title} {one.object_name}" for one in items)
    scenes = [classify(one) for one in items]
    assert [one.object_class for one in scenes] == ["framed", "figurine", "cabinet", "bust"]
    held = [Support.HUNG, Support.FASTENED, Support.FREESTANDING, Support.FASTENED]
    assert [one.support for one in scenes] == held


@pytest.mark.parametrize(
    ("name", "medium", "object_class"),
    [
        ("Madonna and Child, oil on panel", "", "framed"),
        ("Madonna and Child", "oil on panel", "framed"),
        ("Bust of a lady", "pastel on paper", "framed"),
        ("Sainte Anne, huile sur toile", "", "framed"),
        ("Statue of a saint", "wood, painted", "statue"),
        ("Vase, glass", "", "vessel"),
    ],
)
def test_a_technique_tells_a_picture_whatever_it_shows(name: str, medium: str, object_class: str) -> None:
    item = Item(
        object_number="1", gallery="A", title="", object_name=name, medium=medium, on_display=True,
        height_m=0.92, width_m=0.71, depth_m=0.08,
    )  # fmt: skip
    assert classify(item).object_class == object_class


def test_a_longcase_clock_screwed_to_the_wall_stands_there_without_a_depth() -> None:
    clock = Item(
        object_number="1", gallery="Salle 3", title="", object_name="Horloge comtoise", on_display=True,
        displayed="contre le mur, vissée", height_m=2.35, width_m=0.45,
    )  # fmt: skip
    assert classify(clock).support is Support.FASTENED
