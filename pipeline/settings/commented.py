"""The text of a settings file made from its models: every table and key with its default and its description."""

from collections.abc import Mapping
from textwrap import wrap
from typing import Any

import tomlkit
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from tomlkit import TOMLDocument
from tomlkit.items import Table

_WIDTH = 118


def commented(model: type[BaseModel], given: Mapping[tuple[str, str], object], head: str) -> str:
    """Return a TOML file with the defaults of a model, its descriptions as comments.

    Parameters
    ----------
    model : type of BaseModel
        Its fields whose defaults are models are the tables, those with examples lists of tables; other fields are left
        out.  A table's comment is the docstring of its model, a key's the description of its field.  Examples of a
        field become comments that can be uncommented.
    given : mapping
        Values in place of defaults, by table and key.
    head : str
        The comment above all.

    Returns
    -------
    str
        TOML that reads back as the defaults, but for what is given.
    """
    document = tomlkit.document()
    for line in wrap(head, _WIDTH):
        document.add(tomlkit.comment(line))
    for name, field in model.model_fields.items():
        if isinstance(field.default, BaseModel):
            document.add(tomlkit.nl())
            mine = {key: value for (of, key), value in given.items() if of == name}
            document.add(name, _table(name, field, mine))
        elif field.examples:
            # A list of tables that is empty cannot be written in a way in which one can be added below.
            document.add(tomlkit.nl())
            _say(document, field.description or "")
            for example in field.examples:
                for line in listed_table(name, example).splitlines():
                    document.add(tomlkit.comment(line))
    return tomlkit.dumps(document)


def listed_table(name: str, values: Mapping[str, Any]) -> str:
    """Return one table of a list of tables as TOML; tables in it stand on one line.

    Parameters
    ----------
    name : str
        Of the list.
    values : mapping
        By key: texts, numbers, dates, lists and tables.

    Returns
    -------
    str
        Lines that can be added to a file.
    """
    table = tomlkit.table()
    for key, value in values.items():
        if isinstance(value, Mapping):
            inline = tomlkit.inline_table()
            inline.update(value)
            table.add(key, inline)
        else:
            table.add(key, value)
    document = tomlkit.document()
    document.add(name, tomlkit.aot())
    document[name].append(table)
    return tomlkit.dumps(document)


def _table(name: str, of: FieldInfo, given: Mapping[str, object]) -> Table:
    default = of.default
    out = tomlkit.table()
    _say(out, " ".join((type(default).__doc__ or "").split()))
    for example in of.examples or ():
        _example(out, example)
    for key, field in type(default).model_fields.items():
        if key == "root":
            continue
        value = given.get(key, getattr(default, key))
        _say(out, _sentence(field.description or ""))
        for example in field.examples or ():
            _example(out, {name: {key: [example]}})
        # A list of tables that is empty cannot be written in a way in which one can be added below.
        if not field.examples:
            out.add(key, tomlkit.item(value))
    return out


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"


def _say(table: Table | TOMLDocument, text: str) -> None:
    for line in wrap(text, _WIDTH):
        table.add(tomlkit.comment(line))


def _example(table: Table, example: Mapping[str, Any]) -> None:
    for line in tomlkit.dumps(example).splitlines():
        # The table that only holds the example needs no line of its own.
        if line and not (line.startswith("[") and not line.startswith("[[")):
            table.add(tomlkit.comment(line))
