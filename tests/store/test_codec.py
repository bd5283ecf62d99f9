"""What is kept in one column comes back equal and of the same type."""

import math
from datetime import date

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.records import Estimate, Origin
from pipeline.store import codec
from pipeline.store.codec import StoreError
from tests.store.run_samples import SETTINGS, TEXTS


@given(TEXTS | st.text(alphabet="\0\x1a01a", max_size=12))
def test_text_survives_without_nul(text: str) -> None:
    kept = codec.escape(text)
    assert "\0" not in kept
    assert codec.unescape(kept) == text


def test_ordinary_text_is_kept_as_it_is() -> None:
    assert codec.escape("Κοῦρος, 6th c. BC") == "Κοῦρος, 6th c. BC"


@given(SETTINGS)
def test_settings_survive(settings: dict[str, object]) -> None:
    # repr tells 1 from 1.0 and True, a tuple from a list, and 0.0 from -0.0, which == does not.
    assert repr(codec.settings_from_json(codec.settings_to_json(settings))) == repr(settings)


def test_settings_that_cannot_be_kept_are_named() -> None:
    with pytest.raises(StoreError, match=r"settings\.site\.approved\[1\] is a date"):
        codec.settings_to_json({"site": {"approved": ["x", date(2031, 5, 1)]}})
    with pytest.raises(StoreError, match=r"settings\.floors is a mapping whose keys are not text"):
        codec.settings_to_json({"floors": {1: "ground"}})


def test_floats_that_are_not_finite_are_strings_in_json() -> None:
    text = codec.to_json(Estimate, Estimate(math.nan, "m", Origin.ASSUMED, -math.inf, math.inf))
    assert '"value":"NaN"' in text
    back = codec.of_json(Estimate, text)
    assert math.isnan(back.value)
    assert (back.low, back.high) == (-math.inf, math.inf)


def test_damaged_text_is_refused() -> None:
    with pytest.raises(StoreError, match="changed by hand"):
        codec.of_json(Estimate, '{"value": "wide"}')
