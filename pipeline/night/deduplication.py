"""Objects that differ in nothing that anything computed rests on are worked on once.

A service of forty cups, a series of prints in the same frame: what is found of one of them holds for all, with another
number.  So it does for an object of an earlier night, under the same shaking and rules, that is still what it was.
"""

from collections import OrderedDict
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import replace
from operator import attrgetter
from threading import Lock

from pipeline.analysis.faults import Fault, unassessed
from pipeline.collection.record import INDIVIDUAL
from pipeline.records import ITEM_FIELDS, Assessment, Found, Scene, Support

MOST = 100_000
"""Kinds of objects that are remembered, of about 6 kB each."""

# The classification, whose result is a part of the scene, looks at titles; neighbours are looked at afterwards.
_shared = attrgetter(*(name for name in ITEM_FIELDS if name not in INDIVIDUAL))


def likeness(scene: Scene) -> Hashable | None:
    """Return what objects that are alike share; None for one whose company counts.

    That is one that stands in a case, whose measures are for all in it, or on an isolator.
    """
    if scene.item.case.strip() or scene.support is Support.ISOLATED:
        return None
    return (
        *(scene.object_class, scene.rule, scene.support, scene.models, tuple(scene.parameters.items())),
        *(scene.assumptions, scene.missing, scene.floor),
        *_shared(scene.item),
    )


Known = tuple[Assessment, Mapping[str, int]]
"""What was found of an object, and for how many of its analyses any history was run, by the name of the model."""


class Twins:
    """What was found of objects, by their likeness; of too many the first are forgotten."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._known: OrderedDict[Hashable, Known] = OrderedDict()
        # A worker of a museum's own cluster may have several threads.
        self._lock = Lock()

    def get(self, like: Hashable) -> Known | None:
        """Return what is known of such an object."""
        return self._known.get(like)

    def note(self, like: Hashable, assessment: Assessment, needing: Mapping[str, int]) -> None:
        """Take down what was found of an object."""
        with self._lock:
            self._known[like] = (assessment, needing)
            if len(self._known) > self._most:
                self._known.popitem(last=False)

    def learn(self, found: Found) -> None:
        """Take down what an earlier night found, under the same shaking and by the same rules and code."""
        self.take((a, found.needing.get(a.scene.item.object_number, {})) for a in found.assessments)

    def take(self, known: Iterable[Known]) -> None:
        """Take down what is known of some objects."""
        for assessment, needing in known:
            like = likeness(assessment.scene)
            if like is not None:
                self.note(like, assessment, needing)


def as_own(scene: Scene, twin: Assessment) -> Assessment:
    """Return what was found of a twin as found of this object."""
    number, gallery = scene.item.object_number, scene.item.gallery
    if twin.fault:
        return unassessed(scene, Fault(number, twin.fault, ""))
    return Assessment(
        replace(scene, skipped=twin.scene.skipped, missing=twin.scene.missing),
        tuple(replace(one, object_number=number, gallery=gallery) for one in twin.findings),
        tuple(replace(one, object_number=number, gallery=gallery) for one in twin.recommendations),
        tuple(replace(one, object_number=number) for one in twin.fragilities),
    )
