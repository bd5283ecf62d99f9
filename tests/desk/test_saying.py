"""What people say to the desk lies where the commands put it, and the next night takes it up."""

from __future__ import annotations

import time
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from pipeline.collection.database import open_database
from pipeline.collection.inventory import items_named, versions
from pipeline.desk.site import LOOK
from pipeline.operations.workspace import locked
from pipeline.records import DecisionKind, Hanging
from pipeline.settings import load_settings
from pipeline.store.decisions import read_decisions
from pipeline.store.desk import errand_words, picture_image, pictures_of
from pipeline.store.runs import load_run
from tests.museum import museum_of, night, vases

from .conftest import HOSTILE
from .visiting import Visitor, served


def engine_of(folder: Path):  # type: ignore[no-untyped-def]
    return open_database(load_settings(folder / "kouros.toml").database)


def test_what_is_in_the_store_is_not_called_fine(visitor: Visitor) -> None:
    """Nobody looked at it: a list that says "Fine" would be believed."""
    (row,) = visitor.get("/", q="jug store").page.xpath("//*[contains(@class, 'hits')]//li")
    assert "Not on display" in row.text_content()
    assert "Fine" not in row.text_content()
    (there,) = visitor.get("/", q="", state="aside").page.xpath("//*[contains(@class, 'hits')]//li")
    assert "S.1" in there.text_content()
    told = visitor.get("/").page.xpath("//select[@name='state']/option[@value='aside']")
    assert told[0].text_content() == "Not on display (1)"


def test_a_decision_is_that_of_the_command(visitor: Visitor, museum: Path) -> None:
    got = visitor.said_of("2.3", "/object/decide", kind="accept", why="case is rebuilt", until="2099-01-01")
    page = visitor.follow(got)
    assert "case is rebuilt" in page.text
    (one,) = read_decisions(engine_of(museum))
    assert (one.object_number, one.kind, one.who, one.until) == ("2.3", DecisionKind.ACCEPT, "A. Smith", "2099-01-01")
    # What it rested on is kept with it, as by `kouros decide`.
    assert one.basis
    visitor.follow(visitor.said_of("2.3", "/object/decide", kind="withdraw", id=str(one.id), why="not rebuilt"))
    assert read_decisions(engine_of(museum))[1].withdraws == one.id


def test_a_name_is_typed_once_and_is_never_that_of_the_account(
    visitor: Visitor, monkeypatch: pytest.MonkeyPatch
) -> None:
    def named() -> set[str]:
        return set(visitor.object("2.3").page.xpath("//input[@name='who']/@value"))

    assert named() == {""}
    visitor.follow(visitor.said_of("2.3", "/object/decide", kind="accept", why="w", who='Ἑ. Σμίθ; a=b, "c"'))
    assert named() == {'Ἑ. Σμίθ; a=b, "c"'}
    # Only on this browser; elsewhere it is whoever is named for the machine.
    visitor.cookies.clear()
    monkeypatch.setenv("KOUROS_WHO", "B. Rossi")
    assert named() == {"B. Rossi"}


def test_a_measure_is_installed_in_the_readers_units(visitor: Visitor, museum: Path) -> None:
    fields = {"kind": "installed", "measure": "clearance", "why": "moved", "p.clearance": "8 1/2"}
    visitor.follow(visitor.said_of("1.1", "/object/decide", **fields))
    (one,) = read_decisions(engine_of(museum))
    assert one.parameters == {"clearance": pytest.approx(8.5 * 0.0254, abs=1e-12)}


def test_what_cannot_be_is_said_and_what_was_typed_stays(visitor: Visitor, museum: Path) -> None:
    """One after the other at one desk: none of them changes anything."""
    for fields, words in (
        ({"kind": "accept", "why": " "}, "reason"),
        ({"kind": "accept", "why": "x" * 3000}, "2000"),
        ({"kind": "accept", "why": "w", "until": "2001-01-01"}, "before the decision"),
        ({"kind": "installed", "measure": "clearance", "why": "w", "p.clearance": "-3"}, "negative"),
        ({"kind": "installed", "measure": "../etc", "why": "w"}, "which measure"),
        ({"kind": "class", "class": "<b>", "why": "w"}, "no class"),
        ({"kind": "nonsense", "why": "w"}, "what you decide"),
        ({"kind": "accept", "why": "w", "who": "a\nb"}, "one line"),
    ):
        got = visitor.said_of("1.1", "/object/decide", **fields)
        assert got.status == 422, fields
        assert words in got.alert
        if fields["why"].strip() and fields["kind"] in ("accept", "class"):
            assert fields["why"] in [area.text for area in got.page.xpath("//textarea[@name='why']")]
        assert read_decisions(engine_of(museum)) == ()


