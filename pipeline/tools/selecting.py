"""Selection of a suite from folders of records: what is asked, and the site that is written of it."""

import csv
import hashlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pipeline.motions.candidates import CandidateRecord
from pipeline.motions.choosing import Suite, SuiteWish, choose_suite
from pipeline.motions.errors import MotionError
from pipeline.motions.manifest import LEAST_FOR_MEAN, SiteTable
from pipeline.motions.record import Record
from pipeline.motions.targets import Choice, Horizontal, read_target
from pipeline.motions.writing import write_records
from pipeline.operations.workspace import UsageError
from pipeline.quantities import G

SELECTION = "selection.csv"
"""The choice as a table, beside the manifest."""


@dataclass(frozen=True, slots=True)
class SitePlace:
    """What the new site is called and where it is; what is None follows from the target or the folder.

    Attributes
    ----------
    name : str
        Of the site.
    level : str or None
        Of the level of shaking.
    latitude, longitude : float or None
        In degrees north and east.
    return_period_years : float or None
        Of the level.
    combine : {"max", "mean"} or None
        How the motions decide together; None: the mean from seven motions on, else the worst.
    """

    name: str = "Selected site"
    level: str | None = None
    latitude: float | None = None
    longitude: float | None = None
    return_period_years: float | None = None
    combine: Literal["max", "mean"] | None = None


def select(
    folders: Sequence[Path],
    target: Path,
    wish: SuiteWish,
    *,
    choice: Choice = "design",
    component: Horizontal | None = None,
) -> Suite:
    """Choose and scale records of folders for a target spectrum, see `motions.choosing`.

    Parameters
    ----------
    folders : sequence of Path
        The records.
    target : Path
        The file of the target.
    wish : SuiteWish
        What the suite shall be.
    choice : {"design", "mcer"}
        Which spectrum of a design service's answer.
    component : {"rotd50", "rotd100"} or None
        The horizontal measure of the target; None: as `targets.read_target`.

    Returns
    -------
    Suite
        The best that there is, with what is lacking.
    """
    return choose_suite(folders, read_target(target, choice, component), wish, leave=(target,))


def refused(suite: Suite, folders: Sequence[Path]) -> MotionError:
    """Return the error of a suite that does not meet what was asked for."""
    told = "\n  ".join(suite.lacking)
    return MotionError(
        f"{', '.join(map(str, folders))}: no suite meets the target:\n  {told}\n--best takes the best that there is"
    )


def combined(suite: Suite, place: SitePlace) -> str:
    """Return how the motions of a suite decide together: "max" or "mean"."""
    return place.combine or ("mean" if len(suite.motions) >= LEAST_FOR_MEAN else "max")


def write(suite: Suite, target: Path, out: Path, place: SitePlace, *, dry_run: bool = False) -> Path:
    """Write a suite as a site: its records' files, a manifest with the scales, and the choice as a table.

    Parameters
    ----------
    suite : Suite
        What was chosen.
    target : Path
        The file of the target that it was chosen for.
    out : Path
        The folder of the new site.
    place : SitePlace
        What it is called and where it is.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    UsageError
        Where nothing says where the site is.
    MotionError
        Where there is a site already.
    """
    spectrum = suite.target
    digest = hashlib.sha256(target.read_bytes()).hexdigest()
    level: dict[str, Any] = {"name": place.level or spectrum.level, "combine": combined(suite, place)}
    if place.return_period_years is not None:
        level["return_period_years"] = place.return_period_years
    level["target"] = {
        "periods_s": spectrum.periods.tolist(),
        "psa_g": spectrum.psa_g.tolist(),
        "period_range_s": list(suite.wish.periods),
        "component": spectrum.component,
        "source": f"{spectrum.name}; {target.name}, sha256 {digest}"[:500],
    }
    below = _below(suite)
    records: list[tuple[Record, str]] = []
    files: dict[str, Path] = {}
    for one in suite.motions:
        record, folder = one.candidate.record, one.candidate.folder
        placed = _placed(one.candidate, below)
        files |= {name: folder / file for name, file in zip(placed.all_files, record.all_files, strict=True)}
        v_max = None if placed.v_max_cm_s is None else one.scale * placed.v_max_cm_s
        scaled = placed.model_copy(update={"scale": one.scale, "v_max_cm_s": v_max})
        records.append((scaled, f"chosen: {one.why}"))
    why = [
        f"Chosen by: kouros motions select, for {spectrum.name}",
        f"{len(suite.motions)} motions, periods {suite.wish.periods[0]:g} to {suite.wish.periods[1]:g} s, "
        f"{spectrum.component}, scales up to {suite.wish.largest_scale:g}, seed {suite.wish.seed}; see {SELECTION}",
        *(f"It does not meet the target: {told}" for told in suite.lacking),
    ]
    return write_records(
        out,
        _site(suite, place),
        level,
        records,
        files,
        why=why,
        beside={SELECTION: table(suite)},
        dry_run=dry_run,
    )


