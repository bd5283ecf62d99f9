"""The parser and the choice on single texts: what is judged, what is left out, what cannot be read."""

from fractions import Fraction

import pytest

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.dimensions.lexicon import meanings, unit_words, units
from pipeline.quantities import LENGTHS, MASSES
from pipeline.tables import table


def found(text, **how):
    return [(p.name, p.dimension, p.value) for p in parse(text, **how).parts]


def test_units_are_those_of_the_rest_of_the_program():
    for name, value in (LENGTHS | MASSES).items():
        unit = units()[name]
        assert Fraction(unit.num, unit.den) == Fraction(repr(value)), name


def test_no_word_means_two_things_behind_a_number():
    """A word may be a unit behind a number and a label or a foot before it; these are the ones, and no more."""
    assert {word for word in unit_words() if word in meanings()} == {
        "in", "t", "dm", "fuß", "pied", "pie", "piede", "foot", "feet"
    }  # fmt: skip


@pytest.mark.parametrize("name", ["dimension_units", "dimension_words"])
def test_no_word_is_listed_twice(name):
    words = [word for row in table(name) for word in row["words"].split("|")]
    assert sorted(words) == sorted(set(words))


@pytest.mark.parametrize(
    ("text", "kind", "values", "says"),
    [
        ('11 1/4 x 8 7/8" (63 lb., 22.5 cm)', "contradiction", [0.28575, 0.225425, 28.57631931], "a mass in brackets"),
        ("63 lb (22.5 cm)", "ambiguous", [28.57631931, 0.225], "no conversion"),
        ("8 1/2 in. (21.6 in)", "contradiction", [0.2159], "second has the wrong unit"),
        ('10 x 9" (2.54 x 22.9 cm)', "contradiction", [0.254, 0.2286], "decimal mark in the wrong place"),
        ("8' (20.3 cm)", "contradiction", [0.203], "feet and inches are confused"),
        ('881/2" (224.8 cm)', "contradiction", [2.2479], "blank that is missing"),
        ('9 1/4 x 7 1/4" (18.4 x 23.5 cm)', "contradiction", [0.23495, 0.18415], "in another order"),
        ('7" (30 cm)', "contradiction", [0.1778], "the first is believed"),
        ("3000 m (30 cm)", "contradiction", [0.3], "no museum object's size"),
        ("3 oz. (93.2 g)", "unit", [0.0933104304], "troy"),
        ("9' 10\" (25 cm)", "contradiction", [2.9972], "the first is believed"),
        ("8 x 12 (20.3 x 25.4 cm)", "contradiction", [0.2032, 0.3048], "the first is believed"),
        ("8 x 10 (20.3 x 25.4 cm)", "unit", [0.2032, 0.254], "in agrees"),
        (
            '12 5/8 x 18 1/8" (32 x 46 x 6 cm)',
            "conversion",
            [0.320675, 0.460375, 0.06],
            "stands only in the conversion",
        ),
    ],
)
def test_two_readings_are_judged(text, kind, values, says):
    d = parse(text)
    assert [p.value for p in d.parts] == pytest.approx(values, rel=1e-12)
    assert any(says in note.message for note in d.having(kind)), d.notes


def test_readings_within_three_millimetres_or_three_percent_do_not_contradict():
    assert not parse('1/4" (0.8 cm)').having("contradiction")
    assert not parse('100" (250 cm)').having("contradiction")
    assert parse('4" (10.6 cm)').having("contradiction")


@pytest.mark.parametrize(
    "text", ["25 minutes", "7 hrs., 30 min.", "Duration: 4:30 min.", "Scale 1:200", "08/22/72", "100 sq. ft.", "350 MB"]
)
def test_what_is_no_dimension_is_left_out(text):
    d = parse(text)
    assert not d.parts
    assert d.having("left_out")


def test_the_unread_and_the_varying_are_noted():
    assert parse("see child records").having("remainder")
    assert parse("Dimensions variable").having("variable")
    assert parse("10 x 12").having("missing_unit")
    assert [p.value for p in parse("10 x 12").parts] == [None, None]


def test_a_default_unit_is_used_and_said():
    d = parse("10 x 12", default_unit="cm")
    assert [p.value for p in d.parts] == [0.1, 0.12]
    assert d.having("unit")
    assert found("25", default_unit="mm") == [("overall", "unlabelled", 0.025)]


def test_wrong_options_are_refused():
    with pytest.raises(ValueError, match="default_unit must be one of in, ft"):
        parse("1", default_unit="cubits")
    with pytest.raises(ValueError, match="decimal must be"):
        parse("1", decimal=";")


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("sheet: 10 x 12 in.; frame: 14 x 16 in.", ["sheet", "sheet", "frame", "frame"]),
        ("Overall: 5 cm\nRim: 3 cm", ["overall", "rim"]),
        ('30" (76 cm) high, at base 5 x 5" (12.7 x 12.7 cm)', ["overall", "base", "base"]),
        (".1 (fork): 20 cm; .2-.4 (spoons, each): 18 cm", ["1 fork", "2-4 spoons"]),
        ("10 x 12 cm including painted wood frame", ["framed", "framed"]),
        ("28 x 26 cm on wooden base", ["with base", "with base"]),
        ("Diam. at rim 5 cm; .b (lid): 3 cm", ["rim", "b lid"]),
        ("Base: 9 cm high\nWeight: 3 kg", ["base", "overall"]),
    ],
)
def test_parts_are_named(text, names):
    assert [p.name for p in parse(text).parts] == names


