"""The pages as files: well-formed, harmless whatever the text, linked, light, the same every time."""

import re
from base64 import b64encode
from collections import Counter
from dataclasses import replace
from hashlib import sha256
from itertools import pairwise
from pathlib import Path
from urllib.parse import urldefrag

import pytest
from lxml import etree

from pipeline.records import Item
from pipeline.report import ReportError, Units, render

from . import builder
from .shown import shown

HTML = "{http://www.w3.org/1999/xhtml}"


def _pages(folder: Path) -> dict[str, etree._ElementTree]:
    # The pages are written as XML too, so that a strict parser, which repairs nothing, is the judge.
    return {p.name: etree.parse(str(p)) for p in sorted(folder.glob("*.html"))}


def test_pages_are_well_formed_with_unique_ids_and_one_main_heading(report: Path) -> None:
    for name, page in _pages(report).items():
        ids = Counter(e.get("id") for e in page.iter() if e.get("id"))
        assert [i for i, n in ids.items() if n > 1] == [], name
        assert len(list(page.iter("h1"))) == len(list(page.iter("main"))) == 1
        assert page.getroot().get("lang") == "en"


def test_headings_never_skip_a_level(report: Path) -> None:
    for name, page in _pages(report).items():
        levels = [int(str(e.tag)[1]) for e in page.iter("h1", "h2", "h3", "h4")]
        assert all(b - a <= 1 for a, b in pairwise(levels)), name


def test_every_link_and_use_resolves(report: Path) -> None:
    pages = _pages(report)
    ids = {name: {e.get("id") for e in page.iter()} for name, page in pages.items()}
    for name, page in pages.items():
        for element in page.iter("a", "use"):
            file, anchor = urldefrag(element.get("href") or "")
            target = file or name
            assert (report / target).is_file(), target
            assert not anchor or anchor in ids[target], f"{name}: {file}#{anchor}"
        for element in page.iter("svg"):
            assert set((element.get("aria-labelledby") or "").split()) <= ids[name]


def test_nothing_is_fetched_and_nothing_runs(report: Path) -> None:
    for name, page in _pages(report).items():
        assert not list(page.iter("img", "link", "iframe", "object", "form"))
        assert not [a for e in page.iter() for a in e.attrib if str(a).startswith("on") or a == "src"]
        policy = next(e.get("content") for e in page.iter("meta") if e.get("http-equiv"))
        scripts = [e.text or "" for e in page.iter("script")]
        assert len(scripts) == (name not in ("index.html", "news.html", "method.html", "motion.html", "reading.html"))
        # The one script may run because the policy names the hash of its text, and nothing else may.
        named = [b64encode(sha256(text.encode()).digest()).decode() for text in scripts]
        allowed = "".join(f" script-src 'sha256-{one}';" for one in named)
        closed = "base-uri 'none'; form-action 'none'"  # neither falls back to default-src
        assert policy == f"default-src 'none';{allowed} style-src 'unsafe-inline'; img-src data:; {closed}"


@pytest.mark.parametrize("number", builder.HOSTILE)
def test_hostile_titles_come_out_as_text(report: Path, number: str) -> None:
    page = _pages(report)[
        next(g.page.file for g in shown(builder.record(), Units()).galleries if g.name == builder.PAINT)
    ]
    said = ["".join(e.itertext()) for e in page.iter("bdi")]
    title = builder.HOSTILE[number].replace("\x07", "\ufffd").replace("\ud800", "\ufffd")
    start = title[:40]
    assert any(text.startswith(start) for text in said)


def test_all_objects_are_on_exactly_one_page(report: Path) -> None:
    shown = Counter(
        e.text
        for name, page in _pages(report).items()
        if name != "index.html"
        for e in page.iterfind(".//table[@class='list rows']/tbody/tr/th//bdi")
    )
    for assessment in builder.record().assessments:
        assert shown[assessment.scene.item.object_number] == 1


def _whole(text: str | None) -> int:
    return int((text or "").replace(",", ""))


