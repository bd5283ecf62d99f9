"""IIIF: what a manifest (Presentation API 2 and 3) or an image's own description says of where the pictures are."""

import json
from collections.abc import Iterator
from typing import Any

from pipeline.images.errors import ImageError

_DEEP = 40
"""Levels of a document at most that are looked into."""


def is_document(content: bytes, kind: str) -> bool:
    """Say whether an answer is a document and no photograph.

    Parameters
    ----------
    content : bytes
        Of the answer.
    kind : str
        As its host names it.

    Returns
    -------
    bool
    """
    return "json" in kind or content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"


def pictures_of(content: bytes, side: int) -> list[str]:
    """Return the addresses at which a picture of about so many pixels is, the likeliest first.

    Parameters
    ----------
    content : bytes
        A manifest of IIIF (version 2 or 3), or the description of one image (info.json).
    side : int
        Pixels of a side that are wanted.

    Returns
    -------
    list of str
        Three at most: servers differ in the sizes that they make.

    Raises
    ------
    ImageError
        For a document that is neither, or names no picture.
    """
    try:
        document = json.loads(content)
    except (ValueError, RecursionError) as problem:
        raise ImageError("is no JSON that can be read", "give the address of a photograph or of IIIF") from problem
    if not isinstance(document, dict):
        raise ImageError("is no document of IIIF", "give the address of a photograph or of IIIF")
    found: list[str] = []
    for base, address in _images(document):
        found += sized(base, side) if base else [address]
        if found:
            break
    if not found:
        raise ImageError("names no picture of IIIF", "give the address of a photograph or of a manifest with pictures")
    return found


def sized(base: str, side: int) -> list[str]:
    """Return the requests for an image of a IIIF server: within a square, of a width, and whole."""
    base = base.strip().rstrip("/").removesuffix("/info.json").rstrip("/")
    return [f"{base}/full/{size}/0/default.jpg" for size in (f"!{side},{side}", f"{side},", "max")]


def _images(document: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield base of an image service, or address, of the pictures of a document in its order."""
    if "sequences" in document:
        for sequence in _dicts(document, "sequences"):
            for canvas in _dicts(sequence, "canvases"):
                for image in _dicts(canvas, "images"):
                    yield from _resource(image.get("resource"))
    elif document.get("type") == "Manifest" or "items" in document:
        for canvas in _dicts(document, "items"):
            for page in _dicts(canvas, "items"):
                for note in _dicts(page, "items"):
                    yield from _resource(note.get("body"))
    elif "width" in document or "protocol" in document:
        yield _text(document, "id", "@id"), ""


def _resource(resource: Any, deep: int = 0) -> Iterator[tuple[str, str]]:
    for one in resource if isinstance(resource, list) else [resource]:
        if not isinstance(one, dict) or deep > _DEEP:
            continue
        if one.get("type") == "Choice" or one.get("@type") == "oa:Choice":
            yield from _resource(one.get("items") or one.get("default"), deep + 1)
            continue
        services = [*_dicts(one, "service"), *_dicts(one, "services")]
        base = next(filter(None, (_text(service, "id", "@id") for service in services if _is_images(service))), "")
        address = _text(one, "id", "@id")
        if base or address:
            yield base, address


def _is_images(service: dict[str, Any]) -> bool:
    said = " ".join(str(service.get(key) or "") for key in ("type", "@type", "@context", "profile"))
    return "ImageService" in said or "/image" in said or not said.strip()


def _dicts(document: dict[str, Any], key: str) -> list[dict[str, Any]]:
    found = document.get(key)
    return [one for one in (found if isinstance(found, list) else [found]) if isinstance(one, dict)]


def _text(document: dict[str, Any], *keys: str) -> str:
    return next((value for key in keys if isinstance(value := document.get(key), str) and value), "")
