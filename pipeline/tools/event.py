"""An earthquake has just happened: its messages answered from the newest run, kept by version, and told."""

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import exp, log
from pathlib import Path
from shutil import rmtree
from typing import Any

from pipeline.event.answer import Answer, answered
from pipeline.event.capacities import Stock
from pipeline.event.message import FIRST_SIGMA, ReportedEarthquake, SiteShaking
from pipeline.event.reading import EventFiles, OwnRecord, own_record, read_files, with_more
from pipeline.event.reports import conditioned
from pipeline.motions.manifest import load_manifest
from pipeline.night.stocks import run_stock, stock_terms
from pipeline.operations.report_status import presentation
from pipeline.operations.workspace import UsageError, Workspace, folder_of_site
from pipeline.quantities import G
from pipeline.records import Page, RunRecord
from pipeline.report import publish
from pipeline.report.files.event_files import ANSWER, event_document, write_event
from pipeline.report.pages.compose import page_head
from pipeline.report.text import clean
from pipeline.resources import aside_of, sweep
from pipeline.store.codec import StoreError
from pipeline.store.event_reports import event_reports
from pipeline.store.runs import load_head
from pipeline.store.sound import whole_runs
from pipeline.tools.event_folders import (
    CHANCES,
    EVENTS,
    EventQuestion,
    ReportsTaken,
    event_folder,
    found_states,
    kept_document,
    kept_events,
    known_objects,
    rank_shown,
    shown_name,
    take_reports,
)
from pipeline.tools.event_waveforms import Modelled, modelled

OWN, TYPED = 5, 4
"""How much a record of the museum's own and numbers typed by hand are believed; maps 3, stations 2, alerts 1."""

MODELLED = "models"
"""End of the name of an answer whose most important objects were run again."""

_KINDS = {OWN: "record", TYPED: "typed", 3: "shakemap", 2: "stations", 1: "alert"}


@dataclass(frozen=True)
class TypedShaking:
    """Shaking as a person typed it: g, cm/s, and standard deviation of ln; None where nothing was said."""

    pga_g: float
    pgv_cm_s: float | None = None
    ln_sd: float | None = None

    def shaking(self) -> SiteShaking:
        """Return it as what the ground did.

        Raises
        ------
        UsageError
            For numbers that no shaking has.
        """
        speed, sd = self.pgv_cm_s, FIRST_SIGMA if self.ln_sd is None else self.ln_sd
        if not 1e-4 <= self.pga_g <= 5.0:
            raise UsageError(f"--pga {self.pga_g:g}: in g, from 0.0001 to 5; 14.4 % of g is 0.144")
        if speed is not None and not 1e-2 <= speed <= 1000.0:
            raise UsageError(f"--pgv {speed:g}: in cm/s, from 0.01 to 1000")
        if not 0.0 <= sd <= 3.0:
            raise UsageError(f"--ln-sd {sd:g}: standard deviation of the natural logarithm, from 0 to 3, such as 0.3")
        note = f"Nobody says how sure these numbers are: taken to be as a first alert, {sd:g} of ln (judgement)."
        return SiteShaking(self.pga_g, speed, sd, sd, "typed by hand", () if self.ln_sd is not None else (note,))


@dataclass(frozen=True)
class EventDone:
    """What became of a message.

    Attributes
    ----------
    answer : Answer or None
        None where the same was answered before.
    document : mapping
        The answer for programs (contract of `kouros event --json`).
    folder : Path
        Of this version of the answer.
    again : bool
        Whether the same was answered before, so that nothing was done.
    newest : bool
        Whether it is the answer that is shown: not where something that is believed more was answered before.
    taken : ReportsTaken or None
        What was taken of a file of reports; None where there was none.
    """

    answer: Answer | None
    document: Mapping[str, Any]
    folder: Path
    again: bool
    newest: bool
    taken: ReportsTaken | None = None

    @property
    def sentence(self) -> str:
        """The answer in a sentence."""
        down, quake = self.document["expected"], self.document["event"]
        name = quake["name"] or quake["id"] or "an earthquake"
        return (
            f"After {name}: of {len(self.document['objects']):,} objects on display about {down['fallen']:,.0f} have "
            f"probably fallen ({down['low']:,} to {down['high']:,} in 9 of 10 cases)."
        )


