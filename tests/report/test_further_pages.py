"""Pages that other packages bring, installed as a package manager leaves them, in a process of their own."""

import subprocess
import sys
from pathlib import Path

import pytest
from lxml import html

LOANS = """
from markupsafe import Markup
from pipeline.report.pages.further import FurtherPage, PageContent

def content(head, tally, entries):
    rows = [(entry.name, entry.counts.total) for entry in entries]
    return PageContent(
        "Loans & <couriers>",
        "<p id='told'>{{ said }} {{ markup }}</p>{% for name, n in rows %}<b>{{ name }}: {{ n }}</b>{% endfor %}",
        {"said": f"<script>{head.museum}</script>", "markup": Markup(f"<em>{tally.findings}</em>"), "rows": rows},
    )

PAGE = FurtherPage("loans", content)
"""

DRAW = """
import sys, warnings
from pathlib import Path
sys.path.insert(0, sys.argv[1])
warnings.simplefilter("always")
from pipeline.report import render
from tests.report import builder
render(builder.record(), Path(sys.argv[2]), doubts=builder.doubts)
"""


def drawn(site: Path, packages: dict[str, tuple[str, str]]) -> tuple[Path, str]:
    """Render the builder's run where packages are installed, module -> (source, entry point); return what was said."""
    site.mkdir()
    for name, (source, point) in packages.items():
        (site / f"{name}.py").write_text(source, encoding="utf-8")
        told = site / f"{name}-1.0.dist-info"
        told.mkdir()
        (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
        (told / "entry_points.txt").write_text(f"[kouros.pages]\n{point}\n", encoding="utf-8")
    folder = site.parent / "report"
    root = str(Path(__file__).parents[2])
    command = [sys.executable, "-c", DRAW, str(site), str(folder)]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True, timeout=300)
    return folder, done.stderr


def test_a_page_of_another_package_is_in_the_report_and_in_its_navigation(tmp_path: Path) -> None:
    folder, said = drawn(tmp_path / "site", {"loans": (LOANS, "loans = loans:PAGE")})
    assert said == ""
    page = html.parse(str(folder / "page_loans.html"))
    assert page.xpath("string(//h1)") == "Loans & <couriers>"
    # What the context says is text; what was marked as HTML is HTML.
    assert page.xpath("string(//p[@id='told'])").startswith("<script>")
    findings = (folder / "findings.jsonl").read_text(encoding="utf-8").count("\n")
    assert 0 < int(page.xpath("string(//p[@id='told']/em)")) <= findings
    assert not page.xpath("//script")
    names = {p.name for p in folder.glob("*.html")}
    shared = {"index.html", "news.html", "method.html", "motion.html", "reading.html", "objects.html"}
    assert len(page.xpath("//main/b")) == len(names - shared) - 1
    for name in ("index.html", "method.html", "motion.html", "page_loans.html"):
        (link,) = html.parse(str(folder / name)).xpath("//nav/a[@href='page_loans.html']")
        assert link.text == "Loans & <couriers>"
        assert (link.get("aria-current") == "page") is (name == "page_loans.html")


WRONG = {
    "def content(*given): return 1 / 0": "ZeroDivisionError: division by zero",
    "def content(*given): return PageContent('t', '{{ absent }}')": "UndefinedError: 'absent' is undefined",
    "def content(*given): return PageContent('t', '{% if %}')": "TemplateSyntaxError",
    "def content(*given): return None": "AttributeError: 'NoneType' object has no attribute",
    "raise RuntimeError('no licence')": "RuntimeError: no licence",
    "content = None; NAME = '../loans'": "its name '../loans' is not of a-z, 0-9 and hyphens",
    "content = None; FurtherPage = dict": "is no FurtherPage",
}


@pytest.mark.long("test_a_page_of_another_package_is_in_the_report_and_in_its_navigation")
def test_pages_that_fail_are_left_out_and_said(tmp_path: Path) -> None:
    packages = {"loans": (LOANS, "loans = loans:PAGE")}
    for at, source in enumerate(WRONG):
        head = f"from pipeline.report.pages.further import FurtherPage, PageContent\nNAME = 'bad-{at}'\n"
        made = "PAGE = FurtherPage(name=NAME, content=content)\n"
        packages[f"bad{at}"] = (f"{head}{source}\n{made}", f"bad{at} = bad{at}:PAGE")
    folder, said = drawn(tmp_path / "site", packages)
    index = html.parse(str(folder / "index.html"))
    shown = " ".join(index.xpath("string(//main)").split())
    for at, wrong in enumerate(WRONG.values()):
        assert wrong in said
        assert wrong in shown
        assert shown.count(f"'bad-{at}'") + shown.count(f"'bad{at}'") >= 1
    assert index.xpath("//nav/a[@href='page_loans.html']")
    assert [p.name for p in folder.glob("page_*")] == ["page_loans.html"]
