"""Small files of every format, written by hand after the formats' own descriptions; none is an agency's record."""

from __future__ import annotations

import numpy as np

DT = 0.01
SHAPE = {"acceleration": 100.0, "velocity": 9.0, "displacement": 1.5}


def tone(count: int = 60, frequency: float = 2.0) -> np.ndarray:
    """A decaying cosine of amplitude one: no two specimens of it are alike, and its largest value comes first."""
    t = DT * np.arange(count)
    return np.exp(-t) * np.cos(2 * np.pi * frequency * t)


def fortran(values: np.ndarray, columns: int, form: str) -> list[str]:
    """Lines of a Fortran block: fields as given, so many a line."""
    fields = [form.format(value) for value in values]
    return ["".join(fields[i : i + columns]) for i in range(0, len(fields), columns)]


def joined(lines: list[str], end: str = "\r\n") -> bytes:
    return (end.join(lines) + end).encode("ascii")


def at2(old: bool = False, title: str = "Nowhere 1/1/2001, Test Station, 230", count: int = 60) -> bytes:
    size = f"{count}  .01000  NPTS, DT" if old else f"NPTS={count:7d}, DT=   .0100 SEC,"
    unit = f"ACCELERATION TIME {'HISTORY' if old else 'SERIES'} IN UNITS OF G"
    return joined(["PEER NGA STRONG MOTION DATABASE RECORD", title, unit, size, *fortran(tone(count), 5, "{:15.7E}")])


def esm(channel: str = "HNE", **changes: str) -> bytes:
    keys = {
        "EVENT_NAME": "NOWHERE", "EVENT_ID": "1", "NETWORK": "XX", "STATION_CODE": "TEST", "LOCATION": "",
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "20190728_160919.870", "SAMPLING_INTERVAL_S": "0.010000",
        "NDATA": "60", "STREAM": channel, "UNITS": "cm/s^2", "PGA_CM/S^2": "100.000000",
        "BASELINE_CORRECTION": "BASELINE REMOVED", "FILTER_TYPE": "BUTTERWORTH", "DATA_TYPE": "ACCELERATION",
        "PROCESSING": "manual (Paolucci et al., 2011)", "USER5": "",
    }  # fmt: skip
    keys |= changes
    return joined([f"{key}: {value}" for key, value in keys.items()] + fortran(100 * tone(), 1, "{:.6f}"), "\n")


def geonet(volume: int = 2, components: tuple[str, ...] = ("N16E", "N74W", "Up")) -> bytes:
    lines: list[str] = []
    for component in components:
        corrected = volume == 2
        step = "0.010 sec intervals" if corrected else "intervals of 0.010 s"
        data = (
            f"Instrument corrected data at {step}" if corrected else f"Raw readings in units of 1.00 mm/s/s  at {step}"
        )
        lines += [
            f"{'Corrected' if corrected else 'Uncorrected'} accelerogram 20010101_000000_TEST GNS Science",
            "Site TEST      43 30 25S  172 43 53E     Cusp file:  20010101_000000_TEST", "Nowhere", "Instrument Cusp_1",
            "Resolution: 18-bit   Instr Period: 0.0050 s   Damping: 0.700", "Accelerogram", "Nowhere",
            "2001 January 1           00:00:54 UT", "Epicentre", "Number of points  60    Duration 0.59 sec", data,
            "Data is unfiltered", f"Component {component}  Accelerometer Axis",
            "Acceleration:  peak    100.0 mm/s/s at  0.00 sec     rms      2.2 mm/s/s",
            "Velocity record unevaluated", "Displacement record unevaluated",
        ]  # fmt: skip
        integers = np.zeros(40, int)
        integers[[8, 9, 18, 19, 38, 39]] = 2001, 1, 1, 0, 0, 25845
        integers[33:36] = (60, 60, 60) if corrected else (60, 0, 0)
        reals = np.zeros(60)
        reals[[24, 25]] = DT
        lines += fortran(integers, 10, "{:8d}") + fortran(reals, 10, "{:8.4f}")
        for kind, size in SHAPE.items():
            if corrected or kind == "acceleration":
                lines += fortran(size * tone(), 10, "{:8.2f}")
    return joined(lines, "\n")


def csmip(volume: int = 2, channels: tuple[str, ...] = ("360 Deg", " Up", " 90 Deg"), dt: float = DT) -> bytes:
    lines: list[str] = []
    for number, component in enumerate(channels, start=1):
        name = f"Chan {number:2d}: {component}"
        if volume == 2:
            lines.append(f"Corrected accelerogram   00001-L1-01001.01       {name}     from")
        lines += [
            "Uncorrected Accelerogram Data             Processed: 01/02/01, CGS", "Record of Mon Jan  1, 2001",
            "Written by hand", "00001-L1-01001.01      Start time:  1/01/01, 00:00:45.0 UTC (GPS)",
            "Station No. 00001   40.941N, 123.633W      Etna  s/n 1  (3 Chns of  3 at Sta)", "Nowhere", name,
            "Record of Mon Jan  1, 2001", "Hypocenter", "Instr Period =  .0109 sec,  Damping =  .670",
            "No. of Points =  60", "Units of uncor data are sec and g .        Max  =  1.000 g , at  .000 sec.", "RMS",
        ]  # fmt: skip
        if volume == 2:
            lines += ["Peak acceleration =   100.000    cm/sec/sec  at    .000   sec."]
            lines += ["Peak   velocity   =     9.000      cm/sec    at    .000   sec."]
            lines += ["Peak displacement =     1.500        cm      at    .000   sec.", *["text"] * 8]
        reals = np.zeros(100 if volume == 2 else 50)
        if volume == 2:
            reals[52] = dt
        lines += fortran(np.ones(100, int), 16, "{:5d}") + fortran(reals, 8, "{:10.7f}")
        if volume == 1:
            lines += [f"    60 Accelerogram points at {1 / dt:.0f} pts/sec in units of g .      Format: (8f9.6)  "]
            lines += fortran(tone(), 8, "{:9.6f}")
        else:
            for (kind, size), unit in zip(SHAPE.items(), ("cm/sec2", "cm/sec", "cm"), strict=True):
                lines.append(f"    60 points of {kind[:5]} data equally spaced at {dt:5.3f} sec, in {unit}. (8f10.5)")
                lines += fortran(size * tone(), 8, "{:10.5f}")
        lines.append(f"/&  ----------  End of data for channel  {number}  ----------")
    return joined(lines)


