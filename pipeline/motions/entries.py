"""Entries for a manifest of the record files that it does not name: what they say, and what they do not."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pipeline.motions.earthquakes import earthquakes, listed
from pipeline.motions.errors import MotionError
from pipeline.motions.grouping import channels, grouped
from pipeline.motions.manifest import load_manifest, manifest_file, unlisted
from pipeline.motions.parts import whole
from pipeline.motions.reading import open_traces, own_unit


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
    found: list[tuple[str, list[Any]]] = []
    others: list[str] = []
    for name in unlisted(file, manifest):
        try:
            found.append((name, open_traces(file.parent / name, [])))
        except MotionError:
            others.append(f"# {json.dumps(name)} = {json.dumps(_digest(file.parent / name))}")
    made = [_entry(file.parent, of, traces) for of, traces in grouped(found)]
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
    # A channel that is interrupted, or holds several earthquakes, comes in pieces.
    components = _components(list({trace.id: trace for _, trace in reversed(found)}.values()))
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
    lines += _earthquakes(folder, found)
    lines += ["[level.record.components]", *components, "[level.record.sha256]"]
    return "\n".join(lines + [f"{json.dumps(name)} = {json.dumps(_digest(folder / name))}" for name in files])


def _earthquakes(folder: Path, found: Sequence[tuple[str, Any]]) -> list[str]:
    """A comment for each earthquake of several that the first channel holds, one of which is to be chosen."""
    name, first = found[0]
    pieces = sorted((whole(folder / name, t) for _, t in found if t.id == first.id), key=lambda one: one.start.ns)
    events = earthquakes(pieces)
    if len(events) < 2:
        return []
    told = [f'# origin_time = "{str(one.begins)[:19]}Z"  # {listed([one], own_unit(first.stats)[1])}' for one in events]
    return [f"# it holds {len(events)} earthquakes: choose one, or a part by window_s", *told]


def _components(traces: Sequence[Any]) -> list[str]:
    lines = []
    for one in channels(traces):
        oriented = "" if one.orientation is None else f", orientation = {json.dumps(one.orientation)}"
        told = "" if oriented else '  # add its orientation: degrees from north, or "up"'
        told = "  # by its code" if one.by_code else told
        lines.append(f"{json.dumps(one.code)} = {{ axis = {json.dumps(one.axis)}{oriented} }}{told}")
    return lines
