"""Cost of the stages of a night."""

import tempfile
import time
from pathlib import Path


def night() -> None:
    """Print what the first and the second night of the demonstration cost."""
    from pipeline.cli.console import Console
    from pipeline.night.run import run
    from pipeline.tools.initialise import demonstration

    with tempfile.TemporaryDirectory() as folder:
        for which in ("first", "second"):
            start = time.perf_counter()
            run(demonstration(Path(folder)), Console(quiet=True))
            print(f"{which} night of the demonstration: {time.perf_counter() - start:.1f} s")
