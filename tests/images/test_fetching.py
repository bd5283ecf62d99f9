"""Asking a real server: only hosts that are named, bounded in bytes and seconds, and never sent on to another."""

import time

import pytest

from pipeline.images import fetching
from pipeline.images.fetching import Fetcher, Hosts
from pipeline.images.limits import ImageError
from tests.images.conftest import Handler, Site, photograph


def fetcher(*hosts: str, most: int = 1_000_000, seconds: float = 5.0) -> Fetcher:
    return Fetcher(Hosts(hosts), most, seconds)


def test_what_a_named_host_holds_is_had(site: Site) -> None:
    url = site.holds("/a.jpg", photograph(), etag='"1"')
    answer = fetcher(site.host).get(url)
    assert answer.content == photograph()
    assert (answer.etag, answer.kind) == ('"1"', "image/jpeg")
    assert fetcher(site.host).get(url, '"1"').content is None


@pytest.mark.parametrize("named", ["", "images.museum.org", "127.0.0.1", "127.0.0.1:1", "*.0.0.1"])
def test_another_host_is_never_asked(site: Site, named: str) -> None:
    url = site.holds("/a.jpg", photograph())
    with pytest.raises(ImageError, match="hosts does not name 127"):
        fetcher(named).get(url)
    assert site.asked == []


def test_it_follows_to_the_same_host_and_to_no_other(site: Site) -> None:
    site.holds("/a.jpg", photograph())
    assert fetcher(site.host).get(site.moves("/here", "/a.jpg")).content
    port = site.host.rpartition(":")[2]
    for to in (
        "http://images.example.org/a.jpg",
        f"http://localhost:{port}/a.jpg",
        "file:///etc/passwd",
        "//[::1]/a.jpg",
    ):
        before = len(site.asked)
        with pytest.raises(ImageError, match=r"not followed|no address"):
            fetcher(site.host, f"localhost:{port}").get(site.moves("/there", to))
        assert len(site.asked) == before + 1
    with pytest.raises(ImageError, match="from address to address"):
        fetcher(site.host).get(site.moves("/round", "/round"))


def test_it_stops_at_the_limit_of_bytes(site: Site) -> None:
    with pytest.raises(ImageError, match="2,000 are read"):
        fetcher(site.host, most=2000).get(site.holds("/large.jpg", bytes(5000)))

    def endless(handler: Handler) -> None:
        handler.send_response(200)
        handler.end_headers()
        for _ in range(10_000):
            handler.wfile.write(bytes(10_000))

    site.answers["/endless"] = endless
    with pytest.raises(ImageError, match="2,000 are read"):
        fetcher(site.host, most=2000).get(site.url("/endless"))


def test_it_stops_at_the_limit_of_time_however_slowly_it_answers(site: Site) -> None:
    url = site.drips("/slow.jpg", 20.0)
    since = time.monotonic()
    with pytest.raises(ImageError, match=r"more than 0\.5 s") as caught:
        fetcher(site.host, seconds=0.5).get(url)
    assert time.monotonic() - since < 3.0
    assert not caught.value.lasting


@pytest.mark.parametrize(
    "url",
    [
        "ftp://127.0.0.1/a.jpg",
        "http://user:secret@127.0.0.1/a.jpg",
        "http:///a.jpg",
        "http://127.0.0.1:99999/a",
        "http://a b/",
        "http://127.0.0.1/a\r\nHost: evil",
        "javascript:alert(1)",
    ],
)
def test_other_addresses_are_refused(url: str) -> None:
    with pytest.raises(ImageError):
        fetcher("127.0.0.1").get(url)


def test_a_star_allows_no_private_address(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    """A name of the museum's domain that somebody lets point into its own network."""
    real = fetching.socket.getaddrinfo

    def inside(host: str, *args: object, **how: object) -> object:
        return real("127.0.0.1", *args, **how)

    monkeypatch.setattr(fetching.socket, "getaddrinfo", inside)
    with pytest.raises(ImageError, match="private address"):
        fetcher("*.museum.example").get("http://images.museum.example/a.jpg")
    port = site.host.rpartition(":")[2]
    site.holds("/a.jpg", photograph())
    named = f"images.museum.example:{port}"
    assert fetcher(named).get(f"http://{named}/a.jpg").content == photograph()


PRIVATE = (
    *("127.0.0.1", "10.1.2.3", "192.168.0.1", "169.254.169.254", "224.0.0.1", "100.64.0.1"),
    *("::1", "::", "fd00::1", "fe80::1", "::ffff:10.0.0.1", "64:ff9b::a00:1"),
)


@pytest.mark.parametrize("number", PRIVATE)
def test_addresses_that_are_private(number: str) -> None:
    assert not fetching._public(number)


def test_an_address_that_is_public() -> None:
    assert fetching._public("93.184.216.34")
    assert fetching._public("2606:2800:220:1::1")


def test_errors_of_the_server_are_told_and_those_that_pass_are_tried_again(site: Site) -> None:
    with pytest.raises(ImageError, match="answers 404") as lasting:
        fetcher(site.host).get(site.url("/nowhere"))
    assert lasting.value.lasting
    site.answers["/busy"] = lambda handler: handler.send_error(503)
    with pytest.raises(ImageError, match="answers 503") as passing:
        fetcher(site.host).get(site.url("/busy"))
    assert not passing.value.lasting
