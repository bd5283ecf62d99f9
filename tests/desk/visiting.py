"""A desk that really runs, in a process of its own, and a visitor with cookies who speaks HTTP to it."""

from __future__ import annotations

import http.client
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from html import unescape
from http.cookies import SimpleCookie
from pathlib import Path
from threading import Thread
from urllib.parse import quote, urlencode, urlsplit

from lxml import html

from pipeline.desk.serving import server_of

START = "import sys; sys.argv = ['kouros', *sys.argv[1:]]; from pipeline.cli import main; main()"


@contextmanager
def desk(folder: Path, *words: str, environment: Mapping[str, str] | None = None) -> Iterator[str]:
    """Run `kouros serve` beside the settings in a folder, and yield its address."""
    env = {**os.environ, **(environment or {}), "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(
        [sys.executable, "-c", START, "serve", "--port", "0", *words],
        cwd=folder,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("the desk: http://"), line + process.stdout.read()
        yield line.split()[-1].rstrip("/")
    finally:
        process.terminate()
        process.wait(timeout=10)


@contextmanager
def served(folder: Path, host: str | None = None) -> Iterator[str]:
    """Run the same server over the settings in a folder, in a thread of this process: a start costs no seconds."""
    server, listening, address = server_of(folder / "kouros.toml", host, 0)
    thread = Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    thread.start()
    try:
        yield address.rstrip("/")
    finally:
        server.should_exit = True
        thread.join(timeout=10)
        listening.close()


@dataclass
class Got:
    """An answer."""

    status: int
    headers: http.client.HTTPMessage
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()

    @property
    def page(self) -> html.HtmlElement:
        return html.fromstring(self.body)

    def hidden(self, form: str, name: str) -> str:
        """Return a hidden field of the first form with that action."""
        return str(self.page.xpath(f"//form[@action='{form}']//input[@name='{name}']/@value")[0])

    @property
    def alert(self) -> str:
        return " ".join(self.page.xpath("//*[@role='alert']//text()")).strip()


@dataclass
class Visitor:
    """Somebody with a browser: keeps cookies, sends forms as one does."""

    address: str
    headers: dict[str, str] = field(default_factory=dict)
    cookies: dict[str, str] = field(default_factory=dict)

    def ask(self, method: str, path: str, body: bytes = b"", headers: Mapping[str, str] | None = None) -> Got:
        parts = urlsplit(self.address)
        connection = http.client.HTTPConnection(parts.hostname or "", parts.port, timeout=30)
        sent = {**self.headers, **(headers or {})}
        if self.cookies:
            sent["Cookie"] = "; ".join(f"{name}={value}" for name, value in self.cookies.items())
        try:
            connection.request(method, path, body or None, sent)
            answer = connection.getresponse()
            got = Got(answer.status, answer.headers, answer.read())
        finally:
            connection.close()
        for line in answer.headers.get_all("set-cookie") or ():
            for name, morsel in SimpleCookie(line).items():
                self.cookies[name] = morsel.value
        return got

    def get(self, path: str, headers: Mapping[str, str] | None = None, **query: str) -> Got:
        return self.ask("GET", path + (f"?{urlencode(query)}" if query else ""), headers=headers)

    def object(self, number: str) -> Got:
        return self.get("/object", number=number)

    def post(self, path: str, headers: Mapping[str, str] | None = None, **fields: str) -> Got:
        told = {"Content-Type": "application/x-www-form-urlencoded", **(headers or {})}
        return self.ask("POST", path, urlencode(fields).encode(), told)

    def upload(self, path: str, content: bytes, **fields: str) -> Got:
        edge = "kouros-edge"
        parts = [
            f'--{edge}\r\nContent-Disposition: form-data; name="{name}"\r\n\r\n{value}\r\n'.encode()
            for name, value in fields.items()
        ]
        head = f'--{edge}\r\nContent-Disposition: form-data; name="image"; filename="../../x.php"\r\n\r\n'.encode()
        body = b"".join(parts) + head + content + f"\r\n--{edge}--\r\n".encode()
        return self.ask("POST", path, body, {"Content-Type": f"multipart/form-data; boundary={edge}"})

    def said_of(self, number: str, path: str, seen: Got | None = None, **fields: str) -> Got:
        """Send a form of an object's page, as it was when it was seen."""
        seen = seen or self.object(number)
        keys = {name: seen.hidden(path, name) for name in ("token", "version")}
        return self.post(path, number=number, **{"who": "A. Smith", **keys, **fields})

    def follow(self, got: Got) -> Got:
        assert got.status == 303, (got.status, got.text[:500] if got.status == 500 else got.alert)
        return self.get(unescape(got.headers["location"]))


def address_of(number: str) -> str:
    return f"/object?number={quote(number)}"
