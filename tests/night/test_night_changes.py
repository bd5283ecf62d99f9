"""Nights of a small museum with one thing changed at a time: each verdict that moves says why, on both databases."""

from collections.abc import Iterator
from pathlib import Path
from uuid import uuid4

import pytest
from sqlalchemy import create_engine, make_url, text

from pipeline.analysis import scene_parameters
from pipeline.cli.differing import plain_changes
from pipeline.collection.database import database_url
from pipeline.night import prepare, units
from pipeline.night.run import run
from pipeline.operations.workspace import open_workspace
from pipeline.records import CauseKind, DecisionKind, Estimate, Origin, RunChanges, Verdict
from pipeline.settings import DATABASE_VARIABLE, Settings, load_settings
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.rerender import compare
from tests.museum import SILENT, edit, kouros, short_site, workspace
from tests.night.changing import leave_out_pages, vessels
from tests.soak import soaked

pytestmark = pytest.mark.slow_file

ROWS = ["1,A,Vase,1.2,0.2,0.2", "2,B,Vase,1.2,0.2,0.2", "3,B,Plate,0.03,0.3,0.3"]
OWN = "rule,class,aat,classification,words,medium,shape,why\nours,bust,,,vase,,,our vases are busts\n"
FLOOR = '\n[[floor]]\nname = "2"\nheight_ratio = 0.5\nperiod_s = 0.4\n'


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=soaked)])
def database(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A database of the test's own: the museum's file, or one on the server."""
    monkeypatch.delenv(DATABASE_VARIABLE, raising=False)
    if request.param == "sqlite":
        yield "sqlite"
        return
    server = database_url(make_url(request.getfixturevalue("postgresql_url")).render_as_string(False))
    name = f"nights_{uuid4().hex}"
    administrator = create_engine(server, isolation_level="AUTOCOMMIT")
    with administrator.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name}"))
    monkeypatch.setenv(DATABASE_VARIABLE, server.set(database=name).render_as_string(False))
    yield "postgresql"
    with administrator.connect() as connection:
        connection.execute(text(f"DROP DATABASE {name} WITH (FORCE)"))
    administrator.dispose()


def museum(folder: Path, rows: list[str] | None = None) -> Settings:
    return workspace(folder, rows or ROWS, site="site", furnished=True)


def night(folder: Path) -> RunChanges:
    """Run a night and return what changed since the one before."""
    changes = run(load_settings(folder / "kouros.toml"), SILENT).changes
    assert changes is not None
    return changes


def kinds(changes: RunChanges, number: str = "") -> set[tuple[CauseKind, ...]]:
    """The kinds of cause of the verdicts that changed, of one object or of all; there must be such verdicts."""
    moved = [v for v in changes.verdicts if number in ("", v.object_number)]
    assert moved
    return {tuple(dict.fromkeys(cause.kind for cause in v.causes)) for v in moved}


def settings_are_named(tmp_path: Path, toml: Path) -> None:
    """Of the museum's own tables: two nights for each, so that all is as before."""
    # Settings: the museum's own rules make busts of vases.
    (tmp_path / "own.csv").write_text(OWN, encoding="utf-8")
    edit(toml, 'rules = ""', 'rules = "own.csv"')
    changes = night(tmp_path)
    assert [f.name for f in changes.settings] == ["collection.rules"]
    assert {cause for v in changes.verdicts for cause in {c.kind for c in v.causes}} <= {CauseKind.SETTINGS}
    # A bust stands elsewhere than a vase does.
    assert [field.name for field in changes.inputs[0].fields[:2]] == ["scene.furniture", "scene.object_class"]
    edit(toml, 'rules = "own.csv"', 'rules = ""')
    night(tmp_path)

    # Settings: the museum knows better how much room its vessels have.
    (tmp_path / "own.csv").write_text(vessels(0.06), encoding="utf-8")
    edit(toml, 'classes = ""', 'classes = "own.csv"')
    changes = night(tmp_path)
    assert [f.name for f in changes.settings] == ["tables.classes"]
    assert {cause for v in changes.verdicts for cause in {c.kind for c in v.causes}} <= {CauseKind.SETTINGS}
    assert "parameters.clearance" in {field.name for field in changes.inputs[0].fields}
    edit(toml, 'classes = "own.csv"', 'classes = ""')
    night(tmp_path)


@pytest.mark.long("night/test_jobs::test_a_swapped_motion_moves_verdicts_and_is_named")
def test_each_cause_is_named(tmp_path: Path, database: str, monkeypatch: pytest.MonkeyPatch) -> None:
    manifest, toml = short_site(tmp_path), tmp_path / "kouros.toml"
    # What is compared are the records of nights: what their pages say of it is told in test_news.py.
    leave_out_pages(monkeypatch)
    run(museum(tmp_path), SILENT)

    # Nothing: nothing.
    assert not night(tmp_path)

    # Input: a low vase stands; only its own verdicts move.
    museum(tmp_path, ["1,A,Vase,0.03,0.2,0.2", *ROWS[1:]])
    changes = night(tmp_path)
    assert {v.object_number for v in changes.verdicts} == {"1"}
    assert kinds(changes) == {(CauseKind.INPUT,)}
    assert {cause.what for v in changes.verdicts for cause in v.causes} == {"height_m"}
    ((height, *_),) = (i.fields for i in changes.inputs)
    assert (height.name, height.before, height.after) == ("height_m", 1.2, 0.03)
    assert "standing" in {v.model for v in changes.fixed}

    # Motion: 3 % of it moves nothing.
    edit(manifest, "scale = 1.0", "scale = 0.03")
    changes = night(tmp_path)
    (motion,) = changes.motions
    assert kinds(changes) == {(CauseKind.MOTION,)}
    assert {cause.what for v in changes.verdicts for cause in v.causes} == {motion.name}
    assert not changes.worsened

    # Back again, and a higher vase besides: both are named for that vase, the motion for the others.
    edit(manifest, "scale = 0.03", "scale = 1.0")
    museum(tmp_path, ["1,A,Vase,0.5,0.2,0.2", *ROWS[1:]])
    changes = night(tmp_path)
    assert kinds(changes, "1") == {(CauseKind.INPUT, CauseKind.MOTION)}
    assert kinds(changes, "2") == {(CauseKind.MOTION,)}
    assert not changes.fixed

    if database == "sqlite":
        settings_are_named(tmp_path, toml)

    # Decision: room that is there now.
    open_ = open_workspace(load_settings(toml))
    made = decide(open_, Wish("2", DecisionKind.INSTALLED, ["clearance", "clearance_m=50"], "moved", "Ann"))
    changes = night(tmp_path)
    assert {v.object_number for v in changes.verdicts} == {"2"}
    assert kinds(changes) == {(CauseKind.DECISION,)}
    assert [(c.decision.id, c.new) for c in changes.decisions] == [(made.id, True)]
    decide(open_, Wish("2", DecisionKind.WITHDRAW, [str(made.id)], "moved back", "Ann"))
    changes = night(tmp_path)
    assert kinds(changes) == {(CauseKind.DECISION,)}
    assert [(c.decision.id, c.new) for c in changes.decisions] == [(made.id, False)]

    if database == "postgresql":
        return  # floors, moves and versions are told by the same comparison, which tests/store has on both

    # Floor: gallery A goes up to where it shakes more or less; the record's motion is the same.
    edit(manifest, "\n[[level]]", f"{FLOOR}\n[[level]]")
    edit(manifest, "scale = 1.0", "scale = 0.2")
    night(tmp_path)
    edit(toml, "[floors]", '[floors]\n"2" = ["A"]')
    changes = night(tmp_path)
    assert {v.object_number for v in changes.verdicts} == {"1"}
    assert kinds(changes) == {(CauseKind.FLOOR,)}
    assert {cause.what for v in changes.verdicts for cause in v.causes} == {"the ground -> 2"}

    # A gallery's object that moves to where it does not shake so: a move, and its floor.
    museum(tmp_path, ["1,B,Vase,0.5,0.2,0.2", *ROWS[1:]])
    changes = night(tmp_path)
    assert [(m.object_number, m.before, m.after) for m in changes.moved] == [("1", "A", "B")]
    assert not changes.inputs

    # Version: another Kouros assumes room for whatever slides; this one does not, and is not sure of it.
    monkeypatch.setattr(prepare, "__version__", "9.9")
    monkeypatch.setattr(prepare, "code_version", lambda: "another")
    monkeypatch.setattr(units, "code_version", lambda: "another")
    monkeypatch.setattr(
        scene_parameters, "clearance_of", lambda *_: Estimate(50.0, "m", Origin.ASSUMED, 50.0, 50.0, "room", "")
    )
    edit(manifest, "scale = 0.2", "scale = 1.0")
    night(tmp_path)
    monkeypatch.undo()
    changes = night(tmp_path)
    assert kinds(changes) == {(CauseKind.VERSION,)}
    assert {(v.model, v.before, v.after) for v in changes.verdicts} == {("sliding", Verdict.PASS, Verdict.UNDETERMINED)}
    assert {f.name for f in changes.versions} == {"Kouros", "code and tables"}


def test_the_order_is_stable_and_json_has_all(tmp_path: Path) -> None:
    short_site(tmp_path)
    settings = museum(tmp_path)
    run(settings, SILENT)
    museum(tmp_path, [*reversed(ROWS[1:]), "\U0001f3fa<b>,A,Vase,1.2,0.2,0.2", "4,A,Vase,1.2,0.2,0.2"])
    edit(tmp_path / "kouros.toml", "shrink_limit = 0.2", "shrink_limit = 0.9")
    edit(tmp_path / "site" / "manifest.toml", "scale = 1.0", "scale = 0.03")
    run(load_settings(tmp_path / "kouros.toml"), SILENT)
    once, again = compare(settings, None, None), compare(settings, None, None)
    assert once == again
    assert plain_changes(once) == plain_changes(again)
    assert [p.object_number for p in once.added] == ["4", "\U0001f3fa<b>"]
    assert [p.object_number for p in once.removed] == ["1"]
    keys = [(v.gallery, v.object_number, v.level, v.model) for v in once.verdicts]
    assert keys == sorted(keys)
    said = kouros("diff", folder=tmp_path).stdout
    assert "  fixed: 2 (B) standing, test: fail -> pass, because of motion" in said
