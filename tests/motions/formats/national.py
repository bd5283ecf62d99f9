"""Small files of the national formats, written by hand after their agencies' headers; none is an agency's record."""

from __future__ import annotations

import numpy as np

from tests.motions.formats.specimens import DT, esm, fortran, joined, tone


def volume1(
    style: str = "csmip", channels: tuple[str, ...] = ("90 DEG", "UP", "180 DEG"), times: np.ndarray | None = None
) -> bytes:
    """Pairs of time and acceleration in tenths of g, amplitude 1 g/10; the USC's have one blank more, and no end."""
    t = DT * np.arange(60) if times is None else times
    usc = style == "usc"
    lines: list[str] = []
    for number, name in enumerate(channels, start=1):
        lines += [
            "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:" if usc else
            "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 02/08/94, CDMG QN00A001",
            "NOWHERE EARTHQUAKE",
            "JAN 17, 1994 -1230 GMT" if usc else "JANUARY 17, 1994 04:31 PST",
            "BY HAND" if usc else "00001-S1-94021.02               TRIGGER TIME: 01/17/94, 12:31:04.1 UTC",
            "STATION USC# 0016   34 05 22N, 118 26 05N" if usc else "STATION NO. 00001   33.929N, 118.260W  SMA-1",
            "NOWHERE",
            f"COMP {name}".ljust(72) + "9" if usc else f"CHAN  {number}:  {name}".ljust(80),
            "NOWHERE EARTHQUAKE", "HYPOCENTER", "INSTR PERIOD =  .039 SEC",
            f"NO. OF POINTS =  {len(t)}  RECORD LENGTH = {t[-1]:.3f} SEC",
            "UNITS ARE SEC AND G/10" if usc else
            "UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  =   .100 G, AT   .000 SEC.",
            "RMS",
        ]  # fmt: skip
        integers = np.zeros(100, int)
        integers[27] = len(t)
        lines += fortran(integers, 16, "{:5d}") + fortran(np.zeros(50), 8, "{:10.3f}")
        shaken = np.interp(t, DT * np.arange(60), tone()) if times is not None else tone()
        fields = np.column_stack([t, shaken]).ravel()
        lines += [(" " if usc else "") + line for line in fortran(fields, 10, "{:7.3f}")]
        if not usc:
            lines.append(f"/&  ----------  END OF DATA FOR CHANNEL  {number}  ----------")
    return joined(lines)


def usc2(components: tuple[str, ...] = ("N08W",), every: tuple[int, ...] = (1, 1, 1), unit: bool = True) -> bytes:
    """Volume 2 of the USC: ACC, VEL and DIS behind 25 lines, which end by nothing.

    Its older files hold every second velocity and every fifth displacement, or none of them, and no word on the unit.
    """
    lines: list[str] = []
    for name in components:
        lines += [
            f"CORRECTED ACCELEROGRAM  IIBB127  94.610.0 COMP {name}", "FILE 0 OF UNCORRECTED ACCELEROGRAM DATA",
            "NOWHERE", "JAN 17, 1994 -1230 GMT", "IBB127", "STATION USC# 0061   34 17 11N, 118 13 31W", "NOWHERE",
            f"COMP {name}".ljust(72) + "9", *["text"] * 9,
            "PEAK ACCELERATION =   100.00000  CMS/SEC/SEC AT     .000   SEC.",
            "PEAK   VELOCITY   =     9.00000    CMS/SEC   AT     .000   SEC.",
            "PEAK DISPLACEMENT =     1.50000      CMS     AT     .000   SEC.", *["text"] * 5,
        ]  # fmt: skip
        lines += fortran(np.zeros(100, int), 16, "{:5d}") + fortran(np.zeros(100), 8, "{:10.3f}")
        kinds = (("ACC", 100.0, "CM/SEC/SEC"), ("VEL", 9.0, "CM/SEC"), ("DIS", 1.5, "CM"))
        for (kind, size, units), n in zip(kinds, every, strict=False):
            said = f"  IN UNITS {units}" if unit else ""
            lines.append(f"{60 // n:6d} POINTS OF {kind} DATA EQUALLY SPACED AT   {DT * n:.3f}  SEC.{said}")
            lines += fortran(size * tone()[::n], 8, "{:10.3f}")
    return joined(lines)


