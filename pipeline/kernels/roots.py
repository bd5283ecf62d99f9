"""Where a function of time vanishes between two ends of opposite sign: the Illinois variant of the false position."""

from pipeline.kernels import inlined


@inlined
def trial(low: float, high: float, at_low: float, at_high: float) -> float:
    """Return the time to try next; at_low and at_high must differ."""
    t = (low * at_high - high * at_low) / (at_high - at_low)
    return t if low < t < high else 0.5 * (low + high)


@inlined
def narrowed(
    low: float, high: float, at_low: float, at_high: float, side: int, t: float, value: float
) -> tuple[float, float, float, float, int]:
    """Return the bracket with the value at t as its new end, and the side that moved.

    side : the last one that moved (1 high, -1 low, 0 none yet); an end that stays twice is worth half
    """
    if (value > 0.0) == (at_high > 0.0):
        return low, t, (0.5 * at_low if side == 1 else at_low), value, 1
    return t, high, value, (0.5 * at_high if side == -1 else at_high), -1
