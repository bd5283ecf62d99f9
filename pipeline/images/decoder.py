"""The process that decodes photographs: it gets the bytes of one after the other, and gives small pictures back.

It runs by itself (`pipeline.images.decoding` starts it): what is in a photograph may be anybody's, and a decoder that
it breaks, fills the memory of or keeps busy is ended and started again.  It imports nothing of Kouros, opens no file
and knows no network.
"""

import json
import struct
import sys
import warnings
from contextlib import suppress
from io import BytesIO

from PIL import Image, ImageOps, UnidentifiedImageError

FORMATS = ("JPEG", "PNG", "WEBP", "GIF", "TIFF", "BMP")
QUALITY = 80
MEMORY = 2 << 30
"""Bytes of memory that the process may have, where the system can tell it so."""

HEAD = struct.Struct("<Q")


def small(data: bytes, side: int, most_pixels: int) -> tuple[bytes, int, int]:
    """Return a picture of at most ``side`` pixels a side as JPEG, with its width and height.

    Parameters
    ----------
    data : bytes
        A photograph.
    side, most_pixels : int
        Of what is returned at most, and of the photograph at most.

    Returns
    -------
    (bytes, int, int)

    Raises
    ------
    ValueError
        For one of more than ``most_pixels``; what the decoder raises besides.
    """
    Image.MAX_IMAGE_PIXELS = None  # Pillow's own limit warns first: ours is asked below, before anything is decoded.
    with Image.open(BytesIO(data), formats=FORMATS) as photograph:
        wide, high = photograph.size
        if wide * high > most_pixels:
            raise ValueError(f"has {wide:,} x {high:,} pixels, more than {most_pixels:,}")
        # JPEG is decoded at an eighth, a quarter or a half of its size where that is enough.
        photograph.draft("RGB", (2 * side, 2 * side))
        photograph.load()
        turned = ImageOps.exif_transpose(photograph)
        picture = plain(turned)
    picture.thumbnail((side, side), Image.Resampling.LANCZOS, reducing_gap=3.0)
    out = BytesIO()
    picture.save(out, "JPEG", quality=QUALITY, optimize=True)
    return out.getvalue(), picture.width, picture.height


def plain(picture: Image.Image) -> Image.Image:
    """Return a picture in red, green and blue, on white where it is transparent."""
    if picture.mode.startswith(("I", "F")):
        # Sixteen bits, or numbers of any size: from the least to the greatest.
        low, high = picture.getextrema()
        scale = 255.0 / (float(high) - float(low) or 1.0)  # type: ignore[arg-type]
        picture = picture.convert("F").point(lambda value: value * scale - float(low) * scale).convert("L")  # type: ignore[arg-type]
    if picture.mode in ("RGBA", "LA", "PA", "RGBa", "La") or "transparency" in picture.info:
        clear = picture.convert("RGBA")
        white = Image.new("RGBA", clear.size, "white")
        white.alpha_composite(clear)
        picture = white
    return picture.convert("RGB")


def main() -> None:
    """Answer until there is nothing more to answer."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("ignore")
    source, target = sys.stdin.buffer, sys.stdout.buffer
    while len(head := source.read(3 * HEAD.size)) == 3 * HEAD.size:
        length, side, most = (HEAD.unpack_from(head, at * HEAD.size)[0] for at in range(3))
        data = source.read(length)
        told: dict[str, object]
        try:
            content, wide, high = small(data, side, most)
            told = {"width": wide, "height": high}
        except MemoryError:
            content, told = b"", {"why": "needs too much memory"}
        except UnidentifiedImageError:
            content, told = b"", {"why": "it is damaged"}
        except Exception as problem:  # noqa: BLE001 - whatever a hostile file ends in, it is that file's
            content, told = b"", {"why": f"{problem}"[:300] or type(problem).__name__}
        said = json.dumps(told).encode()
        target.write(HEAD.pack(len(said)) + said + HEAD.pack(len(content)) + content)
        target.flush()


if __name__ == "__main__":
    main()
