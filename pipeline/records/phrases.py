"""The phrases in which a run says what it assumed, where numbers come from, what a model adds, what was passed over."""

from pipeline.records.phrase import Clause

STANDS_AS = "; it stands as "
"""Comes behind the rule of a class where somebody decided how the object stands, and before who did."""

SUPPORT = Clause("support: {support}, assumed for: {told}")
SUPPORT_FIXED = Clause("support: {support}, assumed for a post that stands in a footing")
MADE_AS_NAMED = Clause("material: {words}, as its name or its title says")
SUPPORT_TOLD = Clause("support: {support}, as its record says on what it stands")
DISPLAYED = Clause("support: {support}, as its record says of its display: {words}")
SAID_OTHERWISE = Clause(
    "its record contradicts itself: it is {support}, and {other} by the words for its display, so see which holds: "
    "{words}"
)
HELD_AS_DISPLAYED = Clause(
    "support: {support}, taken as made fast at its base until the brace, clips or ties that its record tells of are "
    "recorded as installed: {words}"
)
HELD_BEHIND = Clause(
    "it is held above its base too, as its record says: it bends {factor:-} times as much as if its base alone held it"
)
DISPLAY_WALL = Clause(
    "the wall that it hangs on stands free, as its record says, and nothing is computed of that: see that the wall is "
    "braced or fastened"
)
TWO_BODIES = Clause(
    "its height is that of two bodies, the upper one and what it stands on, which are followed as one: where the "
    "upper one stands loose, it falls sooner"
)
STACKED = Clause(
    "it is a stack, whose pieces are followed as one body: where nothing holds them together, the upper ones slide "
    "and rock on those below, and fall sooner"
)
PIECES = Clause(
    "it is several pieces in one record, taken as one body of the size recorded: a piece that is tall for its base "
    "falls sooner, so record the tallest of them with its own sizes"
)
HEAVY_FOR_FURNITURE = Clause(
    "at {mass:kg~2} it is heavier than {furniture} mostly bears ({bears:kg~2}, judgement): have somebody say what "
    "bears it"
)
HEAVY_FOR_GLASS = Clause(
    "at {mass:kg~2} it is heavier than a shelf of glass mostly bears ({bears:kg~2}, judgement): have somebody say what "
    "bears it"
)
HEAVY_FOR_FLOOR = Clause(
    "it loads its floor by {load:kg/m2~2}, where floors of museums are made for {bears:kg/m2~2}: unless it stands on "
    "the ground, ask an engineer"
)
MOUNT = Clause("mount: it {mount}, assumed for: {told}")
NOT_RECORDED = Clause("not recorded")
HANGING = Clause("hanging: {ways}")
HANGING_NOT_RECORDED = Clause("how it hangs is not recorded")
HANGING_RECORDED = Clause("hanging: {ways}, as recorded")
HANGING_STATED = Clause("hanging: {ways}, by the house rule for {rule}")
HANGING_BY_CORD = Clause(
    "hanging: by a wire or cord, for it hangs from further above its centre than its upper edge is"
)
OTHER_CLASS = Clause("its class is not certain: {told} is possible ({chance:-~2})")
SAY_CLASS = Clause("say what it is")

SIZE = Clause("{size} not recorded: {share:-} of its {of}, as is usual, assumed for: {told}")
SHARE = Clause("{what}: {share:-} of its {of}, assumed for: {told}")
BEARS = Clause("{share:-} of its base bears, assumed: {contact}")
ROLLS = Clause("friction: {friction:-}, for nobody says what keeps it from rolling away: {contact}")
CHOCKED = Clause("friction: {friction:-}, of wheels that do not turn")
ROUND = Clause("{size} not recorded: taken as round")
FACE = Clause("height not recorded: its length of {length:m} is taken for it")
FACE_TURNED = Clause("hung by the long side it is {other:m}")
SECTION_RECORDED = Clause("section: {shape}, as recorded")
SECTION_UNKNOWN = Clause("section: the recorded shape {shape} is not known, and not used")
SOLID = Clause(
    "section: taken as solid from {mass:kg~2} on and as hollow below, its area with its mass: it is hollow or of sheet"
)
POLYGON = Clause("contact polygon, as recorded")
POLYGON_LEAST = Clause("contact polygon, as recorded: {value:m~4}, or {least:m~4} by the least that it may be")
TILTED = Clause("half width: {slope:-~3} times the height of the centre of gravity, by a tilt test")
LEVER = Clause("lever: from the {start} to the centre of gravity")
LEANS = Clause("it leans {lean:°} from upright, assumed")
LEANS_ON = Clause("height of the centre of gravity: it leans on its {size}")

