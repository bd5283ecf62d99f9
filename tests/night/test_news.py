"""News of objects after real nights, against the two reports' own lists of objects, read apart."""

from __future__ import annotations

import csv
import json
import re
from collections import Counter
from datetime import date
from pathlib import Path

import pytest
from lxml import etree

from pipeline.night.run import run
from pipeline.operations.workspace import open_workspace
from pipeline.records import DecisionKind, NewsKind, RunChanges
from pipeline.report.pages.news import sentences
from pipeline.settings import load_settings, template
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.house_answers import take_back
from pipeline.tools.rerender import render_again
from tests.museum import DATABASE, SILENT, edit, in_common, kouros, on_the_floor, short_site, small, with_tables

NAMES = ("object_number", "title", "gallery", "height_m", "width_m", "depth_m", "medium", "on_display")
KIND = NewsKind
HOSTILE = "<img src=x onerror=alert(1)> {{7*7}} \u202evase"


def row(
    number: str, title: str, gallery: str, *sizes: float, medium: str = "bronze", shown: str = "yes"
) -> dict[str, str]:
    return dict(zip(NAMES, (number, title, gallery, *(str(s) for s in sizes), medium, shown), strict=True))


SLENDER, LOW = (0.9, 0.1, 0.1), (0.1, 0.3, 0.3)
"""What 0.2 g of the motion tips (b/h = 1/9), and what it cannot."""

FIRST = [
    row("1922.9", "Amphora", "Gallery 19", *SLENDER),
    row("1913.3", "Dish", "Gallery 19", *LOW),
    row("5.1", "Vase", "Gallery 2", *LOW),
    row("5.2", "Vase", "Gallery 2", *SLENDER),
    row("7.7", "Vase", "Gallery 3", *LOW),
    row("7.8", "Vase", "Gallery 3", *SLENDER),
    row("9.1", "Jar", "Gallery 3", *LOW),
    row("9.2", "Jar", "Store", *SLENDER, shown="no"),
    row("9.3", "Jar", "Gallery 4", *SLENDER),
    row("9.4", "Jar", "Gallery 4", *SLENDER),
]
SECOND = [
    row("1922.9", "Amphora", "Gallery 19", *SLENDER),
    {**row("1913.3", "Dish", "Gallery 19", *LOW), "height_m": "", "width_m": "", "depth_m": ""},
    row("5.1", "Vase", "Gallery 2", *SLENDER),
    row("7.7", "Vase", "Gallery 1", *LOW),
    row("7.8", "Vase", "Gallery 3", *SLENDER),
    row("9.1", "Jar", "Gallery 3", *LOW, shown="no"),
    row("9.2", "Jar", "Gallery 3", *SLENDER),
    row("9.3", "Jar", "Gallery 4", *LOW),
    row("9.4", "Jar", "Gallery 4", *SLENDER),
    row("2026.1", HOSTILE, "Gallery 2", *SLENDER),
    row("2026.2", "Bowl", "Gallery 2", *LOW),
]


