"""Doubts among the steps of a motion: what is used all the same, and what whoever approves it has to know."""

import re
from collections.abc import Sequence
from math import prod

MAY_HOLD = "may hold "
"""Begins the doubt that a record has a second earthquake in the coda of the first, or a fling step."""

ALL_USED = "; all of it is used, "
"""Ends what is said of a record that has several earthquakes."""

UNDECIDED = "the record does not decide between "
"""Begins what is said where two corners are possible."""

DRIFTS = ": its acceleration drifts against the velocity of its files"
"""Of a processed record whose agency corrected its velocity apart from its acceleration."""

FACTOR = ", and does not say whether its numbers have it already: scale in the manifest multiplies them"
"""Ends what is said of a file whose head names a scale."""

NO_RECORD = "; it may be a spectrum or an envelope, where it is no push of a test"
"""Ends what is said of numbers that never cross zero."""

ALIKE = ": one was given twice, or it is no record of two directions"
"""Ends what is said of a record of which two components are the same numbers."""

ODD_ONE = ", as hardly any earthquake makes them: one of them may be in another unit, or of another sensor or record"
"""Ends what is said of a record whose components differ too much in size."""

TOO_QUICK = ": so little for its acceleration as an earthquake seldom has; look at its time step and its unit"
"""Ends what is said of a record whose PGV is small for its PGA."""

UNLIKE = (
    "; see whether its unit, magnitude and distance are right: --unit of `kouros motions add`, or units, scale, event "
    "and distance_km in the manifest"
)
"""Ends what is said of a record that is far stronger or weaker than its magnitude and distance let expect."""

SENSITIVITY_ALONE = (
    ", which has no response: what the instrument does to the highest and lowest frequencies stays "
    "(level=response has it)"
)
"""Ends what is said of counts that are brought to m/s2 by one number."""

TOO_COARSE = " Hz is not in it, and its peak acceleration is too small; take the record as its instrument sampled it"
"""Ends what is said of a record whose samples are too far apart."""

LARGEST_SCALE = 4.0
"""By which a record is scaled at most without a doubt: a stronger earthquake has other periods and another length."""

_SCALED = re.compile(r"scaled by (\S+) \(")


def scale_of(steps: Sequence[str]) -> float:
    """Return by how much a motion was scaled, 1 where it was not."""
    return prod(float(found[1]) for found in map(_SCALED.match, steps) if found)


def doubts(steps: Sequence[str]) -> tuple[str, ...]:
    """Return what is doubtful of a motion.

    Parameters
    ----------
    steps : sequence of str
        Of the motion.

    Returns
    -------
    tuple of str
        In their order; of a step that says how a corner was chosen, only what is doubtful in it.
    """
    found = []
    for step in steps:
        if UNDECIDED in step:
            found.append("; ".join(step[step.index(UNDECIDED) :].split("; ")[:2]))
        elif (
            step.startswith(MAY_HOLD)
            or ALL_USED in step
            or DRIFTS in step
            or step.endswith((NO_RECORD, ALIKE, ODD_ONE, TOO_QUICK, TOO_COARSE, UNLIKE))
        ):
            found.append(step)
        elif FACTOR in step:
            # Of each component.
            found.append(step.partition(": ")[2])
        elif step.endswith(SENSITIVITY_ALONE):
            found.append(step.partition(", by ")[2])
    scale = scale_of(steps)
    if scale != 0.0 and not 1.0 / LARGEST_SCALE <= abs(scale) <= LARGEST_SCALE * (1.0 + 1e-9):
        found.append(
            f"scaled by {scale:.3g}: so much {'stronger' if abs(scale) > 1.0 else 'weaker'} than it was, it stands for "
            f"no earthquake; take a record that needs a factor of 1/{LARGEST_SCALE:g} to {LARGEST_SCALE:g}, such as "
            "`kouros motions select` chooses"
        )
    return tuple(dict.fromkeys(found))