GRIP = Clause("grip of its mount: {grip:-} times its weight sideways, assumed: it {mount}")
OFF_ITS_MOUNT = Clause("clearance: it comes off its mount once it has moved {room:cm} on it, assumed")
CLEARANCE = Clause("clearance: {room:cm} to neighbour, wall or edge, assumed for: {told}")
BOOK_ROOM = Clause("clearance: it falls off its shelf once it has moved {room:cm}, assumed for books in a row")
FRICTION = Clause("friction: {friction:-}, {tables} for {material} on {surface}")
NOT_MEASURED = Clause("not measured")
NO_HARM_BY_ROCKING = Clause("rocking itself is not taken to harm it, assumed for: {told}")

MASS_OF_FRAMED = Clause("mass: {mass:kg/m2} of the face of a framed work, assumed")
MASS_OF_CLOTH = Clause("mass: {mass:kg/m2} of the face of a cloth on a wall, assumed")
MASS_OF_SUSPENDED = Clause("mass: {mass:kg/m2} of the face of what hangs from above, assumed")
MASS_OF_SCREEN = Clause("mass: {mass:kg/m2} of the face of a folding screen, assumed")
STAND_FOOT = Clause("depth: that of its stand, {share:-} of its height, assumed")
SCREEN_FOLDED = Clause("depth not recorded: a folding screen stands {share:-} of its height deep, assumed")
MASS = Clause("mass: {material} of {density:kg/m3} filling {fill:-} of its outline, assumed")
MASS_OF_CLASS = Clause("mass: {material} of {density:kg/m3} filling {fill:-} of its outline ({aside}), assumed")
MASS_OF_SHELL = Clause(
    "mass: {material} of {density:kg/m3} filling {fill:-} of its outline, assumed for such a thing of that material"
)
MASS_OF_USUAL = Clause(
    "mass: {material} of {density:kg/m3}, as such things mostly are, filling {fill:-} of its outline, assumed"
)
STRESS = Clause("allowable stress: {material}, {stress:MPa}, condition factor {factor:-}")
STRESS_UNSEEN = Clause("allowable stress: {material}, {stress:MPa}, condition factor 1 (not recorded)")
CONCENTRATION = Clause("stress where its held base ends: {times:-} times the nominal, assumed for what does not yield")
FREQUENCY = Clause(
    "frequency: {frequency:Hz~2}, as of a cantilever of {material} of {modulus:GPa}, "
    "as slender as its critical section over {share:-} of its height, {times:-} times as stiff as on a perfect clamp"
)
HELD_WHILE_IT_BENDS = Clause("its base is taken as held while it bends, estimated")

LENGTH_FROM_HOOK = Clause(
    "length from hook to centre of gravity: half its height, assumed for: hung from its upper edge"
)
LENGTH_DISPLAYED = Clause(
    "length from hook to centre of gravity: a line of {line:m}, by the words for its display, and half its height"
)
OTHER_HOOKS = Clause("a hook further down gives half of that, a cord from a rail up to {more:m} more")
NO_DAMPING = Clause("damping: none, as the paper takes it for chandeliers")
DAMPING_ON = Clause("damping of {back} on {wall} ({tables})")
DAMPING_LEAST = Clause("damping against the wall: {back} on {wall}, the least of {tables}")
SURFACES_NOT_RECORDED = Clause("wall and back surfaces not recorded")
OWN_DAMPING = Clause("damping of the object itself: {damping:%}, assumed")
HOOK_DEPTH = Clause("depth of its hooks: {span:m~3}, assumed for {ways}")
HOOK_HEIGHT = Clause("height of the hooks above its centre of gravity: {span:m~3}, assumed for {ways}")
HANGERS_BEAR = Clause("what its hangers bear, times its weight: {span:-~3}, assumed for {ways}")
SWING_AND_SLAP = Clause("its load by swing and slap: {span:-~3}, assumed for {ways}")
OFFSET_BY_DEPTH = Clause("centre of gravity in front of its back: {offset:m~3}, of its depth of {depth:m}, assumed")
OFFSET = Clause("centre of gravity in front of its back: {offset:m~3}, depth not recorded, assumed")
REBOUND = Clause("rebound from wall and hooks: {rebound:-} of its speed, assumed")
GYRATION_OF_PLATE = Clause("radius of gyration: a plate")

