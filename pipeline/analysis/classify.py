"""Item -> Scene: which generic class an object belongs to, and every number its models need, with its origin.

The class is the likeliest by what each part of the record says (`pipeline.analysis.evidence`), by the table of rules
(`pipeline.analysis.rules`); the museum's own rules, and people, decide outright.  Numbers that the museum did not
record are what its house rules state (`pipeline.analysis.house`), else they come from the row of the class
(tables/classes.csv) and the material (tables/materials.csv) as value, low and high, and are named as assumed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import NamedTuple

from pipeline.analysis.bodies import as_it_stands, body, of_pieces, on_floor
from pipeline.analysis.evidence import FIELDS, POSSIBLE, Chance, chances_of, taken_of
from pipeline.analysis.furniture import furniture_of, in_furniture
from pipeline.analysis.house.matching import NO_EFFECT, HouseEffect, HouseRules
from pipeline.analysis.mounts import MountGuess, mount_of, mount_of_body
from pipeline.analysis.named_stuff import FLAT, as_made
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.rules import Readings, readings
from pipeline.analysis.scene_parameters import SceneParameters, material_of
from pipeline.analysis.told import as_displayed, as_told, display_note, in_case, too_slender
from pipeline.models import MODELS, model_named
from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.records import UNTOLD_ISOLATOR, Estimate, Furniture, Hanging, Item, Origin, Scene, Support, too_thin
from pipeline.records import phrases as say
from pipeline.tables.assumed import AssumedValues, assumed
from pipeline.tables.assumed_rows import NO_MODEL, WHEN_HELD, ObjectClass
from pipeline.tables.body_rows import BodyRow


class TakenClass(NamedTuple):
    """What an object is taken for: its class, why it is that, and the classes that are likely at all."""

    name: str
    words: str
    chances: tuple[tuple[str, float], ...] = ()


def class_of(item: Item, rules: RuleTable | None = None, decided: tuple[str, str] | None = None) -> TakenClass:
    """Return what an object is taken for.

    Parameters
    ----------
    rules : RuleTable or None, optional
        The table that decides it; None for Kouros's own.
    decided : (str, str) or None, optional
        The class that a person gave it, and their words, in place of the rules.

    Returns
    -------
    TakenClass
    """
    if decided is not None:
        return TakenClass(*decided)
    read = readings(item, rules)
    chances = chances_of(item, read, rules)
    taken = taken_of(item, read, chances)
    if taken is None:
        return _open(read, _told(chances))
    words = _why(read, taken)
    if taken is not chances[0]:
        words = "title alone: nothing but its title speaks, which may name what a picture shows"
    return TakenClass(taken.object_class, words, _told(chances))


def _open(read: Readings, chances: tuple[tuple[str, float], ...]) -> TakenClass:
    """Return what a record that names no class is taken for: what is left, with the chance that the others leave."""
    name = read.decided.rule.object_class
    others = tuple(pair for pair in chances if pair[0] != name)
    words = f"{read.decided.words}; its record names no class"
    if not others:
        return TakenClass(name, words)
    words += f", {others[0][0]} is the likeliest ({others[0][1]:.2f})"
    left = (name, round(1.0 - sum(chance for _, chance in others), 2))
    return TakenClass(name, words, tuple(sorted((*others, left), key=lambda pair: -pair[1])))


@lru_cache(maxsize=65536)
def _told(chances: tuple[Chance, ...]) -> tuple[tuple[str, float], ...]:
    """Return the classes that are likely at all, with their probability to the hundredth."""
    return tuple((one.object_class, round(one.probability, 2)) for one in chances if one.probability >= POSSIBLE)


WEIGHED = "all that its record says, weighed together"
"""Why an object is of a class that none of its words names."""


def _why(read: Readings, taken: Chance) -> str:
    """Return why an object is of a class: the rule that says so, of those of each part of its record."""
    if read.decided.rule.object_class == taken.object_class:
        return read.decided.words
    found = (one for field in FIELDS if (one := getattr(read, field)) is not None)
    for one in found:
        if one.rule.object_class == taken.object_class:
            return str(one.words)
    return f"evidence: {WEIGHED}"


FIXED = "fixed-post:"
"""How the reason of a class begins by whose rule a thing stands fixed in a footing."""


def object_classes() -> Mapping[str, str]:
    """Return the classes that an object may be of, each with its title."""
    return {name: row.title for name, row in assumed().classes.items()}


def house_effect(
    item: Item, house: HouseRules, rules: RuleTable | None = None, decided: tuple[str, str] | None = None
) -> HouseEffect:
    """Return what a museum's house rules come to for an object: see `classify`."""
    return _known_of(item, rules, decided, house).house


