"""The page in front of all reports: where the last good one is, and whether it is stale."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any
from urllib.parse import quote

from pipeline.report.language import Language, speaking
from pipeline.report.pages.environment import environment, fill
from pipeline.report.text import plain

MARK = "<!-- kouros: landing page -->"
"""What tells this page from one that somebody else put there."""

_MOST = 2000


def landing_page(status: Mapping[str, Any], museum: str, language: Language) -> str:
    """Return the page as HTML.

    status : fields of schemas/status.schema.json
    """
    good = status["last_good"]
    context = {
        "museum": museum,
        "state": status["state"],
        "since": _moment(status["since"]),
        "message": plain(status["message"])[:_MOST],
        "report": "" if good is None else quote(good["report"]),
        "finished": "" if good is None else _moment(good["finished"]),
    }
    with speaking(language):
        return fill(environment(language), "landing.html", context)


def _moment(text: str) -> str:
    try:
        return f"{datetime.fromisoformat(text).astimezone(UTC):%Y-%m-%d %H:%M} UTC"
    except ValueError:
        return ""
