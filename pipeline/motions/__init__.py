"""Record files to motions: manifests, reading, processing, intensity.  The only package that knows obspy.

::

    from pipeline.motions import read_motion, read_site

    read_motion("site_motions/malibu")    # the processed motions of a manifest, in its order
    read_motion("CI.CLC..HNE.mseed")      # that of a record, from its file and those that belong to it
    read_motion("demo")                   # that of the site that comes with Kouros
    read_site("site_motions/malibu")      # a site's with levels, measures and who answers for them
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pipeline.motions.by_name import read_motion
    from pipeline.motions.errors import MotionError
    from pipeline.motions.intensity import measures
    from pipeline.motions.manifest import Manifest, load_manifest, manifest_schema
    from pipeline.motions.site import Level, Site, SiteMotion, read_site
    from pipeline.motions.summary import summaries

_HOMES = {
    "MotionError": "errors",
    "measures": "intensity",
    **dict.fromkeys(("Manifest", "load_manifest", "manifest_schema"), "manifest"),
    "read_motion": "by_name",
    **dict.fromkeys(("Level", "Site", "SiteMotion", "read_site"), "site"),
    "summaries": "summary",
}

__all__ = [
    "Level",
    "Manifest",
    "MotionError",
    "Site",
    "SiteMotion",
    "load_manifest",
    "manifest_schema",
    "measures",
    "read_motion",
    "read_site",
    "summaries",
]


def __getattr__(name: str) -> Any:
    # On demand: a program that only reads a file through obspy loads a reader of `formats`, and none of this.
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
