"""The server of the desk: checked before it listens, and told where it is."""

import logging
import os
import socket
from collections.abc import Callable
from pathlib import Path

import uvicorn

from pipeline.desk.accounts import add_account
from pipeline.desk.app import desk_app
from pipeline.errors import InputError
from pipeline.operations.workspace import open_workspace
from pipeline.settings import Settings, load_settings
from pipeline.settings.operations import ServeSettings
from pipeline.store.desk import accounts, remove_account

PASSWORD_VARIABLE = "KOUROS_NEW_PASSWORD"  # noqa: S105 - the name of a variable
"""Environment variable with the password of a new account, where nobody sits at a terminal."""


def serve(config: Path, host: str | None, port: int | None, told: Callable[[str], None]) -> None:
    """Answer browsers until the process is stopped.

    Parameters
    ----------
    config : Path
        The settings' file.
    host, port
        In place of those of the settings.
    told : callable
        Is told the address, once browsers are answered there.

    Raises
    ------
    InputError
        Where it would not be safe, or cannot listen there.
    """
    server, listening, address = server_of(config, host, port)
    told(address)
    try:
        server.run(sockets=[listening])
    finally:
        listening.close()


def server_of(config: Path, host: str | None, port: int | None) -> tuple[uvicorn.Server, socket.socket, str]:
    """Return the server, the socket that it is to run on, which listens already, and its address.

    Raises
    ------
    InputError
        As `serve`.
    """
    settings = load_settings(config)
    asked = settings.serve.model_copy(
        update={name: value for name, value in (("host", host), ("port", port)) if value is not None}
    )
    asked = ServeSettings.model_validate(asked.model_dump())
    asked.require_safe()
    _require_somebody(settings, asked)
    app = desk_app(config, asked)
    listening = _listening(asked)
    shown = listening.getsockname()
    name = f"[{shown[0]}]" if ":" in shown[0] else shown[0]
    logging.getLogger("uvicorn.access").disabled = True
    # What a client says of another address it came by is not believed: whom to trust is for the guard.
    server = _DeskServer(
        uvicorn.Config(
            app, proxy_headers=False, server_header=False, log_level="warning", lifespan="off", access_log=False,
            timeout_keep_alive=15, timeout_graceful_shutdown=1, limit_concurrency=1_000,
            h11_max_incomplete_event_size=32_768,
        )
    )  # fmt: skip
    return server, listening, f"http://{name}:{shown[1]}/"


class _DeskServer(uvicorn.Server):
    """Closes the connections to the database when it ends."""

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End the answers that are under way, then the site."""
        await super().shutdown(sockets)
        self.config.app.close()  # type: ignore[union-attr]


def _require_somebody(settings: Settings, asked: ServeSettings) -> None:
    if asked.identity == "accounts" and not accounts(open_workspace(settings).engine):
        raise InputError("there is no account yet: make one with `kouros serve --add-user NAME --role editor`")


def _listening(asked: ServeSettings) -> socket.socket:
    try:
        family = socket.getaddrinfo(asked.host, asked.port, type=socket.SOCK_STREAM)[0]
        # Named, so that asyncio sends what is written at once: else each page on a connection that is kept waits 40 ms.
        listening = socket.socket(family[0], socket.SOCK_STREAM, socket.IPPROTO_TCP)
    except OSError as problem:
        raise InputError(f"[serve] host {asked.host!r} is no address of this machine ({problem})") from problem
    try:
        if os.name != "nt":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(family[4])
        listening.listen(512)
    except OSError as problem:
        listening.close()
        raise InputError(
            f"the desk cannot listen at {asked.host}:{asked.port} ({problem}): another may be there; name another by "
            "--port, or stop it"
        ) from problem
    return listening


def add_user(settings: Settings, name: str, role: str, password: str) -> None:
    """Make an account, or give it another role and password.

    Raises
    ------
    InputError
        For a name, a role or a password that cannot be.
    """
    add_account(open_workspace(settings).engine, name, role, password)


def remove_user(settings: Settings, name: str) -> None:
    """Remove an account; whoever is signed in by it is no more.

    Raises
    ------
    InputError
        Where there is none of that name.
    """
    engine = open_workspace(settings).engine
    if not remove_account(engine, name):
        known = ", ".join(one.name for one in accounts(engine)) or "none"
        raise InputError(f"there is no account {name!r}; those that there are: {known}")


def users(settings: Settings) -> list[tuple[str, str, str]]:
    """Return name, role and the day of making of every account."""
    return [(one.name, one.role, one.made[:10]) for one in accounts(open_workspace(settings).engine)]
