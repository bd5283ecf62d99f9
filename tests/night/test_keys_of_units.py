"""What is done again after a change of each input: which objects are assessed, which are classed, which pages drawn."""

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from random import Random

import pytest
from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo

from pipeline import resources
from pipeline.night import publication, scheduler
from pipeline.night.context import RunContext
from pipeline.night.publication import PageTask, Rendered
from pipeline.night.run import run
from pipeline.night.unit_tasks import Assessments, UnitTask
from pipeline.operations.workspace import UsageError, open_workspace
from pipeline.records import DecisionKind
from pipeline.tools.decisions import Wish, decide
from tests.museum import SILENT
from tests.night.changing import FRICTION, FURNITURE, ISOLATORS, RULES, Changing, leave_out_pages, measures, vessels
from tests.soak import soaked


@dataclass
class Done:
    """What a night did: units assessed, units only classed, pages drawn."""

    assessed: int = 0
    classed: int = 0
    drawn: int = 0

    def numbers(self) -> tuple[int, int, int]:
        return self.assessed, self.classed, self.drawn


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> Done:
    """What was done since; pages, which nothing here looks at, are left out."""
    return counted(monkeypatch)


def counted(patch: pytest.MonkeyPatch) -> Done:
    made, assess, render = Done(), scheduler.assess_units, publication.render_page

    def assessing(context: RunContext, task: UnitTask) -> Assessments:
        if task.assessed:
            made.assessed += len(task.keys)
        else:
            made.classed += len(task.keys)
        return assess(context, task)

    def rendering(context: RunContext, task: PageTask) -> Rendered:
        made.drawn += 1
        return render(context, task)

    patch.setattr(scheduler, "assess_units", assessing)
    patch.setattr(publication, "render_page", rendering)
    leave_out_pages(patch)
    return made


def alike_in_no_way(museum: Changing) -> None:
    """15 objects of which none is like another: 4 in each of three galleries, two of them in a case, and 3 stored."""
    museum.rows = []
    for n in range(15):
        gallery = "ABC"[n % 3]
        row = museum.object() | {"title": f"No. {n}", "gallery": gallery, "case": "", "height_m": f"{0.1 + n / 100}"}
        row |= {"on_display": "no" if n >= 12 else "yes", "case": "I" if n in (3, 6) else ""}
        row |= {"position_x_m": f"{n}" if gallery == "A" else "", "position_y_m": "0" if gallery == "A" else ""}
        museum.rows.append(row)
    museum.tables = {
        "rules.csv": RULES.format("bust", "vase"), "measures.csv": measures(0.2), "classes.csv": vessels(0.2),
        "isolators.csv": ISOLATORS.format(0.1), "friction.csv": FRICTION.format(0.2),
        "furniture.csv": FURNITURE.format(6),
    }  # fmt: skip
    for name in ("rules", "measures", "friction", "furniture"):
        museum.set(name, f'"{name}.csv"')
    museum.set("catalogue", '"isolators.csv"')


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Changing, Done]:
    """A museum after its first night, and what that did; it is only copied."""
    museum = Changing.of(tmp_path_factory.mktemp("keys") / "museum", 1)
    alike_in_no_way(museum)
    mapping = Path(resources.__file__).parent / "collection/presets/kouros.toml"
    shutil.copy(mapping, museum.home / "mapping.toml")
    museum.set("mapping", '"mapping.toml"')
    # What is counted here is what is asked for, not what it says.
    museum.set("samples", "0")
    with pytest.MonkeyPatch.context() as patch:
        made = counted(patch)
        museum.night()
    return museum, made


@pytest.fixture
def museum(first: tuple[Changing, Done], tmp_path: Path) -> Changing:
    """A copy of the museum after its first night."""
    made = first[0]
    home = Path(shutil.copytree(made.home, tmp_path / "museum", symlinks=True))
    values = {group: dict(some) for group, some in made.values.items()}
    rows = [dict(row) for row in made.rows]
    return Changing(home, Random(1), rows, values=values, tables=dict(made.tables), imports=list(made.imports))


def test_a_first_night_does_everything(first: tuple[Changing, Done]) -> None:
    # 12 on display, of which two in a case are one; pages of three galleries, and one of what is stored.
    assert first[1].numbers() == (11, 3, 4)


NOTHING, PAGES, ALL, SHOWN = (0, 0, 0), (0, 0, 4), (11, 3, 4), (11, 0, 3)
SHAKEN = (11, 0, 4)
"""Every page says by which motions the run was."""


def rules(museum: Changing) -> None:
    museum.tables["rules.csv"] = RULES.format("figurine", "vase")


def limits(museum: Changing) -> None:
    museum.tables["measures.csv"] = measures(0.4)


def isolator(museum: Changing) -> None:
    museum.tables["isolators.csv"] = ISOLATORS.format(0.2)


def friction(museum: Changing) -> None:
    museum.tables["friction.csv"] = FRICTION.format(0.3)


def stiffer(museum: Changing) -> None:
    museum.tables["furniture.csv"] = FURNITURE.format(9)


def on_a_shelf(museum: Changing) -> None:
    museum.rows[1]["furniture"] = "shelf"


