"""A dimension written in any of the museums' styles is read back: its value exactly, its dimension, its unit.

Truth: the fraction that was written, times the exact definition of the unit, rounded once to the nearest double.
"""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.collection.dimensions import Dimensions, parse
from pipeline.quantities import LENGTHS, MASSES

SI = {unit: Fraction(repr(value)) for unit, value in (LENGTHS | MASSES).items()}
ENGLISH = {"in": ("in", "in.", "inches", '"', "”", "″", "''"), "ft": ("ft", "ft.", "feet", "'", "’", "′")}
METRIC = {"cm": ("cm", "cm.", "centimeters"), "mm": ("mm", "millimetres"), "m": ("m", "meters")}
VULGAR = {Fraction(1, 4): "¼", Fraction(1, 2): "½", Fraction(3, 4): "¾", Fraction(1, 8): "⅛", Fraction(7, 8): "⅞"}
LABELS = {  # as English writes them
    "height": ("H", "H.", "h.", "H:", "Height"),
    "width": ("W", "W.", "w.", "W:", "Width"),
    "depth": ("D", "D.", "d.", "D:", "Depth"),
    "diameter": ("Diam.", "diam", "Diameter:", "Ø"),
    "length": ("L.", "l.", "Length"),
}
WORDS = {
    "height": ("Höhe", "hauteur", "alto", "altezza", "hoogte", "altura", "înălțime", "高さ"),
    "width": ("Breite", "largeur", "ancho", "larghezza", "breedte", "largura", "lățime", "幅"),
    "depth": ("Tiefe", "profondeur", "fondo", "profondità", "diepte", "profundidade", "adâncime", "奥行"),
    "diameter": ("Durchmesser", "diamètre", "diámetro", "diametro", "diâmetro", "diametru", "径"),
    "length": ("Länge", "longueur", "lunghezza", "lengte", "comprimento", "lungime"),
}
PARTS = ("overall", "base", "frame", "framed", "sheet", "image", "rim", "with base", "bowl")
JOINS = (" x ", " × ", " by ", "x", " X ")


def shown(number: Fraction) -> st.SearchStrategy[str]:
    """Write a number of eighths in one of the ways that museums do."""
    whole, rest = divmod(number, 1)
    ways = [f"{float(number):g}"]
    if rest:
        fraction = f"{rest.numerator}/{rest.denominator}"
        ways += (
            [f"{whole} {fraction}", f"{whole}-{fraction}", f"{whole} {fraction.replace('/', '⁄')}"]
            if whole
            else [fraction]
        )
        if rest in VULGAR:
            ways += [f"{whole}{VULGAR[rest]}", f"{whole} {VULGAR[rest]}"] if whole else [VULGAR[rest]]
    return st.sampled_from(ways)


eighths = st.integers(1, 8 * 300).map(lambda n: Fraction(n, 8))
units = st.sampled_from([(unit, word) for unit, words in (ENGLISH | METRIC).items() for word in words])


def values(d: Dimensions) -> list[tuple[str, float | None, str]]:
    return [(p.dimension, p.value, p.unit) for p in d.parts]


@given(st.data(), st.lists(eighths, min_size=2, max_size=3), units, st.sampled_from(JOINS), st.sampled_from(PARTS))
def test_joined_by_order(data, numbers, unit, join, part):
    """A x B x C, the unit behind the last number or behind each."""
    name, word = unit
    texts = [data.draw(shown(n)) for n in numbers]
    gap = "" if join == "x" and word[0] in "\"”″''’′" else " "
    each = data.draw(st.booleans())
    body = join.join(f"{t}{gap}{word}" for t in texts) if each and join != "x" else f"{join.join(texts)}{gap}{word}"
    d = parse(f"{part}: {body}")
    expected = [float(n * SI[name]) for n in numbers]
    assert values(d) == [(dim, v, name) for dim, v in zip(("height", "width", "depth"), expected, strict=False)]
    assert {p.name for p in d.parts} == {part}
    assert all(p.assumed for p in d.parts)


