"""The charts and the motion of the builder's record: shapes as in the paper's figures, from closed forms."""

from math import cos, exp, pi, sin, sqrt

from pipeline.records import Axis, Chart, Curve, MotionSummary, Zone

HASH = "5f3a9c0de1b24788a6d0c1f29e5b7a3344556677889900aabbccddeeff001122"
PGA, PGV = 0.70, 0.62  # g and m/s: the paper's Representative Earthquake is 0.7 g


def _geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    return tuple(low * (high / low) ** (i / (count - 1)) for i in range(count))


def charts() -> dict[str, Chart]:
    heights = _geometric(0.05, 4.0, 60)
    onset = tuple(PGA * h for h in heights)
    over = tuple(min(PGV * sqrt(h), 0.98 * o) for h, o in zip(heights, onset, strict=True))
    bottom, top = 0.02, 3.5
    stability = Chart(
        key=f"stability:{HASH}",
        title="Rocking stability",
        caption="Above the upper line an object stays still, below the lower one it falls, between them it rocks.",
        x=Axis("Equivalent height H′ = 2h", "m", "log"),
        y=Axis("Base width B", "m", "log"),
        curves=(Curve("uplift", heights, onset), Curve("overturning", heights, over)),
        zones=(
            Zone("stays still", (*heights, heights[-1], heights[0]), (*onset, top, top), "safe"),
            Zone("rocks", (*heights, *reversed(heights)), (*over, *reversed(onset)), "warn"),
            Zone("overturns", (*heights, heights[-1], heights[0]), (*over, bottom, bottom), "danger"),
        ),
        source="Agbabian et al. 1991, Figure 2",
    )
    mu = tuple(0.02 + 0.01 * i for i in range(50))
    friction = Chart(
        key=f"friction:{HASH}",
        title="Largest sliding displacement",
        caption="How far an object slides, for each friction coefficient.",
        x=Axis("Friction coefficient", "-"),
        y=Axis("Largest displacement", "m"),
        curves=(Curve("this motion", mu, tuple(0.25 * exp(-6 * m) for m in mu)),),
        source="Agbabian et al. 1991, Figure 4",
    )
    turns = [i * 0.02 for i in range(1500)]
    path = Chart(
        key=f"path:0.05:{HASH}",
        title="Path of sliding on the floor",
        caption="Seen from above: the way that the object takes, from where it stood to where it comes to rest.",
        x=Axis("East", "m"),
        y=Axis("North", "m"),
        curves=(
            Curve(
                "comes to rest",
                tuple(0.11 * sin(1.3 * t) * exp(-0.08 * t) + 0.001 * t for t in turns),
                tuple(0.07 * (cos(0.9 * t) - 1) * exp(-0.05 * t) for t in turns),
            ),
        ),
        equal=True,
        source="Agbabian et al. 1991, Figure 3",
    )
    lengths = tuple(0.1 + 0.05 * i for i in range(60))
    swing = Chart(
        key=f"swing:{HASH}",
        title="Swing of a hanging painting",
        caption="How far a painting swings along its wall, for its suspension length and damping.",
        x=Axis("Suspension length", "m"),
        y=Axis("Largest displacement", "m"),
        curves=tuple(
            Curve(
                f"damping {c:.2f}",
                lengths,
                tuple(0.35 * (1 - exp(-1.4 * s)) * (1 + 0.2 * sin(5 * s)) / (1 + 9 * c) for s in lengths),
            )
            for c in (0.0, 0.05, 0.10, 0.20)
        ),
        source="Agbabian et al. 1991, Figure 5",
    )
    frequencies = _geometric(0.2, 5.0, 60)
    isolator = Chart(
        key=f"isolator:{HASH}",
        title="Horizontal isolator",
        caption="Largest acceleration of the isolated object, against the isolator's frequency, at 2 % damping.",
        x=Axis("Isolator frequency", "Hz", "log"),
        y=Axis("Largest acceleration", "m/s2"),
        curves=tuple(
            Curve(
                f"friction {m:.2f}",
                frequencies,
                tuple(9.80665 * (m + 1.1 * (1 - m * 3) * f**2 / (f**2 + 3)) for f in frequencies),
            )
            for m in (0.05, 0.10, 0.15, 0.20)
        ),
        source="Agbabian et al. 1991, Figure 6",
    )
    return {c.key: c for c in (stability, friction, path, swing, isolator)}


def motion() -> MotionSummary:
    t = tuple(i * 0.02 for i in range(1000))
    wave = {
        "x": tuple(6.86 * exp(-(((s - 6) / 3.5) ** 2)) * sin(2 * pi * 1.6 * s + 0.4 * sin(s)) for s in t),
        "y": tuple(5.20 * exp(-(((s - 7) / 4.0) ** 2)) * sin(2 * pi * 1.1 * s + 0.9) for s in t),
        "z": tuple(3.90 * exp(-(((s - 5) / 3.0) ** 2)) * sin(2 * pi * 4.3 * s) for s in t),
    }
    return MotionSummary(
        name="Malibu design motion",
        hash=HASH,
        level="design",
        source="Synthetic, for tests",
        dt=0.005,
        samples=3997,
        measures={
            "pga": PGA * 9.80665,
            "pgv": PGV,
            "pgd": 0.21,
            "arias_intensity": 4.2,
            "significant_duration": 7.9,
        },
        steps=("mean removed", "band-pass 0.1 to 25 Hz, acausal", "scaled by 1.08 (PGA of the level)"),
        licence="CC0",
        series={"t": t, **wave},
    )
