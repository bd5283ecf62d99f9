"""The cache: what was put is got bit for bit, no damage goes unnoticed, and one rule removes what nobody needs."""

import json
import os
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pipeline import cache
from pipeline.analysis.response_charts.charts import Histories
from pipeline.analysis.response_charts.response_chart import ChartCells, ResponseChart
from pipeline.cache import (
    CHARTS,
    DAY,
    HISTORIES,
    HOUSE,
    KINDS,
    MOTIONS,
    PICTURES,
    SAMPLES,
    SELF_TESTS,
    SPECTRA,
    STOCKS,
    THUMBNAILS,
    TRADEOFFS,
    Cache,
    CacheEntry,
    CacheWarning,
    key_of,
)
from pipeline.event.capacities import stock_of
from pipeline.images.album import Album
from pipeline.images.limits import ImageLimits
from pipeline.models import model_named
from pipeline.models.band import band_accelerations, sharing_spectra
from pipeline.motions import read_site
from pipeline.records import Assessment, Axis, Chart, Excitation, Item, Scene, Silent, Support
from pipeline.resources import resource
from pipeline.store import codec
from pipeline.verification import selftest, tradeoff
from pipeline.verification.outcome import Outcome
from tests.images.conftest import photograph

LASTING = {SELF_TESTS, TRADEOFFS, THUMBNAILS}


def put_motion(folder: Path) -> None:
    read_site(resource("site_motions", "demo"), kept=folder)


def put_chart(folder: Path) -> None:
    cells = ChartCells(
        edges=np.array([0.0, 0.5, 1.0]),
        values=np.linspace(0.0, 1.0, 28).reshape(2, 7, 2),
        bounds=np.full((2, 2), 1e-3),
        own=np.array([1e-9, np.nan]),
        note=np.array([0, 3]),
        resolved=np.array([True, False]),
        nodes=13,
    )
    axis = model_named("sliding").chart
    assert axis is not None
    chart = ResponseChart(axis, ("displacement", "residual"), 0.01, 1.0, np.inf, 1e-3, cells)
    Cache(folder).put(CHARTS, cache.key_of("a chart", group=64 * "a"), chart.kept())


def put_pictures(folder: Path) -> None:
    drawn = {"sliding:a": Chart("sliding:a", "Sliding", "0.25 m", Axis("f", "-"), Axis("d", "m"), ())}
    kept = CacheEntry({"pictures": codec.to_json(dict[str, Chart], drawn)})
    Cache(folder).put(PICTURES, cache.key_of("pictures", group=64 * "a"), kept)


def put_histories(folder: Path) -> None:
    histories = Histories(Cache(folder), "batch")
    values = {"friction_static": np.array([0.1, 0.2, np.nan])}
    histories.note("one", values, {"displacement": np.array([0.3, 0.4, 0.5]), "error": np.zeros(3)})
    histories.note("two", values, {"displacement": np.array([0.6, 0.7, 0.8])})
    histories.keep()


def put_spectra(folder: Path) -> None:
    motion = Excitation(0.01, np.sin(np.arange(200.0)), None, np.zeros(200), None)
    with sharing_spectra(Cache(folder)):
        band_accelerations(motion, np.array([2.0]), np.array([2.1]), np.array([0.05]))


def put_self_test(folder: Path) -> None:
    outcome = Outcome("a case", "its truth", None, 1e-9, False, 0.1, "ValueError: no")
    selftest.keep(selftest.SelfTest("2026-01-01T00:00:00+00:00", "0.1.0", "kernels", "a machine", [outcome]), folder)


def put_tradeoff(folder: Path) -> None:
    setting = tradeoff.Setting("sliding", "step", "history", "history", 1.0, 1e-6, 1e-5, 1e-4, 0)
    sample = tradeoff.Sample("sliding", 8, 8, 0, "the collection")
    tradeoff.keep(tradeoff.Tradeoff("2026-01-01", "kernels", ["noise"], [sample], [setting]), folder)


def put_house(folder: Path) -> None:
    effects = {"place": np.array([1, 2], np.uint64), "effect": np.array([0, 1])}
    Cache(folder).put(HOUSE, key_of("rules"), CacheEntry({"effects": ["", "one"]}, effects))


def put_thumbnails(folder: Path) -> None:
    (folder.parent / "a.png").write_bytes(photograph(kind="PNG"))
    Album(Cache(folder), ImageLimits(folder=folder.parent)).gather(["a.png"], Silent())


def put_sample(folder: Path) -> None:
    groups = {"sliding None []": ("sliding", None, {"tail": 30.0})}
    Cache(folder).put(SAMPLES, key_of("objects"), CacheEntry({"groups": groups, "models": ["sliding", "standing"]}))


