"""The paper's Figures 2 to 6 of one motion: pictures of its response charts where there are such."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from pipeline.analysis.chart_runs import deciding, response_chart
from pipeline.analysis.context import Context
from pipeline.analysis.response import respond, trace
from pipeline.analysis.response_charts import ChartCache, ResponseChart
from pipeline.models.common import largest_push, largest_speed
from pipeline.models.rocking import VELOCITY_SCREEN
from pipeline.quantities import Array, G
from pipeline.records import Axis, Chart, Curve, Motion, Numerics, Zone

SPECTRUM_FREQUENCIES = tuple(float(v) for v in np.round(np.geomspace(0.2, 50.0, 96), 4))
PATH_FRICTION = 0.05
PATH_POINTS = 1500

PICTURED = 2e-2
"""Tolerance of the response charts that are made for a picture: half of it, its error as a rule, is a line's width.

It is that of the output which is drawn.  That of the others, the windings of a swing without damping above all, took
two thirds of the analyses and changed nothing that can be seen.
"""

SHORTEST = 0.1
"""Metres of the shortest suspension on a swing's picture: below, verdicts need a chart and nobody a picture."""

SMOOTH = 240
"""Points of a curve between the nodes of its chart, so that it is drawn as the chart is read."""

SLIDING: Mapping[str, Mapping[str, float]] = {"": {}}
SWINGS: Mapping[str, Mapping[str, float]] = {f"damping {d:.2f}": {"damping": d} for d in (0.0, 0.05, 0.10, 0.20)}
ISOLATORS: Mapping[str, Mapping[str, float]] = {
    f"friction {m:.2f}": {"friction": m, "damping": 0.02} for m in (0.05, 0.10, 0.15, 0.20)
}
"""The curves of Figures 4, 5 and 6: what each is called, and the parameters that its chart has fixed."""

SWING_DIRECTIONS = 30.0
"""Degrees between the directions of which a swing's picture shows the worst."""


def chart_key(kind: str, motion: Motion) -> str:
    """Return the identity of a motion's chart, which marks refer to."""
    return f"{kind}:{motion.hash[:16]}"


KINDS = ("stability", "sliding", "path", "swing", "isolator", "spectrum")
"""Kinds of charts drawn of each motion."""


def chart_keys(motion: Motion) -> list[str]:
    """Return the identities of all charts of a motion."""
    return [chart_key(kind, motion) for kind in KINDS]


def draw(motion: Motion, context: Context) -> dict[str, Chart]:
    """Return all pictures of a motion.

    Parameters
    ----------
    motion
        What they are of.
    context
        Where they are made, and where the response charts are found and kept that Figures 4, 5 and 6 are pictures of.

    Returns
    -------
    dict of str to Chart
        By key, see `chart_keys`.

    References
    ----------
    Agbabian, Masri, Nigbor and Ginell (1991), Figures 2 to 6.
    """
    cached, executor = context.charts, context.executor
    curves = [
        *((sliding_of, fixed) for fixed in SLIDING.values()),
        *((swing_of, fixed) for fixed in SWINGS.values()),
        *((isolator_of, fixed) for fixed in ISOLATORS.values()),
    ]
    # Each chart is a piece of work of its own: a picture of four would leave the other cores waiting.
    executor.map(lambda curve: curve[0](motion, cached, curve[1]), curves)
    makers: Sequence[Callable[[Motion], Chart]] = (
        stability_chart,
        partial(sliding_chart, charts=cached),
        path_chart,
        partial(swing_chart, charts=cached),
        partial(isolator_chart, charts=cached),
        spectrum_chart,
    )
    made = executor.map(lambda make: make(motion), makers)
    return {chart.key: chart for chart in made}


def _curve(label: str, x: Sequence[float] | Array, y: Sequence[float] | Array) -> Curve:
    return Curve(label, tuple(map(_rounded, x)), tuple(map(_rounded, y)))


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def sliding_of(motion: Motion, charts: ChartCache, fixed: Mapping[str, Any]) -> ResponseChart:
    """Return the chart of sliding against friction: the very one that verdicts are found by.

    Parameters
    ----------
    motion
        What shakes it.
    charts
        Where response charts are found and kept.
    fixed
        The model's parameters besides that of the axis.

    Returns
    -------
    ResponseChart
        Displacement [m] against friction.
    """
    return response_chart("sliding", motion, numerics=deciding("sliding"), charts=charts, **fixed)


