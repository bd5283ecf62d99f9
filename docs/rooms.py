"""What CONTRIBUTING.md repeats of the code: the table of rooms, in the words of their docstrings."""

import importlib
import inspect
import re
import tomllib

from docs.generate import ROOT, markdown_table, plain

CONTRIBUTING = ROOT / "CONTRIBUTING.md"

_ROOMS = re.compile(r"(?<=<!-- rooms: begin -->\n).*?(?=<!-- rooms: end -->)", re.S)


def rooms(container: str) -> str:
    """Return the rooms of a package, the top floor first, each in the words of its docstring."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    floors = next(c["layers"] for c in contracts if c["type"] == "layers" and c["containers"] == [container])
    rows = []
    for floor in floors:
        for room in re.split(r" [|:] ", floor):
            said = inspect.getdoc(importlib.import_module(f"{container}.{room}")) or ""
            rows.append((f"`{room}`", plain(said.partition("\n\n")[0])))
    return markdown_table(("Room", "What it is"), rows) + "\n"


def with_rooms(text: str) -> str:
    """Return the text of CONTRIBUTING.md with its table of rooms as the code has it."""
    analysis = "Inside the analysis, from findings down to the classes of objects:"
    tables = f"{rooms('pipeline')}\n{analysis}\n\n{rooms('pipeline.analysis')}"
    return _ROOMS.sub(lambda _: tables, text)


if __name__ == "__main__":
    CONTRIBUTING.write_text(with_rooms(CONTRIBUTING.read_text(encoding="utf-8")), encoding="utf-8")