class _Known(NamedTuple):
    """A record with what else it tells, what it is taken for, its class, what house rules come to, and all tables."""

    item: Item
    taken: TakenClass
    row: ObjectClass
    house: HouseEffect
    values: AssumedValues


def _known_of(item: Item, rules: RuleTable | None, decided: tuple[str, str] | None, house: HouseRules | None) -> _Known:
    item = as_displayed(item)
    taken = class_of(item, rules, decided)
    made = as_made(item, taken.name, rules)
    if made is not item and decided is None and (item.object_name or item.classification):
        # What a title alone names is no surer for what it says that is made of.
        again = class_of(made, rules)
        taken = taken if again.name in FLAT else again
    values = assumed() if rules is None else rules.values
    row = values.classes[taken.name]
    if house is None:
        return _Known(made, taken, row, NO_EFFECT, values)
    mounts = WHEN_HELD in row.models or in_case(made, row)
    said = house.effect(made, row.name, as_told(made, row).support or row.support, mounts=mounts)
    return _Known(made, taken, row, said, values)


def _undecided(scene: Scene, values: AssumedValues) -> Scene:
    """Return a scene that says where another class is likely for which something else would be computed."""
    other = scene.next_class
    if other is None or other[0] not in values.classes:
        return scene
    mine, theirs = values.classes[scene.object_class], values.classes[other[0]]
    if mine.support is theirs.support and mine.models == theirs.models:
        return scene
    told = f"{say.OTHER_CLASS(told=theirs.told, chance=other[1])}; {say.SAY_CLASS()}"
    return replace(scene, assumptions=(*scene.assumptions, told))


def classify(
    item: Item,
    rules: RuleTable | None = None,
    decided: tuple[str, str] | None = None,
    house: HouseRules | None = None,
) -> Scene:
    """Return the scene of one object: class, support, models to try, estimates, and the fields that are missing.

    Parameters
    ----------
    rules : RuleTable or None, optional
        The table that decides the class, with what is assumed of each; None for Kouros's own.
    decided : (str, str) or None, optional
        The class that a person gave it, and their words, in place of the rules.
    house : HouseRules or None, optional
        What the museum states once for many objects; None for nothing.

    Returns
    -------
    Scene

    Raises
    ------
    KeyError
        For a decided class that is no row of classes.csv.
    """
    made, taken, row, said, values = _known_of(item, rules, decided, house)
    scene = _scene(made, row, taken.words, values, said)
    if made.material != item.material:
        scene = replace(scene, assumptions=(say.MADE_AS_NAMED(words=made.material), *scene.assumptions))
    item = made
    hanging = said.hanging(item) or scene.hanging
    scene = replace(scene, hanging=hanging, statements=said.statements, chances=taken.chances)
    return in_furniture(_undecided(scene, values), said, values)


def furniture_kind(
    item: Item,
    rules: RuleTable | None = None,
    decided: tuple[str, str] | None = None,
    house: HouseRules | None = None,
) -> Furniture:
    """Return the kind of furniture of the scene that `classify` returns, at a third of its cost."""
    item, taken, row, said, values = _known_of(item, rules, decided, house)
    stance = _stance(item, row, taken.words, values, said)
    return furniture_of(on_floor(_as_taken(item, stance), stance.shape), row.name, stance.support, said).furniture


@dataclass(frozen=True)
class _Stance:
    """How an object is held, as laid over by house rules, as told by the record, and as it is taken in the end."""

    laid: Item
    by_record: Item
    taken: Item
    support: Support
    mount: MountGuess | None
    shape: BodyRow | None


def _stance(item: Item, row: ObjectClass, words: str, values: AssumedValues, house: HouseEffect) -> _Stance:
    laid = house.laid_over(item)
    by_record = as_told(laid, row)
    taken = _held(by_record, words)
    support = taken.support or row.support
    mount = mount_of(taken, row, house, cased=in_case(laid, row))
    shape = body(taken, row, words, support, mount, material_of(item, values))
    mount = mount or mount_of_body(taken, support, shape)
    return _Stance(laid, by_record, taken, support, mount, shape)


def _as_taken(item: Item, stance: _Stance) -> Item:
    """Return a record with what it is on, and how it hangs there, as the rest of it tells for its class."""
    taken = stance.taken
    fixed = stance.support is Support.HUNG and taken.hanging is Hanging.FIXED and stance.laid.hanging is None
    return replace(
        item,
        surface_material=stance.laid.surface_material,
        hanging=Hanging.FIXED if fixed else item.hanging,
        furniture=item.furniture or (Furniture.WALL if taken.furniture is Furniture.WALL else None),
    )


