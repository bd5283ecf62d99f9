"""The settings of operation: whom to tell, what to log and keep, how much to accept; photographs; the desk."""

import re
from ipaddress import ip_network
from typing import Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from pipeline.errors import InputError

Event = Literal["changed", "failed", "shrunk", "shaken"]
"""Verdicts changed; the run failed; the collection shrank suspiciously, and nothing was published; an earthquake was
answered by `kouros event`."""

EVENTS: tuple[Event, ...] = ("changed", "failed", "shrunk", "shaken")

_VARIABLE = r"^KOUROS_[A-Z0-9_]+$"


class SettingsPart(BaseModel):
    """A table of kouros.toml: unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class _Hook(SettingsPart):
    on: tuple[Event, ...] = Field(default=EVENTS, description="the events that are told")
    timeout_s: float = Field(default=30.0, gt=0.0, le=600.0, description="seconds that telling may take")


class CommandHook(_Hook):
    """A program that is started without a shell, with the event as JSON on its standard input."""

    run: tuple[str, ...] = Field(min_length=1, description="the program and its arguments, each a text of its own")

    @field_validator("run")
    @classmethod
    def _startable(cls, words: tuple[str, ...]) -> tuple[str, ...]:
        if not words[0].strip() or any("\0" in word for word in words):
            raise InputError("the first word names a program, and no word holds a NUL character")
        return words


class WebhookHook(_Hook):
    """An address that the event is sent to as JSON, by POST."""

    url: str = Field(default="", description="http:// or https://, where the address is no secret")
    url_from: str = Field(default="", pattern=f"^$|{_VARIABLE}", description="environment variable with the address")
    token_from: str = Field(default="", pattern=f"^$|{_VARIABLE}", description="environment variable with a token")
    retries: int = Field(default=2, ge=0, le=10, description="further attempts after one that failed")

    @model_validator(mode="after")
    def _one_address(self) -> "WebhookHook":
        if bool(self.url) == bool(self.url_from):
            raise InputError("give either url, or url_from with the name of an environment variable")
        if self.url:
            check_address(self.url)
        return self


def check_address(url: str) -> None:
    """Refuse what is no address of a webhook, or holds a password.

    Parameters
    ----------
    url : str
        The address.

    Raises
    ------
    InputError
        Which does not repeat the address.
    """
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise InputError("a webhook's address begins with https:// (or http://) and names a host")
    if parts.username or parts.password:
        raise InputError("a webhook's address holds no password; put a token into a variable and name it in token_from")


class EmailHook(_Hook):
    """A mail to people."""

    host: str = Field(min_length=1, pattern=r"^[^\s/@]+$", description="the mail server")
    port: int = Field(default=587, ge=1, le=65535, description="its port")
    security: Literal["starttls", "tls", "none"] = Field(default="starttls", description="how the line is encrypted")
    sender: str = Field(description="the address that the mail comes from")
    to: tuple[str, ...] = Field(min_length=1, description="the addresses that it goes to")
    user: str = Field(default="", description="where the server asks for one")
    password_from: str = Field(
        default="", pattern=f"^$|{_VARIABLE}", description="environment variable of the password"
    )

    @field_validator("sender", "to")
    @classmethod
    def _addresses(cls, value: str | tuple[str, ...]) -> str | tuple[str, ...]:
        for address in (value,) if isinstance(value, str) else value:
            name, _, domain = address.rpartition("@")
            if not (
                name and domain and address.isascii() and address.isprintable() and not set(" ,;<>") & set(address)
            ):
                raise InputError("an e-mail address is name@domain, without a display name")
        return value

    @model_validator(mode="after")
    def _password_is_protected(self) -> "EmailHook":
        if bool(self.user) != bool(self.password_from):
            raise InputError("user and password_from belong together")
        if self.user and self.security == "none":
            raise InputError('a password is never sent in clear: say security = "starttls" or "tls"')
        return self


class Hooks(SettingsPart):
    """Who is told when verdicts "changed", when a run "failed", when the collection "shrunk", and when it was "shaken".

    Each may be repeated.  Secrets never stand here: url_from, token_from and password_from name variables KOUROS_... of
    the environment.
    """

    command: tuple[CommandHook, ...] = Field(
        default=(),
        description="a program that gets the event as JSON on its standard input, and is started without a shell",
        examples=[{"run": ["/usr/local/bin/tell-conservation", "--from=kouros"], "on": list(EVENTS)}],
    )
    webhook: tuple[WebhookHook, ...] = Field(
        default=(),
        description="an address that the event is sent to as JSON, by POST",
        examples=[{"url": "https://hooks.museum.example/kouros", "token_from": "KOUROS_WEBHOOK_TOKEN"}],
    )
    email: tuple[EmailHook, ...] = Field(
        default=(),
        description="a mail to people",
        examples=[
            {
                "host": "smtp.museum.example",
                "sender": "kouros@museum.example",
                "to": ["registrar@museum.example"],
                "user": "kouros",
                "password_from": "KOUROS_SMTP_PASSWORD",
            }
        ],
    )

    @property
    def variables(self) -> tuple[str, ...]:
        """The environment variables whose values are secrets."""
        named = [name for hook in self.webhook for name in (hook.url_from, hook.token_from)]
        return tuple(dict.fromkeys(filter(None, [*named, *(hook.password_from for hook in self.email)])))


class Logs(SettingsPart):
    """Where the log is kept, one JSON object a line."""

    file: str = Field(
        default="",
        description='a file, such as "logs/kouros.jsonl"; empty: none.  `kouros --log-json run` writes the same lines '
        "to standard error",
    )
    megabytes: float = Field(
        default=10.0, gt=0.0, le=1000.0, description="megabytes of one file, before the next is begun"
    )
    keep: int = Field(default=5, ge=1, le=1000, description="full files that are kept")


class Retention(SettingsPart):
    """What stays of earlier nights; 0 means all, nothing is removed unasked.  The last good ones always stay."""

    runs: int = Field(default=0, ge=0, description="how many runs stay in the database")
    reports: int = Field(default=0, ge=0, description="how many folders of reports stay")
    days: float = Field(default=0.0, ge=0.0, description="days after which runs and reports are removed")


class LimitSettings(SettingsPart):
    """How much of an input is accepted: a collection beyond these is refused whole."""

    megabytes: float = Field(default=1024.0, gt=0.0, le=102_400.0, description="megabytes of a file of the collection")
    rows: int = Field(default=5_000_000, ge=1, le=200_000_000, description="rows of the collection")
    seconds: float = Field(
        default=3600.0, gt=0.0, le=86_400.0, description="seconds that reading the collection may take"
    )


_HOST = re.compile(
    r"(?:\*\.(?=[^:]*\.))?(?:[^\W_](?:[\w-]*[^\W_])?)(?:\.[^\W_](?:[\w-]*[^\W_])?)*(?::\d{1,5})?|\[[0-9a-fA-F:]+\](?::\d{1,5})?"
)


class ImageSettings(SettingsPart):
    """Photographs of the objects: where they may be, and how much a night spends on them."""

    folder: str = Field(
        default="", description="the folder below which the files are that the records name; empty: files are not shown"
    )
    hosts: tuple[str, ...] = Field(
        default=(),
        max_length=100,
        description='the hosts that may be asked, such as "images.museum.org", "localhost:8182" or "*.museum.org" (a '
        "star allows no address of a private network); none: nothing is fetched",
    )
    pixels: int = Field(default=240, ge=64, le=1024, description="of the longer side of a thumbnail")
    megabytes: float = Field(default=30.0, gt=0.0, le=500.0, description="of a photograph at most")
    megapixels: float = Field(default=100.0, gt=0.0, le=1000.0, description="of a photograph at most")
    seconds: float = Field(default=10.0, gt=0.0, le=300.0, description="for one photograph at most")
    minutes: float = Field(
        default=30.0, gt=0.0, le=1440.0, description="for all new ones of a night; the others wait for the next one"
    )
    ask_again_days: float = Field(
        default=30.0, ge=0.0, le=3650.0, description="after which a host is asked whether a photograph has changed"
    )

    @field_validator("hosts")
    @classmethod
    def _hosts(cls, hosts: tuple[str, ...]) -> tuple[str, ...]:
        for host in hosts:
            if not _HOST.fullmatch(host):
                raise InputError(
                    f"{host!r} is no host: write its name alone, with its port where that is unusual, as "
                    "images.museum.org or localhost:8182"
                )
        return hosts


class SurveySettings(SettingsPart):
    """Workbooks of the survey that come back filled in."""

    inbox: str = Field(
        default="",
        description="a folder: what is put into it is taken up by the next night, as `kouros import --sheet` would; "
        "empty: none",
    )


LOCAL = frozenset({"127.0.0.1", "::1", "localhost"})
"""Hosts that this machine alone reaches."""


class ServeSettings(SettingsPart):
    """The desk, `kouros serve`: the report live, and what people say to it.  It needs the extra `serve`."""

    host: str = Field(
        default="127.0.0.1",
        pattern=r"^[A-Za-z0-9.:-]{1,255}$",
        description="the address it listens at; another than 127.0.0.1 needs an identity",
    )
    port: int = Field(default=8750, ge=0, le=65535, description="its port; 0: any that is free")
    identity: Literal["none", "header", "accounts"] = Field(
        default="none",
        description='who somebody is: "none", whoever sits at this machine; "header", whom your proxy names; '
        '"accounts", who signs in with a password of `kouros serve --add-user`',
    )
    header: str = Field(
        default="X-Remote-User", pattern=r"^[A-Za-z][A-Za-z0-9-]{0,63}$", description="the proxy's header with the name"
    )
    trusted: tuple[str, ...] = Field(
        default=(), description='addresses or networks of the proxies, "10.0.0.5"; nobody else is answered'
    )
    editors: tuple[str, ...] = Field(
        default=(),
        max_length=10_000,
        description="with a header: names of those who may write; the others read",
    )
    addresses: tuple[str, ...] = Field(
        default=(), description='how browsers reach it, "https://kouros.museum.example"; other names are refused'
    )
    session_hours: float = Field(default=12.0, gt=0.0, le=720.0, description="hours until one must sign in again")
    upload_megabytes: float = Field(default=15.0, gt=0.0, le=100.0, description="the largest photograph that is taken")

    @field_validator("trusted")
    @classmethod
    def _networks(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        for one in given:
            try:
                ip_network(one)
            except ValueError as problem:
                raise InputError(
                    f"{one!r} is no address and no network ({problem}); write 10.0.0.5 or 10.0.0.0/24"
                ) from problem
        return given

    @field_validator("addresses")
    @classmethod
    def _addresses(cls, given: tuple[str, ...]) -> tuple[str, ...]:
        for one in given:
            parts = urlsplit(one)
            plain = parts.scheme in ("http", "https") and parts.hostname and not (parts.username or parts.password)
            if not plain or parts.path not in ("", "/") or parts.query or parts.fragment:
                raise InputError(f"{one!r} is no address of a site; write https://kouros.museum.example")
        return tuple(one.rstrip("/") for one in given)

    @model_validator(mode="after")
    def _whole(self) -> "ServeSettings":
        if self.identity == "header" and not self.trusted:
            raise InputError('identity = "header" needs trusted: the addresses of the proxies that may name people')
        return self

    def require_safe(self) -> None:
        """Refuse to be reached from elsewhere where nobody knows who somebody is.

        Raises
        ------
        InputError
            Naming the setting and the remedy.
        """
        if self.host in LOCAL or (self.host.startswith("127.") and self.host.replace(".", "").isdigit()):
            return
        if self.identity == "none":
            raise InputError(
                f"[serve] host {self.host!r} would let anybody on the network decide in the museum's name: set "
                '[serve] identity to "accounts" (and make them with `kouros serve --add-user NAME --role editor`) or '
                'to "header" behind your proxy; or leave host at 127.0.0.1'
            )
        if not self.addresses:
            raise InputError(
                f"[serve] host is {self.host!r}, and [serve] addresses names no site: write how browsers reach it, "
                'such as addresses = ["https://kouros.museum.example"]'
            )
