"""The sheet to walk a gallery with: each object to act on once, on paper of the size that was asked for."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from unicodedata import normalize

import pytest
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from pypdf import PdfReader

from pipeline.mitigate.saying import ANCHORED, ENGINEER, HEAVIEST
from pipeline.quantities import G, sorting_key
from pipeline.records import Recommendation
from pipeline.report import render
from pipeline.report.files import sheet_fonts
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.walk_sheet import LACKING, PAPERS, sheet_file, sheet_pdf
from pipeline.report.language import Language
from pipeline.report.pages.chances import ChanceView
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.plainly import brief_measure
from pipeline.report.pages.views import PageView, State
from pipeline.report.pages.walking import WORDS, WalkRow, WalkView, few, numbers_to_set, walk_view
from pipeline.report.render import pages_of
from pipeline.report.text import cased
from pipeline.report.units import Units, inches
from tests.soak import SOAK

from . import builder
from .shown import shown

HEAD = PageHead("Museum", "run", "2031-05-01T02:13:44.000", "1", "", demonstration=False)
FOOT = re.compile(r"page (\d+) of (\d+)")


def words_of(pdf: bytes | Path, folder: Path) -> list[str]:
    """The text of each page."""
    file = pdf if isinstance(pdf, Path) else folder / "one.pdf"
    if isinstance(pdf, bytes):
        file.write_bytes(pdf)
    return [page.extract_text() for page in PdfReader(file).pages]


def drawn(rows: list[WalkRow], paper: str = "A4", name: str = "Gallery 12", measure: int = 0) -> bytes:
    at = len(rows) - measure
    return sheet_pdf(WalkView(name, PageView("g.html"), tuple(rows[:at]), tuple(rows[at:])), HEAD, Language(), paper)


def advice(**parameters: tuple[float, str]) -> Recommendation:
    return Recommendation(
        "1",
        "",
        "design",
        "m",
        "A measure",
        " ".join(f"{{{name}}}" for name in parameters),
        {name: value for name, (value, _unit) in parameters.items()},
        {name: unit for name, (_value, unit) in parameters.items()},
        (),
    )


def test_each_object_to_act_on_is_on_its_gallerys_sheet_once_and_in_the_order_of_the_page(report: Path) -> None:
    several = 0
    for gallery in shown(builder.record()).galleries:
        sheet = report / sheet_file(gallery.page.file)
        assert sheet.exists() == gallery.on_display
        assert ("Sheet to walk with" in (report / gallery.page.file).read_text()) == gallery.on_display
        if not gallery.on_display:
            continue
        # Each on a line of its own: the number, in full, is the first text of its row.
        lines = Counter(line.strip() for page in words_of(sheet, report) for line in page.splitlines())
        wanted = [o for o in gallery.objects if o.state is State.ACT and not o.settled and len(o.number) < 12]
        assert {o.number: lines[o.number] for o in wanted} == {o.number: 1 for o in wanted}
        # What is decided, or fine and not worth a measurement, is on no sheet.
        measured = {o.number for one in gallery.survey for o in one.objects} | {
            o.number for o in gallery.objects if o.open_for
        }
        others = {o.number for o in gallery.objects if o.settled or o.state is not State.ACT} - measured
        assert not others & set(lines)
        told = "\n".join(words_of(sheet, report))
        # What is done alike goes case by case, what is in none last.
        on_the_way = [
            sorted(t.objects, key=lambda o: (not o.place, sorting_key(o.place), sorting_key(o.number)))
            for t in gallery.tasks
        ]
        places = [told.index(o.number) for some in on_the_way for o in some if o in wanted and o.measures[1:] == ()]
        assert places == sorted(places)
        several += len(wanted) > 1
    assert several


@pytest.mark.parametrize("paper", PAPERS)
def test_pages_are_of_the_size_that_is_set_and_say_gallery_date_and_which_they_are(paper: str, tmp_path: Path) -> None:
    rows = [WalkRow(f"N.{at}.", "A title of some words", "Padded clamps", "force 24 N") for at in range(150)]
    pdf = drawn(rows, paper, measure=50)
    file = tmp_path / "one.pdf"
    file.write_bytes(pdf)
    pages = PdfReader(file).pages
    assert len(pages) > 2
    for at, page in enumerate(pages, 1):
        assert (float(page.mediabox.width), float(page.mediabox.height)) == pytest.approx(PAPERS[paper], abs=0.01)
        text = page.extract_text()
        (found,) = FOOT.findall(text)
        assert found == (str(at), str(len(pages)))
        assert "Gallery 12" in text
        assert "results of 2031-05-01" in text
        assert "02:13" not in text
    every = "\n".join(words_of(pdf, tmp_path))
    assert all(every.count(row.number) == 1 for row in rows)
    # A heading of a part is never the last of a page.
    assert all("To measure" not in text.splitlines()[-4:] for text in words_of(pdf, tmp_path))


def test_a_report_is_on_the_paper_of_its_settings(tmp_path: Path) -> None:
    folder = render(builder.record(), tmp_path / "letter", paper="Letter").parent
    sheets = sorted(folder.glob("*-sheet.pdf"))
    assert sheets
    sizes = {tuple(map(float, page.mediabox[2:])) for sheet in sheets for page in PdfReader(sheet).pages}
    assert sizes == {PAPERS["Letter"]}
    one, other = (PageRenderer(builder.record(), Units(), Language(), paper).identity for paper in PAPERS)
    assert one != other


def test_the_same_results_give_the_same_bytes() -> None:
    page, found = next((p, f) for p, f in pages_of(builder.record()) if p.on_display)
    sheets = {PageRenderer(builder.record(), Units(), Language()).draw(page, found, ()).sheet for _ in range(2)}
    assert len(sheets) == 1
    # Another date of the results is another sheet.
    later = replace(page, made="2040-01-01T00:00:00")
    assert PageRenderer(builder.record(), Units(), Language()).draw(later, found, ()).sheet not in sheets


def test_with_nothing_to_do_the_sheet_says_so(tmp_path: Path) -> None:
    (text,) = words_of(drawn([]), tmp_path)
    assert "Nothing to do here" in text
    assert FOOT.findall(text) == [("1", "1")]


@pytest.mark.long("test_each_object_to_act_on_is_on_its_gallerys_sheet_once_and_in_the_order_of_the_page")
def test_hostile_texts_break_no_sheet(tmp_path: Path) -> None:
    texts = [
        *builder.HOSTILE.values(),
        "x" * (10_000 if SOAK else 3_000),
        "a b " * (5_000 if SOAK else 1_000),
        "\x00\x1b[31m",
        "W" * 600,
        "\u202e" * 50,
        "😀",
        "",
    ]
    rows = [WalkRow(f"N.{at}.", text, text, text, text) for at, text in enumerate(texts)]
    rows += [WalkRow(text, "", "") for text in texts]
    for name in ("Gallery 12", *texts):
        told = "\n".join(words_of(drawn(rows, name=name), tmp_path))
        assert all(told.count(f"N.{at}.") == 1 for at in range(len(texts)))
    assert "\u202e" not in told


def test_titles_in_other_scripts_are_shown_or_said_to_be_lacking(tmp_path: Path) -> None:
    rows = [WalkRow("1", "Πορτρέτο", ""), WalkRow("2", "Chip de bărbat și țăran", "")]
    told = "\n".join(words_of(drawn(rows), tmp_path))
    assert "Πορτρέτο" in told
    assert "țăran" in told
    assert LACKING not in told
    # Letters of Arabic are joined (meem has the form of a beginning), and drawn from right to left: pypdf turns such
    # runs round, so that what it reads is the word only where the sheet has it the other way.
    told = "\n".join(words_of(drawn([WalkRow("3", "مرحبا", "")]), tmp_path))
    assert "\ufee3" in told
    assert "مرحبا" in normalize("NFKC", told)
    # Chinese, Japanese and Korean are in the reader's own fonts, also where lines are cut.
    rows = [WalkRow("日-77", "日本の壺" * 9, ""), WalkRow("4", "청자 항아리", ""), WalkRow("5", "铜鼎", "")]
    told = "\n".join(words_of(drawn(rows), tmp_path))
    assert "日-77" in "".join(told.split())
    assert all(word in told for word in ("日本の壺", "항아리", "铜鼎"))
    assert LACKING not in told
    # No font of the sheet has these: the number is there, and the reason.
    told = "\n".join(words_of(drawn([WalkRow("\U00012000-77", "\U00012000", "")]), tmp_path))
    assert f"{LACKING}-77" in told
    assert "stands for letters that the fonts of this sheet lack" in told


def test_a_font_of_the_machine_goes_into_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A font with one letter of its own, such as none that PDF names has, where people keep their fonts."""
    letter = "\ue0d7"
    fonts = tmp_path / ".local" / "share" / "fonts" / "truetype"
    fonts.mkdir(parents=True)
    pen = TTGlyphPen(None)
    for at, corner in enumerate(((0, 0), (0, 900), (900, 900), (900, 0))):
        (pen.lineTo if at else pen.moveTo)(corner)
    pen.closePath()
    glyph = pen.glyph()
    made = FontBuilder(1000)
    made.setupGlyphOrder([".notdef", "own"])
    made.setupCharacterMap({ord(letter): "own"})
    made.setupGlyf({".notdef": glyph, "own": glyph})
    made.setupHorizontalMetrics({".notdef": (1000, 0), "own": (1000, 0)})
    made.setupHorizontalHeader(ascent=900, descent=-100)
    made.setupNameTable({"familyName": "Own", "styleName": "Regular", "psName": "Own"})
    made.setupOS2()
    made.setupPost()
    made.save(fonts / "ipag.ttf")
    monkeypatch.setenv("HOME", str(tmp_path))
    caches = (sheet_fonts._found_here, sheet_fonts._letters_in, sheet_fonts._named)
    try:
        for one in caches:
            one.cache_clear()
        pdf = drawn([WalkRow("1", letter * 3, "")])
        assert fonts / "ipag.ttf" in sheet_fonts.fonts_here()
        assert LACKING not in "\n".join(words_of(pdf, tmp_path))
        (page,) = PdfReader(tmp_path / "one.pdf").pages
        held = [font.get_object() for font in page["/Resources"]["/Font"].values()]  # type: ignore[index]
        (own,) = [font for font in held if "Own" in font["/BaseFont"]]
        assert "/FontFile2" in own["/FontDescriptor"]
    finally:
        for one in caches:
            one.cache_clear()


