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

TABLE_WORDS = {
    "bending": "What holds of whatever bends: how firmly it is held, its damping, stress concentration at a held base.",
    "classes": "What a class of objects assumes where the museum's record is silent.",
    "contacts": "How much of a base that is only assumed may really bear.",
    "column_names": "Names of columns by which `kouros import --guess` knows a field.",
    "damping": "Damping of a hung object by wall and back (Table 4 of the paper).",
    "dimension_labels": "Short labels of dimension texts by language.",
    "dimension_units": "Units of dimension texts.",
    "dimension_words": "Words of dimension texts.",
    "display_words": "Words by which museums say what is on display, in flags and names of places: yes and no of any "
    "flag; shown and away; a store whatever else its name says, or where only a code follows (code); what makes a "
    "store a gallery; who lends.",
    "dispersion": "What a fragility curve's dispersion is made of.",
    "efforts": "Hours, cost and trade of each measure, of one that is not named, and of setting out in a gallery.",
    "fills": "How much of its outline a thing of some materials fills, where its class alone says too much.",
    "fixings": "What wax, putty, pins, ties, clips, brackets and clamps hold, and which materials they harm.",
    "fragility": "Published medians and dispersions that stand beside the computed ones.",
    "friction": "Friction between object and surface (Table 3 of the paper, handbooks and judgement).",
    "generic_models": "The paper's Tables 1 and 2, and the model that answers each row.",
    "hangings": "Ways to hang on a wall: whether a work swings or may be lifted off, its hooks and its hangers.",
    "furniture": "What objects stand on or in, or hang from: frequency [Hz], damping [-], degrees off level, and size.",
    "usual_furniture": "What objects of a class usually stand on or hang from, by height [m]; * is any other class.",
    "usual_hangings": "Ways in which works of a class usually hang, the likeliest first; * is any other class.",
    "isolators": "The isolators that advice may choose from; a museum's own catalogue takes the place of this table.",
    "materials": "Density, strength and stiffness of materials, and the words that name them.",
    "measures": "The measures, in the order of their intrusiveness, with limits, words and sources.",
    "mounts": "How a thing is held that lies in a case or cannot stand by itself: models, measures, grip in weights, "
    "room [m] and lean [degrees].",
    "overturning": "Published medians of overturning that `kouros validate --published` is held against.",
    "plausible": "What a number of a record may be.",
    "proportions": "One size over another one by class: 5th, 50th and 95th percentile; known: how many must be "
    "recorded.",
    "rules": "Which class a record names; the first rule that holds decides.",
    "class_signs": "Words of materials and titles that say something of the class, in eight languages.",
    "class_weights": "What each sign says for each class: logarithms of odds, found from labelled objects.",
    "slender": "How much of an object of a class is about as slender as its critical section, by share of its height.",
    "stakes": "What is at stake: weights of the classes of value and of a person, and the energy that is dangerous.",
    "survey": "The questions of the survey's sheet.",
    "validation": "What `kouros validate` assumes of a body for which nothing is fitted.",
}
"""What each table holds; a table that is not named here stops the build."""

