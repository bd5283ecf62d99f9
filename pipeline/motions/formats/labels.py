"""What the head of a table of numbers says in words: step, number, unit, orientation, time, raw or processed.

A label, in one of a dozen languages, stands before a colon or an equals sign, with its unit in brackets or behind the
number: "Time Increment (s) : 0.005", "Tasa de muestreo: 200 Hz", "NPTS= 3000, DT= .01 SEC".  The last line may name the
columns.  What is said in no such words is passed over; what two lines say differently is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from pipeline.motions.formats import trace_headers
from pipeline.motions.formats.record_text import Lines, shown
from pipeline.motions.formats.trace_headers import FACTORS, Orientation
from pipeline.motions.formats.unit_words import SECONDS, seconds, unit_of

_NUMBER = r"([+-]?(?:\d{1,9}(?:\.\d{0,12})?|\.\d{1,12})(?:[eE][+-]?\d{1,2})?)"


def _label(words: str, value: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![\w.])(?:{words})(?:\s*[(\[]\s*([^()\[\]:=]{{1,20}}?)\s*[)\]])?\s*[:=]\s*{value}", re.I)


_STEP = _label(
    r"time (?:increment|step|interval)|(?:sampling|sample) (?:interval|period|step)|delta(?: ?t)?|dt|"
    r"intervalo de muestreo|paso de tiempo|intervallo di campionamento|passo di campionamento|"
    r"pas (?:de temps|d'.{1,2}chantillonnage)|abtastintervall|zeitschritt|"
    r".rnekleme aral...|zaman ad.m.|采样间隔|时间间隔|サンプリング間隔|шаг(?: по времени| дискретизации)?|"
    r"pas(?:ul)? (?:de|in) timp|βήμα(?: χρόνου)?|χρονικό βήμα",
    rf"{_NUMBER}\s*([a-z]{{1,8}})?",
)
_STEP_BARE = re.compile(
    r"\b(?:dt|(?:sampling|sample|time) (?:interval|step)|equally spaced (?:at|by)|(?:equal )?intervals? of)\s+"
    rf"{_NUMBER}\s*(s|secs?|seconds?|ms|msec)\b",
    re.I,
)
_RATE_BARE = re.compile(rf"\bsampl(?:ing|e) (?:rate|freq\w*\.?)(?: ?\(hz\))?\s+{_NUMBER}\s*(?:hz|sps|samples)\b", re.I)
"""Without a colon, where their unit tells that the number is one."""

_RATE = _label(
    r"(?:sampling|sample)[ _](?:rate|freq(?:uency)?\.?)(?:_hz)?|sps|fs|(?:tasa|frecuencia|velocidad) de muestreo|"
    r"muestreo|frequenza di campionamento|fr.{1,2}quence d'.{1,2}chantillonnage|abtastrate|"
    r".rnekleme (?:frekans.|h.z.)|采样(?:频率|率)|サンプリング周波数|частота(?: дискретизации)?",
    rf"{_NUMBER}\s*(khz|(?:secs?|seconds?|s)\b)?",
)
_COUNT = _label(
    r"(?:number|no\.?) of (?:data|points|samples|values)|npts|ndata|(?:num_?)?samples|sample[ _]count|"
    r"n.{1,2}mero de (?:muestras|datos|puntos)|numero (?:di )?(?:dati|campioni|punti)|"
    r"nombre de points|anzahl (?:der )?werte|num.{1,2}r(?:ul)? de (?:puncte|valori)|αριθμός (?:σημείων|τιμών)",
    r"(\d{1,9})(?![.\d])",
)
_UNIT = _label(
    r"(?:field_)?units?|unidad(?:es)?|unit.{1,2}|"
    r"unit.{1,2}[tțţ]i|μονάδ(?:α|ες)|einheit|birim|单位|単位|единицы(?: измерения)?",
    r"(\S.*)",
)
_ACCELERATION = r"\b(?:accel\w*|acc.l.ration\w*|acel\w*|beschleunigung\w*|ivme\w*|ускорени\w*)\b"
_IN = re.compile(
    rf"(?:(?:{_ACCELERATION}|\bacc\b).{{0,40}}?|\bdata )\b(?:in|en|em) (?:units of )?"
    r"([^\s,;()=]{1,12})(?=$|[\s,;(=])",
    re.I,
)
_IN_BRACKETS = re.compile(rf"{_ACCELERATION}[^()\[\]:=]{{0,40}}[(\[]\s*([^()\[\]]{{1,12}}?)\s*[)\]](?!\s*[:=])", re.I)
_NOT_THE_SAMPLES = re.compile(r"\b(?:peak|max\w*|pga|m[aá]xim\w*|picco)\b", re.I)
_TURN = _label(
    r"orientation|comp\.?|component[eo]?|composante|komponente|orientaci.{1,2}n|direction|azimuth(?:_deg)?|stream",
    r"(\S{1,12}(?: deg)?)",
)
_TURN_BARE = re.compile(
    r"\bcomp(?:\.|onent[eo]?)?\s+(N-?S|S-?N|E-?W|W-?E|U-?D|[NS]\s?\d{1,2}\s?[EW]|north-south|east-west|vertical)\b",
    re.I,
)
_SCALE = _label("scale_factor", _NUMBER)
_FACTOR = _label("scale|scal(?:e|ing) factor|multiplier|factor de escala|fattore di scala", _NUMBER)
_FRACTION = re.compile(r"(?<![\d/.])1 ?/ ?(\d{1,5})(?![\d/.])")
_COMMA = re.compile(r"(?<![\d.,])(\d{1,6}),(\d{1,6})(?![\d.,])")
_SCALED = _label("scale_units", r"(\S{1,12})")
_DIP = _label("dip(?:_deg)?", _NUMBER)
_SID = _label("sid", r"([A-Z0-9]{0,8})_([A-Z0-9]{1,8})_([A-Z0-9]{0,8})_([A-Z0-9]_?[A-Z0-9]_?[A-Z0-9])\b")
_STATION = _label(r"station(?: code)?|estaci.{1,2}n|stazione", r"(\w{2,8})(?=\s|,|$)")
_START = _label(
    r"start[ _]time|(?:time of )?(?:the )?first sample|(?:tiempo|hora) de la primera muestra",
    r"(\d{4})[-/](\d\d)[-/](\d\d)[T ](\d\d):(\d\d):(\d\d(?:\.\d{1,9})?)\s?(?:Z|UTC|GMT)",
)
_PEAK = _label(r"pga|peak (?:ground )?acceleration", rf"{_NUMBER}\s*(\S{{1,10}})?")
_LENGTH = _label(
    r"(?:record )?(?:duration|length)|record duration|duraci.{1,2}n(?: del registro)?|durata|durée|dauer",
    rf"{_NUMBER}\s*(?:s|secs?|seconds|seg)?\b(?!\s*(?:points|samples|lines|m\b))",
)
_PLACES = {"latitude": r"lat(?:itude?|itud|\.)?(?:_deg)?", "longitude": r"lon(?:gitude?|gitud|g?\.)?(?:_deg)?"}
_PLACE = {key: _label(words, _NUMBER) for key, words in _PLACES.items()}
_PER_ROW = re.compile(
    r"\b(\d{1,2}) (?:(?:points|values|data|numbers|samples) )?per (?:line|row)\b|"
    r"\((\d{1,2})[EFG]\d{1,2}\.\d{1,2}(?:,\s*I\d{1,2})?\)",
    re.I,
)
"""How many numbers of one series a row has: in words, or as a format of Fortran."""

_RAW = re.compile(
    r"\b(?:un(?:corrected|processed|filtered)|raw data|sin corregir|no corregid[oa]s?|non corrett[oaie]|"
    r"non corrig.{1,2}e?s?|unkorrigiert\w*|d.zeltilmemi.)\b",
    re.I,
)
_FILTERED = re.compile(
    r"\b(?:butterworth|band[- ]?pass|high[- ]?pass|pas[ao][- ](?:banda|alt[ao])|passe-(?:bande|haut)|"
    r"bandpassgefiltert|hochpassgefiltert)\b|"
    r"\bfilt(?:er\b|\.).{0,40}[:=].*\d",
    re.I,
)

_TIME = re.compile(
    r"^(?:time|t|zeit|tiempo|tempo|temps|zaman|tijd|tid|czas|.as|timp|время|χρ.νος|时间|時間|seconds?|sec)$", re.I
)
_PERIOD = re.compile(r"^(?:p[eé]r[ií]od\w*|periyot|schwingungsdauer|frequen\w+|freq|f|固有周期|周期|период)$", re.I)
_SPECTRAL = re.compile(
    r"^(?:p?s[avd](?:[_ ].*)?|(?-i:Sa?e)|p?sa\b.*|pseudo\W?(?:spectr|acc|vel).*|spectral\b.*|spectrum|rot[dg]\d+|"
    r"espectr\w*|spektral\w*)$",
    re.I,
)
_NAMED = {
    "velocity": re.compile(r"^(?:vel(?:o\w*)?|vitesse|geschwindigkeit|hız|скорость|速度)\b", re.I),
    "displacement": re.compile(
        r"^(?:disp(?:l\w*)?|despl\w*|spost\w*|d.placement|verschiebung|перемещение|变位|変位|位移)\b", re.I
    ),
}
_QUALIFIED = re.compile(r"^(?:(?:un)?(?:corrected|processed|filtered)|raw|absolute|relative|ground)\s+", re.I)
_TITLED = re.compile(
    r"^\s*(?:[(\[][^()\[\]]{1,20}[)\]]\s*)?(?![:=])"
    r"(?:$|[(\[,]|(?:time|history|series|records?|values?|data|trace|in|units)\b)",
    re.I,
)
_SUFFIX = re.compile(r"^(?:(t|time)_(s|sec|ms)|(.+?)_(g|gal|mg|cm_?s2|m_?s2|mps2|m/s2|cm/s2))$", re.I)
_SUFFIXES = {"cms2": "cm/s2", "cm_s2": "cm/s2", "ms2": "m/s2", "m_s2": "m/s2", "mps2": "m/s2"}
"""Units behind the names of columns, as programs write them: time_s, acc_ns_g, acceleration_ms2."""

_CLOCK = re.compile(r"^(?:[ymd]+[-/][ymd]+[-/][ymd]+[ t])?h+:m+:s+(?:\.[sf0]+)?$", re.I)
"""How programs call a clock's form where a unit would stand."""

