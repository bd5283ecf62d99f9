"""What import refused and doubts is said wherever people look, on every later night, until the records are mended."""

import csv
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from lxml import html
from sqlalchemy import create_engine, delete, text

from pipeline.cli.console import summary_lines
from pipeline.collection.database import open_database
from pipeline.collection.inventory import latest_import, reading_report, replace_inventory, versions
from pipeline.collection.inventory.reading_report import READING, account, doubts
from pipeline.collection.source_audit import ContradictionError
from pipeline.night.importing import go_back, import_collection
from pipeline.night.reading_summary import UNKNOWN
from pipeline.night.run import Selection, run
from pipeline.operations.run_summary import Summary
from pipeline.operations.workspace import open_workspace
from pipeline.records import Doubt, Problem
from pipeline.records.run import DOUBTFUL
from pipeline.report import render
from pipeline.report.pages.reading import PAGES, SHOWN, page_file
from pipeline.settings import Settings, load_settings
from pipeline.store.migrate import upgrade
from pipeline.tools.doctor import diagnose
from pipeline.tools.rerender import render_again
from pipeline.tools.sheet_answers import take_sheet
from tests.collection.real_exports import read
from tests.museum import SILENT, carnegie, workspace
from tests.report import builder
from tests.soak import SOAK

pytestmark = pytest.mark.slow_file

GOOD = ["1,A,Vase,1.2,0.2,0.2", "2,B,Plate,0.03,0.3,0.3"]
BAD = [
    *GOOD,
    ",B,Cup,0.1,0.1,0.1",  # no number
    "2,B,Jug,0.1,0.1,0.1",  # a number that is there
    '4,B,=1+2,"<b>much</b>",0.2,0.2',  # no number at all, and hostile
    "5,,Vase,0.4,-0.2,0.2",  # no place, and a negative width
]
COUNTS = {"rows": 6, "refused": 2, "doubtful": 2, "sheets": 0}


def table(index: Path) -> list[dict[str, str]]:
    with index.with_name("reading.csv").open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def words(index: Path) -> str:
    return " ".join(html.parse(str(index)).getroot().find(".//main").text_content().split())


def night(settings: Settings) -> tuple[Summary, Path]:
    summary = run(settings, SILENT)
    assert summary.report is not None
    return summary, summary.report


def said(settings: Settings, counts: dict[str, int]) -> Path:
    """Run a night; its last lines, index, page, list, summary.json and `kouros check` must all say the same."""
    summary, index = night(settings)
    told = json.loads(index.with_name("summary.json").read_text(encoding="utf-8"))["reading"]
    for reading in (summary.reading, told):
        assert reading is not None
        assert {name: reading[name] for name in counts} == counts
    line = f"{counts['rows']:,} rows, {counts['refused']} refused, {counts['doubtful']} doubtful"
    assert f"read: {line}" in "\n".join(summary_lines(summary))
    assert f"Read from the museum’s records: {line}" in words(index)
    assert line in words(index.with_name("reading.html"))
    assert ("none is left out" in words(index)) is not counts["refused"]
    (looked,) = [one for one in diagnose(settings.home / "kouros.toml") if one.what == "inventory"]
    assert f"read: {line}" in looked.message
    assert looked.state == "warning"
    return index