def csmip_narrow() -> bytes:
    """Volume 1 in fields of nine, as the oldest digital recorders' files have them, without a format."""
    lines = [
        "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 06/16/98, CDMG 00001", "NOWHERE",
        "JUNE 28, 1992 08:05 PDT", "00001-E1-92183.06               TRIGGER TIME: 06/28/92, 15:05:37.4 UTC",
        "STATION NO. 00001   34.405N, 117.311W     SSA-1  S/N 1", "NOWHERE", "CHAN  1:  90 DEG", "NOWHERE",
        "HYPOCENTER", "INSTR PERIOD", "NO. OF POINTS =     60",
        "UNITS OF UNCOR ACCEL IS G.   MAX  =  1.000 G, AT    .000 SEC.", "RMS",
    ]  # fmt: skip
    lines += fortran(np.zeros(100, int), 16, "{:5d}") + fortran(np.zeros(50), 8, "{:10.3f}")
    lines.append("   60 POINTS OF ACCEL DATA EQUALLY SPACED AT .010 SEC.  (UNITS: G)")
    return joined([*lines, *fortran(tone(), 8, "{:9.6f}"), "/&"])


def bhrc(points: int = 60) -> bytes:
    lines: list[str] = []
    for name in ("L1", "V2", "T3"):
        lines += [
            "* VOL1DS FILE:  5526/01", "Inst Type = SSA-2", "Origin Time : 2012/08/11   12:23:16", "", name[0], "",
            f"COMP {name}".ljust(70),
            "Nowhere                   Station   37.734 N 47.801 E   Altitude 2026m   Azimuth L 50    T 140",
            "Epicenter", "INSTR PERIOD =  .020 SEC", f"NO. OF POINTS = {points:6d}      DURATION = {0.6:7.3f}",
            "UNITS ARE SECONDS AND G/10", "", *["    0"] * 7, *["  .000000E+00"] * 7,
        ]  # fmt: skip
        lines += [*fortran(tone(), 10, "{:13.6E}"), "/&"]
    return joined(lines)


def cwa(rows: int = 60) -> bytes:
    up, north, east = 100.0 * tone(), -50.0 * tone(), 25.0 * tone()
    lines = [
        "#Earthquake Information", "#Origin Time(GMT+08): 2018/02/06-23:50:42", "", "#Station Information",
        "#StationCode: EAS", "#InstrumentKind: FBA", "#StartTime(GMT+08): 2018/02/06-23:50:29.000",
        "#RecordLength(sec): 0.6", "#SampleRate(Hz): 100", "#AmplitudeUnit:  gal. DCoffset(corr)",
        f"#AmplitudeMAX. U:  {up.max():.3f}~   {up.min():.3f}",
        f"#AmplitudeMAX. N:  {north.max():.3f}~ {north.min():.3f}",
        "#DataSequence: Time U(+); N(+); E(+)", "#Data: 4F10.3 ",
    ]  # fmt: skip
    fields = np.column_stack([DT * np.arange(60), up, north, east])[:rows].ravel()
    return joined(lines + fortran(fields, 4, "{:10.3f}"))


def nsmn(count: int = 60) -> bytes:
    lines = [
        "STRONG GROUND MOTION RECORDS OF TURKIYE", "PLACE                   : NOWHERE",
        "EARTHQUAKE DATE         : 2017/07/20 22:31:09 (GMT)", "STATION ID              : 0921",
        "STATION ALTITUDE (m)    : 66", "RECORD TIME             : 20/07/2017 22:30:58.000000 (GMT)",
        f"NUMBER OF DATA          : {count}", "SAMPLING INTERVAL (sec) : 0.01",
        "RAW PGA VALUES (gal)    : (N-S) 100.000000 (E-W) 50.000000 (U-D) 25.000000", "Copyright",
        "DISASTER AND EMERGENCY MANAGEMENT PRESIDENCY", "       N-S          E-W          U-D",
    ]  # fmt: skip
    fields = np.column_stack([100.0 * tone(), -50.0 * tone(), 25.0 * tone()]).ravel()
    return joined(lines + fortran(fields, 3, "{:14.6f}"))