_CALLED = re.compile(r"^(?:columns?|fields|colonne|columnas|spalten)\s*[:=]\s*", re.I)
_INDEX = re.compile(r"^(?:#|no\.?|nr\.?|index|idx|samples?|points?|id|unnamed: 0)?$", re.I)
_TWO_CELLS = re.compile(r"^(\W{0,10}[^\W\d][^:=,;\t]{0,40})[,;\t]\s{0,10}([^:=,;\t]{1,80}?)[,;\t\s]{0,100}$")
_CELL = re.compile(
    r"^([^()\[\]]{1,40}?(?:\s*[(\[][^()\[\]]{1,12}[)\]](?=\s*[(\[]))?)\s*(?:[(\[]\s*([^()\[\]]{1,20}?)\s*[)\]])?$"
)
_TURNED = re.compile(r"[(\[]\s*(\d{3}|[NS]?\s?\d{1,3}\s?[EW]|up|down|[A-Z][A-Za-z-]{0,11})\s*[)\]]?$")
"""An orientation in brackets behind a name: "H1 (045) [g]", "Ch1 (N)"; a number of fewer digits may count."""

_WORD = re.compile(r"[^\s()\[\]]+(?:[ ]?[(\[][^()\[\]]*[)\]])?")
_PREFIX = re.compile(
    r"^(?:acc(?:el(?:eration|erazione)?)?|acc.l.ration|acel(?:eraci.n)?|acelera..o|accelera[tţț]ie|beschleunigung|ivme|"
    r"ускорение|επιτ.χυνση|a)[ _.-]+(?:comp(?:onente?|osante)?[ _.-]+)?|^加速度(?=[A-Za-z])",
    re.I,
)
_SAID: dict[str, Orientation] = {
    **dict.fromkeys(("e-o", "eo", "e-v", "est-vest", "este-oeste", "est-ouest", "est-ovest", "o-w", "ost-west",
                     "d-b", "dogu-bati", "doğu-batı", "в-з", "восток-запад", "l-o", "leste-oeste", "α-δ",
                     "ανατολή-δύση", "شرق-غرب"), 90.0),
    **dict.fromkeys(("norte-sur", "nord-sud", "nord-süd", "kuzey-güney", "k-g", "с-ю", "север-юг", "norte-sul",
                     "kuzey-guney", "β-ν", "βορράς-νότος", "شمال-جنوب"), 0.0),
    **dict.fromkeys(("verticale", "vertikal", "düşey", "dusey", "arriba", "вертикаль", "верт", "κατακόρυφη",
                     "verticala", "verticală", "قائم"), "up"),
}  # fmt: skip
"""Orientations in other languages; the first of two directions is the positive one."""

