"""Every phrase is looked up: a catalogue that answers in brackets leaves no English outside them, but for the data."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from functools import cache
from gettext import GNUTranslations
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from babel.dates import get_month_names
from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_dir
from babel.messages.frontend import parse_mapping_cfg
from babel.messages.mofile import write_mo
from lxml import etree

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import advise
from pipeline.mitigate.saying import ANCHORED
from pipeline.models import MODELS
from pipeline.models.common import NOTES
from pipeline.records import (
    Assessment,
    Cause,
    CauseKind,
    Decision,
    DecisionChange,
    DecisionKind,
    DecisionStatus,
    Doubt,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    NewsKind,
    ObjectPlace,
    RunChanges,
    RunRecord,
    Verdict,
    VerdictChange,
)
from pipeline.report import Language, ReportError, language, render
from pipeline.report.language import said, speaking
from pipeline.tables import table
from tests.mitigate import scenes

from . import builder
from .news_samples import news_of_every_kind

LONG = pytest.mark.long("test_a_real_run_is_translated")
OPEN, CLOSE = "⟦", "⟧"
PLACEHOLDER = re.compile(r"%\(\w+\)s|\{\w+\}|<[^>]*>|&\w+;|%%")
LETTERS = str.maketrans(
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ", "абцдефгхийклмнопярстувщхузАБЦДЕФГХИЙКЛМНОПЯРСТУВЩХУЗ"
)
UNITS = {"cm", "g", "mm", "m", "in", "ft", "s", "Hz", "kg", "N", "MPa", "PGA", "PGV", "PGD", "SI", "UTC"}
MONTHS = set(get_month_names("abbreviated", locale="it").values())
"""Dates are Italian, by Babel and not by the catalogue."""
FILES = re.compile(r"\w+\.(csv|jsonl|parquet|xlsx|html|toml)|kouros check --numerics")
MARKED = ("bdi", "code", "eq")
"""Elements and classes that hold data: what the museum wrote, hashes, equations."""


NAMES = (
    *("rocking", "height"),
    *("force", "frequency", "stroke", "acceleration", "clearance", "length", "base width", "base depth", "half width"),
    *(
        "friction static",
        "height of the centre of gravity",
        "swing",
        "flexible stress",
        "significant duration",
        "arias intensity",
    ),
)
"""Names of fields, parameters and models in the builder's record: the pages look up the plain words of any name."""


@cache
def phrases(*further: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """All phrases that a translation needs, as babel finds them by the file that the museum's translator uses.

    further : names of folders in which it looks besides those of the report
    """
    root = Path(__file__).parents[2]
    with (root / "templates" / "babel.cfg").open(encoding="utf-8") as file:
        methods, options = parse_mapping_cfg(file)
    folders = {"templates", "pipeline", "report", "pages", "plots", "files", "tables", "models", "mitigate", "measures"}
    folders |= {"analysis", "fragility", *further}
    found = extract_from_dir(root, methods, options, directory_filter=lambda at: Path(at).name in folders)
    messages = (one[2] for one in found)
    return tuple((said, ()) if isinstance(said, str) else (said[0], tuple(said[1:])) for said in messages)


def pseudo(phrase: str) -> str:
    """Return the phrase in brackets and in letters of another script; its placeholders and tags stay."""
    kept = PLACEHOLDER.findall(phrase)
    parts = [part.translate(LETTERS) for part in PLACEHOLDER.split(phrase)]
    return OPEN + "".join(a + b for a, b in zip(parts, [*kept, ""], strict=True)) + CLOSE


def catalogue() -> Catalog:
    made = Catalog(locale="en", fuzzy=False)
    for phrase, plural in phrases():
        key: Any = (phrase, *plural) if plural else phrase
        made.add(key, tuple(map(pseudo, key)) if plural else pseudo(phrase))
    for name in NAMES:
        made.add(name, pseudo(name))
    return made


@pytest.fixture(scope="module")
def compiled() -> GNUTranslations:
    file = BytesIO()
    write_mo(file, catalogue())
    file.seek(0)
    return GNUTranslations(file)


def foreign(value: Any) -> Any:
    """Return the records with every text of theirs in letters of another script, so that data is known from phrases."""
    if isinstance(value, Enum) or value is None:
        return value
    if isinstance(value, str):
        parts = re.split(r"(\{\w+\})", value)  # placeholders stay, for the numbers to go there
        return "".join(part if part.startswith("{") else part.translate(LETTERS) for part in parts)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: _field(f.name, getattr(value, f.name)) for f in fields(value)})
    if isinstance(value, tuple):
        return tuple(foreign(part) for part in value)
    return value


KEPT = {"unit", "units", "model", "models", "motion_hash", "hash", "chart", "key", "decided_by", "fidelity"}
KEPT |= {
    "measure",
    "field",
    "measures",
    "series",
    "decisions",
    "scale",
    "tone",
    "started",
    "finished",
    "run_id",
    "missing",
}


