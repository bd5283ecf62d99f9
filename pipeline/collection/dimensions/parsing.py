"""The text of a dimensions field -> measured parts (`parse`)."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pipeline.collection.dimensions.labels import labelled, labels_in
from pipeline.collection.dimensions.lexicon import label_words, languages, meanings, units
from pipeline.collection.dimensions.pairs_alike import larger_of_pair
from pipeline.collection.dimensions.quantities import DimensionQuantity, Group
from pipeline.collection.dimensions.reader import Reader
from pipeline.collection.dimensions.result import DimensionNote, DimensionPart, Dimensions
from pipeline.collection.dimensions.tokens import tokens_of
from pipeline.collection.dimensions.units_ahead import units_behind
from pipeline.errors import InputError

LONGEST = 2000
"""Characters of a text that are read; what follows is noted, not read."""

_SHOWN = re.compile(r"(?<![\d.,])\d+([.,])\d{1,2}(?![\d.,]|\s*/)")
_THOUSAND, _LARGE = re.compile(r"\d\.\d{3}"), 50
"""Millimetres with three digits behind a point, which are thousands beside others of this size: nobody measures what is
as large to the micrometre (judgement)."""
_POINTED = re.compile(r"\d{1,3}\.\d{3}")
_ORDERS = {"": ("height", "width", "depth"), "length": ("width", "height", "depth")}
_CONVENTION = "the order is taken as height x width x depth, the museums' convention; it is not written"


_FRACTION = re.compile(r"1/2|[12]/3|[13]/4|[1357]/8|\d?[13579]/(?:16|32)")
"""As inches are parted."""
_GR = re.compile(r"\bgr\.?\s*[:=-]?\s*\Z", re.IGNORECASE)
_SLASHED = re.compile(
    r"(?P<legend>\b[^\W\d_]+\.?(?: ?/ ?[^\W\d_]+\.?){1,2}) ?[:=]? ?"
    r"(?P<run>\d+(?:[.,]\d+)?(?: ?[/x×] ?\d+(?:[.,]\d+)?){1,2})(?![/\d])"
)
"""Words and as many numbers, parted by strokes: Höhe/Breite/Tiefe: 11,5/27/16 cm."""

_LEGEND = re.compile(
    r"(?P<legend>\b[^\W\d_]+\.?(?: ?/ ?[^\W\d_]+\.?){1,2})(?= ?[:=]? ?\d[\d ./,]{0,12}(?:[a-z]{1,2}\.? ?)?[x×] ?\d)"
)
"""The same before numbers that joins part already: height/width 3 1/2 x 4 in."""

_MOST_OF_ALL = r"(?:max(?:imum|imal\w*|\.)?|greatest|overall|total|máx(?:im[oa]|\.)?|massim[oa]|größte|hors tout)(?!\w)"
_EXTREME = re.compile(_MOST_OF_ALL, re.IGNORECASE)
_JOIN = re.compile(r"\s*[x×*]\s+")
_QUALIFIED = re.compile(
    rf"(?:{_MOST_OF_ALL} ?)?\b[^\W\d_]+\.?(?: ?[x×*] (?:{_MOST_OF_ALL} ?)?[^\W\d_]+\.?){{1,2}}(?=\s*:)", re.IGNORECASE
)
"""Sides that a legend names, each with what is said of it: "Max. Height x Max. Width x Max. Depth: 12 x 13 x 14"."""
_TWICE = re.compile(rf"\(?\b([^\W\d_]{{3,12}})\s*:\s*(?={_MOST_OF_ALL}\s+\1\b)", re.IGNORECASE)
"""A label before the same label: "height: overall height 81"."""

_DASHED = re.compile(r"(?<![^\W_])([^\W\d_]{1,2})-(?=\d)")
"""A label that a dash parts from its number: H-7 W-24 L-68 cm."""
_SENTENCE_END = re.compile(r"(?<=\d)\.(?=\s+[^\W\d_])")
"""A full stop behind a number: what a sentence ends with is no side of what the next one names, as in 1850. H 90."""
_DASHED_SIDES = frozenset("hwldbt")
_OVERALL = re.compile(r"\bO([HWLD])(?=\s?[:.]?\s?\d)")
"""A label of the whole: OH: 38 in.; OW: 22 in.; OD: 17 in."""
_PARTED = re.compile(r"(?<![\d.,])(\d{1,3}[.,])( )(\d)(?![\d.,/])")
_PLAIN = r"\d+(?:[.,]\d+)?"
_ONLY_STROKES = re.compile(rf"\s*{_PLAIN}(?:\s*/\s*{_PLAIN}){{1,2}}\s*")
_PARTED_RUN = re.compile(
    r"(?:(?<=[^\W\d_])|(?<=[^\W\d_][.:=])|(?<=[^\W\d_][.:=] )|(?<=[^\W\d_] )|\A)"
    rf"(?:{_PLAIN} ?[x×] ?){{0,2}}{_PARTED.pattern}"
    rf"(?: ?[x×] ?(?:{_PARTED.pattern}|{_PLAIN})){{0,2}}(?= ?(?:cm|mm|m)\b)",
    re.IGNORECASE,
)
"""Numbers with a blank behind the decimal mark, ahead of their unit: "H. 19, 5 cm", "19, 5 x 13, 7 cm"."""
_ARTICLE = re.compile(r"\b(?:de|à) la\b", re.IGNORECASE)
"""In "diamètre de la panse", where it is no label of a width."""
_BOTTOM = re.compile(r"(\bdiam\w*\.? (?:del |di |al )?)fondo\b", re.IGNORECASE)
"""The diameter of a bottom, which in Spanish is no depth: "diam. bocca 45 diam. fondo 30 cm"."""
_APART = 10
"""How many times as long as another a side hardly is of which one unit alone is written (judgement)."""


def parse(
    text: str,
    *,
    default_unit: str | None = None,
    decimal: str = ".",
    language: str = "",
    order: Sequence[str] = (),
    prose: bool = False,
) -> Dimensions:
    """Read the text of a dimensions field.

    Parameters
    ----------
    text : str
        Any text; the first 2,000 characters are read.
    default_unit : str or None
        The unit of lengths that none is written for, "cm" for instance; None leaves them without a value.
    decimal : {".", ","}
        The decimal mark where a number leaves it open ("1,234").
    language : str
        The language of the source, of two letters, which settles short labels such as L. and A.; "" leaves that to the
        words of the text.
    order : sequence of str
        The dimensions that numbers without any have by their order, where the source writes another than height x
        width x depth.
    prose : bool
        Whether the text is of sentences, where a number measures only what is named, or by a unit of its own: years
        and counts stand there too.

    Returns
    -------
    Dimensions
        The parts in the order of the text, values in m and kg, each rounded once; and notes.

    Raises
    ------
    InputError
        For an unknown default unit, decimal mark or language.

    References
    ----------
    The conventions of the CC0 open data of MoMA, the Met and Williams College; height x width x depth as in Cataloging
    Cultural Objects (2006), ch. 3.
    """
    default = None
    if default_unit is not None:
        default = units().get(default_unit)
        if default is None or default.kind != "length":
            known = ", ".join(unit.name for unit in units().values() if unit.kind == "length")
            raise InputError(f"default_unit must be one of {known}, not {default_unit!r}")
    if decimal not in (".", ","):
        raise InputError(f'decimal must be "." or ",", not {decimal!r}')
    if language and language not in languages():
        raise InputError(f"language must be one of {', '.join(languages())}, not {language!r}")
    if len(order) > 1 and len(re.findall(_PLAIN, text)) == len(order) and _ONLY_STROKES.fullmatch(text):
        text = text.replace("/", "x")  # "165/230/170" under "Höhe/Breite/Tiefe"
    head = _TWICE.sub(_blank, _QUALIFIED.sub(_unqualified, larger_of_pair(text[:LONGEST])))
    head = _BOTTOM.sub(r"\1base ", _PARTED_RUN.sub(_together, _of_whole(_ARTICLE.sub(_blank, head))))
    head = _undashed(_LEGEND.sub(_with_joins, _SLASHED.sub(_with_joins, head)))
    if prose:
        head = _SENTENCE_END.sub(";", head)
    decimal = _mark_of(head) or decimal
    told: list[DimensionNote] = []
    tokens = units_behind(labelled(tokens_of(head, decimal), head, language, told))
    reader = Reader(head, tokens, default is not None and not prose)
    reader.notes += told
    reader.read()
    notes = reader.notes
    if len(text) > LONGEST:
        notes.append(
            DimensionNote("truncated", f"{len(text):,} characters, of which {LONGEST:,} are read", LONGEST, len(text))
        )
    groups = _whole(reader.groups)
    _share_last(groups, notes)
    for group in groups:
        _named_again(group)
        if all(q.unit is not None for q in group.quantities):
            continue
        _share_units(group, notes)
        for q in group.quantities:
            if q.unit is None and prose and not q.dimension:
                continue
            if q.unit is None and default is not None:
                q.unit = default
                notes.append(
                    DimensionNote("unit", f"no unit is written; {default.name} is the source's own", q.start, q.end)
                )
            elif q.unit is None:
                notes.append(DimensionNote("missing_unit", "no unit is written, so there is no value", q.start, q.end))
    for group in groups:
        _weighed(group, head, notes)
        for q in group.quantities:
            if decimal == "." and q.unit is not None and q.unit.name == "mm" and _THOUSAND.fullmatch(q.word):
                beside = any(p.kind == "length" and p.den == 1 and p.num >= _LARGE for p in group.quantities)
                q.num *= 1000 if beside else 1
                message = f"{q.word} mm is read as {q.num / q.den:.10g}, its point as a mark of "
                message += "thousands" if beside else "decimals"
                notes.append(DimensionNote("ambiguous", message, q.start, q.end))
            elif decimal == "," and _POINTED.fullmatch(q.word):
                message = f"{q.word} is read as {q.num / q.den:.10g}, its point as a mark of thousands"
                notes.append(DimensionNote("ambiguous", message, q.start, q.end))
    parts = tuple(
        _part(group, number, q) for number, group in enumerate(_ordered(groups, notes, order)) for q in group.quantities
    )
    return Dimensions(text, parts, tuple(notes))


def labels(text: str, decimal: str = ".") -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the short labels of a text, such as H and L, and the languages that explain them best.

    Parameters
    ----------
    text, decimal : str
        As of `parse`.

    Returns
    -------
    tuple[frozenset[str], tuple[str, ...]]
    """
    head = text[:LONGEST]
    return labels_in(tokens_of(head, decimal), head)