def test_of_two_people_the_second_is_told_and_nothing_is_lost(address: str, museum: Path) -> None:
    first, second = Visitor(address), Visitor(address)
    seen = second.object("1.1")
    first.follow(first.said_of("1.1", "/object/measured", **{"m.clearance_m": "3"}))
    stale = second.said_of("1.1", "/object/measured", seen, who="B. Jones", **{"m.mass_kg": "12 1/2"})
    assert stale.status == 409
    assert "Somebody else" in stale.alert
    item = items_named(engine_of(museum), ["1.1"])["1.1"]
    assert (item.clearance_m, item.mass_kg) == (pytest.approx(0.0762), None)
    # The form has what was typed, and the version of now: sent again, both stand.
    assert stale.page.xpath("//input[@name='m.mass_kg']/@value") == ["12 1/2"]
    second.follow(second.said_of("1.1", "/object/measured", stale, who="B. Jones", **{"m.mass_kg": "12 1/2"}))
    item = items_named(engine_of(museum), ["1.1"])["1.1"]
    assert item.clearance_m == pytest.approx(0.0762)
    assert item.mass_kg == pytest.approx(12.5 * 0.45359237, rel=1e-9)


def test_measurements_say_who_wrote_what(visitor: Visitor, museum: Path) -> None:
    page = visitor.follow(visitor.said_of("1.1", "/object/measured", **{"m.base_width_m": '3 1/4"'}))
    item = items_named(engine_of(museum), ["1.1"])["1.1"]
    assert item.base_width_m == pytest.approx(3.25 * 0.0254, rel=1e-9)
    (of,) = [of for of in item.provenance if of.field == "base_width_m"]
    assert "A. Smith" in of.note
    assert of.written == '3 1/4"'
    assert "A. Smith" in page.text
    assert versions(engine_of(museum))[0].source == "desk, A. Smith"


@pytest.mark.parametrize(
    ("cells", "told"),
    [
        ({"m.mass_kg": "999999"}, "Mass: 1000000\u202flb in "),
        ({"m.mass_kg": "0"}, "Mass: '0' is too little to be true: measure it again"),
        ({"m.friction": "3"}, "Friction under the base: '3' is too much to be true: measure it again"),
        ({"m.allowable_stress_pa": "0.1 psi"}, "is too little to be true"),
    ],
)
def test_what_cannot_be_beside_its_record_is_told_in_the_words_of_the_desk(
    cells: dict[str, str], told: str, visitor: Visitor, museum: Path
) -> None:
    """A vase of a foot that weighs 500 tons; and nobody with a tablet has a mapping to mend."""
    got = visitor.said_of("1.1", "/object/measured", **cells)
    assert told in got.alert
    for word in ("mapping", "column", "database", "_kg", "_m"):
        assert word not in got.alert
    item = items_named(engine_of(museum), ["1.1"])["1.1"]
    assert (item.mass_kg, item.friction, item.allowable_stress_pa) == (None, None, None)


def test_a_cell_that_is_no_measure_is_marked_and_nothing_is_saved(visitor: Visitor, museum: Path) -> None:
    for cell in ("-3", "10-12", "nan", "1e3", "1/0", "1,234", "3 kg", "9999999", "=1+1", "x" * 200):
        got = visitor.said_of("1.1", "/object/measured", **{"m.clearance_m": cell, "m.mass_kg": "3"})
        assert got.status == 422, cell
        assert got.page.xpath("//div[contains(@class, 'wrong')]//input/@name") == ["m.clearance_m"]
        assert got.page.xpath("//input[@name='m.mass_kg']/@value") == ["3"]
        item = items_named(engine_of(museum), ["1.1"])["1.1"]
        assert (item.clearance_m, item.mass_kg) == (None, None)


