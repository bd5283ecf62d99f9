"""A run's record becomes a report: pages for people, files for programs, and one lasting name for the newest."""

from pipeline.report.errors import ReportError
from pipeline.report.files.manifest import lasting_name, publish
from pipeline.report.language import Language, language
from pipeline.report.render import render
from pipeline.report.units import Units

__all__ = ["Language", "ReportError", "Units", "language", "lasting_name", "publish", "render"]
