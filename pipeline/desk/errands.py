"""Errands of the plan, and what people say of them: who takes one, who has done it."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

from pipeline.collection.database import Database
from pipeline.desk.guard import DeskError
from pipeline.planning.errands import Errand
from pipeline.planning.plan import ErrandPlan
from pipeline.store.desk import ErrandWord, add_errand_word
from pipeline.tools.decisions import WHO_LIMIT, WHY_LIMIT

KINDS = ("take", "give", "done", "back")


@dataclass(frozen=True, slots=True)
class ErrandEntry:
    """An errand in a list: what it is, whose it is now, and all that was said of it.

    Attributes
    ----------
    state : str
        "open", "taken" or "done".
    """

    key: str
    errand: Errand
    chosen: bool
    state: str
    whose: str
    words: tuple[ErrandWord, ...]

    @property
    def version(self) -> str:
        """What whoever says something of it must have seen."""
        return str(self.words[-1].id if self.words else 0)


def errand_key(errand: Errand) -> str:
    """Return what an errand is known by from night to night: place, measure, and the object where it is in no case."""
    alone = "" if errand.case else errand.objects[0].object_number
    told = "\0".join((errand.gallery, errand.case, errand.measure, str(errand.needs is not None), alone))
    told += "\0check" if errand.check and errand.case else ""
    return hashlib.sha256(told.encode("utf-8", "surrogatepass")).hexdigest()[:20]


def entries(plan: ErrandPlan, words: Mapping[str, tuple[ErrandWord, ...]]) -> list[ErrandEntry]:
    """Return the errands in walking order, each with what was said of it."""
    chosen = frozenset(plan.choice.chosen)
    return [_entry(errand, at in chosen, words) for at, errand in enumerate(plan.errands)]


def _entry(errand: Errand, chosen: bool, words: Mapping[str, tuple[ErrandWord, ...]]) -> ErrandEntry:
    key = errand_key(errand)
    mine = words.get(key, ())
    last = mine[-1] if mine else None
    state = "open" if last is None or last.kind == "back" else "done" if last.kind == "done" else "taken"
    return ErrandEntry(key, errand, chosen, state, "" if last is None or state == "open" else last.whose, mine)


def say(engine: Database, entry: ErrandEntry, kind: str, who: str, *, whose: str = "", note: str = "") -> None:
    """Write down what somebody says of an errand.

    Raises
    ------
    DeskError
        For a kind that there is not, and for words that are missing or too long.
    """
    if kind not in KINDS:
        raise DeskError("say whether you take it, give it to somebody, have done it, or put it back")
    if kind == "give" and not whose.strip():
        raise DeskError("write who is to do it")
    if len(whose) > WHO_LIMIT or len(note) > WHY_LIMIT:
        raise DeskError(f"a name has at most {WHO_LIMIT} characters, a note {WHY_LIMIT}: say it shorter")
    named = whose.strip() if kind == "give" else who
    moment = datetime.now(UTC).isoformat(timespec="seconds")
    add_errand_word(engine, ErrandWord(0, entry.key, kind, named, note.strip(), who, moment))
