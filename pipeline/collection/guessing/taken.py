"""A preset that is taken for a source: what the source leaves empty of what it reads, and which places are stores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import tomlkit
from tomlkit.items import Table

from pipeline.collection.display_words import says_away
from pipeline.collection.guessing.columns import Column, joined
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.mapping import PRESETS
from pipeline.collection.mapping import Mapping as Proposal
from pipeline.quantities import counted

MOST_STORES = 200
"""Places that are listed as stores at most."""


def of_preset(
    name: str, columns: Sequence[Column], told: GuessNotes, source: Mapping[str, Any] | None = None
) -> tuple[str, Proposal]:
    """Return a preset as text and as a mapping, in the ways of another source perhaps.

    Parameters
    ----------
    name : str
        Of the preset.
    columns : sequence of Column
        Of the source.
    told : GuessNotes
        What the source leaves empty of what the preset reads is added to its doubts.
    source : mapping of str to object or None
        What differs in the section [source].
    """
    document = tomlkit.parse((PRESETS / f"{name}.toml").read_text(encoding="utf-8"))
    cast(Table, document["source"]).update(source or {})
    text = tomlkit.dumps(document)
    proposal = Proposal.model_validate(document.unwrap())
    filled = {column.name for column in columns if column.filled}

    def tells(*fields: str) -> bool:
        read = [proposal.columns[one] for one in fields if one in proposal.columns]
        return any(one.constant is not None or filled & set(one.sources) for one in read)

    if not tells("object_number"):
        told.doubts.append("no record tells object numbers: export them")
    if not tells("gallery"):
        told.doubts.append(
            "no record tells where an object is: export the current location, or put a constant in [columns.gallery]"
        )
    texts = () if proposal.dimensions is None else proposal.dimensions.columns
    if not tells("height_m", "width_m", "depth_m", "diameter_m") and not filled & set(texts):
        told.doubts.append("no record tells sizes: export the dimensions too")
    places = proposal.columns["gallery"].sources
    stores = list(filter(says_away, joined(columns, places, proposal.columns["gallery"].separator)))
    if stores:
        document["display"] = {"not_on_display": stores[:MOST_STORES]}
        text = tomlkit.dumps(document)
        told.doubts.append(said_of_stores(stores))
    elif not tells("on_display"):
        told.doubts.append("nothing tells what is on display: name stores in the mapping, [display] not_on_display")
    return text, Proposal.model_validate(tomlkit.parse(text).unwrap())


def said_of_stores(stores: Sequence[str]) -> str:
    """Return in words which places are counted as stores."""
    shown = ", ".join(map(repr, stores[:5])) + (", ..." if len(stores) > 5 else "")
    return f"{counted(len(stores), 'place')} counted as stores, by their names: {shown}"
