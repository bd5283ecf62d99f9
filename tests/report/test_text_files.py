"""Text files from new bytes and from an earlier file's are those that were written at once."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.report.errors import ReportError
from pipeline.report.files import text_files
from pipeline.report.files.text_files import TextFile

OLD = np.random.default_rng(1).bytes(5_000)


@pytest.mark.parametrize("block", [1, 64, 700, 1 << 22])
def test_what_was_put_together_is_what_was_meant(block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousand parts, drawn at random: new, old one behind the other, old from anywhere, empty."""
    monkeypatch.setattr(text_files, "BLOCK", block)
    (tmp_path / "old").write_bytes(OLD)
    numbers = np.random.default_rng(block)
    file = TextFile(tmp_path / "new", b"head\n", tmp_path / "old")
    expected, at = b"head\n", 0
    for _ in range(1_000):
        length = int(numbers.integers(0, 60))
        if numbers.random() < 0.3:
            part = numbers.bytes(length)
            place = file.add(part)
        else:
            if numbers.random() < 0.2 or at + length > len(OLD):
                at = int(numbers.integers(0, len(OLD) - 60))
            part = OLD[at : at + length]
            place = file.take(at, length)
            at += length
        assert place == (len(expected), length)
        expected += part
    file.close()
    file.close()
    assert (tmp_path / "new").read_bytes() == expected


def test_an_earlier_file_that_is_too_short_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "old").write_bytes(OLD)
    file = TextFile(tmp_path / "new", b"", tmp_path / "old")
    file.take(4_990, 11)
    with pytest.raises(ReportError, match="old is shorter than its report says"):
        file.close()
    file.close()


def test_a_full_disk_is_said(tmp_path: Path) -> None:
    """The device that is always full: what a thread met is raised where the report is put together."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    file = TextFile(Path("/dev/full"), b"", tmp_path / "old")
    file.add(b"x" * (1 << 23))
    with pytest.raises(OSError, match="No space left"):
        file.add(b"y" * (1 << 23))
    file.close()
