"""Objects as YAML: a list of them, one a document, or a file each, as catalogues and static sites keep them.

It is read event by event: no object of Python is made, a name that stands twice keeps both texts, and what refers to
another place (an alias) is refused, for a few of these can grow beyond any memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, Literal

import yaml
from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import SourceSettings
from pipeline.collection.sources.delimited import RECORD_LIMIT
from pipeline.collection.sources.folders import files_in
from pipeline.collection.sources.json_objects import Json, JsonSettings

FILES = ("*.yml", "*.yaml")
"""What counts in a folder."""

_ENDINGS = frozenset({".yml", ".yaml"})
_DEEPEST = 60
_NOTHING = frozenset({"", "~", "null", "Null", "NULL"})
_LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)


class YamlSettings(JsonSettings):
    """How YAML is read; its keys are those of plain JSON."""

    format: Literal["yaml"] = Field(description="The kind of source.")  # type: ignore[assignment]


class Yaml(Json):
    """A YAML file of objects, or a folder of such files."""

    name = "yaml"
    title = "a YAML file"
    Settings: ClassVar[type[SourceSettings]] = YamlSettings
    patterns = FILES

    def recognises(self, where: str, head: bytes) -> bool:
        """Say whether its name ends as those of YAML do and it begins with names or a list; of a folder likewise."""
        path = Path(where)
        if "://" in where:
            return False
        if path.is_dir():
            return bool(files_in(path, FILES, deep=True))
        return path.suffix.casefold() in _ENDINGS and b"\0" not in head

    def values_of(self, binary: BinaryIO, file: str) -> Iterator[tuple[int, Any]]:
        """Yield the values of a file, those of a list one by one, with the line where each begins."""
        return read_yaml(binary, file)


def read_yaml(stream: BinaryIO, file: str) -> Iterator[tuple[int, Any]]:
    """Yield the values of a file with the line where each begins; those of a list, or of documents, one by one.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : str
        Its name in messages.

    Yields
    ------
    (int, object)
        The line, from 1, and the value: dicts, lists, texts as written, and None.

    Raises
    ------
    CollectionError
        For what is no YAML, for an alias, for what is nested too deeply or larger than RECORD_LIMIT.
    """
    reader = _Events(stream, file)
    for event in reader.events:
        if isinstance(event, yaml.DocumentStartEvent):
            first = next(reader.events)
            if isinstance(first, yaml.SequenceStartEvent):
                while not isinstance(event := next(reader.events), yaml.SequenceEndEvent):
                    yield reader.begun(event), reader.value(event, 1)
            elif (value := reader.value(first, 0)) is not None:
                yield reader.begun(first), value


class _Events:
    def __init__(self, stream: BinaryIO, file: str) -> None:
        self._file = file
        self._size = 0
        self.events = self._read(stream)

    def _read(self, stream: BinaryIO) -> Iterator[Any]:
        at = 0
        try:
            for event in yaml.parse(stream, Loader=_LOADER):
                at = event.start_mark.line + 1
                if isinstance(event, yaml.AliasEvent):
                    raise CollectionError(
                        f"{self._file}, line {at}: *{event.anchor[:40]} stands for what another place says; write that "
                        "out, and import again"
                    )
                yield event
        except yaml.YAMLError as problem:
            mark = getattr(problem, "problem_mark", None)
            line = mark.line + 1 if mark is not None else at
            why = " ".join(str(getattr(problem, "problem", None) or problem).split())[:200]
            raise CollectionError(
                f"{self._file}, line {line}: no YAML: {why}; mend that line, or export it as CSV"
            ) from problem
        except (OSError, UnicodeDecodeError, ValueError) as problem:
            raise CollectionError(
                f"{self._file}, near line {at}: reading stopped: {problem}; see whether the disk is there, and save "
                "the file as UTF-8"
            ) from problem

    def begun(self, event: Any) -> int:
        """Return the line of an event; the size of a value is counted from there on."""
        self._size = 0
        return int(event.start_mark.line) + 1

    def value(self, event: Any, depth: int) -> Any:
        """Return the value that begins with an event."""
        if depth > _DEEPEST:
            raise CollectionError(f"{self._file}, line {event.start_mark.line + 1}: nested more than {_DEEPEST} deep")
        if isinstance(event, yaml.ScalarEvent):
            self._size += len(event.value)
            if self._size > RECORD_LIMIT:
                raise CollectionError(
                    f"{self._file}, line {event.start_mark.line + 1}: a record of more than {RECORD_LIMIT:,} characters"
                )
            return None if event.style in (None, "") and event.implicit[0] and event.value in _NOTHING else event.value
        if isinstance(event, yaml.SequenceStartEvent):
            items = []
            while not isinstance(one := next(self.events), yaml.SequenceEndEvent):
                items.append(self.value(one, depth + 1))
            return items
        out: dict[str, Any] = {}
        while not isinstance(one := next(self.events), yaml.MappingEndEvent):
            key = self.value(one, depth + 1)
            found = self.value(next(self.events), depth + 1)
            # Programs in Ruby write their names so: ":title".
            name = key.removeprefix(":") if isinstance(key, str) else str(key)
            out[name] = [out[name], found] if name in out else found
        return out