_CHINESE: dict[str, Orientation] = {
    **dict.fromkeys(("东西", "東西"), 90.0), "南北": 0.0, **dict.fromkeys(("竖", "竪", "垂直", "上下"), "up")
}  # fmt: skip
"""The same in Chinese and Japanese, with 向 or 方向 behind them, and the word for acceleration before or after."""

_GLYPHS = re.compile(r"(?:方向|方|向|分量|成分|加速度|[\s_:-])+")


@dataclass
class HeadColumn:
    """A column as its head names it: its name, and what its unit is of, as `unit_of` says it."""

    name: str
    kind: str
    unit: str
    is_time: bool = False
    said: str = ""
    """The word for its unit, where that is none that is known."""

    @property
    def orientation(self) -> Orientation:
        """Of a component: what its name says, or the name."""
        behind = _TURNED.search(self.name)
        return next(filter(points, map(turned, behind.groups() if behind else ())), turned(_PREFIX.sub("", self.name)))


@dataclass
class RecordHead:
    """What a head says; None, or "", for what it does not.

    Attributes
    ----------
    at : dict of str to int
        The line that says each of the others, from 0.
    step : float or None
        In s.
    count : int or None
        Of samples.
    length : float or None
        In s, of what it calls a duration: mostly the record's, at times that of its strong part.
    kind, unit : str
        As `unit_of`, of the samples.
    orientation : float, str or None
        Degrees clockwise from north, "up", "down" or the head's own word.
    processed : bool or None
        Whether the samples were filtered.
    start : tuple of float, or None
        Year to second of the first sample, where the head says that they are UTC.
    scale, scaled : float or None, str
        Counts of one unit of what is measured, and that unit, as GeoCSV says them.
    peak : tuple of float, or None
        The peak acceleration and one in its last digit, in m/s2.
    code : tuple of str
        Network, station, location and channel.
    factor : float or None
        What a head calls a scale, other than one, and not whether the numbers have it.
    unit_said : str
        The word for the unit, where that is none that is known.
    per_row : int or None
        Numbers of one series in a row.
    columns : tuple of HeadColumn
        As the last line names them.
    about : dict
        Latitude and longitude.
    """

    at: dict[str, int] = field(default_factory=dict)
    step: float | None = None
    count: int | None = None
    length: float | None = None
    kind: str = ""
    unit: str = ""
    orientation: Orientation = None
    processed: bool | None = None
    start: tuple[float, ...] | None = None
    scale: float | None = None
    scaled: str = ""
    peak: tuple[float, float] | None = None
    code: tuple[str, str, str, str] = ("", "", "", "")
    factor: float | None = None
    unit_said: str = ""
    per_row: int | None = None
    columns: tuple[HeadColumn, ...] = ()
    about: dict[str, float] = field(default_factory=dict)

    def says(self, lines: Lines, index: int, key: str, value: Any) -> None:
        """Take what a line says.

        Raises
        ------
        FormatError
            Where another line says something else.
        """
        known = getattr(self, key)
        if key in self.at and known != value:
            wrong = f"says {shown(str(value))} for {key}, and line {self.at[key] + 1} {shown(str(known))}"
            raise lines.error(index, wrong, "find out which is right, and mend the other")
        setattr(self, key, value)
        self.at.setdefault(key, index)


