"""Measures in a plain sentence, for who does the work: what to do and what to set, without engineering.

The full sentence of a measure, with the moment, the margin and the friction, stays in the folded part of an entry.
"""

from collections.abc import Callable, Iterable, Mapping
from math import ceil, floor, log10

from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.mitigate.fixing_rows import fixing_strengths
from pipeline.mitigate.measures.fixings import FINISHED
from pipeline.mitigate.saying import (
    ANCHORED,
    AT_BEST,
    EACH_PIECE,
    ENGINEER,
    HEAVIEST,
    HELD_FIRST,
    OF_MEAN,
    ONLY_AT_BEST,
    SAID_AS_IT_IS,
    SIZED,
    SIZED_WEIGHED,
    UPPER_FIRST,
)
from pipeline.quantities import G
from pipeline.records import Finding, Recommendation
from pipeline.report.language import _, said
from pipeline.report.pages.tallies import finding_state
from pipeline.report.pages.views import Judged
from pipeline.report.text import clean
from pipeline.report.units import Units, by_hand, significant

AMPLE = 20.0
"""Times what is needed [-] above which nobody asks how many: a few grams are held hundreds of times over."""


def full_measure(advice: Recommendation) -> str:
    """Return the sentence of a measure in the reader's language, with its places still to be filled."""
    sentence = said(advice.sentence)
    ample = advice.parameters.get("margin", 0.0) > AMPLE
    return sentence.replace("{margin}", _("more than 20")) if ample else sentence


def plain_measure(advice: Recommendation, units: Units) -> str:
    """Return what is advised in plain sentences.

    Parameters
    ----------
    advice : Recommendation
        With its numbers in SI.
    units : Units
        The reader's; weights stand for forces.

    Returns
    -------
    str
        Of a measure that is not known here, as one of another package, its title.
    """
    of_weight = times_weight(advice)
    at_best = any(one in advice.sentence for one in ONLY_AT_BEST)
    told, numbers = _advised(advice, units, of_weight=of_weight)
    told += cautions(advice)
    if OF_MEAN in advice.sentence:
        told.append(_("That is for the mean of the earthquakes: in the worst of them it moves %(worst)s.") % numbers)
    if HEAVIEST in advice.sentence:
        heaviest = (
            _(
                "That is %(likely)s if it weighs %(weight)s, as is likeliest, and %(most)s if it weighs %(heaviest)s, "
                "the most."
            )
            if of_weight
            else _("That is for %(heaviest)s, the most that it may weigh; %(weight)s is likelier.")
        ) % numbers
        told.append(heaviest if at_best else f"{_('Weigh it first.')} {heaviest}")
    if NAMED_FIRST in advice.sentence:
        told.append(_("Before that, say what it is: for another kind of object this may not be enough."))
    named, weighed = NAMED_FIRST in advice.sentence, AT_BEST not in advice.sentence
    if at_best and named:
        told.append(
            _("Have its base and weakest part measured too.")
            if weighed
            else _("Have it weighed too, and its base and weakest part measured.")
        )
    elif at_best:
        told.append(
            _("This may not be enough: have its base and weakest part measured first.")
            if weighed
            else _("This may not be enough: have it weighed and its base and weakest part measured first.")
        )
    elif SIZED in advice.sentence:
        told.append(_("Weigh it and measure its base first."))
    elif SIZED_WEIGHED in advice.sentence:
        told.append(_("Measure its base first."))
    return " ".join(told)


def cautions(advice: Recommendation) -> list[str]:
    """Return what whoever does it has to mind, a sentence each."""
    told = [said(row.care) for row in fixing_strengths().values() if row.care in advice.sentence]
    told += [said(one) for one in SAID_AS_IT_IS if one in advice.sentence]
    if FINISHED in advice.sentence:
        told.append(_("It has paint, gilding or lacquer: ask a conservator first where it may be touched."))
    return told


