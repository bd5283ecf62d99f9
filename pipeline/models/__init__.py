"""The registry of generic models: one file and one row each, and those of other packages (group ``kouros.models``)."""

from difflib import get_close_matches

from pipeline.errors import InputError
from pipeline.extensions import Registry
from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.hanger_load import HANGER_LOAD
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rocking import ROCKING
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.models.sliding import SLIDING
from pipeline.models.standing import STANDING
from pipeline.models.stress import FLEXIBLE_STRESS, STRESS
from pipeline.models.swing import SWING, SWING_3D
from pipeline.models.unanchored import UNANCHORED
from pipeline.models.unhooking import UNHOOKING
from pipeline.records import Model


def _model(value: object) -> Model:
    """Return what another package offers, as a model; a row that does not fit together refuses itself."""
    if not isinstance(value, Model):
        raise InputError(f"it is a {type(value).__name__}; let the entry point name a pipeline.records.Model")
    kinds = {figure.kind for model in MODELS.own for figure in model.pictures}
    for figure in value.pictures:
        if figure.kind in kinds:
            raise InputError(f"there are pictures of the kind {figure.kind!r} already; give them another")
    return value


MODELS = Registry(
    "kouros.models",
    (
        STANDING,
        ROCKING,
        SLIDING,
        STRESS,
        FLEXIBLE_STRESS,
        SWING,
        SWING_3D,
        UNHOOKING,
        HANGER_LOAD,
        UNANCHORED,
        FRICTION_ISOLATOR,
        HORIZONTAL_ISOLATOR,
        ROTATIONAL_ISOLATOR,
        OSCILLATOR,
    ),
    _model,
)


def model_named(name: str) -> Model:
    """Return the model of that name.

    Parameters
    ----------
    name : str
        As ``kouros models`` lists it.

    Returns
    -------
    Model
        Its row.

    Raises
    ------
    InputError
        Naming the models there are and the closest one.
    """
    for model in MODELS:
        if model.name == name:
            return model
    names = [m.name for m in MODELS]
    close = get_close_matches(name, names, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else "."
    raise InputError(f"there is no model {name!r}{hint} The models are: {', '.join(names)}")


def settled_by_room(name: str) -> bool:
    """Say whether the failure that a model tells of is a collision, so that room settles it."""
    return model_named(name).room_settles


def tips(name: str) -> bool:
    """Say whether the failure that a model tells of is that an object tips."""
    return model_named(name).tips
