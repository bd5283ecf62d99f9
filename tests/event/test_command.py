"""`kouros event` in a museum: what it answers, keeps and tells."""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from pipeline.cache import CacheWarning
from pipeline.errors import InputError
from pipeline.event.message import MessageError
from pipeline.motions.responses import load_obspy
from pipeline.operations.workspace import UsageError, locked, open_workspace
from pipeline.report.files.event_files import EVENT_COLUMNS
from pipeline.resources import resource
from pipeline.settings import load_settings
from pipeline.store.codec import StoreError
from pipeline.tools.event import EventDone, TypedShaking, answer_event
from pipeline.tools.event_folders import EVENTS
from pipeline.tools.synthetic import synthesise
from tests.cli.test_dry_runs import digest, say
from tests.event.messages import DATA, NOW, PARK, alert
from tests.museum import workspace

MAP = DATA / "loma_prieta_grid.xml"


@pytest.fixture(scope="module")
def night(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A museum after a night."""
    folder = tmp_path_factory.mktemp("museum")
    synthesise("sine", ["amplitude=4", "frequency=1.5", "cycles=3"], folder / "shaking")
    workspace(folder, site="shaking", furnished=True, sampled=True)
    assert say(folder, "run")[0] == 0
    return folder


@pytest.fixture
def museum(night: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(night, tmp_path / "museum", symlinks=True))


def ask(folder: Path, *files: Path, **more: Any) -> EventDone:
    at = more.pop("at", PARK)
    return answer_event(open_workspace(load_settings(folder / "kouros.toml")), files, at=at, now=NOW, **more)


def shown(done: EventDone) -> Path:
    return (done.folder.parent / "latest").resolve()


def test_the_answer_for_programs_is_the_contract(museum: Path) -> None:
    code, out, message = say(museum, "event", str(MAP), "--at", "37.77,-122.47", "--json")
    assert code == 0, message
    said = json.loads(out)
    assert list(said) == ["event", "shaking", "expected", "galleries", "objects"]
    assert list(said["shaking"]) == ["pga_g", "pgv_cm_s", "pga_ln_sd", "pgv_ln_sd", "from"]
    assert list(said["expected"]) == ["fallen", "low", "high"]
    assert said["shaking"]["pga_g"] == pytest.approx(0.144, abs=0.002)
    assert said["expected"]["low"] <= said["expected"]["fallen"] <= said["expected"]["high"]
    # On a flat map: 0.73 degrees of 111.2 km to the north, 0.59 of 88.4 km to the west: 96.5 km.
    assert said["event"]["distance_km"] == pytest.approx(96.6, rel=0.01)
    assert {one["object_number"] for one in said["objects"]} == {"1", "2", "3"}
    assert said["objects"][0]["object_number"] == "1", "the tall one comes first"
    assert said["objects"][0]["probability"] > said["objects"][1]["probability"]
    assert sum(one["fallen"] for one in said["galleries"]) == pytest.approx(said["expected"]["fallen"], abs=1e-3)


def test_the_files_of_an_answer_are_whole_and_hostile_names_are_text(museum: Path) -> None:
    """The museum has a gallery called Gallery "A" <b> and an object whose title is a script."""
    done = ask(museum, MAP)
    names = sorted(path.name for path in done.folder.iterdir())
    assert {"index.html", "answer.json", "objects.csv", "event.geojson"} < set(names)
    sheets = [name for name in names if name.startswith("sheet-")]
    assert len(sheets) == len(done.document["galleries"]) == 2
    for name in ("index.html", *sheets):
        text = (done.folder / name).read_text("utf-8")
        page = etree.fromstring(text.encode(), etree.HTMLParser(recover=False))
        assert not page.findall(".//script"), name
        assert "<script>alert" not in text
        assert all((done.folder / link).is_file() for link in page.xpath("//main//a/@href"))
    everything = "".join((done.folder / name).read_text("utf-8") for name in sheets)
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in everything
    with (done.folder / "objects.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == EVENT_COLUMNS
    assert [row["rank"] for row in rows] == ["1", "2", "3"]
    places = json.loads((done.folder / "event.geojson").read_text("utf-8"))
    points = [one["geometry"]["coordinates"] for one in places["features"] if one["geometry"]]
    assert points == [[PARK[1], PARK[0]], [-121.88, 37.04]]
    assert json.loads((done.folder / "answer.json").read_text("utf-8")) == done.document
    assert shown(done) == done.folder.resolve()


def test_the_same_message_twice_does_nothing(museum: Path) -> None:
    first = ask(museum, MAP)
    before = digest(museum / EVENTS)
    again = ask(museum, MAP)
    assert (first.again, again.again, again.newest) == (False, True, True)
    assert again.document == first.document
    assert digest(museum / EVENTS) == before


def test_what_is_believed_more_replaces_and_every_version_is_kept(museum: Path, tmp_path: Path) -> None:
    message = tmp_path / "alert.xml"
    message.write_text(alert(), encoding="utf-8")
    first = ask(museum, message)
    mapped = ask(museum, MAP)
    later = tmp_path / "grid.xml"
    later.write_text(MAP.read_text("utf-8").replace('shakemap_version="1"', 'shakemap_version="2"'), encoding="utf-8")
    newer = ask(museum, later)
    assert len({done.folder for done in (first, mapped, newer)}) == 3
    assert first.folder.parent == mapped.folder.parent == newer.folder.parent
    assert all((done.folder / "index.html").is_file() for done in (first, mapped, newer))
    assert shown(newer) == newer.folder.resolve()
    # A message that is late changes nothing of what is shown.
    message.write_text(alert(magnitude="6.1"), encoding="utf-8")
    late = ask(museum, message)
    assert (late.again, late.newest) == (False, False)
    assert shown(late) == newer.folder.resolve()


def test_hindcast_the_first_answer_contains_the_second(museum: Path, tmp_path: Path) -> None:
    """Loma Prieta at Golden Gate Park: the first says where it is from and its range, which holds 14.4 % of g."""
    message = tmp_path / "alert.xml"
    message.write_text(alert(), encoding="utf-8")
    first, second = ask(museum, message), ask(museum, MAP)
    assert first.answer is not None
    assert second.answer is not None
    low, high = first.answer.shaking.pga_range()
    assert low < second.answer.shaking.pga_g < high
    low, high = first.answer.shaking.pgv_range()
    assert low < (second.answer.shaking.pgv_cm_s or 0.0) < high
    assert first.document["expected"]["low"] <= second.document["expected"]["fallen"]
    assert second.document["expected"]["fallen"] <= first.document["expected"]["high"]
    assert "ShakeAlert" in first.document["shaking"]["from"]
    # Numbers and their units stay on one line.
    page = (first.folder / "index.html").read_text("utf-8").replace("\xa0", " ").replace("\u202f", " ")
    assert "ShakeAlert" in page
    assert f"{high:.1f} cm/s" in page


def test_numbers_typed_by_hand_are_answered_and_said_to_be_unsure(museum: Path) -> None:
    sure = ask(museum, typed=TypedShaking(0.144, 18.9, 0.3))
    unsure = ask(museum, typed=TypedShaking(0.144))
    assert sure.document["shaking"]["from"] == "typed by hand"
    assert sure.document["shaking"]["pgv_ln_sd"] == 0.3
    assert unsure.document["shaking"]["pga_ln_sd"] == 0.86
    notes = " ".join(unsure.document["event"]["notes"])
    assert "judgement" in notes
    assert "estimated from PGA" in notes
    for wrong in (TypedShaking(14.4), TypedShaking(0.1, -1.0), TypedShaking(0.1, 5.0, 9.0)):
        with pytest.raises(UsageError, match=r"--p|--ln-sd"):
            ask(museum, typed=wrong)


def test_stronger_shaking_brings_more_down(museum: Path) -> None:
    fallen = [
        ask(museum, typed=TypedShaking(pga, 100.0 * pga, 0.1)).document["expected"]["fallen"]
        for pga in (0.05, 0.2, 0.8)
    ]
    assert fallen == sorted(fallen)
    assert fallen[-1] > fallen[0]


@pytest.mark.long("event/test_watch::test_a_record_waits_for_its_stationxml_and_a_folder_is_one_earthquake")
def test_the_own_record_is_believed_most(museum: Path, tmp_path: Path) -> None:
    """The record of the demonstration, counts with StationXML, of the main shock: less than half of it."""
    site = resource("site_motions", "demo")
    records = [site / "CI.CLC.xml"]
    for file in sorted(site.glob("*.mseed")):
        (trace,) = load_obspy().read(str(file))
        trace.trim(trace.stats.starttime + 20.0, trace.stats.starttime + 75.0)
        records.append(tmp_path / file.name)
        trace.write(str(records[-1]), format="MSEED")
    here = (35.81574, -117.59751)
    own = ask(museum, *records, at=here)
    # The reference of this record by full response removal: 0.325 / 0.535 g (east, north).
    assert own.document["shaking"]["pga_g"] == pytest.approx(0.535, rel=0.05)
    assert "own record" in own.document["shaking"]["from"]
    with pytest.raises(MessageError, match=r"recorded [\d,]+\.\d km from the museum"):
        ask(museum, *records, at=PARK)


def test_refusals_keep_earlier_answers(museum: Path, tmp_path: Path) -> None:
    ask(museum, MAP)
    before = digest(museum / EVENTS)
    taken_back = tmp_path / "alert.xml"
    taken_back.write_text(alert(kind="delete"), encoding="utf-8")
    with pytest.raises(MessageError, match="cancelled; earlier answers stay"):
        ask(museum, taken_back)
    cut = tmp_path / "cut.xml"
    cut.write_bytes(MAP.read_bytes()[:1500])
    with pytest.raises(MessageError, match="no whole XML"):
        ask(museum, cut)
    with pytest.raises(MessageError, match="km outside of the map"):
        ask(museum, MAP, at=(40.7, -74.0))
    with pytest.raises(UsageError, match="give a file about the earthquake"):
        ask(museum)
    with pytest.raises(UsageError, match="does not say where the museum is: give --at"):
        ask(museum, MAP, at=None)
    assert digest(museum / EVENTS) == before
    for words in (["--at", "here"], ["--at", "99,0"], ["--pgv", "5"]):
        code, _, message = say(museum, "event", str(MAP), *words)
        assert code == 2
        assert words[0] in message


def test_reports_from_the_galleries_condition_the_rest_and_stay(museum: Path, tmp_path: Path) -> None:
    first = ask(museum, typed=TypedShaking(0.3))
    found = tmp_path / "found.csv"
    found.write_text("object,state\n1,standing\n", encoding="utf-8")
    second = ask(museum, typed=TypedShaking(0.3), report=found)
    assert second.document["shaking"]["pga_g"] < first.document["shaking"]["pga_g"], "what is tall still stands"
    one = next(one for one in second.document["objects"] if one["object_number"] == "1")
    assert (one["reported"], one["states"].get("falls", 0.0)) == ("standing", 0.0)
    assert "found: standing" in (second.folder / "objects.csv").read_text("utf-8")
    pages = [(done.folder / "index.html").read_text("utf-8") for done in (first, second)]
    assert ["Nobody has looked yet" in page for page in pages] == [True, False]
    assert "What was found of 1 object is counted" in pages[1]
    # What was told holds for whatever comes later of the same earthquake.
    third = ask(museum, typed=TypedShaking(0.4))
    assert [one["reported"] for one in third.document["objects"]].count("standing") == 1
    with pytest.raises(InputError, match="give a CSV file"):
        ask(museum, typed=TypedShaking(0.3), report=tmp_path / "absent.csv")


def test_reports_alone_answer_the_last_earthquake_anew_as_its_message_would(museum: Path, tmp_path: Path) -> None:
    """Without its file, and with what the models found: the same answer as from the file with the reports."""
    first = ask(museum, MAP, seconds=5.0)
    assert first.document["event"]["modelled"] > 0
    found = tmp_path / "found.csv"
    found.write_text("object,state\n1,in piedi\n2,moved 2 cm\n", encoding="utf-8")
    before = digest(museum / EVENTS)
    code, out, message = say(museum, "event", "--report", str(found), "--dry-run")
    assert (code, "2 reports were taken." in out) == (0, True), message
    assert digest(museum / EVENTS) == before
    code, out, message = say(museum, "event", "--report", str(found))
    assert (code, "2 reports were taken." in out) == (0, True), message
    alone = json.loads((shown(first) / "answer.json").read_text("utf-8"))
    assert alone["event"]["modelled"] == first.document["event"]["modelled"]
    assert {one["object_number"]: one["reported"] for one in alone["objects"]} == {
        "1": "standing", "2": "moved", "3": ""
    }  # fmt: skip
    # Told again it changes nothing; and from the message, as its curves have it, the shaking is nearly the same.
    code, out, message = say(museum, "event", "--report", str(found))
    assert (code, "2 reports were taken, 2 of which were known." in out) == (0, True), message
    curves = ask(museum, MAP)
    plain = ask(museum, MAP).document["shaking"]
    assert curves.document["shaking"] == plain
    assert alone["shaking"]["pga_g"] == pytest.approx(plain["pga_g"], rel=0.2)
    code, _, message = say(museum, "event", "--report", str(found), "--at", "37.77,-122.47")
    assert (code, "give its FILE too" in message) == (2, True)


def test_reports_alone_need_an_earthquake(museum: Path, tmp_path: Path) -> None:
    found = tmp_path / "found.csv"
    found.write_text("object,state\n1,standing\n", encoding="utf-8")
    code, _, message = say(museum, "event", "--report", str(found))
    assert (code, "no earthquake was answered yet" in message) == (2, True)


def test_a_drill_is_said_to_be_one_and_is_timed(museum: Path) -> None:
    """The sine of 4 m/s2 at 1.5 Hz: its peak velocity is about 4 / (2 pi 1.5) m/s."""
    code, out, message = say(museum, "event", "--drill", "--at", "37.77,-122.47")
    assert code == 0, message
    assert "This was an exercise." in out
    folder = museum / EVENTS
    (page,) = folder.glob("*/latest/index.html")
    # First without, then with the models run again.
    assert len(list(folder.glob("*/typed-*"))) == 2
    assert "This is an exercise. The earthquake did not happen." in page.read_text("utf-8")
    said = json.loads((page.parent / "answer.json").read_text("utf-8"))
    assert said["event"]["scenario"]
    assert said["shaking"]["pga_g"] == pytest.approx(4.0 / 9.80665, rel=0.05)
    # A filtered or started sine may overshoot its steady velocity up to twice.
    assert 0.9 < said["shaking"]["pgv_cm_s"] / 42.4 < 2.1
    code, _, message = say(museum, "event", "--drill", "--pga", "0.1")
    assert (code, "leave files" in message) == (2, True)


def test_without_a_run_it_says_how_to_make_one(tmp_path: Path) -> None:
    workspace(tmp_path, furnished=True, sampled=True)
    with pytest.raises(StoreError, match="make one with `kouros run`"):
        ask(tmp_path, MAP)


def test_hooks_are_told_once(museum: Path) -> None:
    """A program is given the event, of the published schema, without the objects."""
    import jsonschema

    told = museum / "told.json"
    keep = f"import sys, pathlib; pathlib.Path({str(told)!r}).write_text(sys.stdin.read())"
    settings = museum / "kouros.toml"
    hook = f'\n[[hooks.command]]\nrun = {json.dumps([sys.executable, "-c", keep])}\non = ["shaken"]\n'
    settings.write_text(settings.read_text("utf-8") + hook, encoding="utf-8")
    assert say(museum, "event", str(MAP), "--at", "37.77,-122.47")[0] == 0
    said = json.loads(told.read_text("utf-8"))
    schema = json.loads((resource("schemas") / "event.schema.json").read_text("utf-8"))
    schema["properties"]["summary"] = schema["properties"]["last_good"]["properties"]["reading"] = {}
    jsonschema.validate(said, schema)
    assert said["event"] == "shaken"
    assert said["message"].startswith("After Loma Prieta, California: of 3 objects on display")
    assert "objects" not in said["earthquake"]
    assert (museum / said["earthquake"]["event"]["folder"] / "index.html").is_file()
    told.unlink()
    assert say(museum, "event", str(MAP), "--at", "37.77,-122.47")[0] == 0
    assert not told.exists()


def test_the_night_leaves_ready_what_an_answer_needs(museum: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No result is read; what is missing or damaged is made anew, and the answer is the same."""
    from pipeline.night import stocks

    read: list[str] = []
    load = stocks.load_page
    monkeypatch.setattr(stocks, "load_page", lambda engine, key: read.append(key) or load(engine, key))
    first = ask(museum, typed=TypedShaking(0.3, 25.0, 0.2))
    assert read == []
    files = sorted(museum.glob(".kouros*/stocks/*.kept"))
    assert len(files) == 2, "one for each page"
    files[0].unlink()
    files[1].write_bytes(files[1].read_bytes()[:-7])
    shutil.rmtree(first.folder.parent)
    with pytest.warns(CacheWarning, match="not what was written"):
        again = ask(museum, typed=TypedShaking(0.3, 25.0, 0.2))
    assert len(read) == 2
    assert again.document == first.document
    assert sorted(museum.glob(".kouros*/stocks/*.kept")) == files


def test_a_night_at_work_does_not_stop_it(museum: Path) -> None:
    """Who holds the lock of the workspace keeps nobody from an answer."""
    with locked(load_settings(museum / "kouros.toml")):
        assert ask(museum, MAP).newest
