"""The virtual shake table: test signals by name, with their parameters from the command line."""

from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_args, get_type_hints

from pipeline.errors import InputError
from pipeline.motions import matching, synthesis
from pipeline.motions.candidates import Unusable, read_candidates
from pipeline.motions.errors import refusal
from pipeline.motions.manifest import SiteTable
from pipeline.motions.targets import read_target
from pipeline.motions.writing import write_site
from pipeline.operations.workspace import UsageError
from pipeline.quantities import G
from pipeline.records import Motion

SIGNALS: Mapping[str, Callable[..., Motion]] = {
    "sine": synthesis.sine,
    "swept_sine": synthesis.swept_sine,
    "random": synthesis.band_limited_random,
    "rectangular": synthesis.rectangular_pulse,
    "half_sine": synthesis.half_sine_pulse,
    "ricker": synthesis.ricker,
    "mavroeidis_papageorgiou": synthesis.mavroeidis_papageorgiou,
    "spectrum": matching.spectrum_compatible,
}
"""What `kouros motions synthesise` makes; accelerations in m/s2."""


def synthesise(kind: str, words: Sequence[str], folder: Path, *, dry_run: bool = False) -> tuple[Path, Motion]:
    """Make a test signal and write it as a site of its own.

    Parameters
    ----------
    kind : str
        The signal.
    words : sequence of str
        "name=value" of the signal's own parameters; lists with commas.
    folder : Path
        Of the new site.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Path
        The manifest.
    Motion
        The signal.

    Raises
    ------
    UsageError
        Naming the parameter.
    InputError
        As the signal does.
    MotionError
        Where there is a site already.
    """
    make = SIGNALS[kind]
    motion = make(**_arguments(kind, make, words))
    site = SiteTable(name="Virtual shake table", latitude=0.0, longitude=0.0)
    why = f"Written by: kouros motions synthesise {kind} {' '.join(words)}"
    file = write_site(folder, [("test", motion)], site, licence="none needed", why=why, dry_run=dry_run)
    return file, motion


def synthesise_from(
    records: Path,
    target: Path,
    words: Sequence[str],
    folder: Path,
    *,
    compact: bool = False,
    dry_run: bool = False,
) -> tuple[Path, list[Motion], list[Unusable]]:
    """Change each record of a folder until it matches a target spectrum, and write them as a site of their own.

    Parameters
    ----------
    records : Path
        A site, or a folder of record files.
    target : Path
        As of `targets.read_target`.
    words : sequence of str
        "name=value" of damping, band and tolerance.
    folder : Path
        Of the new site.
    compact : bool
        As of `writing.write_site`.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Path
        The manifest.
    list of Motion
        What was made.
    list of Unusable
        What could not be used, or would not match.

    Raises
    ------
    UsageError
        Naming the parameter.
    MotionError
        Where there is a site already, or no record can be used.
    """
    make = matching.spectrum_compatible_record
    given = _arguments("spectrum", make, words, taken=("motion", "periods", "target"))
    spectrum = read_target(target)
    # The band is matched whatever a filter has taken of it before.
    found = read_candidates([records], 0.0, (target,))
    made: list[Motion] = []
    left = list(found.unusable)
    for one in found.candidates:
        try:
            made.append(make(one.motion, spectrum.periods, G * spectrum.psa_g, **given))
        except InputError as problem:
            left.append(Unusable(one.record.name, str(problem)))
    if not made:
        told = "; ".join(f"{one.name}: {one.reason}" for one in left[:3]) or "it holds no files"
        raise refusal(records, "records", f"none can be matched ({told})", "give records of three components")
    site = found.site or SiteTable(name="Virtual shake table", latitude=0.0, longitude=0.0)
    why = f"Made by Kouros from the records of {records.name} for {spectrum.name}; none of them is a recorded motion."
    motions = [(spectrum.level, motion) for motion in made]
    file = write_site(folder, motions, site, licence="as the record", why=why, compact=compact, dry_run=dry_run)
    return file, made, left


def describe(kind: str) -> str:
    """Return the parameters of a signal as a person would type them, with those that may be left out in brackets."""
    return _described(signature(SIGNALS[kind]).parameters)


def _described(parameters: Mapping[str, Parameter]) -> str:
    parts = []
    for name, parameter in parameters.items():
        if parameter.default is Parameter.empty:
            parts.append(f"{name}=")
        else:
            parts.append(f"[{name}={_shown(parameter.default)}]")
    return " ".join(parts)


def _shown(value: Any) -> str:
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _arguments(
    kind: str, make: Callable[..., Motion], words: Sequence[str], taken: Sequence[str] = ()
) -> dict[str, Any]:
    hints = get_type_hints(make)
    known = {name: one for name, one in signature(make).parameters.items() if name not in taken}
    out: dict[str, Any] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if name not in known or not equals:
            raise UsageError(f"{word!r}: {kind} takes {_described(known)}")
        if name in out:
            raise UsageError(f"{name} is given twice")
        out[name] = _value(name, text, hints[name])
    missing = [name for name, p in known.items() if p.default is Parameter.empty and name not in out]
    if missing:
        raise UsageError(f"{kind} needs {', '.join(missing)}; it takes {_described(known)}")
    return out


def _value(name: str, text: str, hint: Any) -> Any:
    allowed = [choice for choice in get_args(hint) if isinstance(choice, str)]
    if allowed:
        return text
    try:
        if hint is int:
            return int(text)
        if hint is float:
            return float(text)
        return tuple(float(part) for part in text.split(","))
    except ValueError as problem:
        raise UsageError(f"{name}: {text!r} is not a number") from problem
