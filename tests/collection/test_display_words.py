"""Words of display in nine languages, as museums write them in flags and in names of places."""

from __future__ import annotations

import pytest

from pipeline.collection.display_words import flag_of, says_away, says_flags

AWAY = (
    "Not on View", "not on display", "Off-site", "OFF SITE", "In storage", "On loan to the Tate", "Depot 3", "Im Depot",
    "Außendepot Nord", "Gemäldedepot", "Magazin 4", "nicht ausgestellt", "Réserve sculptures", "en réserve",
    "Réserve 2", "Non exposé", "en prêt à Lyon", "in deposito", "Deposito 4", "Magazzino A", "no expuesto", "Almacén 3",
    "em reserva", "Reserva técnica", "não exposto", "Depot B", "niet tentoongesteld", "in depozit", "Depozit 2",
    "nu este expus", "収蔵庫A", "展示していません", "Building A > Basement > Storage B2", "Saal 4 (Depot)",
    "Vault", "Store 3", "Gallery 5 - not on view", "Store room 4", "Lager 7",
)  # fmt: skip
SHOWN = (
    "", "Gallery 12", "Hall of Sculpture", "Sala 3", "Saal 4", "Salle des États", "Zaal 2", "展示室1", "Open Storage",
    "Visible Storage", "Schaudepot", "Réserve visitable", "On loan from a private collection", "Leihgabe von Privat",
    "General Store", "Village Store", "Storage Jar Room", "Magazin der Dinge", "Missing Persons Gallery",
    "Loan Gallery", "Reserve Room of Honour", "Restoration", "Storey Hall", "Depotstraße 3",
)  # fmt: skip


@pytest.mark.parametrize("location", AWAY)
def test_places_that_are_no_galleries(location: str) -> None:
    assert says_away(location)
    assert flag_of(location, display=True) is False


@pytest.mark.parametrize("location", SHOWN)
def test_places_that_are_or_may_be(location: str) -> None:
    assert not says_away(location)


@pytest.mark.parametrize(
    ("yes", "no"),
    [
        ("Yes", "No"), ("ja", "nein"), ("oui", "non"), ("Sì", "no"), ("sí", "no"), ("sim", "não"), ("JA", "nee"),
        ("da", "nu"), ("はい", "いいえ"), ("TRUE", "false"), ("vrai", "faux"), ("x", "n"), ("✓", "no"),
    ],
)  # fmt: skip
def test_flags_of_all_kinds(yes: str, no: str) -> None:
    assert (flag_of(yes), flag_of(no)) == (True, False)


def test_flags_of_display_say_it_by_words() -> None:
    for text in (
        "On view",
        "ausgestellt",
        "exposé",
        "Esposto",
        "en exhibición",
        "em exposição",
        "op zaal",
        "expus",
        "展示中",
    ):
        assert flag_of(text, display=True) is True
        assert flag_of(text) is None, "of another flag it says nothing"
    assert flag_of("perhaps", display=True) is None
    assert says_flags(["On view", "Not on view", "on loan"])
    assert not says_flags(["yes", "no"]), "a flag of anything"
    assert not says_flags(["Gallery 1", "Not on view"]), "locations"
    assert not says_flags(["Depot 1", "Depot 2"]), "stores only"


@pytest.mark.parametrize(
    ("place", "away"),
    [
        ("Prints & Drawings Study Room, level E", True),
        ("Print Room", True),
        ("Kupferstichkabinett", True),
        ("Graphische Sammlung, Studiensaal", True),
        ("Gabinetto dei disegni e delle stampe", True),
        ("Conservation lab", True),
        ("The Print Room (Gallery 4)", False),
        ("Kupferstichkabinett, Ausstellungsraum 2", False),
        ("Study Collection", False),
        ("Drawing Room", False),
        ("Library", False),
    ],
)
def test_print_rooms_and_workshops_show_nothing(place: str, away: bool) -> None:
    assert says_away(place) is away
