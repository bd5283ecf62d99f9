"""Reference pages made from code, each time the pages are built: what they say cannot disagree with it."""

import csv
import importlib
import inspect
import json
import pkgutil
import pydoc
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

from docs.table_words import COLUMN_WORDS, TABLE_WORDS
from pipeline.cli import kouros
from pipeline.collection.mapping import MAPPABLE, PRESETS
from pipeline.errors import KourosError
from pipeline.models import MODELS
from pipeline.quantities import Quantity
from pipeline.records import Model
from pipeline.report.files.exports import FINDING_COLUMNS, OBJECT_COLUMNS, RECOMMENDATION_COLUMNS
from pipeline.report.files.plan_files import PLAN_COLUMNS
from pipeline.report.pages.class_curves import COLUMNS as CLASS_COLUMNS
from pipeline.report.pages.class_curves import FILE as CLASS_CURVES
from pipeline.report.pages.class_curves import GRID
from pipeline.report.pages.reading import COLUMNS as READING_COLUMNS
from pipeline.resources import resource
from pipeline.settings import Settings
from pipeline.supports import SUPPORTS
from pipeline.tables import FOLDER as TABLES

ROOT = Path(__file__).resolve().parents[1]

Schema = Mapping[str, Any]


def write(folder: Path) -> None:
    """Write all pages into a folder; one that has not changed keeps its date, so that nothing is built twice."""
    folder.mkdir(parents=True, exist_ok=True)
    made = {folder / f"{name}.md": text for name, text in pages().items()}
    for stray in set(folder.glob("*.md")) - set(made):
        stray.unlink()
    for file, text in made.items():
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """Return the text of every generated page, by its name."""
    makers: tuple[Callable[[], str], ...] = (
        cli, settings, manifest, experiment, mapping, records, exports, decisions, events, models, supports, tables,
        exit_codes, contracts,
    )  # fmt: skip
    return {maker.__name__.replace("_", "-"): maker().strip() + "\n" for maker in makers}


def _agree(holds: bool, otherwise: str) -> None:
    """Stop the build where the words here and the code do not agree."""
    if not holds:
        raise RuntimeError(otherwise)


# The command ----------------------------------------------------------------------------------------------------------


def verbs(group: click.Group = kouros, path: tuple[str, ...] = ()) -> Iterable[tuple[str, click.Command]]:
    """Yield every verb with its words after `kouros`, those of a group one by one."""
    for name, command in sorted(group.commands.items()):
        if isinstance(command, click.Group):
            yield from verbs(command, (*path, name))
        else:
            yield " ".join((*path, name)), command


def cli() -> str:
    """Return what --help says of the command and of every verb."""
    context = click.Context(kouros, info_name="kouros", terminal_width=88)
    said = [f"# Command line\n\nWhat `--help` says.\n\n## kouros\n\n{_block(kouros.get_help(context))}"]
    for words, command in verbs():
        inside = click.Context(command, info_name=f"kouros {words}", terminal_width=88)
        said.append(f"## kouros {words}\n\n{_block(command.get_help(inside))}")
    return "\n\n".join(said)


def exit_codes() -> str:
    """Return what each exit code means, and the errors that end with it."""
    import pipeline.cli

    for module in pkgutil.walk_packages(pipeline.__path__, "pipeline."):
        if "_resources" not in module.name:
            importlib.import_module(module.name)
    errors: dict[int, list[str]] = {}
    for error in _below(KourosError):
        errors.setdefault(error.exit_code, []).append(f"`{error.__name__}`")
    help_text = " ".join((kouros.help or "").split())
    said = re.findall(r"Exit codes: (.*?)\. ", help_text)[0]
    rows = []
    for part in said.split("; "):
        codes, meaning = re.fullmatch(r"([\d and]+?) (?!and)(\D.*)", part).groups()  # type: ignore[union-attr]
        numbers = [int(code) for code in re.findall(r"\d+", codes)]
        rows.append((codes, meaning, ", ".join(sorted(name for n in numbers for name in errors.pop(n, [])))))
    _agree(not errors, f"the command's help does not say what these exit codes mean: {errors}")
    return "# Exit codes\n\n" + markdown_table(("Code", "Meaning", "Errors"), rows)


