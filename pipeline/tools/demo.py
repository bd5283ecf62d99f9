"""The whole job on the bundled collection and site, in a folder of its own."""

import tomllib
import warnings
from pathlib import Path

from pipeline.night.importing import bundled_collection
from pipeline.night.run import run
from pipeline.operations.dry_run import DryRunWarning
from pipeline.operations.run_summary import Summary
from pipeline.records import Progress
from pipeline.resources import replacing
from pipeline.settings import Settings, load_settings, template

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


def demo(folder: Path, progress: Progress) -> Summary:
    """Run the night with the demonstration's settings.

    Parameters
    ----------
    folder : Path
        As of `demonstration`.
    progress : callable
        Is told what is done, of how much.

    Returns
    -------
    Summary
        Of the run.
    """
    return run(demonstration(folder), progress)