def swing_of(motion: Motion, charts: ChartCache, fixed: Mapping[str, Any]) -> ResponseChart:
    """Return the chart of a swing against its length.

    Parameters
    ----------
    motion
        What shakes it.
    charts
        Where response charts are found and kept.
    fixed
        The model's parameters besides that of the axis.

    Returns
    -------
    ResponseChart
        Displacement [m] against length [m].
    """
    return response_chart(
        "swing",
        motion,
        numerics=Numerics(azimuth_step=SWING_DIRECTIONS, tolerance=PICTURED, first=True),
        low=SHORTEST,
        charts=charts,
        **fixed,
    )


def isolator_of(motion: Motion, charts: ChartCache, fixed: Mapping[str, Any]) -> ResponseChart:
    """Return the chart of what a horizontal isolator passes on against its frequency.

    Parameters
    ----------
    motion
        What shakes it.
    charts
        Where response charts are found and kept.
    fixed
        The model's parameters besides that of the axis.

    Returns
    -------
    ResponseChart
        Acceleration [m/s2] against frequency [Hz].
    """
    numerics = Numerics(tolerance=PICTURED, first=True)
    return response_chart("horizontal_isolator", motion, numerics=numerics, charts=charts, **fixed)


def _pictured(made: ResponseChart, label: str) -> Curve:
    """Return the curve of a response chart's first output: through its nodes, read between them as a lookup reads."""
    along = np.concatenate([made.nodes, np.geomspace(made.low, made.high, SMOOTH)])
    if made.settled < made.axis.high:
        along = np.append(along, made.axis.high)
    # Read where the rounded points stand: next to a kink the chart's nodes are nearer than five digits tell apart.
    along = np.unique([_rounded(value) for value in along])
    return _curve(label, along, made.look(along).columns[made.outputs[0]])


def _told(made: Mapping[str, ResponseChart]) -> str:
    """Say of the curves of a picture what they are made of and how far off they may be."""
    count = sum(one.cells.nodes for one in made.values())
    errors = [
        f"{100.0 * one.worst(one.outputs[0]):.2g} %" + (f" ({label})" if label else "") for label, one in made.items()
    ]
    return (
        f"Drawn from {count:,} analyses, closest together where the response turns. Error measured at points held out: "
        f"at most {', '.join(errors)} of the value, or of a hundredth of the largest value where that is more."
    )


def stability_chart(motion: Motion) -> Chart:
    """Return the rocking stability chart (Figure 2): base width against equivalent height H' = 2 h_cg.

    The lines are the paper's screens A_max/g = B/H' and V_max = 10 B/sqrt(H') (Ishiyama 1982).  Overturning asks for
    both: below their crossing no object rocks without overturning.
    """
    excitation = motion.excitation(None)
    slope = largest_push(excitation) / G
    speed = largest_speed(excitation) / VELOCITY_SCREEN
    heights = np.geomspace(0.02, 5.0, 40)
    uplift = slope * heights
    overturn = np.minimum(uplift, speed * np.sqrt(heights))
    low, high = 0.005, 5.0

    def band(label: str, bottom: Array, top: Array, tone: str) -> Zone:
        xs = np.concatenate([heights, heights[::-1]])
        ys = np.clip(np.concatenate([bottom, top[::-1]]), low, high)
        outline = _curve("", xs, ys)
        return Zone(label, outline.x, outline.y, tone)

    floor, ceiling = np.full_like(heights, low), np.full_like(heights, high)
    zones = (
        band("stands", uplift, ceiling, "safe"),
        band("rocks", overturn, uplift, "warn"),
        band("overturns", floor, overturn, "danger"),
    )
    crossing = (speed / slope) ** 2 if slope > 0.0 else 0.0
    caption = (
        f"Peak resultant acceleration {slope:.2f} g, velocity {100.0 * speed * VELOCITY_SCREEN:.0f} cm/s. "
        "H' is twice the height of the centre of gravity. "
        f"Below H' = {100.0 * crossing:.0f} cm there is no band in which an object rocks without overturning. "
        "The lines are the paper's closed-form criteria; the verdict comes from the time history."
    )
    return Chart(
        chart_key("stability", motion),
        "Rocking stability",
        caption,
        Axis("Equivalent height H'", "m", "log"),
        Axis("Base width B", "m", "log"),
        (
            _curve("A_max/g = B/H'", heights, uplift),
            _curve("V_max = 10 B/√H'", heights, np.clip(speed * np.sqrt(heights), low, high)),
        ),
        zones,
        source="Agbabian et al. 1991, Figure 2; Ishiyama 1982",
    )