def answer_event(
    workspace: Workspace,
    files: Sequence[Path],
    *,
    at: tuple[float, float] | None = None,
    typed: TypedShaking | None = None,
    report: Path | None = None,
    drill: ReportedEarthquake | None = None,
    now: datetime | None = None,
    seconds: float = 0.0,
    dry_run: bool = False,
) -> EventDone:
    """Answer the files about one earthquake from the newest run of the whole collection.

    First as its results tell, which takes no model; then, as far as there is time, with those objects of which most is
    lost run again under the motions of the earthquake.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    files : sequence of Path
        Messages and records.
    at : (float, float) or None
        Place of the museum, degrees north and east; None: as its site's manifest says.
    typed : TypedShaking or None
        Numbers typed by hand; they go before messages, and after the museum's own record.
    report : Path or None
        What people found in the galleries, see `read_found`; what was told of the same earthquake before still holds.
    drill : ReportedEarthquake or None
        What the page is to say of an exercise, with the numbers typed.
    now : datetime or None
        By the clock; None: this machine's.
    seconds : float
        For running the models of the objects that matter most under the motions of the earthquake, after an answer
        without them is there; 0: that is not done.
    dry_run : bool
        Write nothing.

    Raises
    ------
    MessageError
        For a message that cannot be used; what was answered before stays.
    MotionError
        For a record that cannot be used.
    UsageError
        Where neither a file nor a number is given, or nobody says where the museum is.
    StoreError
        Where there is no run yet.
    """
    if not files and typed is None:
        raise UsageError("give a file about the earthquake, or its shaking by --pga and --pgv")
    clock = now or datetime.now(UTC)
    told = read_files(files, clock)
    site = _site(workspace, at)
    run = _Run(workspace)
    own = own_record(told.records, *site) if told.records else None
    shaking, quake, rank = _shaking(told, typed, site, own)
    quake = quake if drill is None else drill
    source = hashlib.sha256("\n".join((told.digest, repr(typed), repr(site))).encode()).hexdigest()
    question = EventQuestion(quake, site, rank, shaking, source)
    name = event_folder(workspace.settings.path(EVENTS), quake, clock)
    known, taken, found = run.found(name, report, dry_run=dry_run)
    first = run.root / name / _version(question, run.head, found)
    folder = first.with_name(f"{first.name}-{MODELLED}") if seconds > 0.0 else first
    there = _there(folder, rank, dry_run=dry_run)
    if there is not None:
        return replace(there, taken=taken)
    terms = stock_terms(workspace, run.head)
    stock = run_stock(workspace, terms, run.pages)
    ground = terms.floors[""]
    # The ratio of SI peaks, s, as cm/s for each g.
    question = replace(question, shaking=shaking.with_velocity(_in_cm_s_a_g(ground.ratio), ground.ratio_sd))
    places = {known[number]: state for number, state in found.items()}
    done = _answered(run, question, first, stock, places, None, dry_run=dry_run)
    if folder != first and done.answer is not None:
        far = quake.distance_km(*site)
        ran = modelled(workspace, run.pages, done.answer, stock, question.shaking, quake, own, seconds, distance_km=far)
        done = _answered(run, question, folder, _refined(stock, known, question, ran), places, ran, dry_run=dry_run)
    return replace(done, taken=taken)