def _scene(item: Item, row: ObjectClass, words: str, values: AssumedValues, house: HouseEffect) -> Scene:
    stance = _stance(item, row, words, values, house)
    support, mount, shape = stance.support, stance.mount, stance.shape
    models = _tried(stance.taken, row, None if mount is None else mount.row.models)
    if not models:
        why = f"no generic model applies: it {row.why}"
        return Scene(item, row.name, words, support, (), {}, (), (why,))
    item = as_it_stands(on_floor(_as_taken(item, stance), shape), shape)
    builder = SceneParameters(item, row if shape is None else shape.of_class(row), support, values, house, mount, shape)
    builder.build()
    if mount is None:
        builder.missing.extend(_unheld(as_it_stands(stance.taken, shape), row.name, support))
    if support is Support.ISOLATED and item.isolator != FRICTION_ISOLATOR.name:
        # Its record has no numbers of springs: as if it stood on the floor it would be told to be off display.
        builder.missing.append(UNTOLD_ISOLATOR)
    missing = tuple(builder.missing) if _needs_size(models) else ()
    known = builder.found
    for estimates in _estimates_of(models):
        scene = Scene(item, row.name, words, support, models, dict(known), (), missing)
        known |= {name: one for name, one in estimates(scene).items() if name not in known}
    assumptions = [e.note for e in known.values() if e.origin is Origin.ASSUMED and e.note] + builder.doubts
    hanging = None if builder.hanging is None else builder.hanging.known
    if mount is not None and mount.note:
        assumptions.insert(0, mount.note)
    elif stance.by_record.support is not stance.laid.support:
        assumptions.insert(0, say.SUPPORT_TOLD(support=support.value))
    elif stance.by_record.support is None:
        phrase = say.SUPPORT(support=support.value, told=row.told)
        if stance.taken.support is not None:
            phrase = say.SUPPORT_FIXED(support=support.value)
        assumptions.insert(0, f"{phrase}; {say.NOT_RECORDED()}")
    several = of_pieces(item, shape, support, mount)
    if several:
        assumptions.insert(0, several)
    told = tuple(dict.fromkeys((*display_note(item, support), *assumptions)))
    scene = Scene(item, row.name, words, support, models, known, told, missing, hanging=hanging)
    return scene if mount is None else replace(scene, mount=mount.way, mount_origin=mount.origin)


def _held(item: Item, words: str) -> Item:
    """Return what is known of how an object stands, a post of the open air as made fast where nothing tells."""
    fixed = item.support is None and words.startswith(FIXED)
    return replace(item, support=Support.FASTENED) if fixed else item


def _tried(item: Item, row: ObjectClass, as_mounted: tuple[str, ...] | None = None) -> tuple[str, ...]:
    """Return the models that are tried on an object of a class: those of its class, or of how it is held, and more."""
    models = () if set(row.models) & {NO_MODEL, WHEN_HELD} else row.models
    if as_mounted is not None:
        models = as_mounted
    elif item.support is Support.ISOLATED and item.isolator != FRICTION_ISOLATOR.name:
        models = models or models_of(Support.FREESTANDING)
    elif item.support is not None and (item.support is not row.support or not (models or row.models == (NO_MODEL,))):
        models = models_of(item.support)
    for name, joins in _joining():
        if name not in models and joins(item, row.name, models):
            models = (*models, name)
    return models


@cache
def _joining() -> tuple[tuple[str, Callable[[Item, str, Sequence[str]], bool]], ...]:
    """Return the models that may be tried on objects whose class does not name them, and when."""
    return tuple((model.name, model.joins) for model in MODELS if model.joins is not None)


@cache
def _estimates_of(models: tuple[str, ...]) -> tuple[Callable[[Scene], Mapping[str, Estimate]], ...]:
    """Return how the models that are tried on an object estimate parameters of their own."""
    made = (model_named(name).estimates for name in models)
    return tuple(estimates for estimates in made if estimates is not None)


def unclassified(item: Item) -> Scene:
    """Return the scene of an object that nothing can be said of."""
    return Scene(item, "object", "", item.support or Support.FREESTANDING, (), {})


def _unheld(item: Item, object_class: str, support: Support) -> list[str]:
    """Say that the support is missing where a thing is too thin to stand and nothing tells how it is held."""
    if item.support is not None or support is not Support.FREESTANDING:
        return []
    times = too_slender(item, object_class)
    return [too_thin(times)] if times else []


@cache
def models_of(support: Support) -> tuple[str, ...]:
    """Return the models to try when the museum says how an object is held and its class would say otherwise.

    Parameters
    ----------
    support : Support
        How it is held.

    Returns
    -------
    tuple of str
        Names; what it stands on comes before what it does on it.
    """
    held = (model for model in MODELS if support in model.supports)
    return tuple(model.name for model in sorted(held, key=lambda model: model.kind != "isolator"))


@cache
def _needs_size(models: tuple[str, ...]) -> bool:
    """Say whether any of the models needs the object's dimensions."""
    return any(model_named(name).needs_size for name in models)
