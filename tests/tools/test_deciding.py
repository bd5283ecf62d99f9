"""What people decide: written down for good, computed with, and doubted when its reason goes."""

import json
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner, Result

from pipeline.analysis.classify import classify
from pipeline.analysis.response import respond
from pipeline.analysis.transmission import transmit
from pipeline.cli import kouros
from pipeline.collection.database import open_database
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.installed import InstalledMeasure, placed
from pipeline.motions import read_motion
from pipeline.night.publication import Now, standing
from pipeline.night.run import run
from pipeline.operations.run_summary import Summary
from pipeline.operations.workspace import UsageError, Workspace, open_workspace
from pipeline.records import (
    Anchorage,
    Assessment,
    Basis,
    Decision,
    DecisionKind,
    Finding,
    Item,
    RunRecord,
    Support,
    Verdict,
    in_force,
)
from pipeline.settings import load_settings
from pipeline.store.codec import StoreError
from pipeline.store.decisions import add_decision, read_decisions
from pipeline.store.runs import load_run
from pipeline.store.schema import decision_schema
from pipeline.tables import table
from pipeline.tools.decisions import WHO_VARIABLE, Wish, decide, listed
from pipeline.tools.rerender import render_again
from tests.museum import SILENT, edit, short_site, workspace

HOSTILE = "<script>alert(1)</script>\"'&{{7*7}}\u202e"
ROWS = ["1,A,Vase,1.2,0.2,0.2", "2,A,Vase,1.2,0.2,0.2", "3,B,Plate,0.03,0.3,0.3", f"{HOSTILE[:25]},B,Vase,0.5,0.2,0.2"]
KIND = DecisionKind


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small museum after one night."""
    folder = tmp_path_factory.mktemp("museum")
    short_site(folder)
    run(workspace(folder, ROWS, site="site"), SILENT)
    return folder


@pytest.fixture
def museum(ran: Path, tmp_path: Path) -> Path:
    """A copy of it that a test may change."""
    return Path(shutil.copytree(ran, tmp_path / "museum", symlinks=True))


def opened(folder: Path) -> Workspace:
    return open_workspace(load_settings(folder / "kouros.toml"))


def say(folder: Path, number: str, kind: DecisionKind, *words: str, **more: str) -> Decision:
    return decide(opened(folder), Wish(number, kind, words, **{"why": "because", "who": "Ann", **more}))


def night(folder: Path) -> tuple[Summary, RunRecord]:
    summary = run(load_settings(folder / "kouros.toml"), SILENT)
    return summary, load_run(open_database(folder / "kouros.sqlite"), summary.run_id)


def found(record: RunRecord, number: str) -> Assessment:
    return next(a for a in record.assessments if a.scene.item.object_number == number)


def finding(record: RunRecord, number: str, model: str) -> Finding:
    return next(f for f in found(record, number).findings if f.model == model)


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        (Wish("11", KIND.ACCEPT, why="x"), r"no object '11' in the inventory; did you mean '1'"),
        (Wish("1", KIND.ACCEPT, why=" "), r"needs its reason: give --why"),
        (Wish("1", KIND.ACCEPT, why="x", who="n" * 201), r"--who has 201 characters"),
        (Wish("1", KIND.ACCEPT, why="x", model="floating"), r"no model 'floating'; use one of .*rocking"),
        (Wish("1", KIND.ACCEPT, why="x", level="rare"), r"no level 'rare'; use one of test"),
        (
            Wish("1", KIND.ACCEPT, why="x", model="swing"),
            r"no such finding of object '1'; it has .*sliding \(test\), standing \(test\)",
        ),
        (Wish("1", KIND.ACCEPT, ["pass"], why="x"), r"takes no more words"),
        (Wish("1", KIND.ACCEPT, why="x", on="soon"), r"--on 'soon' is no date; write it as"),
        (Wish("1", KIND.ACCEPT, why="x", on="9999-01-01"), r"--on 9999-01-01 is in the future"),
        (Wish("1", KIND.ACCEPT, why="x", until="2001-01-01"), r"--until 2001-01-01 is before the decision"),
        (Wish("1", KIND.CLASS, ["bust"], why="x", until="2099-01-01"), r"--until is for accepted risks"),
        (Wish("1", KIND.CLASS, ["ship"], why="x"), r"no class 'ship'; use one of .*bust"),
        (Wish("1", KIND.CLASS, why="x"), r"say one class"),
        (Wish("1", KIND.CLASS, ["bust"], why="x", model="standing"), r"--model and --level are for accept and verdict"),
        (Wish("1", KIND.VERDICT, ["pass"], why="x"), r"say by --model which verdict"),
        (Wish("1", KIND.VERDICT, ["maybe"], why="x", model="standing"), r"no verdict 'maybe'; use one of pass, fail"),
        (Wish("1", KIND.INSTALLED, why="x"), r"say what is installed: one of chocks, clearance"),
        (Wish("1", KIND.INSTALLED, ["glue"], why="x"), r"no measure that can be installed 'glue'; use one of chocks"),
        (Wish("1", KIND.INSTALLED, ["remove"], why="x"), r"no measure that can be installed 'remove'"),
        (Wish("1", KIND.INSTALLED, ["clearance"], why="x"), r"clearance needs clearance_m \(room on all sides\)"),
        (Wish("1", KIND.INSTALLED, ["clearance", "0.1"], why="x"), r"write NAME=VALUE"),
        (Wish("1", KIND.INSTALLED, ["clearance", "room=1"], why="x"), r"no parameter of clearance 'room'"),
        (Wish("1", KIND.INSTALLED, ["clearance", "clearance_m=nan"], why="x"), r"must be a finite number at least 0"),
        (Wish("1", KIND.INSTALLED, ["clearance", "clearance_m=-1"], why="x"), r"must be a finite number at least 0"),
        (Wish("1", KIND.INSTALLED, ["clearance", "clearance_m=3 lb"], why="x"), r"must be a finite number at least 0"),
        (Wish("1", KIND.WITHDRAW, ["7"], why="x"), r"no decision '7' to withdraw; it has none"),
    ],
)
def test_what_cannot_be_is_refused_with_what_can(ran: Path, wish: Wish, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        decide(opened(ran), replace(wish, who=wish.who or "Ann"))
    assert read_decisions(opened(ran).engine) == ()


@pytest.mark.parametrize(
    ("text", "metres"), [("0.1", 0.1), ("4in", 0.1016), ("4 1/2 in", 0.1143), ("10 cm", 0.1), ('4"', 0.1016)]
)
def test_a_length_may_name_its_unit(museum: Path, text: str, metres: float) -> None:
    made = say(museum, "1", KIND.INSTALLED, "clearance", f"clearance_m={text}")
    assert made.parameters == {"clearance": metres}


def test_who_comes_from_the_environment_and_is_never_empty(museum: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(WHO_VARIABLE, "Bo Berg")
    assert decide(opened(museum), Wish("1", KIND.ACCEPT, why="x")).who == "Bo Berg"
    monkeypatch.delenv(WHO_VARIABLE)
    monkeypatch.setattr("getpass.getuser", lambda: " ")
    with pytest.raises(UsageError, match=f"give --who NAME, or set {WHO_VARIABLE}"):
        decide(opened(museum), Wish("1", KIND.ACCEPT, why="x"))


def test_the_log_is_only_added_to(museum: Path) -> None:
    """A withdrawal is a row; a later decision on the same matter takes the place of the earlier; imports touch none."""
    first = say(museum, "1", KIND.ACCEPT)
    second = say(museum, "1", KIND.ACCEPT, why="again")
    other = say(museum, "1", KIND.ACCEPT, model="standing")
    say(museum, "1", KIND.WITHDRAW, str(other.id))
    with pytest.raises(UsageError, match="no decision '3' to withdraw; those in force are 2"):
        say(museum, "1", KIND.WITHDRAW, str(other.id))
    engine = opened(museum).engine
    with pytest.raises(StoreError, match="decision 3 is withdrawn already"):
        add_decision(engine, replace(read_decisions(engine)[-1], why="by two at once"))
    assert [d.id for d in listed(opened(museum), "1")] == [second.id]
    log = read_decisions(engine)
    assert [d.kind for d in log] == [KIND.ACCEPT] * 3 + [KIND.WITHDRAW]
    assert log[0] == first
    workspace(museum, ["2,A,Vase,1.2,0.2,0.2", *ROWS[2:]], site="site")
    edit(museum / "kouros.toml", "shrink_limit = 0.2", "shrink_limit = 0.9")
    summary, record = night(museum)
    assert read_decisions(engine) == log
    assert [s.doubts for s in record.decisions] == [("the object is no longer in the inventory",)]
    assert summary.doubted[0].startswith("1: risk accepted, Ann, ")
    # What is gone can still be withdrawn.
    say(museum, "1", KIND.WITHDRAW, str(second.id))
    assert listed(opened(museum)) == []


def test_an_accepted_risk_stands_beside_the_verdict(museum: Path) -> None:
    before = load_run(open_database(museum / "kouros.sqlite"))
    assert finding(before, "1", "standing").verdict is Verdict.FAIL
    made = say(museum, "1", KIND.ACCEPT, until="9998-12-31")
    overruled = say(museum, "2", KIND.VERDICT, "pass", model="standing")
    assert {b.model for b in made.basis} == {f.model for f in found(before, "1").findings}
    assert [b.model for b in overruled.basis] == ["standing"]
    summary, record = night(museum)
    assert [a.findings for a in record.assessments] == [a.findings for a in before.assessments]
    assert [s.doubts for s in record.decisions] == [(), ()]
    assert (summary.decisions, summary.doubted) == ({"accept": 1, "verdict": 1}, [])
    assert not any(text.startswith("1 ") for text in summary.first)
    page = next((museum / "reports" / "latest").glob("a-*.html")).read_text(encoding="utf-8")
    first = page[page.index('id="first"') :].partition("</ol>")[0]
    assert ">1</bdi>" not in first
    assert ">2</bdi>" in first  # sliding still fails there
    assert "Accepted risks" in page
    assert "1 risk accepted, 1 verdict overruled." in page
    index = render_again(load_settings(museum / "kouros.toml"), None)
    assert summary.report is not None
    assert index.read_bytes() == summary.report.read_bytes()


def test_what_is_decided_about_the_object_is_computed_with(museum: Path) -> None:
    say(museum, "1", KIND.CLASS, "bust", why="it is the bust of a vase")
    say(museum, "2", KIND.INSTALLED, "clearance", "clearance_m=3", "product=plinth 4")
    say(museum, "3", KIND.INSTALLED, "fasten")
    _, record = night(museum)
    one, two, three = (found(record, number).scene for number in "123")
    today = datetime.now(UTC).date().isoformat()
    assert (one.object_class, one.rule) == ("bust", f"decided by Ann on {today}: it is the bust of a vase")
    assert two.parameters["clearance"].value == 3.0
    assert "decided by Ann" in two.parameters["clearance"].note
    assert not any(text.startswith("clearance") for text in two.assumptions)
    sliding = finding(record, "2", "sliding")
    assert (sliding.verdict, sliding.capacity) == (Verdict.PASS, 3.0)
    assert three.support is Support.FASTENED
    assert {f.model for f in found(record, "3").findings} <= {"stress", "flexible_stress"}
    # None of it has touched the inventory.
    assert all(found(record, n).scene.item.support is None for n in "123")


def test_what_stands_on_an_isolator_is_run_on_what_that_passes_on(museum: Path) -> None:
    """Stroke and lift are those of the isolator's own equation and of the motion that it transmits."""
    given = {"frequency": 0.5, "damping": 0.02, "friction": 0.05}
    words = [f"{name}={value}" for name, value in (("damping", 0.02), ("friction", 0.05), ("frequency_hz", 0.5))]
    say(museum, "1", KIND.INSTALLED, "horizontal_isolator", *words, "stroke_m=0.9")
    _, record = night(museum)
    (motion,) = read_motion(museum / "site")
    own = finding(record, "1", "horizontal_isolator")
    stroke = respond("horizontal_isolator", motion, **given)["displacement"].iloc[0]
    assert own.demand == pytest.approx(stroke, rel=1e-6)
    assert own.capacity == 0.9
    rocking = finding(record, "1", "standing")
    scene = classify(found(record, "1").scene.item)
    passed = transmit("horizontal_isolator", motion, **given)
    sizes = {name: scene.parameters[name].value for name in ("half_width", "cg_height", "friction_static")}
    # The same polygon in the worst direction; the night asks every ten degrees.
    expected = respond("standing", passed, angle=None, **sizes)["uplift_ratio"].iloc[0]
    assert rocking.demand == pytest.approx(expected, rel=1e-2)
    assert rocking.motion_hash == record.motions[0].hash
    assert rocking.mark is None
    assert "Tipping" not in found(record, "1").scene.skipped
    assert "isolator passes on" in rocking.note