def _below(error: type[KourosError]) -> Iterable[type[KourosError]]:
    for one in error.__subclasses__():
        yield one
        yield from _below(one)


# Settings and contracts -----------------------------------------------------------------------------------------------


def settings() -> str:
    """Return every key of kouros.toml, from the models that read it."""
    schema = Settings.model_json_schema()
    intro = (
        "# kouros.toml\n\nPaths are relative to the file. Unknown keys are errors. Secrets come from the environment:"
        " `KOUROS_DATABASE` takes the place of `[inventory] database`. `kouros init` writes the file with comments."
    )
    parts = [intro]
    for name, field in schema["properties"].items():
        if name == "demonstration":
            continue
        part = _resolved(field, schema)
        if part.get("type") == "array":
            table = _resolved(part["items"], schema)
            parts.append(f"## `[[{name}]]`\n\n{plain(part['description'])}\n\n{_keys(table, schema)}")
            continue
        parts.append(f"## `[{name}]`\n\n{plain(part.get('description', ''))}")
        parts += [_keys(part, schema, skip={"command", "webhook", "email"} if name == "hooks" else set())]
        if name == "hooks":
            for hook in ("command", "webhook", "email"):
                table = _resolved(part["properties"][hook]["items"], schema)
                parts.append(f"### `[[hooks.{hook}]]`\n\n{plain(table['description'])}\n\n{_keys(table, schema)}")
    return "\n\n".join(part for part in parts if part)


def manifest() -> str:
    """Return every key of a site's manifest, and the formats of records."""
    schema = _schema("site-manifest")
    places = {
        "SiteTable": "[site]", "LevelTable": "[[level]]", "TargetTable": "[level.target]", "Record": "[[level.record]]",
        "Horizontal": "[level.record.components], horizontal", "Vertical": "[level.record.components], vertical",
        "BaselineTable": "[level.record.baseline]", "EventTable": "[level.record.event]",
        "StationTable": "[level.record.station]", "FloorTable": "[[floor]]", "FloorRecord": "[[floor.record]]",
    }  # fmt: skip
    parts = ["# The site's manifest\n\n`manifest.toml` in the site's folder, beside the files of the records."]
    for name, place in places.items():
        table = schema["$defs"][name]
        parts.append(f"## `{place}`\n\n{_opening(table)}\n\n{_keys(table, schema)}")
    _agree(set(places) == set(schema["$defs"]), "a table of the manifest has no place here")
    formats = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    rows = [
        (f"`{name}`", _opening({"description": inspect.getdoc(importlib.import_module(module)) or ""}))
        for name, module in sorted(formats["obspy.plugin.waveform"].items())
    ]
    said = "Whatever obspy reads, and these, which Kouros adds to obspy as plugins:"
    return "\n\n".join(
        [*parts, f"## Formats of records\n\n{said}\n\n{markdown_table(('Format', 'What it reads'), rows)}"]
    )


def experiment() -> str:
    """Return every key of an experiment."""
    schema = _schema("experiment")
    places = {"BodyTable": "[[body]]", "PredictionTable": "[[prediction]]"}
    _agree(set(places) == set(schema["$defs"]), "a table of the experiment has no place here")
    keys = _keys(schema, schema, ("body", "prediction"))
    parts = [f"# Experiments\n\n`experiment.toml` in the folder that `kouros validate` is given.\n\n{keys}"]
    for name, place in places.items():
        table = schema["$defs"][name]
        parts.append(f"## `{place}`\n\n{_opening(table)}\n\n{_keys(table, schema)}")
    return "\n\n".join(parts)


