"""The text of a museum's dimensions field -> measured parts, and the extents of the object that they give."""

from pipeline.collection.dimensions.choice import choose
from pipeline.collection.dimensions.doubts import doubts
from pipeline.collection.dimensions.lexicon import languages
from pipeline.collection.dimensions.pairing import agree
from pipeline.collection.dimensions.parsing import labels, parse
from pipeline.collection.dimensions.result import Choice, Chosen, DimensionNote, DimensionPart, Dimensions

__all__ = [
    "Choice",
    "Chosen",
    "DimensionNote",
    "DimensionPart",
    "Dimensions",
    "agree",
    "choose",
    "doubts",
    "labels",
    "languages",
    "parse",
]
