"""Who may ask the desk for what: strange hosts, peers, origins, paths, lengths; accounts and a proxy's word."""

from __future__ import annotations

import socket
from base64 import b64encode
from hashlib import sha384
from pathlib import Path

import pytest
from lxml import html

from pipeline.desk.app import HTMX
from pipeline.desk.guard import POLICY
from pipeline.desk.serving import add_user, server_of
from pipeline.errors import InputError
from pipeline.report.pages.environment import environment, fill
from pipeline.resources import resource
from pipeline.settings import SettingsError, load_settings
from tests.museum import kouros

from .conftest import HOSTILE
from .visiting import Visitor, desk, served

EVERYWHERE = "0.0.0.0"  # noqa: S104 - refused


def serve(folder: Path, text: str) -> None:
    """Put a table [serve] into the settings of a museum."""
    file = folder / "kouros.toml"
    whole = file.read_text(encoding="utf-8")
    head, _, rest = whole.partition("[serve]\n")
    after = rest[rest.index("\n[") + 1 :] if "\n[" in rest else ""
    file.write_text(f"{head}[serve]\n{text}\n\n{after}", encoding="utf-8")


def test_another_name_of_this_machine_is_refused(visitor: Visitor) -> None:
    """DNS rebinding: the page of a stranger whose name was pointed here comes with that name."""
    strangers = ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "", "localhost@evil.example", "[::")
    for host in (*strangers, "a b"):
        got = visitor.get("/", headers={"Host": host})
        assert got.status in (400, 421), host
        assert b"Vase" not in got.body


def test_its_own_names_are_answered(visitor: Visitor) -> None:
    for host in ("localhost:1", "127.0.0.1", "LOCALHOST", "[::1]:8750", "localhost."):
        assert visitor.get("/", headers={"Host": host}).status == 200, host


def test_what_a_browser_may_do_is_said_on_every_answer(visitor: Visitor) -> None:
    for path in ("/", "/nope", "/object?number=1.1", "/static/desk.css", "/static/../../kouros.toml"):
        got = visitor.get(path)
        assert got.headers["content-security-policy"] == POLICY
        assert "unsafe-inline" not in POLICY.replace("style-src-attr 'unsafe-inline'", "")
        assert got.headers["x-content-type-options"] == "nosniff"
        assert got.headers["referrer-policy"] == "same-origin"
        assert "server" not in got.headers
    assert not visitor.get("/").page.xpath("//script[not(@src)] | //style | //@onclick | //@onload")


def test_the_script_is_the_one_that_is_named(visitor: Visitor) -> None:
    content = resource("templates", "desk", "static", "htmx.min.js").read_bytes()
    assert f"sha384-{b64encode(sha384(content).digest()).decode()}" == HTMX
    assert visitor.get("/static/htmx.min.js").body == content
    assert visitor.get("/").page.xpath("//script/@integrity") == [HTMX]
    assert b"BSD" in resource("templates", "desk", "static", "htmx.LICENSE").read_bytes()


@pytest.mark.parametrize(("name", "told"), [("", "Desk"), ("Our <museum>", "Our <museum> ·\u00a0Desk")])
def test_a_desk_without_a_name_begins_with_no_stray_point(name: str, told: str) -> None:
    context = {
        "museum": name,
        "run": None,
        "who": None,
        "here": "/",
        "htmx": HTMX,
        "words": "No.",
        "problem": "",
        "saved": "",
    }
    page = html.fromstring(fill(environment(), "desk/told.html", context))
    assert page.xpath("string(//header//span)") == told
    assert page.xpath("string(//title)") == f"Desk · {name or 'Desk'}"


def test_a_form_from_elsewhere_is_refused(visitor: Visitor) -> None:
    seen = visitor.object("1.1")
    form = {name: seen.hidden("/object/decide", name) for name in ("token", "version")}
    form |= {"number": "1.1", "kind": "accept", "why": "w", "who": "A"}
    assert visitor.post("/object/decide", headers={"Origin": "https://evil.example"}, **form).status == 403
    assert visitor.post("/object/decide", headers={"Origin": "null"}, **form).status == 403
    assert visitor.post("/object/decide", headers={"Sec-Fetch-Site": "cross-site"}, **form).status == 403
    assert visitor.post("/object/decide", **form | {"token": "x"}).status == 403
    assert visitor.post("/object/decide", **form | {"token": ""}).status == 403
    # Another browser's token is none, nor is one without its cookie.
    assert Visitor(visitor.address).post("/object/decide", **form).status == 403
    assert visitor.post("/object/decide", headers={"Origin": visitor.address}, **form).status == 303


@pytest.mark.parametrize("method", ["PUT", "DELETE", "TRACE", "OPTIONS", "PATCH"])
def test_other_methods_are_refused(visitor: Visitor, method: str) -> None:
    assert visitor.ask(method, "/").status == 405


def test_a_reading_address_writes_nothing(visitor: Visitor) -> None:
    assert visitor.get("/object/decide", number="1.1", kind="accept", why="w").status in (404, 405)


