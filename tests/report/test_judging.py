"""Fragilities and spacings in the reader's words: bounds, ranges, years, pictures with words, hostile numbers."""

from dataclasses import replace
from math import inf

import pytest
from lxml import etree

from pipeline.analysis.classify import classify
from pipeline.quantities import G
from pipeline.records import Fragility, Furniture, Item, Spacing, Verdict
from pipeline.report.assumed import rule_words
from pipeline.report.pages.judging import fragility_views, shaking_view, spacing_views, years
from pipeline.report.pages.scene_words import furniture
from pipeline.report.units import Units

from . import builder
from .shown import shown

CURVE = Fragility(
    "1", "rocking", "Rocking", 0.3 * G, 0.2 * G, 0.5 * G, "", 0.5, 0.4, True, 0.2, 0.25, 1, False,
    1 / 900.0, 1 / 2000.0, 1 / 500.0, "", "objects on shelves", 0.4 * G,
)  # fmt: skip
PAIR = Spacing("A", "design", "1", "<b>2</b>", 0.05, 0.03, 0.0, 0.04, 0.03, 0.2, Verdict.PASS, "history", "quake")


def of(curve: Fragility, number: str = "1") -> object:
    return replace(builder.rocking(Item(number, "A", "Vase")), fragilities=(curve,))


def test_a_curve_in_words_and_numbers() -> None:
    (view,) = fragility_views(of(CURVE), Units(), drawn=True)  # type: ignore[arg-type]
    assert view.sentence.replace("\u202f", " ") == "fails from about 0.3 g (0.2 g to 0.5 g)"
    assert view.rate == "about once in 900 years (500 to 2,000)"
    assert view.beside.replace("\u202f", " ") == "0.4 g"
    assert "records 0.40 (stated)" in view.sources
    picture = etree.fromstring(str(view.picture))
    # The lognormal at 0.5 g: Phi(ln(5/3) / 0.5) = 0.8465.
    assert "85% at 0.5\u202fg" in picture.findtext("desc")
    assert picture.findtext("title") == "1: Rocking"


def test_a_curve_of_an_upper_floor_says_whose_shaking_it_is_by() -> None:
    one = of(CURVE)
    above = replace(one, scene=replace(one.scene, floor="<b>2nd"))  # type: ignore[attr-defined, type-var]
    (view,) = fragility_views(above, Units(), drawn=True)  # type: ignore[arg-type]
    assert view.sentence.endswith("; in g as felt on the floor <b>2nd")


def test_probabilities_of_the_lognormal() -> None:
    """Truth: Phi of one and two standard deviations, from tables."""
    assert CURVE.probability(0.0) == 0.0
    assert CURVE.probability(CURVE.median) == pytest.approx(0.5)
    assert CURVE.probability(CURVE.median * 2.718281828459045**0.5) == pytest.approx(0.8413447460685429)
    assert CURVE.probability(CURVE.median * 2.718281828459045**-1.0) == pytest.approx(0.022750131948179195)


@pytest.mark.parametrize(
    ("bound", "said"), [("above", "stands up to 0.3\u202fg at least"), ("below", "fails already at 0.3\u202fg or less")]
)
def test_a_bound_is_said_to_be_one(bound: str, said: str) -> None:
    (view,) = fragility_views(of(replace(CURVE, bound=bound)), Units(), drawn=False)  # type: ignore[arg-type]
    assert view.sentence == said
    assert view.picture == ""


@pytest.mark.parametrize(
    ("rate", "said"), [(0.02, "50"), (1 / 1234.0, "1,200"), (0.3, "3.3"), (0.0, "∞"), (inf, "∞"), (1e-7, "10,000,000")]
)
def test_years_have_two_digits(rate: float, said: str) -> None:
    assert years(rate) == said


