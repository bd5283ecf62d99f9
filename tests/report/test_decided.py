"""What people decided and what changed since the run before, on the pages: counted, listed, escaped."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.records import (
    Cause,
    CauseKind,
    Decision,
    DecisionChange,
    DecisionKind,
    DecisionStatus,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    ObjectPlace,
    RunChanges,
    RunRecord,
    Verdict,
    VerdictChange,
)
from pipeline.report import Units, render
from pipeline.report.pages.since import MOST

from . import builder
from .shown import shown

BAD = builder.HOSTILE["H.1"] + builder.HOSTILE["H.2"]
KIND = DecisionKind


def decision(number: str, kind: DecisionKind = KIND.ACCEPT, **more: object) -> Decision:
    made = Decision(1, number, kind, BAD, "2031-05-01", BAD, "2031-05-01T00:00:00+00:00")
    return replace(made, **more)  # type: ignore[arg-type]


def decided(*standing: DecisionStatus) -> RunRecord:
    return replace(builder.record(), decisions=standing)


def test_what_is_accepted_is_no_task_until_it_is_in_doubt() -> None:
    """The object's state, and with it the four numbers, are those of the computation either way."""
    plain = shown(builder.record(), Units())
    made = DecisionStatus(decision("79.AA.143"))
    accepted = shown(decided(made), Units())
    doubted = shown(decided(replace(made, doubts=("the motion has changed",))), Units())
    for view, listed in ((plain, True), (accepted, False), (doubted, True)):
        assert view.counts == plain.counts
        gallery = next(g for g in view.galleries if g.name == builder.GREEK)
        assert any(o.number == "79.AA.143" for t in gallery.tasks for o in t.objects) is listed
        assert any(o.number == "79.AA.143" for o in view.first) is listed
    assert (accepted.decisions.settled, accepted.decisions.accepted, len(accepted.decisions.doubted)) == (1, 1, 0)
    assert (doubted.decisions.settled, doubted.decisions.accepted, len(doubted.decisions.doubted)) == (0, 1, 1)


@pytest.mark.parametrize(
    ("model", "level", "settled"),
    [("rocking", "", True), ("", "design", True), ("sliding", "", False), ("", "x", False)],
)
def test_only_what_was_accepted_is_settled(model: str, level: str, settled: bool) -> None:
    view = shown(decided(DecisionStatus(decision("79.AA.143", model=model, level=level))), Units())
    assert next(o for g in view.galleries for o in g.objects if o.number == "79.AA.143").settled is settled


def test_hostile_words_of_every_kind_are_text(tmp_path: Path) -> None:
    kinds = (
        decision("79.AA.143", model="rocking", level=BAD, until="2032-01-01"),
        decision("H.1", KIND.INSTALLED, measure="clearance", parameters={"clearance": 0.1}, units={"clearance": "m"},
                 product=BAD),
        decision("73.AA.33", KIND.CLASS, object_class="bust"),
        decision("H.4", KIND.VERDICT, model="rocking", verdict=Verdict.PASS),
        decision(BAD),
    )  # fmt: skip
    standing = tuple(DecisionStatus(d, (BAD,) if i != 1 else ()) for i, d in enumerate(kinds))
    verdict = VerdictChange("H.1", BAD, "rocking", BAD, Verdict.PASS, Verdict.FAIL, (Cause(CauseKind.MOTION, BAD),))
    changes = RunChanges(
        "a", "b", (ObjectPlace(BAD, BAD),), (ObjectPlace(BAD, BAD),), (Move("H.1", BAD, BAD),),
        (InputChange("H.1", BAD, (FieldChange("title", BAD, None), FieldChange("height_m", 0.4, 0.5))),),
        tuple(replace(verdict, object_number=str(n)) for n in range(MOST + 3)),
        (MotionChange(BAD, BAD, BAD, ("x",), None),), (DecisionChange(kinds[1], new=True),),
        (FieldChange("site.folder", BAD, None),), (FieldChange("Kouros", "1", "2"),), "2031-05-01T01:00:00",
    )  # fmt: skip
    folder = render(decided(*standing), tmp_path / "one", changes=changes).parent
    pages = {p.name: p.read_text(encoding="utf-8") for p in folder.glob("*.html")}
    for name, page in pages.items():
        assert page.count("<script") == page.count("script-src 'sha256-"), name  # the page's own, allowed by its hash
        assert "<img" not in page, name
        assert "results hold for the earthquake motion that was used, and for no other" in page, name
        assert "qualified earthquake engineer should be consulted" in page, name
    index = pages["index.html"]
    assert "Since the last run" in index
    assert "And 3 more." in index
    assert "height 40 cm → 50 cm" in index
    assert "4 decisions are to be looked at again" in index
    assert "2 risks accepted, 1 measure installed, 1 verdict overruled, 1 class decided." in index


def test_a_night_without_changes_says_so(tmp_path: Path) -> None:
    index = render(builder.record(), tmp_path / "one", changes=RunChanges("a", "b", started="2031-05-01T01:00:00"))
    assert "Nothing has changed since 2031-05-01 01:00" in index.read_text(encoding="utf-8")
    assert "Since the last run" not in render(builder.record(), tmp_path / "two").read_text(encoding="utf-8")
