"""Telling programs, servers and people what a night came to.  A hook that fails is said, and never fails the night.

The webhook goes by requests, which obspy brings along in any case; mail by smtplib and email of the standard library.
What is sent is schemas/event.schema.json; no secret is ever in it.
"""

import json
import os
import shutil
import signal
import smtplib
import socket
import ssl
import subprocess
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from email.message import EmailMessage
from email.utils import formatdate, make_msgid
from tempfile import TemporaryFile
from time import sleep
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from pipeline import __version__
from pipeline.errors import KourosError
from pipeline.quantities import counted
from pipeline.report.text import plain
from pipeline.settings import DATABASE_VARIABLE
from pipeline.settings.operations import CommandHook, EmailHook, Event, Hooks, WebhookHook, check_address

if TYPE_CHECKING:
    from requests import PreparedRequest

SUBJECTS: Mapping[Event, str] = {
    "changed": "what changed",
    "failed": "the run failed",
    "shrunk": "collection shrank",
    "shaken": "after an earthquake",
}

_NO_REPORT: Mapping[str, str] = {
    "failed": "THE NIGHT FAILED and brought no new report. Because:",
    "shrunk": "THE NIGHT STOPPED and brought no new report, because the collection is much smaller than before:",
}
"""How a mail begins of a night that leaves an older report to be read."""

_SAID = 500
"""Characters of what a program or a server answers that are repeated."""

_PAUSE = 1.0
"""Seconds before the second attempt; each further pause is twice as long."""


class HookError(KourosError):
    """A hook that could not be told; the message holds no secret that the hook itself knows of."""


@dataclass(frozen=True)
class Told:
    """Whether a hook was told.

    Attributes
    ----------
    hook : str
        Its kind, and the program or host.
    problem : str
        "" where it was told.
    """

    hook: str
    problem: str = ""


def tell(
    hooks: Hooks,
    event: Event,
    document: Mapping[str, Any],
    hide: Callable[[str], str],
    environment: Mapping[str, str] | None = None,
) -> list[Told]:
    """Tell every hook that wants this event, one after the other; nothing is raised.

    Parameters
    ----------
    hooks : Hooks
        Those of the settings.
    event : {"changed", "failed", "shrunk", "shaken"}
        What happened.
    document : mapping
        Of schemas/event.schema.json, JSON-ready.
    hide : callable
        Takes the secrets out of what is said about a failure.
    environment : mapping of str to str, or None
        Of this process, unless given.

    Returns
    -------
    list of Told
        One for each hook that wants this event.
    """
    known = os.environ if environment is None else environment
    body = json.dumps(document, allow_nan=False).encode()
    out = []
    for name, hook in named(hooks):
        if event not in hook.on:
            continue
        try:
            match hook:
                case CommandHook():
                    _command(
                        hook, body, {k: v for k, v in known.items() if k not in (*hooks.variables, DATABASE_VARIABLE)}
                    )
                case WebhookHook():
                    _webhook(hook, event, body, known)
                case EmailHook():
                    _email(hook, event, document, body, known)
        except Exception as problem:  # noqa: BLE001 - whatever a hook does, the night is done
            said = str(problem) if isinstance(problem, HookError) else f"{type(problem).__name__}: {problem}"
            out.append(Told(name, hide(" ".join(said.split()))[:_SAID]))
        else:
            out.append(Told(name))
    return out


def named(hooks: Hooks) -> list[tuple[str, CommandHook | WebhookHook | EmailHook]]:
    """Return every hook with a name for messages, which holds no secret."""
    return [
        *((f"command {hook.run[0]}", hook) for hook in hooks.command),
        *((f"webhook {urlsplit(hook.url).hostname or hook.url_from}", hook) for hook in hooks.webhook),
        *((f"email {hook.host}", hook) for hook in hooks.email),
    ]


def look(hook: CommandHook | WebhookHook | EmailHook, environment: Mapping[str, str] | None = None) -> str:
    """Return what would keep a hook from being told; nothing is sent, only names are looked up.

    Parameters
    ----------
    hook : CommandHook, WebhookHook or EmailHook
        Of the settings.
    environment : mapping of str to str, or None
        Of this process, unless given.

    Returns
    -------
    str
        "" for nothing.
    """
    known = os.environ if environment is None else environment
    try:
        match hook:
            case CommandHook():
                return "" if shutil.which(hook.run[0]) else f"there is no program {hook.run[0]!r}; give its whole path"
            case WebhookHook():
                _token(hook, known)
                parts = urlsplit(_address(hook, known))
                _resolves(parts.hostname or "", parts.port or (443 if parts.scheme == "https" else 80))
            case EmailHook():
                _password(hook, known)
                _resolves(hook.host, hook.port)
    except HookError as problem:
        return str(problem)
    return ""


def _resolves(host: str, port: int) -> None:
    try:
        socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as problem:
        raise HookError(f"the host cannot be found ({problem}); see whether its name is right") from None


def _variable(name: str, known: Mapping[str, str]) -> str:
    value = known.get(name, "")
    if not value:
        raise HookError(f"the environment lacks {name}; set it where Kouros is started")
    return value


# ---------------------------------------------------------------------------------------------------------------------
# A command