def turned(word: str) -> Orientation:
    """What a word says of an orientation, a channel's code of SEED included; else the word itself."""
    said = trace_headers.component(word)[0]
    if points(said):
        return said
    coded = trace_headers.seed_orientation(word.upper())
    plain = word.strip().lower().rstrip(".").replace("/", "-")
    other: Orientation = _SAID.get(plain, _CHINESE.get(_GLYPHS.sub("", word)))
    return next((one for one in (coded, other) if one is not None), said)


def read_head(lines: Lines, top: int, width: int, separator: str | None) -> RecordHead:
    """Return what the lines before the numbers say.

    Parameters
    ----------
    lines, top : Lines, int
        The file, and its first row of numbers, from 0.
    width, separator : int, str or None
        Cells of a row, and what parts them; None for blanks.

    Returns
    -------
    RecordHead

    Raises
    ------
    FormatError
        Where two lines contradict each other.
    """
    head = RecordHead()
    texts = [_text(lines.lines[index]) for index in range(top)]
    for index, text in enumerate(texts):
        # "Sampling rate (Hz),200": two cells of a table are a label and its value.
        pair = _TWO_CELLS.sub(r"\1: \2", text)
        _numbers(lines, index, pair, head)
        _words(lines, index, pair, head)
    raw, filtered = (any(pattern.search(text) for text in texts) for pattern in (_RAW, _FILTERED))
    head.processed = filtered if raw != filtered else None
    last = next((index for index in reversed(range(top)) if texts[index].strip("#%*;| ")), None)
    if last is not None:
        names = next((index for index in reversed(range(last)) if texts[index].strip("#%*;| ")), last)
        head.columns = columns_of(_with_units(texts[names], texts[last], separator) or texts[last], width, separator)
        head.at["columns"] = last
    _titles(lines, texts, head)
    return head


