"""What a run assumed, in the reader's units and language."""

import re
from collections.abc import Iterator
from dataclasses import replace
from math import isclose

import pytest

from pipeline.analysis.classify import classify
from pipeline.records import Anchorage, Furniture, Hanging, Item, Scene, Support
from pipeline.records import phrases as say
from pipeline.records.phrase import Clause, Number
from pipeline.records.phrases import PHRASES
from pipeline.report.assumed import assumed, happening, rejected, rule_words, sourced, together
from pipeline.report.language import language, said, speaking
from pipeline.report.pages.scene_words import left_out
from pipeline.report.units import Units
from tests.museum import carnegie

WAYS = "assumed for two hooks or D-rings, or one hook or wire"
DEPTH = f"depth of its hooks: 0.0127 m (0.00508 to 0.0254), {WAYS}"
CLEARANCE = "clearance: 10 cm (5 to 30) to neighbour, wall or edge, assumed for: vessel"
MASS = "mass: bronze of 8700 kg/m3 filling 0.5 of its outline, assumed"
FRAMED = "mass: 15 kg/m2 (5 to 40) of the face of a framed work, assumed"
SOLID = "section: taken as solid from 12 kg on and as hollow below, its area with its mass: it is hollow or of sheet"
SHEET = "the museum's record says 0.2 m, the sheet desk, A. Smith says 0.5 m, which is used"
SCREEN = "A_max/g = 0.35 against B/H' = 0.1: rocks. V_max is 1.2 times 10 B/sqrt(H'): does not overturn."
CASE = "furniture: a showcase, for its record names the case or plinth 'depth of its hooks: 3 m'"
FURNITURE = (
    "furniture: a showcase, assumed for: vessel, usual_furniture.csv; not recorded; of 8 Hz (4 to 20), or stiff, "
    "furniture.csv; taken as fastened, which nobody says"
)


@pytest.mark.parametrize(
    ("text", "length", "told"),
    [
        (DEPTH, "in", f"depth of its hooks: 0.5\u202fin (0.2 to 1), {WAYS}"),
        (CLEARANCE, "mm", "clearance: 100\u202fmm (50 to 300) to neighbour, wall or edge, assumed for: vessel"),
        (MASS, "cm", "mass: bronze of 8700\u202fkg/m³ filling 0.5 of its outline, assumed"),
        # 8700 kg/m3 are 543.12 lb/ft3, 15 kg/m2 3.0722 lb/ft2, 12 kg 26.455 lb.
        (MASS, "in", "mass: bronze of 543\u202flb/ft³ filling 0.5 of its outline, assumed"),
        (FRAMED, "ft", "mass: 3.07\u202flb/ft² (1.02 to 8.19) of the face of a framed work, assumed"),
        (SOLID, "in", "section: taken as solid from 26.5\u202flb on and as hollow below, its area with its mass: it is "
         "hollow or of sheet"),
        (SHEET, "in", "the museum's record says 7\u00a0⅞\u00a0in, the sheet desk, A. Smith says 19\u00a0⅝\u00a0in, "
         "which is used"),
        (CASE, "in", CASE),
        ("its owner says: 30 cm (10 to 50) are free", "in", "its owner says: 30 cm (10 to 50) are free"),
    ],
)  # fmt: skip
def test_what_is_assumed_is_said_in_the_readers_unit_of_length(text: str, length: str, told: str) -> None:
    assert assumed(text, Units(length)) == told


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        (
            CLEARANCE,
            "it",
            "spazio libero: 10\u202fcm (da 5 a 30) da vicino, parete o bordo, ipotizzato per: vaso o recipiente",
        ),
        (
            DEPTH,
            "es",
            "profundidad de sus ganchos: 1,27\u202fcm (0,508 a 2,54), supuesta para: dos ganchos o anillas en D "
            "o un gancho o un alambre",
        ),
        (CASE, "el", "έπιπλο: προθήκη, γιατί η εγγραφή του αναφέρει την προθήκη ή το βάθρο 'depth of its hooks: 3 m'"),
        (
            FURNITURE,
            "ja",
            "什器：展示ケース、次について仮定：容器、通常の什器の表、登録なし、8\u202fHz (4〜20)、または剛、"
            "什器の表、固定されていると見なす（記録なし）",
        ),
    ],
)
def test_what_is_assumed_is_said_in_the_readers_language(text: str, code: str, told: str) -> None:
    with speaking(language(code, None)):
        assert assumed(text, Units("cm")) == told


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("Wider base: it would need a plate 156 cm wide; 120 cm is allowed", "en",
         "Wider base: it would need a plate 61.4\u202fin wide; 47.2\u202fin is allowed"),
        ("Keep clear: with 30 cm harm would remain with a probability of 12 %", "it",
         "Lasciare spazio libero: con 11,8\u202fin resterebbe una probabilità di danno del 12\u00a0%"),
        ("Fasten: dynamic stress may still reach 3.1 times what is allowed, 1.2 times by the best estimates", "el",
         "Στερέωση: δυναμική τάση: μπορεί ακόμη να φτάσει 3,1 φορές το επιτρεπόμενο, 1,2 φορές κατά τις "
         "καλύτερες εκτιμήσεις"),
        ("Our own net: it is too small for 30 cm", "es", "Our own net: it is too small for 30 cm"),
    ],
)  # fmt: skip
def test_why_a_measure_was_passed_over_is_said_in_the_readers_words(text: str, code: str, told: str) -> None:
    with speaking(language(code, None)):
        assert rejected(text, Units("in")) == told