def _undashed(text: str) -> str:
    """Return a text with colons for the dashes behind its labels, where several sides have one."""
    sides = [found[1].casefold() for found in _DASHED.finditer(text)]
    able = len(sides) > 1 and len(set(sides)) == len(sides) and _DASHED_SIDES.issuperset(sides)
    return _DASHED.sub(r"\1:", text) if able else text


def _of_whole(text: str) -> str:
    """Return a text with H for OH, where several sides are labelled so."""
    sides = {found[1] for found in _OVERALL.finditer(text)}
    return _OVERALL.sub(r" \1", text) if len(sides) > 1 and sides & {"H", "W"} else text


def _together(found: re.Match[str]) -> str:
    """Return "19, 5" as "19,5 ", of as many characters; behind the name of a part it is that part's number."""
    before = found.string[: found.start()].split()[-1:]
    if before and meanings().get(before[0].casefold(), ("", ""))[0] == "part":
        return found[0]
    return _PARTED.sub(r"\1\3\2", found[0])


def _blank(found: re.Match[str]) -> str:
    return " " * len(found[0])


def _unqualified(found: re.Match[str]) -> str:
    """Return a legend of sides without what is said of each, as many characters: "Max. Height x Max. Width"."""
    bare = _EXTREME.sub(_blank, found[0])
    words = [word.strip(" .").casefold() for word in _JOIN.split(bare)]
    known = meanings()
    sides = [known.get(word, ("", ""))[0] == "dimension" or word in label_words() for word in words]
    return bare if all(sides) else found[0]


