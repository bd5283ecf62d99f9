"""Lists as registrars of the Balkans, the Baltic, the Near East and South-East Asia write them: heads, sizes, cases.

What is right is what the words mean by the dictionary; no row is a museum's own.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.dimensions import choose, doubts, parse
from pipeline.collection.guess import guess
from pipeline.collection.places import parted
from pipeline.collection.reading import read_items

TEXTS = [
    ("v. 132 cm, š. 48 cm, d. 36 cm", (1.32, 0.48, 0.36, None)),  # Croatian
    ("vis. 62, šir. 38, dub. 14 cm", (0.62, 0.38, 0.14, None)),
    ("v. 65, š. 130, g. 60 cm", (0.65, 1.30, 0.60, None)),  # Slovene
    ("вис. 58 cm, шир. 40 cm, дуб. 30 cm", (0.58, 0.40, 0.30, None)),  # Serbian
    ("вис. 1,42 м; шир. 0,66 м; деб. 0,18 м", (1.42, 0.66, 0.18, None)),  # Bulgarian
    ("вис. 74 см, довж. 118 см, шир. 63 см", (0.74, 0.63, 1.18, None)),  # Ukrainian
    ("aukštis 64 cm, plotis 22 cm, gylis 18 cm", (0.64, 0.22, 0.18, None)),  # Lithuanian
    ("A 28,5 cm, sk. 17 cm", (0.285, None, None, 0.17)),
    ("P: 90 cm, L: 45 cm, T: 50 cm", (0.50, 0.45, 0.90, None)),  # Indonesian
    ("Cao 63 cm, đường kính 79,3 cm", (0.63, None, None, 0.793)),  # Vietnamese
    ("สูง 32 ซม. เส้นผ่านศูนย์กลาง 24 ซม.", (0.32, None, None, 0.24)),  # Thai
    ("ارتفاع ٤٥٫٥ سم، القطر ٣٠ سم", (0.455, None, None, 0.30)),  # Arabic, with its own digits
    ("طول ۹۰ سانتی متر، عرض ۴۵ سانتی متر، ارتفاع ۵۰ سانتی متر", (0.50, 0.45, 0.90, None)),  # Persian
    ('גובה 34 ס"מ קוטר 22 ס״מ', (0.34, None, None, 0.22)),  # Hebrew: the mark within cm is no inch
    ("גובה 1.65 מ'", (1.65, None, None, None)),
]


@pytest.mark.parametrize(("text", "sizes"), TEXTS)
def test_sizes_are_read(text: str, sizes: tuple[float | None, ...]) -> None:
    got = choose(parse(text))
    found = tuple(one and round(one.value, 6) for one in (got.height, got.width, got.depth, got.diameter))
    assert found == sizes


@pytest.mark.parametrize("text", ["qz. 65, xv. 130, wy. 60 cm", "v1. 65, v2. 130, kk. 60 cm"])
def test_labels_that_nobody_knows_are_said(text: str) -> None:
    """The last number alone has a unit and so was the height, of which nothing told."""
    read = parse(text)
    assert [one.kind for one in doubts(read, choose(read))] == ["part"]


LISTS = [
    ("Inv. br.;Naziv;Smještaj;Dimenzije\nMGZ-3;Kip;Dvorana 5, vitrina 2;v. 24 cm", "Dvorana 5", "vitrina 2"),
    ("Инв. бр.;Назив;Локација;Димензије\nНМ-1;Биста;Сала 2, постамент 4;висина 24 cm", "Сала 2", "постамент 4"),
    ("Инв. №;Наименование;Местонахождение;Размери\n12;Шлем;Зала 2, витрина 6;вис. 24 см", "Зала 2", "витрина 6"),
    ("Інв. номер;Назва предмета;Місце;Розміри\nКВ-1;Куманець;Зал 3, вітрина 8;вис. 24 см", "Зал 3", "вітрина 8"),
    ("Inv. Nr.;Pavadinimas;Vieta;Matmenys\nL 1;Ąsotis;2 salė, vitrina 4;aukštis 24 cm", "2 salė", "vitrina 4"),
    ("Inv. št.;Predmet;Mesto;Mere\nN 2;Vrč;soba 4, vitrina 1;viš. 24 cm", "soba 4", "vitrina 1"),
    ("رقم السجل;اسم القطعة;المكان;الأبعاد\n12;جرة;القاعة ٣ - خزانة ٥;ارتفاع ٢٤ سم", "القاعة ٣", "خزانة ٥"),
    ('מספר רישום;שם החפץ;מיקום;מידות\n1;כד;אולם 3 ויטרינה 2;"גובה 24 ס""מ"', "אולם 3", "ויטרינה 2"),
    ("No. Inventaris;Nama Koleksi;Lokasi;Ukuran\n2;Guci;Ruang 3, vitrin 4;tinggi 24 cm", "Ruang 3", "vitrin 4"),
    ("Số kiểm kê;Tên hiện vật;Vị trí trưng bày;Kích thước\nB 1;Tượng;Phòng 3, tủ 6;cao 24 cm", "Phòng 3", "tủ 6"),
    ("登録番号;名称;展示場所;法量\n１２;壺;第２展示室　ケース３;高さ２４㎝", "第２展示室", "ケース３"),
]


@pytest.mark.parametrize(("text", "gallery", "case"), LISTS)
def test_a_list_is_read_by_its_own_heads(tmp_path: Path, text: str, gallery: str, case: str) -> None:
    path = tmp_path / "list.csv"
    path.write_text(text, encoding="utf-8")
    (item,) = read_items(path, guess(path).mapping).items
    assert (item.gallery, item.case, item.height_m) == (gallery, case, 0.24)
    assert item.object_name or item.title


@pytest.mark.parametrize(
    ("text", "room", "case", "displayed"),
    [
        ("Gallery 3 on plinth", "Gallery 3", "", "on plinth"),
        ("Saal 3 an der Wand", "Saal 3", "", "an der Wand"),
        ("第３展示室 展示台", "第３展示室", "", "展示台"),
        ("Gallery 2 North wall", "Gallery 2", "", "North wall"),
        ("Hall of Plinths", "Hall of Plinths", "", ""),
        ("Loft i sal 2", "Loft i sal 2", "", "Loft i sal 2"),  # Danish: the ceiling of room 2
        ("Suspended above stairs", "Suspended above stairs", "", "Suspended above stairs"),
    ],
)
def test_what_stands_behind_a_room_without_a_comma(text: str, room: str, case: str, displayed: str) -> None:
    assert parted(text) == (room, case, displayed)
