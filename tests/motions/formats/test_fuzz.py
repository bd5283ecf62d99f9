"""Whatever is done to a file, a reader returns a stream of finite samples, or says the file, the line and the remedy.

Each reader gets a twentieth of a second of damage, and twenty files at least: cut off at each line, random bytes, lines
exchanged, numbers replaced, lines repeated.  ``KOUROS_FUZZ_SECONDS=120`` gives each reader that many seconds, with a
new seed that a failure names.
"""

from __future__ import annotations

import importlib
import io
import os
import random
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.motions.formats import FormatError
from tests.motions.formats.every import SPECIMENS

SECONDS = os.environ.get("KOUROS_FUZZ_SECONDS")
ROOT = Path(__file__).parents[3]
PATIENCE = 5.0
"""Seconds that no file of a few kilobytes may take."""

HOSTILE = [
    b"nan", b"inf", b"-1", b"0", b"1e999", b"99999999", b"9" * 400, b"\x00", b"\xff\xfe", b"1_0", b"********", b"%s%n",
    b"-999", b"1.7e38", b"0.0", b"\x1b[2J", b"=1+1", b"(", b")", b"((((((((", b"../../etc/passwd", b"1D400", b"0x10",
    b"100000000", b"(99I99)", b"(0F0.0)", "\u0664".encode(),
]  # fmt: skip


def judge(name: str, content: bytes) -> Any:
    """Return the stream, or None where the file was refused; fails for anything but these two, soundly told."""
    reader = importlib.import_module(f"pipeline.motions.formats.{SPECIMENS[name][0]}")
    source = io.BytesIO(content)
    began = time.perf_counter()
    reader.is_format(source)
    try:
        stream = reader.read_format(source)
    except FormatError as refusal:
        said, stream = str(refusal), None
    assert time.perf_counter() - began < PATIENCE
    if stream is None:
        # file: line n: what is wrong; what to do - in printable characters, and not half a file of them
        assert re.match(r"^stream: line \d+: .+; .+$", said), said
        assert said.isprintable()
        assert len(said) < 400
        return None
    assert len(stream) > 0
    for trace in stream:
        assert trace.stats.npts == len(trace.data) >= 2
        assert np.isfinite(trace.data).all()
        assert 1e-5 <= trace.stats.delta <= 1.0
        for kind in ("velocity", "displacement"):
            if kind in trace.stats.kouros:
                assert len(trace.stats.kouros[kind]) == trace.stats.npts
    return stream


def damaged(content: bytes, chance: random.Random) -> bytes:
    lines = content.split(b"\n")
    for _ in range(chance.choice((1, 1, 2, 5))):
        kind = chance.randrange(7)
        at = chance.randrange(len(lines))
        if kind == 0:
            other = chance.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 1:
            line = bytearray(lines[at] or b" ")
            for _ in range(chance.choice((1, 3, 20))):
                line[chance.randrange(len(line))] = chance.randrange(256)
            lines[at] = bytes(line)
        elif kind == 2:
            numbers = list(re.finditer(rb"[\d.+-]+", lines[at]))
            if numbers:
                number = chance.choice(numbers)
                lines[at] = lines[at][: number.start()] + chance.choice(HOSTILE) + lines[at][number.end() :]
        elif kind == 3:
            lines[at] = lines[at][: chance.randrange(len(lines[at]) + 1)]
        elif kind == 4:
            lines[at:at] = lines[at : at + chance.randrange(1, 9)]
        elif kind == 5:
            del lines[at : at + chance.randrange(1, 4)]
            lines = lines or [b""]
        else:
            lines[at] = chance.choice(HOSTILE)
    return b"\n".join(lines)


NUMBERED = {"itaca-1", "series-of-words", "columns-of-words", "geocsv"}


