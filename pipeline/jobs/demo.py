"""The whole job on the bundled collection and site, in a folder of its own."""

from pathlib import Path

from pipeline.jobs.importing import bundled_collection
from pipeline.jobs.nightly import Summary, run
from pipeline.records import Progress
from pipeline.settings import load_settings, template

MUSEUM = "Carnegie Museum of Art (demonstration)"


def demo(folder: Path, progress: Progress) -> Summary:
    """Write the demonstration's settings where they are missing, and run the night with them.

    folder : kept from one demonstration to the next; the reports lie below it
    """
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "kouros.toml"
    if not file.exists():
        text = template(museum=MUSEUM, source=str(bundled_collection()), mapping="carnegie", site="demo")
        file.write_text(text, encoding="utf-8")
    settings = load_settings(file).model_copy(update={"demonstration": True})
    return run(settings, progress)
