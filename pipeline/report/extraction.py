"""Phrases for the catalogue of a translation: what a report shows of tables, of models and of measures."""

import csv
from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields
from io import TextIOWrapper
from typing import IO

from pipeline.analysis.classify import WEIGHED, object_classes
from pipeline.analysis.furniture import DAMPING, FREQUENCY, IN_NO_CASE, IN_THE_OPEN, LEVEL_ERROR, ON_WHEELS, WHAT_HANGS
from pipeline.analysis.section import OF_CLASS, PLAN
from pipeline.analysis.sizes import SIZES
from pipeline.analysis.usual import ON_ANY
from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.fixing_rows import fixing_strengths
from pipeline.mitigate.installed import ON_TOP
from pipeline.mitigate.measures import MEASURES
from pipeline.mitigate.measures.fixings import FINISHED
from pipeline.mitigate.measures.horizontal_isolator import GENERIC
from pipeline.mitigate.proposals import IT
from pipeline.mitigate.rows import STORED
from pipeline.mitigate.saying import (
    ANCHORED,
    EACH_PIECE,
    ENGINEER,
    HEAVIEST,
    HELD_FIRST,
    OF_MEAN,
    ONLY_AT_BEST,
    ONLY_HERE,
    ONLY_SIZED,
    SAID_AS_IT_IS,
    UPPER_FIRST,
)
from pipeline.models import MODELS
from pipeline.models.common import NOTES
from pipeline.records import UNTOLD_ISOLATOR, Anchorage, ChartFigure, Item, Support
from pipeline.records.phrases import PHRASES, SENTENCES
from pipeline.records.picture import CHART_WORDS
from pipeline.report.assumed import SOURCES, TABLES
from pipeline.report.text import bare
from pipeline.tables import table
from pipeline.tables.assumed import assumed

_Found = tuple[int, str, str, list[str]]


def table_phrases(
    file: IO[bytes],
    keywords: Collection[str],  # noqa: ARG001 - asked of every method of extraction
    comment_tags: Collection[str],  # noqa: ARG001
    options: Mapping[str, str],
) -> Iterator[_Found]:
    """Yield the texts of some columns of a table, as babel asks of a method of extraction.

    Parameters
    ----------
    options : mapping of str to str
        "columns", the names of the columns, separated by commas.

    Yields
    ------
    _Found
        (line, function, phrase, comments) for each text that is not empty.
    """
    wanted = [name.strip() for name in options.get("columns", "").split(",") if name.strip()]
    rows = csv.DictReader(TextIOWrapper(file, encoding="utf-8", newline=""))
    for row in rows:
        yield from ((rows.line_num, "_", row[name], []) for name in wanted if row.get(name))


def run_phrases(
    file: IO[bytes],  # noqa: ARG001 - the rows are asked, not their source
    keywords: Collection[str],  # noqa: ARG001
    comment_tags: Collection[str],  # noqa: ARG001
    options: Mapping[str, str],  # noqa: ARG001
) -> Iterator[_Found]:
    """Yield what a run may store and a report then says: of each model, of the measures' evidence, and the names.

    Named in babel.cfg for the registry of the models.
    """
    for phrase in dict.fromkeys((*_of_models(), *_of_measures(), *_of_assumptions(), *_names())):
        if phrase:
            yield 1, "_", phrase, []


def _of_models() -> Iterator[str]:
    for model in MODELS:
        yield from (model.title, model.sentence, model.at_most, model.gripped, model.fails, *model.says)
        for one in model.pictures:
            if isinstance(one, ChartFigure):
                yield from (one.title, one.caption, one.x.label, one.y.label)
    yield from (one.asked for one in CHART_WORDS)
    yield from NOTES.values()
    yield ON_TOP


def _of_measures() -> Iterator[str]:
    """Yield the titles and the sentences of measures with their words put in, and what is added to them."""
    for measure in own_catalogue().measures:
        sentence = measure.row.sentence
        yield from (measure.row.title, sentence, *measure.phrases)
        if "{surface}" in sentence:
            surfaces = dict.fromkeys(pair.surface_material.lower() for pair in assumed().friction)
            yield from (sentence.replace("{surface}", surface) for surface in surfaces)
        if "{what}" in sentence:
            yield sentence.replace("{what}", IT).replace("{product}", GENERIC).replace(" {how}", "")
        if "{care}" in sentence:
            yield sentence.replace(" {care}", "")
    yield from (
        *SAID_AS_IT_IS,
        ENGINEER,
        FINISHED,
        ONLY_HERE,
        *ONLY_AT_BEST,
        *ONLY_SIZED,
        HEAVIEST,
        OF_MEAN,
        ANCHORED,
        NAMED_FIRST,
        EACH_PIECE,
        UPPER_FIRST,
        HELD_FIRST,
    )
    yield from (row.care for row in fixing_strengths().values())


def _of_assumptions() -> Iterator[str]:
    """Yield the phrases of what is assumed, and what may stand in their places."""
    yield from (phrase.asked for phrase in (*PHRASES, *SENTENCES))
    yield from (*TABLES, *SOURCES)
    yield from (row["title"] for name in ("contacts", "bodies") for row in table(name))
    yield from assumed().materials
    pairs = ((row.object_material, row.surface_material) for row in assumed().friction)
    backs = ((row.back_surface, row.wall_surface) for row in assumed().damping)
    yield from (name.lower() for pair in (*pairs, *backs) for name in pair)
    yield from ON_ANY.values()
    yield from (
        "any material",
        "any floor",
        "its back",
        "the wall",
        "what stands",
        IN_THE_OPEN,
        IN_NO_CASE,
        ON_WHEELS,
        *WHAT_HANGS.values(),
    )
    yield from (f"critical section ({kind})" for kind in (*OF_CLASS, PLAN))
    yield from ("wall of its foot", "narrower side", "narrower base side", "base side", "half width of what it lies on")
    yield from (f"smallest size, its {size}" for size in SIZES)
    yield from ("section", "base", "damping of the object itself", "lowest natural frequency")


def _names() -> Iterator[str]:
    """Yield fields, parameters, models, measures and classes as they are said in plain words."""
    quantities = [q for model in MODELS for q in (*model.needs, *model.gives)]
    quantities += [q for measure in MEASURES for q in measure.parameters]
    names = [field.name for field in fields(Item)] + [q.name for q in quantities] + [m.name for m in MODELS]
    names += [name for measure in MEASURES for name in (measure.name, *measure.gives)]
    names += [STORED, *object_classes(), *Support, *Anchorage]
    yield from (bare(name) for name in names)
    yield from ("width (or diameter)", "height or suspension length", "height of the centre of gravity")
    yield from ("width of its weakest section", UNTOLD_ISOLATOR, WEIGHED)
    yield from map(bare, (FREQUENCY, DAMPING, LEVEL_ERROR))
    yield from (f"no generic model applies: it {row['why']}" for row in table("classes") if row["models"] == "none")
    # Whoever chooses one of them at the desk reads its title.
    yield from object_classes().values()
    yield from (row["title"] for name in ("hangings", "furniture", "mounts") for row in table(name))
