"""Units of systemd for a workspace: the examples, with this machine's program, folder and user put in."""

import getpass
import shutil
import sys
from pathlib import Path

from pipeline.operations.workspace import UsageError
from pipeline.resources import replacing, resource

UNITS = ("kouros.service", "kouros.timer")

HOMES = ("/home", "/root", "/run/user")
"""Folders that ``ProtectHome=yes`` hides from a service."""


def write_units(folder: Path, *, dry_run: bool = False) -> list[Path]:
    """Write a service and its timer for the workspace in a folder.

    Parameters
    ----------
    folder : Path
        Of the workspace; the units are written into it.
    dry_run : bool
        Write nothing.

    Returns
    -------
    list of Path
        What was written, or would be.

    Raises
    ------
    UsageError
        Where units are there already, no program `kouros` is found, or a path holds what no unit can name.
    """
    home = folder.resolve()
    made = [home / name for name in UNITS]
    for file in made:
        if file.exists():
            raise UsageError(f"{file} is there already; remove it for a new one")
    service = _service(resource("examples", UNITS[0]).read_text(encoding="utf-8"), home, _program())
    texts = (service, resource("examples", UNITS[1]).read_text(encoding="utf-8"))
    if not dry_run:
        home.mkdir(parents=True, exist_ok=True)
        for file, text in zip(made, texts, strict=True):
            with replacing(file) as aside:
                aside.write_text(text, encoding="utf-8")
    return made


def _service(text: str, home: Path, program: Path) -> str:
    """Return the example of a service with its places exchanged for these; each of them must be there."""
    for path in (home, program):
        if not str(path).isprintable():
            raise UsageError(f"{str(path)!r} holds a character that no unit of systemd can name; choose another place")
    user = getpass.getuser()
    changes = {
        "\nUser=kouros\n": f"\nUser={'kouros' if user == 'root' else user}\n",
        "\nWorkingDirectory=/srv/kouros\n": f"\nWorkingDirectory={_percent(home)}\n",
        "\nExecStart=/opt/kouros/bin/kouros ": f"\nExecStart={_quoted(program, command=True)} ",
        "\nReadWritePaths=/srv/kouros\n": f"\nReadWritePaths={_quoted(home)}\n",
    }
    if any(path.is_relative_to(place) for path in (home, program) for place in HOMES):
        # Hidden, its own folder would be hidden too.
        changes["\nProtectHome=yes\n"] = "\nProtectHome=read-only\n"
    for before, after in changes.items():
        if before not in text:
            raise RuntimeError(f"{UNITS[0]} among the examples has no line {before.strip()!r}")
        text = text.replace(before, after)
    return text


def _percent(path: Path) -> str:
    return str(path).replace("%", "%%")


def _quoted(path: Path, *, command: bool = False) -> str:
    text = _percent(path)
    if command:
        text = text.replace("$", "$$")
    if not any(c in text for c in " \"'\\;"):
        return text
    text = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{text}"'


def _program() -> Path:
    """The program that a service is to start: that of this installation."""
    beside = Path(sys.executable).with_name("kouros")
    found = str(beside) if beside.is_file() else shutil.which("kouros")
    if found is None:
        raise UsageError(f"there is no program kouros beside {sys.executable}, nor on the path: install Kouros first")
    return Path(found).absolute()
