"""Whom a night tells: a real program, a real HTTP server, a real mail server; and what they are told of a failure."""

from __future__ import annotations

import email
import email.policy
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from pipeline.operations import hooks as module
from pipeline.operations.hooks import look, named, tell
from pipeline.operations.secrets import hider
from pipeline.settings import Settings, SettingsError, load_settings
from pipeline.settings.operations import CommandHook, EmailHook, Hooks, WebhookHook

from .servers import CERTIFICATE, Mail, mail, web

TOKEN = "t0ken-that-nobody-may-read"
OPEN = {"host": "h", "sender": "k@m", "to": ["a@b"], "user": "k", "password_from": "KOUROS_P"}
DOCUMENT: dict[str, Any] = {
    "event": "changed",
    "time": "2031-05-01T03:00:00+00:00",
    "version": "1",
    "museum": "Museum\r\nBcc: everybody@museum.example",
    "message": "3 verdicts changed: 1 worse, 1 fixed, 1 other.",
    "exit_code": 0,
    "error": None,
    "summary": None,
    "last_good": {"run_id": "r", "finished": "", "report": "r/index.html"},
}


@pytest.fixture(autouse=True)
def _no_proxy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1,localhost")
    monkeypatch.setattr(module, "_PAUSE", 0.01)


def told(hooks: Hooks, event: Any = "changed", **environment: str) -> list[str]:
    """Return what was said about each hook that was told."""
    known = dict(os.environ) | environment
    hide = hider(Settings(hooks=hooks), known)
    return [one.problem for one in tell(hooks, event, DOCUMENT, hide, known)]


def program(folder: Path, code: str) -> tuple[str, ...]:
    file = folder / "program.py"
    file.write_text(code, encoding="utf-8")
    return sys.executable, str(file)


def test_a_command_gets_the_event_and_no_secret(tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    answer = "json.dumps([json.load(sys.stdin), sys.argv[1:], *os.environ])"
    code = f"import json, os, sys; open({str(out)!r}, 'w').write({answer})"
    command = CommandHook(run=(*program(tmp_path, code), "$(id)", "; ls"))
    hooks = Hooks(command=(command,), webhook=(WebhookHook(url_from="KOUROS_HOOK", on=("failed",)),))
    assert told(hooks, KOUROS_HOOK="https://h.example/x", KOUROS_DATABASE="postgresql://h/x", OTHER="1") == [""]
    document, words, *names = json.loads(out.read_text(encoding="utf-8"))
    assert document == DOCUMENT
    assert words == ["$(id)", "; ls"]  # no shell saw them
    assert "OTHER" in names
    assert not {"KOUROS_HOOK", "KOUROS_DATABASE"} & set(names)


def test_a_command_that_fails_or_hangs_is_said_and_ended(tmp_path: Path) -> None:
    wrong = CommandHook(run=program(tmp_path, "import sys; sys.exit('it is ' + 7 * 'no ')"))
    assert told(Hooks(command=(wrong,))) == ["ended with 1: it is no no no no no no no"]
    assert "cannot be started" in told(Hooks(command=(CommandHook(run=("no-such-program",)),)))[0]
    # A program that starts another one and waits for it: both are ended, so that no hook holds up the next night.
    mark = tmp_path / "mark"
    child = f"import time; time.sleep(1.5); open({str(mark)!r}, 'w')"
    code = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}])"
    began = time.monotonic()
    hanging = CommandHook(run=program(tmp_path, code), timeout_s=0.5)
    assert told(Hooks(command=(hanging,))) == ["took more than 0.5 s and was ended"]
    assert time.monotonic() - began < 1.4
    time.sleep(1.7)
    assert not mark.exists()


def test_only_the_events_that_were_asked_for_are_told(tmp_path: Path) -> None:
    hook = CommandHook(run=program(tmp_path, ""), on=("failed",))
    assert told(Hooks(command=(hook,)), "changed") == []
    assert told(Hooks(command=(hook,)), "failed") == [""]


def test_a_webhook_is_signed_and_told_once() -> None:
    with web(204) as server:
        hook = WebhookHook(url_from="KOUROS_ADDRESS", token_from="KOUROS_TOKEN")
        assert told(Hooks(webhook=(hook,)), KOUROS_ADDRESS=server.url, KOUROS_TOKEN=TOKEN) == [""]
    [(headers, body)] = server.heard
    assert json.loads(body) == DOCUMENT
    assert headers["Authorization"] == f"Bearer {TOKEN}"
    assert (headers["Content-Type"], headers["X-Kouros-Event"]) == ("application/json", "changed")