def _titles(lines: Lines, texts: list[str], head: RecordHead) -> None:
    """Take what the title says of the samples, where neither a label nor the name of a column says it."""
    if head.kind or any(column.kind for column in head.columns):
        return
    for index, text in enumerate(texts):
        found = None if _NOT_THE_SAMPLES.search(text) else _IN_BRACKETS.search(text)
        if found and (said := unit_of(found[1]))[0] == "acceleration":
            head.says(lines, index, "unit", said[1])
            head.kind = said[0]
    if any(re.search(_ACCELERATION, text, re.I) for text in texts):
        return
    for index, text in enumerate(texts):
        title = _QUALIFIED.sub("", text.strip("#%*| \t"))
        for kind, pattern in _NAMED.items():
            if not head.kind and (found := pattern.match(title)) and _TITLED.match(title[found.end() :]):
                head.kind = kind
                head.at.setdefault("unit", index)


def columns_of(text: str, width: int, separator: str | None) -> tuple[HeadColumn, ...]:
    """Return the columns that a line names, none where it does not name so many."""
    text = _CALLED.sub("", text.lstrip("#%*| \ufeff")).strip().rstrip(separator)
    text = re.sub(r"\s+(?=[(\[])", " ", text) if separator is None and "\t" not in text else text
    # A row's tabs may have become blanks; those of the names tell where one ends.
    separator = separator or ("\t" if text.count("\t") == width - 1 else None)
    cells = [cell.strip().strip('"').strip() for cell in (text.split(separator) if separator else _WORD.findall(text))]
    found = [_CELL.match(cell or "#") for cell in cells[:1]] + [_CELL.match(cell) for cell in cells[1:]]
    if len(cells) != width or not all(found):
        return ()
    columns = []
    # One column of (V) is the vertical, several are in volts.
    volts = sum(one is not None and one[2] == "V" for one in found) > 1
    # What counts the rows may stand before the time.
    first = int(len(cells) > 1 and is_index(cells[0]))
    for number, one in enumerate(found):
        name, word = (one[1], one[2] or "") if one else ("", "")
        if not word and (behind := _SUFFIX.match(name)):
            name, word = behind[1] or behind[3], _SUFFIXES.get(behind[4] or "", behind[2] or behind[4])
        # In whatever language: of what is in seconds, nothing but a time is recorded.
        in_time = word.lower() in SECONDS and not _PERIOD.match(name)
        is_time = number == first and (in_time or (not word and bool(_TIME.match(name))))
        kind, unit = ("", word.lower()) if is_time else unit_of(word)
        kind = "a spectrum" if spectral(name) else kind or _kind_by(name)
        if word and not kind and not is_time and not volts and _TURNED.match(f"({word}") and points(turned(word)):
            name, word = f"{name} ({word})", ""
        columns.append(HeadColumn(name, kind, unit, is_time, "" if kind or is_time else word))
    if separator is None and columns[-1].kind and not any(one.kind or one.said for one in columns[:-1]):
        # "N-S  E-W  U-D  (gal)": the unit is that of all.
        alike = columns[-1].kind, columns[-1].unit
        columns = [
            one if one.is_time or not points(one.orientation) else HeadColumn(one.name, *alike) for one in columns
        ]
    # A sentence may have as many words as a row has numbers: a time, units or directions tell names from it.
    pointing = sum(points(one.orientation) for one in columns)
    named = (
        columns[first].is_time
        or _PERIOD.match(columns[0].name)
        or any(one.kind for one in columns)
        or 2 * pointing > len(columns)
    )
    return tuple(columns) if named and not any(":" in one.name or "=" in one.name for one in columns) else ()


