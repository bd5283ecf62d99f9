"""A new workspace: commented settings, an empty site, the database, units of systemd; or the demonstration."""

import getpass
import shutil
import sys
import tomllib
import warnings
from pathlib import Path

from pipeline.collection.database import database_url
from pipeline.operations.dry_run import DryRunWarning
from pipeline.operations.workspace import UsageError, open_workspace
from pipeline.resources import replacing, resource
from pipeline.settings import Settings, load_settings, template

MANIFEST = """\
# The motions of your site; it names none yet.  `kouros motions add FILES...` copies a record's files here and writes
# what they say below; comments stay.  Then `kouros motions show` and `kouros check`.  A site that is complete is copied
# over this folder, not into it (`cp -r THERE/. site_motions/site`), or named in kouros.toml, [site] folder.  The
# documentation (docs/how-to/records.md) lists what a record may say; an error names the key.

[site]
name = "Our site"
latitude = 0.0
longitude = 0.0

# [[level]]
# name = "design"
# return_period_years = 475
# combine = "max"            # with seven records and more: "mean"
# approved_by = "Name"       # the engineer who answers for these motions, and when
# approved_on = 2031-05-01
#
# [[level.record]]             # as many as the level has
# name = "Earthquake, station"
# files = ["record.mseed"]
# response = "station.xml"   # for raw counts; leave it out for processed records
# processed = false
# scale_to_pga_g = 0.5
# highpass_hz = 0.1          # left out: a corner is chosen, and the steps say why
# source = "whose record it is"
# licence = "under which licence"
# [level.record.components]    # without HNZ and with vertical = "absent" where no vertical was recorded
# HNE = { axis = "x", orientation = 90 }
# HNN = { axis = "y", orientation = 0 }
# HNZ = { axis = "z", orientation = "up" }
# [level.record.sha256]        # of every file named, as `kouros motions add` writes it
#
# [[floor]]                  # kouros.toml says which galleries stand on it
# name = "2"
# height_ratio = 0.5         # height of the floor over that of the building
# period_s = 0.4             # of the building, where it is known
"""


def initialise(folder: Path, *, dry_run: bool = False) -> list[Path]:
    """Make kouros.toml, site_motions/site and the database in a folder.

    Parameters
    ----------
    folder : Path
        It is made where there is none.
    dry_run : bool
        Make nothing.

    Returns
    -------
    list of Path
        What was made, or would be.

    Raises
    ------
    UsageError
        Where settings are there already; nothing is overwritten.
    """
    file = folder / "kouros.toml"
    if file.exists():
        raise UsageError(f"{file} is there already; remove it, or choose another folder")
    manifest = folder / "site_motions" / "site" / "manifest.toml"
    made = [file] if manifest.exists() else [file, manifest]
    text = template(museum="", source="", mapping="kouros", site="site_motions/site")
    if not dry_run:
        manifest.parent.mkdir(parents=True, exist_ok=True)
        if manifest in made:
            with replacing(manifest) as aside:
                aside.write_text(MANIFEST, encoding="utf-8")
        # Last, for where it is, nothing more is made.
        with replacing(file) as aside:
            aside.write_text(text, encoding="utf-8")
    settings = Settings(**tomllib.loads(text), home=folder)
    if not dry_run:
        open_workspace(settings)
    url = database_url(settings.database)
    return [*made, Path(url.database)] if url.get_backend_name() == "sqlite" and url.database else made


MUSEUM = "Carnegie Museum of Art (demonstration)"


def demonstration(folder: Path, *, dry_run: bool = False) -> Settings:
    """Return the demonstration's settings, written where they are missing.

    Parameters
    ----------
    folder : Path
        Kept from one demonstration to the next; the reports lie below it.
    dry_run : bool
        Write neither folder nor settings.

    Returns
    -------
    Settings
        Of the demonstration.
    """
    from pipeline.night.importing import bundled_collection

    file = folder / "kouros.toml"
    text = template(museum=MUSEUM, source=str(bundled_collection()), mapping="carnegie", site="demo_suite")
    if dry_run and not file.exists():
        warnings.warn(f"{file} is not there yet: the real one makes it", DryRunWarning, stacklevel=2)
        settings = Settings(**tomllib.loads(text), home=folder)
    else:
        folder.mkdir(parents=True, exist_ok=True)
        if not file.exists():
            with replacing(file) as aside:
                aside.write_text(text, encoding="utf-8")
        settings = load_settings(file)
    return settings.model_copy(update={"demonstration": True})


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
