"""Words of the desk: how long something takes, and names of fields as labels."""

from pipeline.report.language import _, local
from pipeline.report.text import words


def lasting(minutes: float) -> str:
    """Return how long something takes, in hours where it is more than one and a half."""
    if minutes <= _LONG:
        return _("%(minutes)s\u00a0min") % {"minutes": f"{minutes:.0f}"}
    hours = minutes / 60.0
    return _("%(hours)s\u00a0h") % {
        "hours": local(f"{hours:.1f}".removesuffix(".0") if hours < _MANY else f"{hours:.0f}")
    }


_LONG, _MANY = 90.0, 5.0


def name_told(name: str) -> str:
    """Return the name of a field as a label."""
    told = words(name)
    return told[:1].upper() + told[1:]
