"""Sizes that nobody recorded: as the table of proportions says, and as uncertain as it says."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from math import exp, hypot, log

import numpy as np
import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.footing import bearing_of
from pipeline.analysis.likelihood.draws import Draw, Ranges, value_at
from pipeline.analysis.sizes import SIZES, Sizes
from pipeline.analysis.survey import telling_requests
from pipeline.records import Band, Estimate, Item, Likelihood, Origin, Scene
from pipeline.tables import table
from pipeline.tables.proportion_rows import proportions

VASE = Item("1", "G", title="Covered vase", classification="Ceramics", medium="porcelain", height_m=0.4)
ENDS = ("low", "value", "high")


def ratio(object_class: str, size: str, of: str, above: str = "0") -> tuple[float, ...]:
    rows = table("proportions")
    row = next(r for r in rows if (r["class"], r["size"], r["of"], r["above"]) == (object_class, size, of, above))
    return tuple(float(row[end]) for end in ENDS)


def ends(estimate: Estimate) -> list[float]:
    return [getattr(estimate, end) for end in ENDS]


def joint(one: Sequence[float], other: Sequence[float]) -> list[float]:
    """The range of a product of two that have nothing to do with each other: logarithms add up as squares do."""
    best = one[1] * other[1]
    away = [hypot(log(one[at] / one[1]), log(other[at] / other[1])) for at in (0, 2)]
    return [best * exp(-away[0]), best, best * exp(away[1])]


def class_row(name: str) -> dict[str, str]:
    return dict(next(r for r in table("classes") if r["class"] == name))


def test_a_vase_without_a_width_is_as_wide_as_vases_are() -> None:
    scene = classify(VASE)
    assert (scene.object_class, scene.missing) == ("vessel", ())
    row, bears = class_row("vessel"), bearing_of(VASE, "vessel")
    assert bears is not None
    wide = ratio("vessel", "width", "height", "0.3")
    assert ends(scene.parameters["width"]) == pytest.approx([0.4 * one for one in wide])
    assert scene.parameters["width"].origin is Origin.ASSUMED
    assert any(text.startswith("width not recorded") for text in scene.assumptions)
    shares = [float(row[c]) for c in ("base_low", "base_ratio", "base_high")]
    borne = (bears.low, bears.share, bears.high)
    base = joint([0.5 * one for one in shares], [0.4 * one for one in wide])
    assert ends(scene.parameters["half_width"]) == pytest.approx(joint(base, borne))
    # It is as deep as it is wide: its mass grows with the square.
    known = classify(replace(VASE, width_m=0.4 * wide[1])).parameters["mass"]
    assert ends(scene.parameters["mass"]) == pytest.approx(joint(ends(known), [(one / wide[1]) ** 2 for one in wide]))
    assert scene.parameters["mass"].cause == "half_width"
    assert "depth" not in scene.parameters


def test_a_vase_without_a_height_is_as_high_as_vases_are() -> None:
    scene = classify(replace(VASE, height_m=None, width_m=0.2))
    tall = [0.2 * one for one in ratio("vessel", "height", "width")]
    row = class_row("vessel")
    shares = [float(row[c]) for c in ("cg_low", "cg_ratio", "cg_high")]
    assert ends(scene.parameters["cg_height"]) == pytest.approx(joint(tall, shares))
    assert scene.missing == ()
    # What is measured stays so.
    measured = classify(replace(VASE, height_m=None, width_m=0.2, cg_height_m=0.15))
    assert ends(measured.parameters["cg_height"]) == [0.15] * 3


def test_a_painting_without_a_height_hangs_by_what_paintings_are_high() -> None:
    painting = Item("2", "G", title="Landscape", classification="paintings", medium="oil on canvas", width_m=0.6)
    scene = classify(painting)
    tall = [0.6 * one for one in ratio("framed", "height", "width")]
    assert (scene.object_class, scene.missing) == ("framed", ())
    # Hung from its upper edge half its height above its centre; from half of that on, and on a cord of a metre.
    length = ends(scene.parameters["length"])
    assert length == pytest.approx(joint(tall, [0.25, 0.5, (0.5 * tall[1] + 1.0) / tall[1]]))
    assert ends(scene.parameters["mass"]) == pytest.approx(joint([5.0, 15.0, 40.0], [0.6 * one for one in tall]))


@pytest.mark.parametrize("known", [{}, {"height_m": 0.3}, {"width_m": 0.3}])
def test_of_a_thing_of_no_known_class_one_size_says_nothing(known: dict[str, float]) -> None:
    scene = classify(Item("3", "G", title="Thing", **known))  # type: ignore[arg-type]
    assert scene.object_class == "object"
    assert scene.missing
    assert not {*SIZES} & {*scene.parameters}


def test_a_recorded_size_is_never_assumed() -> None:
    whole = classify(replace(VASE, width_m=0.2, depth_m=0.2))
    assert not {*SIZES} & {*whole.parameters}
    assert not any(one.cause for one in whole.parameters.values())


def test_numbers_of_one_cause_are_high_together() -> None:
    """By the inverse of the distribution, at the share that the cause drew."""
    scene = classify(VASE)
    half, mass = scene.parameters["half_width"], scene.parameters["mass"]
    other = replace(mass, cause="")
    ranges = Ranges.of("mass", [mass, other], np.nan)
    both = np.array([0, 1])
    for number in range(8):
        draw = Draw(number, 8)
        drawn = ranges.at(draw, both).tolist()
        assert drawn[0] == pytest.approx(value_at(draw.share("half_width"), *np.take(ends(mass), (0, 1, 2))))
        assert drawn[1] == pytest.approx(value_at(draw.share("mass"), *np.take(ends(mass), (0, 1, 2))))
    assert half.low < half.high


def test_a_size_that_nobody_recorded_is_asked_for_in_place_of_what_hangs_on_it() -> None:
    def asked(scene: Scene, parameter: str) -> list[str]:
        chance = Likelihood("design", 0.3, 0.02, 512, Band.POSSIBLE, "falls", {}, parameter, 0.01, 0.4)
        return [one.field for one in telling_requests([scene], [(chance,)])]

    assert asked(classify(VASE), "half_width") == ["width_m"]
    assert asked(classify(replace(VASE, height_m=None, width_m=0.2)), "cg_height") == ["height_m"]
    (request,) = telling_requests(
        [classify(VASE)], [(Likelihood("d", 0.3, 0.02, 512, Band.POSSIBLE, "", {}, "half_width", 0.01, 0.4),)]
    )
    assert [request.low, request.best, request.high] == pytest.approx(ends(classify(VASE).parameters["width"]))
    # Of what is recorded the footing is asked for, as before.
    assert asked(classify(replace(VASE, width_m=0.2)), "half_width") == ["tilt_angle_deg"]


def test_what_is_tall_is_more_slender_than_what_is_small() -> None:
    for item in (VASE, Item("2", "G", object_name="Longcase clock"), Item("3", "G", object_name="Cabinet")):
        small, tall = (classify(replace(item, height_m=high)).parameters["width"] for high in (0.2, 1.8))
        assert tall.value / 1.8 < 0.7 * small.value / 0.2, item.object_name
        assert small.low < small.value < small.high


def test_every_class_that_is_modelled_has_proportions_of_every_pair() -> None:
    for row in table("classes"):
        of = {(size, one.of) for (name, size), some in proportions().items() if name == row["class"] for one in some}
        if row["models"] == "none":
            assert not of
            continue
        pairs = {(a, b) for a in SIZES for b in SIZES if a != b}
        # What is round is as deep as it is wide.
        assert of == {pair for pair in pairs if row["round"] == "no" or "height" in pair}


def test_few_records_are_told_as_judgement() -> None:
    for row in table("proportions"):
        count = int(row["source"].rpartition(" records")[0].rpartition(" ")[2])
        assert count >= 20 or row["source"].startswith("judgement"), row


def test_what_is_assumed_is_in_one_order_however_it_is_named() -> None:
    """A set of names is in another order in each process, and the notes of a page changed their numbers with it."""
    sizes = Sizes(VASE, {name: Estimate(0.1, 0.05, 0.2, "m", Origin.ASSUMED) for name in SIZES})
    assert {tuple(sizes.used(names)) for names in permutations(SIZES)} == {SIZES}
