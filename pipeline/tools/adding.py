"""Records added to a site: asked for, tried, written, shown, and set beside what the museum uses now."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from pipeline.motions.candidates import Unusable
from pipeline.motions.errors import MotionError
from pipeline.motions.gathering import GatheredFiles, gather
from pipeline.motions.manifest import MANIFEST, Manifest, load_manifest
from pipeline.motions.placing import DESIGN, PlacedRecords, changed, commit, opened, plan
from pipeline.motions.proposing import Answers, MissingAnswer, RecordProposal, propose
from pipeline.motions.record import StationTable
from pipeline.motions.site import read_site
from pipeline.operations.workspace import UsageError, site_folder
from pipeline.quantities import counted
from pipeline.records import Progress
from pipeline.resources import aside_of

if TYPE_CHECKING:
    from pipeline.report import Units
    from pipeline.settings import Settings
    from pipeline.tools.compare_motions import Swap

SHOWN = 12
"""Records that the page of before and after shows at most."""

Ask = Callable[[Sequence[MissingAnswer], Answers], Answers]
"""What puts questions to a person, and returns the answers with those that were there."""


@dataclass(frozen=True)
class AddWish:
    """What is asked for.

    Attributes
    ----------
    answers : Answers
        What was said on the command line.
    accept : mapping of str to str
        Why refusals that are a matter of judgement are overruled, by their names; under "" that of all others.
    latitude, longitude : float or None
        Of a site that is new.
    guess : bool
        Take what can be used, and say of the rest why not; otherwise one that cannot be used stops all.
    compare : bool
        Set the site beside what the museum uses now.
    """

    answers: Answers
    accept: Mapping[str, str] = field(default_factory=dict)
    latitude: float | None = None
    longitude: float | None = None
    guess: bool = False
    compare: bool = True


@dataclass(frozen=True, eq=False)
class Addition:
    """What was made of files.

    Attributes
    ----------
    file : Path
        The manifest.
    new : bool
        Whether the site is.
    placed : sequence of PlacedRecords
        The records that were added.
    measures : mapping of str to mapping
        Of each of them by name, its peaks [SI].
    already : sequence of (str, str)
        Proposals that the site has, and the records that they are.
    left : sequence of Unusable
        What was not added, and why.
    passed_over : sequence of str
        Files that were not looked into.
    told : sequence of str
        What a person has to know of the site.
    withdrawn : str
        Who had approved the level; "" where nobody had.
    page : Path or None
        The page of before and after.
    swap : Swap or None
        What changes for the museum.
    """

    file: Path
    new: bool
    placed: Sequence[PlacedRecords]
    measures: Mapping[str, Mapping[str, float]]
    already: Sequence[tuple[str, str]]
    left: Sequence[Unusable]
    passed_over: Sequence[str]
    told: Sequence[str]
    withdrawn: str
    page: "Path | None"
    swap: "Swap | None"


def add(
    files: Sequence[Path],
    folder: Path,
    wish: AddWish,
    *,
    settings: "Settings | None",
    units: "Units",
    page: Path | None,
    ask: Ask | None,
    progress: Progress,
    dry_run: bool = False,
) -> Addition:
    """Add records to a site, and make it where there is none.

    Parameters
    ----------
    files : sequence of Path
        Files of records, folders of them, and StationXML, QuakeML, GeoJSON and PEER's search tables beside them.
    folder : Path
        Of the site.
    wish : AddWish
        What is asked for.
    settings : Settings or None
        Of the museum.
    units : Units
        Of the page.
    page : Path or None
        Where the page is written to; None: into the site's folder.
    ask : callable or None
        What asks a person; None where nobody can be asked.
    progress : Progress
        Is told what is done, of how much.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Addition

    Raises
    ------
    UsageError
        Where something is not known and nobody can be asked: it names every missing answer with its option.
    MotionError
        For a site or a record that cannot be used; then nothing was written.
    """
    if folder.name == MANIFEST:
        folder = folder.parent
    before, known = opened(folder)
    there = frozenset() if known is None else frozenset((folder / n).resolve() for n in _named(known))
    with TemporaryDirectory(prefix="kouros-add-") as scratch:
        progress.step("files", 0, 1)
        found = gather(files, leave=there if _inside(files, folder) else frozenset(), scratch=Path(scratch))
        progress.step("files", 1, 1)
        answers, proposals, left, missing = _answered(found, wish, known, ask)
        level = answers.level or _level(known)
        if wish.guess:
            asked = [q for q in missing if q.about == "level"]
            left += [
                Unusable(one.name, "; ".join(f"{q.text}: {q.option}" for q in one.questions))
                for one in proposals
                if one.questions
            ]
            proposals = [one for one in proposals if not one.questions]
            missing = asked
        if missing:
            raise UsageError(_listed(missing))
        if wish.answers.name and len(proposals) > 1:
            names = ", ".join(one.name for one in proposals)
            raise UsageError(f"--name is for one record, and the files hold {len(proposals)}: {names}")
        _nothing_wrong(proposals, left, found, guess=wish.guess)
        made = plan(folder, level, proposals, wish.accept, before, known, keep=0 if dry_run else SHOWN)
        left = [*left, *found.unusable, *(Unusable(name, str(problem)) for name, problem in made.refused)]
        _clash(wish, made.level, made.already, known)
        if made.refused and not wish.guess:
            raise _refused([(name, str(problem)) for name, problem in made.refused], usable=len(made.placed))
        if not made.placed and not made.already:
            raise _refused([(one.name, one.reason) for one in left])
        place = _place(wish, found.catalogues.site, folder)
        told = _told(place, new=before is None)
        overruled = {name for one in made.placed for name in one.record.accept}
        told += [f"nothing was refused for {name}: --accept {name} was not needed" for name in wish.accept
                 if name and name not in overruled]  # fmt: skip
        file = folder / MANIFEST
        result = Addition(file, before is None, made.placed, {}, made.already, left, found.passed_over, told,
                          made.withdrawn, None, None)  # fmt: skip
        text = changed(made, place) if made.placed else None
        if dry_run or text is None:
            if text is None:
                read_site(folder, kept=None if settings is None else settings.kept)
            return result
        commit(made, text)
        return _shown(result, folder, before, wish, settings, units, page, progress)


def _answered(
    found: GatheredFiles, wish: AddWish, known: Manifest | None, ask: Ask | None
) -> tuple[Answers, list[RecordProposal], list[Unusable], list[MissingAnswer]]:
    """Return the answers with those of a person, what they make of the files, and which are missing all the same."""
    answers, level = wish.answers, wish.answers.level
    proposals, left = propose(found, answers)
    missing = _missing(proposals, known, level)
    if missing and ask is not None and not wish.guess:
        answers = ask(missing, answers)
        proposals, left = propose(found, answers)
        # Which channels of many is known before the rest can be asked.
        more = [q for q in _missing(proposals, known, level) if q.about not in {"level", "channels"}]
        if more:
            answers = ask(more, answers)
            proposals, left = propose(found, answers)
        missing = _missing(proposals, known, level)
    return answers, proposals, left, missing


def _named(manifest: Manifest) -> list[str]:
    return [name for _, record in manifest.records() for name in record.all_files]


def _inside(files: Sequence[Path], folder: Path) -> bool:
    """Whether a folder was given that has the site in it: then what it has is not asked for again."""
    whole = folder.resolve()
    return any(path.is_dir() and whole.is_relative_to(path.resolve()) for path in files)


def _missing(proposals: Sequence[RecordProposal], known: Manifest | None, level: str) -> list[MissingAnswer]:
    asked = [question for one in proposals for question in one.questions]
    if not level and known is not None and len(known.level) > 1 and proposals:
        names = ", ".join(one.name for one in known.level)
        text = f"The site has {len(known.level)} levels of shaking ({names}).  To which do the records belong?"
        asked.append(
            MissingAnswer("all records", "level", text, "--level NAME", tuple(one.name for one in known.level))
        )
    return asked


def _level(known: Manifest | None) -> str:
    return known.level[0].name if known is not None and len(known.level) == 1 else DESIGN


def _listed(missing: Sequence[MissingAnswer]) -> str:
    lines = [f"{one.record}: {one.text}\n    {one.option}" for one in missing]
    return f"{counted(len(missing), 'answer')} missing, and nobody to ask:\n  " + "\n  ".join(lines)


def _nothing_wrong(
    proposals: Sequence[RecordProposal], left: Sequence[Unusable], found: GatheredFiles, *, guess: bool
) -> None:
    """Refuse files that are no records where each was named, and files among which there is no record at all.

    A velocity or a spectrum is left out beside its accelerations; where a vertical is missing, it may be that.
    """
    every, passed_over = [*left, *found.unusable], found.passed_over
    flat = any(one.record is not None and one.record.vertical == "absent" for one in proposals)
    wrong = [one for one in every if not one.chosen or (flat and one in found.unusable)]
    if not proposals or (wrong and not guess):
        told = [(one.name, one.reason) for one in (wrong or every)]
        why = f" ({'; '.join(passed_over[:5])})" if passed_over else ""
        raise _refused(told or [("files", f"there is no record among them{why}")])


def _refused(told: Sequence[tuple[str, str]], usable: int = 0) -> MotionError:
    lines = [f"{name}: {why}" for name, why in told[:20]]
    more = [f"and {len(told) - 20} more"] if len(told) > 20 else []
    hint = [f"{counted(usable, 'record')} can be used: --guess adds what can"] if usable else []
    return MotionError("nothing was added: " + "\n  ".join([*lines, *more, *hint]))


def _clash(wish: AddWish, level: str, already: Sequence[tuple[str, str]], known: Manifest | None) -> None:
    """Refuse to put a record into a second level: its entry there is a person's to write."""
    if known is None or not wish.answers.level:
        return
    for _, name in already:
        of = next((one.name for one in known.level if name in {r.name for r in one.record}), level)
        if of != level:
            wrong = f"the site has this record already, as {name!r} at the level {of!r}"
            raise MotionError(f"{name}: {wrong}; copy its entry in the manifest under another name for {level!r}")