def _below(suite: Suite) -> dict[Path, str]:
    """Of each folder that a suite was chosen from, where its files go; nothing for a single folder."""
    folders = list(dict.fromkeys(one.candidate.folder for one in suite.motions))
    return {f: f"{n}-{f.resolve().name}" for n, f in enumerate(folders, start=1)} if len(folders) > 1 else {}


def _placed(candidate: CandidateRecord, below: Mapping[Path, str]) -> Record:
    return candidate.record.inside(below[candidate.folder]) if below else candidate.record


def _site(suite: Suite, place: SitePlace) -> SiteTable:
    known = suite.found.site
    north, east = suite.target.place or ((known.latitude, known.longitude) if known else (None, None))
    latitude = north if place.latitude is None else place.latitude
    longitude = east if place.longitude is None else place.longitude
    if latitude is None or longitude is None:
        raise UsageError("neither the target nor the folder says where the site is: --latitude and --longitude")
    # The motions of a site's folder were turned to its own axes.
    azimuth: dict[str, Any] = {} if known is None else {"x_azimuth": known.x_azimuth}
    return SiteTable(name=place.name, latitude=latitude, longitude=longitude, **azimuth)


def rows(suite: Suite) -> list[dict[str, str | float]]:
    """Return the motions of a suite as plain values, one row each.

    Parameters
    ----------
    suite : Suite

    Returns
    -------
    list of dict
        record, scale, pga_g, pgv_cm_s, misfit_ln, station, files (as the new site names them), motion_sha256 (of the
        unscaled samples) and why.
    """
    below = _below(suite)
    return [
        {
            "record": one.candidate.record.name,
            "scale": one.scale,
            "pga_g": round(one.pga / G, 4),
            "pgv_cm_s": round(100.0 * one.pgv, 2),
            "misfit_ln": round(one.misfit, 4),
            "station": one.candidate.station or "",
            "files": " ".join(_placed(one.candidate, below).all_files),
            "motion_sha256": one.candidate.motion.hash,
            "why": one.why,
        }
        for one in suite.motions
    ]


def table(suite: Suite) -> str:
    """Return `rows` as CSV."""
    out = io.StringIO()
    found = rows(suite)
    writer = csv.DictWriter(out, fieldnames=list(found[0]) if found else ["record"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return out.getvalue()


def described(suite: Suite) -> Mapping[str, Any]:
    """Return a suite as plain values for programs: periods in s, spectra in g, how it meets the target."""
    mean, sd = suite.target.at(suite.periods)
    off = suite.spread_off
    return {
        "target": suite.target.name,
        "component": suite.target.component,
        "periods_s": suite.periods.tolist(),
        "target_ln_g": mean.tolist(),
        "target_ln_sd": None if sd is None else sd.tolist(),
        "mean_ratio": suite.ratio.tolist(),
        "arithmetic_mean_ratio": suite.arithmetic_ratio.tolist(),
        "spread_ln": suite.spread.tolist(),
        "spread_off": None if off is None else off.tolist(),
        "meets_target": not suite.lacking,
        "lacking": list(suite.lacking),
        "motions": rows(suite),
        "unusable": [{"name": one.name, "reason": one.reason} for one in suite.found.unusable],
    }
