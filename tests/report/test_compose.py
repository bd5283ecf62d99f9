"""Ranking and counting: the builder's record is known by construction, so every count can be derived by hand."""

from dataclasses import replace

import pytest

from pipeline.records import Assessment, Item, Mark, Move, ObjectPlace, RunChanges
from pipeline.report import ReportError, Units
from pipeline.report.pages.since import since_view
from pipeline.report.pages.tallies import urgency
from pipeline.report.pages.views import State, StateCounts
from pipeline.report.text import cased, count, short, slug, words

from . import builder
from .shown import shown


def test_the_four_counts_add_up_to_all_objects() -> None:
    record = builder.record()
    museum = shown(record, Units())
    # 4 + 1 fail among the antiquities, 2 + 5 in the salon; one open; one unknown; 1 + 4 pass.  In store: 1 and 1.
    assert museum.counts == StateCounts(act=12, watch=1, unknown=1, fine=5)
    assert museum.museum.stores is not None
    assert museum.museum.stores.counts == StateCounts(act=1, fine=1)
    assert museum.counts.total + museum.museum.stores.counts.total == len(record.assessments)
    assert sum(g.counts.total for g in museum.galleries) == len(record.assessments)
    listed = [o.number for g in museum.galleries for o in g.objects]
    assert len(listed) == len(set(listed)) == len(record.assessments)


def test_urgency_overturning_and_breaking_then_value_class_then_utilisation_then_watch_unknown_fine() -> None:
    museum = shown(builder.record(), Units())
    gallery = next(g for g in museum.galleries if g.name == builder.GREEK)
    assert [o.number for o in gallery.objects] == [
        "79.AA.143",  # overturns at 1.82, class A
        "85.AA.40",  # breaks at 1.63, class A
        "82.AB.7",  # overturns at 1.82, without a class
        "83.AC.10",  # rocks at 2.6: more, but it stays up
        "70.AA.2",
        "73.AA.33",
        "96.AC.77",
        "71.AB.9",
    ]
    assert [o.state for o in gallery.objects][-3:] == [State.WATCH, State.UNKNOWN, State.FINE]


@pytest.mark.parametrize("value", [None, float("nan"), float("inf")])
def test_a_failure_of_unknown_size_never_sinks(value: float | None) -> None:
    known = builder.rocking(Item("a", "g"), 9.0, "rocks")
    finding = replace(known.findings[0], utilisation=value)
    assert urgency(replace(known, findings=(finding,))) < urgency(known)


def test_an_object_with_a_missing_field_is_never_safe_and_its_failure_still_counts() -> None:
    missing = ("base_width_m",)
    passed = builder.passing(Item("p", "g"))
    failed = builder.rocking(Item("f", "g"))
    record = replace(
        builder.record(),
        assessments=tuple(replace(a, scene=replace(a.scene, missing=missing)) for a in (passed, failed)),
    )
    states = {o.number: o.state for o in shown(record, Units()).galleries[0].objects}
    assert states == {"p": State.UNKNOWN, "f": State.ACT}


def test_what_to_do_first_counts_objects_by_measure_and_tells_each_its_numbers() -> None:
    items = [Item(str(i), "g") for i in range(3)]
    wide = [builder.sliding(i) for i in items]
    advice = tuple(
        replace(a, recommendations=(replace(a.recommendations[0], parameters={"clearance_m": 0.10 + 0.02 * n}),))
        for n, a in enumerate(wide)
    )
    (task,) = shown(replace(builder.record(), assessments=advice), Units()).galleries[0].tasks
    assert len(task.objects) == 3
    # Each of them its own, and no range over all.
    assert [o.number for o in task.objects] == ["0", "1", "2"]
    assert task.sets == tuple(f"clearance {n}\u202fcm" for n in (10, 12, 14))


def test_an_object_that_no_measure_helps_is_named_at_its_place() -> None:
    museum = shown(builder.record(), Units())
    salon = next(g for g in museum.galleries if g.name == builder.PAINT)
    assert not salon.tasks[0].advised
    assert [o.number for o in salon.tasks[0].objects] == ["91.DA.4"]


def test_objects_not_on_display_have_one_page_whatever_their_gallery() -> None:
    (stored,) = [g for g in shown(builder.record(), Units()).galleries if not g.on_display]
    assert stored.page.file == "not-on-display.html"
    assert {o.number for o in stored.objects} == {"64.ST.1", "64.ST.2"}


def _broken(**finding: object) -> Assessment:
    whole = builder.rocking(Item("12.3", "g"))
    return replace(whole, findings=(replace(whole.findings[0], **finding),))  # type: ignore[arg-type]