def put_stock(folder: Path) -> None:
    scene = Scene(Item("1", "A"), "vase", "", Support.FREESTANDING, (), {})
    Cache(folder).put(STOCKS, key_of("a page"), stock_of([Assessment(scene, (), ())], {}).packed())


PUT: dict[str, Callable[[Path], None]] = {
    MOTIONS: put_motion,
    CHARTS: put_chart,
    PICTURES: put_pictures,
    HISTORIES: put_histories,
    SPECTRA: put_spectra,
    SELF_TESTS: put_self_test,
    TRADEOFFS: put_tradeoff,
    HOUSE: put_house,
    THUMBNAILS: put_thumbnails,
    STOCKS: put_stock,
    SAMPLES: put_sample,
}


def key_in(file: Path) -> str:
    return file.stem.partition("-")[2]


def get(file: Path) -> CacheEntry | None:
    kind = file.parent.name
    return Cache(file.parent.parent).get(kind, key_in(file), lasting=kind in LASTING)


def test_every_kind_is_tried_here() -> None:
    assert set(PUT) == set(KINDS)


def damages(good: bytes, other: bytes, rng: np.random.Generator) -> list[bytes]:
    """Return single damages: bits, digits, zeros, cuts, pieces of nothing, and another's content."""
    out = [b"", b"x", good[:-1], good + b"\0", good + good, bytes(len(good)), other, b"PK\3\4" + good[4:]]
    for at in rng.integers(0, len(good), 100).tolist():
        out.append(good[:at] + bytes([good[at] ^ (1 << int(rng.integers(8)))]) + good[at + 1 :])
    for at in rng.integers(1, len(good), 10).tolist():
        out += [good[:at], good[at:], good[:at] + bytes(len(good) - at), good[: at - 1] + good[at:]]
    start = rng.integers(0, len(good) - 16)
    out.append(good[:start] + bytes(16) + good[start + 16 :])
    digits = [at for at, byte in enumerate(good) if byte in b"0123456789"]
    for at in rng.choice(digits, 10).tolist():
        out.append(good[:at] + bytes([48 + (good[at] - 47) % 10]) + good[at + 1 :])
    return [bad for bad in out if bad != good]


@pytest.mark.parametrize("kind", KINDS)
def test_no_damage_goes_unnoticed(tmp_path: Path, kind: str) -> None:
    """Of 150 single damages to a file of each kind every one is said, counted as not there, and removed."""
    PUT[kind](tmp_path)
    put_chart(tmp_path / "other")
    file = min((tmp_path / kind).iterdir())
    (other,) = (tmp_path / "other" / CHARTS).iterdir()
    good = file.read_bytes()
    assert get(file) is not None
    tried = damages(good, other.read_bytes() if kind != CHARTS else good[:-1], np.random.default_rng(17))
    assert len(tried) >= 150
    for bad in tried:
        file.write_bytes(bad)
        assert [damage.file for damage in Cache(tmp_path).verify()] == [file]
        with pytest.warns(CacheWarning, match=r"cannot be used \(.+\); it is made again"):
            assert get(file) is None
        assert not file.exists()
    file.write_bytes(good)
    assert list(Cache(tmp_path).verify()) == []
    assert get(file) is not None


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_whole_but_under_a_wrong_name_is_foreign(tmp_path: Path, kind: str) -> None:
    """Two files of one kind that changed places, and one that lies among another kind."""
    cache_ = Cache(tmp_path)
    lasting = kind in LASTING
    for key in ("a", "b"):
        cache_.put(kind, key, CacheEntry({"who": key}, {"x": np.arange(3.0)}), lasting=lasting)
    a, b = sorted((tmp_path / kind).iterdir())
    first, second = a.read_bytes(), b.read_bytes()
    a.write_bytes(second)
    b.write_bytes(first)
    assert len(list(cache_.verify())) == 2
    for key in ("a", "b"):
        with pytest.warns(CacheWarning, match="it is another under this name"):
            assert cache_.get(kind, key, lasting=lasting) is None
    elsewhere = tmp_path / next(one for one in KINDS if one != kind) / a.name
    elsewhere.parent.mkdir()
    elsewhere.write_bytes(first)
    assert [damage.file for damage in cache_.verify()] == [elsewhere]


@pytest.mark.parametrize("said", [b"[]", b"{}", b"null", b"[" * 100_000, b'{"kind": 1}', b"\xff"])
def test_a_seal_that_somebody_made_does_not_let_nonsense_in(tmp_path: Path, said: bytes) -> None:
    cache_ = Cache(tmp_path)
    cache_.put(CHARTS, "a", CacheEntry())
    (file,) = (tmp_path / CHARTS).iterdir()
    body = len(said).to_bytes(8, "little") + said
    file.write_bytes(cache._MARK + cache._seal(body) + body)
    with pytest.warns(CacheWarning):
        assert cache_.get(CHARTS, "a") is None


