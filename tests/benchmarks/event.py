"""What an answer to an earthquake costs, in starts of the command: seconds of the processor over seconds of it.

KOUROS_BENCH_FOLDER names the folder of a museum with a run behind it; without it the demonstration's is made, which
takes minutes.  The answers are written into a copy of its database and of what is kept.
"""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROUNDS = 3
"""Rounds of each of which the cheapest counts."""

WORDS = {
    "a start alone (kouros models)": ("models",),
    "first answer, no model": ("event", "--pga", "0.3", "--pgv", "30", "--ln-sd", "0.3", "--seconds", "0"),
    "both answers, 4 s of models": ("event", "--pga", "0.3", "--pgv", "30", "--ln-sd", "0.3"),
    "again, by one report": ("event", "--report", "found.csv"),
}


def answers() -> None:
    """Print what each costs in seconds of the processor, and in starts of the command."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "museum"
        given = os.environ.get("KOUROS_BENCH_FOLDER")
        if given:
            left = shutil.ignore_patterns("reports", "events")
            shutil.copytree(given, folder, symlinks=True, ignore=left)
        else:
            _cost(("demo", str(folder)), Path(name))
        number = ""
        print(f"kouros event, whole process, the cheapest of {ROUNDS}; read the ratios")
        print(f"{'':<34}{'processor s':>12}{'starts':>8}")
        start = 0.0
        for title, words in WORDS.items():
            costs = []
            for _ in range(ROUNDS):
                if "--report" in words:
                    number = number or _first(folder)
                    state = ("standing", "moved", "fallen")[len(costs)]
                    (folder / "found.csv").write_text(f'object,state\n"{number}",{state}\n', encoding="utf-8")
                else:
                    shutil.rmtree(folder / "events", ignore_errors=True)
                costs.append(_cost(words, folder))
            start = start or min(costs)
            print(f"{title:<34}{min(costs):>12.2f}{min(costs) / start:>8.1f}", flush=True)


def _first(folder: Path) -> str:
    """Return the number of the object of which most is lost."""
    import csv

    (file,) = folder.glob("events/*/latest/objects.csv")
    with file.open(encoding="utf-8", newline="") as stream:
        return next(csv.DictReader(stream))["object_number"].replace('"', '""')


def _cost(words: tuple[str, ...], folder: Path) -> float:
    program = "import sys; sys.argv = ['kouros', *sys.argv[1:]]; from pipeline.cli import main; main()"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", program, *words], check=True, cwd=folder, env=env, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