def _command(hook: CommandHook, body: bytes, environment: Mapping[str, str]) -> None:
    with TemporaryFile() as given, TemporaryFile() as complaints:
        given.write(body)
        given.seek(0)
        try:
            # The museum's own settings name the program; there is no shell, so that nothing in a record is a command.
            process = subprocess.Popen(  # noqa: S603
                hook.run,
                stdin=given,
                stdout=subprocess.DEVNULL,
                stderr=complaints,
                env=environment,
                start_new_session=True,
            )
        except OSError as problem:
            raise HookError(f"cannot be started: {problem.strerror or problem}") from None
        try:
            code = process.wait(timeout=hook.timeout_s)
        except subprocess.TimeoutExpired:
            _end(process)
            raise HookError(f"took more than {hook.timeout_s:g} s and was ended") from None
        complaints.seek(0)
        if code:
            said = complaints.read(4 * _SAID).decode("utf-8", "replace").strip()
            raise HookError(f"ended with {code}" + (f": {said}" if said else ""))


def _end(process: subprocess.Popen[bytes]) -> None:
    # With the programs that it started itself, which are of its session.
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


# ---------------------------------------------------------------------------------------------------------------------
# A webhook


def _address(hook: WebhookHook, known: Mapping[str, str]) -> str:
    url = hook.url or _variable(hook.url_from, known)
    try:
        check_address(url)
    except ValueError as problem:
        raise HookError(f"{hook.url_from}: {problem}") from None
    return url


def _token(hook: WebhookHook, known: Mapping[str, str]) -> str:
    return _variable(hook.token_from, known) if hook.token_from else ""


def _webhook(hook: WebhookHook, event: Event, body: bytes, known: Mapping[str, str]) -> None:
    import requests

    url, token = _address(hook, known), _token(hook, known)
    headers = {
        "Content-Type": "application/json",
        "User-Agent": f"kouros/{__version__}",
        "X-Kouros-Event": event,
    }

    def sign(request: "PreparedRequest") -> "PreparedRequest":
        # Given as a function, so that no ~/.netrc puts another password into its place.
        if token:
            request.headers["Authorization"] = f"Bearer {token}"
        return request

    for attempt in range(hook.retries + 1):
        if attempt:
            sleep(_PAUSE * 2 ** (attempt - 1))
        last = attempt == hook.retries
        try:
            # The answer's body is never read: it may be endless.
            with requests.post(
                url,
                data=body,
                headers=headers,
                auth=sign,
                timeout=hook.timeout_s,
                allow_redirects=False,
                stream=True,
            ) as answer:
                code = answer.status_code
        except requests.RequestException as problem:
            if last:
                # The exception's own text holds the whole address.
                raise HookError(f"no answer: {_kind(problem)}, after {counted(attempt + 1, 'attempt')}") from None
            continue
        if 200 <= code < 300:
            return
        if 300 <= code < 400:
            raise HookError(f"answered {code}, a redirection, which is never followed; give the address it leads to")
        if last or not (code == 429 or code >= 500):
            raise HookError(f"answered {code}, after {counted(attempt + 1, 'attempt')}")


def _kind(problem: Exception) -> str:
    return type(problem).__name__


# ---------------------------------------------------------------------------------------------------------------------
# A mail


def _password(hook: EmailHook, known: Mapping[str, str]) -> str:
    return _variable(hook.password_from, known) if hook.password_from else ""


def _email(hook: EmailHook, event: Event, document: Mapping[str, Any], body: bytes, known: Mapping[str, str]) -> None:
    password = _password(hook, known)
    message = _mail(hook, event, document, body)
    trusted = ssl.create_default_context()
    try:
        if hook.security == "tls":
            server: smtplib.SMTP = smtplib.SMTP_SSL(hook.host, hook.port, timeout=hook.timeout_s, context=trusted)
        else:
            server = smtplib.SMTP(hook.host, hook.port, timeout=hook.timeout_s)
        with server:
            if hook.security == "starttls":
                server.starttls(context=trusted)
            if password:
                server.login(hook.user, password)
            refused = server.send_message(message)
    except (OSError, smtplib.SMTPException) as problem:
        raise HookError(f"the mail was not taken: {type(problem).__name__}: {problem}") from None
    if refused:
        raise HookError(f"the mail was not taken for {', '.join(refused)}")


def _mail(hook: EmailHook, event: Event, document: Mapping[str, Any], body: bytes) -> EmailMessage:
    message = EmailMessage()
    # A header is one line whatever the museum is called.
    message["Subject"] = plain(f"Kouros: {SUBJECTS[event]}" + (f", {document['museum']}" if document["museum"] else ""))
    message["From"] = hook.sender
    message["To"] = ", ".join(hook.to)
    message["Date"] = formatdate()
    message["Message-ID"] = make_msgid(domain=hook.sender.rpartition("@")[2])
    message["Auto-Submitted"] = "auto-generated"
    good = document["last_good"]
    last = "There is no good report yet."
    if good:
        of = f", of {good['finished']}" if good.get("finished") else ""
        last = f"The last good report: {good['report']} in the folder of reports{of}."
    lines = [
        *filter(None, [_NO_REPORT.get(event)]),
        *_told_lines(document),
        "",
        last,
        f"At {document['time']}, by Kouros {document['version']}.  The attachment says more, for programs.",
    ]
    message.set_content("\n".join(lines) + "\n")
    message.add_attachment(body, maintype="application", subtype="json", filename="kouros.json")
    return message


def _told_lines(document: Mapping[str, Any]) -> list[str]:
    """Return what happened, news of objects one a line."""
    news = (((document["summary"] or {}).get("changes") or {}).get("news") or {}).get("sentences", [])
    rest = plain(document["message"].removeprefix(" ".join(news)))
    return [*(f"- {plain(sentence)}" for sentence in news), *([rest] if rest else [])]
