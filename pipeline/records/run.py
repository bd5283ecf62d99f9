"""A whole run, the account of the rows behind it, and the small pictures of its objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.records.decision import DecisionStatus
from pipeline.records.motion import MotionSummary
from pipeline.records.picture import Chart
from pipeline.records.result import Assessment, MeasurementRequest, Spacing


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A whole run, as the store gives it back: all that the reports need, and nothing is computed again.

    Attributes
    ----------
    run_id : str
        Its name.
    started, finished : str
        ISO 8601.
    version : str
        Of the code.
    site, museum : str
        As the settings name them.
    level_notes : tuple of str
        What a reader should know of the levels of shaking.
    settings : mapping
        Those it was run with.
    assessments : tuple of Assessment
        One for each object.
    charts : mapping of str to Chart
        By key.
    motions : tuple of MotionSummary
        Of all levels and floors.
    demonstration : bool
        Whether it is of the bundled collection.
    decisions : tuple of DecisionStatus
        Those in force about its objects, and about objects that the inventory has no more.
    wishes : tuple of MeasurementRequest or None
        What is worth measuring, what settles most first; None where the run did not ask.
    spacings : tuple of Spacing
        Of the neighbours in the galleries whose places are known.
    """

    run_id: str
    started: str
    finished: str
    version: str
    site: str
    museum: str
    level_notes: tuple[str, ...]
    settings: Mapping[str, Any]
    assessments: tuple[Assessment, ...]
    charts: Mapping[str, Chart]
    motions: tuple[MotionSummary, ...]
    demonstration: bool = False
    decisions: tuple[DecisionStatus, ...] = ()
    wishes: tuple[MeasurementRequest, ...] | None = None
    spacings: tuple[Spacing, ...] = ()


@dataclass(frozen=True, slots=True)
class Photo:
    """A small picture.

    Attributes
    ----------
    name : str
        A digest of its content, which is its name in a report.
    width, height : int
        In pixels.
    content : bytes
        JPEG; b"" where it is not at hand.
    """

    name: str
    width: int
    height: int
    content: bytes = b""


REFUSED, SOURCE, CHOICE, SHEET, DOUBTFUL = "refused", "source", "choice", "sheet", "doubtful"
"""What a doubt is about: a row that became no object; the whole source; what was settled by choice for all of it; a
sheet of our own; a value of an object."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that reading refused, doubts, or settled by choice.

    Attributes
    ----------
    what : str
        One of the five above.
    row, line : int or None
        Of the source, row 1 the first below the header; None where it is of no row, or not known of which.
    object_number, field : str
        What it is about.
    message, remedy : str
        What is wrong, and what mends it.
    characters : str
        What stands in the museum's record, where that is kept.
    used : str
        What is used of it; "" for nothing.
    """

    what: str
    row: int | None
    line: int | None
    object_number: str
    field: str
    message: str
    remedy: str
    characters: str = ""
    used: str = ""


@dataclass(frozen=True, slots=True)
class Account:
    """Account of the rows behind a version of the inventory.

    Attributes
    ----------
    source : str
        Where they come from.
    rows : int
        How many there are.
    refused : int
        Rows that became no object.
    doubtful : int
        Objects of which a value was refused or is doubted.
    sheets : int
        Rows and cells of sheets of our own that were not used.
    suspicions : tuple of (str, str, str)
        What the whole source seems to have wrong, with what mends it.
    flagged : bool
        Whether a column of the source says what is on display.
    choices : tuple of (str, str, str)
        What was settled for the whole source by choice, with what settles it otherwise.
    """

    source: str
    rows: int
    refused: int
    doubtful: int
    sheets: int
    suspicions: tuple[tuple[str, str, str], ...]
    flagged: bool
    choices: tuple[tuple[str, str, str], ...] = ()