def unam(clock: str = "00:00:01", extra: int = 0, factor: str = "1") -> bytes:
    lines = [
        "*" * 86, "INSTITUTO DE INGENIERIA, UNAM", "*" * 86, "ARCHIVO ESTANDAR DE ACELERACION:",
        "VERSION DEL FORMATO                    : 2.0", "CLAVE DE LA ESTACION                   : CUP5",
        "                                       : more", "NUMERO DE CANALES                      : 3",
        "ORIENTACION C1-C6 (rumbo;orientacion)  : /V/N90E/S00E", "ORIENTACION C7-C12 (rumbo;orientacion) :",
        "INTERVALO DE MUESTREO, C1-C6 (s)       : /0.01/0.01/0.01", "INTERVALO DE MUESTREO, C7-C12 (s)      :",
        "FECHA DEL SISMO [GMT]                  : 2004/01/01", "HORA EPICENTRO (GMT)                   : 23:58:02.7",
        f"HORA DE LA PRIMERA MUESTRA (GMT)       : {clock}", "NUM. TOTAL DE MUESTRAS, C1-C6          : /60/60/60   ",
        "NUM. TOTAL DE MUESTRAS, C7-C12         : ", "ACEL. MAX.(Gal), C1-C6                 : /100.00/-50.00/25.00",
        "ACEL. MAX.(Gal), C7-C12                : ", "UNIDADES DE LOS DATOS                  : Gal (cm/s/s)",
        f"FACTOR DE DECIMACION                   : {factor}", "FORMATO DATOS (FORTRAN,10 campos/dato) : 3F10.3",
        "=" * 80, "COMENTARIOS:", "", "=" * 80, "DATOS DE ACELERACION:", "---------+" * 8,
        "   CANAL-1   CANAL-2   CANAL-3", "         V      N90E      S00E", "---------+" * 8,
    ]  # fmt: skip
    table = np.column_stack([100.0 * tone(), -50.0 * tone(), 25.0 * tone()])
    return joined(lines + fortran(np.vstack([table, table[:extra]]).ravel(), 3, "{:10.3f}"))


def jma(rate: str = "SAMPLING RATE= 100Hz", unit: str = "gal(cm/s/s)", commas: str = ",,") -> bytes:
    lines = [
        f"SITE CODE= 93051 Nowhere,32.79{commas}", f" LAT.=  32.7880{commas}", f" LON.= 130.8190{commas}",
        f" {rate}{commas}",
        f" UNIT  = {unit}{commas}", f"INITIAL TIME = 2016 04 14 21 26 20{commas}", f"NS,EW,UD{commas}",
    ]  # fmt: skip
    rows = [f"{100 * a:.3f},{-50 * a:.3f},{25 * a:.3f}{commas}" for a in tone()]
    return joined(lines + rows)


def csmnc(kind: str = "UNCORRECTED", component: str = "EW", peak: str = "100.000", count: int = 60) -> bytes:
    lines = [
        "051XXX130420080201", "0130420080246 2013-04-20 8:2:46 BTM", "NOWHERE EARTHQUAKE, NOWHERE,CHN",
        "EPICENTER  30.300N 103.000E DEPTH 13 KM", "MAGNITUDE  7.0(Ms)", "STATION: 051XXX 30.400N 102.800E",
        "SITE CONDITION: ROCK", "INSTRUMENT TYPE: MR2002/SLJ-100", "OBSERVING POINT: GROUND", f"COMP. {component}",
        f"{kind} ACCELERATION          UNIT: CM/SEC/SEC",
        f"NO. OF POINTS:  {count}  EQUALLY SPACED INTERVALS OF:  0.010  SEC",
        f"PEAK VALUE:    {peak}   AT   0.00 SEC    DURATION:  0.6 SEC", "PRE-EVENT TIME:  20  SEC", "CSMNC", "",
    ]  # fmt: skip
    return joined(lines + [line + " " for line in fortran(100.0 * tone(), 8, " {:12.6E}")])


def columns(separator: str = "  ", head: str = "# by hand") -> bytes:
    rows = [separator.join((f"{DT * i:.2f}", f"{a:.6f}", f"{-0.5 * a:.6f}")) for i, a in enumerate(tone())]
    return joined([head, *rows] if head else rows, "\n")


def knet(direction: str = "N-S", count: int = 800, peak: str = "") -> bytes:
    """K-NET, which obspy reads: a duration of whole seconds, counts, and a peak about their mean."""
    counts = np.round(1000.0 + 5e5 * tone(count)).astype(int)
    largest = 3920.0 / 6182761.0 * np.abs(counts - counts.mean()).max()
    lines = [
        "Origin Time       2018/01/24 19:51:00", "Lat.              41.0", "Long.             142.5",
        "Depth. (km)       30", "Mag.              6.2", "Station Code      AOM004", "Station Lat.      41.4087",
        "Station Long.     141.4486", "Station Height(m) 30", "Record Time       2018/01/24 19:51:37",
        "Sampling Freq(Hz) 100Hz", "Duration Time(s)  8", f"Dir.              {direction}",
        "Scale Factor      3920(gal)/6182761", f"Max. Acc. (gal)   {peak or f'{largest:.3f}'}",
        "Last Correction   2018/01/24 19:51:37", "Memo.             ",
    ]  # fmt: skip
    return joined(lines + fortran(counts, 8, "{:8d} "), "\n")