def _field(name: str, value: Any) -> Any:
    if name == "settings":
        told = value["numerics"]
        cases = [case | {"what": foreign(case["what"]), "truth": foreign(case["truth"])} for case in told["cases"]]
        read = value["reading"]
        doubts = [d | {name: foreign(d[name]) for name in ("message", "remedy")} for d in read["suspicions"]]
        read = read | {"source": foreign(read["source"]), "suspicions": doubts}
        return {**value, "numerics": told | {"cases": cases, "machine": foreign(told["machine"])}, "reading": read}
    if name == "item":
        return replace(foreign(value), problems=())
    if name == "mark" and value is not None:
        return replace(value, label=foreign(value.label))
    if name in ("parameters", "skipped") and isinstance(value, Mapping):
        return {k: foreign(v) for k, v in value.items()}
    if name == "charts":
        return {k: foreign(v) for k, v in value.items()}
    return value if name in KEPT else foreign(value)


WORD = "Б"
DECIDED = tuple(
    DecisionStatus(Decision(at, "79.AA.143", kind, WORD, "2031-05-01", WORD, "2031-05-01T00:00:00+00:00", **more))  # type: ignore[arg-type]
    for at, (kind, more) in enumerate(
        [
            (DecisionKind.ACCEPT, {"model": "rocking", "level": WORD, "until": "2032-01-01"}),
            (DecisionKind.INSTALLED, {"measure": "clearance", "parameters": {"force": 0.1}, "units": {"force": "m"}}),
            (DecisionKind.CLASS, {"object_class": WORD}),
            (DecisionKind.VERDICT, {"model": "rocking", "verdict": Verdict.PASS}),
        ]
    )
)
TURN = VerdictChange("1", WORD, "rocking", WORD, Verdict.PASS, Verdict.FAIL, (Cause(CauseKind.MOTION, WORD),))
CHANGED = RunChanges(
    "1", "2", (ObjectPlace("1", WORD),), (ObjectPlace("2", WORD),), (Move("3", WORD, WORD),),
    (InputChange("4", WORD, (FieldChange("height_m", 0.4, None),)),),
    (TURN, replace(TURN, before=Verdict.FAIL, after=Verdict.PASS, causes=()), replace(TURN, after=None)),
    (MotionChange(WORD, WORD, WORD, ("x",), None),),
    (DecisionChange(DECIDED[2].decision, new=True), DecisionChange(DECIDED[2].decision, new=False)),
    (FieldChange(WORD, WORD, None),), (FieldChange(WORD, "1", "2"),), "2031-05-01T01:00:00",
    news_of_every_kind(WORD), {kind.value: 2 for kind in NewsKind},
)  # fmt: skip


@pytest.fixture(scope="module")
def pages(compiled: GNUTranslations, tmp_path_factory: pytest.TempPathFactory) -> dict[str, etree._Element]:
    record: RunRecord = foreign(replace(builder.record(), decisions=DECIDED))
    folder = tmp_path_factory.mktemp("pseudo")
    doubts: list[Doubt] = [replace(foreign(one), what=one.what, field=one.field) for one in builder.doubts()]
    spoken = Language("it", compiled)
    index = render(record, folder / "one", language=spoken, changes=CHANGED, doubts=lambda: doubts)
    found = {p.name: etree.parse(str(p)).getroot() for p in sorted(index.parent.glob("*.html"))}
    # What is not on display is left aside or assessed, and the reading may not be known.
    stored = [a for a in record.assessments if not a.scene.item.on_display]
    left = [Assessment(a.scene, (), (), aside=True) if a in stored else a for a in record.assessments]
    unread = {name: value for name, value in record.settings.items() if name != "reading"}
    other = render(replace(record, assessments=tuple(left), settings=unread), folder / "two", language=spoken)
    names = ("index.html", "not-on-display.html")
    return found | {f"aside-{n}": etree.parse(str(other.with_name(n))).getroot() for n in names}


def _texts(page: etree._Element) -> Iterator[str]:
    """Yield each text that a reader or a screen reader meets, and the attributes that are read aloud."""
    for element in page.iter(etree.Element):
        tag = str(element.tag)
        inside = [element, *element.iterancestors()]
        hidden = any(
            str(e.tag) in ("style", "script", *MARKED) or set((e.get("class") or "").split()) & {*MARKED}
            for e in inside
        )
        for name in ("title", "aria-label", "data-words"):
            if element.get(name) and tag != "html":
                yield element.get(name) or ""
        if not hidden:
            yield element.text or ""
        above = inside[1:]
        if not any(
            str(e.tag) in ("style", "script", *MARKED) or set((e.get("class") or "").split()) & {*MARKED} for e in above
        ):
            yield element.tail or ""


def test_no_english_is_left(pages: dict[str, etree._Element]) -> None:
    left: dict[str, str] = {}
    for name, page in pages.items():
        for text in _texts(page):
            bare = FILES.sub("", text)
            for word in re.findall(r"[A-Za-z][A-Za-z]+", bare):
                if word not in UNITS | MONTHS:
                    left.setdefault(word, f"{name}: {text.strip()[:120]}")
    assert left == {}