def test_each_measure_that_can_be_installed_changes_a_scene() -> None:
    """Whatever measures.csv has, with the least that must be known of it; each changes what is run."""
    standing = Item("1", "G", object_name="vase", height_m=0.4, width_m=0.2, depth_m=0.2, mass_kg=3.0)
    hung = Item("2", "G", object_name="painting", height_m=0.8, width_m=0.6, support=Support.HUNG)
    loose = replace(standing, furniture_anchorage=Anchorage.UNANCHORED)
    above = Item("3", "G", object_name="chandelier", height_m=0.8, mass_kg=20.0)
    on_walls = ("rubber_pads", "restrain", "close_hooks")
    known = own_catalogue().installable
    assert set(known) == {row["measure"] for row in table("measures")} - {"remove"}
    for name, measure in known.items():
        parameters = {q.name: 2.0 if q.name == "enlargement" else 0.4 for q in measure.parameters}
        scene = classify({"anchor": loose, "stays": above}.get(name, hung if name in on_walls else standing))
        stands = placed(scene, [InstalledMeasure(name, parameters, "decided by Ann on 2031-05-01: because")])
        assert stands.scene.parameters != scene.parameters or stands.scene.support is not scene.support, name
        assert not any("not computed" in text for text in stands.scene.assumptions), name
        assert (stands.above is not None) is name.endswith("isolator")


