"""Photographs that Pillow made become small pictures; hostile ones are refused, and end nothing but themselves."""

import os
import signal
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO

import pytest
from PIL import Image

from pipeline.images.decoding import Decoder, check_kind
from pipeline.images.limits import ImageError
from tests.images.conftest import photograph


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    decoder = Decoder(240, 1_000_000, 20.0)
    yield decoder
    decoder.close()


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP", "GIF", "TIFF", "BMP"])
def test_a_picture_has_the_proportions_and_the_colour_of_its_photograph(decoder: Decoder, kind: str) -> None:
    made = decoder.picture(photograph((600, 400), "#204080", kind))
    assert (made.width, made.height) == (240, 160)
    with Image.open(BytesIO(made.content)) as shown:
        assert shown.format == "JPEG"
        assert shown.size == (240, 160)
        assert shown.getpixel((120, 80)) == pytest.approx((0x20, 0x40, 0x80), abs=4)


def test_a_small_photograph_is_not_enlarged(decoder: Decoder) -> None:
    made = decoder.picture(photograph((30, 20)))
    assert (made.width, made.height) == (30, 20)


def test_what_a_camera_says_of_its_turn_is_followed_and_nothing_else_is_kept(decoder: Decoder) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # to be turned by 90 degrees
    exif[0x010E] = "where the curator lives"
    out = BytesIO()
    Image.new("RGB", (600, 400)).save(out, "JPEG", exif=exif)
    made = decoder.picture(out.getvalue())
    assert (made.width, made.height) == (160, 240)
    assert b"curator" in out.getvalue()
    assert b"curator" not in made.content


def test_what_is_transparent_is_shown_on_white(decoder: Decoder) -> None:
    made = decoder.picture(photograph((50, 50), "#00000000", "PNG", "RGBA"))
    with Image.open(BytesIO(made.content)) as shown:
        assert shown.getpixel((25, 25)) == (255, 255, 255)


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "CMYK", "I;16", "I", "F"])
def test_any_mode_is_read(decoder: Decoder, mode: str) -> None:
    out = BytesIO()
    Image.new(mode, (50, 40)).save(out, "TIFF")
    assert decoder.picture(out.getvalue()).width == 50


def bomb() -> bytes:
    """A PNG of few bytes that says it has 65,000 x 65,000 pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 65_000, 65_000, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b"")
    )


REFUSED = {
    "a bomb": (bomb(), "pixels"),
    "cut": (photograph()[:1500], "truncated|damaged"),
    "SVG": (b'<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)"/>', "SVG"),
    "SVG behind a head": (b'\xef\xbb\xbf<?xml version="1.0"?>\n<svg/>', "SVG"),
    "a page": (b"<!DOCTYPE html><html></html>", "web page"),
    "PDF": (b"%PDF-1.7\n", "PDF"),
    "PostScript": (b"%!PS-Adobe-3.0 EPSF-3.0\n", "PostScript"),
    "an archive": (b"PK\x03\x04" + bytes(30), "archive"),
    "nothing": (b"", "empty"),
    "noise": (b"\x00\x01\x02\x03" * 100, "kind that is not read"),
    "noise with a mark": (b"\xff\xd8\xff" + b"\x00\x01\x02\x03" * 100, "damaged"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_hostile_is_refused_and_the_next_one_is_read(decoder: Decoder, name: str) -> None:
    content, words = REFUSED[name]
    with pytest.raises(ImageError, match=words):
        decoder.picture(content)
    assert decoder.picture(photograph()).width == 240


def test_one_that_takes_too_long_is_given_up() -> None:
    decoder = Decoder(240, 10**9, 0.000_001)
    try:
        with pytest.raises(ImageError, match="to decode"):
            decoder.picture(photograph((4000, 4000)))
    finally:
        decoder.close()


def test_a_decoder_that_is_ended_is_started_again() -> None:
    decoder = Decoder(240, 10**6, 20.0)
    try:
        decoder.picture(photograph())
        process = decoder._process
        assert process is not None
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        assert decoder.picture(photograph()).width == 240
    finally:
        decoder.close()


def test_no_name_makes_a_photograph() -> None:
    with pytest.raises(ImageError):
        check_kind(b"GIF")
