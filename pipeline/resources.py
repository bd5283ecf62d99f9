"""Where the files that travel with Kouros are, in a checkout and in an installed wheel alike."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def resource(*parts: str) -> Path:
    """Return the path of a bundled file or folder, such as ``resource("templates", "gallery.html")``.

    A wheel carries ``schemas``, ``templates`` and ``site_motions`` inside the package; a checkout has them beside it.

    raises : FileNotFoundError, naming both places looked in
    """
    installed = _PACKAGE.joinpath("_resources", *parts)
    if installed.exists():
        return installed
    checkout = _PACKAGE.parent.joinpath(*parts)
    if checkout.exists():
        return checkout
    raise FileNotFoundError(f"{'/'.join(parts)} is neither in {installed} nor in {checkout}; reinstall kouros")
