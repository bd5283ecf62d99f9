"""Sphinx builds these pages: `make docs`.  What is generated from code is written before they are read."""

import sys
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]

import generate  # noqa: E402

from pipeline import __version__  # noqa: E402

project = "Kouros"
author = "the Kouros maintainers"
release = version = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
exclude_patterns = ["build"]
html_theme = "furo"
html_title = f"Kouros {release}"
html_show_copyright = False
html_static_path = ["static"]
html_css_files = ["kouros.css"]
html_show_sphinx = False

# Every reference that leads nowhere is a warning, and `make docs` makes warnings errors.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r".*")]  # types of other libraries, whose pages are not fetched
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "deflist"]
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False


def setup(app: Sphinx) -> None:
    """Write the generated pages before Sphinx looks for pages."""
    app.add_lexer("csv", TextLexer)
    app.add_lexer("obj", TextLexer)
    app.connect("builder-inited", lambda _app: generate.write(Path(__file__).parent / "reference" / "generated"))
