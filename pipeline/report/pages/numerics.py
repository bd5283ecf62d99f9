"""Numerical errors of a run, what settled its verdicts, and the last self-test."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.records import Errors, RunRecord, Tally
from pipeline.report.language import _, local
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


@dataclass(frozen=True, slots=True)
class CaseView:
    """One case of the numerical self-test: the extreme, its truth, what came out, the limit, whether it is within."""

    what: str
    truth: str
    result: str
    limit: str
    passes: bool


@dataclass(frozen=True, slots=True)
class SelfTestView:
    """The last numerical self-test; outdated where the run's kernels are not those that it tested."""

    when: str
    version: str
    kernels: str
    machine: str
    outdated: bool
    cases: tuple[CaseView, ...]

    @property
    def failed(self) -> tuple[CaseView, ...]:
        """The cases that are not within their limits."""
        return tuple(case for case in self.cases if not case.passes)


def self_test_view(record: RunRecord) -> SelfTestView | None:
    """Return the self-test that the run found, or None: there was none."""
    test = record.settings.get("numerics")
    if not test:
        return None
    return SelfTestView(
        when=clean(str(test["when"])).replace("T", " ").replace("+00:00", " UTC"),
        version=clean(str(test["version"])),
        kernels=clean(str(test["kernels"])),
        machine=clean(str(test["machine"])),
        outdated=test["kernels"] != record.settings.get("kernels"),
        cases=tuple(_case(case) for case in test["cases"]),
    )


def _case(case: Mapping[str, Any]) -> CaseView:
    result = _("no number") if case["result"] is None else local(f"{case['result']:.2g}")
    return CaseView(
        what=clean(str(case["what"])),
        truth=clean(str(case["truth"])),
        result=clean(f"{result}: {case['problem']}" if case["problem"] else result),
        limit=local(f"{case['limit']:.2g}"),
        passes=bool(case["ok"]),
    )
