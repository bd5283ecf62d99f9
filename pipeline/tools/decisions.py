"""Decisions of people: writing them down, and their effect on the next run."""

import getpass
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime

import numpy as np

from pipeline.analysis.classify import object_classes
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.inventory import items_named, object_numbers
from pipeline.collection.record import digest_of
from pipeline.errors import near
from pipeline.mitigate.rows import Isolator
from pipeline.models import MODELS
from pipeline.motions.manifest import load_manifest
from pipeline.operations.workspace import UsageError, Workspace, site_folder
from pipeline.quantities import Quantity
from pipeline.records import Basis, Decision, DecisionKind, Verdict, in_force
from pipeline.store.decisions import add_decision, looked_at, read_decisions
from pipeline.store.sound import whole_runs

WHO_VARIABLE = "KOUROS_WHO"
"""Environment variable with the name of the person who decides, where it is not that of the account."""

ISOLATOR = "isolator"
"""The word that names a row of the catalogue where a measure is an isolator."""

WHO_LIMIT, WHY_LIMIT = 200, 2000
"""Characters of a name and of a reason."""


@dataclass(frozen=True)
class Wish:
    """A decision as it is put, in words; None or empty for what was not said."""

    object_number: str
    kind: DecisionKind
    words: Sequence[str] = ()
    why: str = ""
    who: str = ""
    on: str = ""
    model: str = ""
    level: str = ""
    until: str = ""


def decide(workspace: Workspace, wish: Wish, *, dry_run: bool = False) -> Decision:
    """Write a decision down, with what the last run of the whole collection found.

    Parameters
    ----------
    workspace : Workspace
        Whose log of decisions it goes into.
    wish : Wish
        The decision, in words.
    dry_run : bool
        Write nothing; the decision has the id 0.

    Returns
    -------
    Decision
        As it is kept.

    Raises
    ------
    UsageError
        For an object, measure, class, model, level or decision that there is not (naming those there are), for a name
        or reason that is empty, and for a date or parameter that cannot be.
    """
    decision = _put(workspace, wish)
    return decision if dry_run else add_decision(workspace.engine, decision)


def _put(workspace: Workspace, wish: Wish) -> Decision:
    engine = workspace.engine
    decision = _stated(wish)
    if wish.kind is DecisionKind.WITHDRAW:
        return replace(decision, withdraws=_withdrawn(workspace, wish))
    item = items_named(engine, [wish.object_number]).get(wish.object_number)
    if item is None:
        raise UsageError(_nowhere(wish.object_number, object_numbers(engine)))
    runs = whole_runs(engine)
    basis = looked_at(engine, runs[0], item.object_number, item.gallery) if runs else ()
    decision = replace(decision, run=runs[0] if runs else "", digest=digest_of(item))
    if wish.kind is DecisionKind.CLASS:
        return replace(decision, object_class=_class(wish.words), basis=basis)
    if wish.kind is DecisionKind.INSTALLED:
        return replace(_installed(workspace, decision, wish.words), basis=basis)
    _concerning(workspace, wish, basis)
    if wish.kind is DecisionKind.VERDICT:
        decision = replace(decision, verdict=_verdict(wish, basis))
    elif wish.words:
        raise UsageError(f"an accepted risk takes no more words than --model and --level, not {wish.words[0]!r}")
    return replace(decision, basis=tuple(b for b in basis if decision.concerns(b.model, b.level)))


def _stated(wish: Wish) -> Decision:
    """Check what every decision has: who, when, why."""
    who = (wish.who or person_here()).strip()
    if not who:
        raise UsageError(f"who decides is not known: give --who NAME, or set {WHO_VARIABLE}")
    why = wish.why.strip()
    if not why:
        raise UsageError('a decision needs its reason: give --why "..."')
    for name, text, most in (("--who", who, WHO_LIMIT), ("--why", why, WHY_LIMIT)):
        if len(text) > most:
            raise UsageError(f"{name} has {len(text)} characters; at most {most} are kept: say it shorter")
    moment = datetime.now(UTC)
    day = _day("--on", wish.on) if wish.on else moment.date()
    if day > moment.date():
        raise UsageError(f"--on {day} is in the future; a decision is written down once it is made")
    until = _day("--until", wish.until) if wish.until else None
    if until is not None and wish.kind is not DecisionKind.ACCEPT:
        raise UsageError(f"--until is for accepted risks; {wish.kind} has no end but a withdrawal")
    if until is not None and until < day:
        raise UsageError(f"--until {until} is before the decision itself, {day}")
    if (wish.model or wish.level) and wish.kind not in (DecisionKind.ACCEPT, DecisionKind.VERDICT):
        raise UsageError(f"--model and --level are for accept and verdict, not for {wish.kind}")
    return Decision(
        0,
        wish.object_number,
        wish.kind,
        who,
        day.isoformat(),
        why,
        moment.isoformat(timespec="seconds"),
        model=wish.model,
        level=wish.level,
        until="" if until is None else until.isoformat(),
    )


