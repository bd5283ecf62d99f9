"""Root of a function of time between two ends of opposite sign: the Illinois variant of the false position."""

from pipeline.kernels import inlined


@inlined
def trial(low: float, high: float, at_low: float, at_high: float) -> float:
    r"""Return the time to try next: by the false position, or the middle where that is not inside.

    .. math::

        t = \frac{t_{low} f_{high} - t_{high} f_{low}}{f_{high} - f_{low}}

    Parameters
    ----------
    low, high : float
        Ends of the bracket, s.
    at_low, at_high : float
        Values there, which must differ.

    Returns
    -------
    float
        In s.

    References
    ----------
    Dowell, M. and Jarratt, P. (1971). A modified regula falsi method for computing the root of an equation. BIT 11,
    168-174.
    """
    t = (low * at_high - high * at_low) / (at_high - at_low)
    return t if low < t < high else 0.5 * (low + high)


@inlined
def narrowed(
    low: float, high: float, at_low: float, at_high: float, side: int, t: float, value: float
) -> tuple[float, float, float, float, int]:
    """Return the bracket with the value at a time as its new end; an end that stays twice is worth half.

    Parameters
    ----------
    low, high, at_low, at_high : float
        As in `trial`.
    side : int
        The end that moved last: 1 high, -1 low, 0 none yet.
    t, value : float
        The time that was tried [s], and the value there.

    Returns
    -------
    tuple
        low, high, at_low, at_high, side.

    References
    ----------
    Dowell and Jarratt (1971), as in `trial`.
    """
    if (value > 0.0) == (at_high > 0.0):
        return low, t, (0.5 * at_low if side == 1 else at_low), value, 1
    return t, high, value, (0.5 * at_high if side == -1 else at_high), -1
