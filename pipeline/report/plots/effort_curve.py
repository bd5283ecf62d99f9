"""The picture of a plan: what of the expected loss is left after so many hours of work."""

from collections.abc import Sequence

from markupsafe import Markup

from pipeline.report.language import _
from pipeline.report.plots.panel import Panel, Scale, limits
from pipeline.report.plots.svg import Element, element, level, path, picture, text, through, upright
from pipeline.report.text import count

WIDTH, HEIGHT = 720.0, 330.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 20.0, 14.0, 52.0

POINTS = 400
"""Corners that are drawn, at most: no more can be told apart on a page."""


def effort_curve(
    corners: Sequence[tuple[float, float]],
    at: tuple[float, float, float],
    left: float,
    limit: float | None,
    most: float,
) -> Markup:
    """Return the picture of what is left against hours.

    Parameters
    ----------
    corners : sequence of (float, float)
        Hours [h] and share of the expected loss that is left [-], from nothing done on.
    at : float, float, float
        Hours of the plan [h], as expected, and their ends.
    left : float
        Share that the plan leaves [-].
    limit : float or None
        Hours that there are [h].
    most : float
        Hours at the right end [h].

    Returns
    -------
    Markup
        An ``<svg>``.
    """
    hours = limits([0.0, max(most, 1.0)], False, "hours of the plan")
    panel = Panel(Scale(*hours, _LEFT, WIDTH - _RIGHT), Scale(0.0, 100.0, HEIGHT - _BOTTOM, _TOP))
    drawn = _thinned([(h, s) for h, s in corners if h <= most] or list(corners[:1]))
    beyond = next(((h, s) for h, s in corners if h > most), None)
    if beyond is not None and most > drawn[-1][0]:
        (h0, s0), (h1, s1) = drawn[-1], beyond
        drawn = [*drawn, (most, s0 + (s1 - s0) * (most - h0) / (h1 - h0))]
    line = [panel.at(h, 100.0 * s) for h, s in drawn]
    x, y = panel.at(at[0], 100.0 * left)
    over: list[Element] = []
    if limit is not None and limit <= hours[1]:
        over.append(path("gd", upright(panel.x.at(limit), panel.y.end, panel.y.start)))
    over += [
        path("cu", level(y, panel.x.at(at[1]), panel.x.at(at[2]))),
        element("circle", class_="mk", cx=x, cy=y, r=6.0),
        text(_("this plan"), x + 11 if x < WIDTH - 110 else x - 11, y - 9, "ml" if x < WIDTH - 110 else "ml e"),
        panel.name_x(_("Hours of work")),
        panel.name_y(_("Expected loss that is left (%)"), 14),
    ]
    told = _(
        "Share of the expected loss that is left against hours of work, what avoids most for an hour done first: "
        "%(points)s. This plan takes %(hours)s hours (%(low)s to %(high)s) and leaves %(left)s %%."
    ) % {
        "points": "; ".join(
            _("%(left)s %% after %(hours)s hours") % {"left": f"{100.0 * s:.0f}", "hours": count(round(h))}
            for h, s in _told(drawn)
        ),
        "hours": count(round(at[0])),
        "low": count(round(at[1])),
        "high": count(round(at[2])),
        "left": f"{100.0 * left:.0f}",
    }
    lines = [path("cu", through(line))]
    return picture(
        "chart", WIDTH, HEIGHT, _("What is left for the work"), told, panel.drawn("pl", (), lines, over), ident="pl"
    )


def _thinned(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    step = -(-len(points) // POINTS)
    return [*points[::step], *(points[-1:] if (len(points) - 1) % step else [])]


def _told(points: Sequence[tuple[float, float]]) -> Sequence[tuple[float, float]]:
    """Return a few points that tell how the curve runs."""
    step = max(1, -(-len(points) // 5))
    return [*points[::step], *(points[-1:] if (len(points) - 1) % step else [])]