def person_here() -> str:
    """Return who sits at this machine, as far as it says; "" where nobody knows."""
    return person_named() or _account()


def person_named() -> str:
    """Return who is named for this machine; "" where nobody is."""
    return os.environ.get(WHO_VARIABLE, "")


def _account() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError):
        # An account without a name: KeyError before Python 3.13.
        return ""


def _day(option: str, text: str) -> date:
    try:
        return date.fromisoformat(text)
    except ValueError as problem:
        raise UsageError(f"{option} {text!r} is no date; write it as 2031-05-01") from problem


def _nowhere(number: str, known: Sequence[str]) -> str:
    return f"there is no object {number!r} in the inventory{near(number, known)}"


def _one(words: Sequence[str], what: str) -> str:
    if len(words) != 1:
        raise UsageError(f"say {what}, and nothing else, not {' '.join(words) or 'nothing'!r}")
    return words[0]


def _of(word: str, known: Iterable[str], what: str) -> str:
    names = list(known)
    if word not in names:
        raise UsageError(f"there is no {what} {word!r}; use one of {', '.join(names)}")
    return word


def _class(words: Sequence[str]) -> str:
    return _of(_one(words, "one class"), object_classes(), "class")


def _withdrawn(workspace: Workspace, wish: Wish) -> int:
    word = _one(wish.words, "the id of the decision")
    open_ = {str(row.id): row.id for row in listed(workspace, wish.object_number)}
    if word not in open_:
        there = f"those in force are {', '.join(open_)}" if open_ else "it has none in force"
        raise UsageError(f"object {wish.object_number!r} has no decision {word!r} to withdraw; {there}")
    return open_[word]


def _concerning(workspace: Workspace, wish: Wish, basis: Sequence[Basis]) -> None:
    """Check that the model and the level named are there, and that the last run has such a finding."""
    if wish.model:
        _of(wish.model, (model.name for model in MODELS), "model")
    if wish.level:
        settings = workspace.settings
        manifest = load_manifest(site_folder(settings.home, settings.site.folder))
        _of(wish.level, (level.name for level in manifest.level), "level")
    if (wish.model or wish.level) and basis:
        there = {(b.model, b.level) for b in basis}
        if not any(wish.model in ("", model) and wish.level in ("", level) for model, level in there):
            listed = ", ".join(f"{model} ({level})" for model, level in sorted(there))
            raise UsageError(f"the last run has no such finding of object {wish.object_number!r}; it has {listed}")


def _verdict(wish: Wish, basis: Sequence[Basis]) -> Verdict:
    if not wish.model:
        raise UsageError("say by --model which verdict is overruled")
    if not basis:
        raise UsageError(f"no run has a verdict on object {wish.object_number!r} yet; make one with `kouros run`")
    levels = sorted({b.level for b in basis if b.model == wish.model})
    if len(levels) > 1 and not wish.level:
        raise UsageError(f"say by --level which verdict is overruled: {', '.join(levels)}")
    return Verdict(_of(_one(wish.words, "pass or fail"), (Verdict.PASS, Verdict.FAIL), "verdict"))


