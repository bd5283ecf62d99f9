"""The documentation against the code: what it tells to do is done, and what it names is there."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import click
import pytest
import yaml

import pipeline
from docs import generate
from docs.rooms import with_rooms
from pipeline.cli import kouros
from tests.docs.pages import DOCS, PAGES, PROMISED, ROOT, blocks, codes, links
from tests.docs.runner import NOT_RUN, Reader, short_site, use_site
from tests.soak import SOAK, some

FIRST = DOCS / "tutorials" / "first-night.md"
"""Its reader's folder is where the others begin."""

ANEW = {DOCS / "tutorials" / "first-record.md", ROOT / "README.md", ROOT / "CONTRIBUTING.md"}
"""Pages that begin in an empty folder."""

LONG = pytest.mark.long("test_what_a_page_tells_to_do_can_be_done")
SLOW = {"earthquake", "notebook-motions", "own-rules", "plan", "select-motions"}
"""Pages whose blocks take seconds; the others are done in the same way."""


@cache
def generated() -> dict[str, str]:
    """The pages that are made of the code, by name: the same for all tests."""
    return generate.pages()


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The bundled site's strong part, which takes its place."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("documented")
        made = short_site(folder)
        use_site(patch, made)
        patch.syspath_prepend(ROOT / "pipeline" / "_alias")  # as an editable install has it on the path
        patch.setenv("KOUROS_CACHE", str(folder / "cache"))
        patch.setenv("KOUROS_WHO", "A. Reader")
        # Spectra of few periods: no page tells a number of them.
        patch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 12)
        here = Path.cwd()
        yield made
        os.chdir(here)


