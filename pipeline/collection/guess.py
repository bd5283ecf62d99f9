"""A first mapping for a museum's file or database, guessed from its columns: to be looked at, never used unseen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from pipeline.collection.cells import parting_mark
from pipeline.collection.display_words import says_away
from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.by_values import (
    by_values,
    is_coded,
    perhaps_sizes,
    second_number,
    settle_number,
    unique_in,
)
from pipeline.collection.guessing.columns import (
    Column,
    candidates,
    captions_of_dimensions,
    length_beside,
    material_and_technique,
    prose_of_dimensions,
    sentences_of_dimensions,
    usual_place,
)
from pipeline.collection.guessing.columns import texts_of_dimensions as texts_among
from pipeline.collection.guessing.fields import (
    Fields,
    decimal_of,
    flag_among,
    images_among,
    pictures_said,
    tells_display,
    thousands_in,
)
from pipeline.collection.guessing.headings import place_by_heading
from pipeline.collection.guessing.levels import levels_of_place
from pipeline.collection.guessing.likeness import misspelt
from pipeline.collection.guessing.names import bare, is_length, is_side, named
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.orders import section_of, tells_orders, with_orders
from pipeline.collection.guessing.questions import Question
from pipeline.collection.guessing.shown import (
    place_of_shown,
    removed,
    room_and_position,
    ways_beside,
    words_of_display,
)
from pipeline.collection.guessing.source import (
    columns_in,
    database,
    laid,
    objects_of,
    source_of,
    workbook,
)
from pipeline.collection.guessing.spots import spots_by_sign
from pipeline.collection.guessing.taken import MOST_STORES, of_preset, said_of_stores
from pipeline.collection.guessing.what import (
    describing,
    in_place_of_title,
    name_and_title,
    named_by,
    naming_among,
    naming_the_rest,
)
from pipeline.collection.guessing.within import labels_within, parting, place_among
from pipeline.collection.mapping import MAPPABLE, preset_names
from pipeline.collection.mapping import Mapping as Proposal
from pipeline.collection.places import parted
from pipeline.collection.sources.address import expand_secrets
from pipeline.collection.sources.headings import HEADING
from pipeline.collection.sources.registry import is_address

_SIDES = ("height_m", "width_m", "depth_m", "diameter_m")

_NAMING = ("title", "object_name", "classification", "medium")

_TABLES = ("csv", "tsv", "fixed", "cards", "xlsx", "sql", "json", "yaml", "html")
"""Formats whose columns are the museum's own."""

_FORMATS = {"lido": "lido", "adlib": "adlib", "museumplus_ria": "museumplus", "linked_art": "linked_art"}
"""Preset -> the format of which it reads any file, for Kouros itself names the columns."""


@dataclass(frozen=True)
class Guess:
    """A proposed mapping: as TOML with comments, ready to be used, and what a person should look at.

    Attributes
    ----------
    text : str
        The mapping file.
    mapping : Mapping
        The same, ready to read with.
    doubts : tuple of str
        What was guessed without a sign of it in the file.
    questions : tuple of Question
        What may be chosen otherwise, by the key that the choice has.
    sure : tuple of str
        What the source itself says.
    left : tuple of str
        Columns that hold something and of which nothing is read.
    """

    text: str
    mapping: Proposal
    doubts: tuple[str, ...]
    questions: tuple[Question, ...] = ()
    sure: tuple[str, ...] = ()
    left: tuple[str, ...] = ()