def _installed(workspace: Workspace, decision: Decision, words: Sequence[str]) -> Decision:
    measures = workspace.measures.installable
    if not words:
        raise UsageError(f"say what is installed: one of {', '.join(measures)}")
    measure = _of(words[0], measures, "measure that can be installed")
    kind = measures[measure].isolator
    wanted = {_key(q): q for q in measures[measure].parameters}
    texts = _named(words[1:], (*wanted, "product", *((ISOLATOR,) if kind else ())), measure)
    parameters: dict[str, float] = {}
    product = texts.pop("product", "")
    if ISOLATOR in texts:
        isolator = _isolator(workspace, kind, texts.pop(ISOLATOR))
        parameters, product = _own(isolator, wanted.values()), product or isolator.name
    if len(product) > WHO_LIMIT:
        raise UsageError(f"product has {len(product)} characters; at most {WHO_LIMIT} are kept: say it shorter")
    for name, text in texts.items():
        quantity = wanted[name]
        value = _number(quantity, name, text)
        own = parameters.get(quantity.name, value)
        # Where it stands there may be less room than it could use; all else is its maker's.
        if value > own or (value != own and quantity.name != "stroke"):
            raise UsageError(
                f"{name}={text}, but {product!r} has {own:g} in the catalogue: leave it out, or correct it"
            )
        parameters[quantity.name] = value
    lost = [f"{key} ({q.meaning})" for key, q in wanted.items() if q.name not in parameters]
    if lost:
        raise UsageError(f"{measure} needs {' and '.join(lost)}: write NAME=VALUE for each, in SI units, or 4in")
    units = {q.name: q.unit for q in wanted.values()}
    return replace(decision, measure=measure, parameters=parameters, units=units, product=product)


def _named(words: Sequence[str], known: Sequence[str], measure: str) -> dict[str, str]:
    """Return the words NAME=VALUE of a measure as texts by name, each said once."""
    texts: dict[str, str] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise UsageError(f"{word!r} is no parameter; write NAME=VALUE, as clearance_m=0.1 or clearance_m=4in")
        if _of(name, known, f"parameter of {measure}") in texts:
            raise UsageError(f"{name} is said twice; say it once")
        texts[name] = text.strip()
    return texts


def _isolator(workspace: Workspace, kind: str, name: str) -> Isolator:
    """Return an isolator of that kind from the museum's catalogue."""
    listed = {isolator.name: isolator for isolator in workspace.measures.isolators}
    mine = [isolator.name for isolator in listed.values() if isolator.kind == kind]
    found = listed.get(name)
    if found is None:
        there = f"it has {', '.join(map(repr, mine))}" if mine else f"it has no {kind}"
        raise UsageError(f"there is no isolator {name!r} in the catalogue{near(name, mine) or f'; {there}'}")
    if found.kind != kind:
        raise UsageError(f"{name!r} is a {found.kind}, not a {kind}: install it as that")
    return found


def _own(isolator: Isolator, quantities: Iterable[Quantity]) -> dict[str, float]:
    """Return what a catalogue says of an isolator; a stroke that is as long as its place allows must be said."""
    told = {name: getattr(isolator, name, None) for name in (q.name for q in quantities)}
    return {name: float(value) for name, value in told.items() if value is not None and np.isfinite(value)}


def _key(quantity: Quantity) -> str:
    """Return the name with its unit, as on the command line and in the museum's records: clearance_m."""
    return quantity.name if quantity.unit == "-" else f"{quantity.name}_{quantity.unit.lower()}"


def _number(quantity: Quantity, name: str, text: str) -> float:
    try:
        value = _in_si(text, quantity.unit)
        quantity.check(np.array([value]))
    except ValueError as problem:
        raise UsageError(f"{name}={text} cannot be: {name} must be {quantity.allowed()}") from problem
    return value


def _in_si(text: str, unit: str) -> float:
    """Return a number in SI; a length or a mass may name another unit, as on the sheets that people fill in."""
    try:
        return float(text)
    except ValueError:
        if unit not in ("m", "kg"):
            raise
    # Not 0.10160000000000001 for 4 in.
    return float(f"{of_hand(text, unit).value:.12g}")


# ---------------------------------------------------------------------------------------------------------------------
# What it does to a run


def listed(workspace: Workspace, object_number: str | None = None, *, log: bool = False) -> list[Decision]:
    """Return the decisions about an object, or about all, by id.

    Parameters
    ----------
    workspace : Workspace
        Whose log of decisions is read.
    object_number : str or None
        The museum's number of the object; None: all.
    log : bool
        All that was ever written; else those in force.

    Returns
    -------
    list of Decision
        By id.
    """
    rows = read_decisions(workspace.engine, object_number)
    return list(rows if log else in_force(rows))