def _with_joins(found: re.Match[str]) -> str:
    """Return "Höhe/Breite/Tiefe: 11/27/16" as a legend with joins, of as many characters, where each word is a side."""
    words = [word.strip(" .").casefold() for word in found["legend"].split("/")]
    known = meanings()
    sides = [known.get(word, ("", ""))[0] == "dimension" or word in label_words() for word in words]
    run = found.groupdict().get("run")
    as_many = run is None or (len(re.findall(r"[/x×]", run)) + 1 == len(words) and not _FRACTION.fullmatch(run))
    return found[0].replace("/", "×") if as_many and all(sides) else found[0]


def _whole(groups: list[Group]) -> list[Group]:
    """Return the groups, one of those that say each another dimension of the object: 36 in. (91 cm) h.; 20 in. w."""
    out: list[Group] = []
    for group in groups:
        last = out[-1] if out else None
        if last is not None and _is_own(last) and _is_own(group) and not last.named() & group.named():
            last.quantities += group.quantities
            last.qualifiers |= group.qualifiers
        else:
            out.append(group)
    return out


def _named_again(group: Group) -> None:
    """Let labels name bare numbers that they repeat: "82 x 49.5 x 170 cm; Length: 82 Width: 49.5 Height: 170 cm"."""
    bare = [q for q in group.quantities if not q.dimension]
    told = [q for q in group.quantities if q.dimension and q.dimension != "weight"]
    if len(bare) < 2 or not told or bare[0].start > told[0].start:
        return
    pairs = []
    for q in told:
        first = next((b for b in bare if b.num * q.den == q.num * b.den), None)
        if first is None:
            return
        bare.remove(first)
        pairs.append((first, q))
    for first, q in pairs:
        first.dimension = q.dimension
        group.quantities.remove(q)


