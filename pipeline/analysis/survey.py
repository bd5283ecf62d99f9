"""Survey of missing measurements: those without which nothing can be said, and those that may change what is decided.

Where it is known how likely harm is, the joint samples tell already which number, once measured, may change what is
decided (`pipeline.analysis.likelihood.sampling`).  Where nobody draws samples, verdicts are settled.  A verdict is open
because inputs are uncertain: for each of them in turn, the object is assessed as if that one had been measured, as low,
best and high; the others stay as uncertain as they are.  If the verdict stays open at all three, measuring that alone
is taken to settle nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from pipeline.analysis.assess import assess
from pipeline.analysis.context import Context
from pipeline.analysis.footing import HALVES, tilted
from pipeline.analysis.sizes import PLAN, SIZES
from pipeline.analysis.verdicts import LevelMotions
from pipeline.models import model_named
from pipeline.records import Estimate, Finding, Likelihood, MeasurementRequest, Mount, Numerics, Origin, Scene, Verdict
from pipeline.records.numerics import HISTORIES
from pipeline.tables import table
from pipeline.tables.rows import Entries, Optional, checked

BATCH = 1000
"""Objects looked at together: bounds the memory."""

ENDS = ("low", "value", "high")

TILT = "tilt_angle_deg"
"""The field of a tilt test, which says how half width and height of the centre of gravity stand to each other."""

SOUND = 0.5
"""Condition from which an object may be handled; judgement."""


@dataclass(frozen=True, slots=True)
class Measurable:
    """A field of the record that a person can fill in (a row of tables/survey.csv).

    Attributes
    ----------
    parameters : Entries
        Of the scene, that hang on it; none for a field that is only ever missing.
    factor : Optional
        The field's number for a number 1 of the first parameter; None where it cannot be said in one number.
    heaviest : Optional
        kg of an object that may be handled for it; None where nothing is handled.
    how : str
        How it is measured, for the sheet.
    """

    field: str
    label: str
    unit: str
    parameters: Entries
    factor: Optional
    heaviest: Optional
    how: str


@cache
def measurables() -> tuple[Measurable, ...]:
    """Return what a survey may ask for.

    Returns
    -------
    tuple of Measurable
        In the order of the table.

    Raises
    ------
    TableError
        For a factor that is no number.
    """
    return checked(Measurable, table("survey"), "survey.csv", named="field")


_SIZE_FIELDS = frozenset(f"{size}_m" for size in SIZES)
"""Fields of sizes, on which no model hangs but through other numbers."""

_BEHIND: Mapping[str, Sequence[str]] = {
    **dict.fromkeys((*HALVES, "section_modulus"), PLAN),
    **dict.fromkeys(("cg_height", "lever", "length", "hook_height", "gyration"), ("height",)),
    **dict.fromkeys(("mass", "frequency"), SIZES),
}
"""Parameters, and the sizes that they hang on where nobody recorded these."""

_MISSING = {
    "height": "height_m",
    "width": "width_m",
    "depth": "depth_m",
    "height or suspension length": "suspension_length_m",
    "height of the centre of gravity": "cg_height_m",
    "base width": "base_width_m",
    "base depth": "base_depth_m",
    "mass": "mass_kg",
    "width of its weakest section": "section_width_m",
    "wall of its weakest section": "section_wall_m",
    "support": "support",
}
"""How a scene's words for what is missing begin, and the field that would mend it."""


def field_asked(parameter: str, missing: str) -> str:
    """Return the field that somebody is to measure, by what a report's list of objects says.

    Parameters
    ----------
    parameter : str
        The parameter of a scene whose measurement may change what is decided; "" for none.
    missing : str
        What its record lacks without which nothing can be said, as a scene's words in one text.

    Returns
    -------
    str
        "" for none that can be measured.
    """
    behind = (one.field for one in measurables() if parameter and parameter in one.parameters)
    return next(behind, "") or next(filter(None, map(measurable_of, missing.split("; "))), "")