def test_hostile_object_numbers_stay_text_in_the_picture() -> None:
    hostile = "</title><script>alert(1)</script>"
    (view,) = fragility_views(of(CURVE, hostile), Units(), drawn=True)  # type: ignore[arg-type]
    assert etree.fromstring(str(view.picture)).findtext("title") == f"{hostile}: Rocking"


def test_the_median_of_a_gallery_knows_what_never_fails() -> None:
    members = [of(replace(CURVE, median=m * G, bound=b)) for m, b in ((0.2, ""), (2.1, "above"), (2.1, "above"))]
    view = shaking_view(members)  # type: ignore[arg-type]
    assert view is not None
    said = "Half of the 3 objects that stand free stand at 2.1\u202fg of peak acceleration of their floor at least."
    assert view.sentence == said
    two = shaking_view(members[:1])  # type: ignore[arg-type]
    assert two is not None
    assert two.sentence.startswith(
        "The one object that stands free fails from about 0.2\u202fg of peak acceleration of its floor"
    )
    assert shaking_view([]) is None


def test_a_bound_of_half_a_gallery_is_no_more_than_the_bounds_allow() -> None:
    """Two that stand at 0.5 g at least, one at 2.1 g at least: half stand at 0.5 g, and nobody knows more."""
    members = [of(replace(CURVE, median=m * G, bound="above")) for m in (0.5, 0.5, 2.1)]
    view = shaking_view(members)  # type: ignore[arg-type]
    assert view is not None
    assert "stand at 0.5\u202fg of peak" in view.sentence


def test_what_is_only_bounded_has_no_curve() -> None:
    """Of an object that fails at the least that was tried the probability at half a g is not that of a curve."""
    for bound in ("above", "below"):
        (view,) = fragility_views(of(replace(CURVE, bound=bound)), Units(), drawn=True)  # type: ignore[arg-type]
        assert not view.picture


def test_neighbours_that_may_meet_come_first() -> None:
    worse = replace(PAIR, first="3", verdict=Verdict.FAIL)
    bound = replace(PAIR, first="4", gap=2.0, needed=None, low=None, high=None, radial=None, decided_by="bound")
    views = spacing_views([bound, PAIR, worse], Units())
    assert [v.first for v in views] == ["3", "1", "4"]
    assert [v.state for v in views] == ["act", "safe", "safe"]
    assert views[1].needed.replace("\u202f", " ") == "3 cm (0 to 4 cm)"
    assert (views[1].decided, views[2].decided) == ("both moving together", "bound: the sum of both")
    assert views[2].needed == "–"


def test_each_gallery_has_its_own_neighbours() -> None:
    record = replace(builder.record(), spacings=(replace(PAIR, gallery=builder.PAINT),))
    found = {g.name: len(g.spacings) for g in shown(record, Units()).galleries}
    assert found[builder.PAINT] == 1
    assert sum(found.values()) == 1


def test_what_an_object_stands_in_is_said_with_where_that_is_known_from() -> None:
    """Of a painting nothing that all paintings do; of what a record or a rule says always."""
    vase = Item("1", "G", "Vase", object_name="vase", height_m=0.3, width_m=0.2, depth_m=0.2)
    painting = Item("2", "G", "Landscape", classification="paintings", height_m=1.0, width_m=1.2)
    told = [
        furniture(classify(item))
        for item in (
            vase, replace(vase, furniture=Furniture.SHELF), replace(vase, case="Plinth 1"),
            painting, replace(painting, furniture=Furniture.RAIL),
        )
    ]  # fmt: skip
    assert told == [
        "in a showcase (assumed)", "on a shelf (as recorded)", "on a pedestal or plinth (as its record names a case)",
        "", "from a rail or the ceiling (as recorded)",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("rule", "told"),
    [
        ("slab: it hangs on a wall", "slab: it hangs on a wall"),
        ("slab: it hangs on a wall (width 30)", "slab: it hangs on a wall (width 30)"),
        ("", ""),
    ],
)
def test_why_an_object_is_of_its_class_is_said_once(rule: str, told: str) -> None:
    assert rule_words(rule) == told
