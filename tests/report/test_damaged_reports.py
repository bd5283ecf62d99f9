"""What of an earlier report is used again is as it was written: every damage is noticed, said, and made again."""

import json
import os
import shutil
import warnings
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from random import Random

import pytest

from pipeline.records import Tally
from pipeline.report import Language, Units
from pipeline.report.errors import ReportError, ReportWarning
from pipeline.report.files.manifest import MANIFEST, PreviousReport, read_manifest, verify_report, write_manifest
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter, page_key
from pipeline.report.pages.tallies import total
from pipeline.report.render import pages_of
from tests.soak import some

from . import builder

RECORD = replace(builder.record(), decisions=())
HEAD = replace(RECORD, assessments=(), wishes=None, spacings=())
NOT_READ = {"method.html", "motion.html", "news.html"}
"""Pages that every report writes anew, and so has no need of the earlier one's."""


def night(folder: Path, previous: Path | None, *, beside: bool = False) -> tuple[dict[str, bytes], list[str], int]:
    """Make the report of the same run again; return its files, what was said, and how many pages were drawn.

    beside : whether the earlier report is looked at beside all this, as a night of the whole museum does it
    """
    drawn = 0
    tallies: list[Tally] = []
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        before = None if previous is None else PreviousReport.read(previous)
        looking = before.looking() if before is not None and beside else nullcontext()
        with looking, ReportWriter(folder, PageRenderer(HEAD, Units(), Language()), before) as writer:
            for page, found in pages_of(RECORD):
                key = page_key(writer.renderer, page, ())
                if writer.has(key):
                    tallies.append(writer.reuse(key))
                else:
                    drawn += 1
                    tallies.append(writer.add(key, writer.renderer.draw(page, found, ())))
            writer.finish(HEAD, total(tallies), None, {}, doubts=builder.doubts)
    # What an earlier test left open is collected at any time, and warns then.
    said = [one for one in said if one.category is not ResourceWarning]
    assert {one.category for one in said} <= {ReportWarning}
    return files_of(folder), [str(one.message) for one in said], drawn


