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
from pipeline.event.message import (
    FIRST_SIGMA,
    ReportedEarthquake,
    SiteShaking,
)
from pipeline.event.own_record import OwnRecord, own_record
from pipeline.event.reading import EventFiles, is_same, read_files, with_more
from pipeline.event.reports import STATES, conditioned, read_reports
from pipeline.event.stock import Stock
from pipeline.motions.manifest import load_manifest
from pipeline.night.stocks import run_stock, stock_terms
from pipeline.operations.presentation import presentation
from pipeline.operations.workspace import UsageError, Workspace, folder_of_site
from pipeline.quantities import G
from pipeline.records import Page, RunRecord
from pipeline.report import publish
from pipeline.report.files.event_files import ANSWER, BRIEF, event_document, write_event
from pipeline.report.files.publish import LINK, PAGE
from pipeline.report.pages.compose import page_head
from pipeline.report.text import clean, slug
from pipeline.resources import aside_of, small_text, sweep
from pipeline.store.codec import StoreError
from pipeline.store.pages import load_members
from pipeline.store.reuse import whole_runs
from pipeline.store.runs import load_head
from pipeline.tools.event_waveforms import Modelled, modelled

EVENTS = "events"
"""Folder beside the settings that holds every answer: a folder for each earthquake, in it one for each version."""

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
    """

    answer: Answer | None
    document: Mapping[str, Any]
    folder: Path
    again: bool
    newest: bool

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
        What people found in the galleries, see `read_reports`; what was told of the same earthquake before still holds.
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
    head, pages = load_head(workspace.engine, _newest(workspace))
    own = own_record(told.records, *site) if told.records else None
    shaking, quake, rank = _shaking(told, typed, site, own)
    quake = quake if drill is None else drill
    root = workspace.settings.path(EVENTS)
    whole_event = root / _event_folder(root, quake, clock)
    numbers = _numbers(workspace, pages)
    reports = _earlier_reports(whole_event, numbers)
    if report is not None:
        reports |= read_reports(report, numbers)
    first = whole_event / _version(told, typed, site, head, quake, rank[0], reports)
    folder = first.with_name(f"{first.name}-{MODELLED}") if seconds > 0.0 else first
    newest = rank >= _rank_shown(whole_event)
    if (folder / ANSWER).is_file():
        shown = _shown(whole_event) == folder.name
        if not shown and not dry_run and rank > _rank_shown(whole_event):
            # Who wrote it was stopped before it was shown.
            publish(folder, whole_event)
            shown = True
        return EventDone(None, _kept(folder / ANSWER), folder, again=True, newest=shown)
    terms = stock_terms(workspace, head)
    stock = run_stock(workspace, terms, pages)
    ground = terms.floors[""]
    # The ratio of SI peaks, s, as cm/s for each g.
    shaking = shaking.with_velocity(_in_cm_s_a_g(ground.ratio), ground.ratio_sd)
    places = {numbers[name]: state for name, state in reports.items()}

    def answer(folder: Path, stock: Stock, shaking: SiteShaking, ran: Modelled | None) -> EventDone:
        draws, after = conditioned(stock.capacities, places, shaking, len(stock))
        found = answered(stock, after, workspace.settings.likelihood.sampling, draws, places)
        event = _event(quake, site, rank, after, head, folder, root, ran)
        if not (dry_run or (folder / ANSWER).is_file()):
            _write(folder, workspace, head, found, quake, site, event, newest=newest)
        return EventDone(found, event_document(found, event), folder, again=False, newest=newest)

    done = answer(first, stock, shaking, None)
    if folder == first or done.answer is None:
        return done
    far = quake.distance_km(*site)
    ran = modelled(workspace, pages, done.answer, stock, shaking, quake, own, seconds, distance_km=far)
    told_at = {numbers[name]: chances for name, chances in ran.chances.items()}
    peaks = log(shaking.pga_g * G), log(0.01 * (shaking.pgv_cm_s or 0.0))
    able = stock.capacities.centred(told_at, *peaks, same=ran.same)
    return answer(folder, replace(stock, capacities=able), shaking, ran)


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


def _numbers(workspace: Workspace, pages: Sequence[Page]) -> dict[str, int]:
    """Return the places of objects on display by number, in the order of the stock; no result is read."""
    with workspace.engine.connect() as connection:
        found = [load_members(connection, page.key) for page in pages if page.on_display]
    pairs = [pair for one in found for pair in zip(one.column("object_number"), one.column("on_display"), strict=True)]
    return {number: at for at, number in enumerate(number for number, shown in pairs if shown)}


def _event_folder(root: Path, quake: ReportedEarthquake, now: datetime) -> str:
    """Return the name of an earthquake's folder: one that is there already where another agency sent it."""
    if quake.time is not None and quake.latitude is not None and quake.longitude is not None and root.is_dir():
        for there in sorted(root.iterdir()):
            said = _shown_document(there).get("event", {})
            try:
                time = datetime.fromisoformat(said["time"])
                other = ReportedEarthquake(latitude=said["latitude"], longitude=said["longitude"], time=time)
                apart = quake.apart(other)
            except (KeyError, TypeError, ValueError):
                continue
            if apart is not None and is_same(apart):
                return there.name
    # Of what nobody says when it was, all of one day is one earthquake.
    when = f"{now:%Y%m%d}-" if quake.time is None else f"{quake.time:%Y%m%dT%H%M%S}-"
    return f"{when}{slug(quake.id or quake.name or 'by hand')}"


