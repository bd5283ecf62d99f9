"""A night finds anew only what changed, says so, and shows what an undisturbed first night would show."""

import csv
import json
import shutil
from functools import partial
from pathlib import Path
from random import Random

import pytest
from lxml import html
from sqlalchemy import func, select, update

from pipeline.analysis import demands
from pipeline.collection.database import open_database
from pipeline.collection.listing import Listed, Listing, order
from pipeline.errors import DamageWarning
from pipeline.night import scheduler
from pipeline.night.run import run
from pipeline.night.units import MOST, STORED, paged
from pipeline.report.errors import ReportWarning
from pipeline.settings import DisplaySettings, Floors, Settings, load_settings
from pipeline.store.tables import RESULT
from tests.museum import SILENT, found, museum_of, night, vases, write_collection
from tests.soak import some

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_a_result_that_is_damaged_or_lost_is_found_again")


def results(settings: Settings) -> int:
    engine = open_database(settings.database)
    with engine.connect() as connection:
        return connection.execute(select(func.count()).select_from(RESULT)).scalar_one()


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """A museum after its first night."""
    made = museum_of(tmp_path_factory.mktemp("nights") / "museum", vases())
    assert night(made).fresh == 12
    return made


def test_an_unchanged_night_finds_nothing_anew_and_shows_the_same_files(tmp_path: Path) -> None:
    settings = museum_of(tmp_path / "museum", vases(), sampled=True)
    night(settings)
    before = settings.path("reports").joinpath("latest").resolve()
    summary = night(settings)
    assert summary.report is not None
    after = summary.report.parent
    assert (summary.fresh, results(settings)) == (0, 12)
    assert len(list(before.glob("room-*.html"))) == 3
    own = {
        "index.html",
        "news.html",
        "method.html",
        "motion.html",
        "summary.json",
        ".pages.json",
        "fragility_classes.csv",
    }
    curves = "fragility_classes.csv"  # a few lines, written every night: the same ones
    assert (before / curves).read_bytes() == (after / curves).read_bytes()
    names = {p.relative_to(before).as_posix() for p in before.rglob("*") if p.is_file()}
    # Pages, their parts, sheets to walk with, the exports with a workbook, what was read, the plan, the list of all.
    assert len(names - own) == 3 + 3 * 10 + 3 + 9 + 2 + 2 + 1
    for name in names - own:
        # The very same file, so that a large museum's unchanged night costs nothing.
        assert (before / name).samefile(after / name), name
    assert "Nothing has changed since" in (after / "index.html").read_text(encoding="utf-8")


def test_one_changed_object_costs_only_itself_and_the_rest_is_taken_over(settings: Settings, tmp_path: Path) -> None:
    objects = vases()
    objects[5]["height_m"] = "0.9"
    write_collection(settings.home, objects)
    summary = night(settings)
    assert summary.fresh == 1
    assert summary.changes is not None
    assert [change.object_number for change in summary.changes.inputs] == ["1.1"]
    # A first night of the same museum shows the same, row for row.
    again = museum_of(tmp_path / "again", objects)
    other = night(again)
    assert found(settings) == found(again)
    assert summary.report is not None
    assert other.report is not None
    for name in ("findings.csv", "objects.csv", "recommendations.csv"):
        with (summary.report.parent / name).open() as mine, (other.report.parent / name).open() as its:
            for one, same in zip(csv.DictReader(mine), csv.DictReader(its), strict=True):
                assert one | {"run": ""} == same | {"run": ""}
    write_collection(settings.home, vases())
    # What was found on the first night is still there.
    assert night(settings).fresh == 0


def test_a_changed_motion_is_named_and_all_is_found_anew(settings: Settings) -> None:
    manifest = settings.home / "site" / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.6"), encoding="utf-8")
    summary = night(settings)
    assert summary.fresh == 12
    assert summary.changes is not None
    assert len(summary.changes.motions) == 1
    manifest.write_text(text, encoding="utf-8")
    assert night(settings).fresh == 0