def brief_measure(advice: Recommendation, units: Units) -> str:
    """Return what is advised as a list of many objects says it: what to do, and what to find out before.

    Parameters
    ----------
    advice, units
        As of `plain_measure`.
    """
    told, _numbers = _advised(advice, units, brief=True, of_weight=times_weight(advice))
    if NAMED_FIRST in advice.sentence:
        told.append(_("Before that, say which of the kinds named in its entry it is."))
    elif weighed_first(advice):
        told.append(_("Weigh it first."))
    return " ".join(told)


def times_weight(advice: Recommendation) -> str:
    """Return a force that is for the most that an object may weigh, in times its weight; "" for any other.

    Where nobody knows what an object weighs it holds for whatever the scales say, and the force on a solid block of its
    size, a tonne for an andiron, is no number to work by.
    """
    heaviest, force = (advice.parameters.get(name, 0.0) for name in ("heaviest", "force"))
    if HEAVIEST not in advice.sentence or heaviest <= 0.0 or force <= 0.0:
        return ""
    times = force / (heaviest * G)
    step = 10.0 ** (floor(log10(times)) - 1)
    return _("%(number)s times its weight") % {"number": significant(ceil(times / step - 1e-6) * step, 2)}


def weighed_first(advice: Recommendation) -> bool:
    """Whether an object is to be weighed before its measure is built."""
    return any(one in advice.sentence for one in (HEAVIEST, AT_BEST, SIZED))


def _advised(
    advice: Recommendation, units: Units, *, brief: bool = False, of_weight: str = ""
) -> tuple[list[str], dict[str, str]]:
    """Return the sentences of what is done, and the numbers of the measure as people write them.

    brief : whether why an engineer is needed is left to the entry
    of_weight : what stands for the force, "" for the weight that it is
    """
    write = by_hand(units)
    numbers = {name: write(name, value, advice.units.get(name, "")) for name, value in advice.parameters.items()}
    if of_weight:
        heaviest, weight, force = (advice.parameters[name] for name in ("heaviest", "weight", "force"))
        numbers["most"], numbers["force"] = numbers["force"], of_weight
        numbers["likely"] = write("force", force * weight / heaviest, advice.units.get("force", ""))
    told = [_("First have what it stands in fastened.")] if ANCHORED in advice.sentence else []
    if HELD_FIRST in advice.sentence:
        told.append(_("First record what holds it now as installed."))
    if UPPER_FIRST in advice.sentence:
        told.append(_("First fix each upper body to the one that it stands on."))
    if EACH_PIECE in advice.sentence:
        told.append(_("Do it for each of its pieces."))
    if ENGINEER in advice.sentence:
        told.append(_("Have an engineer design it.") if brief else said(ENGINEER))
    phrase = _PHRASES[advice.measure]() if advice.measure in _PHRASES else ""
    try:
        told.append(phrase % numbers if phrase else f"{said(clean(advice.title))}.")
    except KeyError:
        # Results of another version may lack a number: its title is true in any case.
        told.append(f"{said(clean(advice.title))}.")
    return told, numbers


