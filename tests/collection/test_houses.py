"""Lists of furnished houses and churches: the room, and where in it a thing is, on the mantel, over the sofa."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.places import case_in, parted
from pipeline.night.importing import Proposed, proposed
from pipeline.records import Item
from pipeline.tables.held_rows import HeldAs, told_by

HOUSE = '''Acc. #,Item,Description,Room,Where in room,H,W,D,Wt (lbs)
1.1,Tall case clock,"Mahogany, brass works",Entry Hall,on floor against wall,"94""","20""","10""",
1.2,Gilt mirror,"Pier glass, gilded gesso",Entry Hall,hung over table,"62 1/2""","31""","4""",55
1.3,Ginger jar,Porcelain,Parlor,mantel,"11""","8"" dia",,
1.4,Oil portrait,Oil on canvas,Parlor,wall,"36"" x 29""",,,
1.5,Astral lamp,"Brass, cut glass shade",Dining Room,on sideboard,"26""","8""",,
1.6,Chandelier,"Cut glass, 12 lights",Parlor,ceiling,"48""","36""",,~90
1.7,Bookcase,Mahogany,Library,against wall,"98""","43""","22""",~400
1.8,Bust of Washington,Marble,Library,on pedestal,"23""","14""","10""",
'''
VILLA = """N. inv.;Oggetto;Materia;Misure;Ambiente;Posizione
1;Orologio da camino;bronzo dorato, marmo;h 48, l 32, p 14;Salotto rosso;sul camino
2;Coppia di vasi;porcellana;h 62 diam. 25;Salotto rosso;sulla consolle
3;Ritratto di gentiluomo;olio su tela;98 x 74;Salotto rosso;sopra il divano
4;Lampadario a 24 luci;vetro di Murano;h 150 diam 130;Salone;soffitto
5;Stipo;ebano e avorio;h 165 x l 110 x p 45;Studiolo;contro parete
6;Candelieri;argento;h. cm 41;Cappella;sull'altare
"""
CHATEAU = """Inv.,Désignation,Salle,Emplacement,H,L,P
1,Pendule,Salon,cheminée,45 cm,30 cm,15 cm
2,Paire de vases,Salon,sur console,58,,
3,Buste de Diane,Vestibule,sur gaine,82,50,32
4,Commode,Chambre,contre le mur,88,130,62
5,Lustre,Salon,plafond,140,100,
6,Bénitier,Chapelle,mur,32,,
"""
HACIENDA = """Núm;Objeto;Material;Alto;Ancho;Fondo;Estancia;Ubicación
1;Reloj de mesa;bronce;40;25;12;Sala;sobre la chimenea
2;Jarrón;talavera;55;28;28;Comedor;encima del trinchador
3;Espejo;madera dorada;140;90;;Sala;arriba de la consola
4;Ropero;caoba;210;130;55;Recámara;esquina
5;San José;madera policromada;95;35;30;Capilla;nicho lateral
6;Óleo Virgen de Guadalupe;óleo/tela;110;80;;Capilla;muro sur
7;Metate;piedra;25;35;45;Cocina;piso
8;Arcón;encino;60;120;55;Recámara;a los pies de la cama
"""
KONAK = """Sıra,Envanter No,Eser Adı,En,Boy,Oda,Konum
1,K-1,Ayna,90,160,Salon,duvarda
2,K-2,Hat levhası,60,85,Selamlık,duvarda
3,K-3,Tablo,70,50,Selamlık,kapının üstünde
4,K-4,Semaver,30,48,Mutfak,masa üzerinde
"""
ARCHONTIKO = """Α/Α;Αντικείμενο;Ύψος;Πλάτος;Βάθος;Χώρος;Θέση
1;Ρολόι δαπέδου;225;50;28;Σαλόνι;δάπεδο
2;Βάζο Σεβρών;45;20;20;Σαλόνι;πάνω στο τζάκι
3;Πολυέλαιος;110;90;90;Τραπεζαρία;οροφή
4;Κασέλα;55;120;52;Υπνοδωμάτιο;στο δάπεδο
5;Πιάτο;5;30;30;Τραπεζαρία;στον μπουφέ
"""
JAERAE = """소장품번호,명칭,재질,크기,전시위치,전시여부
1,백자 달항아리,도자기,"높이 44.0cm, 입지름 20.5cm",도자실 단독장,전시중
2,청자 매병,도자기,높이 38.6cm,도자실 벽부장,전시중
3,석조 불두,석,높이 45cm 너비 30cm 두께 28cm,불교조각실,전시중
4,백자 접시,도자기,입지름 17cm 높이 4cm,도자실,비전시
"""
NEPAL = """Reg No.,Object,Material,Ht (inch),W (inch),Th (inch),Where kept,How kept
1,Standing Vishnu,Black stone,38,17,9,Sculpture gallery,on masonry pedestal
2,Bowl,Gilt copper,14.5,9,5,Bronze gallery,showcase 4
3,Prayer wheel,Brass,22,8,8,Bronze gallery,on table
4,Temple bell,Bronze,31,24,24,Courtyard,hanging from timber frame
5,Stupa,Crystal,8.5,4.5,4.5,Bronze gallery,showcase 4
"""


def found_in(folder: Path, rows: str) -> tuple[Proposed, list[Item]]:
    path = folder / "list.csv"
    path.write_text(rows, encoding="utf-8")
    found = proposed(str(path))
    return found, list(found.reading.items)


def stands(item: Item) -> str:
    scene = classify(item)
    return f"{scene.support} {scene.furniture}"


@pytest.mark.parametrize(
    ("rows", "rooms", "held"),
    [
        (HOUSE, ["Entry Hall", "Entry Hall", "Parlor", "Parlor", "Dining Room", "Parlor", "Library", "Library"],
         ["freestanding floor", "hung wall", "freestanding shelf", "hung wall", "freestanding pedestal",
          "suspended rail", "freestanding floor", "freestanding pedestal"]),
        (VILLA, ["Salotto rosso", "Salotto rosso", "Salotto rosso", "Salone", "Studiolo", "Cappella"],
         ["freestanding shelf", "freestanding pedestal", "hung wall", "suspended rail", "freestanding floor",
          "freestanding pedestal"]),
        (CHATEAU, ["Salon", "Salon", "Vestibule", "Chambre", "Salon", "Chapelle"],
         ["freestanding shelf", "freestanding pedestal", "freestanding pedestal", "freestanding floor",
          "suspended rail", "hung wall"]),
        (HACIENDA, ["Sala", "Comedor", "Sala", "Recámara", "Capilla", "Capilla", "Cocina", "Recámara"],
         ["freestanding shelf", "freestanding pedestal", "hung wall", "freestanding floor", "freestanding floor",
          "hung wall", "freestanding floor", "freestanding floor"]),
        (KONAK, ["Salon", "Selamlık", "Selamlık", "Mutfak"],
         ["hung wall", "hung wall", "hung wall", "freestanding pedestal"]),
        (ARCHONTIKO, ["Σαλόνι", "Σαλόνι", "Τραπεζαρία", "Υπνοδωμάτιο", "Τραπεζαρία"],
         ["freestanding floor", "freestanding shelf", "suspended rail", "freestanding floor", "freestanding pedestal"]),
        (NEPAL, ["Sculpture gallery", "Bronze gallery", "Bronze gallery", "Courtyard", "Bronze gallery"],
         ["freestanding pedestal", "freestanding showcase", "freestanding pedestal", "suspended rail",
          "freestanding showcase"]),
    ],
    ids=["house", "villa", "chateau", "hacienda", "konak", "archontiko", "nepal"],
)  # fmt: skip
def test_the_room_and_where_in_it(tmp_path: Path, rows: str, rooms: list[str], held: list[str]) -> None:
    """What a person reads in these rows: written down from the lists, not from what Kouros made of them."""
    _, items = found_in(tmp_path, rows)
    assert [item.gallery for item in items] == rooms
    assert [stands(item) for item in items] == held


@pytest.mark.parametrize(
    ("title", "medium", "expected"),
    [
        ("San José con el Niño", "madera policromada", "statue"),
        ("Virgin and Child", "wood and gesso", "statue"),
        ("Standing Vishnu", "Black stone", "statue"),
        ("Saint Jerome", "oil on wood", "framed"),
        ("Santa Rosa de Lima", "óleo sobre tela", "framed"),
        ("St. George and the Dragon", "engraving", "framed"),
        ("Santa Fe model train", "metal", "model"),
        ("San Francisco bay quilt", "cotton", "relief"),
    ],
)
def test_holy_figures_are_carved_and_their_pictures_are_not(title: str, medium: str, expected: str) -> None:
    assert classify(Item("1", "Chapel", title=title, medium=medium, height_m=0.9, width_m=0.9)).object_class == expected


def test_sizes_of_a_side_that_hold_more(tmp_path: Path) -> None:
    found, items = found_in(tmp_path, HOUSE)
    jar, portrait = items[2], items[3]
    # 8 in across is 8 in deep; 36 by 29 in stands in one cell: 0.0254 m an inch, exact.
    assert (jar.width_m, jar.depth_m) == (pytest.approx(8 * 0.0254), pytest.approx(8 * 0.0254))
    assert (portrait.height_m, portrait.width_m) == (pytest.approx(36 * 0.0254), pytest.approx(29 * 0.0254))
    assert any("text of sizes" in problem.message for problem in portrait.problems)
    assert portrait.title == "Oil portrait: Oil on canvas"
    assert not found.guess.left


def test_labels_in_small_letters_beside_two_sides(tmp_path: Path) -> None:
    _, items = found_in(tmp_path, VILLA)
    assert (items[0].height_m, items[0].width_m, items[0].depth_m) == (0.48, 0.32, 0.14)


def test_turkish_width_and_height(tmp_path: Path) -> None:
    _, items = found_in(tmp_path, KONAK)
    assert [(item.height_m, item.width_m) for item in items[:2]] == [(1.6, 0.9), (0.85, 0.6)]


def test_korean_cases_and_what_is_not_on_display(tmp_path: Path) -> None:
    _, items = found_in(tmp_path, JAERAE)
    assert [(item.gallery, item.case) for item in items[:2]] == [("도자실", "단독장"), ("도자실", "벽부장")]
    assert [item.on_display for item in items] == [True, True, True, False]


def test_a_case_that_is_named_by_how_things_are_kept(tmp_path: Path) -> None:
    _, items = found_in(tmp_path, NEPAL)
    assert [item.case for item in items] == ["", "showcase 4", "", "", "showcase 4"]
    assert items[0].depth_m == pytest.approx(9 * 0.0254)


def test_what_is_not_read_is_told(tmp_path: Path) -> None:
    rows = "No,Object,Height (cm),Where,Girth (cm),Curator's mood\n1,Vase,30,Room 1,60,good\n2,Bowl,9,Room 2,40,bad\n"
    found, _ = found_in(tmp_path, rows)
    assert set(found.guess.left) == {"Girth (cm)", "Curator's mood"}


@pytest.mark.parametrize("now", ["Gallery 3", "Case 3"])
def test_where_a_thing_is_kept_tells_nothing_of_how_it_is_shown(tmp_path: Path, now: str) -> None:
    rows = "".join(f'{n},Vase,30,{now},"Store A, shelf {n}",shelf {n}\n' for n in range(1, 7))
    heads = "No,Object,Height (cm),Current location,Normal location,Storage shelf\n"
    _, items = found_in(tmp_path, heads + rows)
    assert {item.gallery for item in items} == {now}
    assert not any("shelf" in item.displayed + item.case for item in items)


@pytest.mark.parametrize(
    ("place", "room", "case", "displayed"),
    [
        ("Teşhir - Salon 1 Vitrin 3", "Salon 1", "Vitrin 3", ""),
        ("On view: Room 4, case 2", "Room 4", "case 2", ""),
        ("Ausstellung, Raum 2, Vitrine 5", "Raum 2", "Vitrine 5", ""),
        ("第一展厅 3号柜", "第一展厅", "3号柜", ""),
        ("第2展示室 第3ケース", "第2展示室", "第3ケース", ""),
        ("도자공예실 진열장 3", "도자공예실", "진열장 3", ""),
        ("On view", "On view", "", ""),
    ],
)
def test_places_that_begin_with_being_on_view(place: str, room: str, case: str, displayed: str) -> None:
    assert parted(place) == (room, case, displayed)


def test_only_a_numbered_case_is_one() -> None:
    assert case_in("Vitrine 12, on a cushion") == "Vitrine 12"
    assert not case_in("on pedestal, secured with wax")


@pytest.mark.parametrize("text", ["Hanging scroll", "Wall clock", "stand", "Floor plan", "hung over table"])
def test_what_tells_nothing_of_how_it_is_held(text: str) -> None:
    assert told_by(text).furniture is None


def test_what_hangs_stands_on_nothing() -> None:
    over = told_by("on the wall over the sideboard")
    assert (over.support, over.furniture) == (told_by("on the wall").support, None)
    assert told_by("on chest of drawers").mount is None
    assert told_by("") == HeldAs()
