"""The pictures of the motions: made while the museum's records are read, which keeps one core busy and no more.

They are kept in the cache by the content of their motion, and drawn again where that or the code is another.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

from pipeline.analysis.context import Context
from pipeline.analysis.figures import chart_keys, draw
from pipeline.analysis.response_charts import ChartCache
from pipeline.cache import PICTURES, Cache, CacheEntry, key_of
from pipeline.execute import Threads
from pipeline.motions.site import Site
from pipeline.operations.workspace import Workspace
from pipeline.records import Chart, Motion, Progress
from pipeline.settings import Settings
from pipeline.store import codec

_PICTURES = dict[str, Chart]
"""All pictures of a motion, by key."""


def _key(motion: Motion) -> str:
    return key_of(chart_keys(motion), motion.hash, group=motion.hash)


class Pictures:
    """Makes the pictures of motions that are not kept, and finds those that are."""

    def __init__(self, settings: Settings) -> None:
        self._cache = Cache(settings.kept)
        # Not the charts of the verdicts, which are chosen once it is known what pays.
        self._context = Context(Threads(settings.analysis.workers), charts=ChartCache(settings.kept))
        self._hand = ThreadPoolExecutor(1)
        self._stored: dict[str, Mapping[str, Chart]] = {}
        self._begun: dict[str, Future[dict[str, Chart]]] = {}

    def begin(self, motions: Sequence[Motion]) -> None:
        """Begin with motions that will be asked for, one after the other, and return at once."""
        new = [motion for motion in motions if motion.hash not in self._stored.keys() | self._begun.keys()]
        for motion in new:
            kept = self._cache.get(PICTURES, _key(motion))
            if kept is None:
                self._begun[motion.hash] = self._hand.submit(self._draw, motion)
            else:
                self._stored[motion.hash] = codec.of_json(_PICTURES, kept.said["pictures"])

    def _draw(self, motion: Motion) -> dict[str, Chart]:
        drawn = draw(motion, self._context)
        self._cache.put(PICTURES, _key(motion), CacheEntry({"pictures": codec.to_json(_PICTURES, drawn)}))
        return drawn

    def of(self, motions: Sequence[Motion], progress: Progress) -> dict[str, Chart]:
        """Return the pictures of motions, by key."""
        self.begin(motions)
        out: dict[str, Chart] = {}
        for done, motion in enumerate(motions):
            progress.step("charts", done, len(motions))
            begun = self._begun.get(motion.hash)
            out |= self._stored[motion.hash] if begun is None else begun.result()
        progress.step("charts", len(motions), len(motions))
        return out

    def close(self) -> None:
        """Leave what is not begun; a motion that is being worked on is finished, which takes seconds."""
        self._hand.shutdown(cancel_futures=True)


@contextmanager
def pictures(workspace: Workspace, site: Site) -> Iterator[Pictures]:
    """Begin with the pictures of the ground's motions, which are wanted unless all galleries are on other floors."""
    found = Pictures(workspace.settings)
    try:
        if not any("*" in galleries for galleries in workspace.settings.floors.root.values()):
            found.begin([one.motion for level in site.levels for one in level.motions])
        yield found
    finally:
        found.close()
