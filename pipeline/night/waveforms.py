"""Objects under the very motion of an earthquake: all their models, as in a night, the ones that matter most first.

Samples are drawn as for the levels of the site (`pipeline.analysis.likelihood`), with the motion or motions of the
earthquake in their place; no advice, no curves and no verdicts are found.  It goes on until all are done or the time is
up.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from time import perf_counter

from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.cache import Cache
from pipeline.execute import Threads
from pipeline.mitigate.installed import stood_of
from pipeline.models.band import sharing_spectra
from pipeline.motions.manifest import GROUND_FLOOR
from pipeline.motions.site import Site, levels_at
from pipeline.night.assessment import place
from pipeline.night.floors import floor_name
from pipeline.operations.workspace import Workspace
from pipeline.records import Item, Likelihood, Page, Sampling
from pipeline.store.decisions import decisions_in_force
from pipeline.store.pages import load_members

FIRST, GROWTH = 8, 3
"""Objects of the first part, and how many times as many the next one is: together they take less each."""

Shaken = Callable[[str], LevelMotions | None]
"""The shaking of a floor by its name, "" for the ground; None where nobody knows it."""


def shaken_by(site: Site, name: str, x_azimuth: float) -> Shaken:
    """Return the shaking of each floor when the ground of a site does what its one level says.

    Parameters
    ----------
    site : Site
        The museum's, with the motions of the earthquake in place of its own.
    name : str
        What the shaking is called.
    x_azimuth : float
        Of the x axis of its motions, degrees clockwise from north.
    """
    known: dict[str, LevelMotions | None] = {}

    def of(floor: str) -> LevelMotions | None:
        if floor not in known:
            # What was recorded on a floor in other earthquakes says nothing of this one.
            recorded = any(table.records for table in site.manifest.floor if table.name == floor)
            if recorded:
                known[floor] = None
            else:
                level = levels_at(site, floor or GROUND_FLOOR)[0]
                motions = tuple(one.motion for one in level.motions)
                known[floor] = LevelMotions(name, "max", motions, x_azimuth)
        return known[floor]

    return of


def under(
    workspace: Workspace,
    pages: Sequence[Page],
    numbers: Sequence[str],
    shaken: Shaken,
    sampling: Sampling,
    until: float,
) -> dict[str, Likelihood]:
    """Return how likely objects came to harm under a motion, as many of them as there is time for.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    pages : sequence of Page
        Of the run whose records are used.
    numbers : sequence of str
        Of the objects, those that matter most first.
    shaken : Shaken
        The motion by floor.
    sampling : Sampling
        How many samples.
    until : float
        By `perf_counter`: when to stop; what was begun is ended.

    Returns
    -------
    dict of str to Likelihood
        By object number; one for which no model is run is not in it.
    """
    settings = workspace.settings
    executor = Threads(settings.analysis.workers or Threads().workers)
    about = decisions_in_force(workspace.engine)
    items = _items(workspace, pages, set(numbers))
    found: dict[str, Likelihood] = {}
    with sharing_spectra(Cache(settings.kept)):
        for part in _parts(numbers, until):
            by_floor: dict[str, list[Item]] = {}
            for number in part:
                if number in items:
                    by_floor.setdefault(floor_name(settings, items[number].gallery), []).append(items[number])
            for floor, those in by_floor.items():
                level = shaken(floor)
                if level is None:
                    continue
                stands = [
                    place(item, workspace.rules, about.get(item.object_number, ()), workspace.measures, workspace.house)
                    for item in those
                ]
                told = likelihoods(stood_of(stands), len(stands), [level], sampling, executor, telling=False)
                found |= {item.object_number: some[0] for item, some in zip(those, told, strict=True) if some}
    return found


def _parts(numbers: Sequence[str], until: float) -> Iterator[Sequence[str]]:
    """Yield parts of the objects, each larger, as long as the next one will be done in time."""
    at, size, each = 0, FIRST, 0.0
    while at < len(numbers):
        # The first part is run whatever the time.
        if at:
            size = min(size * GROWTH, int((until - perf_counter()) / each))
        if size < 1:
            return
        began = perf_counter()
        yield numbers[at : at + size]
        each = (perf_counter() - began) / min(size, len(numbers) - at)
        at += size


def _items(workspace: Workspace, pages: Sequence[Page], wanted: set[str]) -> Mapping[str, Item]:
    found: dict[str, Item] = {}
    with workspace.engine.connect() as connection:
        for page in pages:
            if page.on_display:
                members = load_members(connection, page.key)
                if wanted.intersection(members.column("object_number")):
                    found |= {item.object_number: item for item in members.read() if item.object_number in wanted}
    return found
