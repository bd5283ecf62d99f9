"""The table of proportions: percentiles of what was measured, and how many of the sizes that were hidden it holds."""

import numpy as np
import pytest

from pipeline.records import Item
from pipeline.verification.proportion_fit import COLUMNS, LIKE, WIDER, inside, rows_of, sizes_by_class, tall_rows_of
from tests.museum import carnegie

WIDTHS = np.linspace(0.1, 0.3, 101)


def vases() -> list[Item]:
    """Vases of a metre, whose width over height is spread evenly: its percentiles are known."""
    return [
        Item(str(at), "G", title="Vase", classification="Ceramics", height_m=1.0, width_m=w, depth_m=w)
        for at, w in enumerate(WIDTHS.tolist())
    ]


def test_rows_are_the_percentiles_of_an_even_spread() -> None:
    sizes = sizes_by_class(vases())
    assert [*sizes] == ["vessel"]
    every = dict.fromkeys(
        row for row in ("framed", "relief", "small_flat", "mounted", "stemmed_glass", "bust", "statue")
    )
    every |= dict.fromkeys(("figurine", "dish", "lamp", "cabinet", "seat", "table", "model", "object"))
    rows = rows_of({**dict.fromkeys(every, sizes["vessel"]), **sizes}, "somewhere")
    assert all(tuple(row) == COLUMNS for row in rows)
    (wide,) = [r for r in rows if (r["class"], r["size"], r["of"]) == ("vessel", "width", "height")]
    # Even from 0.1 to 0.3: 5, 50 and 95 in a hundred of the way.
    assert [float(wide[end]) for end in ("low", "value", "high")] == pytest.approx([0.11, 0.20, 0.29])
    assert "101 records" in wide["source"]
    # Of few records those of a class that is built alike, wider by half.
    few = {(r["class"], r["size"], r["of"]): r for r in rows if r["class"] in LIKE}
    clock = few["clock", "width", "height"]
    assert [float(clock[end]) for end in ("low", "value", "high")] == pytest.approx(
        [0.11 / WIDER, 0.20, 0.29 * WIDER], rel=2e-3
    )
    assert clock["source"].startswith("judgement: 0 records only")
    # What lies lacks its thickness: the smallest size over the next, whichever it is.
    (thick,) = [r for r in rows if (r["class"], r["size"], r["of"]) == ("small_flat", "height", "width")]
    assert float(thick["value"]) == pytest.approx(1.0)


def test_what_is_tall_has_rows_of_its_own_where_there_are_enough_of_it() -> None:
    heights = np.r_[np.full(30, 0.2), np.full(25, 0.5), np.full(10, 2.0)]
    sizes = {"vessel": [(h, 0.4 * h if h > 0.3 else h, 0.3 * h) for h in heights.tolist()]}
    found = tall_rows_of(sizes, "somewhere")
    assert [(r["class"], r["size"], r["of"], r["above"], r["value"]) for r in found] == [
        ("vessel", "width", "height", "0.3", "0.4"), ("vessel", "depth", "height", "0.3", "0.3")
    ]  # fmt: skip
    assert all(tuple(row) == COLUMNS and "of 25 records from 0.3 to 1 m high" in row["source"] for row in found)


def test_hidden_sizes_of_the_demonstration_lie_within_nine_times_in_ten() -> None:
    """A part of the very records that the table was made of: 90 % by its percentiles, three standard errors apart.

    Sizes hidden from an object with two others are judged by the narrower of two ranges, and by no joint one.
    """
    found = inside(carnegie().items)
    tried, right = (sum(column) for column in zip(*found.values(), strict=True))
    assert tried > 2000
    assert right / tried == pytest.approx(0.9, abs=0.04)