def test_a_measure_that_lacks_a_number_of_the_object_is_not_computed_and_says_so() -> None:
    painting = classify(Item("2", "G", object_name="painting", height_m=0.8, support=Support.HUNG))
    said = InstalledMeasure(
        "rotational_isolator", {"frequency": 3.0, "damping": 0.1, "rotation_limit": 0.1}, "decided by Ann"
    )
    stands = placed(painting, [said])
    assert stands.scene.parameters == painting.parameters
    assert any("not computed: 'cg_height'" in text for text in stands.scene.assumptions)


def test_a_decision_whose_reason_has_changed_is_doubted(museum: Path) -> None:
    """Record and motion change; the risk ends; each says so, in the report too, and the object is to be acted on."""
    yesterday = (datetime.now(UTC) - timedelta(days=1)).date().isoformat()
    say(museum, "1", KIND.ACCEPT)
    say(museum, "2", KIND.ACCEPT, on=yesterday, until=yesterday)
    say(museum, "3", KIND.ACCEPT, model="sliding")
    workspace(museum, ["1,A,Vase,1.6,0.2,0.2", *ROWS[1:]], site="site")
    summary, record = night(museum)
    one, two, three = (s.doubts for s in record.decisions)
    assert one[0] == "its record has changed: height_m"
    assert any(text.startswith("Tipping, level test: utilisation ") for text in one)
    assert two == (f"the risk was accepted until {yesterday} only",)
    assert three == ()
    assert len(summary.doubted) == 2
    page = next((museum / "reports" / "latest").glob("a-*.html")).read_text(encoding="utf-8")
    assert "To be looked at again:" in page
    assert ">1</bdi>" in page[page.index('id="first"') : page.index('id="decided"')]
    edit(museum / "site" / "manifest.toml", "scale = 1.0", "scale = 1.05")
    _, record = night(museum)
    # 5 % more motion moves the plate by more than 10 %.
    assert record.decisions[2].doubts[0] == "the motion sine 1.5 Hz of level test has changed"
    assert record.decisions[2].doubts[1].startswith("Sliding, level test: utilisation ")


