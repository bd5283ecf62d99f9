"""News of objects from one run to another: told one by one, but what changed for all at once only as a number."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from pipeline.records import Brief, DecisionChange, NewsKind, ObjectChange, Ruled, Settled
from pipeline.store.causes import Causes

ONE_BY_ONE = 200
"""Objects at most that one change of house rules moves and that are told one by one; of more their number is told."""


class Seen(NamedTuple):
    """An object as one run has it: its title, where it is, whether it is on display, and what is said of it."""

    title: str
    gallery: str
    on_display: bool
    floor: str
    brief: Brief

    @property
    def shown(self) -> Brief | None:
        """What is said of it on display; None where it is not there."""
        return self.brief if self.on_display else None


def news(
    before: Mapping[str, Seen],
    after: Mapping[str, Seen],
    decisions: Iterable[DecisionChange],
    causes: Causes,
    *,
    shared: bool,
    ruled: Mapping[str, tuple[Ruled, ...]] | None = None,
) -> tuple[tuple[ObjectChange, ...], dict[str, int]]:
    """Return news of objects in the order in which it is told, and how much there is that all have in common.

    What changed only because motions, floors, settings or Kouros itself did is counted by its kind: a thousand objects
    that one motion makes worse are one piece of news.

    Parameters
    ----------
    before, after : mapping of str to Seen
        By number, the objects that may have changed, and those that decisions are about.
    decisions : iterable of DecisionChange
        Made or ended.
    causes : Causes
        All that changed.
    shared : bool
        Whether anything changed that verdicts of objects have in common.
    ruled : mapping of str to tuple of Ruled, optional
        By number, house rules that are new for an object, or hold for it no longer.
    """
    ruled = ruled or {}
    about: dict[str, list[Settled]] = {}
    for change in decisions:
        about.setdefault(change.decision.object_number, []).append(Settled.of(change.decision, new=change.new))
    found: list[ObjectChange] = []
    moved: list[ObjectChange] = []
    counts: Counter[NewsKind] = Counter()
    for number in before.keys() | after.keys():
        was, now = before.get(number), after.get(number)
        one = _change(number, was, now, tuple(about.get(number, ())), causes, ruled.get(number, ()))
        kind = one.kind
        if kind is None:
            continue
        if was is not None and now is not None and _in_common(one, was, now, shared=shared):
            if one.ruled:
                moved.append(one)
            else:
                counts[kind] += 1
        else:
            found.append(one)
    if len(moved) <= ONE_BY_ONE:
        found += moved
    else:
        counts.update(one.kind for one in moved if one.kind is not None)
    return tuple(sorted(found, key=lambda one: one.order)), {
        kind.value: counts[kind] for kind in NewsKind if counts[kind]
    }


def _change(
    number: str,
    was: Seen | None,
    now: Seen | None,
    decided: tuple[Settled, ...],
    causes: Causes,
    ruled: tuple[Ruled, ...],
) -> ObjectChange:
    last = now or was
    if last is None:
        raise ValueError(f"{number!a} is in neither of the runs")
    moved = was is not None and now is not None and was.gallery != now.gallery
    return ObjectChange(
        number,
        last.title,
        last.gallery,
        None if was is None else was.shown,
        None if now is None else now.shown,
        was.gallery if moved and was is not None else None,
        now is not None,
        decided,
        causes.fields(number),
        ruled,
    )


def _in_common(one: ObjectChange, was: Seen, now: Seen, *, shared: bool) -> bool:
    """Say whether nothing of the object itself changed, but something did that others rest on too."""
    own = one.fields or one.decided or one.came_from is not None or was.on_display != now.on_display
    return not own and (shared or was.floor != now.floor)
