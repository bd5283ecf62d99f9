"""One file from a host that the settings allow, bounded in bytes and time; and what IIIF says of where pictures are."""

import ipaddress
import json
import socket
import ssl
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from threading import Timer
from typing import Any, NoReturn
from urllib.parse import quote, urljoin, urlsplit, urlunsplit

from pipeline.images.limits import ImageError

MOST_MOVES = 4
"""Redirects that are followed, all to the same host."""

_PORTS = {"http": 80, "https": 443}
_NAT64 = ipaddress.IPv6Network("64:ff9b::/96")
_PIECE = 1 << 16
_MOVED = frozenset({301, 302, 303, 307, 308})
_SAFE = "!#$%&'()*+,/:;=?@[]~"
_AGENT = "Kouros (museum earthquake assessment; thumbnails)"


@dataclass(frozen=True)
class Fetched:
    """What a host answered.

    Attributes
    ----------
    content : bytes or None
        None where it is what it was.
    etag, modified : str
        By which the host knows this state again; "" for nothing.
    kind : str
        Its type as the host names it, such as "image/jpeg".
    """

    content: bytes | None
    etag: str = ""
    modified: str = ""
    kind: str = ""


@dataclass(frozen=True)
class Hosts:
    """The hosts that may be asked.

    Attributes
    ----------
    names : tuple of str
        Such as "images.museum.org", "127.0.0.1:8000" or "*.museum.org".  A private address (of the museum's own
        network, or of this machine) is asked only where a host is named by itself: a star allows none.
    """

    names: tuple[str, ...] = ()
    _named: frozenset[str] = field(init=False, default=frozenset())

    def __post_init__(self) -> None:
        """Keep the names as they are compared."""
        object.__setattr__(self, "_named", frozenset(name.strip().casefold() for name in self.names))

    def allows(self, host: str, port: int, scheme: str) -> bool:
        """Say whether a host may be asked."""
        return self.named(host, port, scheme) or any(
            host.endswith(name[1:]) and port == _PORTS[scheme] for name in self._named if name.startswith("*.")
        )

    def named(self, host: str, port: int, scheme: str) -> bool:
        """Say whether a host is named by itself, with its port unless that is the usual one."""
        shown = f"[{host}]" if ":" in host else host
        return f"{shown}:{port}" in self._named or (port == _PORTS[scheme] and bool({host, shown} & self._named))


@dataclass(frozen=True)
class _Address:
    """A URL in its parts, checked."""

    scheme: str
    host: str
    port: int
    target: str

    @property
    def origin(self) -> str:
        """As the settings name it."""
        shown = f"[{self.host}]" if ":" in self.host else self.host
        return shown if self.port == _PORTS[self.scheme] else f"{shown}:{self.port}"


def address_of(url: str) -> _Address:
    """Return a URL in its parts.

    Parameters
    ----------
    url : str
        As a record names it.

    Returns
    -------
    _Address
        Its host in small letters, its path quoted.

    Raises
    ------
    ImageError
        For what is no URL that is ever asked.
    """
    if not url.isprintable():
        raise ImageError("the address holds control characters", "correct the address")
    try:
        parts = urlsplit(url.strip())
        port = parts.port
        host = (parts.hostname or "").rstrip(".").encode("idna").decode("ascii").casefold()
    except (ValueError, UnicodeError) as problem:
        raise ImageError("is no address of the network", "write it as https://host/path") from problem
    scheme = parts.scheme.casefold()
    if scheme not in _PORTS or not host:
        raise ImageError("is no address of the network", "write it as https://host/path")
    if parts.username is not None or parts.password is not None:
        raise ImageError(
            "the address holds a name or a password", "leave it out: photographs are asked for without one"
        )
    target = urlunsplit(("", "", quote(parts.path or "/", safe=_SAFE), quote(parts.query, safe=_SAFE), ""))
    return _Address(scheme, host, port or _PORTS[scheme], target)