COLUMN_WORDS = {
    "run": "the run that found it, which may be an earlier one",
    "object_number": "the museum's number of the object",
    "title": "of the object, or of the measure",
    "gallery": "the gallery it stands in",
    "level": "the level of shaking, as the site's manifest names it; empty: all",
    "measure": "a row of the table of measures",
    "sentence": "the advice in the reader's language and units",
    "parameters": "what to build or buy, in SI units",
    "checks": "each model that was run again: demand before and after, capacity, passes or fails",
    "rejected": "the less intrusive measures, and why none of them will do",
    "source": "who says so",
    "on_display": "whether it is on display",
    "state": "act, watch, fine, unknown, or not on display",
    "object_class": "the class it was taken for: a row of the table of classes",
    "class_probability": "how likely that class is by what the record says; empty where a person decided",
    "class_next": "the next likely class, where it has more than 0.1",
    "class_next_probability": "how likely that one is",
    "furniture": "what it stands on or in, or hangs from: a row of the table of furniture",
    "furniture_origin": (
        "where that is known from: its record (measured), the case that it names (derived), a house rule (stated), or "
        "what is usual for its class (assumed)"
    ),
    "missing": "what is not recorded, so that it cannot be assessed",
    "median_g": "the peak ground acceleration at which half of such objects fail first, in g",
    "settled": "whether people accepted or overruled all that does not pass at that level",
    "case": "the case that it stands in, as its record says",
    "errand": "its number on the way through the museum",
    "needs": "number of the errand that has to be done first",
    "do": "whether the plan has it, within [plan] hours and cost",
    "place": "its place in the order of what avoids most for an hour; empty for what takes objects from view",
    "objects": "numbers of the objects that it is for",
    "trade": "whose work it is: handler, mount-maker, engineer",
    "hours": "of work, of all who work together",
    "hours_low": "if it goes well",
    "hours_high": "if it does not",
    "cost": "of material and outside work, in the museum's currency",
    "cost_low": "if it goes well",
    "cost_high": "if it does not",
    "loss": "expected loss of its objects without it, in objects of class C; 0 where it only prepares another",
    "avoided": "what of that it avoids",
    "takes_from_view": "whether it takes objects off display",
    "remaining": "probability of harm that remains with it; empty where its checks exclude harm",
    "probability": "of coming to harm at the level where that is likeliest; empty where nobody knows",
    "probability_error": "standard error of it, by the number of samples",
    "band": "the word for it: almost certain, likely, possible, unlikely, very unlikely",
    "harm": "the state of harm that is likeliest: leaves, rocks without a fall, falls, breaks; empty for none",
    "harm_level": "the level of shaking at which harm is likeliest",
    "p_shifts": "probability that it shifts by a millimetre; empty where no model tells it, as of the others",
    "p_leaves": "probability that it leaves its place or hits something",
    "p_rocks": "probability that it rocks",
    "p_falls": "probability that it falls",
    "p_breaks": "probability that it breaks",
    "open_for": "the parameter whose measurement alone may change what is decided; `class` for what it is",
    "worth": "by how much that measurement lowers the expected loss, as a share of the loss by harm",
    "expected_loss": "probability times what is at stake, in objects of class C",
    "median_is": "empty where the median was found; above, below: it is only a bound; flat: no curve tells it",
    "dispersion": "of the fragility curve, lognormal",
    "median_pgv_m_s": "the same median in peak velocity, in m/s",
    "goodness": "probability of a deviance from the curve as large by chance",
    "annual_rate": "how often a year it comes to harm; empty without a hazard curve or two return periods",
    "chance_50_years": "of coming to harm within 50 years",
    "chance_50_years_low": "lower end of its range: 1 case of 20 is below",
    "chance_50_years_high": "upper end of its range",
    "yearly_shifts": "how often a year it shifts; empty where no curve tells it, as of the others",
    "yearly_leaves": "how often a year it leaves its place or hits something",
    "yearly_rocks": "how often a year it rocks",
    "yearly_falls": "how often a year it falls",
    "yearly_breaks": "how often a year it breaks",
    "page": "the page and place of the object in the report",
    "rank": "its place among all objects on display, 1 the most urgent: act before watch, cannot be assessed and fine; "
    "in each, what nobody has settled, what is not to be checked first, and what is expected to be lost come first",
    "row": "of the source",
    "line": "of a text file, where it differs from the row",
    "field": "of the object record",
    "what": "source, choice, refused, sheet, or doubtful",
    "message": "what is wrong",
    "remedy": "what mends it",
    "characters": "what stands in the museum's record, where that is kept: a column; behind | a text of it",
    "used": "what is used of the field, in SI units; empty for nothing",
}
"""Of the exports' columns that no schema describes."""


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