def guess(where: str | Path, table: str | None = None, choices: Mapping[str, str] | None = None) -> Guess:
    """Propose a mapping for a museum's file or database.

    Parameters
    ----------
    where : str or Path
        Path of a file, or the URL of a database, which is only read.
    table : str or None
        The sheet of a workbook, or the table, view or SELECT of a database; where it is left out, the one that looks
        most like an inventory is taken, and a database's dimensions and places are joined to it.
    choices : mapping of str to str
        What a person has chosen: a field and its column ("object_number": "Inv."; "-" for none), a field's unit
        ("height_m.unit": "cm"), "header_row", "header_rows", "encoding", "delimiter", "decimal", "records".

    Returns
    -------
    Guess
        The mapping, and what to look at.

    Raises
    ------
    CollectionError
        For a source that cannot be read, that shows no column with the objects' numbers, and for a choice that cannot
        be; with the option that helps.
    """
    told = GuessNotes(dict(choices or {}))
    _check_choices(told.choices)
    if is_address(where):
        name = expand_secrets(str(where)).shown
        preset, source, columns = database(str(where), name, table, told)
        if preset is not None:
            return _preset(preset, columns, told)
    else:
        path = Path(where)
        name = path.name
        source = source_of(path, told)
        if source["format"] in ("tables", "dump"):
            with laid(path, source, told) as url:
                preset, read, columns = database(url, name, table, told)
            source |= {key: value for key, value in read.items() if key != "format"}
            if preset is not None:
                return _preset(preset, columns, told, source)
        elif source["format"] == "xlsx":
            source, columns = workbook(path, table, told)
        elif table is not None:
            raise CollectionError(f"{name}: has neither sheets nor tables; leave --table out")
        elif source["format"] not in _TABLES:
            kind = str(source["format"])
            preset = next((one for one in preset_names() if _FORMATS.get(one) == kind), None)
            columns = columns_in(path, source)
            if preset is not None:
                told.sure.append(f"{name} is of the format {kind}, whose preset {preset!r} is taken")
                return _preset(preset, columns, told)
        else:
            columns = columns_in(path, source)
    columns = objects_of(name, source, columns, told)
    decimal = told.choices.get("decimal") or decimal_of(columns, parted=source.get("delimiter") == ",")
    if decimal == ",":
        source["decimal"] = decimal
        told.sure.append("decimal comma, as most numbers have it")
    mark = parting_mark(decimal)
    parted = [column for column in columns if column.numeric and thousands_in(column, mark)]
    if parted:
        source["thousands"] = True
        told.doubts.append(
            f"thousands are parted by {mark!r} in {', '.join(repr(column.name) for column in parted)}, beside hundreds "
            "without it; leave thousands out of [source] where that is wrong"
        )
    return _written(name, source, columns, told)


def _preset(name: str, columns: Sequence[Column], told: GuessNotes, source: Mapping[str, Any] | None = None) -> Guess:
    text, proposal = of_preset(name, columns, told, source)
    return Guess(text, proposal, tuple(told.doubts), (), tuple(told.sure))


def _check_choices(choices: Mapping[str, str]) -> None:
    own = ("header_row", "header_rows", "encoding", "delimiter", "decimal", "dimensions", "unit", "records")
    for key in choices:
        if key not in own and key.removesuffix(".unit") not in MAPPABLE:
            raise CollectionError(
                f"--choose {key}: there is no such choice; choose a field of the record (such as gallery=COLUMN), its "
                f"unit (height_m.unit=cm), or one of {', '.join(own)}"
            )


def _places_of_cases(found: dict[str, Column], columns: Sequence[Column], told: GuessNotes) -> None:
    """Take a column of cases for the places too, where no column is of places and it names more than cases' signs."""
    cases = found.get("case")
    if any(one.name == HEADING for one in columns):
        return
    if cases is None or {"gallery", "case"} & {*found.keys() - {"case"}, *told.choices}:
        return
    if sum(parted(text).room != text for text in cases.distinct) >= 0.5 * len(cases.distinct) > 0:
        found["gallery"] = found.pop("case")
        told.doubts.append(
            f"column {cases.name!r} is taken to name rooms and cases; --choose case=COLUMN leaves it cases"
        )