@pytest.fixture(scope="module")
def museum(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the first tutorial leaves."""
    reader = Reader(tmp_path_factory.mktemp("first-night"))
    for block in blocks(FIRST):
        reader.do(block)
    return reader.folder


def test_the_first_night_is_as_told(museum: Path) -> None:
    """All its blocks ran, with the output that it shows; the night left a report."""
    assert (museum / "reports" / "latest" / "index.html").is_file()
    assert (museum / "survey.xlsx").is_file()


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=LONG) if page.stem in SLOW else page
        for page in some((p for p in PAGES if p != FIRST and blocks(p)), 12)
    ],
    ids=lambda p: p.stem,
)
def test_what_a_page_tells_to_do_can_be_done(page: Path, museum: Path, tmp_path: Path) -> None:
    folder = tmp_path / "museum"
    if page in ANEW:
        folder.mkdir()
    else:
        shutil.copytree(museum, folder, symlinks=True)
    reader = Reader(folder)
    for block in blocks(page):
        reader.do(block)


def test_every_reason_not_to_run_something_is_used() -> None:
    notes = {block.note for page in PAGES for block in blocks(page)}
    assert {f"not run: {reason}" for reason in NOT_RUN} == {note for note in notes if note.startswith("not run")}


def commands() -> Iterator[tuple[str, list[str]]]:
    """Every line that begins with kouros, in blocks and in prose: place and words."""
    for page in PAGES:
        for block in blocks(page):
            if block.language == "sh":
                yield from ((block.place, line.split()) for line in block.lines if line.startswith("kouros "))
        yield from ((page.name, code.split()) for code in codes(page) if code.startswith("kouros "))


def options_of(command: click.Command) -> set[str]:
    return {name for p in command.params if isinstance(p, click.Option) and not p.hidden for name in p.opts}


def test_every_verb_and_option_that_is_named_exists() -> None:
    everything = options_of(kouros) | {"--help", "--version"}
    for _, command in generate.verbs():
        everything |= options_of(command)
    seen = 0
    for place, words in commands():
        command: click.Command = kouros
        known = options_of(kouros) | {"--help"}
        for word in words[1:]:
            if isinstance(command, click.Group) and not word.startswith("-"):
                assert word in command.commands, f"{place}: there is no verb {word!r}: {' '.join(words)}"
                command = command.commands[word]
                known |= options_of(command)
                seen += 1
        named = {word.partition("=")[0] for word in words if re.fullmatch(r"--[a-z-]+(=.*)?", word)}
        assert named - PROMISED <= known, f"{place}: there is no {named - known}: {' '.join(words)}"
    assert seen > 50
    for page in PAGES:
        for code in codes(page):
            if re.fullmatch(r"--[a-z][a-z-]*", code):
                assert code in everything | PROMISED, f"{page.name}: there is no option {code}"
    assert not PROMISED & everything, "kept promises are no longer named as such"


def found(dotted: str) -> bool:
    """Whether a dotted name is that of a module, or of something in one."""
    module, _, name = dotted.rpartition(".")
    try:
        return hasattr(importlib.import_module(module), name) or bool(importlib.import_module(dotted))
    except ModuleNotFoundError:
        return False


def test_every_dotted_name_leads_somewhere() -> None:
    dotted = {code for page in PAGES for code in codes(page) if re.fullmatch(r"pipeline(\.\w+)+", code)}
    dotted |= set(generate.CONTRACTS.values())
    assert len(dotted) > 10
    for code in sorted(dotted):
        assert found(code) != (code in PROMISED), code


def test_the_rooms_are_those_of_the_code() -> None:
    """`make docs` writes them."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert with_rooms(text) == text
    assert "| `kernels` |" in text


def test_every_verb_and_option_is_in_the_reference() -> None:
    text = generated()["cli"]
    for words, command in generate.verbs():
        section = text.partition(f"## kouros {words}\n")[2].partition("\n## ")[0]
        assert section, words
        assert options_of(command) <= set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", section)), words


def test_every_key_of_a_file_that_is_named_exists() -> None:
    """A key is named with its table, as `[report] survey`."""
    tables = settings_keys()
    seen = 0
    for page in PAGES:
        for code in codes(page):
            named = re.match(r"\[+(\w+(?:\.\w+)*)\]+(?: (\w+))?", code)
            if named:
                assert named[1] in tables, f"{page.name}: there is no table {code}"
                assert not named[2] or named[2] in tables[named[1]], f"{page.name}: there is no key {code}"
                seen += 1
    assert seen > 5


def settings_keys() -> dict[str, set[str]]:
    """The tables of kouros.toml, a mapping, a manifest and an experiment, as the reference has them, with keys."""
    found: dict[str, set[str]] = {}
    for name in ("settings", "mapping", "manifest", "experiment"):
        for section in generated()[name].split("\n## ")[1:]:
            for part in section.split("\n### "):
                head = re.search(r"\[+([\w.]+)\]+", part.partition("\n")[0])
                if head:
                    found.setdefault(head[1].replace(".FIELD", ""), set()).update(
                        re.findall(r"^\| `(\w+)`", part, re.M)
                    )
    return found


def test_every_name_in_code_is_known_to_the_code() -> None:
    """Names with an underscore: columns, fields, parameters, models, keys."""
    known = set(re.findall(r"\w+", "\n".join(generated().values())))
    for source in [*(ROOT / "pipeline").rglob("*.py"), *(ROOT / "schemas").glob("*.json")]:
        known |= set(re.findall(r"\w+", source.read_text(encoding="utf-8")))
    for page in PAGES:
        for code in codes(page):
            for name in re.findall(r"\b[a-z]+(?:_[a-z0-9]+)+\b", code):
                path = re.search(rf"[/.]{name}|{name}[/.-]|PW", code)
                assert name in known or path, f"{page.name}: {name!r} of {code!r} is nowhere"


def test_every_file_that_is_named_exists() -> None:
    folders = ("docs", "examples", "pipeline", "schemas", "site_motions/demo", "templates", "tests")
    seen = 0
    for page in PAGES:
        for code in codes(page):
            if code.startswith(tuple(f"{folder}/" for folder in folders)) and not set(code) & set("*<>"):
                assert (ROOT / code).exists(), f"{page.name}: there is no {code}"
                seen += 1
    assert seen > 10


def test_every_link_of_the_pages_that_are_not_built_leads_somewhere() -> None:
    """README and CONTRIBUTING are read on a site of repositories; the build looks after the others."""
    for page in (ROOT / "README.md", ROOT / "CONTRIBUTING.md"):
        assert links(page), page.name
        for link in links(page):
            if "://" not in link:
                assert (ROOT / link.partition("#")[0]).exists(), f"{page.name}: {link} leads nowhere"


def test_the_pages_are_built_without_a_warning(tmp_path: Path) -> None:
    """No broken link, no page outside of the table of contents, no docstring that cannot be read; and no network.

    Every day they are read and joined, and not written as HTML; nor are quotes turned, an eighth of the time.
    """
    words = [
        "-W",
        "--keep-going",
        "-q",
        "-b",
        "html" if SOAK else "dummy",
        *(() if SOAK else ("-D", "smartquotes=0")),
        "-d",
        str(tmp_path / "doctrees"),
        str(DOCS),
        str(tmp_path / "html"),
    ]
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *words], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    assert "Housner 1963" in generated()["models"]
    if not SOAK:
        return
    page = (tmp_path / "html" / "reference" / "generated" / "models.html").read_text(encoding="utf-8")
    assert "Housner 1963" in page
    for file in (tmp_path / "html").rglob("*.html"):
        fetched = re.findall(
            r'<(?:script|img|link)[^>]*(?:src|href)="(https?:[^"]+)"', file.read_text(encoding="utf-8")
        )
        assert not fetched, f"{file.name} fetches {fetched}"


def test_one_version_is_told_everywhere() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert str(citation["version"]) == pipeline.__version__
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"^## (\d\S*) \((\d{4}-\d{2}-\d{2})\)$", changes, re.M)
    assert released[0] == (pipeline.__version__, str(citation["date-released"]))


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 130
