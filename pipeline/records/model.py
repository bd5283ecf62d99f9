"""A row of the registry of generic models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pipeline.quantities import Array, Quantity
from pipeline.records.motion import Excitation
from pipeline.records.scene import Scene

Columns = dict[str, Array]
"""Output name -> (n,) values; "error" and "note" (bit flags, see models.common.NOTES) are always there."""


@dataclass(frozen=True)
class Bounds:
    """What the outputs of a model lie between, for certain.

    outputs : output name -> (low, high), (n,) each, of the first output always; a yes or no is bounded by 0 and 1
    note    : (n,) bit flags, see models.common.NOTES
    """

    outputs: Mapping[str, tuple[Array, Array]]
    note: Array


@dataclass(frozen=True)
class ChartAxis:
    """The parameter along which a model's response is tabulated: smooth but for kinks, and never below zero.

    All other parameters are fixed for a chart: where they differ there is another one.

    low, high : where charts are made, above zero, nodes evenly in the logarithm at first; what lies outside is
                integrated
    nodes     : analyses that a chart good enough to tell verdicts takes under strong shaking: fewer sets are integrated
    absent    : optional parameters; a set that has one of them is not on the chart
    settled   : (excitation) -> value from which on the response no longer changes; None: it always does
    leads     : whether verdicts rest on the first output alone, so that a chart for them need not follow the others
    """

    name: str
    low: float
    high: float
    nodes: int
    absent: tuple[str, ...] = ()
    settled: Callable[[Excitation], float] | None = None
    leads: bool = False


@dataclass(frozen=True)
class Model:
    """A generic model or isolator: one row of the registry (see pipeline.models.MODELS).

    needs      : its parameters, in the order a caller would name them
    gives      : its outputs; the first is the one that ranks directions (RotD100) and carries the error
    directions : 1 (along an angle), 2 (both horizontal directions) or 0 (the parameter `directions` says)
    run        : (excitation, parameters, refine, estimate) -> columns; parameters are broadcast (n,) arrays, refine
                 divides the standard step; without estimate the error is left out (NaN) and the cost is a third
    errors     : output -> column of `run` with its own error, where `error` is not of the same unit
    demand     : which output is set against the capacity
    capacity   : parameter of the scene that the demand is held against, or a constant
    applies    : scene -> "" where the model applies, else the reason why not; it may look at the support, the isolator,
                 which parameters there are, and the frequency
    axes       : the object's own axes that it is shaken along where they are known, width first, then depth: for each,
                 the parameters of the scene that take the places of its own
    symmetric  : parameters -> True when the response does not change with the sign of the motion
    screen     : (excitation, parameters) -> columns by the paper's closed-form criterion; reported, never deciding
    say_screen : (one row of the screen, one set of parameters) -> the criterion in words
    trace      : (excitation, one set of parameters) -> time histories at the samples, (n,) each
    bound      : (excitation, parameters) -> guaranteed bounds, much cheaper than `run`; those of a one-direction
                 model that is given two hold for a body shaken along any.  None: it has none that is worth having
    certificate: (excitation in two directions, parameters) -> the demand itself or an upper bound of it for any
                 direction, without integration; what it shows to be below the capacity is never integrated
    exact      : the certificate is the demand itself, not only a bound
    rests      : certificate up to which nothing moves, so that there is nothing to integrate; None: always integrate
    flips      : (excitation, parameters, columns of `run` without estimate) -> (n,) where 1 % of the excitation changes
                 the yes or no among its outputs; None: it has none
    outcome    : (one row, one set of parameters) -> what the object does, in a word and in a sentence
    otherwise  : scene -> (output, capacity, sentence) that take the place of its own for this scene, or None
    chart      : how its response is tabulated; None: never, it is always integrated
    uncharted  : why there is no chart
    mark       : (one set of parameters, demand) -> (kind of chart, x, y), or None
    at_most    : the sentence that takes the place of its own where only a bound is known, which the demand is then
    fails      : what an object does whose demand exceeds the capacity, such as "slides"
    says       : what else its findings may say that holds no number, for the catalogue of a translation
    """

    name: str
    title: str
    kind: str
    source: str
    equation: str
    needs: tuple[Quantity, ...]
    gives: tuple[Quantity, ...]
    directions: int
    run: Callable[[Excitation, Mapping[str, Array], int, bool], Columns]
    demand: str
    capacity: str | float
    applies: Callable[[Scene], str]
    sentence: str
    fails: str
    at_most: str = ""
    errors: Mapping[str, str] = field(default_factory=dict)
    axes: tuple[Mapping[str, str], ...] = ({}, {})
    symmetric: Callable[[Mapping[str, Array]], bool] = lambda _: True
    screen: Callable[[Excitation, Mapping[str, Array]], Columns] | None = None
    say_screen: Callable[[Mapping[str, float], Mapping[str, float]], str] = lambda _row, _parameters: ""
    trace: Callable[[Excitation, Mapping[str, float]], Columns] | None = None
    bound: Callable[[Excitation, Mapping[str, Array]], Bounds] | None = None
    certificate: Callable[[Excitation, Mapping[str, Array]], Array] | None = None
    exact: bool = False
    rests: float | None = None
    flips: Callable[[Excitation, Mapping[str, Array], Columns], NDArray[np.bool_]] | None = None
    outcome: Callable[[Mapping[str, float], Mapping[str, float]], tuple[str, str]] = lambda _row, _parameters: ("", "")
    otherwise: Callable[[Scene], tuple[str, float, str] | None] = lambda _scene: None
    chart: ChartAxis | None = None
    uncharted: str = ""
    says: tuple[str, ...] = ()
    mark: Callable[[Mapping[str, float], float], tuple[str, float, float] | None] = lambda _parameters, _demand: None

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """All parameters of a scene that it may be run with."""
        own = (other for axis in self.axes for other in axis.values())
        return (*(q.name for q in self.needs), *own)

    def error_of(self, output: str) -> str:
        """Return the name of the column that holds the error of an output."""
        return self.errors.get(output, "error")

    def output(self, name: str) -> Quantity:
        """Return the output of that name.

        raises : KeyError
        """
        return next(q for q in self.gives if q.name == name)