def _with_units(names: str, units: str, separator: str | None) -> str:
    """A row of names with the units of the row below it, "" where that is none of units alone."""
    rows = [text.lstrip("#%*| \ufeff").strip() for text in (names, units)]
    parts = [[cell.strip().strip('"()[]') for cell in row.split(separator)] for row in rows]
    known = [cell for cell in parts[1] if unit_of(cell)[0] or cell.lower() in SECONDS or _CLOCK.match(cell)]
    if len(parts[0]) != len(parts[1]) or len(known) < len(parts[1]) or len(known) < 2:
        return ""
    return (separator or " ").join(f"{name} ({unit})" for name, unit in zip(*parts, strict=True))


def _kind_by(name: str) -> str:
    """What a column holds that has no unit, where its name says that it is no acceleration."""
    return next((kind for kind, pattern in _NAMED.items() if pattern.match(name)), "")


def spectral(name: str) -> bool:
    """Whether a column is called what a response spectrum is, such as PSA: its values have the unit of a record's."""
    return bool(_SPECTRAL.match(name.strip()))


def of_spectra(text: str) -> bool:
    """Whether a line names a response spectrum's values, in whatever form."""
    return bool(re.search(r"\bP?S[AVD]\s*[(\[]|\b(?:response|spectral) (?:spectr|accel)|\bfourier\b", text, re.I))


def is_index(name: str) -> bool:
    """Whether a column's name is that of one that counts the rows, or none."""
    return bool(_INDEX.match(name.strip()))


def is_period(name: str) -> bool:
    """Whether a column is called a period or a frequency, over which no record goes."""
    return bool(_PERIOD.match(name.strip()))


def points(said: Orientation) -> bool:
    """Whether what was said is an orientation, and no word."""
    return isinstance(said, float) or said in {"up", "down"}