@given(st.data(), st.permutations(sorted(LABELS)), st.integers(1, 3), units, st.sampled_from(["; ", ", ", " x ", "\n"]))
def test_labels_before(data, dimensions, count, unit, between):
    name, word = unit
    numbers = [data.draw(eighths) for _ in range(count)]
    labels = data.draw(st.sampled_from([LABELS, WORDS]))
    pieces = [
        f"{data.draw(st.sampled_from(labels[dim]))} {data.draw(shown(n))} {word}"
        for dim, n in zip(dimensions, numbers, strict=False)
    ]
    d = parse(between.join(pieces))
    assert values(d) == [(dim, float(n * SI[name]), name) for dim, n in zip(dimensions, numbers, strict=False)]
    assert not any(p.assumed for p in d.parts)


@given(st.data(), st.integers(1, 3), units, st.sampled_from([" x ", ", ", " by "]), st.booleans())
def test_labels_behind(data, count, unit, between, brackets):
    """10 in. H x 12 in. W, and 10 in. (h) x 12 in. (w)."""
    name, word = unit
    numbers = [data.draw(eighths) for _ in range(count)]
    labels = [("H", "height"), ("W", "width"), ("D", "depth")][:count]
    pieces = [
        f"{data.draw(shown(n))} {word} {f'({label.lower()})' if brackets else label}"
        for n, (label, _) in zip(numbers, labels, strict=True)
    ]
    d = parse(between.join(pieces))
    assert values(d) == [(dim, float(n * SI[name]), name) for n, (_, dim) in zip(numbers, labels, strict=True)]


@given(st.data(), st.lists(eighths, min_size=3, max_size=3), st.booleans())
def test_legends(data, numbers, before):
    """(w x h x d) before the numbers or behind them."""
    body = " x ".join([data.draw(shown(n)) for n in numbers]) + " cm"
    text = f"width x height x depth: {body}" if before else f"{body} (w x h x d)"
    expected = [float(n * SI["cm"]) for n in numbers]
    assert values(parse(text)) == [(d, v, "cm") for d, v in zip(("width", "height", "depth"), expected, strict=True)]


@given(st.data(), st.lists(eighths, min_size=1, max_size=3), st.sampled_from(ENGLISH["in"]))
def test_inches_with_centimetres(data, numbers, word):
    """Centimetres rounded to the millimetre are within half of one: no contradiction, and both are kept."""
    inches = " x ".join([data.draw(shown(n)) for n in numbers])
    metric = [round(float(n * SI["in"] * 100), 1) for n in numbers]
    d = parse(f"{inches} {word} ({' x '.join(f'{m:g}' for m in metric)} cm)")
    assert [p.value for p in d.parts] == [float(n * SI["in"]) for n in numbers]
    assert [p.alternative for p in d.parts] == [float(Fraction(f"{m:g}") / 100) for m in metric]
    assert not d.having("contradiction")
    assert not d.having("conversion")


@given(st.integers(1, 20), st.integers(1, 11 * 8), st.data(), st.sampled_from([("'", '"'), ("ft.", "in."), ("’", "”")]))
def test_feet_and_inches(feet, eighth, data, marks):
    inches = Fraction(eighth, 8)
    text = data.draw(shown(inches))
    ends = (
        (f"{feet}{marks[0]} {text}{marks[1]}", f"{feet}{marks[0]}{text}")
        if marks[0] == "'"
        else (f"{feet} {marks[0]} {text} {marks[1]}",)
    )
    for body in ends:
        value = float((12 * feet + inches) * SI["in"])
        assert values(parse(body)) == [("unlabelled", value, "in")]
        assert [p.value for p in parse(f"{body} x {body}").parts] == [value, value]


@given(st.integers(1, 5000), st.integers(1, 999), st.sampled_from(["cm", "mm"]))
def test_decimal_commas_and_thousands(whole, thousandths, unit):
    tenths = Fraction(thousandths % 9 + 1, 10)
    expected = float((whole + tenths) * SI[unit])
    decimal = f"{whole},{tenths.numerator * 10 // tenths.denominator}"
    assert values(parse(f"{decimal} {unit}")) == [("unlabelled", expected, unit)]
    assert values(parse(f"{whole:,}.5 {unit}")) == [("unlabelled", float((whole + Fraction(1, 2)) * SI[unit]), unit)]
    german = f"{whole:,}".replace(",", ".") + ",5"
    assert values(parse(f"{german} {unit}", decimal=",")) == values(parse(f"{whole:,}.5 {unit}"))


