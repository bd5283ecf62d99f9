"""Doubts among the steps of a motion: what is used all the same, and what whoever approves it has to know."""

from collections.abc import Sequence

MAY_HOLD = "may hold "
"""Begins the doubt that a record has a second earthquake in the coda of the first."""

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
        elif step.startswith(MAY_HOLD) or ALL_USED in step or DRIFTS in step or step.endswith(NO_RECORD):
            found.append(step)
        elif FACTOR in step:
            # Of each component.
            found.append(step.partition(": ")[2])
    return tuple(dict.fromkeys(found))
