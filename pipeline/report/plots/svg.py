"""SVG as a tree of elements, which is escaped and written as text in one place."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from pipeline.kernels.thinning import needed

Point = tuple[float, float]
"""Pixels from the left and from the top of a picture."""


class Element(NamedTuple):
    """An element: its name, its attributes (without those that are None), and what it holds, as it came."""

    tag: str
    attributes: dict[str, str | float | None]
    children: "tuple[Element | str, ...]"


def write(*nodes: Element | str) -> Markup:
    """Write elements and texts as SVG; whatever they hold stays text.

    Parameters
    ----------
    *nodes : Element or str
        In the order in which they are painted.

    Returns
    -------
    Markup
        Numbers have one decimal, none where it is 0.
    """
    return Markup("".join(map(_written, nodes)))  # noqa: S704 - all that came from outside has been escaped


def _written(node: Element | str) -> str:
    if isinstance(node, str):
        return escape(node)
    given = ((k, v if isinstance(v, str) else number(v)) for k, v in node.attributes.items() if v is not None)
    start = node.tag + "".join(f' {name}="{escape(value)}"' for name, value in given)
    return f"<{start}>{''.join(map(_written, node.children))}</{node.tag}>" if node.children else f"<{start}/>"


def number(value: float) -> str:
    """Write a length or a place in pixels."""
    return f"{value:.1f}".removesuffix(".0")


# -- elements ---------------------------------------------------------------------------------------------------------


def element(tag: str, *children: Element | str, **attributes: str | float | None) -> Element:
    """Return an element; ``class_`` stands for class and ``stroke_width`` for stroke-width."""
    return Element(tag, {k.rstrip("_").replace("_", "-"): v for k, v in attributes.items()}, children)


def path(kind: str, d: str, *children: Element, **attributes: str | float | None) -> Element:
    """Return a path; its kind is the class of its style."""
    return element("path", *children, class_=kind, **attributes, d=d)


def rect(
    kind: str | None, left: float, top: float, width: float, height: float, *, turned: str | None = None,
    round_: float | None = None,
) -> Element:  # fmt: skip
    """Return a rectangle, turned by a transform, with corners rounded by a radius."""
    return element("rect", class_=kind, transform=turned, x=left, y=top, width=width, height=height, rx=round_)


def text(words: str, x: float, y: float, kind: str | None = None) -> Element:
    """Return a line of text that begins, ends or is centred at a point, as its kind's style says."""
    return element("text", words, class_=kind, x=x, y=y)


def sideways(words: str, x: float, y: float) -> Element:
    """Return the name of a vertical axis: it reads upwards, and its middle is at the point."""
    return element("text", words, class_="al", transform=f"translate({number(x)} {number(y)})rotate(-90)")


def hatch(ident: str, size: int, ground: str, *lines: Element, turn: int | None = None) -> Element:
    """Return a pattern of squares of a size, which a shape's style names by its id to be filled with it."""
    square = element("rect", width=size, height=size, fill=ground)
    turned = None if turn is None else f"rotate({turn})"
    return element(
        "pattern", square, *lines, id=ident, width=size, height=size, patternUnits="userSpaceOnUse",
        patternTransform=turned,
    )  # fmt: skip


def stripe(size: int, colour: str, width: float) -> Element:
    """Return the line of a pattern of a size that hatches."""
    return element("path", d=f"M0 0V{size}", stroke=colour, stroke_width=width)


def picture(
    kind: str, width: float, height: float, title: str, told: str, drawn: Iterable[Element], ident: str = "",
    role: str = "img",
) -> Markup:  # fmt: skip
    """Return a whole picture.

    Parameters
    ----------
    kind : str
        Class of its style.
    width, height : float
        Size of what is drawn in pixels; on a page it is as wide as its style says.
    title, told : str
        What it is called, and what it shows, for those who do not see it.
    drawn : iterable of Element
        In the order in which they are painted.
    ident : str, optional
        Begins the ids by which title and description are referred to; "" for none.
    role : str, optional
        "group" for a picture that one can go through.

    Returns
    -------
    Markup
        An ``<svg>`` to be put into a page.
    """
    names = (f"{ident}t", f"{ident}d") if ident else (None, None)
    words = (element("title", title, id=names[0]), element("desc", told, id=names[1]))
    labelled = f"{ident}t {ident}d" if ident else None
    view = f"0 0 {number(width)} {number(height)}"
    return write(element("svg", *words, *drawn, class_=kind, viewBox=view, role=role, aria_labelledby=labelled))


# -- data of paths ----------------------------------------------------------------------------------------------------


def through(points: Sequence[Point]) -> str:
    """Return the data of a path through the points."""
    return "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points)


def upright(x: float, start: float, end: float) -> str:
    """Return the data of a vertical line."""
    return f"M{number(x)} {number(start)}V{number(end)}"


def level(y: float, start: float, end: float) -> str:
    """Return the data of a horizontal line."""
    return f"M{number(start)} {number(y)}H{number(end)}"


def thin(points: Sequence[Point], tolerance: float = 0.3) -> list[Point]:
    """Drop points that lie within the tolerance of the line through their neighbours (Douglas and Peucker)."""
    x, y = np.array(points, np.float64).reshape(-1, 2).T
    return [points[i] for i in np.flatnonzero(needed(x.copy(), y.copy(), tolerance)).tolist()]
