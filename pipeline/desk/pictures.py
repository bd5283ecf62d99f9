"""Photographs that somebody hands in: decoded, turned upright, made small, written anew: no byte is as it came."""

import warnings
from io import BytesIO

from PIL import Image, ImageOps

from pipeline.errors import InputError

EDGE = 1600
"""Pixels of the longer side of what is kept."""

PIXELS = 60_000_000
"""Of the largest picture that is decoded: what a telephone takes, and what memory bears."""

_FORMATS = ("JPEG", "PNG", "WEBP")


def taken_picture(content: bytes) -> bytes:
    """Return a photograph as it is kept: a JPEG without what its camera wrote of place and time.

    Raises
    ------
    InputError
        For what is no picture of a kind that is taken, is too large, or is damaged.
    """
    try:
        with warnings.catch_warnings():
            # Pillow warns of what may be a bomb; here it is refused.
            warnings.simplefilter("error")
            with Image.open(BytesIO(content), formats=_FORMATS) as picture:
                if picture.width * picture.height > PIXELS:
                    raise InputError(f"the picture has more than {PIXELS // 1_000_000} million pixels; make it smaller")
                picture.draft("RGB", (EDGE, EDGE))
                upright = ImageOps.exif_transpose(picture) or picture
                small = upright.convert("RGB")
                small.thumbnail((EDGE, EDGE))
    except InputError:
        raise
    except Exception as problem:
        # Whatever a decoder stumbles over is a damaged picture.
        raise InputError("the photograph cannot be read; take a JPEG, PNG or WebP picture") from problem
    out = BytesIO()
    small.save(out, "JPEG", quality=85)
    return out.getvalue()
