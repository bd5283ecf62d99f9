"""The address of a museum's database: its secrets come from the environment, and go into no message."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from urllib.parse import quote, quote_plus, unquote

from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from pipeline.collection.errors import CollectionError

_NAME = re.compile(r"\$\{([A-Za-z_][A-Za-z0-9_]*)\}")
_SECRET_KEY = re.compile("pass|pwd|secret|token|key|credential|odbc_connect", re.I)
_SAID = re.compile(r"""(?i)\b(passw(?:or)?d|pwd|secret|token)(\s*[=:]\s*)('[^']*'|"[^"]*"|[^\s;&,]+)""")
_INSIDE = re.compile(r"(://[^:/@\s]*):[^@\s]*@")
_MESSAGE_LIMIT = 300

SHORT = 6
"""Letters below which a secret is looked for as a word of its own: "pi" is in "compiled" by chance."""

_BEFORE = r"(?:(?<![^\W_])|(?<=%[0-9A-Fa-f]{2})|(?<=\\[abfnrtv])|(?<=\\x[0-9a-f]{2})|(?<=\\u[0-9a-f]{4}))"
_AFTER = r"(?![^\W_])"
"""Where a word begins: behind no letter or digit, but for those of an escaped character (%3A, \\n, \\x1b, \\u2028)."""


@dataclass(frozen=True, slots=True, repr=False)
class Address:
    """Where a database is.

    Attributes
    ----------
    url : sqlalchemy.URL
        With its secrets, for opening it only.
    shown : str
        Without them, as it was written: the password is ***, ${NAME} stays, and what follows ? is left out.
    secrets : tuple of str
        Every form of them, the longest first, to be taken out of messages.
    """

    url: URL
    shown: str
    secrets: tuple[str, ...]

    def __repr__(self) -> str:
        return f"Address({self.shown!r})"

    def clean(self, message: object) -> str:
        """Return what a driver said as one line without any of the secrets."""
        return " ".join(hidden(str(message), self.secrets).split())[:_MESSAGE_LIMIT]


def hidden(text: str, secrets: Iterable[str] = ()) -> str:
    """Return a text without secrets.

    Parameters
    ----------
    text : str
        Any text.
    secrets : iterable of str
        What becomes ***, beside passwords in addresses and what is said to be a password.

    Returns
    -------
    str
        With *** in their place.
    """
    for secret in secrets:
        if len(secret) < SHORT:
            before = _BEFORE if secret[:1].isalnum() else ""
            after = _AFTER if secret[-1:].isalnum() else ""
            text = re.sub(f"{before}{re.escape(secret)}{after}", "***", text)
        else:
            text = text.replace(secret, "***")
    return _INSIDE.sub(r"\1:***@", _SAID.sub(r"\1\2***", text))


def expand_secrets(url: str, environment: Mapping[str, str] | None = None) -> Address:
    """Put the values of the environment where a database's address says ${NAME}.

    ${NAME} may stand for a user, a password, a host, a database, a value after the question mark, or for the whole
    address. A value is taken literally: it needs no percent signs.

    Parameters
    ----------
    url : str
        The address, with ${NAME} for secrets.
    environment : mapping of str to str, or None
        Of this process, unless given.

    Returns
    -------
    Address
        With and without its secrets.

    Raises
    ------
    CollectionError
        For a name that the environment lacks, or for what is no address; no value is shown.
    """
    known = os.environ if environment is None else environment
    values: list[str] = []

    def expand(text: str) -> str:
        def value(match: re.Match[str]) -> str:
            if match[1] not in known:
                raise CollectionError(
                    f"the database's address names ${{{match[1]}}}, which the environment lacks; set it where "
                    "Kouros is started"
                )
            values.append(known[match[1]])
            return known[match[1]]

        return _NAME.sub(value, text)

    whole = _NAME.fullmatch(url.strip())
    try:
        written = make_url(expand(url.strip())) if whole else make_url(url)
        opened = written if whole else _each(written, expand)
    except (ArgumentError, ValueError) as problem:
        if isinstance(problem, CollectionError):
            raise
        raise CollectionError(
            "the database's address cannot be read; write it as kind://user:${PASSWORD}@host/database"
        ) from None
    if not whole and "${" in _NAME.sub("", url):
        raise CollectionError(
            "the database's address has a ${ that is no ${NAME}; use letters, digits and _ for the name"
        )
    shown = whole[0] if whole else _shown(written)
    return Address(opened, shown, forms(_secret_values(values, opened)))


def _each(url: URL, expand: Callable[[str], str]) -> URL:
    query = {
        key: expand(value) if isinstance(value, str) else tuple(map(expand, value)) for key, value in url.query.items()
    }
    return url.set(
        username=expand(url.username) if url.username else url.username,
        password=expand(str(url.password)) if url.password else url.password,
        host=expand(url.host) if url.host else url.host,
        database=expand(url.database) if url.database else url.database,
        query=query,
    )


def _shown(url: URL) -> str:
    return unquote(url.set(query={}).render_as_string(hide_password=True))


def _secret_values(values: list[str], url: URL) -> Iterator[str]:
    yield from (*values, str(url.password or ""))
    for key, value in url.query.items():
        if _SECRET_KEY.search(key):
            yield from (value,) if isinstance(value, str) else value


def forms(secrets: Iterable[str]) -> tuple[str, ...]:
    """Return every form in which secrets may come back in a message, the longest first."""
    found = {form for s in secrets for form in (s, quote(s, safe=""), quote_plus(s), repr(s)[1:-1]) if form}
    return tuple(sorted(found, key=lambda form: (-len(form), form)))
