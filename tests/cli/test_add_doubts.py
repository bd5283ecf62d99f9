"""kouros motions add of records that ask for a person: what is overruled, what is asked, what is hostile, a folder."""

from __future__ import annotations

import bz2
import gzip
import json
import re
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pipeline.motions import load_manifest
from pipeline.motions.gathering import gather
from pipeline.motions.proposing import Answers, propose
from tests.cli.test_add_command import DEMO, KNOWN, at2, digest, say, three, trace
from tests.motions.conftest import tone
from tests.motions.formats import national
from tests.motions.formats import specimens as hand
from tests.motions.formats.every import SPECIMENS

# isort: split
import obspy  # after what imports it in a way that warns of nothing

WEAK = 0.0015
"""m/s2: 0.00015 g, below the least that passes, 0.002 g."""


def weak(folder: Path) -> list[str]:
    """A record that is too small, and that ends amid its shaking."""
    folder.mkdir()
    files = []
    for channel in ("HN1", "HN2", "HNZ"):
        one = trace(channel)
        one.data = WEAK * np.sin(np.arange(2000) / 7.0)
        one.write(str(folder / f"{channel}.mseed"), format="MSEED")
        files.append(str(folder / f"{channel}.mseed"))
    return files


RAW = (*KNOWN[:-1], "--raw", "--no-compare")


def test_a_refusal_of_judgement_names_the_file_and_the_option(tmp_path: Path) -> None:
    """Nothing was written: no line of a manifest is what has to be mended."""
    files = weak(tmp_path / "new")
    code, out = say(tmp_path, "add", *files, "--site", "mine", *RAW)
    assert code == 4
    assert 'or look at it and overrule by `kouros motions add --accept size="REASON"`' in out
    assert f"{files[0]}: record 'XX.ONE 2020-01-02 03:04': its larger horizontal component peaks at 0.000157 g" in out
    assert "manifest" not in out
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize(
    ("accepted", "written"),
    [
        (("size=an aftershock", "cut-off=a sine"), {"size": "an aftershock", "cut_off": "a sine"}),
        (("size=an aftershock", "the rest = weak"), {"size": "an aftershock", "cut_off": "the rest = weak"}),
    ],
)
def test_what_is_accepted_is_in_the_manifest_with_its_reason(
    tmp_path: Path, accepted: tuple[str, ...], written: dict[str, str]
) -> None:
    words = [word for one in accepted for word in ("--accept", one)]
    code, out = say(tmp_path, "add", *weak(tmp_path / "new"), "--site", "mine", *RAW, *words)
    assert code == 0, out
    assert load_manifest(tmp_path / "mine").level[0].record[0].accept == written
    text = (tmp_path / "mine" / "manifest.toml").read_text(encoding="utf-8")
    assert tomllib.loads(text)["level"][0]["record"][0]["accept"] == written
    assert all(f"overruled {check}: {why}" in out for check, why in written.items())
    assert re.search(r"design +- +- +0\.0001[56]\d* ", out), "weak shaking is no zero in the table"


def test_one_check_that_is_accepted_overrules_no_other(tmp_path: Path) -> None:
    files = weak(tmp_path / "new")
    code, out = say(tmp_path, "add", *files, "--site", "mine", *RAW, "--accept", "size=weak")
    assert (code, '--accept cut_off="REASON"' in out, (tmp_path / "mine").exists()) == (4, True, False)


def test_a_check_that_was_not_needed_is_said(tmp_path: Path) -> None:
    files = [str(file) for file in three(tmp_path / "new")]
    words = [*KNOWN, "--no-compare", "--accept", "clipping=looked at"]
    code, out = say(tmp_path, "add", *files, "--site", "mine", *words)
    assert code == 0
    assert "nothing was refused for clipping: --accept clipping was not needed" in out
    assert load_manifest(tmp_path / "mine").level[0].record[0].accept == {}


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("cliping=why", "did you mean 'clipping'"),
        ("size=", "give the reason"),
        ("  ", "give the reason"),
        ("size=\x1b[31m", "printable"),
    ],
)
def test_a_check_that_there_is_not_and_a_reason_that_is_none(tmp_path: Path, word: str, told: str) -> None:
    code, out = say(tmp_path, "add", *weak(tmp_path / "new"), "--site", "mine", *RAW, "--accept", word)
    assert (code, told in out, (tmp_path / "mine").exists()) == (2, True, False), out


