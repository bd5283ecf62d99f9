"""Texts whose numbers were once dropped without a word: each is read, or a doubt says what was not."""

from __future__ import annotations

import pytest

from pipeline.collection.dimensions import choose, doubts, parse


def sizes(text: str) -> dict[str, float]:
    """Return what is chosen of a text [cm, kg], by field."""
    chosen = choose(parse(text))
    found = {name: getattr(chosen, name) for name in chosen.__slots__}
    return {name: round(one.value * (1 if name == "mass" else 100), 2) for name, one in found.items() if one}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        # One dimension behind several numbers is the last one's (MoMA).
        (
            '16 5/8 x 5 1/4 x 4" (42.2 x 13.3 x 10.2 cm) diam. at base',
            {"height": 42.23, "width": 13.34, "base_width": 10.16, "base_depth": 10.16},
        ),
        ('36 x 5 7/8" (91.5 x 15 cm) diam. at base', {"height": 91.44, "base_width": 14.92, "base_depth": 14.92}),
        # A remark inside a run ends it no more (MoMA): the first number was lost.
        ("45 (max.) x 22 x 30 cm", {"height": 45, "width": 22, "depth": 30}),
        ("45 max. x 22 x 30 cm", {"height": 45, "width": 22, "depth": 30}),
        ("30 (approx.) x 20 x 10 cm", {"height": 30, "width": 20, "depth": 10}),
        # What stands in brackets is beside the numbers before it, and nothing that follows is its own.
        (
            "Length: 2,351 mm (net 2,329 mm); Width: 939 mm (net 927 mm); Height: 898 mm (net 297 mm)",
            {"height": 89.8, "width": 93.9, "depth": 235.1},
        ),
        # Labels name the bare numbers that they repeat, in a museum's own order.
        ("82 x 49.5 x 170 cm; Lengd: 82 Breidd: 49.5 Hæð: 170 cm", {"height": 170, "width": 49.5, "depth": 82}),
        ("0 x 62 x 23.5 cm; Breidd: 62 Hæð: 23.5 cm", {"height": 23.5, "width": 62}),
        ("30 x 30 x 10 cm; H 10 cm, W 30 cm, D 30 cm", {"height": 10, "width": 30, "depth": 30}),
        # A case is not the sword's height, a volume no height, a sentence no part's name.
        ("Sword: overall length 978 mm, scabbard: 841 mm, case: 1029 mm", {"width": 97.8}),
        ("Volume 500 cm3", {}),
        ("30 cm²", {}),
        (
            "Sizes without lid, stand and projecting mouldings. Length: 200 cm; Height: 80 cm",
            {"height": 80, "width": 200},
        ),
    ],
)
def test_no_number_is_dropped(text: str, found: dict[str, float]) -> None:
    assert sizes(text) == pytest.approx(found, rel=1e-3)


@pytest.mark.parametrize("text", ["1:10 cm", "1:50 mm"])
def test_a_scale_with_a_unit_of_length_is_neither_time_nor_size(text: str) -> None:
    read = parse(text)
    assert not read.having("left_out")
    assert read.having("remainder")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("H 45 cm, ohne Sockel", True),
        ("12 x 10 x 8 cm (without base)", True),
        ("without base: H 30 cm; with base: H 40 cm", False),
        ("H 30 cm (without frame)", False),
    ],
)
def test_what_stands_on_a_base_that_nobody_measured_is_told(text: str, told: bool) -> None:
    read = parse(text)
    assert any("without the base" in note.message for note in doubts(read, choose(read))) is told