def write(folder: Path, rows: list[dict[str, str]]) -> None:
    with (folder / "collection.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, NAMES)
        writer.writeheader()
        writer.writerows(rows)


@pytest.fixture
def museum(tmp_path: Path) -> Path:
    with_tables(tmp_path / DATABASE)
    in_common(tmp_path)
    text = template(museum="Test", source="collection.csv", mapping="kouros", site="site")
    (tmp_path / "kouros.toml").write_text(small(text), encoding="utf-8")
    edit(short_site(tmp_path), "scale = 1.0", "scale = 0.28")
    on_the_floor(tmp_path)
    edit(tmp_path / "kouros.toml", "shrink_limit = 0.2", "shrink_limit = 0.9")
    write(tmp_path, FIRST)
    return tmp_path


def night(folder: Path) -> RunChanges | None:
    return run(load_settings(folder / "kouros.toml"), SILENT).changes


def listed(folder: Path) -> dict[str, tuple[str, str]]:
    """State and word for how likely harm is, of each object on display, as the newest report lists it for programs."""
    with (folder / "reports" / "latest" / "objects.csv").open(encoding="utf-8", newline="") as stream:
        rows = [one for one in csv.DictReader(stream) if one["on_display"] == "true"]
    return {one["object_number"]: (one["state"], one["band"]) for one in rows}


BANDS = ("very unlikely", "unlikely", "possible", "likely", "almost certain")


def turned(was: tuple[str, str], now: tuple[str, str]) -> str:
    """Worse, better or neither, by the lists alone; words for probabilities count of what is acted on."""
    order = ("fine", "watch", "act")
    one, other = ((order.index(state), BANDS.index(band) if state == "act" else 0) for state, band in (was, now))
    return "worse" if other > one else "better" if other < one else ""


def texts(page: Path) -> list[str]:
    """Each line of news of a page, as a reader sees it."""
    lines = etree.parse(str(page), etree.HTMLParser(encoding="utf-8")).iterfind(".//ul[@class='news']/li")
    return [" ".join("".join(line.itertext()).split()) for line in lines]


def test_each_kind_of_news_is_told_of_its_object(museum: Path) -> None:
    night(museum)
    assert texts(museum / "reports" / "latest" / "news.html") == []
    before = listed(museum)
    opened = open_workspace(load_settings(museum / "kouros.toml"))
    decide(opened, Wish("1922.9", DecisionKind.INSTALLED, ["clamps"], "clamped on Monday", "Ann"))
    decide(opened, Wish("7.8", DecisionKind.ACCEPT, [], "the case is rebuilt", "Ann"))
    write(museum, SECOND)
    changes = night(museum)
    after = listed(museum)
    assert changes is not None
    assert changes.shared == {}
    told = {one.object_number: one for one in changes.objects}
    assert {number: one.kind for number, one in told.items()} == {
        "2026.1": KIND.DANGER, "9.2": KIND.DANGER, "5.1": KIND.WORSE, "1913.3": KIND.LOST, "1922.9": KIND.FIXED,
        "9.3": KIND.FIXED, "2026.2": KIND.NEW, "5.2": KIND.GONE, "9.1": KIND.GONE, "7.7": KIND.MOVED,
        "7.8": KIND.DECIDED,
    }  # fmt: skip
    # What either run says is what its own list of objects says.
    for number, one in told.items():
        for brief, lists in ((one.before, before), (one.after, after)):
            assert (None if brief is None else (brief.state, brief.band)) == lists.get(number), number
    said = sentences(changes, 100)
    assert any(one.startswith("Fixed: 1922.9 Amphora (clamped); said by Ann, 20") for one in said)
    assert (
        "Worse: 5.1 Vase: was fine, is in danger (its record changed: height, width, depth): check its sizes first."
        in said
    )
    assert "Gone from display: 5.2 Vase (no longer in the records)." in said
    assert "Decided: 7.8 Vase: risk accepted, by Ann." in said
    assert [line for line in said if line.startswith("New and in danger: 2026.1 <img")]

    # The pages: all news on its own, each object with a link that leads somewhere; the first lines open on the index.
    report = museum / "reports" / "latest"
    lines = texts(report / "news.html")
    assert [line.partition(":")[0] for line in lines] == [line.partition(":")[0] for line in said]
    assert texts(report / "index.html") == lines[:8]
    page = (report / "news.html").read_text(encoding="utf-8")
    assert "<img" not in page
    for target, anchor in re.findall(r'<li class="\w+">.*?href="([^"#]+)#(\w+)"', page):
        assert f'id="{anchor}"' in (report / target).read_text(encoding="utf-8")
    assert page.count("#o") == len(lines) - 1  # one is gone from the records

    # The landing page and the status say the same, the command too; drawn again it is the same page.
    assert texts(museum / "reports" / "index.html") == lines[:8]
    good = json.loads((museum / "reports" / "status.json").read_text(encoding="utf-8"))["last_good"]
    assert good["news"]["counts"] == {"danger": 2, "worse": 1, "lost": 1, "fixed": 2, "new": 1, "gone": 2, "moved": 1,
                                      "decided": 1}  # fmt: skip
    assert sum(good["counts"].values()) == len(after)
    printed = kouros("diff", folder=museum).stdout
    assert printed.index("Fixed: 1922.9 Amphora (clamped); said by Ann, ") < printed.index("  worse:")
    assert texts(render_again(load_settings(museum / "kouros.toml"), None).with_name("news.html")) == lines

    # What one motion does to all is one piece of news, with how many: as the two lists of objects have it.
    before = listed(museum)
    edit(museum / "site" / "manifest.toml", "scale = 0.28", "scale = 1.0")
    changes, after = night(museum), listed(museum)
    assert changes is not None
    assert changes.objects == ()
    expected = Counter(turned(before[n], after[n]) for n in after if "unknown" not in (before[n][0], after[n][0]))
    assert changes.shared == {kind: number for kind, number in expected.items() if kind}
    assert changes.shared["worse"] >= 3
    index = (museum / "reports" / "latest" / "index.html").read_text(encoding="utf-8")
    assert f'because of the earthquake used: Worse: <strong class="num">{changes.shared["worse"]}</strong>' in index
    assert texts(museum / "reports" / "latest" / "news.html") == []

    # Nothing changed: it says so, and no gallery was found anew.
    today = load_run_day(index)
    assert not night(museum)
    index = (museum / "reports" / "latest" / "index.html").read_text(encoding="utf-8")
    assert "Nothing has changed since" in index
    galleries = len(re.findall(r'<span class="since">checked [\d-]+, unchanged since ([\d-]+)</span>', index))
    assert galleries == len({one["gallery"] for one in SECOND if one["on_display"] == "yes"})
    assert f"unchanged since {today}" in index


def load_run_day(index: str) -> str:
    """The day on which the run of an index began, as its foot says."""
    found = re.search(r"from (\d{4}-\d\d-\d\d) ", index)
    assert found
    return found[1]


@pytest.mark.long("test_each_kind_of_news_is_told_of_its_object")
def test_a_house_rule_that_moved_an_object_is_named(museum: Path) -> None:
    """Gallery 2 is said to be fastened: what moves there says by which rule, what moves elsewhere would not."""
    rows = [row(f"5.{at}", "Vase", "Gallery 2", *SLENDER) for at in range(3)]
    write(museum, [*rows, row("7.8", "Vase", "Gallery 3", *SLENDER)])
    night(museum)
    before = listed(museum)
    settings = museum / "kouros.toml"
    rule = '\n[[house]]\ngallery = "Gallery 2"\nheld = "fastened"\nsaid_by = "A. <b>"\nsaid_on = 2031-05-12\n'
    settings.write_text(settings.read_text(encoding="utf-8") + rule, encoding="utf-8")
    changes, after = night(museum), listed(museum)
    assert changes is not None
    moved = {number for number in after if before[number] != after[number]}
    assert moved
    assert moved <= {"5.0", "5.1", "5.2"}
    assert {one.object_number for one in changes.objects} == moved
    assert changes.shared == {}
    said = sentences(changes, 100)
    assert all("house rule for Gallery 2: how they are held: fastened, by A. <b>, 2031-05-12" in one for one in said)
    page = (museum / "reports" / "latest" / "news.html").read_text(encoding="utf-8")
    assert "A. &lt;b&gt;, 2031-05-12" in page
    # Where it is the same of several it is one line, which has a link to each on the page of news.
    (line,) = texts(museum / "reports" / "latest" / "news.html")
    (together,) = texts(museum / "reports" / "index.html")
    assert line == together
    assert page.count("#o") == len(moved)
    assert all(f"{number} Vase" in together for number in moved)
    assert together.count("house rule for Gallery 2: how they are held") == 1

    # Taken back at the desk, it is named with who took it back and why.
    # The museum has another rule before it.
    take_back(settings, len(load_settings(settings).house) - 1, "B. <i>", date(2031, 6, 1), "the pads are gone")
    changes = night(museum)
    assert changes is not None
    assert {one.object_number for one in changes.objects} == moved
    said = sentences(changes, 100)
    assert all("no longer the house rule for Gallery 2" in one for one in said)
    assert all("taken back by B. <i>, 2031-06-01: the pads are gone" in one for one in said)
    ended = settings.read_text(encoding="utf-8")
    settings.write_text(ended.partition("taken_back_by")[0], encoding="utf-8")
    night(museum)

    # Taken out of the file, it is named as what holds no longer.
    settings.write_text(settings.read_text(encoding="utf-8").removesuffix(rule), encoding="utf-8")
    changes = night(museum)
    assert changes is not None
    assert {one.object_number for one in changes.objects} == moved
    assert all("no longer the house rule for Gallery 2" in one for one in sentences(changes, 100))