FURNITURE = Clause("furniture: {furniture}, assumed for: {about}, usual_furniture.csv")
FURNITURE_FROM = Clause("furniture: {furniture}, assumed for: {about} from {height:m} on, usual_furniture.csv")
FURNITURE_RECORDED = Clause("furniture: {furniture}, as recorded")
FURNITURE_STATED = Clause("furniture: {furniture}, by the house rule for {rule}")
FURNITURE_NAMED = Clause("furniture: {furniture}, for its record names the case or plinth {case}")
FURNITURE_SHAKES = Clause("of {frequency:Hz}, or stiff, {table}")
FASTENED = Clause("fastened")
FASTENED_RECORDED = Clause("fastened, as recorded")
FASTENED_STATED = Clause("fastened, by the house rule for {rule}")
FASTENED_TAKEN = Clause("taken as fastened, which nobody says")
LOOSE_RECORDED = Clause("not fastened, as recorded")
LOOSE_STATED = Clause("not fastened, by the house rule for {rule}")
LOOSE_TAKEN = Clause("taken as not fastened, which nobody says")
FURNITURE_DAMPING = Clause("damping of its furniture: {damping:-}, {table} for {furniture}")
FURNITURE_LEVEL = Clause("level: off by up to {angle:°} either way, {table} for {furniture}")
FLOOR_SLOPES = Clause(
    "level: off by up to {angle:°} either way, for its floor is said to slope: measure it, or wedge it level"
)
FURNITURE_HALF_WIDTH = Clause("from the middle of its base to its edge: {span:m}, {table} for {furniture}")
FURNITURE_CG = Clause("height of its centre of gravity: {span:m}, {table} for {furniture}")
FURNITURE_FRICTION = Clause("friction on its floor: {span:-}, {table} for {furniture}")
FURNITURE_HEIGHT = Clause("it stands {height:m} above the floor, {table} for {furniture}")

STATED = Clause("{what}: by the house rule for {rule}")
FAILED = Clause("{without}: Kouros failed, which is not your fault ({words})")
TELL_MAKERS = Clause("please tell its makers")

REACHES = Clause("{check} reaches {times:-~2} times what is allowed by the best estimates")
MAY_BE_MORE = Clause("{check} may still be more than is allowed")
NOTHING_LIMITS = Clause("nothing limits {check} then")
NOTHING_LEFT = Clause("nothing would be left of what {check} is allowed")
MAY_REACH = Clause("{check} may still reach {times:-~2} times what is allowed")
MAY_REACH_AND_DOES = Clause(
    "{check} may still reach {times:-~2} times what is allowed, {best:-~2} times by the best estimates"
)
HARM_REMAINS = Clause("harm would remain with a probability of {chance:%~0f}")
HARM_REMAINS_WITH_ROOM = Clause("with {room:cm~0f} harm would remain with a probability of {chance:%~0f}")
NOT_ENOUGH = Clause("{check} is not enough")
MORE_THAN_BORNE = Clause("{check} is more than it bears")
NEEDS_ROOM = Clause("it would need {room:cm~0f} of room, more than the {allowed:cm~0f} allowed")
NEEDS_ROOM_AROUND = Clause("it would need {room:cm~0f} of room around its plate, more than the {allowed:cm~0f} allowed")
HAS_NO_ROOM = Clause("it would need {room:cm~0f} of room, more than the {allowed:cm~0f} that it can have")
PLATE = Clause("it would need a plate {width:cm~0f} wide")
PLATFORM = Clause("its platform would have to be {width:cm~0f} wide")
LENGTH_ALLOWED = Clause("{limit:cm~0f} is allowed")
HARM_REMAINS_WITH_BALLAST = Clause("with {mass:kg~2} of ballast harm would remain with a probability of {chance:%~0f}")
BALLAST = Clause("it would need {share:%~0f} of its mass")
SHARE_ALLOWED = Clause("{limit:%~0f} is allowed")
LARGER_SECTION = Clause("its section would have to be {times:-~2} times as large")
TIMES_ALLOWED = Clause("{limit:-} is allowed")
TOO_LOW_TO_BRACE = Clause("a brace is out of proportion for what is lower than {height:cm~0f}")
HARMS = Clause("it harms {material}")
HOLDS_AT_MOST = Clause("at most it holds {times:-~2} times what is needed, and {asked:-} times are asked")
SHARES_CASE = Clause("{number} shares its case: {refusal}")
NO_ISOLATOR_UNDER = Clause(
    "the catalogue has no horizontal isolator that keeps to its stroke and none under {stroke:cm~0f}"
)
NO_ISOLATOR_FOR_ALL = Clause(
    "no isolator of the catalogue passes on little enough within its stroke for all {objects:-} objects of its case"
)

