"""What to do about an object, and what was done, in the words of the news."""

from pipeline.records import Brief
from pipeline.report.language import _, said
from pipeline.report.text import clean, short, words

TITLE = 80
"""Characters of a title in the news."""


def to_do(brief: Brief) -> str:
    """Say what to do about an object, in words that follow a colon."""
    if brief.check:
        # What is advised for sizes that nobody believes is not built.
        return _("check its sizes first")
    if not brief.measure:
        return _("ask an engineer")
    known = _WORDS.get(brief.measure)
    return said(short(brief.advice, TITLE)) if known is None else known[0]()


def was_done(measure: str) -> str:
    """Say what was done, by the name of the measure."""
    known = _WORDS.get(measure)
    return words(clean(measure)) if known is None else known[1]()


# By row of tables/measures.csv, what to do and what was done; looked up in the language of the page.  The museum's own
# measures are told by their titles.
_WORDS = {
    "chocks": (lambda: _("chock its wheels"), lambda: _("on chocked wheels")),
    "clearance": (lambda: _("keep it clear"), lambda: _("kept clear")),
    "anchor": (lambda: _("fasten its furniture"), lambda: _("its furniture fastened")),
    "rubber_pads": (lambda: _("put rubber pads behind it"), lambda: _("rubber pads behind it")),
    "surface": (lambda: _("stand it on another surface"), lambda: _("on another surface")),
    "grip_pad": (lambda: _("stand it on a non-slip pad"), lambda: _("on a non-slip pad")),
    "pins": (lambda: _("set padded pins round its foot"), lambda: _("held by pins")),
    "wax": (lambda: _("fix it with wax"), lambda: _("fixed with wax")),
    "putty": (lambda: _("fix it with putty"), lambda: _("fixed with putty")),
    "ties": (lambda: _("tie it down"), lambda: _("tied down")),
    "clips": (lambda: _("hold its foot by clips"), lambda: _("held by clips")),
    "ballast": (lambda: _("put ballast into its base"), lambda: _("ballast in its base")),
    "wide_base": (lambda: _("give it a wider base"), lambda: _("on a wider base")),
    "brackets": (lambda: _("fix it to the wall by brackets"), lambda: _("held by brackets")),
    "clamps": (lambda: _("clamp it"), lambda: _("clamped")),
    "fasten": (lambda: _("fasten it"), lambda: _("fastened")),
    "brace": (lambda: _("brace it"), lambda: _("braced")),
    "armature": (lambda: _("brace it at two heights"), lambda: _("braced at two heights")),
    "close_hooks": (lambda: _("close its hooks"), lambda: _("its hooks closed")),
    "hold": (lambda: _("hold it on its mount"), lambda: _("held on its mount")),
    "restrain": (lambda: _("fix it to the wall"), lambda: _("fixed to the wall")),
    "stays": (lambda: _("stay it to all sides"), lambda: _("stayed to all sides")),
    "friction_isolator": (lambda: _("stand it on a low-friction pad"), lambda: _("on a low-friction pad")),
    "horizontal_isolator": (lambda: _("put it on a horizontal isolator"), lambda: _("on a horizontal isolator")),
    "rotational_isolator": (lambda: _("mount it on a rotational isolator"), lambda: _("on a rotational isolator")),
    "strengthen": (lambda: _("have it strengthened and fastened"), lambda: _("strengthened and fastened")),
    "remove": (lambda: _("take it off display"), lambda: _("taken off display")),
}
