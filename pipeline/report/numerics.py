"""What settled the verdicts of a run, and how large its numerical errors are."""

from collections import Counter
from math import isfinite
from statistics import median

from pipeline.records import Finding, RunRecord
from pipeline.report.describe import decided
from pipeline.report.language import _
from pipeline.report.text import clean, count
from pipeline.report.units import significant
from pipeline.report.views import DecidedView

_KNOWN = ("certificate", "chart", "history")


def decided_views(record: RunRecord) -> tuple[DecidedView, ...]:
    """Return a row for each kind of calculation that settled verdicts, the cheapest first."""
    found: dict[str, list[Finding]] = {}
    for finding in (f for a in record.assessments for f in a.findings):
        found.setdefault(finding.decided_by, []).append(finding)
    total = sum(len(members) for members in found.values())
    order = sorted(found, key=lambda by: (_KNOWN.index(by) if by in _KNOWN else len(_KNOWN), by))
    return tuple(_view(by, found[by], total) for by in order)


def _view(by: str, members: list[Finding], total: int) -> DecidedView:
    errors = [
        abs(f.error / f.demand)
        for f in members
        if f.error is not None and f.demand and isfinite(f.error) and isfinite(f.demand)
    ]
    return DecidedView(
        means=decided(by),
        verdicts=len(members),
        share=f"{significant(100.0 * len(members) / total, 2)} %",
        median=f"{significant(100.0 * median(errors), 2)} %" if errors else _("by proof") if by in _KNOWN[:1] else "–",
        worst=f"{significant(100.0 * max(errors), 2)} %" if errors else "–",
    )


def fidelities(record: RunRecord) -> str:
    """Say how many verdicts were reached at which fidelity, such as "history 2,104, bound 310"."""
    used = Counter(f.fidelity for a in record.assessments for f in a.findings)
    named = {"bound": _("Bound"), "chart": _("Chart"), "history": _("History"), "reference": _("Reference")}
    return ", ".join(f"{named.get(name) or clean(name)} {count(number)}" for name, number in used.most_common())
