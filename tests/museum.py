"""Small museums that tests work with: settings, collections, sites and mappings; a night of theirs; the command."""

import csv
import os
import shutil
import subprocess
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

from pipeline.cache import CHARTS, MOTIONS, PICTURES, SPECTRA
from pipeline.cli.console import Console
from pipeline.collection.database import open_database
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.night.importing import bundled_collection
from pipeline.night.run import run
from pipeline.operations.run_summary import Summary
from pipeline.records import Furniture, Item, RunRecord
from pipeline.resources import resource
from pipeline.settings import KEPT, Settings, load_settings, template
from pipeline.store.migrate import upgrade
from pipeline.store.runs import load_run
from tests.conftest import SHARED
from tests.warm import kouros_process

DATABASE = "kouros.sqlite"
SILENT = Console(quiet=True)
VASE = Item("1", "G", title="Covered vase", classification="Ceramics", medium="porcelain",
            height_m=0.4, width_m=0.2, depth_m=0.2, furniture=Furniture.FLOOR)  # fmt: skip
PAINTING = Item("3", "G", title="Landscape", classification="paintings", height_m=1.0, width_m=1.2)
COLUMNS = "object_number,gallery,title,height_m,width_m,depth_m"
ROWS = ['1,"Gallery ""A"" <b>",<script>alert(1)</script>,1.2,0.2,0.2', "2,B,Plate,0.03,0.3,0.3", "3,B,Vase,,,"]
MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test"
[columns.object_number]
column = "object_number"
[columns.gallery]
column = "gallery"
[columns.title]
column = "title"
[columns.height_m]
column = "height_m"
unit = "m"
[columns.width_m]
column = "width_m"
unit = "m"
[columns.depth_m]
column = "depth_m"
unit = "m"
"""
VASE_COLUMNS = (
    "object_number", "title", "object_name", "gallery", "height_m", "width_m", "depth_m", "medium", "furniture",
)  # fmt: skip


@cache
def carnegie() -> Reading:
    """The bundled collection as it is read: once for all tests of a process, who only look at it."""
    return read_items(bundled_collection(), load_mapping("carnegie"))


OF_MOTIONS = (MOTIONS, CHARTS, PICTURES, SPECTRA)
"""What is kept of motions alone, whatever objects there are."""


def in_common(folder: Path, kinds: tuple[str, ...] = OF_MOTIONS) -> None:
    """Let a museum in a folder keep what it finds of motions where all others do: it is the same whoever found it."""
    for kind in kinds:
        kept = folder / KEPT / kind
        if not kept.exists():
            kept.parent.mkdir(parents=True, exist_ok=True)
            common = Path(os.environ[SHARED]) / kind
            common.mkdir(exist_ok=True)
            kept.symlink_to(common, target_is_directory=True)


@cache
def _tables() -> Path:
    """The file of a database in which all tables are, and no row."""
    file = Path(tempfile.mkdtemp(dir=os.environ[SHARED])) / DATABASE
    upgrade(open_database(file))
    return file


def with_tables(file: Path) -> None:
    """Put a database with all tables where there is none: copied, which is faster than made by each migration."""
    if not file.exists():
        shutil.copyfile(_tables(), file)


def workspace(
    folder: Path, rows: list[str] | None = None, site: str = "brief", *, furnished: bool = False, sampled: bool = False
) -> Settings:
    """A small museum of its own in a folder; only what it finds of motions it has in common with all others.

    site : a folder, made by `own_site` where it is missing and no other is named, or a bundled site by its name
    furnished : what stands free is in furniture that nobody names, not on the floor: variants, half of a night
    sampled : probabilities and curves are found, half of a night too
    """
    in_common(folder)
    if site == "brief" and not (folder / site).exists():
        own_site(folder, site)
    with_tables(folder / DATABASE)
    (folder / "export.csv").write_text("\n".join([COLUMNS, *(ROWS if rows is None else rows)]) + "\n", encoding="utf-8")
    (folder / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    file = folder / "kouros.toml"
    text = template(museum="Test", source="export.csv", mapping="mapping.toml", site=site)
    file.write_text(small(text, sampled=sampled), encoding="utf-8")
    return load_settings(file) if furnished else on_the_floor(folder)


def small(settings: str, *, sampled: bool = True) -> str:
    """Let the nights of settings cost as little as those of a few objects may: few samples or none, on one thread."""
    return one_thread(few_samples(settings, sampled=sampled))


def few_samples(settings: str, *, sampled: bool = True) -> str:
    """Let settings draw as few samples as they can, or none, and no curves: most of a small night is spent on them."""
    assert "samples = 512" in settings
    assert 'fragility = "auto"' in settings
    if sampled:
        return settings.replace("samples = 512", "samples = 64")
    return settings.replace("samples = 512", "samples = 0").replace('fragility = "auto"', "fragility = false")


def one_thread(settings: str) -> str:
    """Let a night of a few objects work on one thread: to start others for each step takes a tenth of it.

    That threads change no digit is for tests that have several: those of processes and clusters, and of the analysis.
    """
    assert "workers = 0" in settings
    return settings.replace("workers = 0", "workers = 1")


def on_the_floor(folder: Path) -> Settings:
    """Let a house rule of the museum in a folder say that everything stands on the floor itself."""
    rule = '\n[[house]]\nsupport = "freestanding"\nfurniture = "floor"\nsaid_by = "a test"\nsaid_on = 2026-01-01\n'
    file = folder / "kouros.toml"
    file.write_text(file.read_text(encoding="utf-8") + rule, encoding="utf-8")
    return load_settings(file)


def own_site(folder: Path, name: str = "site", window_s: tuple[float, float] = (30.0, 60.0)) -> Path:
    """A copy of the bundled site that a test may break, of the main shock without what is quiet around it.

    These 30 s have the peaks of all 100 s, and of their Arias intensity all but a hundredth: nights take a third.
    """
    site = Path(shutil.copytree(resource("site_motions", "demo"), folder / name))
    edit(site / "manifest.toml", "window_s = [20.0, 120.0]", f"window_s = {list(window_s)}")
    return site


def short_site(folder: Path) -> Path:
    """The manifest of a site of one short motion: 7 m/s2 at 1.5 Hz, strong enough to tip vases; a test may edit it."""
    words = ("sine", "amplitude=7", "frequency=1.5", "cycles=3", "--out", "site")
    assert kouros("motions", "synthesise", *words, folder=folder).returncode == 0
    manifest = folder / "site" / "manifest.toml"
    edit(manifest, "processed = true", "processed = true\nscale = 1.0")
    return manifest


def edit(file: Path, before: str, after: str) -> None:
    """Replace words of a file that must be there."""
    said = file.read_text(encoding="utf-8")
    assert before in said
    file.write_text(said.replace(before, after), encoding="utf-8")


def vases(galleries: int = 3, each: int = 4) -> list[dict[str, str]]:
    """A few vases of different sizes in a few galleries, as rows of an export."""
    return [
        {
            "object_number": f"{g}.{n}",
            "title": f"Vase {n}",
            "object_name": "vase",
            "gallery": f"Room {g}",
            "height_m": str(round(0.2 + 0.1 * n, 3)),
            "width_m": str(round(0.1 + 0.02 * g, 3)),
            "depth_m": "0.12",
            "medium": "earthenware",
        }
        for g in range(galleries)
        for n in range(each)
    ]


def write_collection(folder: Path, objects: list[dict[str, str]]) -> None:
    """Write rows such as those of `vases` as the export of the museum in a folder."""
    with (folder / "collection.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, VASE_COLUMNS)
        writer.writeheader()
        writer.writerows(objects)


def museum_of(
    folder: Path,
    objects: list[dict[str, str]],
    *,
    own_charts: bool = False,
    threads: bool = False,
    furnished: bool = False,
    sampled: bool = False,
) -> Settings:
    """A museum of rows such as those of `vases`, with a copy of the bundled site; one thread works unless all shall.

    sampled : probabilities and curves are found, half of a night
    """
    folder.mkdir(parents=True)
    with_tables(folder / DATABASE)
    if not own_charts:
        in_common(folder)
    write_collection(folder, objects)
    text = template(museum="Three rooms", source="collection.csv", mapping="kouros", site="site")
    (folder / "kouros.toml").write_text(
        few_samples(text, sampled=sampled) if threads else small(text, sampled=sampled), encoding="utf-8"
    )
    own_site(folder)
    return load_settings(folder / "kouros.toml") if furnished else on_the_floor(folder)


def night(settings: Settings) -> Summary:
    """Run a night and tell nobody."""
    return run(settings, SILENT)


def found(settings: Settings) -> RunRecord:
    """Return the last run without what tells one night from another, and one museum's history from another's."""
    record = load_run(open_database(settings.database))
    kept = {k: v for k, v in record.settings.items() if k not in ("survey_seconds", "inventory")}
    return replace(record, run_id="", started="", finished="", settings=kept)


def kouros(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command in a folder, as a process of its own; response charts are those of all museums."""
    if "run" in words and (folder / "kouros.toml").exists():
        in_common(folder)
    return kouros_process(words, folder)
