"""The newest run as the desk shows it: all objects, found by parts of words, and where the results of each are."""

import unicodedata
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import merge
from itertools import accumulate
from operator import itemgetter
from pathlib import Path
from threading import Lock
from typing import Any

from pipeline.analysis.classify import object_classes
from pipeline.analysis.house.questions import MANY, stated_by
from pipeline.analysis.survey import field_asked
from pipeline.desk.guard import DeskError
from pipeline.operations.report_status import presentation, terms_of
from pipeline.operations.workspace import Workspace
from pipeline.planning.plan import ErrandPlan, gallery_order
from pipeline.quantities import sorting_key
from pipeline.records import Page, RunRecord
from pipeline.records.likelihood import CLASS
from pipeline.report.files.exports import NOT_SHOWN
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.plan_files import gathered_from
from pipeline.report.files.walk_sheet import sheet_file
from pipeline.report.pages.chances import MOUNT, class_title
from pipeline.report.pages.compose import page_name
from pipeline.report.pages.describe import Sayings
from pipeline.report.pages.views import State
from pipeline.store.pages import Places, load_places
from pipeline.store.runs import load_head
from pipeline.store.sound import whole_runs

_FEW = 400
"""Different words with a part in them up to which their lines are put together: more words stand in so many lines that
the first ones are found soonest line by line."""


