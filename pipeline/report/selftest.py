"""What the method page says of the last numerical self-test."""

from collections.abc import Mapping
from typing import Any

from pipeline.records import RunRecord
from pipeline.report.language import _
from pipeline.report.text import clean
from pipeline.report.views import CaseView, SelfTestView


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
    result = _("no number") if case["result"] is None else f"{case['result']:.2g}"
    return CaseView(
        what=clean(str(case["what"])),
        truth=clean(str(case["truth"])),
        result=clean(f"{result}: {case['problem']}" if case["problem"] else result),
        limit=f"{case['limit']:.2g}",
        passes=bool(case["ok"]),
    )
