"""An index of words finds what looking at every line finds, in its order."""

from __future__ import annotations

import random

import pytest

from pipeline.desk.run_facts import WordIndex, folded

LINES = [
    "1922.9 amphora east", "1922.90 amphora lid east", "2016.7 vase west", "a.7 vase and lid", "no title", "10.7.1",
    "花瓶 vase", "vase vase vase", "",
]  # fmt: skip


@pytest.mark.parametrize(
    ("parts", "there"),
    [
        (["1922.9"], [0, 1]),
        (["vase"], [2, 3, 6, 7]),
        (["lid", "vas"], [3]),
        ([".7"], [2, 3, 5]),
        (["瓶"], [6]),
        (["amphora", "east", "0"], [1]),
        (["amphorae"], []),
    ],
)
def test_all_parts_are_in_the_words_of_a_line(parts: list[str], there: list[int]) -> None:
    assert list(WordIndex(LINES).having(parts)) == there


@pytest.mark.parametrize("few", [0, 3, 400])
def test_it_finds_what_a_look_at_every_line_finds(few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether the words with a part are few or many."""
    monkeypatch.setattr("pipeline.desk.run_facts._FEW", few)
    draw = random.Random(20_261_127)
    letters = "abé19.花\U0001f3fa-"
    lines = [
        folded(" ".join("".join(draw.choices(letters, k=draw.randint(1, 5))) for _ in range(draw.randint(0, 5))))
        for _ in range(300)
    ]
    index = WordIndex(lines)
    for _ in range(300):
        parts = folded(" ".join("".join(draw.choices(letters, k=draw.randint(1, 2))) for _ in range(2))).split()
        wanted = [at for at, line in enumerate(lines) if all(part in line for part in parts)]
        assert list(index.having(parts)) == wanted


def test_nothing_is_found_in_nothing() -> None:
    assert list(WordIndex([]).having(["a"])) == []
