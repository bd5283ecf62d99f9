"""What stands on a chart, and under it, with numbers: titles, captions and names of lines, as a run stores them."""

from pipeline.records.phrase import Clause

STABILITY = Clause(
    "Peak resultant acceleration {push:-~2f}\u00a0g, velocity {speed:cm/s~0f}. H' is twice the height of the centre of "
    "gravity. Below H' = {crossing:cm~0f} there is no band in which an object rocks without overturning. The lines are "
    "the paper's closed-form criteria, which let nothing slide; the verdict comes from friction, the vertical shaking "
    "and the time history."
)
PATH = Clause("Path of an object with friction {friction:-}")
PATH_SEEN = Clause("Seen from above, from where it stood (0, 0). It gets {far:cm~1f} away.")
EAST = Clause("east, {damping:%~0f}")
NORTH = Clause("north, {damping:%~0f}")
OF_DAMPING = Clause("damping {damping:-~2f}")
OF_FRICTION = Clause("friction {friction:-~2f}")
DRAWN_FROM = Clause(
    "Drawn from {count} analyses, closest together where the response turns. Error measured at points held out: at "
    "most {errors} of the value, or of a hundredth of the largest value where that is more."
)

CHART_WORDS = tuple(one for one in globals().values() if isinstance(one, Clause))
"""All of them."""