def test_what_to_do_has_few_words() -> None:
    assert few("one two") == "one two"
    assert len(few("word " * 40).split()) == WORDS
    for gallery in shown(builder.record()).galleries:
        assert all(len(few(task.title).split()) <= WORDS for task in gallery.tasks)


def test_numbers_are_those_that_somebody_sets_in_the_museums_units() -> None:
    one = advice(clearance=(0.2, "m"), movement=(0.1, "m"), force=(100.0, "N"), moment=(50.0, "N m"), mass=(5.0, "kg"))
    metric = numbers_to_set(one, Units("cm"))
    assert "20\u202fcm free all round" in metric
    assert "movement" not in metric
    # 100 N are the weight of 10.197 kg, 50 N m that of 5.099 kg at 1 m; of both less is too little.
    assert "to hold 11\u202fkg" in metric
    assert "moment" not in metric
    alone = replace(one, parameters={"moment": 50.0}, sentence="{moment}")
    assert numbers_to_set(alone, Units("cm")) == "moment 5.1\u202fkg at an arm of 1\u202fm"
    # 0.2 m are 7.874 in, 100 N 22.48 lb, 50 N m 36.88 ft lb and 5 kg 11.02 lb; of the first three less is too little.
    imperial = "7\u00a0⅞\u00a0in free all round; to hold 23\u202flb; mass 11\u202flb"
    assert numbers_to_set(alone, Units("in")) == "moment 37\u202flb at an arm of 1 ft"
    assert numbers_to_set(one, Units("in")) == numbers_to_set(one, Units("ft")) == imperial
    assert numbers_to_set(advice(force=(2.0 * 0.45359237 * G, "N")), Units("in")) == "to hold 2\u202flb"
    # Two digits, the last one up: 1,234 N are 125.83 kg.
    assert numbers_to_set(advice(force=(1234.0, "N")), Units("cm")) == "to hold 130\u202fkg"