def test_the_index_totals_are_the_sums_of_its_rows(report: Path) -> None:
    table = list(_pages(report)["index.html"].iter("table"))[-1]
    rows = [[_whole(td.text) for td in tr.findall("td")[:5]] for tr in table.iterfind("tbody/tr")]
    total = [_whole(td.text) for td in table.findall("tfoot/tr/td")[:5]]
    assert [sum(column) for column in zip(*rows, strict=True)] == total
    assert sum(total[:4]) == total[4] == sum(a.scene.item.on_display for a in builder.record().assessments)


def test_charts_are_defined_once_and_figures_have_words(report: Path) -> None:
    for page in _pages(report).values():
        for figure in (e for e in page.iter("svg") if e.get("role") == "img"):
            assert figure.findtext("title")
            assert len(figure.findtext("desc") or "") > 40
        symbols = [e.get("id") for e in page.iter("symbol")]
        assert {(e.get("href") or "")[1:] for e in page.iter("use")} == set(symbols)


def test_tables_name_their_columns(report: Path) -> None:
    for page in _pages(report).values():
        for table in page.iter("table"):
            assert table.find("caption") is not None
            assert all(th.get("scope") in ("col", "row") for th in table.iter("th"))


def test_the_screen_is_labelled_as_never_deciding_and_silence_about_approval_is_told(report: Path) -> None:
    page = " ".join("".join(_pages(report)["not-on-display.html"].getroot().itertext()).split())
    assert "Screening, never deciding: A_max/g = 0.70" in page
    assert "nobody answers for this motion" in page
    approved = replace(builder.motion(), approved_by="A. Engineer", approved_on="2026-01-02")
    (view,) = shown(replace(builder.record(), motions=(approved,)), Units()).motions
    assert view.approved == "A. Engineer, 2026-01-02"


def test_the_demonstration_says_so_and_others_do_not(report: Path, tmp_path: Path) -> None:
    assert "Demonstration:" in (report / "index.html").read_text(encoding="utf-8")
    index = render(replace(builder.record(), demonstration=False), tmp_path / "r")
    assert "Demonstration:" not in index.read_text(encoding="utf-8")


def test_three_hundred_objects_stay_below_one_and_a_half_megabytes(tmp_path: Path) -> None:
    index = render(builder.crowd(300), tmp_path / "r")
    heaviest = max(p.stat().st_size for p in index.parent.glob("*.html"))
    assert heaviest < 1_500_000


def test_the_same_record_gives_the_same_bytes(report: Path, tmp_path: Path) -> None:
    again = render(builder.record(), tmp_path / "r", doubts=builder.doubts).parent
    assert _files(again) == _files(report)


def _files(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_report_never_overwrites_and_a_failed_one_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    with pytest.raises(ReportError, match="taken"):
        render(builder.record(), tmp_path / "taken")
    whole = builder.rocking(Item("1", "g"))
    bad = replace(whole, findings=(replace(whole.findings[0], sentence="{speed}"),))
    with pytest.raises(ReportError):
        render(builder.record(bad), tmp_path / "r")
    assert [p.name for p in tmp_path.iterdir()] == ["taken"]


def test_an_empty_run_is_a_report_too(tmp_path: Path) -> None:
    empty = replace(builder.record(), assessments=(), motions=(), charts={}, level_notes=())
    page = etree.parse(str(render(empty, tmp_path / "r")))
    assert [td.text for td in page.findall(".//tfoot/tr/td")[:5]] == ["0"] * 5


def test_inches_reach_the_pages(tmp_path: Path) -> None:
    folder = render(builder.record(), tmp_path / "r", units=Units("in")).parent
    text = "".join(p.read_text(encoding="utf-8") for p in folder.glob("*.html"))
    assert "Keep 5\u00a0⅝\u00a0in clear" in text  # 0.14 m are 5.51 in, the next eighth above
    for unit in ("cm", "cm/s", "N", "N m", "MPa", "Pa", "kg"):
        assert not re.search(rf"\d[\u202f\u00a0 ]{unit}[\s,.;:)<]", text), unit