# How strong each level is.
LEVEL_ALONE = Clause("Level {case}: 1 motion, PGA {pga:g~3}, PGV {pgv:cm/s~3}")
LEVEL_MEAN = Clause(
    "Level {case}: the mean of {motions:-} motions, PGA {least_pga:g~3} to {pga:g~3}, PGV {least_pgv:cm/s~3} to "
    "{pgv:cm/s~3}"
)
LEVEL_WORST = Clause(
    "Level {case}: the worst of {motions:-} motions, PGA {least_pga:g~3} to {pga:g~3}, PGV {least_pgv:cm/s~3} to "
    "{pgv:cm/s~3}"
)
LEVEL_PERIOD = Clause("return period {years:-} years")
LEVEL_APPROVED = Clause("approved by {words} on {case}")
LEVEL_UNANSWERED = Clause("no engineer has approved these motions")
ON_GROUND = Clause(
    "Every gallery is taken to stand on the ground: the manifest names no upper floors, which would shake more"
)
PHOTOGRAPHS_UNSET = Clause("{objects:-} photographs not looked for: [images] folder names no folder")
PHOTOGRAPH_UNSET = Clause("1 photograph not looked for: [images] folder names no folder")
LEVEL_FLAT = Clause("no vertical shaking was recorded, and none is assumed: {words}")
LEVEL_ESTIMATED = Clause("no vertical shaking was recorded, and an estimate is assumed: {words}")

# What is doubtful in a museum's texts of dimensions.
TAKEN_FOR_WHOLE = Clause("the size of '{words}' is taken for that of the whole object")
SAY_WHOSE = Clause("measure the whole object, or write which size is whose, such as Overall: H 10 x W 5 cm")
NOT_UNDERSTOOD = Clause("not understood: '{words}'")
WRITE_SIZES = Clause("write it as in H 10 x W 5 x D 3 cm, or see that nothing in it matters")
WRITE_OR_EMPTY = Clause("write it as in H 10 x W 5 x D 3 cm, or leave it empty")
NO_SIZE_IN_TEXT = Clause("the text '{words}' holds no dimension that can be read")
FIRST_BELIEVED = Clause("{first:m~4} against {second:m~4}: the first is believed, as the one that was measured")
SECOND_CONVERTED = Clause("the second is usually its conversion")
MEASURE_AND_CORRECT = Clause("measure it again, and correct the text in the museum's database")
WITH_BASE_UNSAID = Clause("whether the height includes that of the base, the height '{words}', is not said")
MEANING_UNKNOWN = Clause("what '{words}' means is not known")
NO_UNIT = Clause("no unit is written, so there is no value")
WRITE_UNIT = Clause('write the unit into the text, or say it in the mapping, [dimensions] unit = "..."')
CORRECT_TEXT = Clause("correct the text in the museum's database")
NO_LOCATION = Clause("the location is empty")
RECORD_LOCATION = Clause("record its current location")
NOT_SHOWN_UNTIL_THEN = Clause("until then it counts as not on display")