def mapping() -> str:
    """Return every key of a mapping, and the mappings that come with Kouros."""
    schema = _schema("mapping")
    parts = ["# Mappings\n\nA TOML file that says which column of the museum's source is which field of the record."]
    for name, field in schema["properties"].items():
        # Of the columns each is a table of its own; what may be left out is a table or nothing.
        one = next((kind for kind in field.get("anyOf", ()) if "$ref" in kind), field)
        table = _resolved(field["additionalProperties"] if name == "columns" else one, schema)
        place = "[columns.FIELD]" if name == "columns" else f"[{name}]"
        parts.append(f"## `{place}`\n\n{plain(table['description'])}\n\n{_keys(table, schema)}")
        for kind in table.get("oneOf", ()):
            own = _resolved(kind, schema)
            if "properties" in own and "description" in own:
                said = plain(own["description"].partition("\n")[0])
                parts.append(f"### `{place}`: {said}\n\n{_keys(own, schema)}")
        for key, inner in _inner(table, schema).items():
            parts.append(f"### `[{name}.{key}]`\n\n{plain(inner['description'])}\n\n{_keys(inner, schema)}")
    parts.append("### Fields that may be mapped\n\n" + ", ".join(f"`{name}`" for name in MAPPABLE))
    rows = []
    for preset in sorted(PRESETS.glob("*.toml")):
        said = re.match(r"(?:# ?.*\n)+", preset.read_text(encoding="utf-8"))
        rows.append((f"`{preset.stem}`", " ".join(said[0].replace("#", "").split()) if said else ""))
    return "\n\n".join([*parts, "## Presets\n\n" + markdown_table(("Preset", "For"), rows)])


def _inner(table: Schema, schema: Schema) -> dict[str, Schema]:
    """Return the tables within any kind of a table, by their keys."""
    found = {}
    for kind in table.get("oneOf", ()):
        for key, field in _resolved(kind, schema).get("properties", {}).items():
            told = next((one for one in (field, *field.get("anyOf", ())) if "$ref" in one), None)
            inner = {} if told is None else _resolved(told, schema)
            if inner.get("type") == "object":
                found[key] = inner
    return found


def records() -> str:
    """Return the fields of an object record."""
    schema = _schema("item")
    return f"# The object record\n\n{plain(schema['description'])}\n\n{_keys(schema, schema)}"


def exports() -> str:
    """Return the columns of the files beside a report."""
    described = _schema("finding")["properties"]
    tables = {"findings": FINDING_COLUMNS, "recommendations": RECOMMENDATION_COLUMNS, "objects": OBJECT_COLUMNS}
    intro = (
        "# Exports\n\nThe same results lie beside the pages of a report: `findings`, `recommendations` and `objects`"
        " as CSV and Parquet, findings and objects as JSON Lines too, and all of them as a workbook where there are not"
        " too many. Numbers are in SI units. An unknown number is an empty cell, and an endless one is `inf`. In CSV a"
        " text that begins as a formula has an apostrophe in front."
    )
    parts, used = [intro], set()
    for name, columns in {**tables, "plan": PLAN_COLUMNS, "reading": READING_COLUMNS}.items():
        own = described if name == "findings" else {}
        used |= set(columns) - set(own)
        rows = [(f"`{c}`", plain(own[c]["description"] if c in own else COLUMN_WORDS[c])) for c in columns]
        parts.append(f"## {name}\n\n{markdown_table(('Column', 'Meaning'), rows)}")
    _agree(used == set(COLUMN_WORDS), "a column is described that is not there")
    parts.append(
        f"## {Path(CLASS_CURVES).stem}\n\nThe mean fragility of all objects on display (empty `object_class`) and of"
        " each class, fitted by a lognormal: how many objects, how many of these have a curve of their own, the median"
        " in g and whether it is only a bound (`median_is`), the dispersion, by how much mean and lognormal differ at"
        " most, of how many objects it is known how often they come to harm, how many of these are expected to within"
        f" 50 years, and the mean probability of harm at {len(GRID)} peak accelerations, empty where that is not known"
        f" of all: {', '.join(f'`{name}`' for name in CLASS_COLUMNS)}."
    )
    return "\n\n".join(parts)


def decisions() -> str:
    """Return the fields of a decision."""
    schema = _schema("decision")
    return f"# Decisions\n\nAs `kouros decide --list --json` prints them.\n\n{_keys(schema, schema)}"