@pytest.fixture(scope="module")
def museum(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """A museum whose export has two rows to refuse and two to doubt, after its first night."""
    settings = workspace(tmp_path_factory.mktemp("museum"), BAD)
    toml = settings.home / "kouros.toml"
    plain = toml.read_text(encoding="utf-8").replace("shrink_limit = 0.2", "shrink_limit = 0.9")
    toml.write_text(plain.replace('survey = "auto"', "survey = false"), encoding="utf-8")
    night(load_settings(toml))
    return load_settings(toml)


def test_each_row_is_named_with_place_field_words_and_remedy(museum: Settings) -> None:
    index = said(museum, COUNTS)
    rows = [(r["what"], r["row"], r["line"], r["object_number"], r["field"]) for r in table(index)]
    assert rows == [
        ("refused", "3", "4", "", "object_number"),
        ("refused", "4", "5", "", "object_number"),
        ("doubtful", "5", "6", "4", "height_m"),
        ("doubtful", "6", "7", "5", "width_m"),
        ("doubtful", "6", "7", "5", "gallery"),
    ]
    assert all(row["message"] and row["remedy"] for row in table(index))
    page = index.with_name("reading.html").read_text(encoding="utf-8")
    assert "&lt;b&gt;much" in page
    assert "<b>much" not in page
    assert "the object has no number" in page
    assert 'href="reading.html"' in index.read_text(encoding="utf-8")


def test_a_night_that_reads_nothing_anew_or_only_what_changed_says_it_too(museum: Settings) -> None:
    before = said(museum, COUNTS)
    again = said(museum, COUNTS)
    # The same files: of an unchanged inventory nothing is asked again.
    for name in ("reading.html", "reading.csv"):
        assert again.with_name(name).samefile(before.with_name(name))
    # One plain row more and a doubtful one less: the rows that did not change are only counted.
    workspace_rows = [*BAD[:4], "4,B,Jug,0.2,0.2,0.2", BAD[5], "6,B,Dish,0.05,0.3,0.3"]
    export = museum.home / "export.csv"
    kept = export.read_text(encoding="utf-8")
    export.write_text("\n".join([kept.splitlines()[0], *workspace_rows]) + "\n", encoding="utf-8")
    index = said(museum, COUNTS | {"rows": 7, "doubtful": 1})
    assert [row["object_number"] for row in table(index)] == ["", "", "5", "5"]
    # Rendered again, that run says what it said, whatever was imported since.
    run_id = index.parent.name
    export.write_text(kept, encoding="utf-8")
    said(museum, COUNTS)
    once_more = render_again(museum, run_id)
    assert table(once_more) == table(index)
    assert "7 rows, 2 refused, 1 doubtful" in words(once_more)


def test_after_a_return_it_is_that_of_the_version_returned_to(tmp_path: Path) -> None:
    settings = workspace(tmp_path, BAD)
    place = open_workspace(settings)
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    first = account(place.engine)
    workspace(tmp_path, GOOD)
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    good = account(place.engine)
    assert good is not None
    assert (good.rows, good.refused, good.doubtful) == (2, 0, 0)
    go_back(place, 1)
    assert account(place.engine) == first
    assert list(doubts(place.engine, 3)) == list(doubts(place.engine, 1)) != []


def test_what_a_sheet_got_wrong_stays_until_a_sheet_mends_it(tmp_path: Path) -> None:
    settings = workspace(tmp_path, GOOD)
    place = open_workspace(settings)
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)

    def sheet(name: str, *rows: str) -> None:
        (tmp_path / name).write_text(
            "\n".join(["object_number,gallery,mass_kg,friction", *rows]) + "\n", encoding="utf-8"
        )
        take_sheet(place, tmp_path / "kouros.toml", tmp_path / name)

    sheet("one.csv", "1,,heavy,0.3", "2,,1.5,", "9,,2.0,", ",,1.0,")
    told = account(place.engine)
    assert told is not None
    assert (told.rows, told.refused, told.sheets) == (2, 0, 3)
    newest = latest_import(place.engine)
    assert newest is not None
    found = {(d.object_number, d.field, d.message.split(": ")[0]) for d in doubts(place.engine, newest.id)}
    assert found == {("1", "mass_kg", "one.csv"), ("9", "object_number", "one.csv"), ("", "object_number", "one.csv")}
    # The museum's next export does not make the sheet better; a sheet that has the number does.
    workspace(tmp_path, [*GOOD, "3,B,Dish,0.1,0.2,0.2"])
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    after = account(place.engine)
    assert after == replace(told, rows=3)
    sheet("two.csv", "1,,4.5,")
    sheets = [d for d in doubts(place.engine, versions(place.engine)[0].id) if d.what == "sheet"]
    assert {d.object_number for d in sheets} == {"9", ""}