def itaca() -> bytes:
    """ITACA 1: COMPONENT, a first sample without its day, and raw or processed by DATA_TYPE."""
    content = esm("", DATA_TYPE="UNPROCESSED ACCELERATION", FILTER_TYPE="", EVENT_DATE_YYYYMMDD="19971014",
                  EVENT_TIME_HHMMSS="235909", TIME_FIRST_SAMPLE_S="000010.500", COMPONENT="WE")  # fmt: skip
    dropped = (b"STREAM", b"NETWORK", b"DATE_TIME_FIRST", b"PROCESSING", b"USER5")
    return b"".join(line for line in content.splitlines(True) if not line.startswith(dropped))


def series() -> bytes:
    """SIMBAD: labels, and one series wrapped over rows whose numbers touch."""
    lines = [
        "Event Date & Time             : 2001-01-01 01:32:39", "Station Code / Name           : 1 / Nowhere",
        "Orientation                   : NS", "Processing Info               : Acausal Butterworth bandpass filtering",
        "Filter Cut-off Frequency (Hz) : 0.100 - 50.000", "Time Increment (s)            : 0.01",
        "Number of Data                : 60", "PGA (m/s/s)                   : 1.0000000E+00",
        "Accelaration time series in m/s/s",
    ]  # fmt: skip
    return joined(lines + fortran(tone(), 7, "{:14.7E}"), "\n")


def worded() -> bytes:
    """A step, a number and a unit in Spanish, and columns that the last line names; no time."""
    lines = ["Laboratorio", "Estaci\u00f3n: NOWHERE", "Intervalo de muestreo (s): 0.01", "N\u00famero de muestras: 60",
             "Unidades: cm/s^2", "        N00E        UPDO        N90E"]  # fmt: skip
    rows = fortran(100.0 * np.repeat(tone(), 3), 3, "{:12.3f}")
    return ("\n".join(lines + rows) + "\n").encode()


def platform(unit: str = "cm/s/s") -> bytes:
    """SCEC's Broadband Platform: the columns' names are a comment."""
    head = ["# Sim stat=TEST", f"#    time(sec)      N-S({unit})      E-W({unit})      U-D({unit})"]
    rows = [f"{DT * i:.6e}" + f"\t{100 * a:.3f}" * 3 for i, a in enumerate(tone())]
    return joined(head + rows, "\n")


def geocsv(unit: str = "M/S**2") -> bytes:
    head = ["# dataset: GeoCSV 2.0", "# delimiter: ,", f"# field_unit: UTC, {unit}", "# SID: XX_TEST_00_HNZ",
            "# sample_count: 60", "# sample_rate_hz: 100", "# start_time: 2001-01-01T00:00:59.5Z",
            "# azimuth_deg: 0.0", "# dip_deg: -90.0", "Time, Sample"]  # fmt: skip
    rows = [f"2001-01-01T00:{1 if i >= 50 else 0:02d}:{(59.5 + DT * i) % 60:09.6f}Z, {a:.7f}"
            for i, a in enumerate(tone())]  # fmt: skip
    return joined(head + rows, "\n")


def knet_csv(kik: bool = False, count: int = 60, seconds: str = "0.6") -> bytes:
    """Head as NIED writes it (station and earthquake of a real file), with the offset in the samples."""
    names = [f"{n}(gal)" for n in range(1, 7)] if kik else ["N-S(gal)", "E-W(gal)", "U-D(gal)"]
    place = "#Code,Latitude,Longitude,Height1(m),Height2(m)" if kik else "#Code,Latitude,Longitude,Height(m)"
    lines = [
        "#K-NET CSV", "#Event", "#OriginTime,Latitude,Longitude,Depth(km),Magnitude",
        "#2026/01/13 01:58:00,45.048,142.167,0,5.2", "#Station", place,
        "#FKSH09,37.3530,140.4264,60,260" if kik else "#HKD004,45.2149,142.2260,4",
        "#Record", "#SamplingFrequency(Hz)", "#100", "#DurationTime(s)", f"#{seconds}",
        "#Offset", f"#{','.join(names)}", "#" + ",".join(["-2.90"] * len(names)),
        f"#Time,RelativeTime(s),{','.join(names)}",
    ]  # fmt: skip
    for index, value in enumerate(100 * tone(count)):
        cells = ",".join(f"{value / (1 + number) - 2.9:.2f}" for number in range(len(names)))
        lines.append(f"2026/01/13 01:58:43.{index % 100:02d},{0.01 * index:.2f},{cells}")
    return joined(lines)