def test_what_pieces_hold_they_hold_in_all_and_a_dot_is_no_strip() -> None:
    ties = advice(pieces=(4.0, "-"), force=(100.0, "N"))
    assert numbers_to_set(ties, Units("cm")) == "4 pieces; hold 11\u202fkg in all"
    wax = advice(pieces=(4.0, "-"), size=(0.02, "m"), force=(100.0, "N"))
    assert numbers_to_set(wax, Units("cm")) == "4 × Ø 2\u202fcm; hold 11\u202fkg in all"


@pytest.mark.parametrize(
    ("metres", "up", "told"),
    [
        (0.0254, True, "1\u00a0in"),
        (0.0255, True, "1\u00a0⅛\u00a0in"),
        (0.0255, False, "1\u00a0in"),
        (0.001, True, "⅛\u00a0in"),
        (0.0, False, "0\u00a0in"),
    ],
)
def test_inches_are_in_eighths(metres: float, up: bool, told: str) -> None:
    assert inches(metres, up=up) == told


def test_what_makes_advice_doubtful_goes_before_it() -> None:
    """Sizes that nobody believes are checked first; who knows what it is says so before an engineer is asked."""
    record = builder.record()
    views = {view.number: view for gallery in shown(record).galleries for view in gallery.objects}
    told = dict[str, WalkRow]()
    for kind in ("plain", "slender", "unnamed"):
        chance = ChanceView("Harm is possible.", "", "", slender=kind == "slender", unnamed=kind == "unnamed")
        pairs = [
            (
                replace(found, recommendations=() if kind == "unnamed" else found.recommendations),
                replace(view, chance=chance),
            )
            for found in record.assessments
            for view in [views.get(found.scene.item.object_number)]
            if view is not None and view.state is State.ACT and not view.settled and found.recommendations
        ]
        assert pairs
        walk = walk_view("", PageView("g.html"), pairs, (), (), Decided((), Units()), Units())
        assert len(walk.act) == len(pairs)
        told[kind] = walk.act[0]
    assert (told["slender"].what, told["slender"].numbers) == ("Check its sizes first", "")
    assert told["unnamed"].what == "Say first what it is"
    assert told["plain"].what not in {told["slender"].what, told["unnamed"].what}


