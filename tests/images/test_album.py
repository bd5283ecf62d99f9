"""An album: what is unchanged is not looked at again, and one bad photograph takes nothing from the others."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.cache import THUMBNAILS, Cache
from pipeline.images.album import Album, GatheredPhotos, ImageLimits
from pipeline.images.fetching import pictures_of
from pipeline.records import Silent
from tests.images.conftest import Site, photograph


def gathered(folder: Path, limits: ImageLimits, *images: str, whole: bool = True) -> GatheredPhotos:
    return Album(Cache(folder / "kept"), limits).gather(images, Silent(), whole=whole)


@pytest.fixture
def files(tmp_path: Path) -> ImageLimits:
    folder = tmp_path / "pictures"
    (folder / "more").mkdir(parents=True)
    (folder / "a.jpg").write_bytes(photograph())
    (folder / "more" / "b.png").write_bytes(photograph(kind="PNG", colour="blue"))
    (tmp_path / "secret.jpg").write_bytes(photograph(colour="green"))
    return ImageLimits(folder=folder)


def test_files_below_the_folder_are_shown_and_nothing_else(tmp_path: Path, files: ImageLimits) -> None:
    assert files.folder is not None
    (files.folder / "out.jpg").symlink_to(tmp_path / "secret.jpg")
    (files.folder / "in.jpg").symlink_to(files.folder / "a.jpg")
    os.mkfifo(files.folder / "pipe.jpg")
    bad = [
        "../secret.jpg",
        str(tmp_path / "secret.jpg"),
        "out.jpg",
        "more",
        "pipe.jpg",
        "none.jpg",
        "a\0.jpg",
        "x" * 5000,
    ]
    found = gathered(tmp_path, files, "a.jpg", "more/b.png", "more\\b.png", "in.jpg", *bad)
    assert set(found.photos) == {"a.jpg", "more/b.png", "more\\b.png", "in.jpg"}
    assert set(found.refused) == set(bad)
    assert found.photos["a.jpg"] == found.photos["in.jpg"]
    assert len({photo.name for photo in found.photos.values()}) == 2
    assert all(one.remedy for one in found.refused.values())


def test_what_is_unchanged_is_not_read_again(tmp_path: Path, files: ImageLimits) -> None:
    assert files.folder is not None
    (files.folder / "bad.jpg").write_bytes(b"<svg/>")
    images = ("a.jpg", "more/b.png", "bad.jpg")
    first = gathered(tmp_path, files, *images)
    assert first.worked == 3
    # Unreadable now, so that reading one would be told.
    again = gathered(tmp_path, files, *images)
    assert again.worked == 0
    assert (again.photos, again.refused) == (first.photos, first.refused)
    (files.folder / "a.jpg").write_bytes(photograph(colour="yellow"))
    changed = gathered(tmp_path, files, *images)
    assert changed.worked == 1
    assert changed.photos["a.jpg"] != first.photos["a.jpg"]
    fresh = gathered(tmp_path / "fresh", files, *images)
    assert (fresh.photos, fresh.refused) == (changed.photos, changed.refused)


def test_pictures_of_nothing_are_removed_but_not_by_a_part(tmp_path: Path, files: ImageLimits) -> None:
    def kept() -> int:
        return len(list((tmp_path / "kept" / THUMBNAILS).iterdir()))

    gathered(tmp_path, files, "a.jpg", "more/b.png")
    assert kept() == 3
    gathered(tmp_path, files, "a.jpg", whole=False)
    assert kept() == 3
    gathered(tmp_path, files, "a.jpg")
    assert kept() == 2


def test_a_picture_that_is_damaged_is_made_again(tmp_path: Path, files: ImageLimits) -> None:
    album = Album(Cache(tmp_path / "kept"), files)
    known = album.gather(["a.jpg"], Silent()).photos["a.jpg"]
    first = album.photo("a.jpg", known)
    for file in (tmp_path / "kept" / THUMBNAILS).iterdir():
        file.write_bytes(file.read_bytes()[:-10])
    with pytest.warns(UserWarning, match="cannot be used"):
        again = album.photo("a.jpg", known)
    assert first is not None
    assert again == first


def test_limits_and_settings_are_told(tmp_path: Path, files: ImageLimits) -> None:
    assert "10 are read" in gathered(tmp_path, replace(files, most_bytes=10), "a.jpg").refused["a.jpg"].message
    assert gathered(tmp_path, ImageLimits(), "a.jpg", "b.jpg").unset == 2
    found = gathered(tmp_path, files, "https://images.museum.org/a.jpg", "https://images.museum.org/b.jpg")
    assert found.unnamed == {"images.museum.org": 2}
    assert not found.refused
    late = gathered(tmp_path / "late", replace(files, minutes=0.0), "a.jpg", "more/b.png")
    assert (late.left, late.photos) == (2, {})


def test_a_host_is_asked_again_only_after_its_days_and_by_its_etag(tmp_path: Path, site: Site) -> None:
    url = site.holds("/a.jpg", photograph(), etag='"1"')
    limits = ImageLimits(hosts=(site.host,))
    first = gathered(tmp_path, limits, url)
    assert (first.worked, site.asked) == (1, ["/a.jpg"])
    assert gathered(tmp_path, limits, url).photos == first.photos
    assert site.asked == ["/a.jpg"]
    now = replace(limits, ask_again_days=0.0)
    assert gathered(tmp_path, now, url).photos == first.photos
    site.holds("/a.jpg", photograph(colour="blue"), etag='"2"')
    assert gathered(tmp_path, now, url).photos != first.photos
    assert site.asked == ["/a.jpg"] * 3


def test_a_host_that_is_silent_tonight_takes_no_picture_away(tmp_path: Path, site: Site) -> None:
    url = site.holds("/a.jpg", photograph())
    limits = ImageLimits(hosts=(site.host,), ask_again_days=0.0)
    first = gathered(tmp_path, limits, url)
    site.answers["/a.jpg"] = lambda handler: handler.send_error(503)
    found = gathered(tmp_path, limits, url)
    assert found.photos == first.photos
    assert "503" in found.refused[url].message


def test_a_host_that_never_answers_is_left_alone(tmp_path: Path, site: Site) -> None:
    urls = [site.url(f"/{n}.jpg") for n in range(40)]
    for n in range(40):
        site.answers[f"/{n}.jpg"] = lambda handler: handler.send_error(500)
    found = gathered(tmp_path, ImageLimits(hosts=(site.host,)), *urls)
    assert len(found.refused) == 40
    assert len(site.asked) < 15


def manifest(version: int, base: str) -> bytes:
    """A manifest as the cookbook of IIIF has it (https://iiif.io/api/cookbook/recipe/0005-image-service/)."""
    if version == 2:
        service = {"@context": "http://iiif.io/api/image/2/context.json", "@id": base, "profile": "level1"}
        resource = {"@id": f"{base}/full/full/0/default.jpg", "@type": "dctypes:Image", "service": service}
        canvas = {"@type": "sc:Canvas", "images": [{"@type": "oa:Annotation", "resource": resource}]}
        return json.dumps({"@type": "sc:Manifest", "sequences": [{"canvases": [canvas]}]}).encode()
    service = {"id": base, "profile": "level1", "type": "ImageService3"}
    body = {"id": f"{base}/full/max/0/default.jpg", "type": "Image", "service": [service]}
    page = {"type": "AnnotationPage", "items": [{"type": "Annotation", "body": body}]}
    return json.dumps({"type": "Manifest", "items": [{"type": "Canvas", "items": [page]}]}).encode()


@pytest.mark.parametrize("version", [2, 3])
def test_a_manifest_of_iiif_leads_to_its_first_picture(tmp_path: Path, site: Site, version: int) -> None:
    url = site.holds("/manifest.json", manifest(version, site.url("/iiif/x")), "application/ld+json")
    # A server of level 1 makes pictures of a width, and none within a square.
    site.holds("/iiif/x/full/240,/0/default.jpg", photograph((240, 180)))
    found = gathered(tmp_path, ImageLimits(hosts=(site.host,)), url)
    assert (found.photos[url].width, found.photos[url].height) == (240, 180)
    assert site.asked == ["/manifest.json", "/iiif/x/full/!240,240/0/default.jpg", "/iiif/x/full/240,/0/default.jpg"]


def test_an_image_base_sends_on_to_its_description(tmp_path: Path, site: Site) -> None:
    info = {"@context": "http://iiif.io/api/image/2/context.json", "@id": site.url("/iiif/x"), "width": 9, "height": 9}
    site.holds("/iiif/x/info.json", json.dumps(info).encode(), "application/json")
    url = site.moves("/iiif/x", "/iiif/x/info.json")
    site.holds("/iiif/x/full/!240,240/0/default.jpg", photograph((240, 240)))
    assert gathered(tmp_path, ImageLimits(hosts=(site.host,)), url).photos[url].width == 240


def test_a_manifest_leads_to_no_host_that_is_not_named(tmp_path: Path, site: Site) -> None:
    url = site.holds("/manifest.json", manifest(3, "http://169.254.169.254/latest"), "application/json")
    found = gathered(tmp_path, ImageLimits(hosts=(site.host,)), url)
    assert "169.254.169.254" in found.refused[url].message
    assert site.asked == ["/manifest.json"]


@pytest.mark.parametrize(
    "content", [b"{", b"[]", b"{}", b'{"items": 3}', b'{"sequences": [{"canvases": "x"}]}', b"[" * 9999]
)
def test_other_documents_are_refused(content: bytes) -> None:
    with pytest.raises(Exception, match="IIIF") as caught:
        pictures_of(content, 240)
    assert type(caught.value).__name__ == "ImageError"