def events() -> str:
    """Return the documents that programs read: summary, status, event."""
    parts = ["# Summary, status, events\n\nDocuments in JSON; each has its JSON Schema in the folder `schemas`."]
    for name, title in {"run-summary": "summary.json", "status": "status.json", "event": "What a hook is told"}.items():
        schema = _schema(name)
        parts.append(f"## {title}\n\n{plain(schema['description'])}\n\n{_keys(schema, schema)}")
    return "\n\n".join(parts)


# Models and tables ----------------------------------------------------------------------------------------------------


def models() -> str:
    """Return every generic model with its equation."""
    intro = "# Models\n\nWhat `kouros models` lists. Quantities are in SI units."
    return "\n\n".join([intro, *(_model(model) for model in MODELS)])


def _model(model: Model) -> str:
    demand = f"`{model.demand}` against "
    demand += f"`{model.capacity}`" if isinstance(model.capacity, str) else f"{model.capacity:g}"
    offered = [("bound", model.bound), ("chart", model.chart), ("screen", model.screen)]
    facts = [
        f"**Name** `{model.name}` ({model.kind})",
        f"**Source** {plain(model.source)}",
        f"**Demand and capacity** {demand}",
        "**Fidelities** " + ", ".join([*(name for name, has in offered if has), "history", "reference"]),
    ]
    parts = [f"## {model.title}", _block(model.equation), "\\\n".join(facts)]
    return "\n\n".join([*parts, _quantities(model.needs, needed=True), _quantities(model.gives, needed=False)])


def supports() -> str:
    """Return what a motion may pass on its way to an object."""
    parts = ["# Supports\n\nWhat `--through` of `kouros respond` and `transmit` of the Python API take."]
    parts += [f"## `{one.name}`\n\n{_quantities(one.needs, needed=True)}" for one in SUPPORTS]
    return "\n\n".join(parts)


def _quantities(quantities: Iterable[Quantity], *, needed: bool) -> str:
    if not needed:
        rows = [(f"`{q.name}`", q.unit, plain(q.meaning)) for q in quantities]
        return markdown_table(("Gives", "Unit", "Meaning"), rows)
    said = []
    for q in quantities:
        needs = "yes" if not q.optional else "no" if q.default is None else f"no, {q.default:g}"
        said.append((f"`{q.name}`", q.unit, needs, plain(q.allowed()), plain(q.meaning)))
    return markdown_table(("Needs", "Unit", "Required", "Allowed", "Meaning"), said)


CONTRACTS = {
    "A generic model": "pipeline.records.Model",
    "A measure": "pipeline.mitigate.measures.base.Measure",
    "A source of collections": "pipeline.collection.sources.base.Source",
    "A page of the report": "pipeline.report.pages.further",
}
"""What a part of each kind must keep to, wherever it comes from."""


def contracts() -> str:
    """Return the contracts of parts, in the words of their docstrings."""
    intro = "What a part must keep to, of Kouros itself or of [another package](../../how-to/extend.md)."
    parts = ["# Contracts of parts", intro]
    for title, name in CONTRACTS.items():
        found = pydoc.locate(name)
        if found is not None:
            parts.append(f"## {title}\n\n`{name}`\n\n{_block(inspect.getdoc(found) or '')}")
    return "\n\n".join(parts)


def tables() -> str:
    """Return every table of numbers and words, row by row, with the sources."""
    parts = ["# Tables\n\nWhat is assumed where a record is silent. Each row has its source; code repeats no number."]
    for file in sorted(TABLES.glob("*.csv")):
        with file.open(encoding="utf-8", newline="") as stream:
            header, *rows = csv.reader(stream)
        cells = [[plain(cell.replace("|", ", ")) for cell in row] for row in rows]
        shown = markdown_table(header, cells) if len(header) <= WIDE else "\n".join(_row(header, row) for row in cells)
        parts.append(f"## {file.name}\n\n{TABLE_WORDS[file.stem]}\n\n{shown}")
    return "\n\n".join(parts)


WIDE = 7
"""Columns beyond which a table is told row by row, without its empty cells."""


