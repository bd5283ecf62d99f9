"""How a report is written, as the settings ask for it: units, language, paper, and whether there is a plan."""

from typing import TypedDict

from pipeline.operations.workspace import Workspace
from pipeline.planning.plan import PlanTerms
from pipeline.report import Language, Units, language
from pipeline.settings import Settings


class Presentation(TypedDict):
    """How a report is written: what `render` is told."""

    units: Units
    language: Language
    paper: str
    planned: bool


def presentation(settings: Settings) -> Presentation:
    """Return the units, the language and the paper that the settings ask for, and whether they ask for a plan.

    Parameters
    ----------
    settings : Settings
        Of which `[report]` and `[likelihood]` count.

    Returns
    -------
    Presentation
        What `render` is told.

    Raises
    ------
    ReportError
        For a language without a catalogue, or with a damaged one.
    """
    asked = settings.report
    folder = settings.path(asked.catalogues) if asked.catalogues else None
    return {
        "units": Units(length=asked.length),
        "language": language(asked.language, folder),
        "paper": asked.paper,
        "planned": bool(settings.likelihood.samples),
    }


def terms_of(workspace: Workspace) -> PlanTerms | None:
    """Return what the plan of a report rests on; None where nobody asks how likely harm is: there is no plan then."""
    return workspace.plan_terms if workspace.settings.likelihood.samples else None
