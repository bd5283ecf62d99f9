"""Messages that tests read: real ones, and a first alert written after the form of ShakeAlert's."""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

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


ALERT_MAP = """<gmmap_pred number="4">
<grid_field index="1" name="LON" units="deg"/><grid_field index="2" name="LAT" units="deg"/>
<grid_field index="3" name="PGA" units="cm/s/s"/><grid_field index="4" name="PGV" units="cm/s"/>
<grid_field index="5" name="MMI" units=""/>
<grid_data>
-122.6 37.6 98.0665 10.0 5.0
-122.4 37.6 98.0665 10.0 5.0
-122.6 37.8 24.516625 2.5 4.0
-122.4 37.8 24.516625 2.5 4.0
</grid_data></gmmap_pred>"""
"""In the form of ShakeAlert's messages with a map: lines of longitude, latitude, PGA, PGV and intensity."""


def amplitude(name: str, value: object, units: str, flag: str = "0") -> dict[str, object]:
    """An amplitude as stationlist.json of ShakeMap 4 has it."""
    return {"flag": flag, "units": units, "ln_sigma": 0, "name": name, "value": value}


def station(code: str, place: tuple[float, float], channels: dict[str, list[dict[str, object]]], **more: object) -> Any:
    """A station in the form that ShakeMap's manual gives of stationlist.json, with the numbers of its example."""
    said: dict[str, object] = {
        "network": code.partition(".")[0], "intensity_flag": "", "distance": 104.211, "commType": "UNK",
        "mmi_from_pgm": [{"name": "pga", "sigma": 0.66, "value": 2.95}], "intensity": 3.4, "source": "NC",
        "instrumentType": "OBSERVED", "station_type": "seismic", "code": code, "name": "So Tantau Av Cupertino",
        "pga": 0.4807, "pgv": 0.7679, "intensity_stddev": 0.63, "location": "",
        "distances": {"ry0": 103.951, "rrup": 104.211, "rjb": 104.208, "rx": 9.298, "rhypo": 104.433},
        "channels": [{"name": name, "amplitudes": some} for name, some in channels.items()],
        "predictions": [{"units": "%g", "ln_sigma": 0.7032, "name": "pga", "value": 1.186, "ln_bias": -0.7021}],
    }  # fmt: skip
    point = {"coordinates": [place[1], place[0]], "type": "Point"}
    return {"type": "Feature", "id": code, "geometry": point, "properties": said | more}


def station_list(folder: Path, *stations: Any, name: str = "stationlist.json") -> Path:
    """Write stations as ShakeMap's stationlist.json."""
    file = folder / name
    about = {"process_timestamp": "2018-06-13T17:26:14Z", "shakemap_revision": "4.0"}
    file.write_text(json.dumps({"type": "FeatureCollection", "metadata": about, "features": stations}), "utf-8")
    return file
