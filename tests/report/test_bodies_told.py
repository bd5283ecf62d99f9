"""What a page says that an object is taken for: the body that its numbers are assumed of, and else its class."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pipeline.analysis.classify import classify
from pipeline.records import Item
from pipeline.report.language import language, speaking
from pipeline.report.pages.scene_words import what_it_is
from pipeline.tables.body_rows import body_rows, body_told

POST = Item("1", "G", "House post with bear", object_name="totem pole", medium="cedar wood", height_m=4.2, width_m=0.7,
            depth_m=0.6, displayed="freestanding against wall")  # fmt: skip
VASE = Item("2", "G", "Vase", object_name="vase", medium="glass", height_m=0.3, width_m=0.1, depth_m=0.1)


def told(item: Item) -> str:
    scene = classify(item)
    return what_it_is((scene.object_class, body_told(one.note for one in scene.parameters.values())))


def test_a_post_of_cedar_is_no_figure_in_stone() -> None:
    assert classify(POST).object_class == "standing_figure"
    assert told(POST) == "a pole or post"
    assert told(replace(POST, object_name="state coach", title="Gala coach")) == "a carriage on its wheels"
    assert told(VASE) == "vessel"


def test_nothing_that_hangs_is_told_to_stand() -> None:
    hung = replace(POST, object_name="kayak", title="Kayak", displayed="suspended from the ceiling")
    assert told(replace(hung, displayed="on trestles")) == "a boat on a cradle or trestles"
    assert told(hung) == "other object"


@pytest.mark.parametrize("code", ["el", "es", "it", "ja"])
def test_bodies_are_told_in_the_readers_language(code: str) -> None:
    with speaking(language(code, None)):
        assert told(POST) != "a pole or post"
        for row in body_rows():
            note = f"base width: 0.8 of its width, assumed for: {row.title.lower()}; not recorded"
            assert body_told([note]) == row.title.lower()
            assert what_it_is(("vessel", body_told([note]))) != row.title.lower()