def _written(name: str, source: dict[str, Any], columns: Sequence[Column], told: GuessNotes) -> Guess:
    orders = [column for column in columns if tells_orders(column)]
    able = candidates([column for column in columns if column not in orders])
    _add_misspelt(columns, able, told)
    found = _chosen(name, columns, able, told)
    _places_of_cases(found, columns, told)
    signs = spots_by_sign(columns, found, told)
    headed = place_by_heading(found, columns) if "gallery" not in told.choices else ""
    told.doubts += [headed] * bool(headed)
    by_value = by_values(columns, found, told.choices)
    for field, (column, why) in by_value.items():
        found[field] = column
        told.doubts.append(f"{field} is taken from {column.name!r}, for {why}; --choose {field}=- leaves that")
    named_twice = name_and_title(able, found, told.choices)
    if named_twice is not None:
        found["object_name"], found["title"] = named_twice
        told.questions[:] = [question for question in told.questions if question.key != "object_name"]
        told.sure.append(
            f"{named_twice[0].name!r} names things and {named_twice[1].name!r} is their title: it has more words"
        )
    if not {"gallery", "on_display"} & told.choices.keys() and "gallery" not in found:
        place_of_shown(found, told)
    if "gallery" not in found and "gallery" not in told.choices:
        placed = place_among(columns, found.values())
        if placed is not None:
            found["gallery"] = placed
            told.doubts.append(f"column {placed.name!r} is taken to tell where objects are, by what it holds")
    said = {key for key in {*_NAMING} - {*by_value} if key in found and found[key].filled}
    if "title" not in told.choices and said <= {"medium"}:
        saying = naming_among(columns, found.values(), words_enough=not said)
        if saying is not None:
            found["title"] = saying
            told.doubts.append(f"no column is called for names or titles: {saying.name!r} is taken, by what it holds")
    naming = named_by(able, found, told.choices)
    described = naming is not None and naming is not found.get("title")
    about = None if naming is None or described or "title" in told.choices else describing(able, naming)
    if about is None and not described and "title" not in told.choices:
        about = in_place_of_title(able, found)
        if about is not None:
            found["title"] = about
            told.doubts.append(
                f"no column is a title: the first sentence of {about.name!r} is; --choose title=- leaves that"
            )
    if naming is not None:
        found["object_name"] = naming
        if about is not None:
            found["title"] = about
        told.doubts.append(
            f"no column is called for what things are: {naming.name!r} is taken to name them"
            f"{', by its first sentence' * described}; --choose object_name=- leaves that"
        )
    if not any(key in found and found[key].filled for key in _NAMING):
        told.doubts.append(
            "no column says what the objects are: each is taken for a thing that stands; --choose object_name=COLUMN "
            "(or title, classification, medium) names one that does"
        )
    document = tomlkit.document()
    document.add(
        tomlkit.comment(f"Guessed from the columns of {' '.join(name.split())}. Look at every line; units above all.")
    )
    document["source"] = {key: value for key, value in source.items() if key != "long"}
    if "\n" in source.get("query", ""):
        document["source"]["query"] = tomlkit.string(source["query"], multiline=True)
    if "long" in source:
        document["source"]["long"] = source["long"]
    document["museum"] = {"name": "Our museum"}
    levels = levels_of_place(able.get("gallery", ()), found, columns, told)
    rest = [column for column in columns if column not in levels]
    if not levels:
        room_and_position(able.get("gallery", ()), found, told)
    words_of_display(rest, found, told)
    if "on_display" not in found and "on_display" not in told.choices:
        flag = flag_among(columns, found.values())
        if flag is not None:
            found["on_display"] = flag
            told.doubts.append(f"column {flag.name!r} is taken to say what is on display, by its words")
        else:
            told.questions += filter(None, [parting(columns, found.values(), found.get("gallery"))])
    if "image" not in told.choices:
        # A column called "image" may hold anything: what is in it says whether it names photographs.
        if "image" in found and found["image"].pictured <= 0.5:
            del found["image"]
        picture = images_among(columns, [column for name, column in found.items() if name != "image"])
        if "image" not in found and picture is not None:
            found["image"] = picture
        if "image" in found:
            told.doubts.append(pictures_said(columns, found["image"], found.values()))
    usual = None if "gallery" in told.choices else usual_place(columns, found)
    if usual is not None:
        told.questions[:] = [question for question in told.questions if question.key != "gallery"]
    stuff = [one for one in able.get("medium", ()) if not tells_display(one)]
    both = () if "medium" in told.choices else material_and_technique(stuff)
    if both:
        told.questions[:] = [question for question in told.questions if question.key != "medium"]
        told.sure.append(f"the medium is {' and '.join(repr(column.name) for column in both)} together")
    joined = {"medium": both, "displayed": ways_beside(rest, found, told), "gallery": levels}
    second = None if "object_number" in told.choices else second_number(columns, found)
    length = None if "depth_m" in told.choices else length_beside(columns, found.get("depth_m"))
    place = found.get("gallery")
    writer = Fields(columns, told.choices, told.doubts, told.questions, usual, place, joined, second, length)
    fields, used = writer.mapped(found)
    saying, field = (about, "title") if about is not None else (naming if described else None, "object_name")
    if saying is not None and field in fields:
        fields[field]["opening"] = True
        if labels := labels_within(saying):
            fields[field]["behind"] = labels
        # Sizes may stand in its other sentences.
        used = [column for column in used if column is not saying]
    if naming_the_rest(found, told.choices):
        fields["object_name"]["columns"] = [fields["object_name"].pop("column"), found["title"].name]
        fields["object_name"]["first"] = True
        told.doubts.append(
            f"where {found['object_name'].name!r} names no thing, {found['title'].name!r} is taken to; --choose "
            f"object_name={found['object_name'].name} leaves that"
        )
    gone = removed(columns, found, told)
    if gone is not None:
        fields["on_display"] = gone
    if signs is not None:
        fields["furniture"] = signs
    document["columns"] = fields
    _cases_in_places(fields, levels or [column for column in (found.get("gallery"), usual) if column is not None], told)
    texts = with_orders(texts_among(columns, used), orders)
    prose: list[Column] = []
    wanted = told.choices.get("dimensions")
    if wanted is not None:
        texts = [] if wanted == "-" else [_column(name, columns, "dimensions", wanted)]
    if not texts and wanted is None and fields.keys().isdisjoint(_SIDES):
        apart = {id(found.get(field)) for field in ("object_number", "gallery", "on_display", "image")}
        may = [column for column in columns if id(column) not in apart]
        behind = captions_of_dimensions(may) or prose_of_dimensions(columns, used)
        if behind is not None:
            texts, prose = [behind], [behind] * behind.prose
            told.doubts.append(
                f"no column is for sizes: those in {'the sentences of ' * behind.prose}{behind.name!r} are read, look "
                "at each; --choose dimensions=- leaves them"
            )
    if wanted is None:
        beside = sentences_of_dimensions(columns, [*texts, *(found[one] for one in _SIDES if one in found)], used)
        if beside is not None:
            texts, prose = [*texts, beside], [beside]
            told.doubts.append(
                f"the sizes of some objects stand in sentences of {beside.name!r} alone and are read there, look at "
                "each; --choose dimensions=COLUMN leaves them"
            )
    if texts:
        document["dimensions"] = section_of(texts, prose, told)
    taken = {id(column) for column in (*used, *texts)}
    left = [column for column in columns if id(column) not in taken and column.filled]
    # What measurements in rows of their own call a length is read.
    lost = [
        one for one in left if "long" not in source and (is_length(one.name) or (one.numeric and is_side(one.name)))
    ]
    if lost:
        told.doubts.append(
            f"no field takes the numbers of {', '.join(repr(column.name) for column in lost[:10])}; --choose "
            "height_m=COLUMN (or width_m, depth_m, diameter_m) takes one"
        )
    places = [column for column in (found.get("gallery"), usual) if column is not None]
    stores = list(dict.fromkeys(filter(says_away, (place for column in places for place in column.distinct))))
    if stores:
        document["display"] = {"not_on_display": stores[:MOST_STORES]}
        told.doubts.append(said_of_stores(stores))
    if "on_display" not in fields and not stores:
        told.doubts.append(
            "nothing tells what is on display: all objects that have a place are; --choose on_display=COLUMN names one "
            "that says it, and [display] not_on_display in the mapping names stores"
        )
    if not texts and fields.keys().isdisjoint(_SIDES):
        told.doubts.append(
            "no column with sizes was found; --choose height_m=COLUMN (and so on), or --choose dimensions=COLUMN for "
            f"texts such as 12 x 5 cm{perhaps_sizes(left)}"
        )
    text = tomlkit.dumps(document)
    proposal = Proposal.model_validate(document.unwrap())
    read = {column for _, column, _ in proposal.wanted()}
    # A column of units was looked at, whether the mapping names it or the unit that it tells.
    unread = tuple(one.name for one in left if one.units < 0.5 and one.name not in read)
    return Guess(text, proposal, tuple(told.doubts), tuple(told.questions), tuple(told.sure), unread)


