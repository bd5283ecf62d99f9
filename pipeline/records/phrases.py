"""The phrases in which a run says what it assumed, where its numbers come from, and why measures were passed over."""

from pipeline.records.phrase import Phrase

SUPPORT = Phrase("support: {support}, assumed for: {told}")
MOUNT = Phrase("mount: it {mount}, assumed for: {told}")
NOT_RECORDED = Phrase("not recorded")
HANGING = Phrase("hanging: {ways}")
HANGING_NOT_RECORDED = Phrase("how it hangs is not recorded")
HANGING_RECORDED = Phrase("hanging: {ways}, as recorded")
HANGING_STATED = Phrase("hanging: {ways}, by the house rule for {rule}")
HANGING_BY_CORD = Phrase(
    "hanging: by a wire or cord, for it hangs from further above its centre than its upper edge is"
)
OTHER_CLASS = Phrase("its class is not certain: {told} is possible ({chance:-~2})")
SAY_CLASS = Phrase("say what it is")

SIZE = Phrase("{size} not recorded: {share:-} of its {of}, as is usual, assumed for: {told}")
SHARE = Phrase("{what}: {share:-} of its {of}, assumed for: {told}")
BEARS = Phrase("{share:-} of its base bears, assumed: {contact}")
ROUND = Phrase("{size} not recorded: taken as round")
SECTION_RECORDED = Phrase("section: {shape}, as recorded")
SECTION_UNKNOWN = Phrase("section: the recorded shape {shape} is not known, and not used")
SOLID = Phrase(
    "section: taken as solid from {mass:kg~2} on and as hollow below, its area with its mass: it is of metal"
)
POLYGON = Phrase("contact polygon, as recorded")
POLYGON_LEAST = Phrase("contact polygon, as recorded: {value:m~4}, or {least:m~4} by the least that it may be")
TILTED = Phrase("half width: {slope:-~3} times the height of the centre of gravity, by a tilt test")
LEVER = Phrase("lever: from the {start} to the centre of gravity")
LEANS = Phrase("it leans {lean:°} from upright, assumed")
LEANS_ON = Phrase("height of the centre of gravity: it leans on its {size}")

GRIP = Phrase("grip of its mount: {grip:-} times its weight sideways, assumed: it {mount}")
OFF_ITS_MOUNT = Phrase("clearance: it comes off its mount once it has moved {room:cm} on it, assumed")
CLEARANCE = Phrase("clearance: {room:cm} to neighbour, wall or edge, assumed for: {told}")
FRICTION = Phrase("friction: {friction:-}, {tables} for {material} on {surface}")
NOT_MEASURED = Phrase("not measured")
NO_HARM_BY_ROCKING = Phrase("rocking itself is not taken to harm it, assumed for: {told}")

MASS_OF_FRAMED = Phrase("mass: {mass:kg} for each square metre of a framed work, assumed")
MASS = Phrase("mass: {material} of {density:kg/m3} filling {fill:-} of its outline, assumed")
MASS_OF_CLASS = Phrase("mass: {material} of {density:kg/m3} filling {fill:-} of its outline ({aside}), assumed")
MASS_OF_METAL = Phrase(
    "mass: {material} of {density:kg/m3} filling {fill:-} of its outline, assumed for what is made of metal"
)
STRESS = Phrase("allowable stress: {material}, {stress:MPa}, condition factor {factor:-}")
STRESS_UNSEEN = Phrase("allowable stress: {material}, {stress:MPa}, condition factor 1 (not recorded)")
CONCENTRATION = Phrase("stress where its held base ends: {times:-} times the nominal, assumed for what does not yield")
FREQUENCY = Phrase(
    "frequency: {frequency:Hz~2}, as of a cantilever of {material} of {modulus:GPa}, "
    "as slender as its critical section over {share:-} of its height, {times:-} times as stiff as on a perfect clamp"
)
HELD_WHILE_IT_BENDS = Phrase("its base is taken as held while it bends, estimated")

LENGTH_FROM_HOOK = Phrase(
    "length from hook to centre of gravity: half its height, assumed for: hung from its upper edge"
)
OTHER_HOOKS = Phrase("a hook further down gives half of that, a cord from a rail up to {more:m} more")
NO_DAMPING = Phrase("damping: none, as the paper takes it for chandeliers")
DAMPING_ON = Phrase("damping of {back} on {wall} ({tables})")
DAMPING_LEAST = Phrase("damping against the wall: {back} on {wall}, the least of {tables}")
SURFACES_NOT_RECORDED = Phrase("wall and back surfaces not recorded")
OWN_DAMPING = Phrase("damping of the object itself: {damping:%}, assumed")
HOOK_DEPTH = Phrase("depth of its hooks: {span:m~3}, assumed for {ways}")
HOOK_HEIGHT = Phrase("height of the hooks above its centre of gravity: {span:m~3}, assumed for {ways}")
HANGERS_BEAR = Phrase("what its hangers bear, times its weight: {span:-~3}, assumed for {ways}")
SWING_AND_SLAP = Phrase("its load by swing and slap: {span:-~3}, assumed for {ways}")
OFFSET_BY_DEPTH = Phrase("centre of gravity in front of its back: {offset:m~3}, of its depth of {depth:m}, assumed")
OFFSET = Phrase("centre of gravity in front of its back: {offset:m~3}, depth not recorded, assumed")
REBOUND = Phrase("rebound from wall and hooks: {rebound:-} of its speed, assumed")
GYRATION_OF_PLATE = Phrase("radius of gyration: a plate")

