"""The blocks of a page, run in order in a folder, as a reader would."""

from __future__ import annotations

import os
import shlex
import shutil
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import tomlkit
from click.testing import CliRunner

from pipeline.cli import kouros
from pipeline.collection.mapping import Mapping as ColumnMapping
from pipeline.motions.manifest import Manifest
from pipeline.resources import resource
from pipeline.settings import Settings
from tests.docs.pages import PROMISED, Block

NOT_RUN = frozenset(
    {
        "CI runs it",
        "it asks for a password",
        "it changes the machine's own services",
        "it goes on until it is stopped",
        "it is the proxy's",
        "it needs a Dask cluster",
        "it needs a PostgreSQL server",
        "it needs a copy of the source",
        "it needs a museum's own file",
        "it needs a museum's server",
        "it needs a second experiment",
        "it needs a translation",
        "it needs podman or docker",
        "it serves until it is stopped",
        "it takes minutes",
        "no record of the example is refused",
        "pip fetches its motions first",
        "somebody fills it in first",
        "the reader's export comes first",
    }
)
"""Why a block may not be run; each is the reason of at least one."""

GROUPS = ("kouros.models", "kouros.measures", "kouros.sources", "kouros.pages")
"""Of entry points by which another package brings parts."""

_SHAKEN = "window_s = [20.0, 120.0]"
_SHORT = 'window_s = [30.0, 44.0]\naccept = { cut_off = "a test needs the strong part alone" }'


def short_site(folder: Path) -> Path:
    """Copy the bundled site, with its strong part alone: charts of it take a tenth of the time."""
    site = Path(shutil.copytree(resource("site_motions", "demo"), folder / "site_motions" / "demo"))
    text = (site / "manifest.toml").read_text(encoding="utf-8")
    assert _SHAKEN in text
    (site / "manifest.toml").write_text(text.replace(_SHAKEN, _SHORT), encoding="utf-8")
    return site


def use_site(patch: pytest.MonkeyPatch, site: Path) -> None:
    """Let the name `demo` stand for another site."""
    patch.setattr("pipeline.operations.workspace.resource", lambda *_parts: site)


class Reader:
    """Who reads a page in a folder: does what its blocks say, and remembers what was printed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.printed = ""
        self.names: dict[str, Any] = {}

    def do(self, block: Block) -> None:
        """Run a block, or write the file that it says it is."""
        os.chdir(self.folder)
        if block.note.startswith("not run: "):
            assert block.note.removeprefix("not run: ") in NOT_RUN, f"{block.place}: no known reason not to run it"
        elif block.language == "sh":
            assert not block.note, f"{block.place}: what is {block.note!r}?"
            self.printed = "".join(self._command(line, block.place) for line in block.lines)
        elif block.language == "python":
            exec(compile(block.text, block.place, "exec"), self.names)  # noqa: S102 - our own pages
        elif block.language == "text":
            assert block.note == "output", f"{block.place}: a text is the output of the block before it"
            for line in block.text.splitlines():
                assert line.strip() in self.printed, f"{block.place}: {line.strip()!r} is not in\n{self.printed}"
        else:
            assert block.note.startswith("file: "), f"{block.place}: it does not say which file it is"
            self._file(block, *block.note.removeprefix("file: ").partition(", ")[::2])

    def _command(self, line: str, place: str) -> str:
        words = shlex.split(line, comments=True)
        if words[:1] == ["cd"]:
            self.folder = self.folder / words[1]
            os.chdir(self.folder)
            return ""
        if PROMISED & set(words):
            return ""
        assert words[:1] == ["kouros"], f"{place}: no command of Kouros: {line}"
        done = CliRunner().invoke(kouros, words[1:])
        assert done.exit_code == 0, f"{place}: {line}\n{done.output}\n{done.exception!r}"
        return done.output

    def _file(self, block: Block, name: str, how: str) -> None:
        """Write a file, or lay keys over one that is there; settings, mappings and manifests must be good ones."""
        path = Path(name)
        if block.language in {"csv", "obj"}:
            path.write_text(block.text, encoding="utf-8")
            return
        data = tomllib.loads(block.text)
        if how == "a mapping":
            ColumnMapping.model_validate(data)
        elif how == "a part":
            whole = {"site": {"name": "S", "latitude": 0.0, "longitude": 0.0}, **data}
            Manifest.model_validate(whole, strict=False)
        elif name == "pyproject.toml of another package":
            assert set(data["project"]["entry-points"]) == set(GROUPS)
        else:
            if path.name == "kouros.toml":
                Settings(**data)
            if how == "merged":
                document = tomlkit.parse(path.read_text(encoding="utf-8"))
                _merge(document, data)
                path.write_text(tomlkit.dumps(document), encoding="utf-8")
            elif path.name != "kouros.toml":
                path.write_text(block.text, encoding="utf-8")


def _merge(document: Any, data: Mapping[str, Any]) -> None:
    for key, value in data.items():
        if isinstance(value, dict) and key in document:
            _merge(document[key], value)
        else:
            document[key] = value
