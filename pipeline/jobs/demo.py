"""The whole job on the bundled collection and site, in a folder of its own."""

from pathlib import Path

from pipeline.jobs.importing import bundled_collection
from pipeline.jobs.nightly import Summary, run
from pipeline.records import Progress
from pipeline.resources import replacing
from pipeline.settings import Settings, load_settings, template

MUSEUM = "Carnegie Museum of Art (demonstration)"


def demonstration(folder: Path) -> Settings:
    """Return the demonstration's settings, written where they are missing.

    folder : kept from one demonstration to the next; the reports lie below it
    """
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "kouros.toml"
    if not file.exists():
        text = template(museum=MUSEUM, source=str(bundled_collection()), mapping="carnegie", site="demo")
        with replacing(file) as aside:
            aside.write_text(text, encoding="utf-8")
    return load_settings(file).model_copy(update={"demonstration": True})


def demo(folder: Path, progress: Progress) -> Summary:
    """Run the night with the demonstration's settings."""
    return run(demonstration(folder), progress)