@pytest.mark.parametrize("name", SPECIMENS)
def test_cut_off_at_each_line_and_within(name):
    """Half a channel is never taken for a whole one: what is read of a part are channels that it holds whole."""
    content = SPECIMENS[name][1]()
    whole = judge(name, content)
    lines = content.splitlines(keepends=True)
    for count in range(len(lines)):
        start = b"".join(lines[:count])
        for part in (start, start + lines[count][: len(lines[count]) // 2]):
            for trace, full in zip(judge(name, part) or [], whole, strict=False):
                if name in {"csv", "jma", "columns", "columns-of-a-platform"}:
                    # A table does not announce its length: its rows are whole, but for the last number.
                    assert trace.data[:-1].tolist() == full.data[: len(trace.data) - 1].tolist()
                elif name in {"at2", "at2-old", "esm", "nsmn", "csmnc", *NUMBERED}:
                    # Numbers of no fixed width: that the last one of all was cut in two cannot be seen.
                    assert trace.data[:-1].tolist() == full.data[:-1].tolist()
                elif name == "csmip-usc-v2":
                    # Nothing closes a channel, and some agency files end after the acceleration.
                    assert trace.data.tolist() == full.data.tolist()
                    assert all(full.stats.kouros[key] == value for key, value in trace.stats.kouros.items())
                else:
                    assert trace.data.tolist() == full.data.tolist()
                    assert trace.stats.kouros == full.stats.kouros


AGENCY = {
    "np01002r_4225b_u.smc": "smc", "0111a.smc": "smc", "CHAN14.V2": "csmip", "CE89146.V1": "csmip",
    "ce36456p_CE36456.V2": "csmip", "20180212_211557_WPWS_20.V2A": "geonet", "NP1795-n.305.v0c": "cosmos",
}  # fmt: skip


@pytest.mark.parametrize("name", AGENCY)
def test_agency_records_cut_off(agency_file, name):
    """At places drawn by lot: what is read are whole channels of the record."""
    reader = importlib.import_module(f"pipeline.motions.formats.{AGENCY[name]}")
    content = agency_file(name).read_bytes()
    whole = reader.read_format(io.BytesIO(content))
    chance = random.Random(3)
    for _ in range(12):
        try:
            part = reader.read_format(io.BytesIO(content[: chance.randrange(len(content) - 200)]))
        except FormatError as refusal:
            said = str(refusal)
        else:
            said = f"line 0: {len(part)} of {len(whole)} channels"
            assert all(np.array_equal(a.data, b.data) for a, b in zip(part, whole, strict=False))
            assert len(part) < len(whole)
        assert re.search(r"line \d+: ", said)


@pytest.mark.parametrize("name", SPECIMENS)
def test_damage(name):
    seed = 1 if SECONDS is None else random.SystemRandom().randrange(2**32)
    chance = random.Random(seed)
    content = SPECIMENS[name][1]()
    readers = sum(SPECIMENS[other][0] == SPECIMENS[name][0] for other in SPECIMENS)
    until = time.monotonic() + (0.05 if SECONDS is None else float(SECONDS) / readers)
    rounds = 0
    while time.monotonic() < until or rounds < 20:
        broken = damaged(content, chance)
        try:
            judge(name, broken)
        except BaseException:
            Path(f"fuzz-{name}.bin").write_bytes(broken)
            print(f"seed {seed}, round {rounds}; the file is fuzz-{name}.bin")
            raise
        rounds += 1


@pytest.mark.parametrize("name", SPECIMENS)
def test_noise(name):
    chance = random.Random(2)
    for size in (0, 1, 2, 100, 5000):
        assert not judge(name, chance.randbytes(size))
        assert not judge(name, bytes(size))
        assert not judge(name, b"\n" * size)
        assert not judge(name, SPECIMENS[name][1]()[:200] + chance.randbytes(size))


HUNGRY = r"""
import io, re
from pathlib import Path
from pipeline.motions.formats import FormatError, bhrc, columns, cosmos, csmip, csmnc, cwa, esm, geonet, jma, nsmn
from pipeline.motions.formats import peer, smc, table, unam, volume1
from tests.motions.formats import national
from tests.motions.formats import specimens as hand
from tests.soak import SOAK
lines = hand.csmip().replace(b"    60 points", b"99999999 points")
at2 = b"PEER\\nA, 230\\nACCELERATION TIME SERIES IN UNITS OF G\\nNPTS= 99999999, DT= .01 SEC\\n"
many = 63_000_000
files = [
    (csmip, lines), (cosmos, hand.cosmos().replace(b"      60 acc", b"99999999 acc")),
    (smc, hand.smc().replace(b"        60    -32768", b"  99999999    -32768")),
    (esm, hand.esm(NDATA="999999999")), (geonet, hand.geonet().replace(b"points  60", b"points  99999999")),
    (peer, at2), (peer, lambda: at2 + b"\n" * many), (peer, lambda: at2 + b"12345678901\n" * 4_990_000),
    (peer, lambda: at2 + (b"1 " * 40 + b"\n") * (many // 81)), (peer, lambda: b"x" * many),
    (table, lambda: b"time (s)" + b",A (g)" * 1000 + b"\n" + b"1\n" * 4_000_000),
    (peer, lambda: b"x" * (many + 2_000_000)),
    (volume1, national.volume1().replace(b"=  60", b"=  99999999")), (bhrc, national.bhrc(999999)),
    (nsmn, lambda: national.nsmn(99999999) + b"1 2 3\n" * 4_900_000), (csmnc, national.csmnc(count=99999999)),
    (unam, national.unam().replace(b"/60/60/60", b"/99999999/99999999/99999999")),
    (cwa, national.cwa().replace(b"0.6", b"99999")), (jma, lambda: national.jma() + b"1,2\n" * 4_900_000),
    (columns, lambda: b"1 2\n" * 4_900_000),
]
# Every day those that announce much, and of those that send much every fourth one.
floods = [file for file in files if callable(file[1])]
for reader, content in files if SOAK else [file for file in files if file not in floods or file in floods[::4]]:
    try:
        reader.read_format(io.BytesIO(content() if callable(content) else content))
    except FormatError as error:
        assert "line" in str(error)
    else:
        raise SystemExit("was read")
print(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1])
"""


def test_never_a_gigabyte():
    """Announcing a hundred million samples, and sending 63 MB of the smallest lines and numbers that there are.

    The peak of the whole process, with obspy, with the test's own copy of the file (63 MB) and with Python's libraries;
    of its own memory: the `ru_maxrss` of a process begins with what its parent had when it was started.
    """
    done = subprocess.run(
        [sys.executable, "-c", HUNGRY], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr[-2000:] + done.stdout
    assert int(done.stdout) < 1_000_000
