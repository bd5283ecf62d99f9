"""Lists in a registrar's shorthand: headings and heads again and again, places by signs, sizes between slashes."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.told import as_displayed
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.display_words import flag_of
from pipeline.collection.guessing.frames import without_frame
from pipeline.collection.guessing.names import unit_in
from pipeline.collection.places import NamedPlace, parted
from pipeline.night.importing import Proposed, proposed
from pipeline.records import Furniture, Hanging, Item, Support
from pipeline.tables.held_rows import told_by

SECTIONS = """GALLERY 1 - EGYPT,,,,
No,Object,Dims,Wt,Case
E.1,"Anthropoid coffin, wood",185 x 52 x 40 cm,45 kg,"standing in corner, strapped"
E.2,"Canopic jar, limestone",36 x 17 cm dia,6 kg,Case 1
GALLERY 2 - GREECE,,,,
No,Object,Dims,Wt,Case
G.1,"Krater, red-figure",46 x 48 cm dia,8 kg,Case 4
G.2,"Head of a youth, marble",29 x 20 x 22 cm,18 kg,"plinth, on pin"
Total,4 objects,,,
"""
PALACE = """Pos;Bezeichnung;Standort (Geschoss/Raum/Vitrine);Größe H/B/T;kg
1;Meißener Deckelvase;OG1 / Porzellankabinett / Vitrine 2;62/31/31;7,5
2;Bodenstanduhr;OG1 / Gartensaal / –;245/58/34;65
3;Gobelin;OG1 / Gartensaal / Wand Nord;310/420/–;
4;Kronleuchter;OG1 / Gartensaal / Decke;160/120/120;85
5;Marmorbüste;EG / Vestibül / Postament;78/55/32;120
"""
PICTURES = """Acc.no,Title,Medium,Image H (in),Image W (in),Framed H (in),Framed W (in),Framed D (in),Location,Hardware
P.1,Ville d'Avray,oil on canvas,19 1/4,25 5/8,29,36,4,Gallery 5 north wall,"2 D-rings, wire"
P.3,The Gale,oil on canvas,30,48,41,59,5,Gallery 7,"security hangers, 2 each"
P.4,The Thinker,bronze,79,38,,,,Sculpture court,bolted to granite plinth
P.5,Mobile,painted steel,60,,,,,Atrium,suspended from ceiling on cable
"""
PARISH = """N°,Descripción,Material y técnica,Medidas aprox.,Lugar dentro del templo
1,Cristo crucificado,madera policromada,1.80 m de alto,"Altar mayor, muro testero"
3,Campana mayor,bronce fundido,"90 cm Ø x 85 cm alto, unos 400 kg","Torre, colgada de viga"
5,Pila bautismal,piedra laja,1.02 m alto x .75 m diámetro,"Bautisterio, empotrada al piso"
6,Óleo Ánimas del Purgatorio,óleo sobre lienzo,2.40 x 1.90 m,Muro norte de la nave
7,Candelabros,bronce,1.35 m,"Presbiterio, en el piso"
"""
UNIVERSITY = """Ref,Instrument / specimen,Bldg,Room,Cabinet,Shelf,L x W x H (mm),Weight/kg
PH-001,Wimshurst machine,Main,Foyer,1,2,520 x 340 x 610,14
ZO-120,Skeleton of gorilla,Darwin,Museum Rm 1,,,900 x 800 x 1650,35
ZO-121,Spirit jar: octopus,Darwin,Museum Rm 1,4,3,180 x 180 x 420,9.2
GE-007,Iron meteorite,Main,Corridor,,,410 x 330 x 300,118
"""
FRENCH = """REF;INV;DENO;TITR;TECH;DIMS;EMPL
1;D 889.1;tableau;Portrait de femme;huile, toile;H. 73, l. 60, H. avec cadre 95, l. avec cadre 82;Salle 4, mur est
2;D 902.3;statue;Vénus accroupie;marbre;H. 141, l. 83, P. 70, Poids 520 kg;Salle 1, sur socle maçonné
3;I 77.2;pendule;Pendule au char;bronze;H. 0,46 m, l. 0,52 m, P. 0,14 m;Salle 6, cheminée
4;D 2001.9;dessin;Étude de mains;pierre noire;H. 28,5, l. 21;Cabinet d'arts graphiques, réserve
"""
SWEDISH = """Accnr;Sakord;Benämning;Material;Lokal;Monter;Höjd;Bredd;Djup;Vikt;Anm
1;Skåp;Hörnskåp, allmoge;furu, målat;Allmogesalen;;198 cm;92 cm;64 cm;ca 60 kg;står fritt
2;Runsten;Fragment av runsten;sandsten;Entréhallen;;155 cm;70 cm;18 cm;ca 320 kg;stöttad mot vägg, förankrad
3;Bägare;Snapsbägare;silver;Silverkammaren;M3;9 cm;6 cm;6 cm;;
4;Båtmodell;Skonert Ellida;trä, tyg;Sjöfartsrummet;M7;88 cm;110 cm;35 cm;9 kg;
5;Ur;Golvur, Mora;furu, mässing;Allmogesalen;;212 cm;48 cm;25 cm;;fäst i vägg
"""


def listed(folder: Path, text: str) -> tuple[Proposed, dict[str, Item]]:
    file = folder / "list.csv"
    file.write_text(text, encoding="utf-8")
    read = proposed(str(file))
    return read, {item.object_number: item for item in read.reading.items}


def test_the_first_heading_may_stand_above_the_names_of_the_columns(tmp_path: Path) -> None:
    read, items = listed(tmp_path, SECTIONS)
    assert {number: item.gallery for number, item in items.items()} == {
        "E.1": "GALLERY 1 - EGYPT",
        "E.2": "GALLERY 1 - EGYPT",
        "G.1": "GALLERY 2 - GREECE",
        "G.2": "GALLERY 2 - GREECE",
    }
    refused = [one.message for one in read.reading.rejected]
    assert len(refused) == 2
    assert "row 4 (line 6): repeats the names of the columns" in refused[0]
    assert "'Total' sums the others up" in refused[1]


def test_a_title_above_the_names_is_no_heading_where_none_is_like_it(tmp_path: Path) -> None:
    more = SECTIONS.replace("Total,", "GALLERY 3 - ROME,,,,\nR.1,Bust,71 x 52 x 28 cm,96 kg,plinth\nTotal,")
    read, items = listed(tmp_path, more.replace("GALLERY 1 - EGYPT", "Insured objects of 2026"))
    assert "first_heading" not in read.guess.text
    assert (items["E.1"].gallery, items["R.1"].gallery) == ("Location not recorded", "GALLERY 3 - ROME")


def test_sizes_between_slashes_and_walls_of_a_room(tmp_path: Path) -> None:
    _, items = listed(tmp_path, PALACE)
    assert {number: (one.height_m, one.width_m, one.depth_m) for number, one in items.items()} == {
        "1": (0.62, 0.31, 0.31),
        "2": (2.45, 0.58, 0.34),
        "3": (3.1, 4.2, None),
        "4": (1.6, 1.2, 1.2),
        "5": (0.78, 0.55, 0.32),
    }
    assert [one.gallery for one in items.values()] == [
        "OG1 / Porzellankabinett",
        "OG1 / Gartensaal",
        "OG1 / Gartensaal",
        "OG1 / Gartensaal",
        "EG / Vestibül",
    ]
    assert [one.mass_kg for one in items.values()] == [7.5, 65.0, None, 85.0, 120.0]


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("62/31/31", "62 x 31 x 31"),
        ("310 / 420 / –", "310 x 420"),
        ("12,5/8/3", "12,5 x 8 x 3"),
        ("1500/600/1700", "1500 x 600 x 1700"),
        ("12/05/1998", "12/05/1998"),
        ("1/2", "1/2"),
    ],
)
def test_three_numbers_between_slashes_are_sides_and_dates_are_dates(text: str, plain: str) -> None:
    assert plain_text(text) == plain


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("G12.C03.S2", NamedPlace("G12", "C03.S2")),
        ("G12-P01", NamedPlace("G12", "", "P01")),
        ("ST-B2-R14", NamedPlace("ST-B2-R14")),
        ("B2.R14", NamedPlace("B2.R14")),
        ("Gallery 3, east wall", NamedPlace("Gallery 3", "", "east wall")),
        ("Hall / West wing", NamedPlace("Hall / West wing")),
    ],
)
def test_places_by_signs_and_walls(text: str, place: NamedPlace) -> None:
    assert parted(text) == place


def test_flags_in_two_languages_and_units_in_hebrew() -> None:
    assert flag_of("Oui / Yes") is True
    assert flag_of("Non / No") is False
    assert flag_of("Y/N") is flag_of("N/A") is None
    assert unit_in('גובה (ס"מ)') == ("גובה", "cm")
    assert unit_in('משקל (ק"ג)')[1] == "kg"


def test_the_frame_counts_and_what_has_none_is_as_it_is(tmp_path: Path) -> None:
    _, items = listed(tmp_path, PICTURES)
    # Inches of 25.4 mm.
    assert [(one.height_m, one.width_m) for one in items.values()] == [
        pytest.approx((29 * 0.0254, 36 * 0.0254), rel=1e-12),
        pytest.approx((41 * 0.0254, 59 * 0.0254), rel=1e-12),
        pytest.approx((79 * 0.0254, 38 * 0.0254), rel=1e-12),
        (pytest.approx(60 * 0.0254, rel=1e-12), None),
    ]
    shown = {number: as_displayed(item) for number, item in items.items()}
    assert shown["P.1"].hanging is Hanging.TWO_HOOKS
    assert (shown["P.4"].support, shown["P.5"].support) == (Support.FASTENED, Support.SUSPENDED)


def test_pixels_are_no_sizes_and_the_whole_goes_before_its_image(tmp_path: Path) -> None:
    _, items = listed(
        tmp_path,
        "Acc.no,Title,Medium,Height (cm),Width (cm),Image Height (cm),Image Width (cm),"
        "Image Height,Image Width,Location\n"
        "1,The Gale,oil on canvas,104,150,76,122,3000,4200,Gallery 1\n"
        "2,Great Wave,woodblock print,,,25,38,2800,4100,Gallery 1\n"
        "3,Fuji,woodblock print,,,26,39,2800,4100,Gallery 1\n",
    )
    assert [(one.height_m, one.width_m) for one in items.values()] == [(1.04, 1.5), (0.25, 0.38), (0.26, 0.39)]


@pytest.mark.parametrize(
    ("name", "rest", "framed"),
    [
        ("Framed H", "height", True),
        ("Largeur avec cadre", "Largeur", True),
        ("Höhe mit Rahmen", "Höhe", True),
        ("Höhe ohne Rahmen", "Höhe", False),
        ("Altura sin marco", "Altura", False),
        ("Image Width", "Width", False),
    ],
)
def test_sizes_with_and_without_a_frame(name: str, rest: str, framed: bool) -> None:
    assert without_frame(name) == (rest, framed)
    assert without_frame("Height") is None


def test_places_and_ways_in_one_column_where_no_other_tells_places(tmp_path: Path) -> None:
    _, items = listed(tmp_path, PARISH)
    assert {number: item.gallery for number, item in items.items()} == {
        "1": "Altar mayor, muro testero",
        "3": "Torre",
        "5": "Bautisterio",
        "6": "Muro norte de la nave",
        "7": "Presbiterio",
    }
    assert classify(items["3"]).support is Support.SUSPENDED
    assert classify(items["5"]).support is Support.FASTENED


def test_a_head_that_is_the_order_of_sizes_alone(tmp_path: Path) -> None:
    _, items = listed(tmp_path, UNIVERSITY)
    assert {number: (one.height_m, one.width_m, one.depth_m) for number, one in items.items()} == {
        "PH-001": (0.61, 0.34, 0.52),
        "ZO-120": (1.65, 0.8, 0.9),
        "ZO-121": (0.42, 0.18, 0.18),
        "GE-007": (0.3, 0.33, 0.41),
    }
    assert [one.case for one in items.values()] == ["1", "", "4", ""]


def test_codes_of_the_french_register(tmp_path: Path) -> None:
    _, items = listed(tmp_path, FRENCH)
    assert [(one.object_name, one.title, one.gallery) for one in items.values()] == [
        ("tableau", "Portrait de femme", "Salle 4"),
        ("statue", "Vénus accroupie", "Salle 1"),
        ("pendule", "Pendule au char", "Salle 6"),
        ("dessin", "Étude de mains", "Cabinet d'arts graphiques, réserve"),
    ]
    assert [one.height_m for one in items.values()] == [0.95, 1.41, 0.46, 0.285]
    assert [one.on_display for one in items.values()] == [True, True, True, False]


def test_a_swedish_list_with_cases(tmp_path: Path) -> None:
    read, items = listed(tmp_path, SWEDISH)
    assert not read.guess.left
    assert [one.case for one in items.values()] == ["", "", "M3", "M7", ""]
    held = [classify(one).support for one in items.values()]
    assert held[0] is held[2] is held[3] is Support.FREESTANDING
    assert held[1] is held[4] is Support.FASTENED


@pytest.mark.parametrize(
    ("words", "support", "furniture"),
    [
        ("Floor, unfixed", Support.FREESTANDING, Furniture.FLOOR),
        ("wall, 2 hooks", Support.HUNG, None),
        ("East, wall, case 3", None, None),
        ("vetrina 3, appeso", Support.HUNG, Furniture.SHOWCASE),
        ("壁面ケース", None, Furniture.SHOWCASE),
        ("Wall case 5, shelf 3", None, Furniture.SHOWCASE),
        ("tegen de wand, niet verankerd", Support.FREESTANDING, Furniture.FLOOR),
        ("hängt an Haken", Support.HUNG, None),
    ],
)
def test_pieces_of_what_is_said_of_a_display(words: str, support: Support | None, furniture: Furniture | None) -> None:
    told = told_by(words)
    assert (told.support, told.furniture) == (support, furniture)


def test_positions_that_are_cases_and_thousands_of_grams(tmp_path: Path) -> None:
    _, items = listed(
        tmp_path,
        "資料番号,資料名,材質,展示室,展示位置,固定,寸法 H×W×D (mm),重さ(g)\n"
        'N-02,市松人形,桐塑,展示室1,ケース3 上段,テグス,410×150×120,"680"\n'
        'N-03,こけし,木,展示室1,ケース5,ワックス,305×78×78,"410"\n'
        'N-04,からくり人形,木,展示室2,独立ケース2,底板ねじ止め,620×400×380,"5,200"\n'
        'N-07,獅子頭,木,ロビー,台上,なし,330×380×410,"3,900"\n',
    )
    assert [one.mass_kg for one in items.values()] == [0.68, 0.41, 5.2, 3.9]
    assert [classify(one).support for one in items.values()] == [Support.FASTENED] * 3 + [Support.FREESTANDING]


def test_a_wardrobe_on_the_wall_stands_before_it() -> None:
    wardrobe = Item(
        object_number="1", gallery="Stube", title="", object_name="Bauernschrank", on_display=True,
        displayed="an der Wand, Winkel oben", height_m=1.82, width_m=1.28, depth_m=0.52,
    )  # fmt: skip
    assert classify(wardrobe).support is Support.FREESTANDING
