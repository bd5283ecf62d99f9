"""A finished report to look at, and a real browser to look with."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from pipeline.report import render
from tests.conftest import made_once

from . import builder

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

CHROMIUM, DRIVER = Path("/usr/bin/chromium"), Path("/usr/bin/chromedriver")


@pytest.fixture(scope="session")
def report() -> Path:
    """The folder of a rendered report of the builder's record."""
    return made_once("reports", lambda folder: render(builder.record(), folder / "one", doubts=builder.doubts)) / "one"


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    """A headless Chromium with a fresh profile; a machine without one fails instead of skipping."""
    if not (CHROMIUM.exists() and DRIVER.exists()):
        pytest.fail(
            f"{CHROMIUM} or {DRIVER} is missing: install them with `apt-get install chromium chromium-driver`, "
            'or leave these tests out with `pytest -m "not browser"`'
        )
    from selenium.webdriver import Chrome
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.wait import WebDriverWait

    class Patient(Chrome):
        def get(self, url: str) -> None:
            """On a busy machine the driver's own wait now and then ends while the page is still being read."""
            super().get(url)
            WebDriverWait(self, 60.0, 0.05).until(
                lambda c: c.execute_script("return document.readyState") == "complete"
            )

    options = Options()
    options.binary_location = str(CHROMIUM)
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        f"--user-data-dir={tmp_path_factory.mktemp('profile')}",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = Patient(options=options, service=Service(str(DRIVER)))
    yield chrome
    chrome.quit()
