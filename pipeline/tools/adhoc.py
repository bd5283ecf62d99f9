"""One model on one site, ad hoc."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.cache import Cache
from pipeline.operations.workspace import UsageError, charts_of, site_folder
from pipeline.records import Motion, Numerics

if TYPE_CHECKING:
    from pipeline.settings import Settings


def respond_on_site(
    model: str,
    parameters: Sequence[str],
    site: str,
    *,
    through: Sequence[str] = (),
    angle: str,
    fidelity: str,
    tail: float | None,
    settings: "Settings | None" = None,
) -> list[dict[str, Any]]:
    """Run one model under every motion of a site, as it comes through a chain of supports.

    Parameters
    ----------
    model : str
        Its name.
    parameters : sequence of str
        "name=value" or "name=value,value,..." in SI.
    site : str
        Its folder, or "demo".
    through : sequence of str
        The supports from the ground up, each "name:parameter=value,parameter=value" in SI.
    angle : str
        Degrees, or "worst".
    fidelity : str
        As of `Numerics`.
    tail : float or None
        As of `respond`.
    settings : Settings or None
        Of the workspace in which charts and processed motions are kept; None keeps motions in the user's cache, and no
        charts.

    Returns
    -------
    list of dict
        The rows of `respond`'s table with the motion and the parameters in front, for each motion.

    Raises
    ------
    UsageError
        For words that are not name=value.
    InputError
        As `respond`.
    MotionError
        For a site that cannot be used.
    """
    from pipeline.analysis.response import answer
    from pipeline.analysis.transmission import cascade

    given: dict[str, Any] = dict(_parsed(word) for word in parameters)
    direction = None if angle == "worst" else _number("angle", angle)
    rows: list[dict[str, Any]] = []
    chain = [_support(word) for word in through]
    with charts_of(settings) as charts:
        for ground in _motions(site, settings):
            motion = cascade(chain, ground)
            found = answer(model, motion, given, Numerics(fidelity), angle=direction, tail=tail, charts=charts)
            size = len(found["note"])
            columns = {"motion": [motion.name] * size}
            columns |= {name: values * size if len(values) == 1 else values for name, values in given.items()}
            columns |= {name: np.asarray(values).tolist() for name, values in found.items()}
            rows += [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    return rows


def _motions(site: str, settings: "Settings | None") -> Sequence[Motion]:
    from pipeline.kernels import user_cache
    from pipeline.motions.site import motions_of, read_site

    folder = site_folder(Path(), site)
    if settings is None:
        kept = user_cache("motions")
        motions = motions_of(folder, kept=kept)
        Cache(kept).prune()
        return motions
    # Processed once for the nights and for this.
    found = read_site(folder, kept=settings.kept)
    return [one.motion for level in found.levels for one in level.motions]


def _support(word: str) -> tuple[str, dict[str, Any]]:
    name, _, rest = word.partition(":")
    values = {}
    for part in filter(None, rest.split(",")):
        parameter, numbers = _parsed(part)
        values[parameter] = numbers[0]
    return name, values


def _parsed(word: str) -> tuple[str, list[float]]:
    name, equals, values = word.partition("=")
    if not equals or not name or not values:
        raise UsageError(f"{word!r} is not NAME=VALUE, such as friction_static=0.2")
    return name, [_number(name, value) for value in values.split(",")]


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as problem:
        raise UsageError(f"{name}: {text!r} is not a number") from problem