@pytest.mark.parametrize("phrase", PHRASES, ids=lambda phrase: phrase.asked[:40])
def test_a_phrase_finds_again_what_it_wrote(phrase: Clause) -> None:
    names = {name: unit for _, name, unit, _ in phrase._pieces if name}
    given = {name: (0.03, 0.12, 4.5) if unit else f"some {name}" for name, unit in names.items()}
    written = phrase(**given)
    first = next(one for one in PHRASES if one.places(written) is not None)
    assert first is phrase
    for name, found in (phrase.places(written) or {}).items():
        if isinstance(found, Number):
            low, best, high = given[name]
            assert all(map(isclose, found.si, map(float, (best, low, high)))), name
        else:
            assert found == given[name]


def _museum() -> list[Item]:
    read = carnegie()
    items = list(read.items)[::7]
    more = [
        *(replace(item, support=held) for item in items[::9] for held in Support if held is not Support.ISOLATED),
        *(replace(item, hanging=way, support=Support.HUNG) for item in items[::20] for way in Hanging),
        *(replace(item, furniture=kind, furniture_anchorage=fast)
          for item in items[::20] for kind in Furniture for fast in Anchorage),
        *(replace(item, depth_m=None, height_m=None) for item in items[::5]),
        *(replace(item, case="Case 12; upper 3 m shelf", condition=0.5, tilt_angle_deg=12.0) for item in items[::20]),
        *(replace(item, section_width_m=0.1, section_shape="oval") for item in items[::20]),
        *(replace(item, contact_polygon=((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))) for item in items[::20]),
        *(replace(item, surface_material=on, base_material="Wood") for item in items[::20] for on in ("Felt", "Metal")),
    ]  # fmt: skip
    return [*items, *more]


def _clauses(scenes: list[Scene]) -> Iterator[str]:
    for scene in scenes:
        for text in (*scene.assumptions, *(one.note for one in scene.parameters.values() if one.note)):
            yield from text.split("; ")


@pytest.fixture(scope="module")
def clauses() -> set[str]:
    return set(_clauses([classify(item) for item in _museum()]))


def test_every_assumption_about_a_museum_is_of_a_phrase(clauses: set[str]) -> None:
    ours = {one for one in clauses if "3 m shelf" not in one and "Case 12" not in one}
    assert len(ours) > 300
    assert [one for one in sorted(ours) if not any(phrase.places(one) is not None for phrase in PHRASES)] == []


# Of letters other than English ones: there what is left shows.  All catalogues have the same phrases.
@pytest.mark.parametrize("code", ["el", "ja"])
def test_no_english_is_left_in_what_was_assumed(clauses: set[str], code: str) -> None:
    with speaking(language(code, None)):
        told = [assumed(one, Units("cm")) for one in clauses if "Case 12" not in one and "3 m shelf" not in one]
    left = [one for one in told if re.search(r"[A-Za-z]{4,}", re.sub(r"\w+\.csv|'[^']*'", "", one))]
    assert left == []