def test_what_was_put_is_got_bit_for_bit(tmp_path: Path) -> None:
    arrays = {
        "floats": np.array([[0.1, -0.0, np.nan], [np.inf, 5e-324, 1e308]]),
        "turned": np.arange(6.0).reshape(2, 3).T,
        "one": np.asarray(7),
        "none": np.empty((0, 3)),
        "bits": np.array([True, False]),
        "notes": np.array([1, -(2**62)]),
    }
    said = {"text": "\U0001f3fa \udc80", "number": 0.1, "nothing": None, "limit": float("inf"), "list": [1, [2.5]]}
    Cache(tmp_path).put(CHARTS, "a", CacheEntry(said, arrays))
    kept = Cache(tmp_path).get(CHARTS, "a")
    assert kept is not None
    assert kept.said == said
    assert list(kept.arrays) == list(arrays)
    for name, values in arrays.items():
        again = kept.arrays[name]
        assert (again.dtype, again.shape, again.tobytes()) == (values.dtype, values.shape, values.tobytes())
        # Kernels are compiled once more for arrays that are not so.
        assert again.flags.writeable
        assert again.flags.aligned
        assert again.flags.owndata


def test_nothing_is_ever_unpickled_or_named_outside(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="objects of Python"):
        Cache(tmp_path).put(CHARTS, "a", CacheEntry({}, {"x": np.array([object()])}))
    for kind, key in ((CHARTS, "../a"), ("../a", "a"), (CHARTS, ""), (CHARTS, "a-b-c"), (CHARTS, "A.kept")):
        with pytest.raises(ValueError, match="not what a file can be called after"):
            Cache(tmp_path).put(kind, key, CacheEntry())
    assert list(tmp_path.iterdir()) == []


def test_keys_differ_where_anything_does() -> None:
    parts = [(1,), (1.0,), ("1",), (True,), (None,), (0.1,), (0.1 + 1e-17 * 2,), ("a", "b"), ("ab",), (["a", "b"],), ()]
    keys = {cache.key_of(*some) for some in parts}
    assert len(keys) == len({json.dumps(some) for some in parts})
    assert cache.key_of(1, group="a") != cache.key_of(1)
    assert cache.key_of({"a": 1, "b": 2}) == cache.key_of({"b": 2, "a": 1})


def test_other_code_finds_nothing_but_what_is_lasting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Cache(tmp_path).put(CHARTS, "a", CacheEntry())
    Cache(tmp_path).put(SELF_TESTS, "a", CacheEntry(), lasting=True)
    monkeypatch.setattr(cache, "code_version", lambda: 64 * "0")
    assert Cache(tmp_path).get(CHARTS, "a") is None
    assert Cache(tmp_path).get(SELF_TESTS, "a", lasting=True) == CacheEntry()
    # Both are whole.
    assert list(Cache(tmp_path).verify()) == []


def test_what_is_too_large_is_neither_kept_nor_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Cache(tmp_path).put(CHARTS, "a", CacheEntry({}, {"x": np.zeros(1000)}))
    monkeypatch.setattr(cache, "LARGEST", 8000)
    with pytest.warns(CacheWarning, match="too large"):
        assert Cache(tmp_path).get(CHARTS, "a") is None
    Cache(tmp_path).put(CHARTS, "a", CacheEntry({}, {"x": np.zeros(1000)}))
    assert Cache(tmp_path).get(CHARTS, "a") is None
    Cache(tmp_path).put(CHARTS, "a", CacheEntry({}, {"x": np.zeros(500)}))
    assert Cache(tmp_path).get(CHARTS, "a") is not None


def test_a_folder_that_cannot_be_written_or_read_costs_time_only(tmp_path: Path) -> None:
    file = tmp_path / "no-folder"
    file.write_text("a file")
    for folder in (file, tmp_path / "absent"):
        Cache(folder).prune(days=1.0, most_bytes=0)
        assert list(Cache(folder).verify()) == []
    assert Cache(tmp_path / "absent").get(CHARTS, "a") is None
    Cache(file).put(CHARTS, "a", CacheEntry())
    with pytest.warns(CacheWarning, match="Not a directory"):
        assert Cache(file).get(CHARTS, "a") is None
    assert file.read_text() == "a file"


def names(folder: Path, kind: str = CHARTS) -> set[str]:
    return {key_in(file) if file.suffix == ".kept" else file.name for file in (folder / kind).iterdir()}