def test_every_page_says_its_language_and_is_translated(pages: dict[str, etree._Element]) -> None:
    for page in pages.values():
        assert (page.get("lang"), page.get("dir")) == ("it", "ltr")
        assert OPEN in " ".join(_texts(page))
    assert Language("he").direction == "rtl"


def test_babel_finds_phrases_in_templates_and_in_code() -> None:
    found = {phrase for phrase, _plural in phrases()}
    assert {"What to do first", "a guaranteed bound", "%(low)s to %(high)s"} <= found
    assert len(found) > 250


def _write(folder: Path, made: Catalog, code: str = "it") -> Path:
    file = folder / code / "LC_MESSAGES" / "kouros.mo"
    file.parent.mkdir(parents=True)
    with file.open("wb") as out:
        write_mo(out, made)
    return folder


def test_a_catalogue_is_read_from_its_folder(tmp_path: Path) -> None:
    chosen = language("it", _write(tmp_path, catalogue()))
    with speaking(chosen):
        assert said("freestanding") == pseudo("freestanding")
        # A text of the run that no catalogue knows as a whole is looked up sentence by sentence.
        assert said("freestanding. hung") == "freestanding. " + pseudo("hung")
        # What comes before the sentence of a measure is a sentence of its own, though that has a colon.
        (measure,) = (row["sentence"] for row in table("measures") if row["measure"] == "anchor")
        assert ": " in measure
        assert said(f"{ANCHORED} {measure}") == f"{pseudo(ANCHORED)} {pseudo(measure)}"
    assert said("freestanding") == "freestanding"


@pytest.mark.parametrize("code", ["ro", "xx-YY"])
def test_a_language_without_a_catalogue_is_refused(tmp_path: Path, code: str) -> None:
    with pytest.raises(ReportError, match=r"kouros\.mo; compile the catalogue"):
        language(code, tmp_path)
    with pytest.raises(ReportError, match="catalogues names no folder"):
        language(code, None)
    assert language("en-GB", None).code == "en-GB"


def test_a_damaged_catalogue_and_a_wrong_placeholder_are_named(tmp_path: Path) -> None:
    made = Catalog(locale="it")
    made.add("%(low)s to %(high)s", "da %(lo)s")
    with pytest.raises(ReportError, match=r"asks for lo: use only"):
        language("it", _write(tmp_path / "a", made))
    _write(tmp_path / "b", Catalog(locale="it"))
    (tmp_path / "b" / "it" / "LC_MESSAGES" / "kouros.mo").write_bytes(b"no catalogue")
    with pytest.raises(ReportError, match="is damaged"):
        language("it", tmp_path / "b")


def test_every_phrase_of_a_run_is_extracted() -> None:
    """What models and measures say without a number, over every row: none is missing for a translator."""
    known = {phrase for phrase, _plural in phrases()}
    for model in MODELS:
        texts = {model.title, model.sentence, model.at_most, model.gripped, model.fails} - {""}
        assert texts <= known, model.name
    assert set(NOTES.values()) <= known
    assert {row["title"] for row in table("measures")} <= known
    assert {row["why"] for row in table("rules")} - {""} <= known


@pytest.mark.parametrize(
    "name",
    ["BLOCK", "TOWER", *(pytest.param(name, marks=LONG) for name in ("PICTURE", "fragile", "light", "robust"))],
)
def test_a_real_run_is_translated(compiled: GNUTranslations, name: str) -> None:
    """Titles, sentences and outcomes of findings, sentences of advice and titles of its evidence are looked up.

    What a model writes numbers into itself (how long until it falls) is left, and begins with these words.
    """
    motion = scenes.demo_motion()
    item = {
        "fragile": replace(scenes.TOWER, allowable_stress_pa=2e5),
        "light": replace(scenes.TOWER, mass_kg=2.0),
        "robust": replace(scenes.TOWER, susceptible=False),
    }.get(name) or getattr(scenes, name)
    motion = motion.scaled(0.6, "weak") if name == "light" else motion
    scene = classify(item)
    levels = [LevelMotions("design", "max", (motion,))]
    _, findings = assess([scene], levels, Context(Threads(1)))
    (advice,) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice
    with speaking(Language("it", compiled)):
        for finding in findings[0]:
            assert said(finding.title).startswith(OPEN)
            assert said(finding.sentence).startswith(OPEN)
            assert not finding.outcome or said(finding.outcome).startswith(OPEN)
            left = [text for text in re.split(r"(?<=[.!?]) ", finding.sentence) if said(text) == text]
            assert all(text.startswith(("In this motion it", "It comes back")) for text in left)
        for one in advice:
            texts = [one.title, *re.split(r"(?<=[.!?]) ", one.sentence), *(check.title for check in one.checks)]
            assert [text for text in texts if not said(text).startswith(OPEN)] == []
