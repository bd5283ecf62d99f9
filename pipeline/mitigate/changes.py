"""What a measure changes in the scene of an object.  A trial and a measure that is installed are the same change.

The parameters are those of a recommendation, by name [SI]; what they are is what a museum builds or buys.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from pipeline.analysis.classify import models_of
from pipeline.records import Estimate, Origin, Scene, Support

Change = Callable[[Scene, Mapping[str, float]], Scene]

HALVES = ("half_width", "half_base_width", "half_base_depth")
MODULI = ("section_modulus", "section_modulus_width", "section_modulus_depth")
SECTION = ("mass", "lever", "area", "section_modulus", "allowable_stress")


def knows_section(scene: Scene) -> bool:
    """Say whether the stress of its critical section can be computed."""
    return all(name in scene.parameters for name in SECTION)


def _exactly(value: float, unit: str, note: str) -> Estimate:
    return Estimate(value, unit, Origin.DERIVED, value, value, note)


def _with(scene: Scene, **found: Estimate) -> Scene:
    return replace(scene, parameters={**scene.parameters, **found})


def held(scene: Scene, _parameters: Mapping[str, float] | None = None) -> Scene:
    """Return it held at its base: it neither rocks nor slides, and its critical section bears the push."""
    return replace(scene, support=Support.FASTENED, models=models_of(Support.FASTENED))


def _cleared(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    return _with(scene, clearance=_exactly(parameters["clearance"], "m", "clearance given by the measure"))


def _damped(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    return _with(scene, damping=_exactly(parameters["damping"], "-", "damping of the pads"))


def _on_surface(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    return _with(scene, friction_static=_exactly(parameters["friction"], "-", "friction of the new surface"))


def _ballasted(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Lower its centre of gravity: (m h + M H) / (m + M) with the ballast's mass M and height H.

    The ballast lies below the critical section, which bears no more than before.
    """
    mass, cg = scene.parameters["mass"], scene.parameters["cg_height"]
    ballast, at = parameters["mass"], parameters["height"]

    def lowered(own: float, height: float) -> float:
        return (own * height + ballast * at) / (own + ballast)

    note = "height of the centre of gravity with the ballast"
    ends = [lowered(own, height) for own in (mass.low, mass.high) for height in (cg.low, cg.high)]
    value = lowered(mass.value, cg.value)
    return _with(scene, cg_height=Estimate(value, "m", Origin.DERIVED, min(ends), max(ends), note))


def _widened(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Fix it to a footing plate: the base is wider, there is room around it, and its section bears the push."""
    half = 0.5 * parameters["width"]
    found: dict[str, Estimate] = {}
    for name in HALVES:
        before = scene.parameters.get(name)
        if before is not None:
            found[name] = _exactly(half, "m", "half of the footing plate") if before.high < half else before
    models = dict.fromkeys((*models_of(Support.FREESTANDING), *models_of(Support.FASTENED), *scene.models))
    return replace(_cleared(_with(scene, **found), parameters), models=tuple(models))


def _strengthened(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Hold it at its base, its critical section thicker in all directions: area with the square, moduli the cube."""
    times = parameters["enlargement"]
    powers = {"area": 2, **dict.fromkeys(MODULI, 3)}
    found = {
        name: _times(scene.parameters[name], times**power) for name, power in powers.items() if name in scene.parameters
    }
    return held(_with(scene, **found))


def _times(estimate: Estimate, factor: float) -> Estimate:
    return replace(
        estimate, value=factor * estimate.value, low=factor * estimate.low, high=factor * estimate.high, note=""
    )


def _on_low_friction(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    found = _cleared(_on_surface(scene, parameters), parameters)
    return _isolated(found, "friction_isolator")


def _on_springs(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    units = {"frequency": "Hz", "damping": "-", "friction": "-", "stroke": "m"}
    found = {name: _exactly(parameters[name], unit, f"{name} of its isolator") for name, unit in units.items()}
    return _isolated(_with(scene, **found), "horizontal_isolator")


def _on_rubber(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Put it on an elastomeric pad; the inertia is that of a uniform body about the middle of its base.

    I = m h^2 + m (b^2 + h^2) / 3, so that I / (m h^2) = 1 + (b^2 / h^2 + 1) / 3, at the ends of what b/h may be.
    """
    cg = scene.parameters["cg_height"]
    half = scene.parameters.get("half_width")
    slopes = (0.5, 0.5, 0.5) if half is None else (half.value / cg.value, half.low / cg.high, half.high / cg.low)
    ratio, low, high = (1.0 + (slope**2 + 1.0) / 3.0 for slope in slopes)
    uniform = "a uniform body about the middle of its base"
    found = {
        "frequency": _exactly(parameters["frequency"], "Hz", "frequency of its pad"),
        "damping": _exactly(parameters["damping"], "-", "damping of its pad"),
        "inertia_ratio": Estimate(ratio, "-", Origin.DERIVED, low, high, uniform),
        "rotation_limit": _exactly(parameters["rotation_limit"], "rad", "largest turn that its mount allows"),
    }
    return _isolated(_with(scene, **found), "rotational_isolator")


def _isolated(scene: Scene, kind: str) -> Scene:
    # Only the isolator's own demand: what stands on it is run on what the isolator passes on.
    return replace(scene, support=Support.ISOLATED, models=(kind,), item=replace(scene.item, isolator=kind))


CHANGES: Mapping[str, Change] = {
    "clearance": _cleared,
    "rubber_pads": _damped,
    "surface": _on_surface,
    "grip_pad": _on_surface,
    "wax": held,
    "ballast": _ballasted,
    "wide_base": _widened,
    "fasten": held,
    "restrain": held,
    "friction_isolator": _on_low_friction,
    "horizontal_isolator": _on_springs,
    "rotational_isolator": _on_rubber,
    "strengthen": _strengthened,
}
"""How each row of measures.csv but removal changes a scene."""


def changed(scene: Scene, measure: str, parameters: Mapping[str, float]) -> Scene:
    """Return the scene with a measure in place.

    measure    : a row of measures.csv, but not "remove"
    parameters : those of its recommendation [SI]
    raises     : KeyError for another measure, or where a parameter of the measure or the scene is missing
    """
    return CHANGES[measure](scene, parameters)
