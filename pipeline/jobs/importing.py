"""The museum's export -> Kouros's inventory."""

from dataclasses import dataclass
from pathlib import Path

from pipeline.collection.inventory import Counts, replace_inventory
from pipeline.collection.mapping import load_mapping, preset_names
from pipeline.collection.reading import Reading, read_items
from pipeline.jobs.workspace import Workspace
from pipeline.records import Item, Problem


@dataclass(frozen=True)
class Imported:
    """What an import read, and what it changed (None for a dry run)."""

    reading: Reading
    counts: Counts | None

    @property
    def problems(self) -> list[tuple[Item, Problem]]:
        """Return every value that could not be accepted, with its object."""
        return [(item, problem) for item in self.reading.items for problem in item.problems]


def bundled_collection() -> Path:
    """Return the file of the bundled Carnegie rows."""
    return Path(__file__).resolve().parents[1] / "collection" / "data" / "carnegie_2000.csv"


def import_collection(
    workspace: Workspace, source: Path, mapping: str, *, shrink_limit: float, dry_run: bool = False
) -> Imported:
    """Read a museum's file and make the inventory what it says, all of it or nothing."""
    named = mapping if mapping in preset_names() else workspace.settings.path(mapping)
    reading = read_items(source, load_mapping(named))
    if dry_run:
        return Imported(reading, None)
    return Imported(reading, replace_inventory(workspace.engine, reading, shrink_limit=shrink_limit))
