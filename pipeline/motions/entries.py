"""Entries for a manifest of the record files that it does not name: what they say, and what they do not."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pipeline.motions.errors import MotionError
from pipeline.motions.manifest import load_manifest, manifest_file, unlisted
from pipeline.motions.reading import open_traces, own_unit

_BY_CODE: dict[str, float | str] = {"E": 90.0, "N": 0.0, "Z": "up"}
"""How a channel is oriented whose code ends so, by the convention of SEED."""


def entries(folder: str | Path) -> list[str]:
    """Return, for the record files of a site's folder that its manifest does not name, TOML to be pasted into it.

    One entry for each record: files of one station and instrument belong together.  What no file says stands there as a
    comment to be answered; a file that is no record is named with its hash alone.

    Parameters
    ----------
    folder : str or Path
        The site's folder, or its manifest.toml.

    Returns
    -------
    list of str
        The entries; first the level that they belong to, where the manifest has none, last what is no record.

    Raises
    ------
    MotionError
        For a folder without a manifest, or one that cannot be used.
    """
    file = manifest_file(folder)
    manifest = load_manifest(file, begun=True)
    records: dict[str, list[tuple[str, Any]]] = {}
    others: list[str] = []
    for name in unlisted(file, manifest):
        try:
            traces = open_traces(file.parent / name, [])
        except MotionError:
            others.append(f"# {json.dumps(name)} = {json.dumps(_digest(file.parent / name))}")
            continue
        for trace in traces:
            # A file of three components is a record; of one, the station and all but the direction tell which.
            of = name if len(traces) > 1 else trace.id[:-1] or name
            records.setdefault(of, []).append((name, trace))
    made = [_entry(file.parent, of, found) for of, found in records.items()]
    if made and not manifest.level:
        made.insert(0, '[[level]]\nname = "design"\ncombine = "max"')
    return (
        [*made, "\n".join(["# Files that cannot be read as records, such as a response, with their sha256:", *others])]
        if others
        else made
    )


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _entry(folder: Path, of: str, found: Sequence[tuple[str, Any]]) -> str:
    files = list(dict.fromkeys(name for name, _ in found))
    said = [trace.stats.get("kouros", {}) for _, trace in found]
    components = _components([trace for _, trace in found])
    processed = {one.get("processed") for one in said}
    lines = [
        "[[level.record]]",
        f"name = {json.dumps(of.strip('.') or files[0])}",
        f"files = {json.dumps(files)}",
        'source = "say whose record it is, and of which earthquake"',
        'licence = "say under which licence"',
    ]
    if processed == {None} or len(processed) != 1:
        lines.append(
            "# processed = false        # the files do not say: false for a raw record, true for a filtered one"
        )
    if not all(own_unit(trace.stats)[1] for _, trace in found):
        lines.append('# units = "m/s2"           # or the response of what holds counts: response = "station.xml"')
    if len(components) == 2 and not any('"z"' in line for line in components):
        lines.append('vertical = "absent"')
    elif len(components) != 3:
        lines.append(f'# it has {len(components)} channels; a record has x, y and z, or vertical = "absent"')
    lines += ["[level.record.components]", *components, "[level.record.sha256]"]
    return "\n".join(lines + [f"{json.dumps(name)} = {json.dumps(_digest(folder / name))}" for name in files])


def _components(traces: Sequence[Any]) -> list[str]:
    free = ["x", "y"]
    lines = []
    # East before north, as x before y.
    for trace in sorted(traces, key=lambda one: ("EN".find(one.stats.channel[-1:]) % 3, one.id)):
        code = trace.stats.channel or trace.id
        own = trace.stats.get("kouros", {}).get("orientation")
        meant = own if own is not None else _BY_CODE.get(code[-1:])
        told = "" if own is not None or meant is None else "  # by its code"
        if meant in {"up", "down"} or (meant is None and code[-1:].upper() in {"V", "3"}):
            axis = "z"
        else:
            axis = free.pop(0) if free else "?"
        oriented = f", orientation = {json.dumps(meant)}" if meant is not None else ""
        told = told or ("" if oriented else '  # add its orientation: degrees from north, or "up"')
        lines.append(f"{json.dumps(code)} = {{ axis = {json.dumps(axis)}{oriented} }}{told}")
    return lines
