"""Names of photographs in a museum's records: files, URLs and addresses of IIIF."""

from __future__ import annotations

import re
from string import Formatter
from urllib.parse import quote, urlsplit

_ENDING = re.compile(r"\.(?:jpe?g|png|tiff?|webp|gif|bmp)$", re.IGNORECASE)
_IIIF = re.compile(
    r"/(?:manifest(?:\.json)?|info\.json)/?$|/manifests?/[^/]+/?$|/iiif/|/(?:full|\d+,\d+,\d+,\d+)/[^/]+/\d+/\w+\.\w+$",
    re.I,
)
_SPLIT = re.compile(r"\s*[|;\n]\s*")

SCHEMES = ("https://", "http://")
"""How an address of the network begins; all else is a file."""


def is_image_name(text: str) -> bool:
    """Say whether a text is the name of an image file, the URL of one, or an address of IIIF.

    Parameters
    ----------
    text : str
        Such as a cell.

    Returns
    -------
    bool
    """
    text = text.strip()
    if not text.casefold().startswith(SCHEMES):
        return bool(_ENDING.search(text)) and "\n" not in text
    path = urlsplit(text).path if _is_url(text) else ""
    return bool(_ENDING.search(path) or _IIIF.search(path))


def _is_url(text: str) -> bool:
    try:
        return bool(urlsplit(text).hostname)
    except ValueError:
        return False


def first_of(text: str) -> str:
    """Return the first of several photographs that one cell names, parted by `|`, `;` or a line break.

    Parameters
    ----------
    text : str
        The cell.

    Returns
    -------
    str
        The whole text, unless all its parts are names of photographs.
    """
    parts = [part for part in _SPLIT.split(text.strip()) if part]
    return parts[0] if len(parts) > 1 and all(map(is_image_name, parts)) else text.strip()


def pattern_keys(pattern: str) -> set[str]:
    """Return the words that a pattern has in braces; what is no pattern has a word that no pattern may have."""
    try:
        return {
            key + (spec or "") + (turned or "")
            for _, key, spec, turned in Formatter().parse(pattern)
            if key is not None
        }
    except ValueError:
        return {"{"}


def of_pattern(pattern: str, object_number: str, image: str) -> str:
    """Return where a photograph is.

    Parameters
    ----------
    pattern : str
        Of the mapping, "" for none.
    object_number : str
        Of the object.
    image : str
        What its column gives, "" for nothing.

    Returns
    -------
    str
        What the column gives where no pattern says otherwise.
    """
    key = next(iter(pattern_keys(pattern)), "")
    if not key or (key == "image") != bool(image):
        return image
    value = image or object_number
    # In a URL the number of an object is one step of its path, whatever is in it.
    given = quote(value, safe="") if pattern.casefold().startswith(SCHEMES) else value
    return pattern.format(**{key: given})