def _place(wish: AddWish, said: Sequence[StationTable], folder: Path) -> StationTable:
    one = said[0] if said else StationTable()
    place = {"latitude": wish.latitude, "longitude": wish.longitude}
    return one.model_copy(
        update={"name": one.name or folder.resolve().name} | {k: v for k, v in place.items() if v is not None}
    )


def _told(place: StationTable, *, new: bool) -> list[str]:
    if not new or (place.latitude is not None and place.longitude is not None):
        return []
    return ["nobody has said where the site is: put the museum's latitude and longitude into the manifest"]


def _shown(
    result: Addition,
    folder: Path,
    before: str | None,
    wish: AddWish,
    settings: "Settings | None",
    units: "Units",
    page: Path | None,
    progress: Progress,
) -> Addition:
    """Read the site as a night does, draw the page of the new records, and compare."""
    from pipeline.motions.inspection import inspect
    from pipeline.report.pages.record_page import render_record

    names = [one.name for one in result.placed]
    measures: dict[str, Mapping[str, float]] = {}
    if len(load_manifest(folder).records()) > min(len(names), SHOWN):
        # What is not looked at below.
        site = read_site(folder, kept=None if settings is None else settings.kept)
        measures = {m.motion.name: m.measures for level in site.levels for m in level.motions if m.motion.name in names}
    looked = []
    for number, one in enumerate(result.placed[:SHOWN]):
        progress.step("records", number, len(names[:SHOWN]))
        looked += inspect(folder, one.name, done=one.done)
    measures |= {one.motion.name: one.measures for one in looked}
    progress.step("records", len(looked), len(looked))
    drawn = render_record(looked, folder / "added.html" if page is None else page, units)
    swap, told = None, list(result.told)
    if len(names) > SHOWN:
        told.append(f"the page shows the first {SHOWN} records; `kouros motions show` draws all")
    if wish.compare:
        try:
            swap = _compared(folder, before, settings, progress)
        except MotionError as problem:
            told.append(f"nothing was compared: {problem}")
    return replace(result, measures=measures, page=drawn, swap=swap, told=told)