def test_the_question_of_an_orientation_quotes_the_header(tmp_path: Path) -> None:
    (tmp_path / "a.v1").write_bytes(national.volume1(channels=("EW", "V", "NZ")))
    code, out = say(tmp_path, "add", "a.v1", "--site", "mine")
    assert code == 2
    assert "How is HN3 (its header says 'NZ') oriented" in out
    (tmp_path / "b.v1").write_bytes(national.volume1(channels=("L", "V", "T")))
    code, out = say(tmp_path, "add", "b.v1", "--site", "mine")
    assert "How are HN1 (its header says 'L'), HN3 (its header says 'T') oriented" in out


def test_the_answer_for_one_of_several_records_is_for_no_other(tmp_path: Path) -> None:
    """Two stations whose channels have one name: each is asked by its file, and answered by it."""
    for name, word in (("a", "L"), ("b", "T")):
        (tmp_path / f"{name}.v1").write_bytes(national.volume1(channels=(word, "V", "EW")))
    code, out = say(tmp_path, "add", "a.v1", "b.v1", "--site", "mine")
    assert code == 2
    options = [line.split()[1].removesuffix("=...") for line in out.splitlines() if "--orientation" in line]
    assert options == ["a.v1#.00001.01.HN1", "b.v1#.00001.01.HN1"]
    answers = Answers(orientations=dict(zip(options, (30.0, 120.0), strict=True)))
    proposals, left = propose(gather([tmp_path / "a.v1", tmp_path / "b.v1"]), answers)
    assert not left
    found = [{c.orientation for c in one.record.components.values()} for one in proposals if one.record is not None]
    assert found == [{30.0, 90.0, "up"}, {120.0, 90.0, "up"}]


def test_a_station_that_is_a_number_is_called_by_its_name(tmp_path: Path) -> None:
    """The code that BHRC's file has is I1.5526, which tells nobody where it stood."""
    (tmp_path / "a.V1").write_bytes(national.bhrc())
    (one,), left = propose(gather([tmp_path / "a.V1"]), Answers())
    assert not left
    assert one.record is not None
    assert one.record.station is not None
    assert one.record.station.name
    assert one.name.startswith(one.record.station.name)


def test_a_single_channel_says_which_it_is(tmp_path: Path) -> None:
    (tmp_path / "e.asc").write_bytes(hand.esm())
    code, out = say(tmp_path, "add", "e.asc", "--site", "mine")
    assert code == 4
    told = (
        "e.asc holds 1 channel (HNE, 90 degrees, in cm/s2, processed), and lacks the other horizontal component; give "
    )
    assert f"{told}the files of the other components of" in out


def test_a_horizontal_and_a_vertical_say_what_they_lack(tmp_path: Path) -> None:
    (tmp_path / "a.v1").write_bytes(national.volume1(channels=("90 DEG", "UP")))
    code, out = say(tmp_path, "add", "a.v1", "--site", "mine")
    assert code == 4
    told = (
        "a.v1 holds 2 channels (HNE, 90 degrees, in g/10, raw; HNZ, up, in g/10, raw), and lacks the other horizontal"
    )
    assert told in out
    (tmp_path / "z.v1").write_bytes(national.volume1(channels=("UP",)))
    code, out = say(tmp_path, "add", "z.v1", "--site", "mine")
    assert (code, "lacks both horizontal components" in out) == (4, True), out


def test_every_format_in_one_folder_is_added_or_left_with_a_reason(tmp_path: Path) -> None:
    """No file is passed over in silence, and nothing that is sound is lost for what is not."""
    folder = tmp_path / "all"
    three(folder)
    for name, (_, written) in SPECIMENS.items():
        (folder / f"{name}.dat").write_bytes(written())
    for direction in ("090", "360", "UP"):
        at2(folder / f"RSN1_X_{direction}.AT2", f"Kobe, 1/16/1995, Kakogawa, {direction}", 0.1 * tone(1500))
    (folder / "words.csv").write_text("object,height\nvase,0.3\n", encoding="ascii")
    (folder / "packed.v1.gz").write_bytes(gzip.compress(hand.csmip(1)))
    (folder / "readme.txt").write_text("words", encoding="ascii")
    code, out = say(tmp_path, "add", "all", "--guess", "--site", "mine", *KNOWN, "--no-compare", "--json")
    assert code == 0, out
    answer = json.loads(out)
    names = {one["name"] for one in answer["added"]}
    assert {"XX.ONE 2020-01-02 03:04", "Kobe, 1/16/1995, Kakogawa"} <= names
    told = "\n".join(f"{one['name']}: {one['reason']}" for one in answer["left"])
    told += "\n".join(name for one in answer["added"] for name in one["files"]) + "\n".join(answer["passed_over"])
    records = load_manifest(tmp_path / "mine").level[0].record
    assert {record.name for record in records} == names
    assert all(len(one["reason"]) > 10 and "\n" not in one["name"] for one in answer["left"])
    for word in ("words.csv", "packed.v1", "readme.txt"):
        assert word in told
    # The specimens last 0.6 s: what is no record of an earthquake is left with its check, or asks.
    assert len(answer["left"]) + len(names) >= len(SPECIMENS) - 6, "those of one channel and station are one"


