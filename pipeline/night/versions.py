"""What a verdict rests on besides its object and its motion, as short texts that are kept with a run."""

import hashlib

from pipeline.settings import Settings


def rules_digest(settings: Settings) -> str:
    """Return a digest of the museum's own rules of classification; "" where it has none."""
    own = settings.collection.rules
    return hashlib.sha256(settings.path(own).read_bytes()).hexdigest()[:12] if own else ""
