"""Messages that tests read: real ones, and a first alert written after the form of ShakeAlert's."""

from datetime import UTC, datetime
from pathlib import Path

DATA = Path(__file__).parents[1] / "data" / "shakemap"
NOW = datetime(2026, 1, 1, tzinfo=UTC)
PARK = (37.77, -122.47)
"""Golden Gate Park, San Francisco."""

ALERT = """<?xml version="1.0" encoding="UTF-8"?>
<event_message category="live" message_type="{kind}" orig_sys="dm" version="0" timestamp="1989-10-18T00:04:25Z">
<core_info id="7"><mag units="Mw">{magnitude}</mag><mag_uncer units="Mw">0.5</mag_uncer>
<lat units="deg">37.04</lat><lon units="deg">-121.88</lon><depth units="km">8</depth>
<orig_time units="UTC">1989-10-18T00:04:16Z</orig_time></core_info>
<gm_info><gmcontour_pred number="2">
<contour><MMI units="">4</MMI><PGA units="{unit}">18.07</PGA><PGV units="cm/s">2.37</PGV>
<polygon number="4">38.5,-123.7 35.5,-123.7 35.5,-120 38.5,-120</polygon></contour>
<contour><MMI units="">5</MMI><PGA units="{unit}">80.95</PGA><PGV units="cm/s">11.0</PGV>
<polygon number="4">37.5,-122.3 36.6,-122.3 36.6,-121.4 37.5,-121.4</polygon></contour>
</gmcontour_pred></gm_info></event_message>
"""
"""Between the contours, half way in the logarithm, lie 38.25 cm/s2: the 3.9 % of g of the first message."""


def alert(kind: str = "new", magnitude: str = "5.8", unit: str = "cm/s/s") -> str:
    """Return the first message about Loma Prieta, as it might have been."""
    return ALERT.format(kind=kind, magnitude=magnitude, unit=unit)
