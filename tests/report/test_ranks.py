"""Ranks: their order is that of Python's own sort of the keys, and every row of every format has its own."""

import csv
import json
import time
from dataclasses import replace
from math import inf
from pathlib import Path
from random import Random

import jsonschema
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from lxml import html

from pipeline.cli.console import summary_lines
from pipeline.night.run import summarise
from pipeline.operations.run_summary import summary_document
from pipeline.planning.efforts import efforts
from pipeline.planning.plan import PlanTerms
from pipeline.records import Assessment, Brief, Found, Item, Likelihood, Urgency
from pipeline.records.likelihood import Sampling
from pipeline.report import render
from pipeline.report.files.concatenation import concatenate
from pipeline.report.files.exports import OBJECT_COLUMNS, RANK, part_of, schema_of, table_part
from pipeline.report.files.ranks import keys_part, ranks_of
from pipeline.report.pages.compose import PERIODS
from pipeline.report.pages.news_words import to_do
from pipeline.report.pages.tallies import tally, urgency
from pipeline.resources import resource
from pipeline.store.results import anonymous, encode
from tests.soak import SOAK

from . import builder


def _keys(count: int, seed: int = 1) -> list[Urgency | None]:
    """Keys with many ties in all but the number, a tenth of them of objects without a rank."""
    chance = Random(seed)
    losses, sizes = (-3.0, 0.0, 2.0, inf), (-1.0, -0.5, -inf)
    names = ("Vase", "vase", "Väse", "é", "\U0001f3fa", "", "a\nb", "\uffff")
    return [
        None
        if chance.random() < 0.1
        else (
            chance.randrange(4), chance.random() < 0.1, chance.random() < 0.1, chance.choice(losses),
            float(chance.randrange(3)), chance.choice(sizes), f"{chance.choice(names)}{at}", chance.choice(names),
        )
        for at in range(count)
    ]  # fmt: skip


def _parts(folder: Path, keys: list[Urgency | None], size: int) -> list[Path]:
    parts = []
    for start in range(0, len(keys), size):
        parts.append(folder / f"{start}.arrow")
        parts[-1].write_bytes(keys_part(keys[start : start + size]))
    return parts


@pytest.mark.parametrize("size", [1, 7, 3_000])
def test_ranks_are_places_in_the_sorted_list_of_those_that_have_one(size: int, tmp_path: Path) -> None:
    keys = _keys(1_000)
    ranked = sorted(key for key in keys if key is not None)
    place = {key: at for at, key in enumerate(ranked, start=1)}
    found = ranks_of(_parts(tmp_path, keys, size))
    assert [len(one) for one in found] == [min(size, 1_000 - start) for start in range(0, 1_000, size)]
    assert np.concatenate(found).tolist() == [0 if key is None else place[key] for key in keys]


def test_a_report_without_pages_has_no_ranks() -> None:
    assert ranks_of([]) == []


def test_the_ranks_of_half_a_million_take_seconds(tmp_path: Path) -> None:
    """2,500 pages of 200: it took 1.5 s on two cores; a minute would be a fault of kind, not of the machine.

    Every day a fifth of them, in a fifth of the time.
    """
    pages = 2_500 if SOAK else 500
    keys = _keys(200)
    named = [None if key is None else key for key in keys]
    for page in range(pages):
        mine = [None if key is None else (*key[:6], f"{page}.{key[6]}", key[7]) for key in named]
        (tmp_path / f"{page}.arrow").write_bytes(keys_part(mine))
    began = time.perf_counter()
    found = np.concatenate(ranks_of([tmp_path / f"{page}.arrow" for page in range(pages)]))
    assert time.perf_counter() - began < pages / 40.0
    given = pages * sum(key is not None for key in keys)
    assert sorted(found[found > 0].tolist()) == list(range(1, given + 1))


ODD = ("plain", 'a "quoted", one', "two\nlines", '"\n"', "\r\n", ',"', "", 'ends in "')
"""What a title may hold that a file of lines must not stumble over."""


