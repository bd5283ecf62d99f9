"""Names that the table of rules does not know: what their kin say, and how far it is believed."""

from __future__ import annotations

import pytest

from pipeline.analysis.akin import akin
from pipeline.analysis.classify import classify
from pipeline.analysis.rule_table import rules
from pipeline.records import Item


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        # Compounds that no dictionary of museum terms lists; German, Dutch, Danish, Swedish, Hungarian, Finnish.
        ("Paradehellebarde", "mounted"),
        ("feestdraailier", "mounted"),
        ("søndagslænestol", "seat"),
        ("midsommarlysestake", "lamp"),
        ("vasárnapikancsó", "vessel"),
        ("juhlalautanen", "dish"),
    ],
)
def test_a_compound_is_of_the_class_of_its_head_and_never_sure(name: str, taken: str) -> None:
    _, share = akin(name, rules())
    assert 0.0 < share <= 0.9
    scene = classify(Item("1", "Room", object_name=name))
    assert scene.object_class == taken
    assert scene.chances[0][1] < 0.9


def test_kin_are_believed_as_far_as_the_words_of_the_table_bear_it_out() -> None:
    """Few words in -er are of the class of what is left (a Hungarian szekér is no szék); most in -viool are."""
    _, ending = akin("stoler", rules())
    _, head = akin("marktviool", rules())
    assert 0.0 < ending < 0.5 < head
    assert akin("vase", rules()) == ("", 0.0)
    assert akin("qwzx", rules()) == ("", 0.0)


@pytest.mark.parametrize(
    ("name", "taken"),
    [("cartel d'applique", "relief"), ("cartel d’applique", "relief"), ("ÇAYDANLIK", "vessel"), ("KALKAN", "mounted")],
)
def test_phrases_with_elided_articles_and_turkish_capitals(name: str, taken: str) -> None:
    assert classify(Item("1", "Room", object_name=name)).object_class == taken


@pytest.mark.parametrize("name", ["Tabla", "Stroj", "Mörser"])
def test_a_word_of_two_languages_is_not_sure(name: str) -> None:
    assert classify(Item("1", "Room", object_name=name)).chances[0][1] < 0.75
    # What stands beside it settles it.
    painted = classify(Item("1", "Room", object_name="Tabla", medium="oil on panel", height_m=0.6, width_m=0.4))
    assert (painted.object_class, painted.chances[0][1] > 0.75) == ("framed", True)
