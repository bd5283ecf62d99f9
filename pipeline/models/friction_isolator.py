r"""Generic isolator: a low-friction interface, which slides as a rigid body does and passes on what friction gives.

.. math::

    u'' = -a_h - \mu_k N \frac{u'}{|u'|}, \qquad a_{\mathrm{on}} = a_h + u''

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.6 and Table 2.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.models.common import N_, needs
from pipeline.models.friction import kinetic, slip_bounds, stick_slip, stick_slip_trace
from pipeline.models.sliding import FRICTION_AXIS, FRICTION_EXTREMES, FRICTION_KINETIC, FRICTION_STATIC
from pipeline.quantities import Array, Quantity
from pipeline.records import Bounds, Columns, Excitation, Model, Scene, Support, Trials


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    mu_s = parameters["friction_static"]
    free = np.zeros_like(mu_s)
    out = stick_slip(motion, free, free, mu_s, kinetic(parameters), refine, estimate)
    # The error of the first output: friction passes on exactly mu N while slipping and the base's own while at rest,
    # but when it slips and rests is not known exactly.
    out["displacement_error"], out["error"] = out["error"], out.pop("acceleration_error")
    del out["path_length"]
    return out


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    mu_k = kinetic({name: np.array([value]) for name, value in parameters.items()})
    return stick_slip_trace(motion, 0.0, 0.0, parameters["friction_static"], float(mu_k[0]))


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    mu_s, mu_k = parameters["friction_static"], kinetic(parameters)
    return slip_bounds(motion, mu_s, mu_k, "acceleration", "displacement", "residual")


def _applies(scene: Scene) -> str:
    if scene.support is not Support.ISOLATED or scene.item.isolator != FRICTION_ISOLATOR.name:
        return N_("it does not stand on a friction isolator")
    return needs(scene, "friction_static")


FRICTION_ISOLATOR = Model(
    name="friction_isolator",
    title="Friction isolator",
    kind="isolator",
    source="Agbabian et al. 1991, sec. 2.6",
    equation="u'' = -a_h - mu_k N u'/|u'|; passes on a_h + u''",
    needs=(FRICTION_STATIC, FRICTION_KINETIC),
    gives=(
        Quantity("acceleration", "m/s2", "largest horizontal acceleration passed on"),
        Quantity("displacement", "m", "largest distance from where it stood"),
        Quantity("residual", "m", "distance from where it stood when it rests"),
    ),
    directions=2,
    run=_run,
    trace=_trace,
    bound=_bound,
    chart=FRICTION_AXIS,
    errors={"displacement": "displacement_error"},
    demand="displacement",
    capacity="clearance",
    applies=_applies,
    sentence="On its low-friction pad it slides {demand}; there is room for {capacity}.",
    at_most="On its low-friction pad it slides at most {demand} (at most {high}); there is room for {capacity}.",
    fails="slides",
    trials=Trials(ranges={"friction_static": (0.03, 0.15)}, extremes=FRICTION_EXTREMES),
    listed="Table 2, Isolator, friction: Low friction interface",
    supports=(Support.ISOLATED,),
    needs_size=False,
    room_settles=True,
)