def test_each_doubt_by_itself(ran: Path) -> None:
    """Verdict and utilisation against the basis: 10 % more is not yet in doubt, 11 % is."""
    record = load_run(open_database(ran / "kouros.sqlite"))
    seen = found(record, "1")
    made = decide(
        opened(Path(shutil.copytree(ran, ran.parent / "doubts", symlinks=True))),
        Wish("1", KIND.ACCEPT, why="x", who="A"),
    )

    def doubts(*findings: Finding, decision: Decision = made, today: str = record.started[:10]) -> tuple[str, ...]:
        now = {"1": replace(seen, findings=findings)}
        at = Now(now, record.motions, {"1": made.digest}, lambda *_: (), today)
        return standing([decision], at)[0].doubts

    first, *rest = (replace(f, verdict=Verdict.FAIL, utilisation=2.0) for f in seen.findings)
    decision = replace(made, basis=tuple(replace(b, utilisation=2.0, verdict=Verdict.FAIL) for b in made.basis))
    assert doubts(first, *rest, decision=decision) == ()
    assert doubts(replace(first, utilisation=2.19), *rest, decision=decision) == ()
    assert doubts(replace(first, utilisation=2.21), *rest, decision=decision) == (
        f"{first.title}, level test: utilisation 2.00 then, 2.21 now",
    )
    eased = replace(
        decision, basis=tuple(replace(b, verdict=Verdict.PASS) for b in decision.basis[:1]) + decision.basis[1:]
    )
    assert doubts(first, *rest, decision=eased) == (f"{first.title}, level test: pass then, fail now",)
    assert doubts(*rest, decision=decision) == (f"{first.title}, level test: there is no such finding any more",)
    fewer = replace(decision, basis=decision.basis[1:])
    assert doubts(first, *rest, decision=fewer) == (f"{first.title}, level test: fail now, and was not looked at then",)
    gone = replace(decision, kind=KIND.CLASS, object_class="galleon")
    assert doubts(first, *rest, decision=gone) == ("there is no class galleon any more, so that it is not used",)