def _earlier_reports(folder: Path, known: Mapping[str, int]) -> dict[str, str]:
    """Return what was found by object number, as the answer that is shown has it."""
    said = _shown_document(folder).get("reported")
    pairs = said.items() if isinstance(said, dict) else ()
    return {name: state for name, state in pairs if state in STATES and name in known}


def _version(
    told: EventFiles,
    typed: TypedShaking | None,
    site: tuple[float, float],
    head: RunRecord,
    quake: ReportedEarthquake,
    rank: int,
    reports: Mapping[str, str],
) -> str:
    """Return the name of an answer's folder, by all that it depends on: the same again is the same answer."""
    parts = [told.digest, repr(typed), repr(site), head.run_id, head.version, repr(sorted(reports.items()))]
    digest = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:12]
    version = re.sub("[^0-9A-Za-z]", "", quake.version)[:20] or "0"
    return f"{_KINDS[rank]}-{version}-{digest}"


def _shown(folder: Path) -> str:
    """Return the name of the version that an earthquake's folder shows; "" for none."""
    link, page = folder / LINK, folder / PAGE
    if link.is_symlink():
        return link.readlink().name
    # Where links cannot be made a page leads there.
    return small_text(page).partition("url=")[2].partition("/")[0] if page.is_file() else ""


def _shown_document(folder: Path) -> Mapping[str, Any]:
    name = _shown(folder) if folder.is_dir() else ""
    file = folder / name / BRIEF
    return _kept(file) if name and file.is_file() else {}


def _kept(file: Path) -> Mapping[str, Any]:
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise StoreError(f"{file}: an earlier answer that is damaged ({problem}); remove its folder") from problem
    if not isinstance(said, dict):
        raise StoreError(f"{file}: an earlier answer that is damaged; remove its folder")
    return said


def _rank_shown(folder: Path) -> tuple[int, float]:
    said = _shown_document(folder).get("event", {}).get("rank")
    return (int(said[0]), float(said[1])) if isinstance(said, list) and len(said) == 2 else (0, 0.0)


def _event(
    quake: ReportedEarthquake,
    site: tuple[float, float],
    rank: tuple[int, float],
    shaking: SiteShaking,
    head: RunRecord,
    folder: Path,
    root: Path,
    ran: Modelled | None,
) -> dict[str, Any]:
    distance = quake.distance_km(*site)
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
        "site": list(site),
        "rank": list(rank),
        "notes": [clean(note) for note in shaking.notes],
        "modelled": 0 if ran is None else len(ran.chances),
        "modelled_under": "" if ran is None else clean(ran.told),
        "run_id": head.run_id,
        "folder": folder.relative_to(root.parent).as_posix(),
    }


def _write(
    folder: Path,
    workspace: Workspace,
    head: RunRecord,
    found: Answer,
    quake: ReportedEarthquake,
    site: tuple[float, float],
    event: Mapping[str, Any],
    *,
    newest: bool,
) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
    spoken = presentation(workspace.settings)["language"]
    sweep(folder.parent)
    aside = aside_of(folder)
    aside.mkdir()
    try:
        write_event(aside, found, quake, site, event, replace(shown, started=head.started), spoken)
        aside.rename(folder)
    except BaseException:
        # Whoever stops it leaves nothing half written.
        rmtree(aside, ignore_errors=True)
        raise
    if newest:
        publish(folder, folder.parent)
