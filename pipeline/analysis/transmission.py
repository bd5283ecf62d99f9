"""Transmission of a motion by a support, or a chain of supports, to the objects on it."""

from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.analysis.model_runs import single
from pipeline.errors import InputError
from pipeline.quantities import real_number, some_error
from pipeline.records import Motion
from pipeline.supports import TRANSMITTED, refined, support_named


def transmit(
    support: str, motion: Motion, *, refine: int | None = None, error: float = TRANSMITTED, **parameters: Any
) -> Motion:
    """Return the motion that a support passes on to what stands on it.

    A floor by its factor is exact on the samples of its input, so that no error is asked of it.

    Parameters
    ----------
    support
        A name of ``pipeline.supports.SUPPORTS``.
    motion
        What shakes the support.
    refine
        Samples of the output for each of the input; None: as many as the error asks for.  The input is a polygon, so
        more samples add nothing to it, but what stick and slip pass on jumps between them.
    error
        Largest error of the displacement of an oscillator of 2 to 20 Hz and 5 % damping on the support, as a share of
        its peak; what is reached stands in the last of the motion's steps.
    **parameters
        The support's own, in SI, single numbers.

    Returns
    -------
    Motion
        The absolute acceleration on top of the support [m/s2].

    Raises
    ------
    InputError
        For an unknown support or parameter, and for an error that is not above 0.
    """
    row = support_named(support)
    values = single(row, parameters, "transmit passes a motion through one support")
    if values.get("directions", 2.0) != 2.0:
        raise InputError("transmit passes both horizontal directions on; leave directions out")
    error = some_error(error)
    if refine is not None and not (real_number(refine) >= 1.0 and real_number(refine).is_integer()):
        raise InputError(f"refine must be at least 1, not {refine!r}; a whole number, or None for as many as it takes")
    if refine is not None or not row.refines(values):
        return row.transmit(motion, values, 1 if refine is None else int(refine))
    return refined(lambda samples: row.transmit(motion, values, samples), error)


def cascade(chain: Sequence[tuple[str, Mapping[str, Any]]], motion: Motion, *, error: float = TRANSMITTED) -> Motion:
    """Return the motion on top of a chain of supports, the error shared out equally between them.

    Parameters
    ----------
    chain
        (support, its parameters) from the ground up; empty: the motion itself.
    motion
        What shakes the lowest of them.
    error
        As in `transmit`, of all of them together.

    Returns
    -------
    Motion
        The absolute acceleration on top of the last support [m/s2].

    Raises
    ------
    InputError
        As `transmit`.
    """
    error = some_error(error)
    for support, parameters in chain:
        motion = transmit(support, motion, error=error / len(chain), **parameters)
    return motion
