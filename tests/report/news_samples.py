"""News of objects for tests: one of every kind, and as many as wanted."""

from __future__ import annotations

from dataclasses import replace

from pipeline.records import Band, Brief, NewsKind, ObjectChange, Ruled, Settled, State
from pipeline.tables import table

ACT = Brief(State.ACT, Band.LIKELY.value, "fasten", "Fasten")
WATCH = Brief(State.WATCH, Band.UNLIKELY.value)
FINE = Brief(State.FINE, Band.VERY_UNLIKELY.value)
UNKNOWN = Brief(State.UNKNOWN, missing="height_m")


def news_of_every_kind(word: str) -> tuple[ObjectChange, ...]:
    """Return news of each kind, in each of its wordings, of objects whose texts are all one word."""
    made = Settled(True, "clamps", word, word, date="2031-05-01")
    rule = Ruled(True, word, "2031-05-01", ("framed",), (word,), {"hanging": "two_hooks", "friction": ""})
    base = ObjectChange("1", word, word, FINE, ACT)
    unsure = replace(ACT, band=Band.ALMOST_CERTAIN.value, measure="")
    found = [
        replace(base, before=None),
        base,
        replace(base, after=unsure, fields=("height_m", "width_m", "depth_m", "medium")),
        replace(base, before=ACT, after=unsure),
        replace(base, before=UNKNOWN),
        replace(base, after=WATCH, came_from=word),
        replace(base, after=UNKNOWN),
        replace(base, before=unsure, after=ACT, decided=(made,)),
        replace(base, before=ACT, after=FINE, decided=(made, replace(made, new=False, measure="wax"))),
        replace(base, before=ACT, after=WATCH, decided=(made,)),
        replace(base, before=ACT, after=WATCH, decided=(replace(made, new=False, measure=""),)),
        replace(base, before=ACT, after=FINE, ruled=(rule,)),
        replace(base, ruled=(replace(rule, new=False),)),
        replace(base, before=None, after=FINE),
        replace(base, before=None, after=UNKNOWN),
        replace(base, after=None),
        replace(base, after=None, recorded=False),
        replace(base, before=FINE, after=FINE, came_from=""),
        replace(base, before=ACT, after=ACT, decided=(replace(made, measure=""), replace(made, new=False, measure=""))),
    ]
    found += [replace(base, after=replace(ACT, measure=row["measure"])) for row in table("measures")]
    found += [replace(base, after=FINE, decided=(replace(made, measure=row["measure"]),)) for row in table("measures")]
    found = [replace(one, object_number=str(at)) for at, one in enumerate(found)]
    assert {one.kind for one in found} == set(NewsKind)
    return tuple(sorted(found, key=lambda one: one.order))
