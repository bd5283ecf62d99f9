"""What a night remembers of the museum's source: which one the inventory is the state of, what became of its rows."""

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from pipeline.collection.blocks import Block
from pipeline.collection.inventory import latest_import
from pipeline.collection.mapping import Mapping, load_mapping, preset_names
from pipeline.collection.sources.opening import is_database
from pipeline.operations.workspace import Workspace
from pipeline.resources import code_version, replacing
from pipeline.settings import Settings


def mapping_of(settings: Settings, mapping: str) -> Mapping:
    """Return a mapping by the name of its preset, or from its file.

    raises : MappingError for a mapping that cannot be used
    """
    return load_mapping(mapping if mapping in preset_names() else settings.path(mapping))


def unchanged(workspace: Workspace, source: str, mapping: str) -> bool:
    """Say whether a file is the one that the inventory is the state of, byte for byte, and would be read alike.

    source : as in the settings; a database must be read to know
    raises : MappingError for a mapping that cannot be used
    """
    if is_database(source):
        return False
    try:
        with _file(workspace).open(encoding="utf-8") as lines:
            told, _ = json.loads(next(lines))
        return bool(told == _seen(workspace, source, mapping, _content(workspace, source)))
    except (OSError, ValueError, StopIteration):
        return False


def known_blocks(workspace: Workspace, source: str | Path, mapping: str) -> list[Block] | None:
    """Return what became of the rows of a source, if the inventory is their state, and they would be read alike.

    source : as it is opened: the URL of a database, or a file's path
    raises : MappingError for a mapping that cannot be used
    """
    try:
        with _file(workspace).open(encoding="utf-8") as lines:
            told, count = json.loads(next(lines))
            if told != _seen(workspace, str(source), mapping, told.get("sha256")):
                return None
            found = [Block.of_line(line) for line in lines]
        # All of them or none: what is gone is what is in none of them.
        return found if found and len(found) == count else None
    except (OSError, ValueError, TypeError, AttributeError, StopIteration):
        return None


def remember(workspace: Workspace, source: str, mapping: str, content: str, blocks: Sequence[Block]) -> None:
    """Note which source the inventory is the state of, and what became of its rows.

    source  : as in the settings
    content : digest of what was read of it
    blocks  : none where the inventory is not the state of its rows, because a person went back to an earlier one
    """
    file = _file(workspace)
    with suppress(OSError):
        # Without the note the next night reads the source, and that is all.
        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as aside, aside.open("w", encoding="utf-8") as stream:
            stream.write(json.dumps([_seen(workspace, source, mapping, content), len(blocks)]) + "\n")
            stream.writelines(block.line() + "\n" for block in blocks)


def _file(workspace: Workspace) -> Path:
    return workspace.settings.kept / "source.jsonl"


def _content(workspace: Workspace, source: str) -> str:
    with workspace.settings.path(source).open("rb") as binary:
        return hashlib.file_digest(binary, "sha256").hexdigest()


def _seen(workspace: Workspace, source: str, mapping: str, content: str) -> dict[str, Any]:
    # The address of a database may hold what is nobody's business.
    named = hashlib.sha256(source.encode()).hexdigest() if is_database(source) else str(workspace.settings.path(source))
    info = latest_import(workspace.engine)
    return {
        "source": named,
        "sha256": content,
        "mapping": hashlib.sha256(mapping_of(workspace.settings, mapping).model_dump_json().encode()).hexdigest(),
        "code": code_version(),
        "limits": workspace.settings.limits.model_dump_json(),
        "version": None if info is None else info.id,
    }


def rules_digest(settings: Settings) -> str:
    """Return a digest of the museum's own rules of classification; "" where it has none."""
    own = settings.collection.rules
    return hashlib.sha256(settings.path(own).read_bytes()).hexdigest()[:12] if own else ""
