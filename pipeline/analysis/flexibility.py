r"""How an object bends where nobody measured it: its lowest natural frequency as a range, and its base where held.

What is as slender as the critical section, over a length L above it, is a beam of stiffness E I; what stands on it is a
rigid body.  With the deflection v and L times the slope at the top of the beam, its mass m_b, and the body's mass m_c,
centre of gravity c L above that and radius of gyration r L,

.. math::

    \frac{E I}{L^3} \begin{pmatrix} 12 & -6 \\ -6 & 4 \end{pmatrix}, \qquad
    \frac{m_b}{420} \begin{pmatrix} 156 & -22 \\ -22 & 4 \end{pmatrix}
    + m_c \begin{pmatrix} 1 & c \\ c & c^2 + r^2 \end{pmatrix}

are stiffness and mass (one element of a beam with its consistent mass), and the lowest eigenvalue is in closed form.  A
beam without mass is met exactly, as sqrt(3 E I / (m L^3)) for a mass on its tip; a uniform cantilever comes out 0.5 %
too high.

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.5: an oscillator whose frequency and damping are
estimated; sec. 2.6: stress concentration at a clamped base.

Clough, R. W. and Penzien, J. (2003). Dynamics of Structures, 3rd ed. Sec. 10-3: the consistent mass of a beam element.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, hypot, log, pi, sqrt

from pipeline.analysis.section import Section
from pipeline.models.stress import RIGID_PERIOD
from pipeline.records import Estimate, Item, Origin
from pipeline.records import phrases as say
from pipeline.tables import Range
from pipeline.tables.assumed import assumed
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.bending_rows import bending, slender_shares


def cantilever_frequency(
    stiffness: float, length: float, beam: float, body: float, reach: float, gyration: float
) -> float:
    """Return the lowest natural frequency of a rigid body on a beam that is clamped at its foot [Hz].

    Parameters
    ----------
    stiffness : float
        E I of the beam [N m2].
    length : float
        Of the beam [m].
    beam, body : float
        Their masses [kg].
    reach : float
        From the top of the beam up to the body's centre of gravity [m].
    gyration : float
        Radius of gyration of the body about its centre of gravity [m].

    Returns
    -------
    float

    References
    ----------
    Clough and Penzien (2003), sec. 10-3.
    """
    reach, gyration = reach / length, gyration / length
    m11 = beam * 156.0 / 420.0 + body
    m12 = -beam * 22.0 / 420.0 + body * reach
    m22 = beam * 4.0 / 420.0 + body * (reach**2 + gyration**2)
    # det(K - x M) = 12 - b x + d x^2, written so that the smaller root loses no digits.
    b, d = 12.0 * m22 + 4.0 * m11 + 12.0 * m12, m11 * m22 - m12**2
    root = 24.0 / (b + sqrt(max(b * b - 48.0 * d, 0.0)))
    return sqrt(root * stiffness / length**3) / (2.0 * pi)


@dataclass(frozen=True, slots=True)
class Body:
    """What bends.

    Attributes
    ----------
    section : Section
        The critical one.
    mass, cg : Estimate
        [kg], and the height of the centre of gravity above the base [m].
    height : float or None
        [m]; None: twice the centre of gravity's.
    foot : float
        Height of the section above the base [m].
    width : float or None
        [m]; None: not known, and what stands on the slender part is taken as thin.
    """

    section: Section
    mass: Estimate
    cg: Estimate
    height: float | None
    foot: float
    width: float | None

    def frequency(
        self, modulus: float, inertia: float, slender: float, restraint: float, mass: float, cg: float
    ) -> float:
        """Return its lowest natural frequency [Hz] for one set of numbers.

        Parameters
        ----------
        modulus : float
            Young's [Pa].
        inertia : float
            Second moment of the section [m4].
        slender : float
            Share of what is above the section that is as slender as it [-].
        restraint : float
            Stiffness over that of a perfect clamp [-].
        mass, cg : float
            As of the class.

        Returns
        -------
        float
            NaN where nothing stands above the section.
        """
        above, lever = (self.height or 2.0 * cg) - self.foot, cg - self.foot
        if above <= 0.0 or lever <= 0.0:
            return float("nan")
        length = slender * above
        # Both parts uniform, and shared so that the centre of gravity of all is where it is.
        beam = mass * min(max((above + length - 2.0 * lever) / above, 0.0), 1.0)
        rest = above - length
        reach, gyration = max(0.5 * rest, lever - length), hypot(rest, self.width or 0.0) / sqrt(12.0)
        return cantilever_frequency(restraint * modulus * inertia, length, beam, mass - beam, reach, gyration)


def estimated_frequency(body: Body, row: ObjectClass, material: Material) -> Estimate | None:
    """Return the lowest natural frequency of an object that may be flexible.

    Each number at its ends alone moves the logarithm of the frequency; the ends of the range are the roots of the sums
    of the squares of these, as it would be wrong to have all numbers at their ends at once.

    Parameters
    ----------
    body : Body
        What bends.
    row : ObjectClass
        Its class.
    material : Material
        What it is made of.

    Returns
    -------
    Estimate or None
        [Hz]; None where its whole range is rigid (a period below RIGID_PERIOD), or nothing says how much of it bends.
    """
    share, modulus = slender_shares().get(row.name), _elastic(material)
    if share is None or modulus is None:
        return None
    clamp = bending("restraint")
    low, value, high = (body.section.inertia(end) for end in ("low", "value", "high"))
    best: Mapping[str, float] = {
        "modulus": modulus.value, "inertia": value, "slender": share.value, "restraint": clamp.value,
        "mass": body.mass.value, "cg": body.cg.value,
    }  # fmt: skip
    ends: Mapping[str, tuple[float, float]] = {
        "modulus": (modulus.low, modulus.high), "inertia": (low, high), "slender": (share.low, share.high),
        "restraint": (clamp.low, clamp.high), "mass": (body.mass.low, body.mass.high),
        "cg": (body.cg.low, body.cg.high),
    }  # fmt: skip
    value, low, high = spread(body.frequency, best, ends)
    if not low < 1.0 / RIGID_PERIOD:
        # Of what is rigid nothing more need be said; so of what nothing is known (NaN).
        return None
    note = say.FREQUENCY(
        frequency=(low, value, high), material=material.told, modulus=modulus, share=share, times=clamp
    )
    note = f"{note}; {say.HELD_WHILE_IT_BENDS()}"
    return Estimate(value, "Hz", Origin.ASSUMED, low, high, note, f"{share.source}; {modulus.source}; {clamp.source}")


def spread(
    of: Callable[..., float], best: Mapping[str, float], ends: Mapping[str, tuple[float, float]]
) -> tuple[float, float, float]:
    """Return the best value of a positive function, and the ends of its range over inputs that are independent.

    Parameters
    ----------
    of : callable
        Of the inputs by name.
    best : mapping of str to float
        The best of each.
    ends : mapping of str to (float, float)
        What each may be.

    Returns
    -------
    value, low, high : float
        The ends are exp of the root of the sum of the squares of what each input moves the logarithm by, down and up.
    """
    value = of(**best)
    down, up = 0.0, 0.0
    for name, both in ends.items():
        moves = [log(of(**{**best, name: one}) / value) for one in both]
        down, up = hypot(down, min(0.0, *moves)), hypot(up, max(0.0, *moves))
    return value, value * exp(-down), value * exp(up)


def concentration(item: Item, material: Material) -> Estimate | None:
    """Return what the bending stress in the critical section is multiplied by once its base is held [-].

    Parameters
    ----------
    item : Item
        Its record; a section that it says to be above the base is not at the clamp.
    material : Material
        What it is made of; what is ductile yields at the clamp before it breaks, and none is counted: judgement.

    Returns
    -------
    Estimate or None
        None for 1.
    """
    ductile = material.ductile
    if ductile is None:
        ductile = assumed().materials[material.name].ductile
    if ductile or item.section_height_m:
        return None
    found = bending("concentration")
    note = say.CONCENTRATION(times=found)
    return Estimate(found.value, "-", Origin.ASSUMED, found.low, found.high, note, found.source)


def _elastic(material: Material) -> Range | None:
    """Return Young's modulus [Pa], Kouros's own where a museum's row leaves it out."""
    return material.modulus_range or assumed().materials[material.name].modulus_range