def test_an_inventory_of_before_the_upgrade_is_not_called_whole(tmp_path: Path) -> None:
    """What an older Kouros imported: nothing was noted. Importing the same file again notes it, as no new version."""
    settings = workspace(tmp_path, GOOD)
    place = open_workspace(settings)
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    with place.engine.begin() as connection:
        connection.execute(delete(READING))
    toml = tmp_path / "kouros.toml"
    toml.write_text(toml.read_text(encoding="utf-8").replace('source = "export.csv"', 'source = ""'), encoding="utf-8")
    summary, index = night(load_settings(toml))
    assert summary.reading is None
    assert f"read: {UNKNOWN}" in "\n".join(summary_lines(summary))
    assert "not known what was refused" in words(index)
    assert "none is left out" not in words(index)
    assert not index.with_name("reading.html").exists()
    import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9)
    assert len(versions(place.engine)) == 1
    summary, index = night(load_settings(toml))
    assert summary.reading is not None
    assert "none is left out" in words(index)
    # Of a part of the collection it is not said either.
    part = run(load_settings(toml), SILENT, Selection(objects=("2",)))
    assert part.report is not None
    assert "none is left out" not in words(part.report)
    assert "part of the collection" in words(part.report)


def test_a_database_is_no_other_source(tmp_path: Path) -> None:
    settings = workspace(tmp_path, [])
    museums = create_engine(f"sqlite:///{tmp_path / 'museum.sqlite'}")
    with museums.begin() as connection:
        connection.execute(text("CREATE TABLE things (object_number, gallery, title, height_m, width_m, depth_m)"))
        for row in BAD:
            (cells,) = csv.reader([row])
            values = {f"c{n}": cell for n, cell in enumerate(cells)}
            connection.execute(text("INSERT INTO things VALUES (:c0, :c1, :c2, :c3, :c4, :c5)"), values)
    mapping = tmp_path / "mapping.toml"
    said = re.sub(
        r"\[source\].*?\[museum\]",
        '[source]\nformat = "sql"\ntable = "things"\n[museum]',
        mapping.read_text(),
        flags=re.S,
    )
    mapping.write_text(said, encoding="utf-8")
    place = open_workspace(settings)
    import_collection(place, f"sqlite:///{tmp_path / 'museum.sqlite'}", "mapping.toml", shrink_limit=0.9)
    found = account(place.engine)
    assert found is not None
    assert (found.rows, found.refused, found.doubtful) == (6, 2, 2)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("carnegie_2000", marks=pytest.mark.long("test_real_files_are_accounted_for")),
        "met_27_rows_cp1252",
        "tms_rows_cut_off",
        "moma_rows",
    ],
)
def test_real_files_are_accounted_for(name: str, tmp_path: Path) -> None:
    """Rows of four real exports: rows, refusals and doubtful objects are those of the reading itself."""
    reading = carnegie() if "carnegie" in name else read(name)
    engine = open_database(tmp_path / "k.sqlite")
    upgrade(engine)
    replace_inventory(engine, reading)
    found = account(engine)
    assert found is not None
    doubtful = [item for item in reading.items if item.problems]
    assert (found.rows, found.refused, found.doubtful) == (reading.rows, len(reading.rejected), len(doubtful))
    assert found.rows == found.refused + len(reading.items)
    listed = [d for d in doubts(engine, 1) if d.what == DOUBTFUL]
    assert len(listed) == sum(len(item.problems) for item in doubtful)
    places = {item.object_number: place for item, place in zip(reading.items, reading.places, strict=True)}
    assert all((d.row, d.line) == places[d.object_number] for d in listed)


