"""The registry of measures: one file each, and after them those of other packages.

How to write one is told by `pipeline.mitigate.measures.base.Measure`.
"""

from inspect import isabstract

from pipeline.errors import InputError
from pipeline.extensions import Registry
from pipeline.mitigate.measures.adhesives import Putty, Wax
from pipeline.mitigate.measures.anchor import Anchor
from pipeline.mitigate.measures.ballast import Ballast
from pipeline.mitigate.measures.base import Measure
from pipeline.mitigate.measures.brace import Armature, Brace
from pipeline.mitigate.measures.chocks import Chocks
from pipeline.mitigate.measures.clearance import Clearance
from pipeline.mitigate.measures.close_hooks import CloseHooks
from pipeline.mitigate.measures.fasten import Fasten
from pipeline.mitigate.measures.friction_isolator import FrictionIsolator
from pipeline.mitigate.measures.hold import Hold
from pipeline.mitigate.measures.horizontal_isolator import HorizontalIsolator
from pipeline.mitigate.measures.remove import Remove
from pipeline.mitigate.measures.restrain import Restrain, Stays
from pipeline.mitigate.measures.restraints import Brackets, Clamps, Clips, Pins, Ties
from pipeline.mitigate.measures.rotational_isolator import RotationalIsolator
from pipeline.mitigate.measures.rubber_pads import RubberPads
from pipeline.mitigate.measures.strengthen import Strengthen
from pipeline.mitigate.measures.surfaces import GripPad, Surface
from pipeline.mitigate.measures.wide_base import WideBase
from pipeline.mitigate.rows import read_measure_rows
from pipeline.tables import table

__all__ = ["MEASURES", "Measure", "checked"]


def checked(value: object) -> type[Measure]:
    """Return what an entry point names as a measure.

    Parameters
    ----------
    value : object
        A class derived from `Measure`, with its `own_row`.

    Raises
    ------
    InputError
        For anything else, and for a row that cannot be used.
    """
    if not (isinstance(value, type) and issubclass(value, Measure)) or isabstract(value):
        raise InputError(f"{value!r} is no class of a measure; derive one from pipeline.mitigate.measures.Measure")
    if value.last_resort:
        raise InputError("last_resort is for Kouros's own measure 'remove'; leave it out")
    if value.own_row is None:
        raise InputError("it has no own_row; give it the cells of a row of measures.csv")
    (row,) = read_measure_rows([value.own_row], "own_row", {value.name: value})
    last = next(float(other["order"]) for other in table("measures") if other["measure"] == Remove.name)
    if not row.order < last:
        raise InputError(f"the order of its own_row must be below {last:g}, that of {Remove.name!r}")
    if row.name != value.name:
        raise InputError(f"its own_row is of {row.name!r}; give it the name {value.name!r}")
    return value


MEASURES: Registry[type[Measure]] = Registry(
    "kouros.measures",
    (
        Chocks,
        Clearance,
        Anchor,
        RubberPads,
        Surface,
        GripPad,
        Pins,
        Wax,
        Putty,
        Ties,
        Clips,
        Ballast,
        WideBase,
        Brackets,
        Clamps,
        Fasten,
        Brace,
        Armature,
        CloseHooks,
        Hold,
        Restrain,
        Stays,
        FrictionIsolator,
        HorizontalIsolator,
        RotationalIsolator,
        Strengthen,
        Remove,
    ),
    checked,
)