def test_while_a_night_is_at_work_what_was_typed_stays(
    visitor: Visitor, museum: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.desk.entering.PATIENCE", 0.3)
    seen = visitor.object("1.1")
    with locked(load_settings(museum / "kouros.toml")):
        got = visitor.said_of("1.1", "/object/measured", seen, **{"m.mass_kg": "3"})
    assert "a run is at work" in got.alert
    assert got.page.xpath("//input[@name='m.mass_kg']/@value") == ["3"]
    visitor.follow(visitor.said_of("1.1", "/object/measured", got, **{"m.mass_kg": "3"}))


@pytest.mark.long("test_a_following_night_takes_it_up")
def test_a_house_rule_goes_into_the_settings_once(visitor: Visitor, museum: Path) -> None:
    page = visitor.get("/house")
    # What is not offered is not chosen, nor counted.
    for asked in ("class=dragon", "gallery=Nowhere", "states=mood"):
        other = visitor.get(f"/house?{asked}").page
        assert not other.xpath("//select[@name='class' or @name='gallery']/option[@selected and @value != '']")
        assert "0 objects" not in other.text_content()
    keys = {name: page.hidden("/house/rule", name) for name in ("token", "version")}
    rule = {"class": "framed", "gallery": "Room 0", "states": "hanging", "word": "two_hooks", "who": "A. Smith"}
    visitor.follow(visitor.post("/house/rule", **keys, **rule))
    (stated,) = load_settings(museum / "kouros.toml").house
    assert (stated.hanging, stated.gallery, stated.said_by) == (Hanging.TWO_HOOKS, ("Room 0",), "A. Smith")
    other = visitor.post("/house/rule", **keys, **rule | {"word": "cleat"})
    assert other.status == 409
    keys["version"] = other.hidden("/house/rule", "version")
    against = visitor.post("/house/rule", **keys, **rule | {"word": "cleat"})
    assert against.status == 422
    assert len(load_settings(museum / "kouros.toml").house) == 1
    number = rule | {"states": "clearance_m", "low": "1/2", "best": "1", "high": "5 cm", "word": ""}
    visitor.follow(visitor.post("/house/rule", **keys, **number))
    span = load_settings(museum / "kouros.toml").house[1].clearance_m
    assert span is not None
    assert (span.low, span.best) == pytest.approx((0.0127, 0.0254))


def test_a_house_rule_is_taken_back_with_who_when_and_why(visitor: Visitor, museum: Path) -> None:
    config = museum / "kouros.toml"
    before = config.read_text(encoding="utf-8") + '\n# ours\n[[house]] # the first\nnumber = "1.*"\nfriction = 0.4\n'
    before += 'said_by = "A. Smith"\nsaid_on = 2031-05-12\n\n[[house]]\nclass = "framed"\nhanging = "cleat"\n'
    before += 'said_by = "A. Smith"\nsaid_on = 2031-05-12\n'
    config.write_text(before, encoding="utf-8")
    page = visitor.get("/house")
    keys = {name: page.hidden("/house/back", name) for name in ("token", "version")}
    for wrong in ({"at": "7", "why": "x"}, {"at": "-1", "why": "x"}, {"at": "0", "why": " "}, {"at": "x", "why": "x"}):
        assert visitor.post("/house/back", **keys, **wrong, who="B. Rossi").status == 422
    assert visitor.post("/house/back", **keys, at="0", why="x", who="").status == 422
    assert config.read_text(encoding="utf-8") == before
    done = visitor.post("/house/back", **keys, at="0", why='The "pads" <b>\nare gone', who="B. Rossi")
    visitor.follow(done)
    first, second = load_settings(config).house
    assert not first.holds
    assert (first.taken_back_by, first.taken_back_why) == ("B. Rossi", 'The "pads" <b> are gone')
    assert second.holds
    # Nothing else of the file has changed, not a comment.
    lines = config.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if not line.startswith("taken_back_")] == before.splitlines()
    shown = visitor.get("/house").page
    assert 'The "pads" <b> are gone' in shown.text_content()
    assert len(shown.xpath("//form[@action='/house/back']")) == 1
    # Two people on one rule: the second is told.
    assert visitor.post("/house/back", **keys, at="0", why="again", who="C. Doe").status == 409
    keys["version"] = visitor.get("/house").hidden("/house/back", "version")
    assert visitor.post("/house/back", **keys, at="0", why="again", who="C. Doe").status == 422
    # What was taken back may be stated again, or something else in its place.
    rule = {"states": "hanging", "class": "framed", "word": "cleat", "who": "A. Smith"}
    visitor.post("/house/rule", **keys, **rule)
    assert len(load_settings(config).house) == 2