@pytest.mark.parametrize("values", [{"sentence": "{speed}"}, {"mark": Mark("no such chart", 1.0, 1.0)}])
def test_what_cannot_be_shown_is_refused_by_object(values: dict[str, object]) -> None:
    with pytest.raises(ReportError, match=r"12\.3"):
        shown(builder.record(_broken(**values)), Units())


def test_a_parameter_without_a_unit_is_refused() -> None:
    whole = builder.sliding(Item("12.3", "g"))
    bare = replace(whole, recommendations=(replace(whole.recommendations[0], units={}),))
    with pytest.raises(ReportError, match="clearance_m"):
        shown(builder.record(bare), Units())


@pytest.mark.parametrize(
    "name", ["Salon <b>", "../../etc/passwd", "", "ギャラリー", "a" * 400, "CON", "x/y\\z:*?", "\ud800"]
)
def test_file_names_are_plain_short_and_tell_twins_apart(name: str) -> None:
    stem = slug(name)
    assert set(stem) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")
    assert len(stem) <= 69
    assert slug(name + " ") != stem


def test_counts_have_a_separator() -> None:
    assert [count(n) for n in (0, 999, 1000, 12345, 2_000_000)] == ["0", "999", "1,000", "12,345", "2,000,000"]


def test_plain_words() -> None:
    assert words("base_width_m") == "base width"
    assert words("cg_height_m") == "height of the centre of gravity"
    assert short("one two three", 9) == "one two…"
    assert len(short("x" * 500, 80)) == 80


def test_one_measure_for_two_levels_is_said_once_with_the_evidence_of_each() -> None:
    """The same advice at both levels is one block; another parameter at one of them would be another measure."""
    whole = builder.rocking(Item("1", "g"))
    (first,) = whole.recommendations
    rare = replace(first, level="rare", checks=(replace(first.checks[0], demand=4.0e6),))
    findings = (*whole.findings, replace(whole.findings[0], level="rare"))
    both = replace(whole, findings=findings, recommendations=(first, rare))
    (gallery,) = shown(replace(builder.record(), assessments=(both,)), Units()).galleries
    (measure,) = gallery.objects[0].measures
    assert measure.level == "design, rare"
    assert [check.title for check in measure.checks] == ["Stress at the base (design)", "Stress at the base (rare)"]
    assert [check.title for check in measure.ended] == ["Rocking (design)", "Rocking (rare)"]
    other = replace(both, recommendations=(first, replace(rare, parameters={"force": 641.0})))
    (gallery,) = shown(replace(builder.record(), assessments=(other,)), Units()).galleries
    assert [m.level for m in gallery.objects[0].measures] == ["design", "rare"]


def test_a_range_is_told_only_where_there_is_one() -> None:
    """Nothing uncertain: no bracket about a range that is none; what the sentence says is not said again."""
    whole = builder.rocking(Item("1", "g"))
    told = "It is pushed {demand} ({low} to {high}) times what lifts it."
    for low, sentence in ((1.6, "It is pushed 1.8 (1.6 to 1.8) times what lifts it."), (1.8, "It is pushed 1.8 times")):
        finding = replace(whole.findings[0], sentence=told, demand=1.8, low=low, high=1.8, utilisation=1.8)
        one = replace(whole, findings=(finding,))
        (gallery,) = shown(replace(builder.record(), assessments=(one,)), Units()).galleries
        (view,) = gallery.objects[0].findings
        assert view.sentence.startswith(sentence)
        assert "Demand" not in view.numbers
        assert view.numbers.startswith("Decided by ")


def test_a_gallery_without_a_name_is_said_to_have_none() -> None:
    """What is gone, or moved into no gallery, is no sentence with a hole in it."""
    changes = RunChanges(
        "1", "2", (), (ObjectPlace("2", ""),), (Move("3", "", "East"), Move("4", "East", "")),
        (), (), (), (), (), (), "2031-05-01T01:00:00",
    )  # fmt: skip
    lines = {line.number: line.text for _, lines, _ in since_view(changes, {}, Units()).lists for line in lines}
    assert lines == {
        "2": "no gallery recorded",
        "3": "no gallery recorded → East",
        "4": "East → no gallery recorded",
    }


@pytest.mark.parametrize(
    ("case", "called"),
    [("3", "case 3"), ("IV", "case IV"), ("case 15", "case 15"), ("vitrine 3", "vitrine 3")],
)
def test_a_case_is_called_so_once(case: str, called: str) -> None:
    assert cased(case) == called
