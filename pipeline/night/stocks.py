"""What an earthquake's answer needs of a run: kept in the cache as its pages are made, made anew where it is missing.

The night leaves it ready; whoever asks after an earthquake reads it in a second, and waits for no lock.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.analysis.stakes import counting
from pipeline.cache import STOCKS, Cache
from pipeline.event.capacities import FloorMotions, Stock, floors_of, stock_joined, stock_key, stock_of
from pipeline.motions.site import Level
from pipeline.motions.summary import summaries
from pipeline.operations.workspace import Workspace
from pipeline.records import Found, MotionSummary, Page, RunRecord
from pipeline.store.pages import load_page


@dataclass(frozen=True)
class StockTerms:
    """What the stock of every page rests on besides the page: the motions of the floors, and what money counts.

    Attributes
    ----------
    kept : Path
        Folder of the cache.
    floors : mapping of str to FloorMotions
        Of the run.
    value_per_c : float
        As of `counting`.
    """

    kept: Path
    floors: Mapping[str, FloorMotions]
    value_per_c: float

    def there(self, page: Page) -> bool:
        """Say whether the stock of a page is kept."""
        return Cache(self.kept).has(STOCKS, self._key(page))

    def keep(self, page: Page, found: Found) -> Stock:
        """Keep the stock of a page, and return it."""
        with counting(self.value_per_c):
            stock = stock_of(found.assessments, self.floors)
        Cache(self.kept).put(STOCKS, self._key(page), stock.packed())
        return stock

    def get(self, page: Page) -> Stock | None:
        """Return the stock of a page; None where it is not kept, or not what was kept."""
        kept = Cache(self.kept).get(STOCKS, self._key(page))
        return None if kept is None else Stock.of_packed(kept)

    def _key(self, page: Page) -> str:
        return stock_key(page.key, self.floors, self.value_per_c)


def told_floors(motions: Sequence[MotionSummary], levels: Sequence[Level]) -> dict[str, FloorMotions]:
    """Return the floors of a run by name.

    Parameters
    ----------
    motions : sequence of MotionSummary
        Those of the run.
    levels : sequence of Level
        Of the ground: a run in which nothing stands on it does not have its motions.
    """
    ground = [one for one in motions if not one.floor]
    return floors_of(motions, ground or summaries(levels))


def stock_terms(workspace: Workspace, head: RunRecord) -> StockTerms:
    """Return what the stock of a run rests on.

    Raises
    ------
    MotionError
        Where the site has to be read for it, and cannot be used.
    """
    settings = workspace.settings
    grounded = any(not one.floor for one in head.motions)
    floors = told_floors(head.motions, () if grounded else workspace.site().levels)
    return StockTerms(settings.kept, floors, settings.museum.value_per_c)


def run_stock(workspace: Workspace, terms: StockTerms, pages: Sequence[Page]) -> Stock:
    """Return the stock of a run: as it is kept, else from its results, and then it is kept.

    Raises
    ------
    StoreError
        For a result that is not there any more, or damaged.
    """
    return stock_joined([terms.get(page) or _made(workspace, terms, page) for page in pages if page.on_display])


def keep_stocks(workspace: Workspace, terms: StockTerms, pages: Sequence[Page]) -> None:
    """Keep the stock of those pages of a run whose stock is not kept yet."""
    for page in pages:
        if page.on_display and not terms.there(page):
            _made(workspace, terms, page)


def _made(workspace: Workspace, terms: StockTerms, page: Page) -> Stock:
    return terms.keep(page, load_page(workspace.engine, page.key))
