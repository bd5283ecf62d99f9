"""A request as pages take it, and an answer as they give it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlencode

from pipeline.desk.guard import Person
from pipeline.desk.site import DeskSite


@dataclass(frozen=True)
class Asked:
    """What a browser asked for.

    Attributes
    ----------
    site : DeskSite
        Of the desk.
    who : Person
        Who asks.
    query, form : mapping of str to str
        Of the address, and of the form that was sent.
    lists : mapping of str to tuple of str
        All values of each name of the form.
    upload : bytes
        The photograph that was sent; empty for none.
    fragment : bool
        Whether only a part of the page is wanted (htmx).
    newest : tuple of int or None
        The newest ids of what people said when it was asked; None where nobody looked.
    """

    site: DeskSite
    who: Person
    query: Mapping[str, str]
    form: Mapping[str, str] = field(default_factory=dict)
    lists: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    upload: bytes = b""
    fragment: bool = False
    newest: tuple[int, ...] | None = None

    @property
    def name(self) -> str:
        """Who is to stand in the log: whoever is known, else who the form says it is."""
        return self.who.name if self.who.known else (self.form.get("who", "").strip() or self.who.name)


@dataclass(frozen=True)
class DeskAnswer:
    """A page: a template of the desk with what it shows; or, with ``to``, another address to go to."""

    template: str = ""
    context: Mapping[str, Any] = field(default_factory=dict)
    status: int = 200
    to: str = ""


def address(path: str, **query: str) -> str:
    """Return an address of the desk; it never leads elsewhere."""
    told = {name.rstrip("_"): value for name, value in query.items() if value}
    return path + (f"?{urlencode(told)}" if told else "")


def page_number(query: Mapping[str, str]) -> int:
    """Return which page of a list is asked for; the first where that is no number."""
    text = query.get("page", "1")
    return int(text) if text.isdecimal() and len(text) < 7 and int(text) > 0 else 1