def test_in_force_is_what_was_said_last_and_not_withdrawn() -> None:
    def row(number: int, kind: DecisionKind = KIND.ACCEPT, **more: object) -> Decision:
        return replace(Decision(number, "1", kind, "A", "2031-05-01", "x", ""), **more)  # type: ignore[arg-type]

    log = [row(1), row(2, model="standing"), row(3), row(4, KIND.CLASS), row(5, KIND.CLASS)]
    assert [d.id for d in in_force(log)] == [2, 3, 5]
    # What was replaced is not brought back.
    assert [d.id for d in in_force([*log, row(6, KIND.WITHDRAW, withdraws=3)])] == [2, 5]


def command(folder: Path, *words: str) -> Result:
    return CliRunner().invoke(kouros, ["--config", str(folder / "kouros.toml"), "decide", *words])


def test_the_command_writes_lists_and_withdraws(museum: Path) -> None:
    more = ("--why", HOSTILE, "--who", "A\x1b[31m")
    done = command(museum, "1", "installed", "clearance", "clearance_m=0.1", *more)
    assert done.exit_code == 0, done.output
    assert "installed clearance (clearance 0.1 m)" in done.output
    assert "\x1b" not in done.output
    assert "\u202e" not in done.output
    assert "the next run takes it into account" in done.output
    rows = json.loads(command(museum, "--list", "--json").output)
    assert [row["why"] for row in rows] == [HOSTILE]
    for row in rows:
        jsonschema.validate(row, decision_schema(), cls=jsonschema.Draft202012Validator)
    assert command(museum, "1", "withdraw", "1", "--why", "error", "--who", "A").exit_code == 0
    assert command(museum, "--list", "1").output == "no decision\n"
    assert len(command(museum, "--list", "1", "--log").output.splitlines()) == 2
    noted = command(museum, "3", "accept", "--model", "standing", "--why", "x", "--who", "A")
    assert "found nothing to accept there" in noted.output
    for words in ((), ("1",), ("1", "accept", "--list"), ("1", "adore", "--why", "x")):
        assert command(museum, *words).exit_code == 2, words