def test_what_happens_in_a_motion_is_told_in_the_readers_unit_and_language() -> None:
    moved = say.COMES_BACK_MOVED(share=0.254, times=3.0, away=0.0254)
    text = f"It tips by {{demand}}. {moved} {say.SLIDES_BEFORE(friction=0.2)} Somebody's own words."
    told = happening(text, Units("in"))
    assert told.startswith("It tips by {demand}. It comes back: it tips by at most 25\u00a0% of its critical angle")
    # 2.54 cm are stored to the millimetre: 2.5 cm, 0.984 in.
    assert "its base ends 0.984\u202fin from where it stood. But its friction of 0.2 lets it slide" in told
    assert told.endswith(" Somebody's own words.")
    assert happening(say.OPENS(angle=2.0, speed=0.127), Units("in")).endswith("at 5.12\u202fin/s.")
    with speaking(language("it", None)):
        assert happening(SCREEN, Units("cm")) == (
            "A_max/g = 0,35 contro B/H' = 0,1: dondola. V_max è 1,2 volte 10 B/sqrt(H'): non si ribalta."
        )


@pytest.mark.parametrize("code", ["it", "es", "el", "ja"])
def test_rules_and_sources_are_told_in_the_readers_language(code: str) -> None:
    with speaking(language(code, None)):
        told = rule_words("vessel-name: its name says that it is a vessel (named 'vase'); its record names no class")
        assert "'vase'" in told
        assert "named" not in told
        for text in ("classes.csv, vessel (judgement)", "usual_hangings.csv; strengths: fixings.csv"):
            assert not {"csv", "judgement", "vessel", "strengths"} & set(sourced(text).replace(".", " ").split())
        assert "Blevins 1979, Table 8-1" in sourced("bending: a bar (Blevins 1979, Table 8-1)")
    assert sourced("classes.csv, vessel (judgement)") == "classes.csv, vessel (judgement)"
    assert rule_words('evidence: all (named "a\'b")') == 'evidence: all (named "a\'b")'


def test_what_a_person_reads_of_a_doubt_is_in_their_language() -> None:
    """Truth by the catalogue of Greek: no word of English is left in what was stored as English."""
    for text in (
        "Level design: the mean of 11 motions, PGA 0.316 g to 0.644 g, PGV 27.7 cm/s to 96.4 cm/s; return period 475 "
        "years; no engineer has approved these motions",
        "the size of 'βάση' is taken for that of the whole object; measure the whole object, or write which size is "
        "whose, such as Overall: H 10 x W 5 cm",
        "0.25 m against 0.45 m: the first is believed, as the one that was measured; the second is usually its "
        "conversion; measure it again, and correct the text in the museum's database",
        "no unit is written, so there is no value; write the unit into the text, or say it in the mapping, "
        '[dimensions] unit = "..."',
    ):
        with speaking(language("el", None)):
            told = assumed(text, Units())
        assert not re.search(r"\b(the|is|of|and|are|measure|believed|written)\b", told), told
    with speaking(language("el", None)):
        why = "not required: its name says that it is a vessel (named 'carafe'); it is free to move instead"
        assert "required" not in left_out(("stress", why))
        assert "it is free" not in left_out(("stress", why))
        care = "Stand it here. Sleeve each tie with soft tubing where it touches: a bare line cuts into paint, gilding "
        care += "and soft surfaces. Renew it every few years, as nylon creeps and ages."
        assert "Renew" not in said(care)


def test_levels_are_told_in_the_readers_units() -> None:
    text = "Level design: the worst of 2 motions, PGA 0.3 g to 0.6 g, PGV 25.4 cm/s to 50.8 cm/s"
    assert assumed(text, Units("in")).endswith("PGV 10\u202fin/s to 20\u202fin/s")


def test_a_reason_that_several_measures_share_is_said_once() -> None:
    stands = "it does not stand free"
    texts = (f"Non-slip pad: {stands}", "Keep clear: it does not move", f"Museum putty: {stands}", "Nothing helps")
    told = together(rejected(text, Units()) for text in texts)
    assert told == [f"Non-slip pad, Museum putty: {stands}", "Keep clear: it does not move", "Nothing helps"]
