"""Numerical errors of a run, and what settled its verdicts."""

from collections.abc import Mapping
from dataclasses import dataclass

from pipeline.records import Errors, Tally
from pipeline.report.language import _
from pipeline.report.pages.describe import decided
from pipeline.report.text import clean, count
from pipeline.report.units import significant


@dataclass(frozen=True, slots=True)
class DecidedView:
    """How many verdicts one kind of calculation settled, their share, and their numerical errors."""

    means: str
    verdicts: int
    share: str
    median: str
    worst: str


_KNOWN = ("certificate", "chart", "history")


def decided_views(tally: Tally) -> tuple[DecidedView, ...]:
    """Return a row for each kind of calculation that settled verdicts, the cheapest first."""
    found = tally.decided
    total = sum(errors.verdicts for errors in found.values())
    order = sorted(found, key=lambda by: (_KNOWN.index(by) if by in _KNOWN else len(_KNOWN), by))
    return tuple(_view(by, found[by], total) for by in order)


def _view(by: str, errors: Errors, total: int) -> DecidedView:
    known = bool(errors.sizes)
    middle = f"{significant(100.0 * median(errors.sizes), 2)} %" if known else ""
    return DecidedView(
        means=decided(by),
        verdicts=errors.verdicts,
        share=f"{significant(100.0 * errors.verdicts / total, 2)} %",
        median=middle or (_("by proof") if by in _KNOWN[:1] else "–"),
        worst=f"{significant(100.0 * errors.worst, 2)} %" if known else "–",
    )


def median(sizes: Mapping[str, int]) -> float:
    """Return the median of numbers that are given with how often they occur, at least one; the lower one of two."""
    ordered = sorted((float(size), often) for size, often in sizes.items())
    half, seen = sum(sizes.values()) / 2.0, 0
    for size, often in ordered:
        seen += often
        if seen >= half:
            return size
    return ordered[-1][0]


def fidelities(tally: Tally) -> str:
    """Say how many verdicts were reached at which fidelity, such as "history 2,104, bound 310"."""
    used = sorted(tally.fidelities.items(), key=lambda pair: -pair[1])
    named = {"bound": _("Bound"), "chart": _("Chart"), "history": _("History"), "reference": _("Reference")}
    return ", ".join(f"{named.get(name) or clean(name)} {count(number)}" for name, number in used)