def test_a_dot_behind_an_abbreviation_is_no_decimal_mark():
    assert found("h. 11 cm, diam.17 cm") == [("overall", "height", 0.11), ("overall", "diameter", 0.17)]
    assert found(".5 cm") == [("overall", "unlabelled", 0.005)]


def test_qualifiers_are_kept():
    (part,) = parse("page (each, approx., irreg.): 10 cm").parts
    assert part.qualifiers == ("approximate", "each", "irregular")
    assert [p.qualifiers for p in parse('8 x 5" (20.3 x 12.7 cm) (irreg.)').parts] == [("irregular",)] * 2


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("3 oz. 2 dwt.", 0.0964207781),
        ("5 lb. 3 oz.", 2.353010419375),
        ("1.5 troy oz", 0.0466552152),
        ("Gewicht 2 t", 2000.0),
        ("2 tons", 1814.36948),
    ],
)
def test_masses(text, values):
    """Truth: 1959 pound, 480-grain ounce, 2,000-pound ton: exact by definition."""
    (part,) = parse(text).parts
    assert part.dimension == "weight"
    assert part.value == pytest.approx(values, rel=1e-9)


HOSTILE = [
    "x", "1", "1 ", "1x", "(", "1(", "1 in(", '1"(1")x', "1 in (1 cm) x ", "a,", "1 in, a, ", "H.", "1/", "1 - 1 ",
    ".1", "1½", "(h x w)", "1 in (irreg)", "\n", "\x00", "1'1\"", "1 lb 1 oz ", "various dimensions. ", "1:1 ", "٣",
    "(1 x 1 x ", "1 1/2 1/2", " ", "9", "1,1", "\ud800",
]  # fmt: skip


@pytest.mark.parametrize("piece", HOSTILE)
def test_hostile_texts_are_read_to_the_end(piece):
    """2,000 characters of whatever makes a pattern or a look ahead go back: it finishes, and nothing is infinite."""
    for text in (piece * (2000 // len(piece)), "1 in " + piece * 2000):
        d = parse(text)
        choose(d)
        assert all(p.value is None or 0.0 <= p.value < 1e24 for p in d.parts)


def test_a_million_characters_cost_no_more_than_two_thousand():
    d = parse("x" * 10**6)
    assert not d.parts
    assert d.having("truncated")


@pytest.mark.parametrize(
    "text", ["9" * 3000 + " cm", "1e400 in", "1" * 25 + " km", "1/0 in", "1 0/0 in", "10,12,14 cm"]
)
def test_numbers_that_measure_nothing_are_not_guessed(text):
    d = parse(text)
    assert not d.parts
    assert d.having("remainder")


def test_digits_of_other_scripts_count():
    assert found("٣ cm") == [("overall", "unlabelled", 0.03)]
    assert found("高さ１０cm") == [("overall", "height", 0.1)]


def test_the_whole_object_goes_before_its_parts():
    text = "Bowl: H. 5 cm; Overall: 20 x 10 x 8 cm; Base: 2 x 9 x 7 cm; Weight: 3 kg"
    chosen = choose(parse(text))
    assert (chosen.height.value, chosen.width.value, chosen.depth.value) == (0.2, 0.1, 0.08)
    assert (chosen.base_width.value, chosen.base_depth.value, chosen.mass.value) == (0.09, 0.07, 3.0)
    assert text[chosen.height.start : chosen.height.end] == "20"
    assert "height x width x depth" in chosen.height.why


def test_with_base_goes_before_the_object_alone():
    chosen = choose(parse('5 x 6 x 7"; 8 x 9 x 10" including base'))
    assert chosen.height.value == 0.2032


@pytest.mark.parametrize(("hung", "height"), [(True, 0.508), (False, 0.4)])
def test_the_frame_counts_where_the_work_hangs(hung, height):
    chosen = choose(parse("40 x 30 cm; sheet: 10 x 12 in.; frame: 20 x 22 x 2 in."), hung=hung)
    assert chosen.height.value == height


def test_the_largest_of_several_is_taken_whole():
    chosen = choose(parse("10 x 50 cm\n30 x 45 cm\n20 x 20 cm"))
    assert (chosen.height.value, chosen.width.value) == (0.3, 0.45)
    assert "largest of 3" in chosen.height.why


@pytest.mark.parametrize(
    ("text", "base"),
    [
        ("H. 40 cm, base diam. 12 cm", (0.12, 0.12)),
        ('30" high, at base 7 x 8"', (0.1778, 0.2032)),
        ("Overall: 40 cm; Base: 3 x 20 cm", (0.2, 0.2)),
        ("Overall: 40 x 30 cm", None),
    ],
)
def test_bases(text, base):
    chosen = choose(parse(text))
    read = (chosen.base_width.value, chosen.base_depth.value) if chosen.base_width and chosen.base_depth else None
    assert read == base


def test_lengths_lie_and_circumferences_become_diameters():
    chosen = choose(parse("l. 20 x w. 3 cm"))
    assert (chosen.width.value, chosen.depth.value, chosen.height) == (0.03, 0.2, None)
    assert choose(parse("circumference: 31.4159265 cm")).diameter.value == pytest.approx(0.1, rel=1e-8)
    assert "circumference" in choose(parse("circumference: 31.4 cm")).diameter.why


def test_nothing_is_chosen_from_nothing():
    chosen = choose(parse("Dimensions unavailable"))
    assert all(getattr(chosen, field) is None for field in chosen.__slots__)