def measurement_requests(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    context: Context,
    numerics: Numerics = HISTORIES,
) -> list[MeasurementRequest]:
    """Return what is worth measuring on the objects on display.

    Parameters
    ----------
    scenes
        The objects as they stand.
    findings
        Of each scene, as `assess` returned them under the same levels.
    levels
        The motions.
    context
        Where it runs, and who is told.
    numerics
        How finely.  Each trial is asked once, so that a chart of its own would not pay.

    Returns
    -------
    list of MeasurementRequest
        What settles most first.
    """
    out: list[MeasurementRequest] = []
    shown = [at for at, scene in enumerate(scenes) if scene.item.on_display]
    for start in range(0, len(shown), BATCH):
        context.progress.step("survey", start, len(shown))
        chosen = shown[start : start + BATCH]
        trials = [trial for at in chosen for trial in (_missing(scenes[at]) or _trials(scenes[at], findings[at]))]
        tried = [(trial, end) for trial in trials for end in (ENDS if trial.models else ())]
        _, answers = assess(
            [_measured(trial, end) for trial, end in tried],
            levels,
            context.silent,
            numerics,
            outcomes=False,
        )
        settled: dict[int, int] = {}
        for (trial, _), answer in zip(tried, answers, strict=True):
            decided = sum((f.model, f.level) in trial.open and f.verdict is not Verdict.UNDETERMINED for f in answer)
            settled[id(trial)] = settled.get(id(trial), 0) + decided
        out += [_request(trial, settled.get(id(trial), 0) / len(ENDS)) for trial in trials]
    context.progress.step("survey", len(shown), len(shown))
    return in_order(out)


def telling_requests(scenes: Sequence[Scene], chances: Sequence[Sequence[Likelihood]]) -> list[MeasurementRequest]:
    """Return what is worth measuring on the objects on display, where it is known how likely harm is.

    Parameters
    ----------
    scenes
        The objects as they stand.
    chances
        Of each scene, how likely it comes to harm at each level.

    Returns
    -------
    list of MeasurementRequest
        What is missing, and of each object and level the number that tells most; what settles most first.
    """
    out: list[MeasurementRequest] = []
    for scene, those in zip(scenes, chances, strict=True):
        if not scene.item.on_display:
            continue
        out += [_request(trial, 0.0) for trial in _missing(scene)]
        best: dict[str, list[Likelihood]] = {}
        for one in those:
            best.setdefault(one.open_for, []).append(one)
        for parameter, some in best.items():
            if parameter == "friction_static" and scene.mount is Mount.UNKNOWN:
                # No scale tells how a mount grips: a house rule does.
                continue
            size = size_behind(scene, parameter)
            # The first of the table that may be asked for: a tilt test tells more than a base that is measured.
            fit = (m for m in measurables() if (size or parameter) in m.parameters and _may_be_asked(scene, m))
            measurable = next(fit, None)
            if measurable is None:
                continue
            estimate = scene.parameters.get(size or parameter)
            reason = (estimate.note if estimate is not None else "") or "derived"
            trial = _Trial(scene, measurable, frozenset((parameter, one.level) for one in some), (), reason)
            out.append(replace(_request(trial, sum(one.moves for one in some)), drawn=True))
    return in_order(out)


def size_behind(scene: Scene, parameter: str) -> str:
    """Return the size that a number hangs on and that nobody recorded, which is sooner measured than the number.

    Parameters
    ----------
    scene
        The object as it stands.
    parameter
        Of its models.

    Returns
    -------
    str
        "height", "width" or "depth"; "" where the number hangs on none, or where all of them are recorded.
    """
    return next((size for size in _BEHIND.get(parameter, ()) if size in scene.parameters), "")


def in_order(found: Sequence[MeasurementRequest]) -> list[MeasurementRequest]:
    """Return measurement requests, what settles most first.

    Parameters
    ----------
    found
        In any order.

    Returns
    -------
    list of MeasurementRequest
        Ties by gallery and object, and of one object in the order of the table: a tilt test first.
    """
    order = {measurable.field: at for at, measurable in enumerate(measurables())}
    return sorted(found, key=lambda w: (-w.gain, -w.unlocks, w.gallery, w.object_number, order[w.field]))


@dataclass(frozen=True, slots=True)
class _Trial:
    """One field of one object, and the open verdicts (model, level) that it takes part in; no models: it is missing."""

    scene: Scene
    measurable: Measurable
    open: frozenset[tuple[str, str]]
    models: tuple[str, ...]
    reason: str
    unlocks: int = 0