def test_a_netrc_gives_no_other_password(tmp_path: Path) -> None:
    """requests would put the password of ~/.netrc for this host in the place of the token."""
    netrc = tmp_path / "netrc"
    netrc.write_text("machine 127.0.0.1 login somebody password else\n", encoding="utf-8")
    before = os.environ.get("NETRC")
    os.environ["NETRC"] = str(netrc)
    try:
        with web(204) as server:
            assert told(Hooks(webhook=(WebhookHook(url=server.url),))) == [""]
    finally:
        os.environ.pop("NETRC") if before is None else os.environ.update(NETRC=before)
    assert "Authorization" not in server.heard[0][0]


@pytest.mark.parametrize(("answers", "heard"), [((503, 429, 204), 3), ((500, 200), 2)])
def test_a_server_that_is_busy_is_asked_again(answers: tuple[int, ...], heard: int) -> None:
    with web(*answers) as server:
        assert told(Hooks(webhook=(WebhookHook(url=server.url),))) == [""]
    assert len(server.heard) == heard


@pytest.mark.parametrize(("code", "heard", "said"), [(500, 3, "answered 500, after 3"), (403, 1, "answered 403")])
def test_a_webhook_that_refuses_is_said(code: int, heard: int, said: str) -> None:
    with web(code) as server:
        assert said in told(Hooks(webhook=(WebhookHook(url=server.url),)))[0]
    assert len(server.heard) == heard


@pytest.mark.parametrize("code", [301, 302, 303, 307, 308])
def test_a_redirection_is_never_followed(code: int) -> None:
    """The token must not go to whoever the first server names."""
    with web(204) as thief, web(code, location=thief.url) as server:
        hook = WebhookHook(url=server.url, token_from="KOUROS_TOKEN")
        assert "a redirection, which is never followed" in told(Hooks(webhook=(hook,)), KOUROS_TOKEN=TOKEN)[0]
    assert thief.heard == []


def test_a_webhook_that_never_answers_ends_in_time() -> None:
    with web(0) as server:
        began = time.monotonic()
        hook = WebhookHook(url=server.url, timeout_s=0.3, retries=1)
        assert "no answer: ReadTimeout, after 2 attempts" in told(Hooks(webhook=(hook,)))[0]
        assert time.monotonic() - began < 5.0


def test_a_failure_does_not_tell_the_secret_address() -> None:
    secret = "http://127.0.0.1:9/services/T0P/S3CRET"
    said = told(Hooks(webhook=(WebhookHook(url_from="KOUROS_ADDRESS", retries=0),)), KOUROS_ADDRESS=secret)
    assert "no answer" in said[0]
    assert "S3CRET" not in said[0]


def unencrypted(server: Mail) -> EmailHook:
    to = "a@m.example", "b@m.example"
    return EmailHook(host="127.0.0.1", port=server.port, security="none", sender="k@museum.example", to=to)


def test_a_mail_goes_out_and_its_subject_is_one_line() -> None:
    with mail() as server:
        hook = unencrypted(server)
        assert told(Hooks(email=(hook,)), "failed") == [""]
    [(sender, to, raw)] = server.mails
    assert (sender, to) == ("k@museum.example", ["a@m.example", "b@m.example"])
    message = email.message_from_bytes(raw, policy=email.policy.default)
    assert message["Subject"] == "Kouros: the run failed, Museum Bcc: everybody@museum.example"
    assert message["Bcc"] is None
    body, attached = message.iter_parts()
    first, second, *_rest = body.get_content().splitlines()
    assert first == "THE NIGHT FAILED and brought no new report. Because:"
    assert second == DOCUMENT["message"]
    assert json.loads(attached.get_content()) == DOCUMENT