def test_a_sheet_that_counts_a_later_decision_says_so(tmp_path: Path) -> None:
    view = WalkView("Gallery 12", PageView("g.html"), (WalkRow("1", "", "Clamp it"),), ())
    told = {
        day: words_of(sheet_pdf(replace(view, decided=day), HEAD, Language()), tmp_path)[0]
        for day in ("", "2031-04-30", "2031-05-01", "2031-05-12")
    }
    assert all("results of 2031-05-01" in text for text in told.values())
    assert {day for day, text in told.items() if "decisions until" in text} == {"2031-05-12"}
    assert "decisions until 2031-05-12" in told["2031-05-12"]


def test_a_force_on_what_nobody_weighed_is_told_in_times_its_weight() -> None:
    """Truth by hand: 9,806.65 N on 850 kg are 1.176 of its weight, rounded up to 1.2, whatever it weighs."""
    one = advice(force=(9806.65, "N"), heaviest=(850.0, "kg"), weight=(85.0, "kg"))
    alone = "Fasten its base: the mount must hold {force} sideways."
    one = replace(one, measure="fasten", sentence=f"{alone} {HEAVIEST}")
    for units in (Units("cm"), Units("in")):
        assert numbers_to_set(one, units) == "to hold 1.2 times its weight"
        told = brief_measure(one, units)
        assert told == "Fasten its base: the mount must hold 1.2 times its weight sideways. Weigh it first."
    # Where it was weighed, the force is the number.
    weighed = replace(one, sentence=alone)
    assert numbers_to_set(weighed, Units("cm")) == "to hold 1000\u202fkg"
    assert brief_measure(weighed, Units("cm")) == "Fasten its base: the mount must hold 1000\u202fkg sideways."


def test_what_comes_before_a_measure_is_on_the_sheet() -> None:
    """Wax in a case that falls holds nothing, and nobody ties down a tonne by the sheet."""
    one = advice(force=(100.0, "N"))
    told = numbers_to_set(replace(one, sentence=f"{ANCHORED} {ENGINEER} {{force}}"), Units("cm"))
    assert told == "first have what it stands in fastened; an engineer designs it; to hold 11\u202fkg"


def test_a_gallery_that_is_a_number_is_called_one(tmp_path: Path) -> None:
    told = words_of(drawn([WalkRow("1", "Jug", "")], name="704"), tmp_path)
    assert "Gallery 704" in "\n".join(told)
    assert "Gallery Gallery" not in "\n".join(words_of(drawn([WalkRow("1", "Jug", "")]), tmp_path))


@pytest.mark.parametrize("paper", ["A4", "Letter"])
def test_a_number_and_its_unit_stand_on_one_line(paper: str, tmp_path: Path) -> None:
    """Wherever a line ends: "170" at the end of one, and "kg" below, is read as a number of something else."""
    texts = [f"{'to hold ' * some}to hold 170\u202fkg" for some in range(8)]
    rows = [WalkRow(str(at), "Vase", "Fasten", text) for at, text in enumerate(texts)]
    lines = [line for page in words_of(drawn(rows, paper), tmp_path) for line in page.splitlines()]
    assert sum("170\u202fkg" in line for line in lines) == sum("170" in line for line in lines) > 0


def test_the_case_stands_before_the_title(report: Path) -> None:
    placed = 0
    for gallery in shown(builder.record()).galleries:
        if not gallery.on_display:
            continue
        told = "".join(" ".join(words_of(report / sheet_file(gallery.page.file), report)).split())
        for one in gallery.objects:
            if one.place and one.state is State.ACT and not one.settled:
                placed += 1
                assert "".join(cased(one.place).split())[:20] in told
    assert placed
