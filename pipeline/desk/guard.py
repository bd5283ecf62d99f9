"""What stands before every page: which host was asked for, who asks, how much is sent, and what a browser may do."""

import hashlib
import hmac
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from ipaddress import ip_address, ip_network
from typing import Any
from urllib.parse import quote, unquote, urlsplit

from starlette.requests import Request
from starlette.responses import PlainTextResponse

from pipeline.collection.database import Database
from pipeline.desk.accounts import of_token
from pipeline.errors import InputError
from pipeline.settings.operations import LOCAL, ServeSettings
from pipeline.tools.decisions import WHO_LIMIT, person_named


class DeskError(InputError):
    """The desk cannot do what it was asked to."""


class StaleError(DeskError):
    """Somebody else changed what a form was made of: it is told, and nothing of either is lost."""


class NotThereError(DeskError):
    """There is no such object, gallery or errand."""


class BodyTooLongError(DeskError):
    """More is sent than is taken."""


SESSION_COOKIE, FORM_COOKIE, NAME_COOKIE = "kouros_session", "kouros_form", "kouros_name"

FORM_BYTES = 200_000
"""Of a form without a photograph."""

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; style-src-attr 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
"""No script and no style sheet but those of the desk; bars are drawn by attributes."""

REPORT_POLICY = "frame-ancestors 'none'; base-uri 'none'; form-action 'none'; object-src 'none'"
"""Of the pages of the night, which state a policy of their own, stricter than this."""

_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    # Not "no-referrer": browsers then say of a form of this very site that its origin is null.
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "geolocation=(), microphone=()",
    "X-Frame-Options": "DENY",
}

_ADDED = tuple(
    (name.lower().encode(), text.encode())
    for name, text in (*_HEADERS.items(), ("Content-Security-Policy", POLICY), ("Cache-Control", "no-store"))
)
"""As they are sent."""

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class Person:
    """Who asks: the name, whether they may write, whether the name is known and not only said, and their session."""

    name: str
    editor: bool
    known: bool
    session: str = ""


class Guard:
    """The outermost layer of the site (ASGI): refuses strange hosts, peers, origins and lengths; adds headers."""

    def __init__(self, app: Any, settings: ServeSettings, close: Callable[[], None]) -> None:
        self._app, self._settings, self.close = app, settings, close
        self._hosts = {*LOCAL, *(urlsplit(one).hostname or "" for one in settings.addresses)}
        if not _everywhere(settings.host):
            self._hosts.add(settings.host)
        self._origins = {_origin(one) for one in settings.addresses}
        self._proxies = [ip_network(one) for one in settings.trusted]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """DeskAnswer, or hand on."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return
        request = Request(scope)
        refused = self._refused(request)
        if refused is not None:
            await self._with_headers(refused, scope, receive, send)
            return
        most = FORM_BYTES + round(1e6 * self._settings.upload_megabytes)
        told = request.headers.get("content-length", "0")
        if not told.isdigit() or int(told) > most:
            await self._with_headers(_too_long(most), scope, receive, send)
            return
        heard = 0

        async def bounded() -> MutableMapping[str, Any]:
            nonlocal heard
            message = await receive()
            heard += len(message.get("body", b""))
            if heard > most:
                raise BodyTooLongError
            return message

        await self._with_headers(self._app, scope, bounded, send)

    def _refused(self, request: Request) -> PlainTextResponse | None:
        if len(request.headers.getlist("host")) != 1 or _hostname(request.headers["host"]) not in self._hosts:
            # A page elsewhere whose name was pointed at this machine (DNS rebinding) comes with its own name.
            return PlainTextResponse("No such site here: [serve] addresses names those that there are.", 421)
        if self._settings.identity == "header" and not self._trusted(request):
            return PlainTextResponse("Only the museum's proxy is answered here.", 403)
        if request.method not in ("GET", "HEAD", "POST"):
            return PlainTextResponse("No such method.", 405)
        if request.method == "POST" and not self._own(request):
            return PlainTextResponse("The form came from another site.", 403)
        return None

    def _trusted(self, request: Request) -> bool:
        try:
            peer = ip_address(request.client.host if request.client else "")
        except ValueError:
            return False
        return any(peer in network for network in self._proxies)

    def _own(self, request: Request) -> bool:
        """Whether a form was sent from a page of this site, as far as the browser says."""
        if request.headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return False
        origin = request.headers.get("origin")
        if origin is None:
            return True
        return origin in self._origins or origin == f"{request.url.scheme}://{request.headers['host']}"

    async def _with_headers(self, app: Any, scope: Scope, receive: Receive, send: Send) -> None:
        async def headed(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                there = {name.lower() for name, _ in message["headers"]}
                message["headers"] = [*message["headers"], *(one for one in _ADDED if one[0] not in there)]
            await send(message)

        await app(scope, receive, headed)


def _too_long(most: int) -> PlainTextResponse:
    return PlainTextResponse(f"That is more than the {most / 1e6:.0f} MB that are taken at once.", 413)


def _hostname(host: str) -> str:
    try:
        return (urlsplit(f"//{host}").hostname or "").rstrip(".")
    except ValueError:
        return ""


def _everywhere(host: str) -> bool:
    """Whether a host is no address by which one could ask, but all that this machine has."""
    try:
        return ip_address(host).is_unspecified
    except ValueError:
        return False


def _origin(address: str) -> str:
    parts = urlsplit(address)
    return f"{parts.scheme}://{parts.netloc}"


def person(request: Request, settings: ServeSettings, engine: Database) -> Person | None:
    """Return who asks; None where nobody is known who may.

    Parameters
    ----------
    request : Request
        Which the guard let pass.
    settings : ServeSettings
        Of which the identity counts.
    engine : Database
        With the accounts.
    """
    if settings.identity == "accounts":
        token = request.cookies.get(SESSION_COOKIE, "")
        account = of_token(engine, token)
        return None if account is None else Person(account.name, account.role == "editor", True, token)
    if settings.identity == "header":
        given = request.headers.getlist(settings.header)
        name = _text(given[0]) if len(given) == 1 else ""
        return Person(name, name in settings.editors, True) if name else None
    # The account that the desk runs under is nobody of the museum: a name is that which the browser's user typed last.
    return Person(_text(unquote(request.cookies.get(NAME_COOKIE, ""))) or person_named(), True, False)


def named_cookie(name: str) -> str:
    """Return a name as a cookie carries it."""
    return quote(name, safe="")


def _text(header: str) -> str:
    """Return a header or a cookie as text: a header comes as bytes read as Latin-1; one that names nobody is empty."""
    try:
        name = header.encode("latin-1").decode("utf-8").strip()
    except UnicodeError:
        name = header.strip()
    return name if name.isprintable() and len(name) <= WHO_LIMIT else ""


def form_seed(request: Request, who: Person | None) -> tuple[str, bool]:
    """Return what the tokens of a browser's forms are made of, and whether it must be given to the browser first."""
    if who is not None and who.session:
        return who.session, False
    there = request.cookies.get(FORM_COOKIE, "")
    return (there, False) if len(there) >= 40 else (secrets.token_urlsafe(32), True)


def form_token(seed: str) -> str:
    """Return the token that a form of a browser carries."""
    return hmac.new(seed.encode("utf-8", "surrogatepass"), b"kouros form", hashlib.sha256).hexdigest()


def is_form_token(given: str, seed: str) -> bool:
    """Whether a form carries the token of its browser."""
    return hmac.compare_digest(given.encode("utf-8", "surrogatepass"), form_token(seed).encode())
