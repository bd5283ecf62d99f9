"""Records that travel between workers arrive as they were, small, and only those that are wanted."""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from pipeline.analysis.classify import classify
from pipeline.records import Assessment, Item
from pipeline.store import codec
from pipeline.store.codec import StoreError
from pipeline.store.parcels import Parcel

Known = tuple[Assessment, Mapping[str, int]]
VASE = Item("1", "Room", title="Vase \u2013 \u82b1\u74f6", object_name="vase", medium="earthenware", height_m=0.3)
KNOWN = {
    -(2**63) + n: (Assessment(classify(replace(VASE, height_m=0.1 + n / 7)), (), ()), {"rocking": n}) for n in range(40)
}


def test_what_arrives_is_what_was_sent() -> None:
    parcel = Parcel.of(Known, KNOWN)
    assert parcel.opened() == list(KNOWN.values())
    some = parcel.only({min(KNOWN), max(KNOWN), 17})
    assert some.opened() == [KNOWN[key] for key in some.records]
    assert set(some.records) == {min(KNOWN), max(KNOWN)}
    assert Parcel.of(Known, {}).opened() == []


def test_keys_may_share_a_record_which_travels_once() -> None:
    one = min(KNOWN)
    parcel = Parcel.of(Known, KNOWN, {5: one, 6: one, 7: 12_345})
    assert parcel.only({5, 6, one}).opened() == parcel.only({6}).opened() == [KNOWN[one]]
    assert parcel.only({7}).opened() == []
    assert parcel.opened() == list(KNOWN.values())


def test_like_records_are_small() -> None:
    """A tenth of their JSON: what they have in common is in the dictionary."""
    whole = sum(len(codec.to_json(Known, one)) for one in KNOWN.values())
    assert sum(map(len, Parcel.of(Known, KNOWN).records.values())) < 0.1 * whole


def test_damage_is_named() -> None:
    parcel = Parcel.of(Known, KNOWN)
    key = min(KNOWN)
    with pytest.raises(StoreError, match="arrived damaged"):
        replace(parcel, records={key: parcel.records[key][:-9]}).opened()
    with pytest.raises(StoreError, match="arrived damaged"):
        replace(parcel, dictionary=parcel.dictionary[1:]).opened()
