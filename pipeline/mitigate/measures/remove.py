"""Removal from display: what is left where nothing else passes."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import Measure
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal
from pipeline.mitigate.rows import STORED
from pipeline.mitigate.trials import TrialRunner
from pipeline.records import Item, Scene

STORED_TITLE = "Store it lower, or make it fast"

STORED_SENTENCE = (
    "Store it lower, or make it fast on its shelf: none of the measures tried is enough, and there is no model of "
    "shelves here that says more."
)


class Remove(Measure):
    """Take it off display.

    References
    ----------
    Agbabian et al. (1991), sec. 4.
    """

    name = "remove"
    last_resort = True
    phrases = (STORED_TITLE, STORED_SENTENCE)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Refuse: what is not there is not run.

        Raises
        ------
        KeyError
            Always.
        """
        raise KeyError(self.name)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose it: it passes always."""
        return Proposal((Candidate({}),))

    def called(self, item: Item) -> tuple[str, str, str]:
        """Return name, title and sentence: what is not on display is stored otherwise."""
        return super().called(item) if item.on_display else (STORED, STORED_TITLE, STORED_SENTENCE)


LAST_RESORTS = (Remove.name, STORED)
"""Names of what is advised where nothing that was tried passes."""
