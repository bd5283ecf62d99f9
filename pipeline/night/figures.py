"""The pictures of the motions: made while the museum's records are read, which keeps one core busy and no more."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

from pipeline.analysis.context import Context
from pipeline.analysis.figures import chart_keys, draw
from pipeline.analysis.response_charts import ChartCache
from pipeline.execute import Threads
from pipeline.motions.site import Site
from pipeline.operations.workspace import Workspace
from pipeline.records import Chart, Motion, Progress
from pipeline.resources import code_version
from pipeline.store.reuse import stored_charts


class Pictures:
    """Makes the pictures of motions that no earlier run has stored, and finds those that one has."""

    def __init__(self, workspace: Workspace) -> None:
        settings = workspace.settings
        self._workspace = workspace
        # Not the charts of the verdicts, which are chosen once it is known what pays.
        self._context = Context(Threads(settings.analysis.workers), charts=ChartCache(settings.kept))
        self._hand = ThreadPoolExecutor(1)
        self._stored: dict[str, Mapping[str, Chart]] = {}
        self._begun: dict[str, Future[dict[str, Chart]]] = {}

    def begin(self, motions: Sequence[Motion]) -> None:
        """Begin with motions that will be asked for, one after the other, and return at once."""
        new = [motion for motion in motions if motion.hash not in self._stored.keys() | self._begun.keys()]
        wanted = [key for motion in new for key in chart_keys(motion)]
        there = stored_charts(self._workspace.engine, wanted, code_version()) if wanted else {}
        for motion in new:
            keys = chart_keys(motion)
            if there.keys() >= set(keys):
                self._stored[motion.hash] = {key: there[key] for key in keys}
            else:
                self._begun[motion.hash] = self._hand.submit(draw, motion, self._context)

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
    found = Pictures(workspace)
    try:
        if not any("*" in galleries for galleries in workspace.settings.floors.root.values()):
            found.begin([one.motion for level in site.levels for one in level.motions])
        yield found
    finally:
        found.close()
