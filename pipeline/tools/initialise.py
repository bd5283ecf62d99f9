"""A new workspace: commented settings, an empty site, the database."""

import tomllib
from pathlib import Path

from pipeline.collection.database import database_url
from pipeline.operations.workspace import UsageError, open_workspace
from pipeline.resources import replacing
from pipeline.settings import Settings, template

MANIFEST = """\
# The motions of your site; it names none yet.  `kouros motions add FILES...` copies a record's files here and writes
# what they say below; comments stay.  Then `kouros motions show` and `kouros check`.  The documentation
# (docs/how-to/records.md) lists what a record may say; an error names the key.

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