def answer_again(
    workspace: Workspace, event: str = "", *, report: Path | None = None, dry_run: bool = False
) -> EventDone:
    """Answer an earthquake anew by what was found, without its messages: no model is run, and those that were count.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    event : str
        Name of the earthquake's folder; "" for the one that was answered last.
    report : Path or None
        What people found, as of `answer_event`.
    dry_run : bool
        Write nothing.

    Raises
    ------
    UsageError
        Where no such earthquake was answered.
    StoreError
        Where there is no run any more, or the earlier answer is damaged.
    """
    root = workspace.settings.path(EVENTS)
    kept = next((one for one in kept_events(root) if event in ("", one.name)), None)
    if kept is None:
        raise UsageError("no earthquake was answered yet: give a file about it, or its shaking by --pga and --pgv")
    try:
        question = EventQuestion.of_packed(kept.brief["question"])
    except (KeyError, TypeError, ValueError) as problem:
        raise StoreError(f"{kept.folder}: an earlier answer that is damaged; give its message again") from problem
    run = _Run(workspace)
    known, taken, found = run.found(kept.name, report, dry_run=dry_run)
    ran = _kept_chances(kept.folder / CHANCES) if kept.brief["event"].get("run_id") == run.head.run_id else None
    folder = run.root / kept.name / _version(question, run.head, found)
    folder = folder if ran is None else folder.with_name(f"{folder.name}-{MODELLED}")
    there = _there(folder, question.rank, dry_run=dry_run, replacing=True)
    if there is not None:
        return replace(there, taken=taken)
    stock = run_stock(workspace, stock_terms(workspace, run.head), run.pages)
    places = {known[number]: state for number, state in found.items()}
    able = stock if ran is None else _refined(stock, known, question, ran)
    return replace(_answered(run, question, folder, able, places, ran, dry_run=dry_run), taken=taken)


class _Run:
    """The newest run of the whole collection, and where answers from it go."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.head, self.pages = load_head(workspace.engine, _newest(workspace))
        self.root = workspace.settings.path(EVENTS)

    def found(
        self, event: str, report: Path | None, *, dry_run: bool
    ) -> tuple[dict[str, int], ReportsTaken | None, dict[str, str]]:
        """Return the places of objects by number, what was taken of a file of reports, and all that is known by now."""
        known = known_objects(self.workspace, self.pages)
        if report is None:
            return known, None, found_states(event_reports(self.workspace.engine, event), known)
        return known, *take_reports(self.workspace, event, report, known, dry_run=dry_run)


def _there(folder: Path, rank: tuple[int, float], *, dry_run: bool, replacing: bool = False) -> EventDone | None:
    """Return an answer that is there already; None where it is not."""
    if not (folder / ANSWER).is_file():
        return None
    shown = shown_name(folder.parent) == folder.name
    before = rank_shown(folder.parent)
    if not (shown or dry_run) and (rank > before or (replacing and rank == before)):
        # Who wrote it was stopped before it was shown; or what was found is as it was once before.
        publish(folder, folder.parent)
        shown = True
    return EventDone(None, kept_document(folder / ANSWER), folder, again=True, newest=shown)


def _answered(
    run: _Run,
    question: EventQuestion,
    folder: Path,
    stock: Stock,
    places: Mapping[int, str],
    ran: Modelled | None,
    *,
    dry_run: bool,
) -> EventDone:
    """Answer, and write that into its folder."""
    newest = question.rank >= rank_shown(folder.parent)
    draws, after = conditioned(stock.capacities, places, question.shaking, len(stock))
    found = answered(stock, after, run.workspace.settings.likelihood.sampling, draws, places)
    event = _event(question, after, run.head, folder, run.root, ran)
    if not (dry_run or (folder / ANSWER).is_file()):
        _write(folder, run, found, question, event, ran, newest=newest)
    return EventDone(found, event_document(found, event), folder, again=False, newest=newest)


def _refined(stock: Stock, known: Mapping[str, int], question: EventQuestion, ran: Modelled) -> Stock:
    """Return the stock with what models found of some objects."""
    shaking = question.shaking
    told_at = {known[number]: chances for number, chances in ran.chances.items() if number in known}
    peaks = log(shaking.pga_g * G), log(0.01 * (shaking.pgv_cm_s or 0.0))
    return replace(stock, capacities=stock.capacities.centred(told_at, *peaks, same=ran.same))


def _kept_chances(file: Path) -> Modelled | None:
    if not file.is_file():
        return None
    said = kept_document(file)
    try:
        return Modelled(dict(said["chances"]), str(said["told"]), bool(said["same"]))
    except (KeyError, TypeError, ValueError) as problem:
        raise StoreError(f"{file}: is damaged; remove it") from problem


def exercise(workspace: Workspace) -> tuple[TypedShaking, ReportedEarthquake]:
    """Return the shaking of an exercise: that of the strongest level of the newest run, within 0.3 of ln (judgement).

    Raises
    ------
    StoreError
        Where there is no run yet.
    """
    head = load_head(workspace.engine, _newest(workspace))[0]
    levels = stock_terms(workspace, head).floors[""].levels
    name, (pga, pgv) = max(levels.items(), key=lambda one: one[1])
    return TypedShaking(exp(pga) / G, 100.0 * exp(pgv), 0.3), ReportedEarthquake(
        name=f"Exercise: {name}", scenario=True
    )


def _newest(workspace: Workspace) -> str:
    whole = whole_runs(workspace.engine)
    if not whole:
        raise StoreError("there is no finished run of the whole collection to answer from; make one with `kouros run`")
    return whole[0]


def _site(workspace: Workspace, at: tuple[float, float] | None) -> tuple[float, float]:
    if at is not None:
        return at
    site = load_manifest(folder_of_site(workspace.settings, None), begun=True).site
    if (site.latitude, site.longitude) == (0.0, 0.0):
        raise UsageError("the site's manifest does not say where the museum is: give --at LAT,LON")
    return site.latitude, site.longitude


def _shaking(
    told: EventFiles, typed: TypedShaking | None, site: tuple[float, float], own: OwnRecord | None
) -> tuple[SiteShaking, ReportedEarthquake, tuple[int, float]]:
    quake = told.quake
    version = quake.version_number
    if own is not None:
        return own.shaking, with_more(quake, own.quake), (OWN, version)
    if typed is not None:
        return typed.shaking(), quake, (TYPED, version)
    return told.messages[0].at(*site), quake, (told.messages[0].rank, version)


def _in_cm_s_a_g(ratio: float) -> float:
    return 100.0 * exp(ratio) * G


def _version(question: EventQuestion, head: RunRecord, found: Mapping[str, str]) -> str:
    """Return the name of an answer's folder, by all that it depends on: the same again is the same answer."""
    parts = [question.source, head.run_id, head.version, repr(sorted(found.items()))]
    digest = hashlib.sha256("\n".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:12]
    version = re.sub("[^0-9A-Za-z]", "", question.quake.version)[:20] or "0"
    return f"{_KINDS[question.rank[0]]}-{version}-{digest}"


