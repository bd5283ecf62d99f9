"""News of objects in words: every kind and every measure has its own, whatever the museum's texts are, however many."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from pipeline.operations.hooks import SUBJECTS
from pipeline.operations.run_summary import json_ready, plain_changes
from pipeline.records import (
    Brief,
    Decision,
    DecisionKind,
    NewsKind,
    ObjectChange,
    Ruled,
    RunChanges,
    Settled,
    State,
    Verdict,
)
from pipeline.report import render
from pipeline.report.pages.news import KEPT, ON_A_PAGE, kept_view, news_line, news_view, sentences
from pipeline.report.pages.news_words import to_do
from pipeline.tables import table

from . import builder
from .news_samples import ACT, FINE, UNKNOWN, WATCH, news_of_every_kind

BAD = "<script>alert(1)</script>\x1b[2J\u202e{{7*7}} %(x)s\n\u0000"


def changes(*objects: ObjectChange, **more: object) -> RunChanges:
    return RunChanges("a", "b", started="2031-05-01T01:00:00+00:00", objects=objects, **more)  # type: ignore[arg-type]


def test_the_words_that_a_curator_reads() -> None:
    """As the museum asked for them."""
    clamped = ObjectChange(
        "1922.9", "amphora", "Gallery 19", ACT, FINE, decided=(Settled(True, "clamps", "installed clamps", "Ann"),)
    )
    vase = ObjectChange("2026.1", "vase", "Gallery 2", None, ACT)
    assert [news_line(one).sentence for one in (clamped, vase)] == [
        "Fixed: 1922.9 amphora (clamped).",
        "New and in danger: 2026.1 vase: fasten it.",
    ]
    assert SUBJECTS["changed"] == "what changed"
    accepted = ObjectChange("1", "t", "g", ACT, ACT, decided=(Settled(True, "", "risk accepted", "A.B."),))
    assert news_line(accepted).sentence == "Decided: 1 t: risk accepted, by A.B."


def test_a_measure_that_is_in_place_and_not_enough_is_said_to_be() -> None:
    surer = replace(ACT, band="almost certain")
    for measure, told in (("fasten", "that is not enough: fasten it"), ("clamps", "fasten it")):
        made = Settled(True, measure, "", "Ann")
        one = ObjectChange("1", "t", "g", surer, ACT, decided=(made,))
        assert one.kind is NewsKind.STILL
        assert news_line(one).text.endswith(f"harm was almost certain, and is likely: {told}")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"kind": DecisionKind.ACCEPT, "until": "2032-01-01"}, "risk accepted until 2032-01-01, by Ann"),
        ({"kind": DecisionKind.ACCEPT, "model": "rocking"}, "risk accepted (rocking), by Ann"),
        ({"kind": DecisionKind.CLASS, "object_class": "vessel"}, "named: Vessel, by Ann"),
        ({"kind": DecisionKind.VERDICT, "verdict": Verdict.PASS, "level": "a"}, "verdict pass (level a), by Ann"),
    ],
)
def test_a_decision_is_told_in_the_words_of_who_decides(more: dict[str, Any], said: str) -> None:
    made = Decision(1, "1", who="Ann", date="2031-05-01", why="w", recorded="", **more)
    change = ObjectChange("1", "t", "g", FINE, FINE, decided=(Settled.of(made, new=True),))
    assert news_line(change).text.startswith(f": {said}")


def test_every_measure_of_the_table_has_words_of_its_own() -> None:
    done = {}
    for row in table("measures"):
        asked = to_do(Brief(State.ACT, "", row["measure"], "TITLE"))
        assert "TITLE" not in asked, row["measure"]
        settled = Settled(True, row["measure"], "", "Ann")
        done[row["measure"]] = news_line(ObjectChange("1", "t", "g", ACT, FINE, decided=(settled,))).text
        assert asked[0].islower()
    assert len(set(done.values())) == len(done)
    # One of the museum's own table is told by its title, and by its name.
    assert to_do(Brief(State.ACT, "", "our_net", "Our own net")) == "Our own net"
    settled = Settled(True, "our_net", "", "Ann")
    assert news_line(ObjectChange("1", "t", "g", ACT, FINE, decided=(settled,))).text == " (our net)"


def test_kinds_of_all_turns_of_a_state() -> None:
    """By hand: what is acted on is worse than what is watched, and that than what is fine."""
    size = {State.FINE: 0, State.WATCH: 1, State.ACT: 2}
    for was, now in product((FINE, WATCH, ACT), repeat=2):
        kind = ObjectChange("1", "", "", was, now).kind
        step = size[now.state or State.FINE] - size[was.state or State.FINE]
        fixed = was is ACT and now is FINE
        expected = NewsKind.FIXED if fixed else NewsKind.WORSE if step > 0 else NewsKind.BETTER if step < 0 else None
        assert kind is expected, (was, now)
    for now, kind in ((ACT, NewsKind.WORSE), (WATCH, NewsKind.BETTER), (FINE, NewsKind.BETTER), (UNKNOWN, None)):
        assert ObjectChange("1", "", "", UNKNOWN, now).kind is kind
        assert ObjectChange("1", "", "", now, UNKNOWN).kind is (None if now is UNKNOWN else NewsKind.LOST)
    likelier = replace(ACT, band="almost certain")
    assert ObjectChange("1", "", "", ACT, likelier).kind is NewsKind.WORSE
    assert ObjectChange("1", "", "", likelier, ACT).kind is NewsKind.BETTER
    # What a proof says is fine is fine whatever word its probability has.
    assert ObjectChange("1", "", "", FINE, replace(FINE, band="unlikely")).kind is None


def test_hostile_texts_stay_texts(tmp_path: Path) -> None:
    objects = tuple(replace(one, object_number=f"{at}{BAD}") for at, one in enumerate(news_of_every_kind(BAD)))
    folder = render(builder.record(), tmp_path / "one", changes=changes(*objects, shared={"worse": 3})).parent
    for name in ("index.html", "news.html"):
        page = (folder / name).read_text(encoding="utf-8")
        assert "<script>alert" not in page
        assert "\x1b" not in page
        assert "{{7*7}}" in page
    for sentence in sentences(changes(*objects), 1000):
        assert not set(sentence) & {"\x1b", "\u202e", "\n", "\u0000"}
        assert len(sentence) < 1000


def test_a_thousand_pieces_of_news_are_on_pages(tmp_path: Path) -> None:
    many = ON_A_PAGE * 2 + 1
    objects = tuple(ObjectChange(f"n{at:05d}", "t", "g", None, ACT) for at in range(many))
    index = render(builder.record(), tmp_path / "one", changes=changes(*objects))
    files = [index.with_name(name) for name in ("news.html", "news-2.html", "news-3.html")]
    found = [re.findall(r"<bdi>(n\d{5})</bdi>", file.read_text(encoding="utf-8")) for file in files]
    assert [len(numbers) for numbers in found] == [ON_A_PAGE, ON_A_PAGE, 1]
    assert [number for numbers in found for number in numbers] == [one.object_number for one in objects]
    assert not index.with_name("news-4.html").exists()
    for file in files:
        assert all(f'href="{other.name}"' in file.read_text("utf-8") for other in files if other != file)
    page = index.read_text(encoding="utf-8")
    assert page.count('<li class="danger">') == 8
    assert f"All {many:,} objects with news" in page
    assert sentences(changes(*objects), 5)[-1] == f"And {many - 5:,} more objects."


def test_what_is_the_same_of_many_is_said_once_and_what_is_acted_on_one_by_one() -> None:
    """Seven works that one house rule made fine, a decision behind them, and three that overturn now."""
    rule = Ruled(True, "A.B.", "2031-05-12", ("framed",), ("Gallery 19",), {"hanging": "two_hooks"})
    ruled = [ObjectChange(f"7.{n}", f"Sea {n}", "Gallery 19", WATCH, FINE, ruled=(rule,)) for n in range(7)]
    decided = ObjectChange(
        "8", "Bust", "East", ACT, ACT, decided=(Settled(True, "", "risk accepted", "A.B.", kind="accept"),)
    )
    worse = [ObjectChange(f"9.{n}", "Vase", "East", WATCH, ACT) for n in range(3)]
    told = changes(*worse, *ruled, decided)
    heads = [(len(group.lines), group.first.kind) for group in news_view(told, {}).brief]
    assert heads == [(1, NewsKind.WORSE)] * 3 + [(7, NewsKind.BETTER), (1, NewsKind.DECIDED)]
    said = sentences(told)
    assert len(said) == 5
    assert said[3].startswith("Better: 7.0 Sea 0, 7.1 Sea 1, 7.2 Sea 2, 7.3 Sea 3, 7.4 Sea 4 and 2 more: was to be")
    assert said[3].count("A.B.") == 1


def test_what_a_status_keeps_is_told_as_on_the_night() -> None:
    told = changes(*news_of_every_kind("x"), shared={"worse": 3, "fixed": 1})
    rows = json_ready(plain_changes(told)["objects"])
    kept = {"since": told.started, "counts": dict(Counter(row["kind"] for row in rows)), "because": [], "objects": rows,
            "shared": told.shared}  # fmt: skip
    view, whole = kept_view(kept), news_view(told, {})
    assert view.lines == whole.lines[:KEPT]
    assert view.brief == whole.brief
    assert (view.total, view.shared, view.before) == (whole.total, whole.shared, whole.before)
    assert [row["text"] for row in rows] == [line.sentence for line in whole.lines]


@pytest.mark.parametrize("damage", ["counts", "objects", "shared", "because"])
def test_what_was_damaged_in_a_status_is_refused(damage: str) -> None:
    row = asdict(ObjectChange("1", "t", "g", None, ACT))
    kept = {"since": "", "counts": {}, "because": [], "objects": [row], "shared": {}}
    assert kept_view(kept).lines[0].number == "1"
    for value in ("x", 7, [{}], {"nonsense": 1}, None):
        with pytest.raises((KeyError, TypeError, ValueError, AttributeError)):
            kept_view(kept | {damage: value})