def _row(header: Iterable[str], cells: Iterable[str]) -> str:
    (_, first), *others = zip(header, cells, strict=True)
    return f"- **{first}**: " + "; ".join(f"*{plain(name)}* {cell}" for name, cell in others if cell)


# Markdown -------------------------------------------------------------------------------------------------------------


def _schema(name: str) -> Schema:
    found: Schema = json.loads(resource("schemas", f"{name}.schema.json").read_text(encoding="utf-8"))
    return found


def _resolved(field: Schema, schema: Schema) -> Schema:
    """Return what a reference within a schema stands for, with the words of the place that refers to it."""
    where = str(field.get("$ref", ""))
    if not where.startswith("#/$defs/"):
        return field
    target: Schema = schema["$defs"][where.removeprefix("#/$defs/")]
    return {**target, **{key: value for key, value in field.items() if key != "$ref"}}


def _keys(table: Schema, schema: Schema, skip: Iterable[str] = ()) -> str:
    """Return the keys of a table of a schema: type, default, meaning."""
    told = _docstring_words(str(table.get("description", "")))
    rows = []
    for key, field in table.get("properties", {}).items():
        if key in skip:
            continue
        shown = _resolved(field, schema)
        default = "required" if key in table.get("required", ()) else _json(field.get("default"))
        words = field.get("description") or told.get(key) or shown.get("description", "").partition("\n")[0]
        rows.append((f"`{key}`", _type(field, schema), default, plain(words)))
    return markdown_table(("Key", "Type", "Default", "Meaning"), rows) if rows else ""


def _json(value: object) -> str:
    return "" if value is None else f"`{json.dumps(value, ensure_ascii=False)}`"


def _type(field: Schema, schema: Schema) -> str:
    """Return the type of a field in words, with its limits."""
    for several in ("anyOf", "oneOf"):
        if several in field:
            kinds = [_type(one, schema) for one in field[several] if one.get("type") != "null"]
            return " or ".join(dict.fromkeys(kind for kind in kinds if kind))
    if "enum" in field:
        return ", ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if "$ref" in field:
        target = _resolved(field, schema)
        return "table" if "properties" in target or target is field else _type(target, schema)
    kind = field.get("type", "")
    if isinstance(kind, list):
        kind = " or ".join(one for one in kind if one != "null")
    if kind == "array":
        return f"list of {_type(field['items'], schema)}" if isinstance(field.get("items"), dict) else "list"
    names = {"string": "text", "object": "table", "boolean": "true or false", "integer": "whole number"}
    limits = {"minimum": "from", "exclusiveMinimum": "above", "maximum": "to", "exclusiveMaximum": "below"}
    said = [f"{word} {field[key]:g}" for key, word in limits.items() if key in field]
    return " ".join([names.get(kind, kind), *said])


def _docstring_words(text: str) -> dict[str, str]:
    """Return what a class's docstring says of its fields, in numpydoc's layout or as `name : what it is`."""
    found: dict[str, str] = {}
    keys: list[str] = []
    for line in text.splitlines():
        head = re.match(r"^(\w+(?:, \w+)*) *: ?(.*)$", line)
        if head:
            keys = head[1].split(", ")
            found |= dict.fromkeys(keys, "" if "---" in text else head[2])
        elif line.startswith(" ") and keys:
            found |= {key: f"{found[key]} {line.strip()}".strip() for key in keys}
        else:
            keys = []
    return found


def _opening(table: Schema) -> str:
    return plain(str(table.get("description", "")).partition("\n\n")[0])


def plain(text: str) -> str:
    """Return a text on one line that Markdown takes as it stands, but for code between grave accents."""
    words = " ".join(str(text).replace("``", "`").split())
    parts = words.split("`")
    if len(parts) % 2 == 0:
        return re.sub(r"([\\`*_{}\[\]<#|$~^])", r"\\\1", words)
    return "`".join(
        part.replace("|", "\\|") if i % 2 else re.sub(r"([\\*_{}\[\]<#|$~^])", r"\\\1", part)
        for i, part in enumerate(parts)
    )


def _block(text: str) -> str:
    return f"```text\n{text.strip()}\n```"


def markdown_table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table of Markdown."""
    names = list(header)
    lines = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])
