"""The page in front of all reports: where the last good one is, what changed, and whether it is stale."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta, tzinfo
from typing import Any
from urllib.parse import quote
from zoneinfo import ZoneInfo

from pipeline.report.language import Language, moment, speaking
from pipeline.report.pages.environment import environment, fill, script_of
from pipeline.report.pages.news import NewsView, kept_view
from pipeline.report.pages.views import StateCounts
from pipeline.report.text import plain

MARK = "<!-- kouros: landing page -->"
"""What tells this page from one that somebody else put there."""

DAYS = 14
"""Days of the row of nights."""

LATE_HOURS = 36
"""Hours without a good night after which the page is red."""

LONG_HOURS = 12
"""Hours after which a run that has not ended was interrupted: no night lasts until the next evening (judgement)."""

_MOST = 2000


@dataclass(frozen=True, slots=True)
class Moment:
    """A moment for people and for programs: "2026-11-24 03:10 CET", and ISO 8601 in UTC; both "" where not known."""

    text: str = ""
    iso: str = ""


@dataclass(frozen=True, slots=True)
class DayView:
    """What became of the night of a day.

    Attributes
    ----------
    day : str
        ISO 8601.
    state : str
        Of its last run: "good", "failed", "interrupted"; "" where there was none.
    again : bool
        Whether it was good only after another run of that day was not.
    """

    day: str
    state: str = ""
    again: bool = False


def landing_page(status: Mapping[str, Any], museum: str, language: Language, time_zone: str = "UTC") -> str:
    """Return the page as HTML.

    Parameters
    ----------
    status : mapping
        Fields of schemas/status.schema.json.
    museum : str
        Its name.
    language : Language
        Of the page.
    time_zone : str
        In which times are told, by its name in the IANA database.
    """
    zone = UTC if time_zone == "UTC" else ZoneInfo(time_zone)
    good = status["last_good"]
    with speaking(language):
        context = {
            "museum": museum,
            "state": status["state"],
            "since": _moment(status["since"], zone),
            "message": plain(status["message"])[:_MOST],
            "fault": status.get("fault", False),
            "report": "" if good is None else quote(good["report"]),
            "beside": "" if good is None else quote(good["report"].rpartition("/")[0]),
            "finished": Moment() if good is None else _moment(good["finished"], zone),
            "counts": None if good is None else _counts(good.get("counts")),
            "news": None if good is None else _news(good.get("news"), zone),
            "days": days(status.get("nights", ()), zone),
            "late": LATE_HOURS,
            "long": LONG_HOURS,
        }
        return fill(environment(language), "landing.html", {**context, **script_of("landing")})


def _moment(text: str, zone: tzinfo) -> Moment:
    found = _read(text)
    return Moment() if found is None else Moment(told(found, zone), found.astimezone(UTC).isoformat(timespec="seconds"))


def told(when: datetime, zone: tzinfo) -> str:
    """Return a moment as people of a time zone say it; where its hours have no name of their own, with the offset."""
    local = when.astimezone(zone)
    name = local.tzname() or ""
    return f"{moment(local.isoformat())} {f'UTC{name}' if name[:1] in ('+', '-') else name}".strip()


def _read(text: str) -> datetime | None:
    try:
        found = datetime.fromisoformat(text)
        return (found.replace(tzinfo=UTC) if found.tzinfo is None else found).astimezone(UTC)
    except (ValueError, TypeError, OverflowError):
        return None


def _counts(counts: Mapping[str, int] | None) -> StateCounts | None:
    names = ("act", "watch", "unknown", "fine")
    try:
        return None if counts is None else StateCounts(**{name: int(counts[name]) for name in names})
    except (KeyError, TypeError, ValueError):
        return None


def _news(kept: Mapping[str, Any] | None, zone: tzinfo) -> tuple[NewsView, str] | None:
    """Return the news that a status keeps, and since when; None where there is none, or where it cannot be read."""
    if kept is None:
        return None
    try:
        view = kept_view(kept)
    except (KeyError, TypeError, ValueError, AttributeError):
        return None
    return view, _moment(view.before, zone).text


def days(nights: Sequence[Mapping[str, str]], zone: tzinfo) -> tuple[DayView, ...]:
    """Return what became of the last days that had a run, and of the days between them, the oldest first.

    A run belongs to the day on which it began, where the museum is. Days behind that of the last run are of a clock
    that was wrong.
    """
    by_day: dict[date, list[str]] = {}
    last = date.min
    for night in nights:
        began = _read(night.get("began", ""))
        if began is not None and night.get("state") in ("good", "failed", "interrupted"):
            last = began.astimezone(zone).date()
            by_day.setdefault(last, []).append(night["state"])
    if not by_day:
        return ()
    first = max(min(by_day), last - timedelta(DAYS - 1))
    found = []
    for at in range((last - first).days + 1):
        day = first + timedelta(at)
        states = by_day.get(day, [""])
        again = states[-1] == "good" and any(state != "good" for state in states)
        found.append(DayView(day.isoformat(), states[-1], again))
    return tuple(found)