def test_hostile_words_reach_the_page_as_text(museum: Path) -> None:
    number = HOSTILE[:25]
    say(museum, number, KIND.ACCEPT, why=HOSTILE, who=HOSTILE)
    say(museum, number, KIND.INSTALLED, "clearance", "clearance_m=0.1", f"product={HOSTILE}", who=HOSTILE)
    workspace(museum, ROWS[:3], site="site")
    edit(museum / "kouros.toml", "shrink_limit = 0.2", "shrink_limit = 0.9")
    night(museum)
    pages = {p.name: p.read_text(encoding="utf-8") for p in (museum / "reports" / "latest").resolve().glob("*.html")}
    assert "&lt;script&gt;alert(1)&lt;/script&gt;&#34;&#39;&amp;{{7*7}}" in pages["index.html"]
    assert "the object is no longer in the inventory" in pages["index.html"]
    # A gallery has one script of its own, to sort and filter; none comes from what people wrote.
    assert all(page.count("<script") <= 1 and "<script>alert" not in page for page in pages.values())


SPRINGS = "generic 0.5 Hz, friction 0.05"


def test_an_isolator_is_installed_by_its_name_in_the_catalogue(museum: Path) -> None:
    """The numbers are those of the row of isolators.csv; its stroke is as long as its place allows, so it is said."""
    row = next(r for r in table("isolators") if r["name"] == SPRINGS)
    made = say(museum, "1", KIND.INSTALLED, "horizontal_isolator", f"isolator={SPRINGS}", "stroke_m=0.9")
    own = {name: float(row[name]) for name in ("frequency", "damping", "friction")}
    assert made.parameters == {**own, "stroke": 0.9}
    assert made.product == SPRINGS
    assert SPRINGS in made.matter


