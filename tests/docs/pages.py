"""The pages of the documentation, taken apart: their blocks of code, the words in code, and the links."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

PAGES = sorted(
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    + [page for page in DOCS.rglob("*.md") if "generated" not in page.parts and "build" not in page.parts]
)
"""All pages that a person wrote, the changelog apart: it tells of names that are no more."""

PROMISED: frozenset[str] = frozenset()
"""Names in the pages that the code does not have yet; each is taken out of here when it does."""

_FENCE = re.compile(
    r"^(?:<!-- (?P<note>[^\n]*) -->\n)?(?P<fence>```+)(?P<language>[^\n]*)\n(?P<text>.*?)^(?P=fence)$", re.M | re.S
)
_CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
_LINK = re.compile(r"\]\(([^)\s]+)\)")


@dataclass(frozen=True)
class Block:
    """A block of code: its language, its text, and what the comment before it says of it."""

    page: Path
    line: int
    language: str
    text: str
    note: str

    @property
    def place(self) -> str:
        """Where it stands, for a message."""
        return f"{self.page.relative_to(ROOT)}, line {self.line}"

    @property
    def lines(self) -> list[str]:
        """Its commands, one a line."""
        return [line for line in self.text.replace("\\\n", " ").splitlines() if line.strip()]


def blocks(page: Path) -> list[Block]:
    """Return the blocks of a page, in order; what is written for Sphinx, such as a table of contents, is none."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(page, text.count("\n", 0, found.start()) + 1, found["language"], found["text"], found["note"] or "")
        for found in _FENCE.finditer(text)
        if not found["language"].startswith("{")
    ]


def prose(page: Path) -> str:
    """Return a page without its blocks."""
    return _FENCE.sub("", page.read_text(encoding="utf-8"))


def codes(page: Path) -> list[str]:
    """Return what stands between grave accents in the prose of a page."""
    return _CODE.findall(prose(page))


def links(page: Path) -> list[str]:
    """Return where the links of a page lead to."""
    return _LINK.findall(prose(page))
