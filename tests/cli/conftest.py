"""What all tests of the command leave out where it runs in this process."""

import pytest


@pytest.fixture(autouse=True)
def few_periods(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw spectra of few periods on the pages of records: tests/report/test_record_page.py looks at whole ones."""
    monkeypatch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 12)
