"""Exports of museums that nobody has seen: what a person reads from them is read, with no step but the guess itself."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items

from .newcomers import ALL, Newcomer, italian_csv, spanish_csv
from .newcomers_by_hand import BY_HAND, by_hand


@pytest.mark.parametrize("make", [*ALL, *BY_HAND], ids=lambda make: make.__name__)
def test_a_newcomers_export_is_read_at_the_first_try(make: Callable[[Path], Newcomer], tmp_path: Path) -> None:
    museum = make(tmp_path)
    found = guess(museum.where)
    reading = read_items(museum.where, found.mapping)
    assert not [row.message for row in reading.rejected if "a heading, or a sum" not in row.message]
    items = {item.object_number: item for item in reading.items}
    assert set(items) == {one.number for one in museum.things}
    for one in museum.things:
        item = items[one.number]
        # A case that a place names is taken for the case, and nothing of the place is lost.
        told = f"{item.gallery}{item.case}"
        assert re.sub(r"\W", "", one.place) in re.sub(r"\W", "", told)
        assert item.on_display == one.shown
        assert item.object_name == one.name
        assert item.medium == one.medium
        # Decimal numbers of centimetres become the nearest double once: nothing but that is lost.
        for centimetres, metres in ((one.height, item.height_m), (one.width, item.width_m), (one.depth, item.depth_m)):
            assert metres == (None if centimetres is None else pytest.approx(0.01 * centimetres, rel=1e-12))
        if any(other.mass_kg for other in reading.items):
            assert item.mass_kg == (None if one.mass is None else pytest.approx(one.mass, rel=1e-12))
    assert not [problem for item in reading.items for problem in item.problems]


def test_what_a_museum_is_asked_is_little(tmp_path: Path) -> None:
    """At most one thing is to be decided in any of them: number, place, flag and sizes are all in the files."""
    for make in (*ALL, *BY_HAND):
        folder = tmp_path / make.__name__
        folder.mkdir()
        assert len(guess(make(folder).where).questions) <= 1, make.__name__


def test_the_accession_number_is_preferred_and_the_choice_said(tmp_path: Path) -> None:
    museum = italian_csv(tmp_path)
    path = Path(museum.where)
    path.write_bytes(path.read_bytes().replace(b"ID;N. inv", b"Object ID;N. inv", 1))
    found = guess(museum.where)
    assert found.mapping.columns["object_number"].column == "N. inventario"
    (said,) = (doubt for doubt in found.doubts if "object numbers are taken" in doubt)
    assert "from 'N. inventario', and not from 'Object ID'; --choose object_number=COLUMN takes another" in said
    other = guess(museum.where, choices={"object_number": "Object ID"})
    assert other.mapping.columns["object_number"].column == "Object ID"
    assert not [doubt for doubt in other.doubts if "object numbers are taken" in doubt]


def test_cells_that_are_not_quoted_are_said_where_they_stand(tmp_path: Path) -> None:
    museum = spanish_csv(tmp_path)
    path = Path(museum.where)
    path.write_text(path.read_text(encoding="utf-8-sig").replace('"', ""), encoding="utf-8")
    with pytest.raises(Exception, match=r"no row can be used. line 6: 1[0-9] cells, the header has 11.*--choose"):
        guess(path)


def test_what_parts_the_rows_of_a_list_and_sums_them_up_is_no_object(tmp_path: Path) -> None:
    museum = by_hand(tmp_path)
    rejected = read_items(museum.where, guess(museum.where).mapping).rejected
    found = [row.message.partition("'")[2].partition("'")[0] for row in rejected]
    assert found == ["FURNITURE", "KITCHEN", "CLOCKS", "NEEDLEWORK", "TOTAL"]