def smc(corrected: bool = True, vertical: int = 90, azimuth: int = 133, values: np.ndarray | None = None) -> bytes:
    if values is None:
        values = 100 * tone() if corrected else pairs()
    component = {0: "up", 180: "down"}.get(vertical, f"{azimuth}")
    lines = [f"{'2 CORRECTED' if corrected else '1 UNCORRECTED'} ACCELEROGRAM", "*", "A000A"]
    lines += ["     2001   1   1    0004 Nowhere", "Moment Mag=", f"station = Nowhere  component=    {component}"]
    peak = np.abs(values if corrected else values[1::2]).max()
    lines += [f"epicentral dist =     63.0       pk acc = {peak:8.1f}", "inst type=SMA-1", "*", "*", "*"]
    integers = np.full(48, -32768)
    integers[[1, 2, 3, 4, 5, 7, 8, 12, 13, 15, 16]] = 2001, 1, 0, 4, 0, 1, 1, vertical, azimuth, 2, len(values)
    reals = np.full(50, 1.7e38)
    if corrected:
        reals[1] = 1 / DT
    lines += fortran(integers, 8, "{:10d}") + fortran(reals, 5, "{:15.7E}") + ["|", "|by hand"]
    data = [f"{value:.4E}".replace("E+0", "E+").replace("E-0", "E-").rjust(10) for value in values]
    return joined(lines + ["".join(data[i : i + 8]) for i in range(0, len(data), 8)])


def pairs() -> np.ndarray:
    """Pairs of irregular time and acceleration that lie on one straight line a piece: resampled without an error."""
    t = np.array([0.0, 0.0013, 0.0200, 0.0271, 0.0271, 0.0600, 0.1000])
    a = np.array([0.0, 13.0, 200.0, 271.0, 271.0, 600.0, 0.0])
    return np.column_stack([t, a]).ravel()


def cosmos(stage: int = 1, azimuths: tuple[int, ...] = (90, 360, 400), apart: bool = False) -> bytes:
    lines: list[str] = []
    title = ("Raw acceleration counts", "Uncorrected acceleration", "Corrected acceleration")[stage]
    for number, azimuth in enumerate(azimuths, start=1):
        blocks = [["acceleration"]] if stage < 2 else [list(SHAPE)]
        if apart:
            blocks = [[kind] for kind in SHAPE]
        for kinds in blocks:
            lines += _cosmos_header(title.replace("acceleration", kinds[0]), number, azimuth, stage)
            for kind in kinds:
                unit, form = (
                    {"acceleration": "cm/sec2 (04)", "velocity": "cm/sec (05)", "displacement": "cm (06)"}[kind],
                    "(8F10.5)",
                )
                data = fortran(SHAPE[kind] * tone(), 8, "{:10.5f}")
                if stage == 0:
                    unit, form = "counts (50)", "(10I8)"
                    data = fortran(np.round(1e6 * tone()).astype(int), 10, "{:8d}")
                lines += [f"      60 {kind} pts, approx    0 secs, units={unit}, Format={form}", *data]
            lines.append(f"End-of-data for Chan {number} {kinds[0]}")
    return joined(lines)


def _cosmos_header(title: str, number: int, azimuth: int, stage: int) -> list[str]:
    integers = np.full(100, -999)
    integers[[0, 1, 2, 3, 39, 41, 42, 43, 44, 49, 53]] = stage, 1, 4, 120, 2001, 1, 1, 0, 4, number, azimuth
    reals = np.full(100, -999.0)
    reals[[21, 29, 41, 46, 61, 63]] = 1.0, 39.5, 2.0, 1.0, 1000 * DT, 100.0 if stage else 1e6
    lines = [f"{title}   (Format v01.20 with 13 text lines)", *["text"] * 3]
    lines += ["Statn No: 02-000001 Code:XX-TEST   Nowhere", *["text"] * 3]
    lines += [f"Sta Chan   {number}: {azimuth} Deg (Rcrdr Chan  ?) Location:Ground", *["text"] * 3]
    lines += ["Values used when parameter of data value is unknown/unspecified:  -999, -999.000"]
    lines += [" 100 Integer-header values follow on  10 lines, Format = (10I8)", *fortran(integers, 10, "{:8d}")]
    lines += [" 100 Real-header values follow on  20 lines, Format =(5F15.6)", *fortran(reals, 5, "{:15.6f}")]
    return [*lines, "   1 Comment line(s) follow, each starting with a |", "| by hand"]


def csv(
    header: str = "time (s),HNE (cm/s2),H2 360 (g),V up [m/s^2]", separator: str = ",", comments: str = ""
) -> bytes:
    data = [(f"{DT * i:.3f}", f"{100 * a:.6f}", f"{a:.6f}", f"{9 * a:.6f}") for i, a in enumerate(tone())]
    rows = [separator.join(row[: header.count("(") + header.count("[")]) for row in data]
    return joined([*comments.splitlines(), header.replace(",", separator), *rows], "\n")