def files_of(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report as it was written."""
    folder = tmp_path_factory.mktemp("reports") / "good"
    assert night(folder, None)[2] == len(pages_of(RECORD))
    return folder


def flip(data: bytes, chance: Random) -> bytes:
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def digit(data: bytes, chance: Random) -> bytes:
    places = [at for at, byte in enumerate(data) if byte in b"0123456789"]
    if not places:
        return flip(data, chance)
    at = chance.choice(places)
    return data[:at] + str((data[at] - 48 + chance.randrange(1, 10)) % 10).encode() + data[at + 1 :]


def zeros(data: bytes, chance: Random) -> bytes:
    start = chance.randrange(len(data))
    return data[:start] + bytes(min(4096, len(data) - start)) + data[start + 4096 :]


def cut(data: bytes, chance: Random) -> bytes:
    return data[: chance.randrange(len(data))]


def longer(data: bytes, chance: Random) -> bytes:
    return data + chance.randbytes(chance.randrange(1, 99))


SEEDS = int(os.environ.get("KOUROS_SEEDS", "4"))
"""Files that each kind of damage is done to; `make soak` takes 24."""

LONG = pytest.mark.long("test_no_damage_goes_into_the_next_report")

DAMAGES: tuple[Callable[[bytes, Random], bytes], ...] = (flip, digit, zeros, cut, longer)


def test_an_unchanged_report_is_linked_and_says_nothing(good: Path, tmp_path: Path) -> None:
    made, said, drawn = night(tmp_path / "again", good)
    assert (said, drawn) == ([], 0)
    assert made == files_of(good)
    for name in made.keys() - NOT_READ - {"index.html", MANIFEST}:
        assert (good / name).samefile(tmp_path / "again" / name)
    assert list(verify_report(good)) == list(verify_report(tmp_path / "again")) == []


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda one: one.__name__)
@pytest.mark.parametrize("seed", [seed if seed < 2 else pytest.param(seed, marks=LONG) for seed in range(SEEDS)])
def test_no_damage_goes_into_the_next_report(
    good: Path, tmp_path: Path, damage: Callable[[bytes, Random], bytes], seed: int
) -> None:
    chance = Random(f"{damage.__name__} {seed}")
    last = Path(shutil.copytree(good, tmp_path / "last"))
    name = chance.choice(sorted(files_of(last)))
    before = (last / name).read_bytes()
    after = damage(before, chance) if before else b"\0"
    (last / name).write_bytes(after)
    if after == before:  # zeros where there were some
        return
    assert [(one.file, bool(one.why)) for one in verify_report(last)] == [(last / name, True)]
    made, said, _drawn = night(tmp_path / "next", last, beside=bool(seed % 2))
    assert made == files_of(good)
    assert [str(last / name) in one for one in said] == ([] if name in NOT_READ else [True])


@pytest.mark.parametrize("seed", some(range(12), 5))
def test_swapped_and_lost_files_are_noticed(good: Path, tmp_path: Path, seed: int) -> None:
    chance = Random(seed)
    last = Path(shutil.copytree(good, tmp_path / "last"))
    names = [name for name in sorted(files_of(last)) if name not in NOT_READ and name != "index.html"]
    chosen = chance.sample(names, 3)
    one, other, lost = (last / name for name in chosen)
    same = one.read_bytes() == other.read_bytes()
    one.rename(last / "aside")
    other.rename(one)
    (last / "aside").rename(other)
    lost.unlink()
    wrong = {lost} if same else {one, other, lost}
    if last / MANIFEST in wrong:
        assert {found.file for found in verify_report(last)} == {last / MANIFEST}
        # A report without one may be of an earlier version.
        wrong &= {last / MANIFEST} if (last / MANIFEST).exists() else set()
    else:
        assert {found.file for found in verify_report(last)} == wrong
    made, said, _drawn = night(tmp_path / "next", last)
    assert made == files_of(good)
    assert {Path(text.partition(": ")[0]) for text in said} == wrong


def test_a_damaged_page_alone_is_drawn_again(good: Path, tmp_path: Path) -> None:
    last = Path(shutil.copytree(good, tmp_path / "last"))
    (part, *_) = sorted((last / "parts").glob("gallery-101*.findings.csv"))
    part.write_bytes(part.read_bytes().replace(b"0", b"1", 1))
    made, said, drawn = night(tmp_path / "next", last)
    assert (made, drawn) == (files_of(good), 1)
    assert len(said) == 1
    assert f"{part}: is damaged: its checksum is not that of what was written; it is made again" in said[0]


def test_a_damaged_export_of_the_whole_is_put_together_again(good: Path, tmp_path: Path) -> None:
    last = Path(shutil.copytree(good, tmp_path / "last"))
    (last / "findings.csv").write_bytes((last / "findings.csv").read_bytes()[:-1])
    made, said, drawn = night(tmp_path / "next", last)
    assert (made, drawn, len(said)) == (files_of(good), 0, 1)


def test_an_additional_file_is_named(good: Path, tmp_path: Path) -> None:
    last = Path(shutil.copytree(good, tmp_path / "last"))
    (last / "parts" / "more.csv").write_text("a\n")
    assert [(one.file, one.why) for one in verify_report(last)] == [
        (last / "parts" / "more.csv", "is not of this report")
    ]


def test_the_manifest_of_another_report_or_version_is_not_used(good: Path, tmp_path: Path) -> None:
    last = Path(shutil.copytree(good, tmp_path / "last"))
    manifest = read_manifest(last)
    write_manifest(last, replace(manifest, files={**manifest.files, "index.html": manifest.files["method.html"]}))
    made, said, drawn = night(tmp_path / "next", last)
    assert made == files_of(good)
    assert (drawn, len(said)) == (len(pages_of(RECORD)), 1)
    content = json.dumps({"pages": [{"key": "of another version"}]}).encode()
    sealed = b'{"sha256":"%b","report":%b}\n' % (sha256(content).hexdigest().encode(), content)
    (last / MANIFEST).write_bytes(sealed)
    _made, said, drawn = night(tmp_path / "third", last)
    assert drawn == len(pages_of(RECORD))
    assert [".pages.json: was written by another version of Kouros" in one for one in said] == [True]


def test_a_report_of_an_earlier_version_is_not_used_and_nothing_is_said(good: Path, tmp_path: Path) -> None:
    last = Path(shutil.copytree(good, tmp_path / "last"))
    (last / MANIFEST).rename(last / ".sheets.json")
    _made, said, drawn = night(tmp_path / "next", last)
    assert (said, drawn) == ([], len(pages_of(RECORD)))


def test_two_pages_of_one_name_are_refused_and_the_last_report_stays_as_it_was(good: Path, tmp_path: Path) -> None:
    before = files_of(good)
    page, found = pages_of(RECORD)[0]
    writer = ReportWriter(tmp_path / "next", PageRenderer(HEAD, Units(), Language()), PreviousReport.read(good))
    rendered = writer.renderer.draw(page, found, ())
    with writer:
        tallies = [writer.reuse(page_key(writer.renderer, page, ()))]
        tallies.append(writer.add("another", replace(rendered, page=b"another")))
        with pytest.raises(ReportError, match="would share one file"):
            writer.finish(HEAD, total(tallies), None, {})
    assert files_of(good) == before
    assert list(tmp_path.iterdir()) == []


def test_where_files_cannot_be_linked_they_are_copied(
    good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("not on this file system")

    monkeypatch.setattr("os.link", refuse)
    made, said, drawn = night(tmp_path / "next", good)
    assert (made, said, drawn) == (files_of(good), [], 0)
    assert not (good / "findings.csv").samefile(tmp_path / "next" / "findings.csv")
