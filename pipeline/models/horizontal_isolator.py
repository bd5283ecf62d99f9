r"""Generic isolator: horizontal, with spring, viscous damping and Coulomb friction.

With stick phases, while the spring and the push are less than the friction,

.. math::

    u'' + 2 \zeta \omega u' + \omega^2 u + \mu N \frac{u'}{|u'|} = -a_h, \qquad a_{\mathrm{on}} = a_h + u''

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.6 and Figure 6.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.models.common import N_, grid, needs
from pipeline.models.friction import stick_slip, stick_slip_trace
from pipeline.models.sliding import DIRECTIONS
from pipeline.quantities import Array, Quantity
from pipeline.records import Axis, ChartAxis, ChartFigure, Columns, Excitation, Harm, Model, Scene, Support, Trials
from pipeline.records import picture as on_chart


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    mu = parameters["friction"]
    w = 2.0 * np.pi * parameters["frequency"]
    out = stick_slip(motion, w, parameters["damping"], mu, mu, refine, estimate)
    # The kernel's error is of the displacement; the acceleration follows it through the spring and the dashpot.
    moved = out["displacement_error"] = out["error"]
    out["error"] = moved * w * (w + 2.0 * parameters["damping"] * w) + out.pop("acceleration_error")
    del out["path_length"]
    return out


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    mu = parameters["friction"]
    return stick_slip_trace(motion, 2.0 * np.pi * parameters["frequency"], parameters["damping"], mu, mu)


def _applies(scene: Scene) -> str:
    if scene.support is not Support.ISOLATED or scene.item.isolator != HORIZONTAL_ISOLATOR.name:
        return N_("it does not stand on a horizontal isolator")
    return needs(scene, "frequency", "damping", "friction", "stroke")


FREQUENCY = Quantity("frequency", "Hz", "undamped natural frequency", 0.0, exclusive=True)
DAMPING = Quantity("damping", "-", "viscous damping ratio", 0.0)

HORIZONTAL_ISOLATOR = Model(
    name="horizontal_isolator",
    title="Horizontal isolator",
    kind="isolator",
    source="Agbabian et al. 1991, sec. 2.6 and Figure 6",
    equation="u'' + 2 zeta w u' + w^2 u + mu N u'/|u'| = -a_h, with stick phases; passes on a_h + u''",
    needs=(FREQUENCY, DAMPING, Quantity("friction", "-", "Coulomb friction coefficient", 0.0), DIRECTIONS),
    gives=(
        Quantity("acceleration", "m/s2", "largest horizontal acceleration passed on"),
        Quantity("displacement", "m", "largest stroke"),
        Quantity("residual", "m", "offset when it rests"),
    ),
    directions=0,
    run=_run,
    trace=_trace,
    chart=ChartAxis("frequency", 0.1, 10.0, nodes=330),
    errors={"displacement": "displacement_error"},
    demand="displacement",
    capacity="stroke",
    applies=_applies,
    sentence="Its isolator moves {demand}; its stroke is {capacity}.",
    fails="exceeds the stroke of its isolator",
    states=(Harm.LEAVES,),
    trials=Trials(
        ranges={"frequency": (0.3, 2.0), "damping": (0.02, 0.2), "friction": (0.0, 0.15)},
        extremes=grid(frequency=[0.02, 1.0, 500.0], damping=[0.0, 1.0, 2.0], friction=[0.0, 1e-6, 5.0]),
        sample={"frequency": 10.0, "damping": 0.1, "friction": 0.05},
        promised=5e-4,
    ),
    listed="Table 2, Isolator, horizontal: Coulomb friction & viscous damping",
    supports=(Support.ISOLATED,),
    pictures=(
        ChartFigure(
            "isolator",
            title="Horizontal isolator",
            caption=(
                "Peak horizontal acceleration passed on, with 2 % viscous damping and four friction coefficients."
            ),
            x=Axis("Isolator frequency", "Hz", "log"),
            y=Axis("Peak acceleration", "m/s2"),
            source="Agbabian et al. 1991, Figure 6",
            curves={
                on_chart.OF_FRICTION(friction=m): {"friction": m, "damping": 0.02} for m in (0.05, 0.10, 0.15, 0.20)
            },
        ),
    ),
)