def _is_own(group: Group) -> bool:
    """Whether a group says of the object itself, with a label at each number, what it says."""
    own = group.name == "overall" and not group.words and not group.aside
    return own and all(q.dimension for q in group.quantities)


def _share_last(groups: list[Group], notes: list[DimensionNote]) -> None:
    """Carry the only unit of a text, behind its last number, back to the labelled numbers of all its parts."""
    every = sorted((q for group in groups for q in group.quantities), key=lambda q: q.start)
    before = [q for q in every if q.run != every[-1].run]
    if len(groups) < 2 or every[-1].kind != "length" or any(q.unit is not None for q in before):
        return
    for q in every[:-1]:
        if q.dimension not in ("", "weight"):
            q.unit = every[-1].unit
            notes.append(DimensionNote("unit", "the unit is that of the last number", q.start, q.end))


def _mark_of(text: str) -> str:
    """Return the decimal mark that a text itself shows by decimals of one or two digits; "" where it shows none."""
    found = {match[1] for match in _SHOWN.finditer(text)}
    return found.pop() if len(found) == 1 else ""


def _share_units(group: Group, notes: list[DimensionNote]) -> None:
    """Carry a unit back in 'H. 10, W. 5, D. 3 cm', and on in 'H. 10 cm, W. 5, D. 3'."""
    first, rest = group.quantities[:1], group.quantities[1:]
    if first and first[0].unit is not None and first[0].kind == "length" and first[0].dimension:
        on = [q for q in rest if q.unit is None and q.dimension not in ("", "weight")]
        # 1.2 m high, 45 wide: of another unit, that is not told.
        alike = all(q.num * first[0].den < _APART * first[0].num * q.den for q in on)
        if on and alike and all(q.unit is None or q.kind != "length" for q in rest):
            for q in on:
                q.unit = first[0].unit
                message = f"the unit is that of the first number, {first[0].unit.name}"
                notes.append(DimensionNote("shared_unit", message, q.start, q.end))
    unit = None
    for q in reversed(group.quantities):
        if q.unit is not None and q.unit.kind == "length":
            unit = q.unit
        elif q.unit is None and unit is not None and q.dimension != "weight":
            q.unit = unit
            notes.append(DimensionNote("unit", f"the unit is that of the next number, {unit.name}", q.start, q.end))


def _weighed(group: Group, text: str, notes: list[DimensionNote]) -> None:
    """Refuse a weight in centimetres and a height in kilograms: the unit is believed, the label is not.

    A Romanian "Gr." is both: greutate in grams, grosime in centimetres.
    """
    for q in group.quantities:
        if (q.dimension == "weight" and q.kind == "length") or (q.kind == "mass" and q.dimension not in ("", "weight")):
            message = f"{q.dimension} in {q.unit.name if q.unit else ''}: the unit is believed, and not the label"
            notes.append(DimensionNote("ambiguous", message, q.start, q.end))
            thick = q.kind == "length" and _GR.search(text[: q.start])
            q.dimension = "weight" if q.kind == "mass" else "thickness" if thick else "unlabelled"


def _ordered(groups: list[Group], notes: list[DimensionNote], own: Sequence[str]) -> list[Group]:
    """Give numbers without a written dimension theirs, by their order within a run."""
    first: tuple[int, int] | None = None
    for group in groups:
        bare = [q for q in group.quantities if not q.dimension]
        for number in dict.fromkeys(q.run for q in bare):
            run = [q for q in group.quantities if q.run == number]
            if len(run) == 1:
                run[0].dimension = "unlabelled"
                continue
            used = {q.dimension for q in run}
            usual = _ORDERS["length" if "length" in used else ""]
            order = iter([d for d in (usual if used - {""} or not own else own) if d not in used])
            for q in run:
                if not q.dimension:
                    q.dimension, q.assumed = next(order, "unlabelled"), True
            first = first or (run[0].start, run[-1].end)
    if first:
        said = f"the order is taken as {' x '.join(own)}, as this source writes it" if own else _CONVENTION
        notes.append(DimensionNote("order", said, *first))
    return groups


def _part(group: Group, number: int, q: DimensionQuantity) -> DimensionPart:
    if q.unit is None:
        value = low = high = None
        unit = ""
    else:
        unit = q.unit.name
        value = high = q.si()
        low = q.scaled(*q.first) if q.first else value
    return DimensionPart(
        group.name, group.words, q.dimension, value, unit, q.unit_text, low, high,
        q.other.si() if q.other is not None and q.other.unit is not None else None,
        tuple(sorted(group.qualifiers)), q.assumed, number, q.start, q.end,
    )  # fmt: skip
