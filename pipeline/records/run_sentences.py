"""Sentences with numbers that a model adds to a finding: what happens in a motion, and the screens of the paper."""

from pipeline.records.phrase import Clause

LIFTS = Clause("A_max/g = {push:-~2f} against B/H' = {slope:-~2f}: rocks.")
STAYS_DOWN = Clause("A_max/g = {push:-~2f} against B/H' = {slope:-~2f}: does not rock.")
OVERTURNS = Clause("V_max is {ratio:-~2} times 10 B/sqrt(H'): overturns.")
STAYS_UP = Clause("V_max is {ratio:-~2} times 10 B/sqrt(H'): does not overturn.")
SLIDES_BEFORE = Clause("But its friction of {friction:-~2f} lets it slide before it tips.")
SWING_UNDAMPED = Clause("1.4 times the undamped swing in one plane: {swing:cm~0f}.")
TILT_TEST = Clause("Tilt test: would it break if it were tilted {tilt:°~0f}?")
NO_TILT = Clause("Tilt test: the peak acceleration is 1 g or more; no tilt reproduces it.")

FALLS_OVER = Clause("In this motion it falls over after {time:s~1f}.")
COMES_BACK = Clause(
    "It comes back: it tips by at most {share:%~0f} of its critical angle and lands {times:-~0f} times."
)
COMES_BACK_MOVED = Clause(
    "It comes back: it tips by at most {share:%~0f} of its critical angle and lands {times:-~0f} times; "
    "its base ends {away:cm~1f} from where it stood."
)
SLIDES_ONLY = Clause("It does not tilt; it slides {away:cm~1f}.")
OPENS = Clause("Its lower edge opens by {angle:°~0f} and strikes the wall at {speed:cm/s~0f}.")
MOVES_ON_FLOOR = Clause("By the best estimates it moves {away:cm~1f} on its floor.")
STAYS_ON_FLOOR = Clause("By the best estimates it stays where it stands.")

SENTENCES = tuple(one for one in globals().values() if isinstance(one, Clause))
"""All of them."""