def loose_furniture(museum: Changing) -> None:
    museum.rows[1]["furniture_anchorage"] = "unanchored"


def wider_furniture(museum: Changing) -> None:
    """What furniture that is not fastened slides and rocks by is a part of its table."""
    header, row = FURNITURE.format(6).splitlines()
    body = "half_width,half_width_low,half_width_high,cg_height,cg_height_low,cg_height_high,friction,friction_low,"
    body += "friction_high,shelf_height"
    museum.tables["furniture.csv"] = f"{header},{body}\n{row},0.4,0.4,0.4,0.8,0.8,0.8,0.3,0.3,0.3,1\n"


def another_name(museum: Changing) -> None:
    """The same rows in a file of another name, which reports give as their origin."""
    museum.tables["tilt.csv"] = museum.tables["friction.csv"]
    museum.set("friction", '"tilt.csv"')


def setting(name: str, value: str) -> Callable[[Changing], None]:
    def change(museum: Changing) -> None:
        museum.set(name, value)

    change.__name__ = f"{name}={value}"
    return change


def record(museum: Changing) -> None:
    """Another record of the same size and time of change: only its digest in the manifest tells."""
    file, manifest = museum.home / "site" / "motion-1.csv", museum.home / "manifest.txt"
    before, text = file.read_bytes(), file.read_text(encoding="utf-8")
    times = file.stat()
    assert text.count("\n0.10000000000000001, 3.8217") == 1
    file.write_text(text.replace("\n0.10000000000000001, 3.8217", "\n0.10000000000000001, 3.8216"), encoding="utf-8")
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))
    after = file.read_bytes()
    assert len(before) == len(after)
    assert before != after
    said = manifest.read_text(encoding="utf-8")
    assert sha256(before).hexdigest() in said
    manifest.write_text(said.replace(sha256(before).hexdigest(), sha256(after).hexdigest()), encoding="utf-8")


def scale(museum: Changing) -> None:
    museum.scale = 1.1


def v_max(museum: Changing) -> None:
    museum.v_max = 33.0


def height(museum: Changing) -> None:
    museum.rows[1]["height_m"] = "0.77"


def place(museum: Changing) -> None:
    museum.rows[0]["position_y_m"] = "0.3"


def value(museum: Changing) -> None:
    museum.rows[1]["value"] = "40000"


def loan(museum: Changing) -> None:
    museum.rows[1] |= {"value": "40000", "on_loan": "yes"}


def in_a_case(museum: Changing) -> None:
    museum.rows[3]["height_m"] = "0.77"


def off_display(museum: Changing) -> None:
    museum.rows[1]["on_display"] = "no"


def upstairs(museum: Changing) -> None:
    museum.upstairs = ["B"]


def house_rule(what: str, states: str) -> Callable[[Changing], None]:
    def change(museum: Changing) -> None:
        museum.house = f'[[house]]\n{what}\n{states}\nsaid_by = "Ann"\nsaid_on = 2031-05-01\n'

    change.__name__ = f"[[house]] {what} {states}"
    return change


def neither(museum: Changing) -> None:
    """All settings of which neither objects nor pages know: what they cost together, each costs at most."""
    for name, value in (
        ("time_zone", '"Europe/Rome"'), ("shrink_limit", "0.5"), ("workers", "2"), ("processes", "1"), ("keep", "4"),
        ("unused_days", "20.0"), ("reports", "4"), ("rows", "500"), ("mapping", '"kouros"'),
    ):  # fmt: skip
        museum.set(name, value)


def written_otherwise(museum: Changing) -> None:
    """The same records in another order, with columns and line ends of another export."""
    museum.rows.reverse()
    museum.columns.reverse()
    museum.newline = "\r\n"


def mapping(museum: Changing) -> None:
    """Depths are read as what they are in another unit."""
    file = museum.home / "mapping.toml"
    text = file.read_text(encoding="utf-8")
    lines = text.split("\n")
    at = next(n for n, line in enumerate(lines) if "[columns.depth_m]" in line)
    at = next(n for n in range(at, len(lines)) if 'unit = "m"' in lines[n])
    lines[at] = lines[at].replace('unit = "m"', 'unit = "ft"')
    file.write_text("\n".join(lines), encoding="utf-8")


def classed(museum: Changing) -> None:
    wish = Wish(museum.rows[1]["object_number"], DecisionKind.CLASS, ["statue"], "so it is", "Ann")
    decide(open_workspace(museum.settings), wish)