def test_a_result_that_is_there_is_taken_up_by_a_run_that_was_cut_off(settings: Settings, tmp_path: Path) -> None:
    """What a run stored before it died needs not be found again, and the report is that of an undisturbed night."""
    again = museum_of(tmp_path / "cut", vases())
    night(again)
    engine = open_database(again.database)
    with engine.begin() as connection:
        # As after a kill: neither the run nor its pages are there, eleven of its results are.
        connection.exec_driver_sql("DELETE FROM run")
        connection.exec_driver_sql("DELETE FROM page")
        connection.exec_driver_sql("DELETE FROM result WHERE key = (SELECT min(key) FROM result)")
    shutil.rmtree(again.path("reports"))
    summary = run(again, SILENT, resume=True)
    assert summary.fresh == 1
    assert found(again).assessments == found(settings).assessments


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(damage, marks=[] if at == 0 else LONG)
        for at, damage in enumerate(some([{"found": b"damaged"}, {"outline": "[]"}, {"made": "2000-01-01"}, None], 2))
    ],
)
def test_a_result_that_is_damaged_or_lost_is_found_again(damage: dict[str, object] | None, tmp_path: Path) -> None:
    """Noticed where it is read: when its page is drawn again."""
    made = museum_of(tmp_path / "damaged", vases(1, 4))
    night(made)
    before = found(made)
    engine = open_database(made.database)
    with engine.begin() as connection:
        one = connection.execute(select(func.min(RESULT.c.key))).scalar_one()
        row = RESULT.c.key == one
        connection.execute(RESULT.delete().where(row) if damage is None else update(RESULT).where(row).values(damage))
    shutil.rmtree(made.path("reports"))
    with pytest.warns(DamageWarning) as told:
        night(made)
    said = " ".join(str(one.message) for one in told)
    assert "holds no report, though 1 night of the whole collection ended well" in said
    assert ("1 result of the database changed since written" in said) is (damage is not None)
    assert found(made).assessments == before.assessments
    assert results(made) == 4
    assert night(made).fresh == 0


def listed(number: int, case: str = "", gallery: str = "Store") -> Listed:
    return Listed(f"S.{number:05d}", gallery, case, True, "", "")


def test_a_large_gallery_is_cut_by_count() -> None:
    everything = [listed(n) for n in range(2 * MOST + 1)]
    parts = paged(Listing.of(everything), Settings())
    assert [(part.number, part.of, len(part.objects)) for part in parts] == [(1, 3, MOST), (2, 3, MOST), (3, 3, 1)]
    assert [one for part in parts for one in part.objects] == everything


def test_a_case_is_never_cut() -> None:
    everything = [listed(n, case=f"case {n // 70:03d}") for n in range(3_000)]
    where: dict[str, set[int]] = {}
    for part in paged(Listing.of(everything), Settings()):
        for one in part.objects:
            where.setdefault(one.case, set()).add(part.number)
    assert all(len(numbers) == 1 for numbers in where.values())


def walked(members: list[Listed], most: int) -> list[list[Listed]]:
    """Cut one group as one would by hand, company by company."""
    companies: list[list[Listed]] = []
    for one in members:
        if companies and one.case and (one.gallery, one.case) == (companies[-1][0].gallery, companies[-1][0].case):
            companies[-1].append(one)
        else:
            companies.append([one])
    pieces: list[list[Listed]] = [[]]
    for company in companies:
        if pieces[-1] and len(pieces[-1]) + len(company) > most:
            pieces.append([])
        pieces[-1] += company
    return pieces


@pytest.mark.parametrize("seed", range(20))
def test_pages_are_cut_as_by_hand(seed: int) -> None:
    """Galleries of all sizes, on two floors, with cases of up to more than a page holds."""
    random = Random(seed)
    objects = []
    for n in range(random.choice([1, 40, 700])):
        case = random.choice(["", "", f"case {n // random.choice([3, 60])}"])
        one = listed(n, case, f"Room {random.randrange(3)}")
        objects.append(one._replace(on_display=random.random() < 0.5))
    objects.sort(key=order)
    settings = Settings(floors=Floors({"upper": ("Room 1",)}), display=DisplaySettings(stores=True))
    parts = paged(Listing.of(objects), settings, most=30, stored=7)
    groups: dict[tuple[bool, str], list[Listed]] = {}
    for one in objects:
        upper = "upper" if one.gallery == "Room 1" else ""
        groups.setdefault((not one.on_display, one.gallery if one.on_display else upper), []).append(one)
    by_hand = {group: walked(members, 7 if group[0] else 30) for group, members in groups.items()}
    expected = [piece for group in sorted(by_hand) for piece in by_hand[group]]
    assert [list(part.objects) for part in parts] == expected
    stored = sum(len(pieces) for (absent, _), pieces in by_hand.items() if absent)
    for part in parts:
        of = len(by_hand[False, part.gallery]) if part.on_display else stored
        assert (part.of, part.gallery != "") == (of, part.on_display)
        assert part.floor == ("upper" if any(one.gallery == "Room 1" for one in part.objects) else "")


def test_a_small_gallery_is_one_page_and_what_is_stored_shares_pages() -> None:
    stored = [listed(n, gallery=f"Store {n % 3}")._replace(on_display=False) for n in range(30)]
    parts = paged(Listing.of([listed(100), *sorted(stored, key=order)]), Settings())
    assert [(part.gallery, part.on_display, len(part.objects)) for part in parts] == [
        ("Store", True, 1),
        ("", False, 30),
    ]


