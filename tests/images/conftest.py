"""A real server of images on this machine, and photographs made by Pillow."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO

import pytest
from PIL import Image


def photograph(size: tuple[int, int] = (600, 400), colour: str = "red", kind: str = "JPEG", mode: str = "RGB") -> bytes:
    out = BytesIO()
    Image.new(mode, size, colour).save(out, kind)
    return out.getvalue()


Answer = Callable[["Handler"], None]


class Handler(BaseHTTPRequestHandler):
    """Answers as the server's table says, and notes what was asked."""

    server: "Server"

    def do_GET(self) -> None:
        self.server.site.asked.append(self.path)
        answer = self.server.site.answers.get(self.path)
        if answer is None:
            self.send_error(404)
        else:
            answer(self)

    def say(self, content: bytes, kind: str = "image/jpeg", **headers: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


class Server(ThreadingHTTPServer):
    daemon_threads = True
    site: "Site"

    def handle_error(self, *_: object) -> None:
        """A client that goes away is meant to."""


@dataclass
class Site:
    """What the server holds, and what it was asked for."""

    host: str
    answers: dict[str, Answer] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)

    def url(self, path: str) -> str:
        return f"http://{self.host}{path}"

    def holds(self, path: str, content: bytes, kind: str = "image/jpeg", etag: str = "") -> str:
        """Let it hold a file, known again by its ETag if it has one; return its address."""

        def answer(handler: Handler) -> None:
            if etag and handler.headers.get("If-None-Match") == etag:
                handler.send_response(304)
                handler.send_header("ETag", etag)
                handler.end_headers()
            else:
                handler.say(content, kind, **({"ETag": etag} if etag else {}))

        self.answers[path] = answer
        return self.url(path)

    def moves(self, path: str, to: str) -> str:
        def answer(handler: Handler) -> None:
            handler.send_response(302)
            handler.send_header("Location", to)
            handler.end_headers()

        self.answers[path] = answer
        return self.url(path)

    def drips(self, path: str, seconds: float) -> str:
        """Let it answer a byte at a time."""

        def answer(handler: Handler) -> None:
            handler.send_response(200)
            handler.send_header("Content-Type", "image/jpeg")
            handler.end_headers()
            until = time.monotonic() + seconds
            while time.monotonic() < until:
                handler.wfile.write(b"\xff")
                handler.wfile.flush()
                time.sleep(0.05)

        self.answers[path] = answer
        return self.url(path)


@pytest.fixture
def site() -> Iterator[Site]:
    with Server(("127.0.0.1", 0), Handler) as server:
        server.site = Site(f"127.0.0.1:{server.server_address[1]}")
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server.site
        server.shutdown()