FURNITURE = Phrase("furniture: {furniture}, assumed for: {about}, usual_furniture.csv")
FURNITURE_FROM = Phrase("furniture: {furniture}, assumed for: {about} from {height:m} on, usual_furniture.csv")
FURNITURE_RECORDED = Phrase("furniture: {furniture}, as recorded")
FURNITURE_STATED = Phrase("furniture: {furniture}, by the house rule for {rule}")
FURNITURE_NAMED = Phrase("furniture: {furniture}, for its record names the case or plinth {case}")
FURNITURE_SHAKES = Phrase("of {frequency:Hz}, or stiff, {table}")
FASTENED = Phrase("fastened")
FASTENED_RECORDED = Phrase("fastened, as recorded")
FASTENED_STATED = Phrase("fastened, by the house rule for {rule}")
FASTENED_TAKEN = Phrase("taken as fastened, which nobody says")
LOOSE_RECORDED = Phrase("not fastened, as recorded")
LOOSE_STATED = Phrase("not fastened, by the house rule for {rule}")
LOOSE_TAKEN = Phrase("taken as not fastened, which nobody says")
FURNITURE_DAMPING = Phrase("damping of its furniture: {damping:-}, {table} for {furniture}")
FURNITURE_LEVEL = Phrase("level: off by up to {angle:°} either way, {table} for {furniture}")
FURNITURE_HALF_WIDTH = Phrase("from the middle of its base to its edge: {span:m}, {table} for {furniture}")
FURNITURE_CG = Phrase("height of its centre of gravity: {span:m}, {table} for {furniture}")
FURNITURE_FRICTION = Phrase("friction on its floor: {span:-}, {table} for {furniture}")
FURNITURE_HEIGHT = Phrase("it stands {height:m} above the floor, {table} for {furniture}")

STATED = Phrase("{what}: by the house rule for {rule}")
FAILED = Phrase("{without}: Kouros failed, which is not your fault ({words})")
TELL_MAKERS = Phrase("please tell its makers")

REACHES = Phrase("{check} reaches {times:-~2} times what is allowed by the best estimates")
MAY_BE_MORE = Phrase("{check} may still be more than is allowed")
NOTHING_LIMITS = Phrase("nothing limits {check} then")
NOTHING_LEFT = Phrase("nothing would be left of what {check} is allowed")
MAY_REACH = Phrase("{check} may still reach {times:-~2} times what is allowed")
MAY_REACH_AND_DOES = Phrase(
    "{check} may still reach {times:-~2} times what is allowed, {best:-~2} times by the best estimates"
)
HARM_REMAINS = Phrase("harm would remain with a probability of {chance:%~0f}")
HARM_REMAINS_WITH_ROOM = Phrase("with {room:cm~0f} harm would remain with a probability of {chance:%~0f}")
NOT_ENOUGH = Phrase("{check} is not enough")
MORE_THAN_BORNE = Phrase("{check} is more than it bears")
NEEDS_ROOM = Phrase("it would need {room:cm~0f} of room, more than the {allowed:cm~0f} allowed")
NEEDS_ROOM_AROUND = Phrase("it would need {room:cm~0f} of room around its plate, more than the {allowed:cm~0f} allowed")
HAS_NO_ROOM = Phrase("it would need {room:cm~0f} of room, more than the {allowed:cm~0f} that it can have")
PLATE = Phrase("it would need a plate {width:cm~0f} wide")
PLATFORM = Phrase("its platform would have to be {width:cm~0f} wide")
LENGTH_ALLOWED = Phrase("{limit:cm~0f} is allowed")
BALLAST = Phrase("it would need {share:%~0f} of its mass")
SHARE_ALLOWED = Phrase("{limit:%~0f} is allowed")
LARGER_SECTION = Phrase("its section would have to be {times:-~2} times as large")
TIMES_ALLOWED = Phrase("{limit:-} is allowed")
TOO_LOW_TO_BRACE = Phrase("a brace is out of proportion for what is lower than {height:cm~0f}")
HARMS = Phrase("it harms {material}")
HOLDS_AT_MOST = Phrase("at most it holds {times:-~2} times what is needed, and {asked:-} times are asked")
SHARES_CASE = Phrase("{number} shares its case: {refusal}")
NO_ISOLATOR_UNDER = Phrase(
    "the catalogue has no horizontal isolator that keeps to its stroke and none under {stroke:cm~0f}"
)
NO_ISOLATOR_FOR_ALL = Phrase(
    "no isolator of the catalogue passes on little enough within its stroke for all {objects:-} objects of its case"
)

PHRASES = tuple(
    sorted((one for one in globals().values() if isinstance(one, Phrase)), key=lambda one: one.letters, reverse=True)
)
"""All of them, those with the most words of their own first: they say more than others that match the same clause."""