def _text(raw: bytes) -> str:
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return "".join(letter if letter.isprintable() or letter == "\t" else " " for letter in text).rstrip(" ")


def _numbers(lines: Lines, index: int, text: str, head: RecordHead) -> None:
    text = _COMMA.sub(r"\1.\2", _FRACTION.sub(lambda found: f"{1.0 / max(int(found[1]), 1):.12f}", text))
    if found := _STEP.search(text):
        head.says(lines, index, "step", seconds(found[3] or found[1]) * float(found[2]))
    elif (found := _RATE.search(text)) and float(found[2]) > 0.0:
        # "Sampling rate: 0.005 sec" is what a step is called as well.
        behind = (found[3] or "").lower()
        rate = float(found[2]) * (1000.0 if behind == "khz" else 1.0)
        head.says(lines, index, "step", rate if behind.startswith("s") else 1.0 / rate)
    elif found := _STEP_BARE.search(text):
        head.says(lines, index, "step", seconds(found[2]) * float(found[1]))
    elif (found := _RATE_BARE.search(text)) and float(found[1]) > 0.0:
        head.says(lines, index, "step", 1.0 / float(found[1]))
    if found := _COUNT.search(text):
        head.says(lines, index, "count", int(found[2]))
    if (found := _LENGTH.search(text)) and head.length is None and float(found[2]) > 0.0:
        # Two durations contradict nothing: that of the record, and of its strong part.
        head.length, head.at["length"] = float(found[2]), index
    if found := _PER_ROW.search(text):
        head.per_row = int(found[1] or found[2])
    if (found := _PEAK.search(text)) and (unit := unit_of(found[1] or found[3] or ""))[0] == "acceleration":
        mantissa, _, power = found[2].lower().partition("e")
        digit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
        head.says(lines, index, "peak", (FACTORS[unit[1]] * abs(float(found[2])), FACTORS[unit[1]] * digit))
    if (found := _SCALE.search(text)) and float(found[2]) != 0.0:
        head.says(lines, index, "scale", float(found[2]))
    if (found := _FACTOR.search(text)) and float(found[2]) not in {0.0, 1.0}:
        head.says(lines, index, "factor", float(found[2]))
    for key, pattern in _PLACE.items():
        if found := pattern.search(text):
            head.about.setdefault(key, float(found[2]))


def _words(lines: Lines, index: int, text: str, head: RecordHead) -> None:
    for word in _units(text):
        kind, unit = unit_of(word)
        if kind:
            head.says(lines, index, "unit", unit)
            head.kind = kind
            break
    else:
        if found := _UNIT.search(text):
            head.unit_said = found[2].split("  ")[0].rstrip()[:40]
    if found := _SID.search(text):
        network, station, location, channel = found.groups()[1:]
        head.says(lines, index, "code", (network, station, location, channel.replace("_", "")))
    elif (found := _STATION.search(text)) and not head.code[1]:
        head.says(lines, index, "code", ("", found[2], "", ""))
    if (found := _DIP.search(text)) and abs(abs(float(found[2])) - 90.0) < 1e-6:
        head.orientation = "up" if float(found[2]) < 0.0 else "down"
        head.at["orientation"] = index
    elif (found := _TURN.search(text)) and head.orientation not in {"up", "down"}:
        head.says(lines, index, "orientation", turned(found[2].rstrip(",;")))
    elif (found := _TURN_BARE.search(text)) and head.orientation is None:
        head.says(lines, index, "orientation", turned(found[1]))
    if found := _SCALED.search(text):
        head.says(lines, index, "scaled", unit_of(found[2])[1])
    if found := _START.search(text):
        head.says(lines, index, "start", tuple(map(float, found.groups()[1:])))


def _units(text: str) -> Iterable[str]:
    if found := _UNIT.search(text):
        # GeoCSV says the unit of each column, the time's first.
        yield found[2].rpartition(",")[2]
        yield found[2].split("  ")[0]
    if (found := _IN.search(text)) and not _NOT_THE_SAMPLES.search(text):
        yield found[1]
