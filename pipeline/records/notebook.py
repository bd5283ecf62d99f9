"""How records show themselves in a notebook: a table, a small picture, and axes to draw on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np

from pipeline.errors import KourosError
from pipeline.quantities import Array

_WIDTH, _HEIGHT = 480, 60
"""Size of a small picture, in pixels."""


def table(caption: str, rows: Mapping[str, Iterable[str]]) -> str:
    """Return rows of texts as a table in HTML; whatever they say, they stay texts.

    Parameters
    ----------
    caption : str
        Of the table.
    rows : mapping of str to iterable of str
        Heading of a row -> its lines.

    Returns
    -------
    str
        HTML.
    """
    said = "".join(
        f'<tr><th style="text-align:left">{escape(head)}</th>'
        f'<td style="text-align:left">{"<br>".join(escape(line) for line in lines)}</td></tr>'
        for head, lines in rows.items()
    )
    return f"<table><caption>{escape(caption)}</caption>{said}</table>"


def small_picture(values: Array, label: str) -> str:
    """Return a series as a picture of its own size, without a script: what it reaches in each column of pixels.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.
    label : str
        For those who cannot see it.

    Returns
    -------
    str
        SVG.
    """
    parts = np.array_split(values, min(values.size, _WIDTH))
    reach = float(np.abs(values).max()) or 1.0
    middle = _HEIGHT / 2.0
    step = _WIDTH / len(parts)

    def y(value: float) -> str:
        return f"{middle - value / reach * (middle - 1.0):.1f}"

    points = "".join(f"L{(i + 0.5) * step:.1f} {y(p.min())}V{y(p.max())}" for i, p in enumerate(parts))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{escape(label)}" width="{_WIDTH}" '
        f'height="{_HEIGHT}" viewBox="0 0 {_WIDTH} {_HEIGHT}"><path d="M0 {y(0.0)}{points}" fill="none" '
        f'stroke="currentColor"/></svg>'
    )


def axes_for(rows: int, given: Any = None) -> Any:
    """Return axes to draw on, one below another.

    Parameters
    ----------
    rows : int
        How many.
    given : Axes or array of Axes, optional
        The caller's own; None: of a new figure.

    Returns
    -------
    ndarray of Axes, shape (rows,)

    Raises
    ------
    KourosError
        Where matplotlib is not installed, or another number of axes is given.
    """
    if given is not None:
        own = np.atleast_1d(np.asarray(given, dtype=object)).ravel()
        if own.size != rows:
            raise KourosError(f"there {'is 1 axis' if rows == 1 else f'are {rows} axes'} to draw on, not {own.size}")
        return own
    try:
        from matplotlib import pyplot
    except ImportError as problem:
        raise KourosError("drawing needs matplotlib: pip install matplotlib") from problem
    _, made = pyplot.subplots(
        rows, 1, sharex=True, squeeze=False, figsize=(8.0, 1.0 + 1.8 * rows), layout="constrained"
    )
    return made[:, 0]
