"""Strong-motion formats as obspy waveform plugins, one module a format.

Once Kouros is installed, ``obspy.read`` in any program reads them; the entry points are in pyproject.toml.  Each module
has ``is_format(source)``, strict and cheap, and ``read_format(source, headonly=False)``, which returns an obspy Stream
or raises a `FormatError` naming file and line.  The samples stay in the file's unit; what the header says is in
``trace.stats.kouros`` (see `trace_headers.make_trace`).
"""

from pipeline.motions.formats.record_text import FormatError
from pipeline.motions.formats.trace_headers import Series

NAMES = {
    "BHRC": "BHRC (Iran)",
    "COSMOS": "COSMOS V0 to V2",
    "CSMIP": "CSMIP V1 and V2",
    "CSMNC": "CSMNC (China)",
    "CWA": "CWA (Taiwan)",
    "ESM": "ESM, ITACA and AFAD (DYNA)",
    "FILM_V1": "V1 of film (CSMIP, USC, RENADIC)",
    "GEONET": "GeoNet V1A and V2A",
    "JMA_CSV": "JMA CSV",
    "MOTION_COLUMNS": "columns or one series of numbers, bare or under a head in words",
    "MOTION_CSV": "CSV with units in its head",
    "NSMN": "NSMN (Türkiye)",
    "PEER_AT2": "PEER AT2",
    "SMC": "USGS SMC",
    "UNAM_ASA": "ASA (UNAM, RACM)",
}
"""What the readers are called by obspy (the entry points), and by people."""

__all__ = ["NAMES", "FormatError", "Series"]
