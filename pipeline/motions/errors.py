"""Errors of a refused motion, and the refusals that a person may overrule."""

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Literal, get_args

from pipeline.errors import InputError

Judgement = Literal["clipping", "filled", "cut_off", "size", "drift", "orientation", "mixed", "several"]
"""Refusals that a person may overrule; what is corrupt is refused whatever is accepted."""

JUDGEMENTS: tuple[Judgement, ...] = get_args(Judgement)


class MotionError(InputError):
    """A record or a manifest that Kouros refuses to assess anything with.

    The message names the file, the place in it (key path, component, sample), what is wrong and what mends it.

    Attributes
    ----------
    judgement : str
        The name under which a person may overrule it in the record's table `accept`; "" for what is corrupt.
    """

    exit_code: ClassVar[int] = 4

    def __init__(self, message: str, judgement: Judgement | Literal[""] = "") -> None:
        super().__init__(message)
        self.judgement = judgement


def refusal(file: Path, place: str, wrong: str, remedy: str, judgement: Judgement | Literal[""] = "") -> MotionError:
    """Return the error, so that every refusal reads alike: file: place: what is wrong; remedy.

    Parameters
    ----------
    file : Path
        The record's file or the manifest.
    place : str
        Where in it: key path, component, sample.
    wrong : str
        What is wrong there.
    remedy : str
        What mends it.
    judgement : str
        The name under which a person may overrule it; "" for what is corrupt.

    Returns
    -------
    MotionError
        To be raised by the caller.
    """
    return MotionError(f"{file}: {place}: {wrong}; {remedy}", judgement)


def judged(
    accept: Mapping[Judgement, str],
    judgement: Judgement,
    file: Path,
    place: str,
    wrong: str,
    remedy: str,
    steps: list[str],
) -> None:
    """Refuse what is a matter of judgement, unless the manifest's record accepts it: then its reason becomes a step.

    Parameters
    ----------
    accept : mapping of str to str
        The record's table of overruled refusals: the reason of each, by name.
    judgement : str
        The name of this refusal.
    file, place, wrong, remedy : Path, str, str, str
        As of `refusal`.
    steps : list of str
        What was done to the record; the accepted refusal is appended.

    Raises
    ------
    MotionError
        With its `judgement`, where it is not accepted.
    """
    if judgement not in accept:
        raise refusal(file, place, wrong, f"{remedy}, {_by_manifest(judgement)}", judgement)
    steps.append(f"{place} {wrong}; accepted: {accept[judgement]}")


def unwritten(problem: MotionError) -> MotionError:
    """Return the refusal of a record that no manifest names yet: what overrules it is an option, not a manifest's line.

    Parameters
    ----------
    problem : MotionError
        As it is raised for a manifest's record.

    Returns
    -------
    MotionError
    """
    judgement = problem.judgement
    if not judgement:
        return problem
    way = f'or look at it and overrule by `kouros motions add --accept {judgement}="REASON"`'
    return MotionError(str(problem).replace(_by_manifest(judgement), way), judgement)


def _by_manifest(judgement: Judgement) -> str:
    return f'or look at it and overrule by accept.{judgement} = "REASON" in the manifest\'s record'