def _add_misspelt(columns: Sequence[Column], able: dict[str, list[Column]], told: GuessNotes) -> None:
    """Take columns whose names are nearly those of fields that no column has, and say so."""
    for column in columns:
        meant = misspelt(column.name) if column.filled and named(column.name) is None else None
        if meant is not None and meant[0].field in MAPPABLE and meant[0].field not in able:
            able[meant[0].field] = [column]
            told.doubts.append(
                f"column {column.name!r} is read as {meant[1]!r}, misspelt; --choose {meant[0].field}=- leaves it out"
            )


def _cases_in_places(fields: tomlkit.items.Table, places: Sequence[Column], told: GuessNotes) -> None:
    """Take cases from places that name them, where no column does, and say so."""
    if not places or "case" in fields or "case" in told.choices:
        return
    texts = list(dict.fromkeys(place for column in places for place in column.distinct))
    apart = [(text, place) for text in texts if any((place := parted(text))[1:])]
    if len(apart) > 1 or len(apart) > 0.05 * len(texts):
        fields["gallery"]["cases"] = True
        text, place = next((one for one in apart if one[0] != one[1].room), apart[0])
        room, rest = place.room[:80], (place.case or place.displayed)[:80]
        how = (
            f"the gallery is {room!r}, the rest {rest!r}" if rest != room else "both the gallery and the case are that"
        )
        told.sure.append(
            f"{len(apart)} of {len(texts)} places name a case, a plinth, a shelf or how things are held: of "
            f"{text[:80]!r} {how}; --choose case=- leaves places whole"
        )