def test_too_much_is_refused(visitor: Visitor) -> None:
    seen = visitor.object("1.1")
    keys = {name: seen.hidden("/object/picture", name) for name in ("token", "version")}
    assert visitor.ask("POST", "/object/picture", b"", {"Content-Length": "999999999999"}).status == 413
    assert visitor.ask("POST", "/object/picture", b"", {"Content-Length": "-5"}).status in (400, 413)
    assert visitor.upload("/object/picture", bytes(15_100_000), number="1.1", who="A", **keys).status in (413, 422)
    # A field is bounded too, and so is how many there are.
    assert visitor.upload("/object/picture", b"x", number="1.1", who="A", note="n" * 300_000, **keys).status == 400
    assert visitor.get("/", q="x" * 60_000).status in (200, 400, 414)
    many = {f"f{n}": "1" for n in range(5_000)}
    assert visitor.post("/object/decide", **many).status == 400
    assert visitor.get("/").status == 200


def test_no_path_leads_out_of_the_report(visitor: Visitor, museum: Path) -> None:
    (museum / "reports" / "secret.html").write_text("secret", encoding="utf-8")
    assert visitor.get("/report/index.html").status == 200
    for path in (
        "/report/../secret.html", "/report/..%2fsecret.html", "/report/%2e%2e/secret.html", "/report/..%5csecret.html",
        "/report/.pages.json", "/report/%00index.html", "/report//etc/passwd", "/static/..%2fstyle.css",
        "/static/%2e%2e/%2e%2e/index.html", "/report/findings.parquet", "/report/parts", "/picture?id=../1",
        "/picture?id=-1", "/picture?id=1%20or%201", "//evil.example/", "/\\evil.example",
    ):  # fmt: skip
        got = visitor.ask("GET", path)
        assert got.status in (400, 404), path
        assert b"secret" not in got.body


def test_it_leads_nowhere_else_and_no_text_becomes_a_header(visitor: Visitor) -> None:
    got = visitor.said_of(HOSTILE, "/object/decide", kind="accept", why="w\r\nSet-Cookie: x=1", who="A")
    assert got.status == 303
    assert got.headers["location"].startswith("/object?number=")
    assert "x=1" not in str(got.headers)
    seen = visitor.object("1.1")
    keys = {name: seen.hidden("/object/measured", name) for name in ("token", "version")}
    away = "//evil.example\r\nX: y"
    got = visitor.post("/object/measured", number="1.1", who="A", following=away, **{"m.mass_kg": "3"}, **keys)
    assert got.headers["location"].startswith("/object?number=%2F%2Fevil.example%0")
    assert "x" not in got.headers


def test_what_is_written_is_sent_at_once(museum: Path) -> None:
    """asyncio tells a connection not to wait for more only where the socket that it came by names its protocol."""
    _server, listening, _address = server_of(museum / "kouros.toml", None, 0)
    with listening:
        assert listening.proto == socket.IPPROTO_TCP


def test_another_host_needs_somebody_known(museum: Path) -> None:
    config = museum / "kouros.toml"
    for host in (EVERYWHERE, "::", "192.0.2.1"):
        with pytest.raises(InputError, match="identity"):
            server_of(config, host, 0)
    serve(museum, 'identity = "accounts"')
    with pytest.raises(InputError, match="addresses"):
        server_of(config, EVERYWHERE, 0)
    with pytest.raises(InputError, match="no account yet"):
        server_of(config, None, 0)
    serve(museum, 'identity = "header"')
    with pytest.raises(SettingsError, match="trusted"):
        load_settings(config)
    for wrong in (
        'trusted = ["proxy"]',
        'addresses = ["https://a:b@c"]',
        'addresses = ["javascript:x"]',
        "port = 99999",
    ):
        serve(museum, wrong)
        with pytest.raises(SettingsError, match="serve"):
            load_settings(config)


@pytest.mark.long("desk/test_paths::test_a_curator_finds_an_object_sees_why_and_accepts_the_risk")
def test_the_command_says_what_it_does(museum: Path) -> None:
    refused = kouros("serve", "--host", EVERYWHERE, folder=museum)
    assert refused.returncode == 2
    assert "[serve] identity" in refused.stderr
    with desk(museum) as there:
        assert Visitor(there).get("/").status == 200
        port = there.rpartition(":")[2]
        taken = kouros("serve", "--port", port, folder=museum)
        assert taken.returncode == 2
        assert "--port" in taken.stderr


def header_desk(folder: Path, trusted: str) -> None:
    serve(
        folder,
        f'identity = "header"\nheader = "X-Forwarded-User"\ntrusted = ["{trusted}"]\neditors = ["Zoë Editor"]\n'
        'addresses = ["https://desk.museum.example"]',
    )


