"""What things are where no column is called so, and in which order a museum writes sizes that it does not label."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.dimensions import parse
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item

PLAIN = """Nr.;Titel;Maße
1;Bronzestatuette der Athena;H 22 cm, B 8 cm, T 7 cm
2;Henkelkrug;H 18 cm, Dm 12 cm
3;Standuhr;H 210 cm, B 50 cm, T 30 cm
4;Kerzenleuchter;H 30 cm, Dm 12 cm
"""


def read(tmp_path: Path, text: str) -> tuple[list[Item], list[str]]:
    path = tmp_path / "things.csv"
    path.write_text(text, encoding="utf-8")
    found = proposed(str(path)).guess
    return list(read_items(path, found.mapping).items), [str(one) for one in found.doubts]


def test_titles_of_a_list_of_bodies_name_its_things(tmp_path: Path) -> None:
    items, _ = read(tmp_path, PLAIN)
    assert [item.object_name for item in items] == [item.title for item in items]
    assert [classify(item).object_class for item in items] == ["figurine", "vessel", "clock", "lamp"]


def test_titles_of_pictures_do_not(tmp_path: Path) -> None:
    items, _ = read(
        tmp_path, "Nr.;Titel;Maße\n1;Der Krug;60 x 40 cm\n2;Stuhl am Fenster;80 x 60 cm\n3;Vase;50 x 40 cm\n"
    )
    assert not any(item.object_name for item in items)


def test_nor_beside_an_artist(tmp_path: Path) -> None:
    lines = [f"{line};{end}" for line, end in zip(PLAIN.splitlines(), ("Künstler", *["Anna Beck"] * 4), strict=True)]
    items, _ = read(tmp_path, "\n".join(lines))
    assert not any(item.object_name for item in items)


def test_the_first_sentence_of_a_description_names_a_thing(tmp_path: Path) -> None:
    items, _ = read(
        tmp_path,
        "No.,Description,Height (cm)\n1,Bronze figurine of a horse. It stands beside a vase.,12\n"
        "2,Oak armchair; the seat is worn.,98\n3,Glazed jug. Bought with a clock.,20\n",
    )
    assert [classify(item).object_class for item in items] == ["figurine", "seat", "vessel"]
    assert not any("vase" in item.object_name or "clock" in item.object_name for item in items)


@pytest.mark.parametrize(
    ("head", "labelled", "sides", "said"),
    [
        ("Maße (L x B x H)", 0, (0.2, 0.3, 0.1), "as the head of"),
        ("Maße (H x B x T)", 0, (0.3, 0.2, 0.1), ""),
        ("Maße", 4, (0.2, 0.3, 0.1), "as 4 of the column's texts with labels have it"),
        ("Maße", 2, (0.3, 0.2, 0.1), ""),
    ],
)
def test_the_order_of_unlabelled_sizes(
    tmp_path: Path, head: str, labelled: int, sides: tuple[float, float, float], said: str
) -> None:
    """Of "30 x 10 x 20 cm" or "30 x 20 x 10 cm" the head of the column, or three labelled texts of it, tell which."""
    rows = [f"{n};Kasten;L {30 + n} cm x B {10 + n} cm x H {20 + n} cm" for n in range(labelled)]
    numbers = "30 x 10 x 20" if sides[0] == 0.2 else "30 x 20 x 10"
    items, doubts = read(tmp_path, "\n".join([f"Nr.;Objektbezeichnung;{head}", *rows, f"9;Kasten;{numbers} cm"]))
    last = items[-1]
    assert last.height_m == pytest.approx(sides[0])
    assert sorted((last.width_m or 0, last.depth_m or 0)) == pytest.approx(sorted(sides[1:]))
    assert any(said in doubt for doubt in doubts) if said else not any("without labels" in doubt for doubt in doubts)


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("30/40 x 20 in.", [("height", 1.016), ("width", 0.508)]),
        ("L 82 cm; bore 12 mm", [("length", 0.82), ("unlabelled", 0.012)]),
        ("高さが19.5cm", [("height", 0.195)]),
        ("75 cm d'alçada", [("height", 0.75)]),
        ("visina 12 cm, promjer 8 cm", [("height", 0.12), ("diameter", 0.08)]),
    ],
)
def test_sizes_that_were_mistaken(text: str, read: list[tuple[str, float]]) -> None:
    assert [(part.dimension, part.value) for part in parse(text).parts] == [
        (dimension, pytest.approx(value)) for dimension, value in read
    ]


def test_the_bore_of_a_gun_is_of_a_part() -> None:
    assert [part.name for part in parse("L 82 cm; bore 12 mm").parts] == ["overall", "bore"]


@pytest.mark.parametrize(("beside", "width"), [("lat", None), ("Titre bis", pytest.approx(0.04676089))])
def test_a_longitude_is_no_length(beside: str, width: object, tmp_path: Path) -> None:
    """4.676 degrees east of Greenwich, as a register of many museums has it; without a latitude it may be a length."""
    heads = f"Numero_inventaire,Titre,{beside},long,Mesures"
    rows = [f"2003.0.{n},Robe,43.67646,4.676089,H. {n} cm" for n in range(101, 107)]
    items, _ = read(tmp_path, "\n".join([heads, *rows, ""]))
    assert [item.height_m for item in items] == [pytest.approx(n / 100.0) for n in range(101, 107)]
    assert all(item.width_m == width for item in items)