def _chosen(
    name: str, columns: Sequence[Column], able: Mapping[str, list[Column]], told: GuessNotes
) -> dict[str, Column]:
    """Return the column of each field: the one that was chosen, or the likeliest."""
    found = {fieldname: those[0] for fieldname, those in able.items() if fieldname in MAPPABLE}
    for key, wanted in told.choices.items():
        if key in MAPPABLE:
            found.pop(key, None)
            if wanted != "-":
                found[key] = _column(name, columns, key, wanted)
    for fieldname, those in able.items():
        # The numbers of objects are asked about below, with their reason; sizes in two units need no question.
        if fieldname in (*told.choices, "object_number") or fieldname not in found:
            continue
        if len({bare(column.name) for column in those}) > 1:
            names = tuple(column.name for column in those)
            words = fieldname.removesuffix("_m").removesuffix("_kg").replace("_", " ")
            told.questions.append(Question(fieldname, f"which column is the {words}?", names, names[0]))
    settle_number(able.get("object_number", ()), columns, found, told)
    number = found.get("object_number")
    if number is None:
        found["object_number"] = number = unique_in(name, columns, found)
        if found.get("object_name") is number and is_coded(number):
            del found["object_name"]
        told.doubts.append(f"object numbers are taken from {number.name!r}, where each row has another one")
        texts = texts_among(columns, found.values())
        free = [one for one in columns if one is number or (one not in found.values() and one not in texts)]
        likely = tuple(c.name for c in free if c is number or (c.numbering and len(c.distinct) > 0.9 * len(c.values)))
        told.questions.append(Question("object_number", "which column has the object numbers?", likely, number.name))
    elif len(able.get("object_number", ())) > 1 and "object_number" not in told.choices:
        likely = tuple(column.name for column in able["object_number"])
        told.questions.append(Question("object_number", "which column has the object numbers?", likely, number.name))
        others = ", ".join(repr(column.name) for column in able["object_number"] if column is not number)
        told.doubts.append(
            f"object numbers are taken from {number.name!r}, and not from {others}; --choose object_number=COLUMN "
            "takes another"
        )
    none = number.blanks if second_number(columns, found) is not None else ()
    numbers = [text for text in number.filled if text not in none]
    repeated = len(numbers) - len(set(numbers))
    if repeated:
        told.doubts.append(
            f"column {number.name!r} repeats {repeated} object numbers: only the first row of each is kept"
        )
    if len(number.filled) < len(number.values):
        told.doubts.append(
            f"column {number.name!r} is empty in {len(number.values) - len(number.filled)} rows, which are refused"
        )
    return found


def _column(name: str, columns: Sequence[Column], key: str, wanted: str) -> Column:
    for column in columns:
        if column.name == wanted:
            return column
    there = ", ".join(repr(column.name) for column in columns[:80])
    raise CollectionError(f"{name}: --choose {key}: there is no column {wanted!r}; its columns are {there}")
