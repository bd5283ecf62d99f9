"""The texts that results share, for a dictionary that they are compressed with (see `pipeline.store.codec`).

`python -m tests.benchmarks.dictionary DATABASE... > FILE` takes every 20th result of some databases; the file goes to
`pipeline/store/dictionaries`, named by its checksum, which is printed.
"""

import re
import sqlite3
import sys
import zlib
from collections import Counter
from collections.abc import Iterable

from pipeline.store.codec import inflated, joined

SIZE = 8_000
"""Bytes: twice as many save 5 % more."""

WORTH = 450
"""Bytes that a text must save in all the results that were looked at."""

NEW = 0.2
"""Part of a text that the texts before it do not have, at least: else it takes the place of others."""

VARYING = re.compile(r'"motion":"[^"]*"|-?\d+\.\d{3,}(?:e-?\d+)?|[0-9a-f]{16,}')
"""What differs from object to object and from museum to museum: motions, numbers, digests."""


def shared(results: Iterable[str]) -> list[str]:
    """Return the texts between what varies that save most, the most common last, where they are named in fewer bits."""
    counts = Counter(text for one in results for text in {*VARYING.split(one)} if len(text) > 12)
    chosen: list[tuple[int, str]] = []
    whole = ""
    for text, number in sorted(counts.items(), key=lambda one: -len(one[0]) * one[1]):
        if text in whole:
            continue
        packer = zlib.compressobj(6, zdict=whole[-32_000:].encode()) if whole else zlib.compressobj(6)
        new = len(packer.compress(text.encode()) + packer.flush())
        if new >= NEW * len(text) and new * number >= WORTH:
            chosen.append((number, text))
            whole += text
        if len(whole) > SIZE:
            break
    return [text for _, text in sorted(chosen)]


def main(files: list[str]) -> None:
    """Print the dictionary, and its checksum beside."""
    found = []
    for file in files:
        rows = sqlite3.connect(f"file:{file}?mode=ro", uri=True).execute(
            "SELECT found FROM result WHERE rowid % 20 = 0"
        )
        found += [inflated(row[0]).decode() for row in rows]
    text = "\n".join(shared(found)) + "\n"
    print(text, end="")
    print(f"{zlib.adler32(joined(text)):08x}", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