def sliding_chart(motion: Motion, charts: ChartCache) -> Chart:
    """Return the largest sliding displacement against friction (Figure 4).

    Parameters
    ----------
    motion
        What it is of.
    charts
        Where response charts are found and kept.

    Returns
    -------
    Chart
        Largest displacement [m] against friction.

    References
    ----------
    Agbabian et al. (1991), Figure 4.
    """
    made = {label: sliding_of(motion, charts, fixed) for label, fixed in SLIDING.items()}
    return Chart(
        chart_key("sliding", motion),
        "Sliding against friction",
        f"Largest distance an object slides from where it stood, for each friction coefficient of its base. "
        f"{_told(made)}",
        Axis("Friction coefficient", "-", "log"),
        Axis("Largest displacement", "m"),
        tuple(_pictured(one, label) for label, one in made.items()),
        source="Agbabian et al. 1991, Figure 4",
    )


def path_chart(motion: Motion) -> Chart:
    """Return the path of an object that slides with friction 0.05 (Figure 3)."""
    path = trace("sliding", motion, friction_static=PATH_FRICTION)
    every = max(1, len(path) // PATH_POINTS)
    x, y = path["u_x"].to_numpy()[::every], path["u_y"].to_numpy()[::every]
    far = float(np.hypot(path["u_x"], path["u_y"]).max())
    return Chart(
        chart_key("path", motion),
        f"Path of an object with friction {PATH_FRICTION:g}",
        f"Seen from above, from where it stood (0, 0). It gets {100.0 * far:.1f} cm away.",
        Axis("East", "m"),
        Axis("North", "m"),
        (_curve("", x, y),),
        equal=True,
        source="Agbabian et al. 1991, Figure 3",
    )


def swing_chart(motion: Motion, charts: ChartCache) -> Chart:
    """Return the swing of a hung object against its suspension length, for four dampings (Figure 5).

    Parameters
    ----------
    motion
        What it is of.
    charts
        Where response charts are found and kept.

    Returns
    -------
    Chart
        Largest displacement [m] against suspension length [m].

    References
    ----------
    Agbabian et al. (1991), Figure 5.
    """
    made = {label: swing_of(motion, charts, fixed) for label, fixed in SWINGS.items()}
    return Chart(
        chart_key("swing", motion),
        "Swing of a hung object",
        f"Largest sideways displacement in the worst direction (every {SWING_DIRECTIONS:g} degrees), for four damping "
        f"coefficients. {_told(made)}",
        Axis("Suspension length", "m", "log"),
        Axis("Largest displacement", "m"),
        tuple(_pictured(one, label) for label, one in made.items()),
        source="Agbabian et al. 1991, Figure 5",
    )


def isolator_chart(motion: Motion, charts: ChartCache) -> Chart:
    """Return the peak acceleration on a horizontal isolator against its frequency, for four frictions (Figure 6).

    Parameters
    ----------
    motion
        What it is of.
    charts
        Where response charts are found and kept.

    Returns
    -------
    Chart
        Peak acceleration [m/s2] against frequency [Hz].

    References
    ----------
    Agbabian et al. (1991), Figure 6.
    """
    made = {label: isolator_of(motion, charts, fixed) for label, fixed in ISOLATORS.items()}
    return Chart(
        chart_key("isolator", motion),
        "Horizontal isolator",
        f"Peak horizontal acceleration passed on, with 2 % viscous damping and four friction coefficients. "
        f"{_told(made)}",
        Axis("Isolator frequency", "Hz", "log"),
        Axis("Peak acceleration", "m/s2"),
        tuple(_pictured(one, label) for label, one in made.items()),
        source="Agbabian et al. 1991, Figure 6",
    )


def spectrum_chart(motion: Motion) -> Chart:
    """Return the pseudo-acceleration spectrum in the two recorded directions, for 2 and 5 % damping."""
    curves = []
    for label, angle in (("east", 0.0), ("north", 90.0)):
        for damping in (0.02, 0.05):
            table = respond("oscillator", motion, frequency=SPECTRUM_FREQUENCIES, damping=damping, angle=angle)
            name = f"{label}, {100.0 * damping:.0f} %"
            curves.append(_curve(name, SPECTRUM_FREQUENCIES, table["pseudo_acceleration"].to_numpy()))
    return Chart(
        chart_key("spectrum", motion),
        "Acceleration felt by a flexible object",
        "Pseudo-acceleration of an oscillator; a rigid object (33 Hz and more) feels the peak acceleration.",
        Axis("Natural frequency", "Hz", "log"),
        Axis("Pseudo-acceleration", "m/s2"),
        tuple(curves),
        source="Agbabian et al. 1991, sec. 2.5; Nigam and Jennings 1969",
    )
