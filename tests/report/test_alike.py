"""What objects share is put into words once: never taken for what is written otherwise, and never told of another."""

from dataclasses import fields, replace
from enum import Enum

import pytest

from pipeline.records import Finding
from pipeline.report.files.exports import FINDING_COLUMNS, FindingRows
from pipeline.report.pages.describe import Sayings
from pipeline.report.pages.notes import Memory, finding_key
from pipeline.report.units import Units

from . import builder

FINDING = next(f for a in builder.record().assessments for f in a.findings)


@pytest.mark.parametrize("name", [one.name for one in fields(Finding)])
def test_a_finding_is_known_by_all_that_is_said_of_it(name: str) -> None:
    """Every field counts but those that say of which object it is, and the mark, which is put on a chart for each."""
    value = getattr(FINDING, name)
    if isinstance(value, Enum):
        other: object = next(one for one in type(value) if one is not value)
    elif isinstance(value, float):
        other = value + 1.0
    else:
        other = ("another",) if isinstance(value, tuple) else "another"
    same = finding_key(replace(FINDING, **{name: other})) == finding_key(FINDING)  # type: ignore[arg-type]
    assert same == (name in {"object_number", "gallery", "mark"})


def test_zeros_of_either_sign_are_told_apart() -> None:
    """They are equal, and "-0.0" is written otherwise."""
    rows = FindingRows()
    zeros = [replace(FINDING, demand=zero, low=zero, utilisation=zero) for zero in (0.0, -0.0, 0.0)]
    lines = rows.of("run", zeros)[1].splitlines()
    assert lines[0] == lines[2] != lines[1]
    assert "-0.0" in lines[1]
    assert "-0.0" not in lines[0]


def test_rows_of_alike_findings_differ_by_their_objects_alone() -> None:
    """Row for row those of a memory that holds nothing yet, whatever quotation marks a number asks for."""
    numbers = ["1", 'a "b", c', "=2+2", "two\nlines", "1"]
    alike = [replace(FINDING, object_number=number, gallery=f"Room {number}") for number in numbers]
    rows, lines, objects = FindingRows().of("run", alike)
    each = [FindingRows().of("run", [one]) for one in alike]
    assert rows == [row for some, _, _ in each for row in some]
    assert lines == "".join(line for _, line, _ in each)
    assert objects == "".join(line for _, _, line in each)
    assert [row["object_number"] for row in rows] == numbers
    assert all(tuple(row) == FINDING_COLUMNS for row in rows)


def test_words_are_those_of_a_memory_that_holds_nothing_yet() -> None:
    record = builder.record()
    several, units = Sayings(record.motions, Units()), Units()
    for assessment in (*record.assessments, *record.assessments):
        for finding in assessment.findings:
            assert several.finding(finding) == Sayings(record.motions, units).finding(finding)
        for name, estimate in assessment.scene.parameters.items():
            assert several.number(name, estimate) == Sayings(record.motions, units).number(name, estimate)


def test_a_memory_holds_no_more_than_it_may() -> None:
    memory: Memory[str] = Memory(most=3)
    made = []

    def make(key: int) -> str:
        made.append(key)
        return str(key)

    for key in (1, 1, 2, 3, 1, 4, 1):
        assert memory.had(key, lambda key=key: make(key)) == str(key)  # type: ignore[misc]
    # The fourth does not fit beside three: it begins anew.
    assert made == [1, 2, 3, 4, 1]