def picture(size: tuple[int, int] = (64, 48), kind: str = "JPEG") -> bytes:
    out = BytesIO()
    exif = Image.Exif()
    exif[0x010F] = "SECRET CAMERA"
    exif[0x0112] = 6
    Image.new("RGB", size, (200, 10, 10)).save(out, kind, exif=exif)
    return out.getvalue()


def test_a_photograph_is_written_anew(visitor: Visitor, museum: Path) -> None:
    seen = visitor.object("1.1")
    keys = {name: seen.hidden("/object/picture", name) for name in ("token", "version")}
    sent = picture() + b"<script>alert(1)</script>"
    visitor.follow(visitor.upload("/object/picture", sent, number="1.1", who="A. Smith", note="<b>clip", **keys))
    (kept,) = pictures_of(engine_of(museum), "1.1")
    image = picture_image(engine_of(museum), kept.id)
    assert image is not None
    assert b"SECRET" not in image
    assert b"script" not in image
    # Turned upright: what the camera said of its side is done, and gone.
    assert Image.open(BytesIO(image)).size == (48, 64)
    got = visitor.get("/picture", id=str(kept.id))
    assert (got.headers["content-type"], got.headers["x-content-type-options"]) == ("image/jpeg", "nosniff")
    assert "<b>clip" not in visitor.object("1.1").text


def test_what_is_no_photograph_is_refused(visitor: Visitor, museum: Path) -> None:
    svg = b"<svg xmlns='http://www.w3.org/2000/svg'/>"
    for content in (b"", svg, b"GIF89a" + bytes(50), picture()[:200], b"\xff\xd8\xff" * 99):
        seen = visitor.object("1.1")
        keys = {name: seen.hidden("/object/picture", name) for name in ("token", "version")}
        got = visitor.upload("/object/picture", content, number="1.1", who="A. Smith", **keys)
        assert got.status == 422, content
        assert "photograph" in got.alert
        assert pictures_of(engine_of(museum), "1.1") == ()


def test_a_picture_that_would_fill_the_memory_is_refused(visitor: Visitor) -> None:
    out = BytesIO()
    Image.new("1", (8_000, 8_000)).save(out, "PNG")
    seen = visitor.object("1.1")
    keys = {name: seen.hidden("/object/picture", name) for name in ("token", "version")}
    assert visitor.upload("/object/picture", out.getvalue(), number="1.1", who="A", **keys).status == 422


def first_errand(visitor: Visitor) -> str:
    return str(visitor.get("/errands").page.xpath("//a[starts-with(@href, '/errand?key=')]/@href")[0]).partition("=")[2]


def test_an_errand_is_taken_and_done(visitor: Visitor, museum: Path) -> None:
    key = first_errand(visitor)
    page = visitor.get("/errand", key=key)
    keys = {name: page.hidden("/errand/say", name) for name in ("token", "version")}
    page = visitor.follow(visitor.post("/errand/say", key=key, kind="take", who="M. Maker", **keys))
    assert visitor.post("/errand/say", key=key, kind="give", whose="X", who="late", **keys).status == 409
    assert key in visitor.get("/errands", whose="M. Maker").text
    keys["version"] = page.hidden("/errand/say", "version")
    numbers = page.page.xpath("//input[@name='object']/@value")
    told = {"key": key, "kind": "done", "who": "M. Maker", "ticks": "1"}
    if numbers:
        untold = visitor.post("/errand/say", **told, **keys)
        assert untold.status == 422
        cells = {str(i.get("name")): str(i.get("value")) or "4" for i in page.page.xpath("//ol//input[@inputmode]")}
        visitor.follow(visitor.post("/errand/say", **told, **keys, **cells, object=str(numbers[0])))
        (made,) = read_decisions(engine_of(museum))
        assert (made.object_number, made.kind, made.who) == (numbers[0], DecisionKind.INSTALLED, "M. Maker")
    assert [word.kind for word in errand_words(engine_of(museum))[key]] == ["take", "done"]