def test_what_can_be_used_beside_what_is_refused_is_said(tmp_path: Path) -> None:
    good = [str(file) for file in three(tmp_path / "good", station="TWO")]
    words = ["--accept", "cut_off=a sine"]
    code, out = say(tmp_path, "add", *good, *weak(tmp_path / "new"), "--site", "mine", *RAW, *words)
    assert (code, "1 record can be used: --guess adds what can" in out) == (4, True), out
    before = digest(tmp_path)
    assert "mine/manifest.toml" not in before


Spoil = Callable[[bytes], bytes]
HOSTILE: dict[str, tuple[Spoil, str]] = {
    "cut off": (lambda raw: raw[: raw.rindex(b"points of") + 300], "it is cut off: fetch the file again"),
    "empty": (lambda _: b"", "is empty"),
    "blanks": (lambda _: b" \r\n\0\x1a", "is empty"),
    "UTF-16": (lambda raw: raw.decode("latin-1").encode("utf-16"), "is text in UTF-16; save it as plain text"),
    "UTF-16 unmarked": (lambda raw: raw.decode("latin-1").encode("utf-16-be"), "is text in UTF-16"),
    "bzip2": (bz2.compress, "is packed (bzip2); unpack it"),
    "gzip cut off": (lambda raw: gzip.compress(raw)[:-9], "cannot be unpacked (gzip: "),
    "huge count": (lambda raw: raw.replace(b"   60 points", b"99999999 points", 1), "99999999"),
    "wrong count": (lambda raw: raw.replace(b"   60 points", b"   72 points", 1), "line "),
    "no number": (
        lambda raw: raw.replace(b" 100.00000", b"       NaN", 1),
        "expected 8 values of acceleration of 10 characters, found '       NaN",
    ),
    "no step": (lambda raw: raw.replace(b".010 sec", b".000 sec"), "step"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_damaged_is_refused_by_name_and_nothing_is_written(tmp_path: Path, name: str) -> None:
    spoil, told = HOSTILE[name]
    raw, done = hand.csmip(), spoil(hand.csmip())
    assert done != raw, "the specimen has what is spoilt"
    (tmp_path / "a.v2").write_bytes(done)
    code, out = say(tmp_path, "add", "a.v2", "--site", "mine")
    assert (code, "a.v2: " in out, told in out, (tmp_path / "mine").exists()) == (4, True, True, False), out


@pytest.mark.parametrize("name", sorted(SPECIMENS))
@pytest.mark.parametrize("ends", [b"\r", b"\n", b"\r\n"])
def test_line_ends_and_a_byte_order_mark_change_nothing(tmp_path: Path, name: str, ends: bytes) -> None:
    """Each format, with the line ends of three systems: the same samples and header, by the same reader."""
    from pipeline.motions.reading import open_traces

    raw = SPECIMENS[name][1]()
    (tmp_path / "plain").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "plain" / "a.dat").write_bytes(raw)
    (tmp_path / "other" / "a.dat").write_bytes(b"\xef\xbb\xbf" + raw.replace(b"\r\n", b"\n").replace(b"\n", ends))
    one, other = (open_traces(tmp_path / where / "a.dat", []) for where in ("plain", "other"))
    assert [trace.id for trace in one] == [trace.id for trace in other]
    for mine, theirs in zip(one, other, strict=True):
        np.testing.assert_array_equal(mine.data, theirs.data)
        assert mine.stats._format == theirs.stats._format
        assert mine.stats.kouros.orientation == theirs.stats.kouros.orientation


def test_a_file_of_k_net_without_lines_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.NS").write_bytes(national.knet().replace(b"\r\n", b"\n").replace(b"\n", b"\r"))
    code, out = say(tmp_path, "add", "a.NS", "--site", "mine")
    assert (code, "a.NS: " in out, "Traceback" in out) == (4, True, False), out


def test_an_unknown_file_shows_its_first_line_and_the_way_out(tmp_path: Path) -> None:
    (tmp_path / "x.dat").write_text("Logger 7, second floor\n0.0 1.0\n", encoding="ascii")
    code, out = say(tmp_path, "add", "x.dat", "--site", "mine")
    assert code == 4
    assert "its first line is 'Logger 7, second floor'" in out
    assert "CSMIP V1 and V2" in out
    assert "MiniSEED" in out
    assert "kouros motions convert FILE --columns" in out


@pytest.mark.long("motions/test_several::test_it_is_told_among_the_steps_and_never_refused")
def test_a_second_earthquake_is_told_where_it_is_seen(tmp_path: Path) -> None:
    """Of the demonstration's record 80 s, and their copy 60 s later, which begins to shake at 92 s."""
    new = tmp_path / "new"
    new.mkdir()
    for file in sorted(DEMO.glob("CI.CLC*")):
        if file.suffix != ".mseed":
            shutil.copy(file, new)
            continue
        (one,) = obspy.read(str(file))
        late, whole = round(60.0 / one.stats.delta), round(80.0 / one.stats.delta)
        shaken = (one.data - np.median(one.data))[:whole]
        data = np.zeros(whole + late)
        data[:whole] = shaken
        data[late:] += shaken
        one.data = np.round(data).astype(np.int32)
        one.write(str(new / file.name), format="MSEED", encoding="STEIM2")
    told = re.compile(r"doubtful:? +may hold two earthquakes, .* it shakes anew at 9[0-9] s .*; all of it is used")
    code, out = say(tmp_path, "add", str(new), "--site", "mine", "--no-compare", "--dry-run", "--guess")
    assert (code, len(told.findall(out))) == (0, 1), out
    code, out = say(tmp_path, "add", str(new), "--site", "mine", "--no-compare")
    assert (code, len(told.findall(out))) == (0, 1), out
    assert "# doubtful: may hold two earthquakes" in (tmp_path / "mine" / "manifest.toml").read_text(encoding="utf-8")
    page = (tmp_path / "mine" / "added.html").read_text(encoding="utf-8")
    assert re.search(r'<p class="act">Doubtful: may hold two earthquakes, [^<]*</p>', page)
    code, out = say(tmp_path, "show", "mine")
    assert (code, len(told.findall(out))) == (0, 1), out


def esm_files(folder: Path, codes: str = "NEZ") -> None:
    """As ESM packs them: of each component acceleration, velocity and response spectrum."""
    folder.mkdir()
    values = 100.0 * tone(1500)
    size = f"{np.abs(values).max():.6f}"
    for code in codes:
        keys = {"NDATA": "1500", "STREAM": f"HN{code}", "PGA_CM/S^2": size}
        head = hand.esm(**keys).decode().splitlines()[:-60]
        samples = [f"{value:.6f}" for value in values]
        other = [line.replace("DATA_TYPE: ACCELERATION", "DATA_TYPE: VELOCITY") for line in head]
        (folder / f"X.HN{code}.ACC.ASC").write_text("\n".join([*head, *samples, ""]))
        (folder / f"X.HN{code}.VEL.ASC").write_text("\n".join([*other, *samples, ""]))
    (folder / "X.v3").write_text("Response and Fourier Amplitude Spectra  X  Chan 1\n" + "1.0 2.0\n" * 200)


def test_velocities_and_spectra_beside_accelerations_are_left_out(tmp_path: Path) -> None:
    esm_files(tmp_path / "new")
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare")
    assert code == 0, out
    record = load_manifest(tmp_path / "mine").level[0].record[0]
    assert sorted(Path(name).name for name in record.files) == [f"X.HN{one}.ACC.ASC" for one in "ENZ"]
    assert out.count("the file holds 'VELOCITY'; give the file of the acceleration") == 3
    assert "holds response and Fourier spectra" in out


def test_a_velocity_in_the_place_of_the_vertical_is_refused(tmp_path: Path) -> None:
    esm_files(tmp_path / "new")
    (tmp_path / "new" / "X.HNZ.ACC.ASC").unlink()
    code, out = say(tmp_path, "add", "new", "--site", "mine", "--no-compare")
    assert (code, "X.HNZ.VEL.ASC" in out, (tmp_path / "mine").exists()) == (4, True, False), out


def test_velocities_alone_are_no_record(tmp_path: Path) -> None:
    esm_files(tmp_path / "new")
    for file in (tmp_path / "new").glob("*.ACC.ASC"):
        file.unlink()
    code, out = say(tmp_path, "add", "new", "--site", "mine")
    assert (code, "holds 'VELOCITY'" in out, (tmp_path / "mine").exists()) == (4, True, False), out