@given(eighths, eighths, units, st.sampled_from(["-", " - ", "–", " to "]))
def test_ranges(one, two, unit, dash):
    name, word = unit
    low, high = sorted((one, two))
    (part,) = parse(f"{float(low):g}{dash}{float(high):g} {word}").parts
    assert (part.low, part.high, part.value) == (float(low * SI[name]), float(high * SI[name]), float(high * SI[name]))


@given(
    st.integers(1, 5000), st.sampled_from([("kg", "kg"), ("g", "grams"), ("lb", "lbs."), ("lb", "lb."), ("oz", "oz.")])
)
def test_weights(tenths, unit):
    name, word = unit
    number = Fraction(tenths, 10)
    for text in (
        f"{float(number):g} {word}",
        f"Weight: {float(number):g} {word}",
        f"H. 3 cm; {float(number):g} {word}",
    ):
        assert values(parse(text))[-1] == ("weight", float(number * SI[name]), name)


@given(st.text(max_size=300))
def test_any_text_is_read(text):
    d = parse(text)
    assert d.text == text
    assert all(0 <= p.start < p.end <= len(text) for p in d.parts)
    assert all(0 <= n.start <= n.end <= len(text) for n in d.notes)


PIECES = st.sampled_from(
    [
        "x",
        " ",
        "1",
        "8 7/8",
        ".1",
        "½",
        "in",
        '"',
        "'",
        "cm",
        "(",
        ")",
        ";",
        ",",
        ":",
        "-",
        "\n",
        "H",
        "diam.",
        "to",
        "each",
        "lb",
        "min",
        "base",
    ]
)


@given(st.lists(PIECES, max_size=60), st.sampled_from([None, "cm"]))
def test_any_mixture_of_its_pieces_is_read(pieces, unit):
    d = parse("".join(pieces), default_unit=unit)
    assert all(p.value is None or p.value >= 0.0 for p in d.parts)


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("40/30 cm", [("height", 0.4), ("width", 0.3)]),
        ("40 / 30 / 2,5 cm", [("height", 0.4), ("width", 0.3), ("depth", 0.025)]),
        ("24/18/6 in.", [("height", 24 * 0.0254), ("width", 18 * 0.0254), ("depth", 6 * 0.0254)]),
        ("Höhe/Breite/Tiefe: 11/5/8 cm", [("height", 0.11), ("width", 0.05), ("depth", 0.08)]),
        # What one dimension has two numbers of reaches from one to the other; the larger one counts.
        ("Durchmesser: 10/12 cm", [("diameter", 0.12)]),
        ("30/40 x 20 cm", [("height", 0.4), ("width", 0.2)]),
        ("3/4 cm", [("unlabelled", 0.0075)]),
        ("3/4 x 2 cm", [("height", 0.0075), ("width", 0.02)]),
        # A slip for 11 5/8 in., as its conversion says: 29.5 cm.
        ('Plate 11/5/8 x 9 5/16"', [("height", 11.625 * 0.0254), ("width", 9.3125 * 0.0254)]),
        ('5 1/2 / 3 1/4 in.', [("height", 5.5 * 0.0254), ("width", 3.25 * 0.0254)]),
        ("dated 11/5/2016, 4 x 5 cm", [("height", 0.04), ("width", 0.05)]),
    ],
)  # fmt: skip
def test_strokes_part_sizes_where_they_make_no_fraction(text: str, read: list[tuple[str, float]]) -> None:
    found = [(part.dimension, part.value) for part in parse(text).parts]
    assert [name for name, _ in found] == [name for name, _ in read]
    assert [value for _, value in found] == pytest.approx([value for _, value in read], rel=1e-12)
