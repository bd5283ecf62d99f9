"""Fixtures of other rooms that nights need too: a real server of images, and a real browser."""

from tests.images.conftest import site
from tests.report.conftest import browser

__all__ = ["browser", "site"]
