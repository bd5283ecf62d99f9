"""Accounts of the desk: passwords, sessions, and how often somebody may guess."""

import hashlib
import secrets
import time
from collections import OrderedDict
from dataclasses import dataclass, field
from datetime import UTC, datetime
from threading import Lock

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from pipeline.collection.database import Database
from pipeline.errors import InputError
from pipeline.store.desk import DeskAccount, account_named, begin_session, put_account, session_of

ROLES = ("reader", "editor")
SHORTEST, LONGEST = 12, 200
"""Characters of a password."""

NAME_LIMIT = 100

_HASHER = PasswordHasher()
_NOBODY = _HASHER.hash(secrets.token_urlsafe(16))
"""Compared with where there is no such account, so that the time of an answer tells nothing."""

_ONE_AT_A_TIME = Lock()
"""Argon2 takes 64 MB: those who sign in wait for each other."""


def add_account(engine: Database, name: str, role: str, password: str) -> DeskAccount:
    """Make an account, or give it another role and password.

    Raises
    ------
    InputError
        For a name, a role or a password that cannot be.
    """
    name = name.strip()
    if not name or len(name) > NAME_LIMIT or not name.isprintable():
        raise InputError(f"{name[:40]!r} is no name of an account; write up to {NAME_LIMIT} characters on one line")
    if role not in ROLES:
        raise InputError(f"there is no role {role!r}; use one of {', '.join(ROLES)}")
    if not SHORTEST <= len(password) <= LONGEST:
        raise InputError(
            f"a password has {SHORTEST} to {LONGEST} characters; four words that do not belong together do"
        )
    account = DeskAccount(name, role, _HASHER.hash(password), datetime.now(UTC).isoformat(timespec="seconds"))
    put_account(engine, account)
    return account


def signed_in(engine: Database, name: str, password: str, hours: float) -> str | None:
    """Begin a session where the password is that of the account.

    Returns
    -------
    str or None
        What the browser keeps; of it only a digest is stored.
    """
    account = account_named(engine, name.strip()) if len(name) <= NAME_LIMIT else None
    try:
        with _ONE_AT_A_TIME:
            _HASHER.verify(_NOBODY if account is None else account.secret, password[:LONGEST])
    except (Argon2Error, InvalidHashError):
        return None
    if account is None:
        return None
    token, now = secrets.token_urlsafe(32), int(time.time())
    begin_session(engine, digest(token), account.name, now=now, ends=now + round(3600.0 * hours))
    return token


def of_token(engine: Database, token: str) -> DeskAccount | None:
    """Return whose session it is; None for one that has ended or never was."""
    return session_of(engine, digest(token), int(time.time())) if token else None


def digest(token: str) -> str:
    """Return what is stored of a session's token."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()


@dataclass
class Attempts:
    """How often signing in failed, by who tried: after ``most`` within ``seconds`` nobody is heard for a while."""

    most: int = 5
    seconds: float = 300.0
    _failed: OrderedDict[str, list[float]] = field(default_factory=OrderedDict)
    _lock: Lock = field(default_factory=Lock)

    def wait(self, *whose: str) -> float:
        """Return the seconds until somebody may try again; 0 for now."""
        now = time.monotonic()
        with self._lock:
            return max((self._wait(one, now) for one in whose), default=0.0)

    def _wait(self, one: str, now: float) -> float:
        recent = [at for at in self._failed.get(one, ()) if now - at < self.seconds]
        return recent[-self.most] + self.seconds - now if len(recent) >= self.most else 0.0

    def failed(self, *whose: str) -> None:
        """Take down that it failed."""
        now = time.monotonic()
        with self._lock:
            for one in whose:
                recent = [at for at in self._failed.pop(one, ()) if now - at < self.seconds]
                self._failed[one] = [*recent[-self.most :], now]
            while len(self._failed) > 10_000:
                self._failed.popitem(last=False)

    def succeeded(self, *whose: str) -> None:
        """Forget who failed before."""
        with self._lock:
            for one in whose:
                self._failed.pop(one, None)
