"""State of the source behind the inventory, and whether it would be read alike now."""

import hashlib
from pathlib import Path

from pipeline.collection.inventory.source_rows import SourceKey, is_unchanged
from pipeline.collection.mapping import Mapping, load_mapping, preset_names
from pipeline.collection.sources.registry import is_address
from pipeline.operations.workspace import Workspace
from pipeline.resources import code_version
from pipeline.settings import Settings


def mapping_of(settings: Settings, mapping: str) -> Mapping:
    """Return a mapping by the name of its preset, or from its file.

    Raises
    ------
    MappingError
        For a mapping that cannot be used.
    """
    return load_mapping(mapping if mapping in preset_names() else settings.path(mapping))


def source_key(settings: Settings, source: str | Path, mapping: str) -> SourceKey:
    """Return what the meaning of a source's rows hangs on besides their cells.

    Parameters
    ----------
    settings : Settings
        Of the museum.
    source : str or Path
        As it is opened: an address, or a file's path.
    mapping : str
        Name of a preset, or a file.

    Returns
    -------
    SourceKey
        Without the address of a database, which may hold what is nobody's business.

    Raises
    ------
    MappingError
        For a mapping that cannot be used.
    """
    where = hashlib.sha256(str(source).encode()).hexdigest() if is_address(source) else str(Path(source).resolve())
    used = mapping_of(settings, mapping)
    return SourceKey(
        source=where,
        mapping=hashlib.sha256(f"{used.name}\0{used.model_dump_json()}".encode()).hexdigest(),
        code=code_version(),
        limits=settings.limits.model_dump_json(),
    )


def unchanged(workspace: Workspace, source: str, mapping: str) -> bool:
    """Say whether a file is the one that the inventory is the state of, byte for byte, and would be read alike.

    Parameters
    ----------
    source : str
        As in the settings; a database must be read to know.

    Returns
    -------
    bool

    Raises
    ------
    MappingError
        For a mapping that cannot be used.
    """
    if is_address(source):
        return False
    path = workspace.settings.path(source)
    try:
        with path.open("rb") as binary:
            content = hashlib.file_digest(binary, "sha256").hexdigest()
    except OSError:
        return False
    return is_unchanged(workspace.engine, source_key(workspace.settings, path, mapping), content)


def house_digest(settings: Settings) -> str:
    """Return a digest of the museum's house rules; "" where it has none."""
    told = repr([rule.plain() for rule in settings.house])
    return hashlib.sha256(told.encode("utf-8", "surrogatepass")).hexdigest()[:12] if settings.house else ""


def rules_digest(settings: Settings) -> str:
    """Return a digest of the museum's own rules of classification; "" where it has none."""
    own = settings.collection.rules
    return _file_digest(settings, own) if own else ""


def tables_digest(settings: Settings) -> dict[str, str]:
    """Return digests of the museum's own rows of what is assumed, by table; those that it has none of are left out."""
    return {name: _file_digest(settings, file) for name, file in settings.tables.model_dump().items() if file}


def _file_digest(settings: Settings, file: str) -> str:
    """Return a digest of a file of the museum's, with its name, which reports give as the origin of what is in it."""
    path = settings.path(file)
    return hashlib.sha256(path.name.encode("utf-8", "surrogateescape") + b"\0" + path.read_bytes()).hexdigest()[:12]