def _compared(folder: Path, before: str | None, settings: "Settings | None", progress: Progress) -> "Swap | None":
    """Set the site beside the one that the museum uses, or beside itself as it was; None where that has no records."""
    from pipeline.tools.compare_motions import compare_sites

    own = None if settings is None else site_folder(settings.home, settings.site.folder)
    other = own is not None and own.resolve() != folder.resolve() and (own / MANIFEST).is_file()
    if own is not None and other and load_manifest(own, begun=True).level:
        return compare_sites(own, folder, settings, progress)
    if before is None:
        return None
    old = aside_of(folder / MANIFEST)
    try:
        old.write_text(before, encoding="utf-8")
        if not load_manifest(old, begun=True).level:
            return None
        swap = compare_sites(old, folder, settings, progress)
    finally:
        old.unlink(missing_ok=True)
    return replace(swap, old=f"{swap.old.partition(' (')[0]} (as it was)")


def described(one: Addition) -> dict[str, Any]:
    """Return what was made of files as plain values for programs; peaks in SI."""
    return {
        "manifest": str(one.file),
        "new": one.new,
        "added": [
            {
                "name": placed.name,
                "level": placed.level,
                "told": list(placed.told),
                "doubts": list(placed.doubts),
                **{key: one.measures[placed.name][key] for key in ("pga", "pgv", "pgd") if placed.name in one.measures},
                **placed.record.model_dump(mode="json", exclude_none=True, include=_KEYS),
            }
            for placed in one.placed
        ],
        "already": [{"name": name, "record": record} for name, record in one.already],
        "left": [{"name": left.name, "reason": left.reason} for left in one.left],
        "passed_over": list(one.passed_over),
        "told": list(one.told),
        "approval_withdrawn": one.withdrawn,
        "page": one.page and str(one.page),
        "compared": one.swap and asdict(one.swap),
    }


_KEYS = {"files", "response", "components", "units", "processed", "vertical", "scale", "event", "station",
         "distance_km", "source", "licence", "sha256"}  # fmt: skip
