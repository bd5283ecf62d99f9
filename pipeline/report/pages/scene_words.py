"""What many objects have alike, in words: how they are held, what they stand in or on, what they are taken for."""

from collections.abc import Callable, Mapping
from functools import cache

from pipeline.records import Anchorage, Furniture, Mount, Origin, Scene, Support
from pipeline.report.assumed import class_words, reason_words
from pipeline.report.language import _, local, said
from pipeline.report.text import clean, count, words
from pipeline.tables import table

_POSSIBLE = 0.05
"""Probability from which another class is named on the page of an object."""


def support(of: Support) -> str:
    """Say in words how an object is held."""
    told = {
        Support.FREESTANDING: _("freestanding"),
        Support.FASTENED: _("fastened"),
        Support.HUNG: _("hung"),
        Support.SUSPENDED: _("suspended"),
        Support.ISOLATED: _("isolated"),
    }
    return told[of]


def held(scene: Scene) -> str:
    """Say in words how an object is held where it stands, lies or hangs."""
    ways = {
        Mount.LYING: _("lies on its largest face"),
        Mount.STANDING: _("stands by itself"),
        Mount.LEANING: _("leans on a stand or against a backing"),
        Mount.RESTING: _("rests on its mount, held by nothing else"),
        Mount.SECURED: _("held on its mount"),
        Mount.UNKNOWN: _("on a mount that nobody described"),
    }
    return support(scene.support) if scene.mount is None else ways[scene.mount]


def furniture(scene: Scene) -> str:
    """Say in words what an object stands in or on, and where that is known from; "" of what hangs as all such do."""
    if scene.furniture is None or scene.stands_by is None:
        return ""
    told = {
        Furniture.FLOOR: _("on the floor"),
        Furniture.SHOWCASE: _("in a showcase"),
        Furniture.PEDESTAL: _("on a pedestal or plinth"),
        Furniture.SHELF: _("on a shelf"),
        Furniture.WALL: _("on a wall"),
        Furniture.RAIL: _("from a rail or the ceiling"),
    }
    known = {
        Origin.MEASURED: _("as recorded"),
        Origin.DERIVED: _("as its record names a case"),
        Origin.STATED: _("stated by a house rule"),
        Origin.ASSUMED: _("assumed"),
    }
    held = {
        None: "",
        Anchorage.ANCHORED: _(", fastened"),
        Anchorage.UNANCHORED: _(", not fastened"),
    }[scene.anchorage]
    return f"{told[scene.furniture]} ({known[scene.stands_by]}){held}"


def furniture_known(counts: Mapping[str, int]) -> str:
    """Say in one line of how many objects it is known from where what they stand on; "" of none.

    Parameters
    ----------
    counts : mapping of str to int
        By origin.

    Returns
    -------
    str
    """
    told = {
        Origin.MEASURED: _("%(count)s by their record"),
        Origin.DERIVED: _("%(count)s by the case that their record names"),
        Origin.STATED: _("%(count)s by a house rule"),
        Origin.ASSUMED: _("%(count)s by what is usual for their class"),
    }
    return ", ".join(text % {"count": count(counts[of])} for of, text in told.items() if counts.get(of))


NOT_REQUIRED, NO_CLASS = "not required: ", "its record names no class"
"""How it is told that no model is asked, and that nothing names a class."""


def left_out(skipped: tuple[str, str]) -> str:
    """Say which model was left out, and why."""
    model, why = skipped
    asked, sign, rule = clean(why).partition(NOT_REQUIRED)
    if asked or not sign:
        return f"{words(clean(model))}: {said(clean(why))}"
    # Behind the rule stands what a model says to all of which it is not asked.
    first, parted, last = rule.rpartition("; ")
    if not parted or last.startswith(NO_CLASS):
        first, last = rule, ""
    not_required = _("not required")
    told = f"{words(clean(model))}: {not_required}: {reason_words(first)}"
    return f"{told}; {said(last)}" if last else told


def what_it_is(kind: tuple[str, str]) -> str:
    """Return what an object is computed as.

    Parameters
    ----------
    kind : (str, str)
        Its class, and in words the body that is more particular; "" where there is none.

    Returns
    -------
    str
    """
    object_class, body = kind
    return said(body) if body else class_words(object_class)


def taken_words(scene: Scene) -> str:
    """Return how sure the class of an object is, and which other one is possible."""
    sure = dict(scene.chances).get(scene.object_class)
    if sure is None:
        return ""
    told = _("taken for: {one} ({sure})").format(one=words(clean(scene.object_class)), sure=local(f"{sure:.2f}"))
    others = [pair for pair in scene.chances if pair[0] != scene.object_class and pair[1] >= _POSSIBLE]
    if not others:
        return told
    other = _("{one} is possible ({sure})").format(one=words(clean(others[0][0])), sure=f"{others[0][1]:.2f}")
    return f"{told}; {other}"


_TABLES = {"hanging": "hangings", "furniture": "furniture", "mount": "mounts"}
"""Field or statement of a rule -> the table whose rows it names."""


# Looked up in the language of the page.
STATED: Mapping[str, Callable[[], str]] = {
    "hanging": lambda: _("how they hang"),
    "furniture": lambda: _("what they stand on or in"),
    "furniture_anchorage": lambda: _("whether that is fastened"),
    "surface": lambda: _("what lies under them"),
    "held": lambda: _("how they are held"),
    "mount": lambda: _("how their mount holds them"),
    "friction": lambda: _("friction under them"),
    "clearance_m": lambda: _("free distance around them"),
    "cg_height_m": lambda: _("height of the centre of gravity"),
    "cg_ratio": lambda: _("height of the centre of gravity as a share of the object's height"),
    "base_ratio": lambda: _("footing as a share of the width"),
    "suspension_length_m": lambda: _("from hook to centre of gravity"),
    "suspension_ratio": lambda: _("from hook to centre of gravity as a share of the object's height"),
    "damping": lambda: _("damping ratio"),
    "frequency_hz": lambda: _("natural frequency"),
}
"""What a house rule may state, what people know without an instrument first."""


def stated_told(name: str) -> str:
    """Return what a house rule states, as the page that asks for it says it."""
    return STATED[name]() if name in STATED else words(name)


def word_told(field: str, word: str) -> str:
    """Return a word that a field may hold, or a rule may state, as people say it.

    Parameters
    ----------
    field : str
        Such as "hanging".
    word : str
        Such as "two_hooks".
    """
    title = _titles(field).get(str(word))
    return said(title) if title else words(str(word))


@cache
def _titles(field: str) -> dict[str, str]:
    listed = _TABLES.get(field)
    return {row[field]: row["title"] for row in table(listed)} if listed else {}