def accepted(museum: Changing) -> None:
    wish = Wish(museum.rows[1]["object_number"], DecisionKind.ACCEPT, [], "so it is", "Ann")
    decide(open_workspace(museum.settings), wish)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda _: None, NOTHING),
        (rules, ALL),
        pytest.param(limits, ALL, marks=soaked),
        pytest.param(isolator, ALL, marks=soaked),
        (friction, ALL),
        pytest.param(stiffer, ALL, marks=soaked),
        pytest.param(wider_furniture, ALL, marks=soaked),
        (another_name, ALL),
        pytest.param(setting("classes", '"classes.csv"'), ALL, marks=soaked),
        # A setting of each group.
        (setting("name", '"Another museum"'), PAGES),
        (setting("value_per_c", "500.0"), PAGES),
        (neither, NOTHING),
        (setting("azimuth_step", "30.0"), SHOWN),
        pytest.param(setting("fidelity", '"history"'), SHOWN, marks=soaked),
        pytest.param(setting("fragility", "true"), SHOWN, marks=soaked),
        (setting("stores", "true"), (3, 0, 1)),
        (setting("length", '"in"'), PAGES),
        (setting("survey", "true"), ALL),
        # Motions.
        (record, SHAKEN),
        (scale, SHAKEN),
        pytest.param(v_max, SHOWN, marks=soaked),
        # What is stored shares no page with what is stored on another floor.
        (upstairs, (4, 1, 5)),
        # Records.
        (height, (1, 0, 1)),
        (on_a_shelf, (1, 0, 1)),
        (loose_furniture, (1, 0, 1)),
        (in_a_case, (1, 0, 1)),
        # Where an object stands is its neighbours' business, and what it is worth that of its page.
        (place, (0, 0, 1)),
        (value, (0, 0, 1)),
        (loan, (0, 0, 1)),
        (off_display, (0, 1, 2)),
        (written_otherwise, NOTHING),
        pytest.param(mapping, ALL, marks=soaked),
        # House rules: what each comes to for an object alone, and what it matches in no other way.
        (house_rule('gallery = "B"', "clearance_m = 0.07"), (4, 1, 2)),
        (house_rule('number = "014"', "clearance_m = 0.07"), (1, 0, 1)),
        (house_rule('number = "014"', 'furniture = "pedestal"'), (1, 0, 1)),
        (house_rule('number = "014"', 'furniture_anchorage = "unanchored"'), (1, 0, 1)),
        (house_rule('medium = "ormolu"', "clearance_m = 0.07"), NOTHING),
        # Decisions.
        (classed, (1, 0, 1)),
        (accepted, (0, 0, 1)),
    ],
    ids=lambda given: getattr(given, "__name__", "").replace("<lambda>", "nothing") or None,
)
def test_what_a_change_costs(
    museum: Changing, done: Done, change: Callable[[Changing], None], expected: tuple[int, int, int]
) -> None:
    change(museum)
    museum.night()
    assert done.numbers() == expected


def test_an_own_table_that_is_not_there_ends_the_night_before_its_work(museum: Changing, done: Done) -> None:
    museum.set("friction", '"gone.csv"')
    museum.write()
    with pytest.raises(UsageError, match=r"gone\.csv is not there; \[tables\] friction names the file"):
        run(museum.settings, SILENT)
    assert done.numbers() == NOTHING


@pytest.fixture
def versions() -> Iterator[None]:
    """Digests of code and libraries are found anew, before and after."""
    for digest in (resources.code_version, resources.page_version):
        digest.cache_clear()
    yield
    for digest in (resources.code_version, resources.page_version):
        digest.cache_clear()


@pytest.mark.parametrize(
    ("library", "expected"), [("numpy", ALL), pytest.param("numba", ALL, marks=soaked), ("jinja2", PAGES)]
)
@pytest.mark.usefixtures("versions")
def test_what_another_version_of_a_library_costs(
    museum: Changing, done: Done, monkeypatch: pytest.MonkeyPatch, library: str, expected: tuple[int, int, int]
) -> None:
    true = resources._installed
    monkeypatch.setattr(resources, "_installed", lambda name: "999" if name == library else true(name))
    museum.night()
    assert done.numbers() == expected


@pytest.mark.usefixtures("versions")
def test_another_template_costs_pages_alone(museum: Changing, done: Done, monkeypatch: pytest.MonkeyPatch) -> None:
    true = resources.page_files
    monkeypatch.setattr(resources, "page_files", lambda: true()[:-1])
    museum.night()
    assert done.numbers() == PAGES


def test_another_catalogue_of_phrases_costs_pages_alone(museum: Changing, done: Done) -> None:
    museum.set("language", '"it"')
    museum.set("catalogues", '"phrases"')

    def phrase(said: str) -> None:
        catalogue = Catalog(locale="it")
        catalogue.add("Galleries", said)
        file = museum.home / "phrases" / "it" / "LC_MESSAGES" / "kouros.mo"
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as out:
            write_mo(out, catalogue)

    phrase("Gallerie")
    museum.night()
    assert done.numbers() == PAGES
    phrase("Sale")
    museum.night()
    assert done.numbers() == (0, 0, 8)


def test_a_second_house_rule_costs_its_own_objects_alone(museum: Changing, done: Done) -> None:
    """Wherever it stands in the file; and what rules come to is read of no record that they were asked about before."""
    house_rule('medium = "earthenware"', "friction = 0.31")(museum)
    museum.night()
    first, done.assessed = done.assessed, 0
    # Of 12 on display those of earthenware that stand, of which two share a case.
    assert 0 < first < 11
    before = museum.house
    house_rule('number = "014"', "clearance_m = 0.07")(museum)
    museum.house += before
    museum.night()
    assert done.assessed == 1
