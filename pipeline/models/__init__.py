"""The registry of generic models: one file and one row each.  Where else a new one is named: README."""

from difflib import get_close_matches

from pipeline.errors import InputError
from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rocking import ROCKING
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.models.sliding import SLIDING
from pipeline.models.stress import FLEXIBLE_STRESS, STRESS
from pipeline.models.swing import SWING, SWING_3D
from pipeline.records import Model

MODELS: tuple[Model, ...] = (
    ROCKING,
    SLIDING,
    STRESS,
    FLEXIBLE_STRESS,
    SWING,
    SWING_3D,
    FRICTION_ISOLATOR,
    HORIZONTAL_ISOLATOR,
    ROTATIONAL_ISOLATOR,
    OSCILLATOR,
)


def model_named(name: str) -> Model:
    """Return the model of that name.

    raises : ValueError naming the models there are and the closest one
    """
    for model in MODELS:
        if model.name == name:
            return model
    names = [m.name for m in MODELS]
    close = get_close_matches(name, names, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else "."
    raise InputError(f"there is no model {name!r}{hint} The models are: {', '.join(names)}")