def _trials(scene: Scene, findings: Sequence[Finding]) -> list[_Trial]:
    # What stands on an isolator is judged on what that passes on, and is not tried here.
    still = {(f.model, f.level) for f in findings if f.verdict is Verdict.UNDETERMINED and f.model in scene.models}
    if not still:
        return []
    out = []
    for measurable in measurables():
        if not _may_be_asked(scene, measurable) or measurable.field in _SIZE_FIELDS:
            continue
        uncertain = [
            scene.parameters[name]
            for name in measurable.parameters
            if name in scene.parameters and scene.parameters[name].low < scene.parameters[name].high
        ]
        mine = frozenset((m, level) for m, level in still if _inputs(m) & set(measurable.parameters))
        if uncertain and mine:
            models = tuple(dict.fromkeys(model for model, _ in sorted(mine)))
            out.append(_Trial(scene, measurable, mine, models, uncertain[0].note or "derived"))
    return out


def _may_be_asked(scene: Scene, measurable: Measurable) -> bool:
    """Say whether an object may be handled as a measurement asks for, and whether that was not done yet."""
    if measurable.heaviest is None:
        return True
    item, mass = scene.item, scene.parameters.get("mass")
    done = measurable.field == TILT and item.tilt_angle_deg is not None
    # What may be heavier, is shaken to pieces by rocking, or is no longer sound, nobody tilts.
    light = mass is not None and mass.value <= measurable.heaviest
    sound = item.condition is None or item.condition >= SOUND
    return not done and light and sound and item.susceptible is not True


@cache
def _inputs(name: str) -> frozenset[str]:
    model = model_named(name)
    return frozenset(model.inputs) | ({model.capacity} if isinstance(model.capacity, str) else frozenset())


def measurable_of(words: str) -> str | None:
    """Return the field that would mend what a scene says is missing.

    Parameters
    ----------
    words
        One of the scene's `missing`.

    Returns
    -------
    str or None
        A field of the record; None where no measurement would mend it.
    """
    return next((f for start, f in _MISSING.items() if words == start or words.startswith(f"{start} (")), None)


def _missing(scene: Scene) -> list[_Trial]:
    out = []
    for words in scene.missing:
        field = measurable_of(words)
        # Instead of a base that nobody measured, a tilt test does.
        instead = (TILT,) if field == "base_width_m" else ()
        for measurable in (m for m in measurables() if m.field in (*instead, field) and _may_be_asked(scene, m)):
            out.append(_Trial(scene, measurable, frozenset(), (), f"not recorded: {words}", len(scene.models)))
    return out


def _measured(trial: _Trial, end: str) -> Scene:
    pinned = dict(trial.scene.parameters)
    if trial.measurable.field == TILT:
        half, height = pinned["half_width"], pinned["cg_height"]
        slope = {"low": half.low / height.high, "value": half.value / height.value, "high": half.high / height.low}[end]
        halves = {name: pinned[name] for name in HALVES if name in pinned}
        return replace(trial.scene, parameters=pinned | tilted(halves, slope, height), models=trial.models)
    for name in trial.measurable.parameters:
        if name in pinned:
            old = pinned[name]
            value = float(getattr(old, end))
            pinned[name] = Estimate(value, old.unit, Origin.MEASURED, value, value)
    for name, tied in pinned.items():
        if tied.per in trial.measurable.parameters and name not in trial.measurable.parameters:
            times = pinned[tied.per].value / trial.scene.parameters[tied.per].value
            pinned[name] = replace(tied, value=times * tied.value, low=times * tied.value, high=times * tied.value)
    return replace(trial.scene, parameters=pinned, models=trial.models)


def _request(trial: _Trial, settles: float) -> MeasurementRequest:
    item, measurable = trial.scene.item, trial.measurable
    first = next((trial.scene.parameters[n] for n in measurable.parameters if n in trial.scene.parameters), None)
    low = best = high = None
    if first is not None and measurable.factor is not None:
        low, best, high = (measurable.factor * end for end in (first.low, first.value, first.high))
    return MeasurementRequest(
        item.object_number,
        item.gallery,
        item.called,
        measurable.field,
        measurable.unit,
        low,
        best,
        high,
        trial.reason,
        len(trial.open),
        settles,
        trial.unlocks,
    )
