"""Packed records: what is in them is read, whatever packed it, and no archive fills the disk or leads elsewhere."""

from __future__ import annotations

import gzip
import hashlib
import io
import tarfile
import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner

from pipeline.cli import kouros
from pipeline.motions import MotionError, unpacking
from pipeline.motions.gathering import gather
from pipeline.motions.manifest import load_manifest
from pipeline.motions.unpacking import Unpacking
from tests.motions.formats import national

DATA = Path(__file__).parents[1] / "data" / "motions"
CONTENT = national.nsmn()


def tarred(members):
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w") as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return out.getvalue()


def zipped(members):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return out.getvalue()


@pytest.fixture
def unpacked(tmp_path):
    def unpack(name, content):
        (tmp_path / "given").mkdir(exist_ok=True)
        (tmp_path / "scratch").mkdir(exist_ok=True)
        file = tmp_path / "given" / name
        file.write_bytes(content)
        return Unpacking(tmp_path / "scratch").files_of(file)

    return unpack


@pytest.mark.parametrize(
    ("name", "content", "shown"),
    [
        ("a.txt", CONTENT, "a.txt"),
        ("a.txt.gz", gzip.compress(CONTENT), "a.txt"),
        ("a.zip", zipped({"in/a.txt": CONTENT}), "a.zip/in/a.txt"),
        ("a.tar", tarred({"in/a.txt": CONTENT}), "a.tar/in/a.txt"),
        ("a.tar.gz", gzip.compress(tarred({"a.txt.gz": gzip.compress(CONTENT)})), "a.tar/a.txt"),
        ("a.zip", zipped({"../../a.txt": CONTENT, "__MACOSX/._a.txt": b"x", "in/": b""}), "a.zip/a.txt"),
        ("a.zip", zipped({"C:\\x\\..\\a.txt": CONTENT}), "a.zip/C:/x/a.txt"),
    ],
)
def test_what_is_in_it(unpacked, tmp_path, name, content, shown):
    (one,) = unpacked(name, content)
    assert one.shown == tmp_path / "given" / shown
    assert one.path.read_bytes() == CONTENT
    assert one.path.resolve().is_relative_to(tmp_path)


def test_links_in_an_archive_are_left_out(unpacked):
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w") as archive:
        info = tarfile.TarInfo("a.txt")
        info.type, info.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(info)
    assert unpacked("a.tar", out.getvalue()) == []


def test_three_gzip_files_of_one_folder_stay_together(tmp_path):
    """K-NET's three components, packed one by one, have their station and folder in common."""
    (tmp_path / "given").mkdir()
    (tmp_path / "scratch").mkdir()
    for direction, ending in (("N-S", "NS"), ("E-W", "EW"), ("U-D", "UD")):
        (tmp_path / "given" / f"AOM004.{ending}.gz").write_bytes(gzip.compress(national.knet(direction)))
    found = gather([tmp_path / "given"], scratch=tmp_path / "scratch")
    assert [name for name, _ in found.traces] == ["0/AOM004.EW", "0/AOM004.NS", "0/AOM004.UD"]
    assert found.unusable == []


@pytest.mark.parametrize(
    ("name", "content", "wrong"),
    [
        ("a.gz", gzip.compress(CONTENT)[:-20], "cannot be unpacked"),
        ("a.zip", zipped({"a.txt": CONTENT})[:-40], "cannot be unpacked"),
        ("a.gz", gzip.compress(bytes(5_000_000)), "more than 1,000,000 bytes"),
        ("a.zip", zipped({f"{n}": b"" for n in range(30)}), "or 20 files"),
        ("a.gz", gzip.compress(gzip.compress(gzip.compress(gzip.compress(CONTENT)))), "packed more than 3 times"),
        ("a.zip", zipped({"in/a b.txt": CONTENT, "in/a_b.txt": CONTENT}), "two files"),
    ],
)
def test_refused(unpacked, monkeypatch, name, content, wrong):
    monkeypatch.setattr(unpacking, "LARGEST_UNPACKED", 1_000_000)
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 20)
    with pytest.raises(MotionError, match=wrong):
        unpacked(name, content)


def test_a_record_that_is_packed_becomes_one_of_the_site(tmp_path):
    """The file that the site keeps, and its hash, are of the record and not of what packed it."""
    content = gzip.decompress((DATA / "CE89146.V2.gz").read_bytes())
    packed = tmp_path / "CE89146.zip"
    packed.write_bytes(zipped({"ce89146p/CE89146.V2": content}))
    done = CliRunner().invoke(kouros, ["-q", "motions", "add", str(packed), "--site", str(tmp_path / "site")])
    assert done.exit_code == 0, done.output
    ((_, record),) = load_manifest(tmp_path / "site").records()
    (name,) = record.files
    assert (tmp_path / "site" / name).read_bytes() == content
    assert record.sha256 == {name: hashlib.sha256(content).hexdigest()}