def test_a_following_night_takes_it_up(visitor: Visitor, museum: Path) -> None:
    visitor.follow(visitor.said_of("2.3", "/object/decide", kind="accept", why="case is rebuilt"))
    visitor.follow(visitor.said_of("1.1", "/object/measured", **{"m.clearance_m": "40"}))
    page = visitor.get("/house")
    # What is not offered is not chosen, nor counted.
    for asked in ("class=dragon", "gallery=Nowhere", "states=mood"):
        other = visitor.get(f"/house?{asked}").page
        assert not other.xpath("//select[@name='class' or @name='gallery']/option[@selected and @value != '']")
        assert "0 objects" not in other.text_content()
    keys = {name: page.hidden("/house/rule", name) for name in ("token", "version")}
    rule = {"class": "framed", "gallery": "Room 0", "states": "hanging", "word": "two_hooks", "who": "A. Smith"}
    visitor.follow(visitor.post("/house/rule", **keys, **rule))
    summary = night(load_settings(museum / "kouros.toml"))
    run = load_run(engine_of(museum))
    assert run.run_id == summary.run_id
    assert [(s.decision.object_number, s.decision.who) for s in run.decisions] == [("2.3", "A. Smith")]
    scenes = {a.scene.item.object_number: a.scene for a in run.assessments}
    assert scenes["1.1"].parameters["clearance"].value == pytest.approx(40 * 0.0254)
    assert scenes["P1"].hanging is Hanging.TWO_HOOKS
    # And the desk, which has run all the while, shows the new night.
    for _ in range(50):
        page = visitor.object("1.1")
        if run.run_id in page.text:
            break
        time.sleep(0.1)
    assert run.run_id in page.text


def test_it_works_on_a_postgresql_server(
    tmp_path: Path, postgresql_databases: Callable[[], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    postgresql_url = postgresql_databases()
    monkeypatch.setenv("KOUROS_DATABASE", postgresql_url)
    folder = tmp_path / "museum"
    settings = museum_of(folder, vases(1, 2), furnished=True)
    night(settings)
    with served(folder) as there:
        visitor = Visitor(there)
        visitor.follow(visitor.said_of("0.1", "/object/decide", kind="accept", why="é \x00 <b>"))
        visitor.follow(visitor.said_of("0.1", "/object/measured", **{"m.mass_kg": "0,3"}))
        seen = visitor.object("0.1")
        keys = {name: seen.hidden("/object/picture", name) for name in ("token", "version")}
        visitor.follow(visitor.upload("/object/picture", picture(), number="0.1", who="A", note="n", **keys))
        assert visitor.get("/picture", id="1").body[:2] == b"\xff\xd8"
    engine = open_database(postgresql_url)
    assert read_decisions(engine)[0].why == "é  <b>"
    assert items_named(engine, ["0.1"])["0.1"].mass_kg == 0.3


def test_hostile_numbers_and_titles_stay_text(visitor: Visitor, museum: Path) -> None:
    for path in ("/", "/galleries", "/errands", "/survey", "/?q=img", "/?q=%3Cscript"):
        got = visitor.get(path)
        assert got.status == 200, path
        assert not got.page.xpath("//main//script | //main//img"), path
    page = visitor.object(HOSTILE)
    assert page.status == 200
    assert page.page.xpath("//h1//text()")[0] == HOSTILE
    visitor.follow(visitor.said_of(HOSTILE, "/object/decide", kind="accept", why="<script>alert(2)</script>"))
    (made,) = read_decisions(engine_of(museum))
    assert made.object_number == HOSTILE


@pytest.mark.long("test_a_following_night_takes_it_up")
def test_an_object_says_that_a_measure_decided_today_is_computed_with_tonight(museum: Path, visitor: Visitor) -> None:
    told = "to be computed again tonight"
    assert told not in visitor.object("1.2").text
    # A risk that is accepted changes nothing that is computed.
    assert told not in visitor.follow(visitor.said_of("1.2", "/object/decide", kind="accept", why="w")).text
    done = visitor.said_of("1.2", "/object/decide", kind="class", why="w", **{"class": "cabinet"})
    assert told in visitor.follow(done).text
    night(load_settings(museum / "kouros.toml"))
    time.sleep(LOOK)  # a night of ten objects may be over before the desk looks for a newer run again
    assert told not in Visitor(visitor.address).object("1.2").text