def test_what_is_stored_is_cut_by_count_in_the_order_of_its_numbers() -> None:
    """As people count, whatever the place and the case."""
    numbers = [f"{year}.{n}" for year in (98, 1913, 2016) for n in range(1, 201)]
    stored = [Listed(number, f"Store {at % 3}", f"case {at % 7}", False, "", "") for at, number in enumerate(numbers)]
    parts = paged(Listing.of(sorted(stored, key=order)), Settings())
    assert [(part.number, part.of, len(part.objects)) for part in parts] == [
        (1, 3, STORED), (2, 3, STORED), (3, 3, len(numbers) - 2 * STORED)
    ]  # fmt: skip
    assert [one.object_number for part in parts for one in part.objects] == numbers


def test_the_pages_of_a_cut_gallery_lead_to_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut at 12 instead of 1,000 objects, so that the test is quick."""
    monkeypatch.setattr(scheduler, "paged", partial(paged, most=12))
    made = museum_of(tmp_path / "large", vases(galleries=1, each=30))
    summary = night(made)
    assert summary.report is not None
    folder = summary.report.parent
    pages = sorted(folder.glob("room-0-*.html"))
    assert len(pages) == 3
    index = (folder / "index.html").read_text(encoding="utf-8")
    galleries = html.fromstring(index.encode()).xpath("//section[@aria-labelledby='galleries']//tbody/tr")
    assert len(galleries) == 1
    for page in pages:
        assert f'href="{page.name}"' in index
        assert f"of {len(pages)} of this gallery" in page.read_text(encoding="utf-8")
    kept = json.loads((folder / ".pages.json").read_text(encoding="utf-8"))["report"]["pages"]
    assert sum(sum(page["entry"]["counts"].values()) for page in kept) == 30


def test_a_page_whose_report_was_tampered_with_is_drawn_again(settings: Settings) -> None:
    latest = settings.path("reports").joinpath("latest").resolve()
    (latest / ".pages.json").write_text("[{}]", encoding="utf-8")
    with pytest.warns(ReportWarning, match=r"\.pages\.json: is damaged"):
        summary = night(settings)
    assert (summary.fresh, summary.objects) == (0, 12)
    assert summary.report is not None
    assert len(list(summary.report.parent.glob("room-*.html"))) == 3


@pytest.mark.long("test_a_changed_motion_is_named_and_all_is_found_anew")
def test_one_changed_motion_runs_its_own_histories_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two motions one changes: no history of the other is run again, and a first night would find the same."""
    made = museum_of(tmp_path / "two", [{**vase, "furniture": "floor"} for vase in vases(1, 3)])
    file = made.home / "kouros.toml"
    file.write_text(file.read_text(encoding="utf-8").replace('fragility = "auto"', "fragility = false"), "utf-8")
    made = load_settings(file)
    manifest = made.home / "site" / "manifest.toml"
    head, record = manifest.read_text(encoding="utf-8").split("[[level.record]]")
    other = record.replace('name = "Ridgecrest', 'name = "weaker Ridgecrest')
    text = f"{head}[[level.record]]{record}[[level.record]]{other}"
    first, second = text.replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.5"), text
    manifest.write_text(first.replace("scale_to_pga_g = 0.5", "scale_to_pga_g = 0.7", 1), encoding="utf-8")
    ran: list[str] = []
    true = demands._run

    def noted(task: demands._RunTask) -> demands.Columns:
        ran.append(task[1].hash)
        return true(task)

    monkeypatch.setattr(demands, "_run", noted)
    assert night(made).fresh == 3
    before = {motion.name: motion.hash for motion in found(made).motions}
    assert set(ran) == set(before.values())
    ran.clear()
    manifest.write_text(
        second.replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.6", 2).replace(
            "scale_to_pga_g = 0.6", "scale_to_pga_g = 0.7", 1
        ),
        encoding="utf-8",
    )
    summary = night(made)
    after = {motion.name: motion.hash for motion in found(made).motions}
    changed = {name for name in before if before[name] != after[name]}
    assert len(changed) == 1
    assert summary.fresh == 3
    # What isolators pass on is run for its own sake: those are motions of their own.
    assert not {before[name] for name in before if name not in changed} & set(ran)
    assert after[changed.pop()] in ran
    again = Path(
        shutil.copytree(made.home, tmp_path / "again", ignore=shutil.ignore_patterns("*.sqlite", "reports", ".kouros*"))
    )
    fresh = load_settings(again / "kouros.toml")
    assert night(fresh).fresh == 3
    assert found(made).assessments == found(fresh).assessments
