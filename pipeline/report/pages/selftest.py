"""Last numerical self-test, as the method page tells it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.records import RunRecord
from pipeline.report.language import _, local
from pipeline.report.text import clean


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