class Fetcher:
    """Asks hosts for files.

    Parameters
    ----------
    hosts : Hosts
        Those that may be asked.
    most_bytes : int
        Of a file.
    seconds : float
        For one file, redirects included.
    """

    def __init__(self, hosts: Hosts, most_bytes: int, seconds: float) -> None:
        self._hosts, self._most, self._seconds = hosts, most_bytes, seconds

    def allows(self, url: str) -> str:
        """Return "" for an address that may be asked, and else the host that the settings would have to name.

        Raises
        ------
        ImageError
            As `address_of`.
        """
        at = address_of(url)
        return "" if self._hosts.allows(at.host, at.port, at.scheme) else at.origin

    def get(self, url: str, etag: str = "", modified: str = "") -> Fetched:
        """Return what stands at an address.

        Parameters
        ----------
        url : str
            Of a host that may be asked.
        etag, modified : str
            Of the state that is known; where that still holds nothing is sent.

        Returns
        -------
        Fetched
            The answer.

        Raises
        ------
        ImageError
            For a host that is not allowed or does not answer, an error, too many bytes or seconds.
        """
        until = time.monotonic() + self._seconds
        first = at = address_of(url)
        for _ in range(MOST_MOVES + 1):
            self._check(at, first)
            moved, answer = self._ask(at, etag, modified, until)
            if answer is not None:
                return answer
            at = address_of(urljoin(f"{at.scheme}://{at.origin}{at.target}", moved))
        raise ImageError(f"{first.origin} sends it from address to address", "give the address where it ends")

    def _check(self, at: _Address, first: _Address) -> None:
        if not self._hosts.allows(at.host, at.port, at.scheme):
            if at.origin != first.origin:
                raise ImageError(
                    f"{first.origin} sends it on to {at.origin}, which is not followed",
                    "give the address where it ends",
                )
            raise ImageError(f"[images] hosts does not name {at.origin}", f'add "{at.origin}" there')
        if at.host != first.host:
            raise ImageError(
                f"{first.origin} sends it on to {at.origin}, which is not followed", "give the address where it ends"
            )

    def _ask(self, at: _Address, etag: str, modified: str, until: float) -> tuple[str, Fetched | None]:
        """Return where it was moved to, or the answer."""
        left = until - time.monotonic()
        if left <= 0.0:
            self._late(at)
        connection = _connection(at, _checked(at, self._hosts.named(at.host, at.port, at.scheme)), left)
        # However slowly it answers: at the end of the time the connection is cut.
        late: list[bool] = []
        # The connection forgets its socket where the server says that it will close it.
        through = connection.sock

        def cut() -> None:
            late.append(True)
            with suppress(OSError):
                through.shutdown(socket.SHUT_RDWR)

        timer = Timer(left, cut)
        timer.daemon = True
        timer.start()
        try:
            headers = {
                "User-Agent": _AGENT,
                "Accept": "image/*, application/ld+json, application/json;q=0.8, */*;q=0.1",
            }
            headers |= {"If-None-Match": etag} if etag else {}
            headers |= {"If-Modified-Since": modified} if modified else {}
            connection.request("GET", at.target, headers=headers)
            response = connection.getresponse()
            if response.status in _MOVED and response.getheader("Location"):
                return str(response.getheader("Location")), None
            answer = self._answer(at, response)
            if late:
                self._late(at)
            return "", answer
        except ImageError:
            raise
        except (OSError, HTTPException, ValueError) as problem:
            if late or isinstance(problem, TimeoutError):
                self._late(at)
            said = str(problem) or type(problem).__name__
            raise ImageError(
                f"{at.origin} does not answer: {said[:200]}", "it is tried again", lasting=False
            ) from problem
        finally:
            timer.cancel()
            connection.close()
            through.close()

    def _answer(self, at: _Address, response: HTTPResponse) -> Fetched:
        told = {name: (response.getheader(name) or "")[:300] for name in ("ETag", "Last-Modified", "Content-Type")}
        if response.status == 304:
            return Fetched(None, told["ETag"], told["Last-Modified"])
        if response.status != 200:
            lasting = response.status in (400, 401, 403, 404, 410)
            raise ImageError(f"{at.origin} answers {response.status}", "correct the address", lasting=lasting)
        length = response.getheader("Content-Length") or ""
        if length.isdecimal() and int(length) > self._most:
            self._large(int(length))
        content = bytearray()
        while piece := response.read(_PIECE):
            content += piece
            if len(content) > self._most:
                self._large(len(content))
        if length.isdecimal() and len(content) < int(length):
            raise ImageError(f"{at.origin} stops in the middle of it", "it is tried again", lasting=False)
        kind = told["Content-Type"].partition(";")[0].strip().casefold()
        return Fetched(bytes(content), told["ETag"], told["Last-Modified"], kind)

    def _large(self, size: int) -> NoReturn:
        raise ImageError(
            f"has {size:,} bytes or more, and {self._most:,} are read",
            "give a smaller one, or raise [images] megabytes",
        )

    def _late(self, at: _Address) -> NoReturn:
        raise ImageError(f"{at.origin} takes more than {self._seconds:g} s", "it is tried again", lasting=False)


def _checked(at: _Address, named: bool) -> Iterable[str]:
    """Return the addresses of a host that may be asked: private ones only where the settings name it by itself."""
    try:
        found = socket.getaddrinfo(at.host, at.port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as problem:
        raise ImageError(f"there is no host {at.host}", "it is tried again", lasting=False) from problem
    numbers = list(dict.fromkeys(str(one[4][0]) for one in found))
    if not named and any(not _public(number) for number in numbers):
        raise ImageError(
            f"{at.host} is at a private address, which a star in [images] hosts does not allow",
            f'name it by itself: "{at.origin}"',
        )
    return numbers


def _public(number: str) -> bool:
    address = ipaddress.ip_address(number.partition("%")[0])
    # An address of the sixth version may stand for one of the fourth.
    meant: list[ipaddress.IPv4Address | ipaddress.IPv6Address | None] = [address]
    if isinstance(address, ipaddress.IPv6Address):
        meant += [address.ipv4_mapped, address.sixtofour, *(address.teredo or ())]
        if address in _NAT64:
            meant.append(ipaddress.IPv4Address(int(address) & 0xFFFFFFFF))
    if isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped is not None:
        meant.remove(address)
    return all(one is None or (one.is_global and not one.is_multicast) for one in meant)


def _connection(at: _Address, numbers: Iterable[str], seconds: float) -> HTTPConnection:
    """Return a connection to one of the very addresses that were looked at, which a name may not change meanwhile."""
    problem: OSError | None = None
    for number in numbers:
        try:
            plain = socket.create_connection((number, at.port), timeout=seconds)
        except OSError as fault:
            problem = fault
            continue
        if at.scheme == "http":
            http = HTTPConnection(at.host, at.port, timeout=seconds)
            http.sock = plain
            return http
        try:
            https = HTTPSConnection(at.host, at.port, timeout=seconds)
            https.sock = ssl.create_default_context().wrap_socket(plain, server_hostname=at.host)
        except OSError as fault:
            plain.close()
            raise ImageError(f"{at.origin}: {fault}"[:300], "see to its certificate", lasting=False) from fault
        return https
    raise ImageError(f"{at.origin} does not answer: {problem}"[:300], "it is tried again", lasting=False) from problem


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
