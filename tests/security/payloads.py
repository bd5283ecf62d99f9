"""A collection that means harm: rows with a payload in every field."""

from __future__ import annotations

import csv
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import openpyxl

from pipeline.collection.mapping import PRESETS
from pipeline.collection.record import KINDS

DAILY = 100
ROWS = int(os.environ.get("KOUROS_HOSTILE", str(DAILY)))
"""Two for each payload in each field; `make soak` takes a thousand."""

BROKEN = 6
"""Rows at the beginning that no reader can take: their number is missing, too long, or there already."""

SCRIPT = "window.pwned=(window.pwned||0)+1"
PRODUCT = "8641969"
"""1234567 times 7: what a template that is evaluated would print."""

FIELDS = tuple(name for name, kind in KINDS.items() if kind != "list" and name != "dimensions")
NUMBERS = tuple(name for name in FIELDS if KINDS[name] in ("number", "integer"))
SIZES = {"height_m": "0.6", "width_m": "0.12", "depth_m": "0.12", "mass_kg": "5", "clearance_m": "0.05"}
"""Good numbers, so that most objects are assessed and every kind of page is filled."""


def payloads(canary: str, outside: Path) -> list[str]:
    """Return what is put into the fields.

    canary  : address of a server that nobody may ask for anything
    outside : a path at which nothing may ever be written
    """
    up = "../" * 12
    scripts = [
        f"<script>{SCRIPT}</script>",
        f'"><img src="{canary}img" onerror="{SCRIPT}">',
        f"'><svg/onload={SCRIPT}>",
        f"</title></style></svg></textarea><script>{SCRIPT}</script>",
        f"--><script>{SCRIPT}</script><!--",
        f"]]><script>{SCRIPT}</script>",
        f"javascript:{SCRIPT}",
        f'" autofocus onfocus="{SCRIPT}" onmouseover="{SCRIPT}" x="',
        f'<iframe srcdoc="<script>parent.{SCRIPT}</script>"></iframe>',
        f'<details open ontoggle="{SCRIPT}"><a href="javascript:{SCRIPT}" id=x>click</a></details>',
        f'<meta http-equiv="refresh" content="0;url={canary}meta">',
        f'<link rel=stylesheet href="{canary}css"><style>@import "{canary}import"</style>',
        f"<style>*{{background:url({canary}url)}}</style>",
        f'<form action="{canary}form"><input type=submit autofocus></form><base href="{canary}">',
        "<!DOCTYPE x [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>&a;",
        "&lt;script&gt;&#x3c;script&#62;&amp;",
    ]
    paths = [
        f"{up}{outside.as_posix().lstrip('/')}",
        str(outside),
        f"..\\..\\..\\{outside.name}",
        f"C:\\{outside.name}",
        f"file://{outside.as_posix()}",
        f"%2e%2e%2f{outside.name}",
        "CON",
        "..",
        "/",
        f"x/{outside.name}.html",
        "index.html",
        f"$(touch {outside.as_posix()})",
        f"`touch {outside.as_posix()}`; touch {outside.as_posix()} | touch {outside.as_posix()}",
    ]
    formulas = [
        "=cmd|' /C calc'!A0",
        f'=HYPERLINK("{canary}formula","click")',
        "+1+1",
        "-2+3",
        "@SUM(1+1)",
        "\t=1+1",
        "x;=1+1",
        "\uff1d1+1",
        '",=1+1,"',
    ]
    templates = [
        "{{1234567*7}}",
        "${1234567*7} #{1234567*7} <%= 1234567*7 %>",
        "{% for x in ().__class__.__base__.__subclasses__() %}{{x}}{% endfor %}",
        "{0.__class__.__init__.__globals__}",
        "{demand} {capacity!r} {",
        "%s %(x)s %n %99999999s",
        "\\u003cscript\\u003e",
    ]
    queries = [
        "'; DROP TABLE item; --",
        '" OR 1=1; DELETE FROM run; --',
        "') UNION SELECT 1,2,3 --",
        ":name %(name)s ?",
    ]
    controls = [
        "\x1b[2J\x1b[1;31mred\x1b]0;owned\x07",
        "\x9b2J\x90\x9c",
        "\u202egnp.exe\u202c \u2066x\u2069 \u200f",
        "\x07\x08\x7f\x0b\x0c",
        "line\r\nX-Forged: yes\r\n\r\nbody",
        "\ufeff\ufffe\ufff9\U000e0041",
        "Z" + "\u0301" * 300,
        "\u2028\u2029\u0085",
    ]
    longs = ["A" * 5000, "very long " * 400, '"' * 300, "'" * 50 + "\\" * 50]
    return [*scripts, *paths, *formulas, *templates, *queries, *controls, *longs]


def rows(payload: list[str]) -> Iterator[dict[str, str]]:
    """Yield the rows; each field gets each payload in its turn, and a tenth of the numbers too."""
    # Each gallery has a page: twenty in `make soak`, every day half as many.
    galleries = payload[:: max(len(payload) // (20 if ROWS > DAILY else 10), 1)]
    for number in range(ROWS):
        row = {}
        for place, field in enumerate(FIELDS):
            text = payload[(number + 7 * place) % len(payload)]
            if field in NUMBERS and number % 10:
                text = SIZES.get(field, "")
            row[field] = text
        row["gallery"] = galleries[number % len(galleries)]
        row["object_number"] = f"{payload[number % len(payload)][:120]} {number}"
        if number % 10 != 1:
            # What stands on an isolator that nobody described is not assessed.
            row["isolator"] = ""
        if number % 3:
            row |= {"support": "", "on_display": "", "susceptible": ""}
        if number < BROKEN:
            row["object_number"] = ("", "twice" if number == 1 else "", "n" * 300)[number % 3]
        if number == BROKEN:
            row["object_number"] = "twice"
        yield row


def write_csv(path: Path, table: list[dict[str, str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows(table)


def write_xlsx(path: Path, table: list[dict[str, str]]) -> None:
    """Write the same as texts; what no workbook can hold is left out of its cell."""
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE

    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet("objects")
    sheet.append(list(FIELDS))
    for row in table:
        cells = []
        for field in FIELDS:
            cell = WriteOnlyCell(sheet, ILLEGAL_CHARACTERS_RE.sub("", row[field]).replace("\ufffe", ""))
            cell.data_type = "s"
            cells.append(cell)
        sheet.append(cells)
    book.save(path)


def write_sqlite(path: Path, table: list[dict[str, str]]) -> None:
    names = ", ".join(f'"{field}"' for field in FIELDS)
    with sqlite3.connect(path) as database:
        # An empty number would be its table's key otherwise.
        database.execute(f"CREATE TABLE objects (place INTEGER PRIMARY KEY, {names})")
        places = ", ".join("?" * len(FIELDS))
        statement = f"INSERT INTO objects ({names}) VALUES ({places})"  # noqa: S608 - our own names
        database.executemany(statement, [tuple(row[field] for field in FIELDS) for row in table])
    database.close()


def mapping(source: str) -> str:
    """Return the preset for Kouros's own columns, for another kind of source."""
    text = (PRESETS / "kouros.toml").read_text(encoding="utf-8")
    head, _, rest = text.partition("[source]")
    _, _, columns = rest.partition("[museum]")
    return f"{head}[source]\n{source}\n[museum]{columns}"
