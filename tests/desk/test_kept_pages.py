"""Pages that are kept: only while nothing changed, no more than fit, and each browser with a token of its own."""

from __future__ import annotations

from pipeline.desk.site import KeptPages

from .visiting import Visitor


def test_a_page_is_of_one_state_of_the_museum() -> None:
    kept = KeptPages(most=100)
    kept.keep(1, "/", "before")
    assert kept.get(1, "/") == "before"
    assert kept.get(2, "/") is None
    kept.keep(2, "/", "after")
    # A page that began before the change and ended after it is not shown to those who come after.
    kept.keep(1, "/", "late")
    assert kept.get(2, "/") is None


def test_what_was_asked_for_longest_ago_goes_first() -> None:
    kept = KeptPages(most=10)
    kept.keep(1, "a", "aaaa")
    kept.keep(1, "b", "bbbb")
    assert kept.get(1, "a") == "aaaa"
    kept.keep(1, "c", "cccc")
    assert [kept.get(1, key) for key in "abc"] == ["aaaa", None, "cccc"]
    kept.keep(1, "d", "d" * 11)
    assert [kept.get(1, key) for key in "acd"] == [None, None, None]


def test_a_kept_page_has_the_token_of_its_browser_and_what_was_said_since(visitor: Visitor) -> None:
    other = Visitor(visitor.address)
    first, second = visitor.object("1.1"), other.object("1.1")
    tokens = {got.hidden("/object/decide", "token") for got in (first, second)}
    assert len(tokens) == 2
    assert first.text.replace(first.hidden("/object/decide", "token"), "") == second.text.replace(
        second.hidden("/object/decide", "token"), ""
    )
    visitor.follow(visitor.said_of("1.1", "/object/decide", first, kind="accept", why="bolted in 1998"))
    assert "bolted in 1998" in other.object("1.1").text
