r"""Impact of a corner of a rigid body on a surface with Coulomb friction: no rebound, the impulse by Routh's method.

With r = (r_x, r_y) [m] from the centre of gravity to the corner, rho [m] the radius of gyration and P [m/s] the impulse
per mass, the corner's velocity c = (c_x, c_y) [m/s] changes by

.. math::

    \Delta c_x = A P_x - B P_y, \quad \Delta c_y = -B P_x + C P_y, \qquad
    A = 1 + \frac{r_y^2}{\rho^2}, \; B = \frac{r_x r_y}{\rho^2}, \; C = 1 + \frac{r_x^2}{\rho^2}

While the corner slips P_x = -mu_k sign(c_x) P_y; where it has stopped it sticks if mu_s >= ``|B|``/A, and slips the
other way if not.  The impact ends when c_y = 0.  A corner that sticks throughout turns about itself afterwards, which
is Housner's landing.

References
----------
Routh, E. J. (1905). The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies. Macmillan. Art. 180.
Shenton, H. W. and Jones, N. P. (1991). Base excitation of rigid bodies. I: formulation. Journal of Engineering
Mechanics 117, 2286-2306.
"""

import math

from pipeline.kernels import fused


@fused
def impulse(
    cx: float, cy: float, rx: float, ry: float, rho2: float, mu_s: float, mu_k: float
) -> tuple[float, float, float]:
    """Return the impulse on a corner, and the velocity along the surface that the corner is left with.

    Parameters
    ----------
    cx, cy : float
        Its velocity before, m/s; cy < 0.
    rx, ry : float
        From the centre of gravity to it, m.
    rho2 : float
        Radius of gyration squared, m2.
    mu_s, mu_k : float
        Friction at rest and while slipping [-].

    Returns
    -------
    tuple of float
        Px, Py per mass and the velocity cx after, m/s.
    """
    a, b, c = 1.0 + ry * ry / rho2, rx * ry / rho2, 1.0 + rx * rx / rho2
    px, py = 0.0, 0.0
    if cx != 0.0:
        way = 1.0 if cx > 0.0 else -1.0
        slow, brake = way * mu_k * a + b, c + way * mu_k * b
        stops = cx / slow if cx * slow > 0.0 else math.inf
        ends = -cy / brake if brake > 0.0 else math.inf
        if ends <= stops:
            return -way * mu_k * ends, ends, cx - slow * ends
        px, py = -way * mu_k * stops, stops
        cy += brake * stops
    if abs(b) <= mu_s * a:
        more = -cy / (c - b * b / a)
        return px + b / a * more, py + more, 0.0
    way = -1.0 if b > 0.0 else 1.0
    more = -cy / (c + way * mu_k * b)
    return px - way * mu_k * more, py + more, -(way * mu_k * a + b) * more


@fused
def held(cx: float, cy: float, rx: float, ry: float, rho2: float) -> tuple[float, float]:
    """Return the impulse that stops a corner for good, whatever friction that needs.

    Parameters
    ----------
    cx, cy, rx, ry, rho2
        As in `impulse`.

    Returns
    -------
    tuple of float
        Px, Py per mass, m/s.
    """
    a, b, c = 1.0 + ry * ry / rho2, rx * ry / rho2, 1.0 + rx * rx / rho2
    whole = a * c - b * b
    return (-c * cx - b * cy) / whole, (-a * cy - b * cx) / whole
