"""The virtual shake table: test signals by name, with their parameters from the command line."""

from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_args, get_type_hints

from pipeline.motions import matching, synthesis
from pipeline.motions.manifest import SiteTable
from pipeline.motions.writing import write_site
from pipeline.operations.workspace import UsageError
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


def describe(kind: str) -> str:
    """Return the parameters of a signal as a person would type them, with those that may be left out in brackets."""
    parts = []
    for name, parameter in signature(SIGNALS[kind]).parameters.items():
        if parameter.default is Parameter.empty:
            parts.append(f"{name}=")
        else:
            parts.append(f"[{name}={_shown(parameter.default)}]")
    return " ".join(parts)


def _shown(value: Any) -> str:
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _arguments(kind: str, make: Callable[..., Motion], words: Sequence[str]) -> dict[str, Any]:
    hints = get_type_hints(make)
    known = signature(make).parameters
    out: dict[str, Any] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if name not in known or not equals:
            raise UsageError(f"{word!r}: {kind} takes {describe(kind)}")
        if name in out:
            raise UsageError(f"{name} is given twice")
        out[name] = _value(name, text, hints[name])
    missing = [name for name, p in known.items() if p.default is Parameter.empty and name not in out]
    if missing:
        raise UsageError(f"{kind} needs {', '.join(missing)}; it takes {describe(kind)}")
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
