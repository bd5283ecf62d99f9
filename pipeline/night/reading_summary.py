"""Summary of the reading behind the inventory, its refusals and doubts, for programs and in a line."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import chain
from typing import Any

from pipeline.collection.inventory.reading_report import account, doubts
from pipeline.collection.object_index import ObjectIndex
from pipeline.collection.reading import NOWHERE
from pipeline.night.photographs import image_doubts
from pipeline.operations.workspace import Workspace
from pipeline.quantities import counted
from pipeline.records import Doubt, RunRecord
from pipeline.report.pages.reading import IMAGES, INVENTORY, READING

_TOLD = ("field", "message", "remedy")

UNKNOWN = "not known what was refused or is doubted: import again"


def told(workspace: Workspace, index: ObjectIndex) -> dict[str, Any] | None:
    """Return what became of the rows behind the inventory, for JSON; None where that was not noted.

    unsaid : objects that are taken to be on display because neither a column nor a location says what is; else 0
    """
    found = account(workspace.engine, index.version)
    if found is None:
        return None
    stores = any(not run.on_display and run.gallery != NOWHERE for run in index.objects.runs)
    return {
        "source": found.source,
        "rows": found.rows,
        "refused": found.refused,
        "doubtful": found.doubtful,
        "sheets": found.sheets,
        "suspicions": [dict(zip(_TOLD, one, strict=True)) for one in found.suspicions],
        "choices": [dict(zip(_TOLD, one, strict=True)) for one in found.choices],
        "unsaid": 0 if found.flagged or stores else index.objects.shown,
    }


def doubts_of(workspace: Workspace, head: RunRecord) -> Callable[[], Iterable[Doubt]] | None:
    """Return what gives all that was refused or is doubted of the inventory of a run; None where that is not known."""
    if head.settings.get(READING) is None:
        return None
    read = partial(doubts, workspace.engine, int(head.settings[INVENTORY]))
    if not head.settings.get(IMAGES):
        return read
    return lambda: chain(read(), image_doubts(workspace))


def in_line(reading: Mapping[str, Any] | None) -> str:
    """Return how many rows were read, refused and are doubtful, in a line."""
    if reading is None:
        return UNKNOWN
    parts = [counted(reading["rows"], "row"), f"{reading['refused']:,} refused", f"{reading['doubtful']:,} doubtful"]
    if reading["sheets"]:
        parts.append(f"{reading['sheets']:,} not used of sheets")
    if reading.get("images"):
        parts.append(f"{counted(reading['images'], 'photograph')} not shown")
    if reading["suspicions"]:
        parts.append(f"{counted(len(reading['suspicions']), 'doubt')} about the whole file")
    if reading.get("choices"):
        parts.append(f"{len(reading['choices']):,} settled by choice")
    return ", ".join(parts)


def to_look_at(reading: Mapping[str, Any] | None) -> bool:
    """Say whether reading left something that somebody should look at, or nobody knows."""
    return reading is None or any(
        reading.get(name) for name in ("refused", "doubtful", "sheets", "suspicions", "images")
    )


def unsaid(shown: int) -> str:
    """Return that no column says what is on display, or, where nothing is, why and what mends it."""
    if not shown:
        return (
            "nothing is on display, and a night would have nothing to assess: no record says where its object is; "
            'export the current locations, or write constant = "Gallery 1" in place of column under [columns.gallery]'
        )
    return f"no column says what is on display: all {counted(shown, 'object')} are taken to be"