def _event(
    question: EventQuestion,
    shaking: SiteShaking,
    head: RunRecord,
    folder: Path,
    root: Path,
    ran: Modelled | None,
) -> dict[str, Any]:
    quake = question.quake
    distance = quake.distance_km(*question.site)
    return {
        "id": clean(quake.id),
        "name": clean(quake.name),
        "magnitude": quake.magnitude,
        "time": None if quake.time is None else quake.time.isoformat(),
        "latitude": quake.latitude,
        "longitude": quake.longitude,
        "depth_km": quake.depth_km,
        "distance_km": None if distance is None else round(distance, 1),
        "version": clean(quake.version),
        "scenario": quake.scenario,
        "site": list(question.site),
        "rank": list(question.rank),
        "notes": [clean(note) for note in shaking.notes],
        "modelled": 0 if ran is None else len(ran.chances),
        "modelled_under": "" if ran is None else clean(ran.told),
        "run_id": head.run_id,
        "folder": folder.relative_to(root.parent).as_posix(),
    }


def _write(
    folder: Path,
    run: _Run,
    found: Answer,
    question: EventQuestion,
    event: Mapping[str, Any],
    ran: Modelled | None,
    *,
    newest: bool,
) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    head = run.head
    shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
    spoken = presentation(run.workspace.settings)["language"]
    sweep(folder.parent)
    aside = aside_of(folder)
    aside.mkdir()
    try:
        write_event(aside, found, question.quake, question.site, event, replace(shown, started=head.started), spoken,
                    question.packed())  # fmt: skip
        if ran is not None:
            said = {"told": ran.told, "same": ran.same, "chances": ran.chances}
            (aside / CHANCES).write_text(json.dumps(said, allow_nan=False), encoding="utf-8")
        aside.rename(folder)
    except BaseException as problem:
        # Whoever stops it leaves nothing half written.
        rmtree(aside, ignore_errors=True)
        if not (isinstance(problem, OSError) and (folder / ANSWER).is_file()):
            raise
        # Somebody else has answered the same meanwhile.
    if newest:
        publish(folder, folder.parent)
