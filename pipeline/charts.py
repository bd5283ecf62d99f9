"""Response charts of one motion: the paper's Figures 2 to 6, drawn from the site's own record."""

from collections.abc import Callable, Sequence

import numpy as np

from pipeline.models.common import largest_push, largest_speed
from pipeline.models.rocking import VELOCITY_SCREEN
from pipeline.quantities import Array, G
from pipeline.records import Axis, Chart, Curve, Executor, Motion, Zone
from pipeline.response import respond, trace

FRICTIONS = tuple(float(v) for v in np.round(np.geomspace(0.02, 0.8, 48), 4))
LENGTHS = tuple(float(v) for v in np.round(np.geomspace(0.05, 5.0, 48), 4))
ISOLATOR_FREQUENCIES = tuple(float(v) for v in np.round(np.geomspace(0.1, 10.0, 33), 4))
SPECTRUM_FREQUENCIES = tuple(float(v) for v in np.round(np.geomspace(0.2, 50.0, 96), 4))
SWING_DAMPINGS = (0.0, 0.05, 0.10, 0.20)
ISOLATOR_FRICTIONS = (0.05, 0.10, 0.15, 0.20)
ISOLATOR_DAMPING = 0.02
PATH_FRICTION = 0.05
PATH_POINTS = 1500


def chart_key(kind: str, motion: Motion) -> str:
    """Return the identity of a motion's chart, which marks refer to."""
    return f"{kind}:{motion.hash[:16]}"


KINDS = ("stability", "sliding", "path", "swing", "isolator", "spectrum")
"""Kinds of charts drawn of each motion."""


def chart_keys(motion: Motion) -> list[str]:
    """Return the identities of all charts of a motion."""
    return [chart_key(kind, motion) for kind in KINDS]


def charts(motion: Motion, executor: Executor) -> dict[str, Chart]:
    """Return all charts of a motion, by key."""
    makers: Sequence[Callable[[Motion], Chart]] = (
        stability_chart,
        sliding_chart,
        path_chart,
        swing_chart,
        isolator_chart,
        spectrum_chart,
    )
    made = executor.map(lambda make: make(motion), makers)
    return {chart.key: chart for chart in made}


def _curve(label: str, x: Sequence[float] | Array, y: Sequence[float] | Array) -> Curve:
    return Curve(label, tuple(float(f"{v:.5g}") for v in x), tuple(float(f"{v:.5g}") for v in y))


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


def sliding_chart(motion: Motion) -> Chart:
    """Return the largest sliding displacement against friction (Figure 4)."""
    table = respond("sliding", motion, friction_static=FRICTIONS)
    return Chart(
        chart_key("sliding", motion),
        "Sliding against friction",
        "Largest distance an object slides from where it stood, for each friction coefficient of its base.",
        Axis("Friction coefficient", "-", "log"),
        Axis("Largest displacement", "m"),
        (_curve("", FRICTIONS, table["displacement"].to_numpy()),),
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


def swing_chart(motion: Motion) -> Chart:
    """Return the swing of a hung object against its suspension length, for four dampings (Figure 5)."""
    lengths, dampings = np.meshgrid(LENGTHS, SWING_DAMPINGS, indexing="ij")
    table = respond("swing", motion, length=lengths.ravel(), damping=dampings.ravel(), angle=None, azimuth_step=30.0)
    swings = table["displacement"].to_numpy().reshape(lengths.shape)
    return Chart(
        chart_key("swing", motion),
        "Swing of a hung object",
        "Largest sideways displacement in the worst direction (every 30 degrees), for four damping coefficients.",
        Axis("Suspension length", "m", "log"),
        Axis("Largest displacement", "m"),
        tuple(_curve(f"damping {d:.2f}", LENGTHS, swings[:, i]) for i, d in enumerate(SWING_DAMPINGS)),
        source="Agbabian et al. 1991, Figure 5",
    )


def isolator_chart(motion: Motion) -> Chart:
    """Return the peak acceleration on a horizontal isolator against its frequency, for four frictions (Figure 6)."""
    frequencies, frictions = np.meshgrid(ISOLATOR_FREQUENCIES, ISOLATOR_FRICTIONS, indexing="ij")
    table = respond(
        "horizontal_isolator",
        motion,
        frequency=frequencies.ravel(),
        friction=frictions.ravel(),
        damping=ISOLATOR_DAMPING,
    )
    peaks = table["acceleration"].to_numpy().reshape(frequencies.shape)
    return Chart(
        chart_key("isolator", motion),
        "Horizontal isolator",
        "Peak horizontal acceleration passed on, with 2 % viscous damping and four friction coefficients.",
        Axis("Isolator frequency", "Hz", "log"),
        Axis("Peak acceleration", "m/s2"),
        tuple(_curve(f"friction {m:.2f}", ISOLATOR_FREQUENCIES, peaks[:, i]) for i, m in enumerate(ISOLATOR_FRICTIONS)),
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