def used(folder: Path, ages: dict[str, float], kind: str = CHARTS) -> None:
    """Let files be as if they had been used last so many days ago."""
    for file in (folder / kind).glob("*.kept"):
        if key_in(file) in ages:
            at = time.time() - ages[key_in(file)] * DAY
            os.utime(file, (at, at))


def test_what_nobody_asks_for_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of other code, and of groups that were not used for long; nothing that is not the cache's own."""
    kept = Cache(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(cache, "code_version", lambda: 64 * "0")
        kept.put(CHARTS, "f-old", CacheEntry())
    keys = ("a-1", "a-2", "b-1", "b-2", "c-1", "c-2")
    for key in keys:
        kept.put(CHARTS, key, CacheEntry())
    others = {".chart.kept.77-88.kouros.partial", "mine.npz", "mine.kept", "notes.txt"}
    for name in others:
        (tmp_path / CHARTS / name).write_bytes(b"of the user")
    # Those of a Kouros before this cache go.
    for former in (f"{'a' * 64}.npz", f"charts/{'0' * 12}-{'a' * 12}-{'b' * 16}-{'c' * 32}.npz"):
        (tmp_path / former).write_bytes(b"PK")
    used(tmp_path, dict.fromkeys(keys, 40.0))
    # To ask for one is to use its group.
    assert kept.get(CHARTS, "a-1") is not None
    kept.prune(days=50.0, most_bytes=10**9)
    left = {key_in(file) for file in (tmp_path / CHARTS).glob("*-*.kept")}
    assert left == set(keys)
    assert others <= {file.name for file in (tmp_path / CHARTS).iterdir()}
    assert list(tmp_path.rglob("*.npz")) == [tmp_path / CHARTS / "mine.npz"]
    kept.prune(days=30.0, most_bytes=10**9, using=["b"])
    assert {key_in(file) for file in (tmp_path / CHARTS).glob("*-*.kept")} == {"a-1", "a-2", "b-1", "b-2"}
    # It counts as used now.
    kept.prune(days=30.0, most_bytes=10**9)
    assert {key_in(file) for file in (tmp_path / CHARTS).glob("*-*.kept")} == {"a-1", "a-2", "b-1", "b-2"}
    assert others <= {file.name for file in (tmp_path / CHARTS).iterdir()}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_is_bounded(tmp_path: Path, kind: str) -> None:
    """What was used longest ago goes first; what is in use goes last; what is lasting stays."""
    kept = Cache(tmp_path)
    for key in ("a-1", "b-1", "c-1"):
        kept.put(kind, key, CacheEntry({}, {"x": np.zeros(100)}))
    kept.put(kind, "d-1", CacheEntry(), lasting=True)
    used(tmp_path, {"a-1": 3.0, "b-1": 2.0, "c-1": 1.0}, kind)
    (size,) = {file.stat().st_size for file in (tmp_path / kind).iterdir() if "lasting" not in file.name}
    kept.prune(days=30.0, most_bytes=3 * size)
    assert names(tmp_path, kind) == {"a-1", "b-1", "c-1", "d-1"}
    kept.prune(days=30.0, most_bytes=3 * size - 1)
    assert names(tmp_path, kind) == {"b-1", "c-1", "d-1"}
    kept.prune(days=30.0, most_bytes=size, using=["b"])
    assert names(tmp_path, kind) == {"b-1", "d-1"}
    kept.prune(days=30.0, most_bytes=0)
    assert names(tmp_path, kind) == {"d-1"}


def test_the_hash_of_a_motion_in_use_is_the_group_of_its_charts(tmp_path: Path) -> None:
    """Groups are told by their first letters, in names as in what is said to be in use."""
    motion = "0123456789abcdef" * 4
    kept, key = Cache(tmp_path), cache.key_of("a chart", group=motion)
    kept.put(CHARTS, key, CacheEntry())
    used(tmp_path, {key: 40.0})
    kept.prune(days=30.0, most_bytes=10**9, using=[motion])
    assert names(tmp_path) == {key}


def test_what_two_write_at_once_is_one_of_both(tmp_path: Path) -> None:
    """Each writes aside and renames: a reader finds the one or the other, never a mixture."""
    from concurrent.futures import ThreadPoolExecutor

    kept = Cache(tmp_path)

    def write(number: int) -> None:
        for _ in range(20):
            kept.put(CHARTS, "a", CacheEntry({"n": number}, {"x": np.full(2000, float(number))}))

    def read(_: int) -> None:
        for _ in range(50):
            found = kept.get(CHARTS, "a")
            assert found is None or (found.arrays["x"] == found.said["n"]).all()

    with warnings.catch_warnings(), ThreadPoolExecutor(4) as pool:
        warnings.simplefilter("error", CacheWarning)
        assert len([*pool.map(write, range(2)), *pool.map(read, range(2))]) == 4