# What is wrong with a row or a cell of a museum's list.
HEADS_OR_SUMS = Clause("'{words}' has no figure in it and nothing but numbers beside it: a heading, or a sum")
HEADS_MERGED = Clause("'{words}' is merged across all columns: a heading")
LEAVE_OR_NUMBER = Clause("leave it out, or give the object a number and a place")
HEADS_NOTHING = Clause("'{words}' stands alone in its row, as a heading does, and no row below it")
LEAVE_OR_FILL = Clause("leave it out, or fill the row")
HAS_NO_NUMBER = Clause("the object has no number")
GIVE_NUMBER = Clause("give it one in the museum's database")
NUMBER_TWICE = Clause("object number '{words}' was given in row {number} already")
ROW_KEPT = Clause("only that row is kept")
OWN_NUMBER = Clause("give each object its own number, and export one row an object")
NO_HAND_NUMBER = Clause("column '{words}': '{filled}' is no number with a unit that is known")
WRITE_ONE = Clause("write one number in {words}, or with its unit, as 8 1/2 or 0.3")
NO_UNIT_NUMBER = Clause("column '{words}': '{filled}' is no number with its unit")
WRITE_WITH_UNIT = Clause("write it as in 23 cm or 8 1/2 in")
HIDDEN_BY_MERGING = Clause("column '{words}': is one of the merged cells {number}")
UNMERGE = Clause("unmerge them, and fill in every row and column")
HOLDS_FORMULA = Clause("column '{words}': holds a formula")
PASTE_VALUES = Clause("copy the column and paste it as values")
NOT_COMPUTED = Clause("formulas are not computed here")
MEND_CELL = Clause("mend the cell, or empty it")
MEASURE_OR_EMPTY = Clause("measure it, or leave the cell empty")
GIVEN_TWICE = Clause("the record gives it twice: {filled} and {words}")
SAY_WHICH_PART = Clause("say in the record which part each is of, or delete the wrong one")
ITS_DIAMETER = Clause("its diameter")

# What stands in the record beside a sheet that was filled in.
SHEET_LENGTH = Clause("the museum's record says {recorded:m~6}, the sheet {sheet} says {filled:m~6}, which is used")
SHEET_MASS = Clause("the museum's record says {recorded:kg~6}, the sheet {sheet} says {filled:kg~6}, which is used")
SHEET_OTHER = Clause("the museum's record says {recorded}, the sheet {sheet} says {filled}, which is used")
SEE_WHICH = Clause("see which is right: mend the museum's record, or fill in a new sheet")

# What a record says twice, and not alike.
TEXT_DIFFERS = Clause("the text says {text:m~4} ({reasons}), its own column {column:m~4}")
TEXT_WEIGHS_OTHERWISE = Clause("the text says {text:kg~4} ({reasons}), its own column {column:kg~4}")
COLUMN_USED = Clause("the column is used")
TEXT_USED = Clause("the text is used")
WHICH_IS_RIGHT = Clause("see which is right, and correct the other")
ORDERED = Clause("by the order height x width x depth")
OF_ITSELF = Clause("of the object itself")
OF_NAMED = Clause("of '{words}'")
FRAMED = Clause("framed")
AS_IT_HANGS = Clause("as it hangs")
LARGEST_OF = Clause("the largest of {objects:-} alike")
BASE_WIDER = Clause("the base is {base:m~4} wide, the object at its widest {widest:m~4}")
MEASURE_BOTH = Clause("measure both again")
BASE_USED = Clause("the base is used, as overall sizes are often given without it")
HEIGHT_USED = Clause("the height is used")
LIES_ABOVE = Clause("the {size} at {above:m~4} would lie above the object, which is {height:m~4} high")
NO_FIELD_HOLDS = Clause("the text also gives {words}, which no field holds")
WHOSE_IS_IT = Clause("see which of them is the object's, and correct the text in the museum's database")
NAME_NUMBERS = Clause("write which number is which, such as H 10 x W 5 cm")
ONLY_PART_WEIGHED = Clause("only a part is weighed ({mass:kg~4}), which is not the mass of the object")
WEIGH_WHOLE = Clause("weigh the whole object")

PHRASES = tuple(
    sorted((one for one in globals().values() if isinstance(one, Clause)), key=lambda one: one.letters, reverse=True)
)
"""All of them, those with the most words of their own first: they say more than others that match the same clause."""


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