@pytest.mark.long("test_each_row_is_named_with_place_field_words_and_remedy")
def test_tens_of_thousands_of_doubts_make_no_heavy_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pages show the first rows, whatever order they come in; the list has all, and no cell is a formula.

    Every day they are three pages, as heavy as each of twenty.
    """
    pages_shown = PAGES if SOAK else 3
    monkeypatch.setattr("pipeline.report.pages.reading.PAGES", pages_shown)
    most, many = pages_shown * SHOWN, 100_000 if SOAK else 3_500

    def all_of_them() -> Iterator[Doubt]:
        for n in range(many, 0, -1):
            hostile = "<script>" + "x" * 400
            yield Doubt(DOUBTFUL, n, n + 1, f"=cmd{n}", "height_m", hostile, "@measure it", hostile, hostile)

    record = builder.record()
    settings = {**record.settings, "reading": builder.reading() | {"doubtful": many, "rows": many}}
    index = render(replace(record, assessments=(), settings=settings), tmp_path / "r", doubts=all_of_them)
    pages = [index.with_name(page_file(number)) for number in range(1, pages_shown + 1)]
    assert not index.with_name(page_file(pages_shown + 1)).exists()
    for number, page in enumerate(pages):
        assert page.stat().st_size < 2_000_000
        tree = html.parse(str(page)).getroot()
        rows = tree.findall(".//table[@class='doubts']/tbody/tr")
        assert (len(rows), rows[0].findtext("th/bdi")) == (SHOWN, f"=cmd{number * SHOWN + 1}")
        assert "<script>x" not in page.read_text(encoding="utf-8")
        (turn, again) = tree.findall(".//nav[@class='turn']")
        assert [a.get("href") for a in turn.findall("a")] == [p.name for p in pages if p != page]
        assert turn.findtext("strong") == again.findtext("strong") == str(number + 1)
        # What to mend is told once, on the first.
        assert (tree.find(".//table[@class='kinds']") is not None) is (number == 0)
    assert f"The first {most:,} of {many:,} are shown" in words(pages[0])
    assert f"{many:,}height" in words(pages[0])
    with index.with_name("reading.csv").open(encoding="utf-8", newline="") as stream:
        cells = next(row for n, row in enumerate(csv.reader(stream)) if n == many)
    assert cells[2] == "'=cmd1"
    assert cells[6] == "'@measure it"


def test_what_stands_there_and_what_was_made_of_it(tmp_path: Path) -> None:
    """Refused, left out, doubted and used, taken by choice: each entry says which, with the museum's characters."""
    settings = workspace(tmp_path, [])
    head = "object_number,gallery,title,height_m,width_m,depth_m,size,shown"
    rows = [
        "1,Hall,Vase,0.3,0.1,0.1,H 40 x W 10 x D 10 cm,yes",  # a text that contradicts its column
        "2,Depot 1,Jug,0.2,-0.2,0.2,,ja",  # a flag against a location, and a negative width
        "3,Réserve,Jug,0.2,0.2,0.2,,",  # a location that says it alone
        "4,Hall,Jug,0.2,0.2,0.2,approx. two feet,oui",  # a text that is not read
        ",Hall,Jug,0.2,0.2,0.2,,nein",
    ]
    (tmp_path / "export.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    mapping = tmp_path / "mapping.toml"
    more = '[columns.on_display]\ncolumn = "shown"\n[dimensions]\ncolumns = ["size"]\n'
    mapping.write_text(mapping.read_text(encoding="utf-8") + more, encoding="utf-8")
    summary, index = night(settings)
    assert "1 settled by choice" in "\n".join(summary_lines(summary))
    assert "Settled by choice: 1 object is taken not to be on display" in words(index)
    assert "5 rows, 1 refused, 3 doubtful, 1 settled by choice: look" in words(index)
    found = {(r["what"], r["object_number"], r["field"]): (r["characters"], r["used"]) for r in table(index)}
    assert found == {
        ("choice", "", "on_display"): ("", ""),
        ("refused", "", "object_number"): ("", ""),
        ("doubtful", "1", "height_m"): ("0.3 m | H 40 x W 10 x D 10 cm", "0.3 m"),
        ("doubtful", "2", "width_m"): ("", ""),
        ("doubtful", "2", "on_display"): ("", "on display"),
        ("doubtful", "4", "dimensions"): ("approx. two feet", "height 0.2 m, width 0.2 m, depth 0.2 m"),
    }
    page = index.with_name("reading.html")
    made = [
        row.findtext("td[3]/bdi")
        for row in html.parse(str(page)).getroot().findall(".//table[@class='doubts']/tbody/tr")
    ]
    assert made[:2] == ["taken so", "no object was made of it"]
    # The page says it in the museum's units, the file in SI.
    shown = sorted(one.replace("\u202f", " ") for one in made[2:])
    assert shown == sorted(["30 cm", "not used", "on display", "height 20 cm, width 20 cm, depth 20 cm"])
    told = json.loads(index.with_name("summary.json").read_text(encoding="utf-8"))["reading"]
    assert [one["field"] for one in told["choices"]] == ["on_display"]
    (looked,) = [one for one in diagnose(tmp_path / "kouros.toml") if one.what == "inventory"]
    assert "settled by choice: 1 object taken not to be on display" in looked.message


def test_a_source_that_contradicts_itself_stops_the_night_and_leaves_all_as_it_was(tmp_path: Path) -> None:
    settings = workspace(tmp_path, [f"{n},A,Vase,1.2,0.2,0.2" for n in range(1, 31)])
    mapping = tmp_path / "mapping.toml"
    text = mapping.read_text(encoding="utf-8")
    mapping.write_text(text + '[dimensions]\ncolumns = ["size"]\noptional = true\n', encoding="utf-8")
    _, index = night(settings)
    before = (tmp_path / "kouros.sqlite").read_bytes()
    head = "object_number,gallery,title,height_m,width_m,depth_m,size"
    rows = [f'{n},A,Vase,1.2,0.2,0.2,"H {n + 50} x W 20 x D 20 cm"' for n in range(1, 31)]
    (tmp_path / "export.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    for dry_run in (True, False):
        with pytest.raises(ContradictionError, match="say other things of height in 30 of 30 rows"):
            run(settings, SILENT, dry_run=dry_run)
        place = open_workspace(settings)
        with pytest.raises(ContradictionError, match=r"row 1, 1: its column says 1\.2 m, the text 0\.51 m"):
            import_collection(place, tmp_path / "export.csv", "mapping.toml", shrink_limit=0.9, dry_run=dry_run)
    assert (tmp_path / "kouros.sqlite").read_bytes() == before
    assert len(list(index.parent.parent.glob("2*T*"))) == 1, "no report was made"
    with mapping.open("a", encoding="utf-8") as file:
        file.write('[holds]\ntexts = "texts"\n')
    summary, index = night(settings)
    assert "say other things of height in 30 of 30 rows" in words(index)
    assert 'settled by the mapping, [holds] texts = "texts"' in words(index)
    assert summary.reading is not None
    assert summary.reading["doubtful"] == 30


def test_what_a_version_keeps_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More objects are doubtful than row and line are kept of: each is still named, the later ones by number alone."""
    monkeypatch.setattr(reading_report, "PLACES", 50)
    problem = (Problem("mass_kg", "no", "weigh it"),)
    reading = carnegie()
    items = tuple(replace(item, problems=problem) for item in reading.items)
    engine = open_database(tmp_path / "k.sqlite")
    upgrade(engine)
    replace_inventory(engine, replace(reading, items=items))
    found = list(doubts(engine, 1))
    assert len(found) == len(items)
    assert {one.row for one in found} == {None, *range(1, 51)}