def test_a_password_goes_only_to_a_server_whose_certificate_is_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    def hook(port: int) -> Hooks:
        return Hooks(
            email=(
                EmailHook(
                    host="localhost",
                    port=port,
                    sender="k@museum.example",
                    to=("a@m.example",),
                    user="kouros",
                    password_from="KOUROS_SMTP_PASSWORD",
                    timeout_s=5.0,
                ),
            )
        )

    with mail(tls=True, password=TOKEN) as server:
        [said] = told(hook(server.port), KOUROS_SMTP_PASSWORD=TOKEN)
        assert "SSLCertVerificationError" in said
        # A server that cannot encrypt gets no password either.
        with mail(password=TOKEN) as plain_server:
            assert "STARTTLS" in told(hook(plain_server.port), KOUROS_SMTP_PASSWORD=TOKEN)[0]
        monkeypatch.setenv("SSL_CERT_FILE", str(CERTIFICATE))
        assert told(hook(server.port), KOUROS_SMTP_PASSWORD=TOKEN) == [""]
        assert server.encrypted == [True]
        assert "535" in told(hook(server.port), KOUROS_SMTP_PASSWORD="wrong")[0]


def test_a_mail_that_some_do_not_get_is_said() -> None:
    with mail(refused="b@m.example") as server:
        hook = unencrypted(server)
        assert told(Hooks(email=(hook,))) == ["the mail was not taken for b@m.example"]
    assert server.mails[0][1] == ["a@m.example"]


def test_one_hook_that_fails_keeps_no_other_from_being_told(tmp_path: Path) -> None:
    with web(204) as server:
        first = WebhookHook(url="http://127.0.0.1:9/", retries=0)
        said = told(Hooks(command=(CommandHook(run=("absent",)),), webhook=(first, WebhookHook(url=server.url))))
    assert [bool(problem) for problem in said] == [True, True, False]


def test_a_look_sends_nothing_and_names_what_is_missing() -> None:
    with web(204) as server:
        assert look(WebhookHook(url=server.url)) == ""
        assert "the environment lacks KOUROS_T" in look(WebhookHook(url=server.url, token_from="KOUROS_T"), {})
    assert server.heard == []
    assert "no program 'absent'" in look(CommandHook(run=("absent",)))
    assert look(CommandHook(run=(sys.executable,))) == ""
    assert "cannot be found" in look(WebhookHook(url="https://no-such-host.invalid/"))
    mail_hook = EmailHook(host="localhost", sender="k@m.example", to=("a@m.example",))
    assert look(mail_hook) == ""


def test_names_hold_no_secret() -> None:
    hooks = Hooks(webhook=(WebhookHook(url="https://h.example/services/S3CRET"), WebhookHook(url_from="KOUROS_W")))
    assert [name for name, _ in named(hooks)] == ["webhook h.example", "webhook KOUROS_W"]


@pytest.mark.parametrize(
    "hook",
    [
        {"webhook": [{"url": "https://user:pass@h.example/"}]},
        {"webhook": [{"url": "file:///etc/passwd"}]},
        {"webhook": [{"url": "https://h.example/", "url_from": "KOUROS_A"}]},
        {"webhook": [{}]},
        {"webhook": [{"url_from": "PATH"}]},
        {"webhook": [{"url": "https://h.example/", "on": ["always"]}]},
        {"command": [{"run": "rm -rf /"}]},
        {"command": [{"run": []}]},
        {"email": [{"host": "h", "sender": "k@m\r\nBcc: x@y", "to": ["a@b"]}]},
        {"email": [{"host": "h", "sender": "k@m", "to": ["a@b"], "user": "k"}]},
        {"email": [OPEN | {"security": "none"}]},
        {"email": [{"host": "h", "sender": "k@m", "to": ["a@b"], "password": "geheim"}]},
    ],
)  # fmt: skip
def test_hooks_that_cannot_be_meant_are_refused(hook: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Hooks.model_validate(hook)


def test_a_secret_in_the_wrong_place_is_refused_and_not_repeated(tmp_path: Path) -> None:
    file = tmp_path / "kouros.toml"
    for text, key in (
        ('[[hooks.webhook]]\nurl = "https://u:geheim@h.example/"', "hooks.webhook.0"),
        ('[[hooks.email]]\npassword = "geheim"\nhost = "h"\nsender = "k@m"\nto = ["a@b"]', "hooks.email.0.password"),
        ('[inventory]\ndatabase = "postgresql://u:geheim@h/db"', "inventory.database"),
        ('[collection]\nsource = "postgresql://u:geheim@h/db"', "collection.source"),
    ):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(SettingsError, match=key) as raised:
            load_settings(file)
        assert "geheim" not in str(raised.value)
        assert raised.value.__suppress_context__
    file.write_text('[collection]\nsource = "postgresql://u:${PW}@h/db"', encoding="utf-8")
    assert load_settings(file).collection.source.endswith("@h/db")
