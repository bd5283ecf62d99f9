"""Nights of a museum with photographs: on its pages and its sheets to walk with, and what cannot be shown is told."""

import json
from io import BytesIO
from pathlib import Path

import pytest
from lxml import etree
from PIL import Image
from pypdf import PdfReader
from selenium.webdriver import Chrome

from pipeline.images import album
from pipeline.operations.run_summary import Summary
from pipeline.settings import Settings, load_settings
from pipeline.tools.rerender import render_again
from tests.images.conftest import Site, photograph
from tests.museum import edit, museum_of, night, vases


@pytest.fixture
def museum(tmp_path: Path) -> Settings:
    """Four vases of two rooms: two with a photograph, one whose file is no photograph, one without."""
    objects = [dict(one) for one in vases(galleries=2, each=2)]
    settings = museum_of(tmp_path / "museum", objects)
    home = settings.home
    (home / "pictures").mkdir()
    (home / "pictures" / "a.jpg").write_bytes(photograph((600, 300), "red"))
    (home / "pictures" / "b.png").write_bytes(photograph((300, 600), "blue", "PNG"))
    (home / "pictures" / "c.jpg").write_text("<svg/>")
    with_images(home, {"0.0": "a.jpg", "0.1": "c.jpg", "1.0": "b.png"})
    file = home / "kouros.toml"
    before, after = file.read_text(encoding="utf-8").split("[images]")
    after = after.replace('folder = ""', 'folder = "pictures"', 1)
    file.write_text(f"{before}[images]{after}", encoding="utf-8")
    return load_settings(home / "kouros.toml")


def with_images(home: Path, images: dict[str, str]) -> None:
    """Write the photographs of objects beside their numbers into the export."""
    lines = (home / "collection.csv").read_text().splitlines()
    if "image" not in lines[0]:
        lines = [
            f"{line},{more}" for line, more in zip(lines, ["image,image_credit", *["" for _ in lines[1:]]], strict=True)
        ]
    out = [lines[0]]
    for line in lines[1:]:
        number = line.split(",")[0]
        cells = line.split(",")[: lines[0].split(",").index("image")]
        out.append(",".join([*cells, images.get(number, ""), '"Photo: ""><script>alert(1)</script>"']))
    (home / "collection.csv").write_text("\n".join(out) + "\n")


def page(done: Summary, room: int) -> str:
    assert done.report is not None
    (file,) = done.report.parent.glob(f"room-{room}-*.html")
    return file.read_text(encoding="utf-8")


def shown(text: str) -> list[dict[str, str]]:
    tree = etree.fromstring(text.encode(), etree.HTMLParser())
    return [dict(one.attrib) for one in tree.iter("img")]


def test_a_photograph_is_on_page_card_and_sheet_with_its_size_and_words(museum: Settings) -> None:
    done = night(museum)
    assert done.report is not None
    listed, carded = shown(page(done, 0))
    assert (listed["width"], listed["height"]) == ("56", "28")
    assert (carded["width"], carded["height"]) == ("120", "60")
    assert all(one["loading"] == "lazy" and one["alt"] == "Photograph of 0.0" for one in (listed, carded))
    with Image.open(done.report.parent / listed["src"]) as picture:
        assert picture.size == (240, 120)
        assert picture.getpixel((100, 60)) == pytest.approx((254, 0, 0), abs=3)
    assert "<script>alert(1)" not in page(done, 0)
    assert "Photo: &#34;&gt;&lt;script&gt;" in page(done, 0)
    assert "img-src data: 'self'" in page(done, 0)
    (sheet,) = done.report.parent.glob("room-0-*-sheet.pdf")
    (image,) = [one for some in PdfReader(sheet).pages for one in some.images]
    with Image.open(BytesIO(image.data)) as printed:
        assert printed.size == (240, 120)


def test_what_cannot_be_shown_is_counted_and_told(museum: Settings) -> None:
    done = night(museum)
    assert done.report is not None
    assert done.reading is not None
    assert done.reading["images"] == 1
    folder = done.report.parent
    assert json.loads((folder / "summary.json").read_text())["reading"]["images"] == 1
    assert "1 photograph not shown" in (folder / "index.html").read_text(encoding="utf-8")
    (row,) = [line for line in (folder / "reading.csv").read_text().splitlines() if "photograph" in line]
    assert ",0.1,image,doubtful," in row
    assert "SVG" in row
    assert "c.jpg" in row


def test_an_unchanged_night_looks_at_no_photograph_and_draws_no_page(
    museum: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = night(museum)

    def never(*_: object) -> None:
        raise AssertionError("a photograph was read")

    monkeypatch.setattr(album, "_content", never)
    again = night(museum)
    assert first.report is not None
    assert again.report is not None
    for one in (*first.report.parent.glob("room-*"), *first.report.parent.glob("images/*")):
        assert one.samefile(again.report.parent / one.relative_to(first.report.parent))


def test_another_photograph_under_the_same_name_is_another_page(museum: Settings) -> None:
    first = night(museum)
    (museum.home / "pictures" / "a.jpg").write_bytes(photograph((300, 300), "green"))
    (museum.home / "pictures" / "c.jpg").write_bytes(photograph((300, 300), "red"))
    again = night(museum)
    assert again.report is not None
    assert first.report is not None
    assert {one["height"] for one in shown(page(again, 0))} == {"56", "120"}
    assert len(shown(page(again, 0))) == 4
    assert page(again, 1) == page(first, 1)
    assert again.reading is not None
    assert "images" not in again.reading
    assert len(list((again.report.parent / "images").iterdir())) == 3
    drawn = render_again(museum, None)
    assert sorted(one.name for one in (drawn.parent / "images").iterdir()) == sorted(
        one.name for one in (again.report.parent / "images").iterdir()
    )


def test_hosts_are_asked_only_where_settings_name_them(museum: Settings, site: Site) -> None:
    with_images(museum.home, {"0.0": site.holds("/a.jpg", photograph()), "1.0": "b.png"})
    done = night(museum)
    assert done.report is not None
    assert site.asked == []
    index = (done.report.parent / "index.html").read_text(encoding="utf-8")
    assert f"1 photograph at {site.host} was not fetched: [images] hosts does not name it." in index
    assert len(list((done.report.parent / "images").iterdir())) == 1
    edit(museum.home / "kouros.toml", "hosts = []", f'hosts = ["{site.host}"]')
    settings = load_settings(museum.home / "kouros.toml")
    done = night(settings)
    assert site.asked == ["/a.jpg"]
    assert len(shown(page(done, 0))) == 2
    night(settings)
    assert site.asked == ["/a.jpg"]


@pytest.mark.browser
def test_a_browser_shows_the_pictures_of_a_page_from_the_file_system(museum: Settings, browser: Chrome) -> None:
    """The pages allow nothing but themselves: whether that lets their own pictures through only a browser knows."""
    done = night(museum)
    assert done.report is not None
    (file,) = done.report.parent.glob("room-0-*.html")
    browser.get(file.as_uri())
    sizes = browser.execute_async_script(
        "const done = arguments[0], all = [...document.images]; all.forEach(i => i.loading = 'eager');"
        "Promise.all(all.map(i => i.decode().catch(() => 0))).then(() => done(all.map(i => i.naturalWidth)))"
    )
    assert sizes == [240, 240]
