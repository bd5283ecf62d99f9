"""Strong-motion formats as obspy waveform plugins, one module a format.

Once Kouros is installed, ``obspy.read`` in any program reads them; the entry points are in pyproject.toml.  Each module
has ``is_format(source)``, strict and cheap, and ``read_format(source, headonly=False)``, which returns an obspy Stream
or raises a `FormatError` naming file and line.  The samples stay in the file's unit; what the header says is in
``trace.stats.kouros`` (see `trace_headers.make_trace`).
"""

from pipeline.motions.formats.record_text import FormatError
from pipeline.motions.formats.trace_headers import Series

__all__ = ["FormatError", "Series"]
