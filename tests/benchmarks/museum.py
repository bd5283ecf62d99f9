"""A museum of any size to measure with: real dimensions resampled with a fixed seed, and a suite of eleven motions.

Only the records that a museum published are used; what the museum is called, where its objects stand and what shakes it
is made up.  Without a spread copies of one record are one piece of work; with a spread sizes vary from copy to copy, so
that no two objects are.

KOUROS_BENCH_REAL names the whole exports that records are drawn from, as "carnegie=FILE,moma=FILE" (mapping=file), in
place of the thousands of rows that come with the tests.
"""

import csv
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.motions import read_motion
from pipeline.motions.manifest import SiteTable
from pipeline.motions.writing import write_site
from pipeline.night.importing import bundled_collection
from pipeline.quantities import Array, G
from pipeline.records import Item, Motion
from pipeline.resources import resource

SEED = 20_261_121
REAL = "KOUROS_BENCH_REAL"
SAMPLES, DT = 20_000, 0.005
PGA = tuple(np.linspace(0.2, 0.7, 11).tolist())
"""Of the suite's motions, g: the larger horizontal component."""

GALLERY = 500
"""Objects in each gallery."""

COLUMNS = (
    "object_number", "title", "object_name", "classification", "medium", "aat", "gallery", "height_m", "width_m",
    "depth_m", "mass_kg", "susceptible",
)  # fmt: skip

SETTINGS = """\
[museum]
name = "A museum of {objects} objects"

[collection]
source = "collection.csv"
mapping = "kouros"

[site]
folder = "site"
{more}"""


@dataclass(frozen=True)
class Museum:
    """Where everything of a made-up museum lies."""

    settings: Path
    collection: Path
    site: Path


def museum(folder: Path, objects: int, *, motions: int = len(PGA), spread: float = 0.0, more: str = "") -> Museum:
    """Write a museum with its settings, collection and site.

    spread : of the sizes of copies, relative
    more   : further settings, as TOML
    """
    folder.mkdir(parents=True, exist_ok=True)
    collection = folder / "collection.csv"
    write_collection(collection, objects, spread)
    site = SiteTable(name="A made-up suite", latitude=35.8, longitude=-117.6)
    told = [("design", motion) for motion in suite()[:motions]]
    write_site(folder / "site", told, site, licence="made up", why="eleven motions to measure with")
    settings = folder / "kouros.toml"
    settings.write_text(SETTINGS.format(objects=objects, more=more), encoding="utf-8")
    return Museum(settings, collection, folder / "site")


def real_items() -> list[Item]:
    """Return the real records that sizes are taken from: those of Carnegie and MoMA that have a height."""
    moma = Path(__file__).resolve().parents[1] / "data" / "collections" / "moma_rows.csv"
    files = [(bundled_collection(), "carnegie"), (moma, "moma")]
    if named := os.environ.get(REAL):
        files = [(Path(file), mapping) for mapping, _, file in (one.partition("=") for one in named.split(","))]
    items = [item for file, mapping in files for item in read_items(file, load_mapping(mapping)).items]
    return [item for item in items if item.height_m]


def write_collection(file: Path, objects: int, spread: float = 0.0) -> None:
    """Write a collection: real records drawn again and again, each time larger or smaller by the spread."""
    real = real_items()
    numbers = np.random.default_rng(SEED)
    drawn = numbers.integers(0, len(real), objects)
    sizes = numbers.lognormal(0.0, spread, (objects, 4))
    tough = numbers.random(objects) < 0.2
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        for at, (which, (h, w, d, m), hardy) in enumerate(zip(drawn, sizes, tough, strict=True)):
            item = real[which]
            measured = zip((item.height_m, item.width_m, item.depth_m, item.mass_kg), (h, w, d, m), strict=True)
            cells = ["" if value is None else f"{value * factor:.4g}" for value, factor in measured]
            what = (item.title, item.object_name, item.classification, item.medium, item.aat)
            gallery = f"Gallery {1 + at // GALLERY}"
            writer.writerow([f"X.{at:07d}", *what, gallery, *cells, "false" if hardy else ""])


def suite() -> list[Motion]:
    """Return one real motion and ten of shaped noise, three components of 20,000 samples, PGA from 0.2 to 0.7 g."""
    real = read_motion(resource("site_motions", "demo"))[0]
    found = [Motion(DT, _resampled(real), real.name, source=real.source)]
    found += [Motion(DT, _noise(seed), f"shaped noise {seed}") for seed in range(1, len(PGA))]
    return [_scaled(motion, pga) for motion, pga in zip(found, PGA, strict=True)]


def _scaled(motion: Motion, pga: float) -> Motion:
    factor = pga * G / float(np.abs(motion.acceleration[:2]).max())
    return Motion(motion.dt, factor * motion.acceleration, motion.name, source=motion.source)


def _resampled(motion: Motion) -> Array:
    times = DT * np.arange(SAMPLES)
    own = motion.dt * np.arange(motion.acceleration.shape[1])
    return np.array([np.interp(times, own, row, right=0.0) for row in motion.acceleration])


def _noise(seed: int) -> Array:
    """Noise through the ground filter of Kanai and Tajimi (2.5 Hz, 60 %), growing and fading."""
    numbers = np.random.default_rng([SEED, seed])
    f = np.fft.rfftfreq(SAMPLES, DT)
    ratio = 1j * f / 2.5
    ground = (1.0 + 1.2 * ratio) / (1.0 + 1.2 * ratio + ratio**2)
    band = f**4 / (f**4 + 0.2**4) / (1.0 + (f / 20.0) ** 8)
    t = DT * np.arange(SAMPLES)
    envelope = np.minimum(1.0, t / 4.0) ** 2 * np.exp(-np.maximum(0.0, t - 14.0) / 9.0)
    rows = np.fft.irfft(np.fft.rfft(numbers.normal(size=(3, SAMPLES))) * ground * band, SAMPLES) * envelope
    rows[2] *= 0.6
    return np.asarray(rows)
