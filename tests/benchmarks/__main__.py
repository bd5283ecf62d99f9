"""Kouros beside its peers, beside C, and by itself: `python -m tests.benchmarks [peers] [native] [models] [charts]
[auto] [night] [starts] [event] [agencies]`.

Machines are noisy: read the ratios of one run, not the times.
"""

import sys

from tests.benchmarks import (
    agencies,
    auto,
    charts,
    event,
    general,
    models,
    multibody,
    native,
    night,
    opensees,
    scale,
    spectra,
    starts,
)
from tests.benchmarks.common import FAR, HEADING, OBJECTS, marked


def peers() -> None:
    """Print the table of comparisons, one row a peer and setting."""
    print(
        f"One thread; ours is one of {OBJECTS} analyses in one call.  Errors of the peak: median / worst.  '!': below"
    )
    print(
        "what is wanted.  The ratio to read is that of a peer's coarsest setting with all outcomes right and a median"
    )
    print(f"error below {FAR:.0%}: a faster one gives another answer.")
    print(HEADING)
    for compare in (
        spectra.comparisons,
        general.one_way,
        opensees.comparisons,
        multibody.comparisons,
        general.by_scipy,
    ):
        for row, counts in marked(compare()):
            print(row.line(counts), flush=True)


PARTS = {
    "peers": peers,
    "native": native.native,
    "models": models.costs,
    "charts": charts.lookups,
    "auto": auto.auto,
    "night": night.night,
    "scale": scale.scale,
    "starts": starts.starts,
    "event": event.answers,
    "agencies": agencies.agencies,
}


def main(wanted: list[str]) -> None:
    """Run the parts named, or all.

    raises : SystemExit for a part that there is not
    """
    for name in wanted:
        if name not in PARTS:
            raise SystemExit(f"there is no part {name!r}; choose from {', '.join(PARTS)}")
    for name in wanted or PARTS:
        PARTS[name]()
        print()


if __name__ == "__main__":
    main(sys.argv[1:])
