"""Of what objects stand on it is told from where that is known: counted on the first page, named in the exports."""

import csv
import json
from collections import Counter
from pathlib import Path

import pyarrow.parquet as pq
from lxml import html

from pipeline.records import Origin
from pipeline.report.pages.scene_words import furniture_known
from pipeline.settings import load_settings
from tests.museum import museum_of, night, vases

RULE = '\n[[house]]\ngallery = "Room 1"\nfurniture = "shelf"\nsaid_by = "Ann"\nsaid_on = 2031-05-01\n'


def test_a_night_counts_where_it_is_known_from_what_objects_stand_on(tmp_path: Path) -> None:
    """Six vases: one by its record, which a rule does not overrule, one by that rule, four by what is usual."""
    rows = vases(3, 2)
    rows[2]["furniture"] = "pedestal"
    museum_of(tmp_path / "museum", rows, furnished=True)
    file = tmp_path / "museum" / "kouros.toml"
    file.write_text(file.read_text(encoding="utf-8") + RULE, encoding="utf-8")
    summary = night(load_settings(file))
    assert summary.report is not None
    told = json.loads(summary.report.with_name("summary.json").read_text(encoding="utf-8"))
    assert told["stands_by"] == {"measured": 1, "stated": 1, "assumed": 4}
    words = " ".join(html.parse(str(summary.report)).getroot().find(".//main").text_content().split())
    line = "What objects stand on: 1 by their record, 1 by a house rule, 4 by what is usual for their class"
    assert line in words
    with summary.report.with_name("objects.csv").open(encoding="utf-8", newline="") as stream:
        objects = {row["object_number"]: (row["furniture"], row["furniture_origin"]) for row in csv.DictReader(stream)}
    assert (objects["1.0"], objects["1.1"]) == (("pedestal", "measured"), ("shelf", "stated"))
    assert Counter(origin for _, origin in objects.values()) == told["stands_by"]
    columns = pq.read_table(summary.report.with_name("objects.parquet")).to_pydict()
    assert list(zip(columns["furniture"], columns["furniture_origin"], strict=True)) == list(objects.values())


def test_the_line_names_what_there_is_and_nothing_else() -> None:
    assert furniture_known({}) == ""
    assert furniture_known({Origin.ASSUMED: 1234, Origin.DERIVED: 2}).replace("\u202f", ",") == (
        "2 by the case that their record names, 1,234 by what is usual for their class"
    )