def test_each_row_of_each_format_gets_the_rank_of_its_object(tmp_path: Path) -> None:
    """Titles with line ends and quotation marks in every place, read back by csv, json and pyarrow."""
    chance = Random(2)
    schema = pa.schema([field for field in schema_of("objects") if field.name != RANK])
    ranks, titles, parts = [], [], []
    for at, size in enumerate((3, 0, 8, 1)):
        own = [chance.choice(ODD) for _ in range(size)]
        titles += own
        ranks.append(np.array([chance.choice((0, 10 * at + n + 1)) for n in range(size)], dtype=np.int64))
        rows = [dict.fromkeys(schema.names) | {"object_number": str(n), "title": title} for n, title in enumerate(own)]
        parts.append(tmp_path / str(at))
        with Path(f"{parts[-1]}.csv").open("w", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, schema.names, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        Path(f"{parts[-1]}.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        Path(f"{parts[-1]}.arrow").write_bytes(table_part("objects", rows))
    for kind in ("csv", "jsonl", "parquet"):
        export = f"objects.{kind}"
        concatenate(tmp_path / export, [Path(f"{part}{Path(part_of(export)).suffix}") for part in parts], ranks)
    expected = [(title, rank or None) for title, rank in zip(titles, np.concatenate(ranks).tolist(), strict=True)]
    with (tmp_path / "objects.csv").open(encoding="utf-8", newline="") as stream:
        read = csv.DictReader(stream)
        assert [(row["title"], int(row["rank"]) if row["rank"] else None) for row in read] == expected
        assert tuple(read.fieldnames or ()) == OBJECT_COLUMNS
    lines = (tmp_path / "objects.jsonl").read_text(encoding="utf-8").splitlines()
    assert [(row["title"], row["rank"]) for row in map(json.loads, lines)] == expected
    table = pq.read_table(tmp_path / "objects.parquet")
    assert table.schema.equals(schema_of("objects"))
    assert list(zip(table["title"].to_pylist(), table["rank"].to_pylist(), strict=True)) == expected


def _likely(number: str, probability: float, measure: str = "", **item: object) -> Assessment:
    """An object that comes to harm with a probability, worth 1 where its class of value is C."""
    made = builder.rocking(replace(Item(number, "g", value_class="C"), **item), 1.2, "rocks")  # type: ignore[arg-type]
    advice = tuple(replace(r, measure=measure or r.measure) for r in made.recommendations)
    found = Likelihood("design", probability, 0.01, 512, Sampling().band(probability), "rocks", {"rocks": probability})
    return replace(made, likelihoods=(found,), recommendations=advice)


def test_the_rank_is_the_order_of_the_first_page_and_that_of_what_is_lost(tmp_path: Path) -> None:
    """Losses of 0.9 in every case but one; within a hundredth of each other the easier measure comes first.

    putty is order 33 and fasten 40 of measures.csv; of class B 0.4 is 1.2 of C.  A pillar 0.9 m high and 0.1 m deep is
    9 times as high as deep, and to be looked at first: it comes after all others on which something is to be done.
    """
    objects = (
        _likely("4", 0.8, "putty"),
        _likely("2", 0.9000, "putty"),
        _likely("3", 0.9001, "fasten"),
        _likely("5", 0.99, height_m=0.9, width_m=0.1, depth_m=0.1),
        _likely("1", 0.4, "fasten", value_class="B"),
        _likely("6", 0.05),
        replace(_likely("7", 0.9), aside=True, findings=(), likelihoods=()),
    )
    stored = objects[-1]
    objects = (*objects[:-1], replace(stored, scene=replace(stored.scene, item=Item("7", "g", on_display=False))))
    page = render(replace(builder.record(), assessments=objects, decisions=()), tmp_path / "report")
    with page.with_name("objects.csv").open(encoding="utf-8", newline="") as stream:
        ranks = {row["object_number"]: row["rank"] for row in csv.DictReader(stream)}
    assert ranks == {str(n): str(n) for n in range(1, 7)} | {"7": ""}
    first = html.parse(page).xpath("//table[@class='urgent rows']/tbody/tr/th//text()")
    shown = [text.strip() for text in first if text.strip() in ranks]
    assert shown == sorted(shown, key=lambda number: int(ranks[number]))
    assert shown == ["1", "2", "3", "4"]
    check = html.parse(page).xpath("//section[@aria-labelledby='check']")[0]
    assert [text for text in check.xpath(".//li/a//text()") if text.strip() in ranks] == ["5"]
    assert "1 object to act on can hardly stand as it is recorded" in check.text_content()


def test_what_can_hardly_stand_is_to_be_checked_first_whatever_page_names_it(tmp_path: Path) -> None:
    """The list of the gallery, the plan, the exports and the news; what stands as recorded is told its measure."""
    doubted, sound = _likely("5", 0.9, height_m=0.9, width_m=0.1, depth_m=0.1), _likely("6", 0.9, height_m=0.3)
    head = replace(builder.record(), assessments=(doubted, sound), decisions=())
    folder = render(head, tmp_path / "report", terms=PlanTerms(efforts())).parent
    with (folder / "objects.csv").open(encoding="utf-8", newline="") as stream:
        flags = {row["object_number"]: row["check_sizes"] for row in csv.DictReader(stream)}
    assert flags == {"5": "true", "6": "false"}
    with (folder / "plan.csv").open(encoding="utf-8", newline="") as stream:
        titles = {row["objects"]: row["title"] for row in csv.DictReader(stream)}
    title = sound.recommendations[0].title
    assert titles == {"5": f"Check the sizes first, then: {title}", "6": title}
    plan = html.parse(folder / "plan.html").xpath("string(//main)")
    assert f"Check the sizes first, then: {title}" in plan
    (gallery,) = [file for file in folder.glob("g-*.html") if "-sheet" not in file.name]
    assert "Check its sizes first" in html.parse(gallery).xpath("string(//main)")
    briefs = [json.loads(encode("k", [anonymous(one, {}, None)]).outline)[0][-1] for one in (doubted, sound)]
    assert [to_do(Brief(**brief)) for brief in briefs] == ["check its sizes first", "fasten it"]


def test_the_list_of_records_to_check_is_bounded_and_counts_all(tmp_path: Path) -> None:
    objects = tuple(_likely(f"{n:02d}", 0.9, height_m=0.9, width_m=0.1, depth_m=0.1) for n in range(30))
    page = render(replace(builder.record(), assessments=objects, decisions=()), tmp_path / "report")
    (check,) = html.parse(page).xpath("//section[@aria-labelledby='check']")
    assert len(check.xpath(".//li")) == 8
    assert "30 objects to act on can hardly stand" in check.text_content()
    assert "and 22 more" in check.text_content()
    assert not html.parse(page).xpath("//section[@aria-labelledby='first']")


def _at_two_levels(number: str, frequent: float, rare: float) -> Assessment:
    """An object with a finding and a probability at each of two levels."""
    made = _likely(number, rare)
    finding, (found,) = made.findings[0], made.likelihoods
    levels = (("frequent", frequent), ("<i>rare</i>", rare))
    return replace(
        made,
        findings=tuple(replace(finding, level=name) for name, _ in levels),
        likelihoods=tuple(replace(found, level=n, probability=p, band=Sampling().band(p)) for n, p in levels),
    )


def test_results_are_counted_by_level_and_the_state_is_that_where_harm_is_likeliest(tmp_path: Path) -> None:
    """Act from 0.1 on, watch from 0.01 on, fine below; each level by itself, and the worse of both for the object."""
    objects = (
        _at_two_levels("1", 0.2, 0.9),
        _at_two_levels("2", 0.05, 0.5),
        _at_two_levels("3", 0.001, 0.3),
        _at_two_levels("4", 0.001, 0.02),
        builder.unknown(Item("5", "g")),
    )
    totals = tally(Found(objects, None, ()))
    assert totals.levels == {"frequent": {"act": 1, "watch": 1, "fine": 2}, "<i>rare</i>": {"act": 3, "watch": 1}}
    assert totals.states == {"act": 3, "watch": 1, "unknown": 1, "fine": 0}
    head = replace(builder.record(), assessments=(), decisions=())
    head = replace(head, settings={**head.settings, PERIODS: {"frequent": 73.0, "<i>rare</i>": 2475.0}})
    page = render(replace(head, assessments=objects), tmp_path / "report")
    rows = html.parse(page).xpath("//section[@aria-labelledby='levels']//tbody/tr")
    assert [[cell.text_content().strip() for cell in row] for row in rows] == [
        ["frequent", "73 years", "1", "1", "2"],
        ["<i>rare</i>", "2,475 years", "3", "1", "0"],
    ]
    summary = summarise(head, (), totals)
    assert [tuple(level.values()) for level in summary.levels] == [
        ("frequent", 73.0, 1, 1, 2),
        ("<i>rare</i>", 2475.0, 3, 1, 0),
    ]
    assert "    frequent: 1 to act on, 1 to watch, 2 fine" in summary_lines(summary)
    schema = json.loads(resource("schemas", "run-summary.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(summary_document(summary), schema)


def test_of_a_single_level_the_summary_counts_the_objects_themselves() -> None:
    head = replace(builder.record(), assessments=(), decisions=())
    head = replace(head, settings={**head.settings, PERIODS: {"design": None}})
    totals = tally(Found((_likely("1", 0.9), _likely("2", 0.05), _likely("3", 0.001)), None, ()))
    assert totals.levels == {}
    assert summarise(head, (), totals).levels == [
        {"name": "design", "return_period_years": None, "act": 1, "watch": 1, "fine": 1}
    ]


def test_what_people_settled_comes_after_what_nobody_looked_at_and_before_what_is_to_be_watched() -> None:
    assert urgency(_likely("1", 0.9)) < urgency(_likely("0", 0.95), settled=True) < urgency(_likely("2", 0.05))


def test_a_loss_beyond_all_numbers_is_the_most_urgent() -> None:
    usual = _likely("1", 0.9)
    scene = usual.scene
    beyond = replace(usual, scene=replace(scene, item=replace(scene.item, value=float("inf"))))
    assert urgency(beyond) < urgency(usual)
