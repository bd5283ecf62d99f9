"""Results are compressed with a dictionary of texts, and what was compressed with another one, or none, is read."""

import zlib
from pathlib import Path

import pytest

from pipeline.store import codec
from pipeline.store.codec import StoreError, deflated, inflated, joined
from pipeline.store.results import anonymous, decode, encode
from tests.store.run_samples import assessment, finding

FOLDER = Path(codec.__file__).with_name("dictionaries")
RESULT = anonymous(assessment("1", finding("1")), {}, None)


def test_every_dictionary_is_what_its_name_says() -> None:
    """Changed by a letter it would make rows of before unreadable: a new one is a new file."""
    names = {file.stem for file in FOLDER.glob("*.txt")}
    assert codec.NEWEST in names
    for name in names:
        assert f"{zlib.adler32(joined((FOLDER / f'{name}.txt').read_text(encoding='utf-8'))):08x}" == name


def test_what_is_written_names_its_dictionary_and_comes_back() -> None:
    content = b'{"note":"mass of 3 kg"}' * 9
    packed = deflated(content)
    assert packed[2:6].hex() == codec.NEWEST
    assert inflated(packed) == content
    assert deflated(content) == packed


def test_a_result_of_before_the_dictionary_is_read() -> None:
    old = zlib.compress(inflated(encode("k", [RESULT]).found), 1)
    assert decode(old) == (RESULT,)


def test_the_dictionary_pays() -> None:
    """A result of one finding, mostly names of fields, takes little more than half of what it takes without."""
    packed = encode("k", [RESULT]).found
    assert len(packed) < 0.55 * len(zlib.compress(inflated(packed), 9))


@pytest.mark.parametrize(
    "broken",
    [lambda p: p[:-1], lambda p: p[:3], lambda p: p + b"0", lambda p: p[:2] + b"none" + p[6:], lambda _: b""],
    ids=["cut", "cut early", "longer", "another dictionary", "empty"],
)  # fmt: skip
def test_what_is_damaged_is_refused(broken) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(StoreError, match="damaged"):
        decode(broken(encode("k", [RESULT]).found))
