"""Whether the words of a collection are known at all: a museum that writes in another language must hear of it."""

from collections import Counter
from collections.abc import Sequence

from pipeline.analysis.object_class import class_of
from pipeline.analysis.rules import PICTURES, readings
from pipeline.records import Item

SEEN = 2000
"""Objects that it is told by, evenly chosen."""
FEWEST = 20
"""Objects below which nothing is said."""
MOST = 0.3
"""Share of the objects whose words may say no class; museums of modern art name a sixth of theirs by bare titles."""
NAMED = 3
"""Names that are shown."""


def unknown_names(items: Sequence[Item]) -> str:
    """Return in words that the records of many objects name no class that is known; "" where few do.

    Parameters
    ----------
    items : sequence of Item
        The objects.

    Returns
    -------
    str
        With the names that are most frequent, and what helps.
    """
    some = items[:: max(1, len(items) // SEEN)]
    # A title alone may name what a picture shows: what is taken for one is not held to stand.
    silent = [item for item in some if readings(item).silent and class_of(item).name not in PICTURES]
    if len(some) < FEWEST or len(silent) <= MOST * len(some):
        return ""
    names = Counter(item.object_name or item.title for item in silent if item.object_name or item.title)
    told = ", ".join(repr(name[:40]) for name, _ in names.most_common(NAMED)) or "no name at all"
    return (
        f"{len(silent) / len(some):.0%} of the objects are called what names no class here, such as {told}: they are "
        "taken for free-standing objects. Where their words are of another language, name their classes in a file "
        "of rules, [collection] rules; where a column says what a thing is, choose it by --choose object_name=COLUMN"
    )