def test_a_museums_own_isolator_has_its_own_stroke(museum: Path) -> None:
    """Of its 25 cm a place may give less, not more; nothing else of the maker's can be said otherwise."""
    text = "name,kind,frequency,damping,friction,stroke,source\nOurs,horizontal_isolator,0.45,0.05,0.08,0.25,maker\n"
    (museum / "ours.csv").write_text(text, encoding="utf-8")
    edit(museum / "kouros.toml", 'catalogue = ""', 'catalogue = "ours.csv"')
    whole = say(museum, "1", KIND.INSTALLED, "horizontal_isolator", "isolator=Ours")
    assert whole.parameters == {"frequency": 0.45, "damping": 0.05, "friction": 0.08, "stroke": 0.25}
    less = say(museum, "1", KIND.INSTALLED, "horizontal_isolator", "isolator=Ours", "stroke_m=0.2", "product=No. 4")
    assert (less.parameters["stroke"], less.product) == (0.2, "No. 4")
    for words, message in (
        (["stroke_m=0.3"], "stroke_m=0.3, but 'Ours' has 0.25 in the catalogue: leave it out"),
        (["friction=0.1"], "friction=0.1, but 'Ours' has 0.08 in the catalogue"),
    ):
        with pytest.raises(UsageError, match=message):
            say(museum, "1", KIND.INSTALLED, "horizontal_isolator", "isolator=Ours", *words)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["horizontal_isolator", "isolator=generic 0.5 Hz friction 0.05"], "did you mean 'generic 0.5 Hz, friction 0."),
        (["horizontal_isolator", f"isolator={HOSTILE}"], "it has 'generic 0.35 Hz, friction 0.05', "),
        (
            ["horizontal_isolator", "isolator=generic low-friction pad"],
            "is a friction_isolator, not a horizontal_isolator",
        ),
        (["horizontal_isolator", f"isolator={SPRINGS}"], "horizontal_isolator needs stroke_m"),
        (["clearance", f"isolator={SPRINGS}"], "no parameter of clearance 'isolator'; use one of clearance_m, product"),
        (["clearance", "clearance_m=0.1", "clearance_m=0.2"], "clearance_m is said twice; say it once"),
        (["fasten", f"product={'n' * 201}"], "product has 201 characters; at most 200 are kept"),
    ],
)
def test_an_isolator_that_cannot_be_is_refused(museum: Path, words: list[str], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        say(museum, "1", KIND.INSTALLED, *words)
    assert listed(opened(museum)) == []


def test_what_is_fastened_to_an_isolator_stays_on_it() -> None:
    """A measure on an object that stands on an isolator changes the object; the isolator moves as before."""
    vase = classify(Item("1", "G", object_name="vase", height_m=0.4, width_m=0.2, depth_m=0.2, mass_kg=3.0))
    springs = InstalledMeasure(
        "horizontal_isolator", {"frequency": 0.5, "damping": 0.02, "friction": 0.05, "stroke": 0.3}, "decided by Ann"
    )
    room = InstalledMeasure("clearance", {"clearance": 0.123}, "decided by Ann")
    stands = placed(vase, [springs, InstalledMeasure("fasten", {}, "decided by Ann"), room])
    assert stands.scene.support is Support.ISOLATED
    assert stands.scene.parameters == placed(vase, [springs]).scene.parameters
    assert stands.above is not None
    assert stands.above.support is Support.FASTENED
    assert stands.above.parameters["clearance"].value == 0.123
    pad = InstalledMeasure("friction_isolator", {"friction": 0.05, "clearance": 0.3}, "decided by Ann")
    other = placed(vase, [springs, pad])
    assert other.isolator == "friction_isolator"
    assert other.above is not None
    assert other.above.support is Support.FREESTANDING


def test_no_end_of_a_utilisation_is_written_as_a_number(ran: Path) -> None:
    """Where contact is lost the utilisation is endless: a reader sees the sign for it, and no word of a program."""
    record = load_run(open_database(ran / "kouros.sqlite"))
    seen = found(record, "1")
    basis = tuple(
        Basis(
            f.model, f.title, f.level, f.demand, f.capacity, f.unit, f.utilisation, f.verdict, f.motion, f.motion_hash
        )
        for f in seen.findings
    )
    worse = replace(seen, findings=tuple(replace(f, utilisation=float("inf")) for f in seen.findings))
    decision = Decision(1, "1", KIND.ACCEPT, "Ann", "2031-05-01", "because", "", digest="d", basis=basis)
    at = Now({"1": worse}, record.motions, {"1": "d"}, lambda _n, _d: (), "2031-05-02")
    ((only,),) = (standing([decision], at),)
    assert any(text.endswith(" then, ∞ now") for text in only.doubts)
    assert not any("inf" in text for text in only.doubts)
