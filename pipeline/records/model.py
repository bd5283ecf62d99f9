"""A row of the registry of generic models."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pipeline.errors import InputError
from pipeline.quantities import Array, Quantity
from pipeline.records.likelihood import Harm
from pipeline.records.motion import Excitation, Motion
from pipeline.records.picture import Axis, Chart
from pipeline.records.scene import Estimate, Item, Scene, Support

Columns = dict[str, Array]
"""Output name -> (n,) values; "error" and "note" (bit flags, see models.common.NOTES) are always there."""


@dataclass(frozen=True)
class Bounds:
    """Bounds between which the outputs of a model lie for certain.

    Attributes
    ----------
    outputs : mapping of str to (ndarray, ndarray)
        Output name -> (low, high), (n,) each in the output's unit, of the first output always; a yes or no is bounded
        by 0 and 1.
    note : ndarray, shape (n,)
        Bit flags, see models.common.NOTES.
    worst : mapping of str to ndarray
        Of a model of one direction that is given two: output -> what it is at least, (n,), along the worst of all
        directions, of which x is one.
    """

    outputs: Mapping[str, tuple[Array, Array]]
    note: Array
    worst: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class ChartAxis:
    """The parameter along which a model's response is tabulated: smooth but for kinks, and never below zero.

    All other parameters are fixed for a chart: where they differ there is another one.

    Attributes
    ----------
    name : str
        Of the parameter.
    low, high : float
        Where charts are made, above zero, in the parameter's unit (SI), nodes evenly in the logarithm at first; what
        lies outside is integrated.
    nodes : int
        Analyses that a chart good enough to tell verdicts takes under strong shaking: fewer sets are integrated.
    absent : tuple of str
        Optional parameters; a set that has one of them is not on the chart.
    settled : callable, optional
        (excitation) -> value from which on the response no longer changes; None: it always does.
    leads : bool
        Whether verdicts rest on the first output alone, so that a chart for them need not follow the others.
    """

    name: str
    low: float
    high: float
    nodes: int
    absent: tuple[str, ...] = ()
    settled: Callable[[Excitation], float] | None = None
    leads: bool = False


@dataclass(frozen=True)
class Trials:
    """The objects that a model's error and cost are measured on, and at which the self-test tries to break it.

    Attributes
    ----------
    ranges : mapping of str to (float, float)
        Each parameter that it must be given -> (low, high) in SI, drawn from in equal ratios where the collection has
        no object of it (`kouros tradeoff`).
    extremes : mapping of str to sequence of float
        Parameter -> values (SI), columns of one length; empty: a closed form, with no time steps to break.
    sample : mapping of str to float
        An object (SI) that time steps of 0.5 to 40 ms must not trouble; empty: the self-test asks of none.
    promised : float
        Relative error of `history` on the sample, against `reference`.
    """

    ranges: Mapping[str, tuple[float, float]]
    extremes: Mapping[str, Sequence[float]] = field(default_factory=dict)
    sample: Mapping[str, float] = field(default_factory=dict)
    promised: float = 0.0


@dataclass(frozen=True)
class Figure:
    """A picture of a motion's effect by closed forms and histories.

    Attributes
    ----------
    kind : str
        How its key begins, which marks refer to.
    draw : callable
        (key, motion) -> the picture.
    """

    kind: str
    draw: Callable[[str, Motion], Chart]


@dataclass(frozen=True)
class ChartFigure:
    """A picture of a model's response charts under a motion: its first output along their axis.

    What the charts are made of and how far off they may be is added to the caption.

    Attributes
    ----------
    kind : str
        How its key begins, which marks refer to.
    title, caption, source : str
        As the picture shows them.
    x, y : Axis
        Of the picture.
    curves : mapping of str to mapping
        What each is called -> the parameters (SI) that its chart has fixed.
    low : float or None
        Where the chart begins (SI); None: as the model's charts do.
    azimuth_step : float or None
        Degrees between the directions of which the worst is shown; None: as verdicts ask for them.
    decides : bool
        Whether it is drawn from the very charts that verdicts are found by.
    """

    kind: str
    title: str
    caption: str
    x: Axis
    y: Axis
    source: str
    curves: Mapping[str, Mapping[str, float]]
    low: float | None = None
    azimuth_step: float | None = None
    decides: bool = False


_NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Model:
    """A generic model or isolator: one row of the registry (`pipeline.models.MODELS`), which holds all about it.

    A new one is a module with its kernel where it has one, a module with its row, and its name in the registry; or the
    two modules in another package, with an entry point of the group ``kouros.models``.  In order to be run, to be
    measured and to be given to objects it must guarantee the following:

    1.  `needs` names its parameters and `gives` its outputs, in SI, the first of which ranks directions (RotD100) and
        is what the error is of.  None is below zero, and none NaN or infinite without a note, at `trials.extremes`.
    2.  `run(excitation, parameters, refine, estimate)` returns a column (n,) for each output, and "error" and "note".
        The parameters are float arrays (n,) within the limits of `needs`; what is optional and not given is NaN or its
        default.  `refine` divides the standard step; without `estimate` the error is NaN and the cost a third.  It
        neither changes its arguments nor keeps anything between calls, and gives each row what it would give it alone.
    3.  `directions` says what the excitation holds: 1 (x, along an angle), 2 (x and y), or 0 (the parameter
        `directions` says which).
    4.  `demand` is the output that is held against `capacity`, a parameter of the scene or a constant; a larger one is
        worse.
    5.  `applies(scene)` returns "" or the reason why it is not run on an object.  It may look at the class, the
        support, how it hangs, the isolator, which parameters the scene has, and the frequency: scenes alike in these
        are asked once.
    6.  An object is tried with it where its class names it (column models of tables/classes.csv), where the museum says
        that the object is held in one of the ways in `supports` and its class would say otherwise, or where
        `joins(item, class, models)` is true.  Parameters that scenes do not have come from `estimates(scene)`.  Neither
        looks at what objects that are otherwise alike differ in: number, gallery and place.
    7.  `trials` says on which objects its cost and its error are measured, and what may break it.
    8.  What it does besides (bounds, a certificate, a screen, histories in time, a chart, pictures) it does as said
        below, or leaves out.

    Parameters
    ----------
    name : str
        As it is asked for: lower case, digits and underscores.
    title : str
        In words, for a report.
    kind : str
        "rigid", "flexible" or "isolator".
    source, equation : str
        Who says so, and the equation in plain text.
    needs : tuple of Quantity
        Its parameters, in the order a caller would name them.
    gives : tuple of Quantity
        Its outputs; one that is optional may be empty (NaN).
    directions : int
        1, 2 or 0, see 3.
    run : callable
        See 2.
    demand : str
        See 4.
    capacity : str or float
        See 4.
    applies : callable
        See 5.
    sentence : str
        What a finding says; {demand}, {low}, {high} and {capacity} are put in.
    fails : str
        What an object does whose demand exceeds the capacity, such as "slides".
    trials : Trials
        See 7.
    listed : str
        Where the paper's lists of generic models have it, such as "Table 1, Rigid: Rocking".
    supports : tuple of Support
        See 6.
    joins : callable, optional
        (item, class, models that its class names) -> whether it is tried on an object besides those; None: on none.
    estimates : callable, optional
        scene -> parameters of its own by name, each with range, origin and note; none takes the place of one that the
        scene has.
    counted : callable
        (parameter, what a scene knows of it) -> as much of its range as is counted on.
    needs_size : bool
        Whether it cannot be run without the object's dimensions.
    unasked : str
        What is said besides of an object that it applies to and that is not tried with it.
    room_settles : bool
        Whether its failure is a collision, so that room settles it.
    tips : bool
        Whether its failure is that an object tips, so that a wider or a heavier base helps.
    resultant : bool
        Of a model of one direction that is linear: given both, `run` answers with the worst of all directions, in
        place of which no angle is looked for.
    turns : bool
        Whether its plane of motion turns by itself, so that its last part does not tell all directions.
    pictures : tuple of Figure or ChartFigure
        What is drawn of every motion, in order.
    at_most : str
        The sentence that takes the place of its own where only a bound is known, which the demand is then.
    gripped : str
        The sentence that takes the place of both for what a mount holds; "" where that is no matter.
    errors : mapping
        Output -> column of `run` with its own error, where `error` is not of the same unit.
    axes : tuple of mapping
        The object's own axes that it is shaken along where they are known, width first, then depth: for each, the
        parameters of the scene that take the places of its own.
    across : bool
        Of a model of one direction: whether it is shaken across the object's width where that is known, instead of
        along it.
    vertical : bool
        Whether the vertical shaking loads or unloads it, so that its findings say where a motion has none.
    searched : mapping of str to str
        Parameters over whose range the demand is not monotone -> the optional parameter that takes the upper end of the
        range, the other then being the lower: the model searches the band between them.
    least : str
        Output that is the least over what is searched of what `demand` is the largest of; "" where nothing is.
    symmetric : callable
        parameters -> True when the response does not change with the sign of the motion.
    screen : callable, optional
        (excitation, parameters) -> columns by the paper's closed-form criterion; reported, never deciding.
    say_screen : callable
        (one row of the screen, one set of parameters) -> the criterion in words.
    trace : callable, optional
        (excitation, one set of parameters) -> time histories at the samples, (n,) each; of a model whose demand is
        called "displacement" u_x, and u_y in two directions [m], from where it stood.
    bound : callable, optional
        (excitation, parameters) -> guaranteed bounds, much cheaper than `run`; those of a one-direction model that is
        given two hold for a body shaken along any.  None: it has none that is worth having.
    certificate : callable, optional
        (excitation in two directions, parameters) -> the demand itself or an upper bound of it for any direction,
        without integration; what it shows to be below the capacity is never integrated.
    exact : bool
        The certificate is the demand itself, not only a bound.
    rests : float, optional
        Certificate up to which the outputs that count are nothing, so that there is nothing to integrate; None: always
        integrate.
    flips : callable, optional
        (excitation, parameters, columns of `run` without estimate) -> (n,) where 1 % of the excitation changes the yes
        or no among its outputs; None: it has none.
    outcome : callable
        (one row, one set of parameters) -> what the object does, in a word and in a sentence.
    otherwise : callable
        scene -> (output, capacity, sentence) that take the place of its own for this scene, or None.
    chart : ChartAxis, optional
        How its response is tabulated; None: never, it is always integrated.
    uncharted : str
        Why there is no chart.
    says : tuple of str
        What else its findings may say that holds no number, for the catalogue of a translation.
    mark : callable
        (one set of parameters, demand) -> (kind of picture, x, y), or None.
    states : tuple of Harm
        What an object may come to by it; empty: it leaves its place where room settles its failure, else it breaks.
    reaches : callable, optional
        (columns of `run`, whether the demand exceeds the capacity, room around the object [m]), (n,) each -> by state
        whether it is reached, (n,); None: its only state, where the demand exceeds the capacity.

    Raises
    ------
    InputError
        Where these do not fit together: which, and what mends it.
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
    trials: Trials
    listed: str = ""
    supports: tuple[Support, ...] = ()
    joins: Callable[[Item, str, Sequence[str]], bool] | None = None
    estimates: Callable[[Scene], Mapping[str, Estimate]] | None = None
    counted: Callable[[str, Estimate], Estimate] = lambda _name, estimate: estimate
    needs_size: bool = True
    unasked: str = ""
    room_settles: bool = False
    tips: bool = False
    resultant: bool = False
    turns: bool = False
    pictures: tuple[Figure | ChartFigure, ...] = ()
    at_most: str = ""
    gripped: str = ""
    errors: Mapping[str, str] = field(default_factory=dict)
    axes: tuple[Mapping[str, str], ...] = ({}, {})
    across: bool = False
    vertical: bool = False
    searched: Mapping[str, str] = field(default_factory=dict)
    least: str = ""
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
    states: tuple[Harm, ...] = ()
    reaches: Callable[[Columns, NDArray[np.bool_], Array], Mapping[Harm, NDArray[np.bool_]]] | None = None

    def __post_init__(self) -> None:
        """Refuse a row whose names do not fit together."""
        known, made = [q.name for q in self.needs], [q.name for q in self.gives]
        if not _NAME.fullmatch(self.name):
            raise InputError(f"a model's name is lower case letters, digits and underscores, not {self.name!r}")
        if self.directions not in (0, 1, 2) or (self.directions == 0 and "directions" not in known):
            raise InputError(f"{self.name}: directions is 1 or 2, or 0 with a parameter 'directions' among its needs")
        if not known:
            raise InputError(f"{self.name}: needs is empty; name the parameters that it is run with")
        must = [q.name for q in self.needs if not q.optional]
        named: tuple[tuple[str, Iterable[str], Sequence[str]], ...] = (
            ("demand", (self.demand,), made),
            ("errors", self.errors, made),
            ("searched", (*self.searched, *self.searched.values()), known),
            ("least", (self.least,) if self.least else (), made),
            ("axes", (name for axis in self.axes for name in axis), known),
            ("chart", () if self.chart is None else (self.chart.name, *self.chart.absent), known),
            ("trials.ranges", self.trials.ranges, known),
            ("trials.extremes", self.trials.extremes, known),
            ("trials.sample", self.trials.sample, known),
        )
        for what, names, allowed in named:
            for name in names:
                if name not in allowed:
                    raise InputError(f"{self.name}: {what} names {name!r}; use one of {', '.join(allowed)}")
        for what, given in (("ranges", self.trials.ranges), ("extremes", self.trials.extremes)):
            lost = [name for name in must if name not in given]
            if lost and (given or what == "ranges"):
                raise InputError(f"{self.name}: trials.{what} lacks {', '.join(lost)}; it must be given these")

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """All parameters of a scene that it may be run with."""
        own = (other for axis in self.axes for other in axis.values())
        return (*(q.name for q in self.needs), *own)

    @property
    def reachable(self) -> tuple[Harm, ...]:
        """The states that an object may come to by it."""
        return self.states or ((Harm.LEAVES,) if self.room_settles else (Harm.BREAKS,))

    def reached(self, columns: Columns, exceeded: NDArray[np.bool_], room: Array) -> Mapping[Harm, NDArray[np.bool_]]:
        """Return which states are reached.

        Parameters
        ----------
        columns : mapping of str to ndarray, shape (n,)
            What `run` returned.
        exceeded : ndarray of bool, shape (n,)
            Whether the demand exceeds the capacity.
        room : ndarray, shape (n,)
            Around the object, m; infinite where nobody says it.

        Returns
        -------
        mapping of Harm to ndarray of bool, shape (n,)
            Of each state that is reachable.
        """
        if self.reaches is not None:
            return self.reaches(columns, exceeded, room)
        return {self.reachable[0]: exceeded}

    def error_of(self, output: str) -> str:
        """Return the name of the column that holds the error of an output.

        Parameters
        ----------
        output : str
            Its name.

        Returns
        -------
        str
            A key of what `run` returns.
        """
        return self.errors.get(output, "error")

    def least_of(self, output: str) -> str:
        """Return the name of the output that is the least of another one over what is searched.

        Parameters
        ----------
        output : str
            Its name.

        Returns
        -------
        str
            The same where nothing is searched.
        """
        return self.least if self.least and output == self.demand else output

    def output(self, name: str) -> Quantity:
        """Return the output of that name.

        Parameters
        ----------
        name : str
            One of `gives`.

        Returns
        -------
        Quantity
            With its unit.

        Raises
        ------
        StopIteration
            For a name that is not one of them.
        """
        return next(q for q in self.gives if q.name == name)
