"""The settings of the desk: where it listens, and who it takes somebody for."""

from ipaddress import ip_network
from typing import Literal
from urllib.parse import urlsplit

from pydantic import Field, field_validator, model_validator

from pipeline.errors import InputError
from pipeline.settings.operations import SettingsPart

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