class WordIndex:
    """An index of lines.

    A part of a word is sought among the different words, of which there are far fewer than words.

    Parameters
    ----------
    lines : sequence of str
        Words parted by single spaces.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self._lines = lines
        places: dict[str, list[int]] = {}
        for at, line in enumerate(lines):
            for word in dict.fromkeys(line.split(" ")):
                places.setdefault(word, []).append(at)
        # Most words of a museum are its numbers: no word with a letter is sought among them.
        words = sorted(places, key=_no_letter)
        self._places = [places[word] for word in words]
        # In bytes, of which most words have fewer than letters take.
        self._text = b"".join(b"\n" + word.encode() for word in words) + b"\n"
        lengths = (len(word.encode()) + 1 for word in words)
        self._starts = list(accumulate(lengths, initial=1))
        self._lettered = self._starts[sum(not _no_letter(word) for word in words)]

    def having(self, parts: Sequence[str]) -> Iterator[int]:
        """Yield the places of the lines that have all parts in their words, in order.

        Parameters
        ----------
        parts : sequence of str
            Without spaces, one at least.
        """
        rarest = min((self._words_with(part) for part in parts), key=len)
        if len(rarest) > _FEW:
            found: Iterator[int] = iter(range(len(self._lines)))
        else:
            found = merge(*(self._places[word] for word in rarest))
        last = -1
        for at in found:
            # A line may have several of the words.
            if at != last and all(part in self._lines[at] for part in parts):
                yield at
            last = at

    def _words_with(self, part: str) -> list[int]:
        """Return the different words that have a part, or some more than a few of them."""
        text, sought, found = self._text, part.encode("utf-8", "replace"), list[int]()
        end = len(text) if _no_letter(part) else self._lettered
        at = text.find(sought, 0, end)
        while at >= 0 and len(found) <= _FEW:
            word = bisect_right(self._starts, at) - 1
            found.append(word)
            at = text.find(sought, self._starts[word + 1], end)
        return found


def _no_letter(word: str) -> bool:
    return not any(map(str.isalpha, word))


SHOWN = 50
"""Objects on a page of what a search finds."""

_COLUMNS = (
    "object_number", "title", "gallery", "case", "on_display", "state", "object_class", "open_for", "missing", "page",
    "rank",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class ListedObject:
    """An object in a list: ``open_for`` is the field whose measurement may change what is decided, "" for none.

    Attributes
    ----------
    rank : int
        Its place among all by urgency; the last of all where it has none.
    """

    number: str
    title: str
    gallery: str
    case: str
    on_display: bool
    state: str
    object_class: str
    open_for: str
    missing: str
    page: str
    rank: int

    @property
    def asks(self) -> str:
        """The one field that is worth measuring, or CLASS or MOUNT, which nobody measures; "" for nothing."""
        return asked_for(self.open_for, self.missing)


def asked_for(open_for: str, missing: str) -> str:
    """Return what is to be found out of an object, as of `ListedObject`."""
    return open_for if open_for in (CLASS, MOUNT) else field_asked(open_for, missing)


class RunFacts:
    """What the newest run of the whole collection found.

    Parameters
    ----------
    workspace : Workspace
        Whose run it is.

    Raises
    ------
    DeskError
        Where there is no run yet, or its report is gone.
    """

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        runs = whole_runs(workspace.engine)
        if not runs:
            raise DeskError("there is no finished run of the whole collection yet: make one with `kouros run`")
        self.run_id = runs[0]
        head, pages = load_head(workspace.engine, self.run_id)
        self.head: RunRecord = head
        self.folder: Path = workspace.reports / self.run_id
        shown = presentation(workspace.settings)
        self.units, self.language = shown["units"], shown["language"]
        self.renderer = PageRenderer(head, **shown)
        self.sayings = Sayings(head.motions, self.units)
        self.several = len({motion.level for motion in head.motions}) > 1
        self._pages = {page_name(p.gallery, p.number, on_display=p.on_display): p for p in pages}
        self._places: dict[str, Places] = {}
        self._lock = Lock()
        rows = sorted(_listed(self.folder), key=lambda one: sorting_key(one.number))
        self.objects: tuple[ListedObject, ...] = tuple(rows)
        self.by_number = {one.number: one for one in rows}
        self.galleries = Counter(one.gallery for one in rows if one.on_display)
        self.classes = Counter(one.object_class for one in rows if one.on_display)
        # Now, and not by the first four who search at once.
        self._words = WordIndex([folded(f"{o.number} {o.title} {o.gallery}") for o in self.objects])

    def found(self, words: str, gallery: str = "", state: str = "") -> Iterator[ListedObject]:
        """Yield the objects that have all words in number, title or gallery; one whose number it is comes first.

        Parameters
        ----------
        gallery, state : str
            Only there, only these; "" for all.
        """
        asked = folded(words)
        exact = self.by_number.get(words.strip())
        first = exact if exact is not None and _is(exact, gallery, state) else None
        if first is not None:
            yield first
        parts = asked.split()
        candidates = (self.objects[at] for at in self._words.having(parts)) if parts else iter(self.objects)
        yield from (one for one in candidates if one is not first and _is(one, gallery, state))

    @cached_property
    def urgent(self) -> tuple[ListedObject, ...]:
        """The objects on display that are to act on, the most urgent first."""
        return tuple(sorted((one for one in self.objects if one.state == State.ACT), key=lambda one: one.rank))

    @cached_property
    def rule_questions(self) -> tuple[tuple[str, str, int], ...]:
        """What one house rule may answer for many objects: class, what it states, how many wait for that first."""
        alike = Counter((o.object_class, o.open_for, o.missing) for o in self.objects if o.on_display)
        open_ones: Counter[tuple[str, str]] = Counter()
        for (kind, parameter, missing), count in alike.items():
            open_ones[kind, stated_by(asked_for(parameter, missing))] += count
        many = [(kind, states, count) for (kind, states), count in open_ones.items() if states and count >= MANY]
        return tuple(sorted(many, key=lambda one: (-one[2], one[0], one[1])))

    @cached_property
    def class_titles(self) -> tuple[tuple[str, str], ...]:
        """All classes of objects with what people call them, in the order of that."""
        return tuple(sorted(((name, class_title(name)) for name in object_classes()), key=itemgetter(1)))

    @cached_property
    def gallery_names(self) -> tuple[str, ...]:
        """The galleries as people list them."""
        return tuple(sorted(self.galleries, key=sorting_key))

    @cached_property
    def states(self) -> Counter[str]:
        """How many objects are in each state."""
        return Counter(one.state for one in self.objects)

    @cached_property
    def counts(self) -> Mapping[str, Counter[str]]:
        """By gallery how many objects on display are in each state."""
        found: dict[str, Counter[str]] = {}
        for one in self.objects:
            if one.on_display:
                found.setdefault(one.gallery, Counter())[one.state] += 1
        return found

    @cached_property
    def order(self) -> list[str]:
        """The galleries in walking order: as on the report's first page, the one with the most to do first."""
        walked = (State.ACT, State.WATCH, State.UNKNOWN)
        counts = {name: [here[state] for state in walked] for name, here in self.counts.items()}
        return sorted(counts, key=gallery_order(counts).__getitem__)

    def in_gallery(self, gallery: str) -> list[ListedObject]:
        """Return the objects on display in a gallery, in walking order: case by case, by number in each."""
        return self._walk.get(gallery, [])

    @cached_property
    def _walk(self) -> Mapping[str, list[ListedObject]]:
        found: dict[str, list[ListedObject]] = {}
        for one in self.objects:
            if one.on_display:
                found.setdefault(one.gallery, []).append(one)
        for those in found.values():
            those.sort(key=lambda one: (one.case.strip() == "", sorting_key(one.case), sorting_key(one.number)))
        return found

    def place(self, number: str) -> tuple[Page, str, int, str] | None:
        """Return the page of an object, the key and place of its results, and its record's digest then."""
        listed = self.by_number.get(number)
        page = None if listed is None else self._pages.get(listed.page.partition("#")[0])
        if page is None:
            return None
        places = self._places.get(page.key)
        if places is None:
            places = self._places[page.key] = load_places(self.workspace.engine, page.key)
        found = places.get(number)
        return None if found is None else (page, *found)

    def sheets(self, gallery: str) -> list[str]:
        """Return the files of the sheets to walk a gallery with, which its report has."""
        pages = sorted(
            (p for p in self._pages.values() if p.on_display and p.gallery == gallery), key=lambda p: p.number
        )
        files = [sheet_file(page_name(p.gallery, p.number)) for p in pages]
        return [file for file in files if (self.folder / file).is_file()]

    @property
    def plan(self) -> ErrandPlan | None:
        """The plan of the run's report; None where nobody knows how likely harm is.  Made when first asked for."""
        with self._lock:
            return self._plan

    @cached_property
    def _plan(self) -> ErrandPlan | None:
        terms = terms_of(self.workspace)
        return None if terms is None else gathered_from(self.folder).plan(terms)


def folded(text: str) -> str:
    """Return words as they are compared in a search: without case and accents, on one line."""
    plain = unicodedata.normalize("NFKD", text.casefold())
    return " ".join("".join(c for c in plain if not unicodedata.combining(c)).split())


def _is(one: ListedObject, gallery: str, state: str) -> bool:
    return gallery in ("", one.gallery) and state in ("", one.state)


def _listed(folder: Path) -> Iterator[ListedObject]:
    import pyarrow.parquet as pq

    file = folder / "objects.parquet"
    if not file.is_file():
        raise DeskError(f"{file} is not there, by which the desk finds objects: make the report with `kouros run`")
    with pq.ParquetFile(file) as table:
        for batch in table.iter_batches(columns=list(_COLUMNS)):
            columns: list[list[Any]] = [batch.column(name).to_pylist() for name in _COLUMNS]
            at = _COLUMNS.index("state")
            columns[at] = [State.ASIDE.value if state == NOT_SHOWN else state for state in columns[at]]
            # What has no place among all comes last.
            columns[-1] = [1 << 60 if rank is None else rank for rank in columns[-1]]
            yield from (ListedObject(*row) for row in zip(*columns, strict=True))
