"""The specimens of every format by name: which reader takes each, and what writes it."""

from __future__ import annotations

from collections.abc import Callable

from tests.motions.formats import national
from tests.motions.formats import specimens as hand

SPECIMENS: dict[str, tuple[str, Callable[[], bytes]]] = {
    "at2": ("peer", hand.at2),
    "at2-old": ("peer", lambda: hand.at2(old=True)),
    "esm": ("esm", hand.esm),
    "geonet-v1a": ("geonet", lambda: hand.geonet(1)),
    "geonet-v2a": ("geonet", hand.geonet),
    "csmip-v1": ("csmip", lambda: hand.csmip(1)),
    "csmip-v2": ("csmip", hand.csmip),
    "smc-corrected": ("smc", hand.smc),
    "smc-uncorrected": ("smc", lambda: hand.smc(corrected=False)),
    "cosmos-v0": ("cosmos", lambda: hand.cosmos(0)),
    "cosmos-v1": ("cosmos", hand.cosmos),
    "cosmos-v2": ("cosmos", lambda: hand.cosmos(2)),
    "csv": ("table", hand.csv),
    "film": ("volume1", national.volume1),
    "film-usc": ("volume1", lambda: national.volume1("usc", ("N90E",))),
    "csmip-v1-narrow": ("csmip", national.csmip_narrow),
    "csmip-usc-v2": ("csmip", national.usc2),
    "bhrc": ("bhrc", national.bhrc),
    "cwa": ("cwa", national.cwa),
    "nsmn": ("nsmn", national.nsmn),
    "unam": ("unam", national.unam),
    "jma": ("jma", national.jma),
    "csmnc": ("csmnc", national.csmnc),
    "columns": ("columns", national.columns),
    "itaca-1": ("esm", national.itaca),
    "series-of-words": ("columns", national.series),
    "columns-of-words": ("columns", national.worded),
    "columns-of-a-platform": ("columns", national.platform),
    "geocsv": ("columns", national.geocsv),
    "knet-csv": ("table", national.knet_csv),
    "kiknet-csv": ("table", lambda: national.knet_csv(kik=True)),
}
"""Name -> the reader's module in pipeline.motions.formats, and what writes the file."""