def test_a_proxy_names_people(museum: Path) -> None:
    header_desk(museum, "127.0.0.0/8")
    with served(museum) as there:
        nobody = Visitor(there)
        assert nobody.get("/").status == 401
        for name in ("", " ", "x" * 500):
            assert nobody.get("/", headers={"X-Forwarded-User": name}).status == 401
        reader = Visitor(there, {"X-Forwarded-User": "R. Reader", "Host": "desk.museum.example"})
        page = reader.object("1.1")
        assert page.status == 200
        assert not page.page.xpath("//form[@method='post']")
        assert reader.post("/object/decide", number="1.1", kind="accept", why="w", who="boss").status == 403
        editor = Visitor(there, {"X-Forwarded-User": "Zoë Editor".encode().decode("latin-1")})
        # Who it is stands in the log, whatever the form says, and whatever other headers say.
        done = editor.said_of("1.1", "/object/decide", kind="accept", why="w", who="Somebody Else")
        page = editor.follow(done)
        assert "Zoë Editor" in page.text
        assert "Somebody Else" not in page.text
        # By its public name, and with cookies that go over TLS alone.
        named = Visitor(
            there, {**editor.headers, "Host": "desk.museum.example", "Origin": "https://desk.museum.example"}
        )
        first = named.get("/")
        assert "secure" in first.headers["set-cookie"].lower()
        assert named.said_of("1.2", "/object/decide", kind="accept", why="w").status == 303


def test_nobody_but_the_proxy_is_answered(museum: Path) -> None:
    header_desk(museum, "192.0.2.7")
    with served(museum) as there:
        sent = {"X-Forwarded-User": "Z", "X-Forwarded-For": "192.0.2.7", "Forwarded": "for=192.0.2.7"}
        got = Visitor(there, sent).get("/")
        assert got.status == 403
        assert b"Vase" not in got.body


def sign_in(visitor: Visitor, name: str, password: str) -> int:
    token = visitor.get("/sign-in").hidden("/sign-in", "token")
    return visitor.post("/sign-in", token=token, name=name, password=password).status


def test_accounts(museum: Path) -> None:
    serve(museum, 'identity = "accounts"')
    settings = load_settings(museum / "kouros.toml")
    add_user(settings, "Ed", "editor", "correct horse battery")
    add_user(settings, "Rea", "reader", "staple under the moon")
    for name, role, password in (("x", "king", "long enough here"), ("x", "editor", "short"), ("", "editor", "l" * 20)):
        with pytest.raises(InputError):
            add_user(settings, name, role, password)
    listed = kouros("serve", "--users", folder=museum)
    assert [line.split()[:2] for line in listed.stdout.splitlines()] == [["Ed", "editor"], ["Rea", "reader"]]
    assert b"correct horse" not in (museum / "kouros.sqlite").read_bytes()
    with served(museum) as there:
        stranger = Visitor(there)
        for path in ("/", "/object?number=1.1", "/report/index.html", "/picture?id=1", "/house", "/nope"):
            got = stranger.get(path)
            assert (got.status, got.headers["location"]) == (303, "/sign-in"), path
        assert stranger.post("/object/decide", number="1.1").status == 303
        editor = Visitor(there)
        assert sign_in(editor, "Ed", "wrong horse battery") == 403
        token = editor.get("/sign-in").hidden("/sign-in", "token")
        got = editor.post("/sign-in", token=token, name="Ed", password="correct horse battery")
        cookie = got.headers["set-cookie"].lower()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        # What the browser holds is not what is stored.
        assert editor.cookies["kouros_session"].encode() not in (museum / "kouros.sqlite").read_bytes()
        page = editor.follow(editor.said_of("1.1", "/object/decide", kind="accept", why="w", who="Imposter"))
        assert "Imposter" not in page.text
        reader = Visitor(there)
        assert sign_in(reader, "Rea", "staple under the moon") == 303
        assert reader.get("/").status == 200
        assert reader.post("/object/decide", number="1.1", kind="accept", why="w").status == 403
        # A session ends for good: with the word to end it, and with a new password.
        kept = dict(editor.cookies)
        token = editor.get("/").hidden("/sign-out", "token")
        editor.post("/sign-out", token=token)
        assert Visitor(there, cookies=kept).get("/").status == 303
        add_user(settings, "Rea", "reader", "another under the sun")
        assert reader.get("/").status == 303


def test_who_guesses_must_wait(museum: Path) -> None:
    serve(museum, 'identity = "accounts"')
    add_user(load_settings(museum / "kouros.toml"), "Ed", "editor", "correct horse battery")
    with served(museum) as there:
        visitor = Visitor(there)
        answers = [sign_in(visitor, "Ed", f"guess number {n}") for n in range(7)]
        assert answers == [403] * 5 + [429] * 2
        # Nor does the right word help now: who guesses learns nothing.
        assert sign_in(visitor, "Ed", "correct horse battery") == 429


def test_without_the_extra_it_names_it(museum: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from click.testing import CliRunner

    from pipeline.cli.serving import serve as verb

    monkeypatch.setattr("pipeline.cli.serving.find_spec", lambda name: None if name == "starlette" else object())
    told = CliRunner().invoke(verb, [])
    assert isinstance(told.exception, InputError)
    assert "pip install 'kouros[serve]'" in str(told.exception)
    assert "starlette" in str(told.exception)
