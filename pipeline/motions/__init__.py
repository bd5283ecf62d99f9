"""Record files to motions: manifests, reading, processing, intensity.  The only package that knows obspy.

::

    from pipeline.motions import read_motion, read_site

    read_motion("site_motions/malibu")    # the processed motions of a manifest, in its order
    read_site("site_motions/malibu")      # the same with levels, measures and who answers for them
"""

from pipeline.motions.errors import MotionError
from pipeline.motions.intensity import measures
from pipeline.motions.manifest import Manifest, load_manifest, manifest_schema
from pipeline.motions.site import Level, Site, SiteMotion, read_motion, read_site, summaries

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
