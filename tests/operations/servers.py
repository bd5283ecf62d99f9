"""A real HTTP server and a real mail server on this machine, which keep what they are told."""

from __future__ import annotations

import base64
import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socketserver import StreamRequestHandler, ThreadingTCPServer
from threading import Event, Thread
from typing import Any

CERTIFICATE = Path(__file__).parents[1] / "data" / "tls" / "localhost.pem"
"""A certificate with its key for localhost, signed by itself: trusted by nobody but these tests."""


class Web(ThreadingHTTPServer):
    """Answers what it is told to: a list of codes, one after the other, the last for ever; 0 is no answer at all."""

    daemon_threads = True

    def __init__(self, answers: list[int], location: str = "") -> None:
        super().__init__(("127.0.0.1", 0), _WebHandler)
        self.answers, self.location = answers, location
        self.heard: list[tuple[dict[str, str], bytes]] = []
        self.over = Event()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/kouros"


class _WebHandler(BaseHTTPRequestHandler):
    server: Web

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        place = min(len(self.server.heard), len(self.server.answers) - 1)
        self.server.heard.append((dict(self.headers), body))
        code = self.server.answers[place]
        if not code:
            self.server.over.wait(20.0)
            return
        self.send_response(code)
        if self.server.location:
            self.send_header("Location", self.server.location)
        self.end_headers()

    do_GET = do_POST  # noqa: N815 - as the standard library calls it

    def log_message(self, *_: Any) -> None:
        pass


@contextmanager
def web(*answers: int, location: str = "") -> Iterator[Web]:
    server = Web(list(answers) or [204], location)
    with _serving(server):
        yield server
        server.over.set()


class Mail(ThreadingTCPServer):
    """A mail server (RFC 5321) with STARTTLS and AUTH where it is told so; it keeps whole mails."""

    daemon_threads = True

    def __init__(self, *, tls: bool, password: str, refused: str) -> None:
        super().__init__(("127.0.0.1", 0), _MailHandler)
        self.tls, self.password, self.refused = tls, password, refused
        self.mails: list[tuple[str, list[str], bytes]] = []
        self.encrypted: list[bool] = []

    @property
    def port(self) -> int:
        return int(self.server_address[1])


class _MailHandler(StreamRequestHandler):
    server: Mail
    timeout = 20.0

    def handle(self) -> None:
        self.secret = False
        self.known = not self.server.password
        sender, to = "", list[str]()
        self.say("220 localhost")
        while line := self.rfile.readline(4096).decode("ascii").strip():
            verb = line.upper().split(":")[0]
            if verb.startswith("EHLO"):
                offers = ["STARTTLS"] if self.server.tls and not self.secret else []
                offers += ["AUTH PLAIN"] if self.server.password else []
                for offer in ["localhost", *offers]:
                    self.say(f"250-{offer}")
                self.say("250 SIZE 10000000")
            elif verb == "STARTTLS":
                self.encrypt()
            elif verb.startswith("AUTH PLAIN"):
                _, user, password = base64.b64decode(line.split()[2]).decode().split("\0")
                self.known = (user, password) == ("kouros", self.server.password)
                self.say("235 ok" if self.known else "535 no")
            elif verb == "MAIL FROM":
                sender = line.partition("<")[2].partition(">")[0]
                self.say("250 ok" if self.known else "530 who are you")
            elif verb == "RCPT TO":
                wanted = line.partition("<")[2].partition(">")[0]
                good = wanted != self.server.refused
                to += [wanted] if good else []
                self.say("250 ok" if good else "550 nobody of that name")
            elif verb == "DATA":
                self.say("354 go on")
                self.server.mails.append((sender, to, self.data()))
                self.server.encrypted.append(self.secret)
                self.say("250 taken")
            elif verb == "QUIT":
                self.say("221 bye")
                return
            else:
                self.say("250 ok")

    def data(self) -> bytes:
        lines = []
        while (line := self.rfile.readline()) != b".\r\n":
            lines.append(line.removeprefix(b"."))
        return b"".join(lines)

    def encrypt(self) -> None:
        self.say("220 go on")
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(CERTIFICATE)
        self.connection = context.wrap_socket(self.connection, server_side=True)
        self.rfile, self.wfile = self.connection.makefile("rb"), self.connection.makefile("wb", 0)  # type: ignore[assignment]
        self.secret = True

    def say(self, line: str) -> None:
        self.wfile.write(line.encode() + b"\r\n")


class _Quiet(Mail):
    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that distrusts the certificate hangs up, as it should."""


@contextmanager
def mail(*, tls: bool = False, password: str = "", refused: str = "") -> Iterator[Mail]:
    server = _Quiet(tls=tls, password=password, refused=refused)
    with _serving(server):
        yield server


@contextmanager
def _serving(server: Any) -> Iterator[None]:
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