# Looked up in the language of the page.
_PHRASES: Mapping[str, Callable[[], str]] = {
    "chocks": lambda: _("Chock every wheel on both sides, or set it on padded blocks, so that it does not roll."),
    "clearance": lambda: _("Keep %(clearance)s free on all sides."),
    "anchor": lambda: _("Have what it stands in fastened to the floor or a wall."),
    "rubber_pads": lambda: _("Put rubber pads behind its lower corners."),
    "surface": lambda: _("Stand it on a rougher surface; its entry names one."),
    "grip_pad": lambda: _("Stand it on a non-slip pad that neither stains nor gives off gases."),
    "pins": lambda: _("Set %(pieces)s padded brass pins round its foot."),
    "wax": lambda: _("Fix it with %(pieces)s dots of microcrystalline wax, %(size)s across, under its base."),
    "putty": lambda: _("Fix it with %(pieces)s pads of museum putty, %(size)s across, under its base."),
    "ties": lambda: _(
        "Tie it down with %(pieces)s nylon lines round its body, never round a limb, a handle or a neck: together they "
        "must hold %(force)s sideways."
    ),
    "clips": lambda: _("Hold its foot by %(pieces)s padded clips: together they must hold %(force)s sideways."),
    "ballast": lambda: _("Put %(mass)s of ballast low into its base, in sealed and padded bags."),
    "wide_base": lambda: _(
        "Fix it to a plate %(width)s wide and deep, with %(clearance)s free around: the fixing must hold "
        "%(force)s sideways."
    ),
    "brackets": lambda: _(
        "Fix its top to the wall by %(pieces)s steel brackets: together they must hold %(force)s sideways."
    ),
    "clamps": lambda: _("Clamp its base by %(pieces)s padded clamps: together they must hold %(force)s sideways."),
    "fasten": lambda: _("Fasten its base: the mount must hold %(force)s sideways."),
    "brace": lambda: _(
        "Brace it from behind at a height of %(height)s, where the brace must hold %(force)s sideways, and fasten its "
        "base."
    ),
    "armature": lambda: _(
        "Have an armature made for its back, which holds it at %(height)s and %(second)s and bears %(force)s sideways, "
        "and fasten its base."
    ),
    "close_hooks": lambda: _("Close its hooks, so that it cannot jump out of them."),
    "hold": lambda: _("Have a mount-maker hold it on its mount, for %(times)s times its weight."),
    "restrain": lambda: _("Fix it to the wall at its lower corners too: the fixings must hold %(force)s together."),
    "stays": lambda: _(
        "Have it stayed from swinging by three or more lines or rods to the ceiling, the walls or the case all round: "
        "each must hold %(force)s. Give it a slack safety line too."
    ),
    "friction_isolator": lambda: _("Stand it on a low-friction pad, with %(clearance)s free on all sides."),
    "horizontal_isolator": lambda: _("Have it fastened to an isolator that moves by up to %(stroke)s."),
    "rotational_isolator": lambda: _("Have it mounted on an elastic pad."),
    "strengthen": lambda: _("Have its weakest part strengthened, and its base fastened to hold %(force)s sideways."),
    "remove": lambda: _("Take it off display, or have an engineer design its mount."),
}


def dangers(findings: Iterable[Finding]) -> str:
    """Say what an object may do by what it does not pass: "It may tip over, slide or break."; "" for nothing.

    Parameters
    ----------
    findings : iterable of Finding
        Of the object, the most urgent first; one of a model of another package is told by its title.

    Returns
    -------
    str
    """
    failing = [f for f in findings if finding_state(f) is not Judged.PASSES]
    if any(f.model not in _DANGERS for f in failing):
        return ", ".join(dict.fromkeys(said(clean(f.title)) for f in failing)) + "."
    told = list(dict.fromkeys(_DANGERS[f.model]() for f in failing))
    several = _(" or ").join(filter(None, (", ".join(told[:-1]), *told[-1:])))
    return _("It may %(dangers)s.") % {"dangers": several} if told else ""


# Looked up in the language of the page.
_DANGERS: Mapping[str, Callable[[], str]] = {
    "standing": lambda: _("tip over"),
    "rocking": lambda: _("rock too far"),
    "sliding": lambda: _("slide too far"),
    "stress": lambda: _("break at its weakest part"),
    "flexible_stress": lambda: _("break at its weakest part"),
    "swing": lambda: _("swing too far"),
    "swing_3d": lambda: _("swing too far"),
    "unhooking": lambda: _("jump off its hooks"),
    "hanger_load": lambda: _("tear its hangers out"),
    "unanchored": lambda: _("fall with what it stands in"),
    "friction_isolator": lambda: _("need more room than its isolator has"),
    "horizontal_isolator": lambda: _("need more room than its isolator has"),
    "rotational_isolator": lambda: _("ask more of its isolator than that can give"),
}
