"""Kouros: the seismic risk of a museum's collection.

The four public names are handed on lazily, so that ``import pipeline`` costs nothing::

    from pipeline import Motion, read_motion, respond, transmit

Its modules tell what they do to loggers below "pipeline", which nobody hears who does not ask: `kouros -v` and
`kouros --debug` show them.
"""

import logging
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pipeline.analysis.response import respond, trace
    from pipeline.analysis.transmission import transmit
    from pipeline.motions import read_motion
    from pipeline.records import Motion

__version__ = "0.1.0"
__all__ = ["Motion", "read_motion", "respond", "trace", "transmit"]

logging.getLogger(__name__).addHandler(logging.NullHandler())

_HOMES = {
    "Motion": "pipeline.records",
    "read_motion": "pipeline.motions",
    "respond": "pipeline.analysis.response",
    "trace": "pipeline.analysis.response",
    "transmit": "pipeline.analysis.transmission",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'pipeline' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
