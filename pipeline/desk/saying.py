"""What people say to the desk, photographs too: each goes where its command puts it, or back to the form."""

import warnings
from collections.abc import Mapping
from datetime import UTC, datetime
from io import BytesIO

from PIL import Image, ImageOps

from pipeline.desk.asking import Asked, DeskAnswer, address
from pipeline.desk.entering import CellsError, end_rule, enter, house_rule, rules_version, state_rule, writing
from pipeline.desk.errands import say
from pipeline.desk.guard import DeskError, NotThereError, StaleError
from pipeline.desk.looking import errand_context, errand_named, house_context, object_context
from pipeline.desk.numbers import read_number
from pipeline.desk.object_facts import ObjectFacts
from pipeline.errors import InputError, KourosError
from pipeline.records import DecisionKind
from pipeline.store.desk import Picture, add_picture
from pipeline.tools.decisions import WHO_LIMIT, WHY_LIMIT, Wish, decide

EDGE = 1600
"""Pixels of the longer side of what is kept."""

PIXELS = 60_000_000
"""Of the largest picture that is decoded: what a telephone takes, and what memory bears."""

_FORMATS = ("JPEG", "PNG", "WEBP")


def taken_picture(content: bytes) -> bytes:
    """Return a photograph as it is kept: a JPEG without what its camera wrote of place and time.

    Raises
    ------
    InputError
        For what is no picture of a kind that is taken, is too large, or is damaged.
    """
    try:
        with warnings.catch_warnings():
            # Pillow warns of what may be a bomb; here it is refused.
            warnings.simplefilter("error")
            with Image.open(BytesIO(content), formats=_FORMATS) as picture:
                if picture.width * picture.height > PIXELS:
                    raise InputError(f"the picture has more than {PIXELS // 1_000_000} million pixels; make it smaller")
                picture.draft("RGB", (EDGE, EDGE))
                upright = ImageOps.exif_transpose(picture) or picture
                small = upright.convert("RGB")
                small.thumbnail((EDGE, EDGE))
    except InputError:
        raise
    except Exception as problem:
        # Whatever a decoder stumbles over is a damaged picture.
        raise InputError("the photograph cannot be read; take a JPEG, PNG or WebP picture") from problem
    out = BytesIO()
    small.save(out, "JPEG", quality=85)
    return out.getvalue()


STALE = (
    "Somebody else changed this while it was open here. What is there now stands below; nothing of yours was saved, "
    "and it still stands in the form. Send it again if it still holds."
)


def say_decision(asked: Asked) -> DeskAnswer:
    """Write down a decision about an object."""
    form, number = asked.form, asked.form.get("number", "")
    try:
        signed(asked)
        with writing(asked.site.workspace.settings):
            _seen(asked, number)
            decide(asked.site.workspace, _wish(asked, number, form))
    except KourosError as problem:
        return _object_again(asked, number, problem, form.get("kind", ""))
    return DeskAnswer(to=address("/object", number=number, saved="decision"))


def _wish(asked: Asked, number: str, form: Mapping[str, str]) -> Wish:
    if form.get("kind") not in tuple(DecisionKind):
        raise DeskError("say what you decide")
    kind = DecisionKind(form["kind"])
    model, _, level = form.get("about", "").partition("\n") if form.get("about") else ("", "", "")
    about = {"model": model, "level": level} if kind in (DecisionKind.ACCEPT, DecisionKind.VERDICT) else {}
    words: tuple[str, ...] = ()
    if kind is DecisionKind.INSTALLED:
        words = _installed(asked, form.get("measure", ""), form, "")
    elif kind is DecisionKind.CLASS:
        words = (form.get("class", ""),)
    elif kind is DecisionKind.VERDICT:
        words = (form.get("verdict", ""),)
    elif kind is DecisionKind.WITHDRAW:
        words = (form.get("id", ""),)
    until = form.get("until", "") if kind is DecisionKind.ACCEPT else ""
    return Wish(number, kind, words, form.get("why", ""), asked.name, form.get("on", ""), until=until, **about)


def _installed(asked: Asked, measure: str, form: Mapping[str, str], prefix: str) -> tuple[str, ...]:
    """Return a measure as the command takes it: its name, and NAME=VALUE of each of its numbers in SI."""
    known = asked.site.workspace.measures.installable.get(measure)
    if known is None:
        raise DeskError("say which measure is installed")
    words = [measure]
    for q in known.parameters:
        text = form.get(f"{prefix}p.{q.name}", "").strip()
        if not text:
            raise DeskError(f"write the {q.meaning}")
        value = read_number(text, q.unit, asked.site.run.units)[0]
        key = q.name if q.unit == "-" else f"{q.name}_{q.unit.lower()}"
        words.append(f"{key}={value!r}")
    product = form.get(f"{prefix}product", "").strip()
    return (*words, f"product={product}") if product else tuple(words)


def say_measured(asked: Asked) -> DeskAnswer:
    """Lay what was measured over an object's record."""
    form, number = asked.form, asked.form.get("number", "")
    typed = {name.removeprefix("m."): text for name, text in form.items() if name.startswith("m.")}
    try:
        signed(asked)
        with writing(asked.site.workspace.settings):
            facts = _seen(asked, number)
            enter(asked.site.workspace, facts.item, typed, asked.name, asked.site.run.units)
    except KourosError as problem:
        return _object_again(asked, number, problem, "measure")
    following = form.get("following", "")
    if following:
        return DeskAnswer(to=address("/object", number=following, open_="measure", saved="measured"))
    return DeskAnswer(to=address("/object", number=number, saved="measured"))


def say_picture(asked: Asked) -> DeskAnswer:
    """Keep a photograph of an object's mount."""
    number = asked.form.get("number", "")
    try:
        signed(asked)
        if len(asked.upload) > 1e6 * asked.site.serving.upload_megabytes:
            raise DeskError(f"the photograph has more than {asked.site.serving.upload_megabytes:g} MB; make it smaller")
        if not asked.upload:
            raise DeskError("choose or take a photograph")
        note = asked.form.get("note", "").strip()
        if len(note) > WHY_LIMIT:
            raise DeskError(f"a note has at most {WHY_LIMIT} characters: say it shorter")
        asked.site.facts(number)
        image = taken_picture(asked.upload)
        picture = Picture(0, number, note, asked.name, datetime.now(UTC).isoformat(timespec="seconds"))
        add_picture(asked.site.workspace.engine, picture, image)
    except KourosError as problem:
        return _object_again(asked, number, problem, "picture")
    return DeskAnswer(to=address("/object", number=number, saved="picture"))


def say_rule(asked: Asked) -> DeskAnswer:
    """Add a house rule to the settings."""
    form = asked.form
    try:
        signed(asked)
        rule = house_rule(form, asked.name, datetime.now(UTC).date(), asked.site.run.units)
        with writing(asked.site.workspace.settings):
            if form.get("version") != rules_version(asked.site.config):
                raise StaleError(STALE)
            added = state_rule(asked.site.config, rule)
    except KourosError as problem:
        context = house_context(asked, problem=_words(problem), typed=form)
        return DeskAnswer("house.html", context, _status(problem))
    return DeskAnswer(to=address("/house", saved="rule" if added else "known"))


def say_back(asked: Asked) -> DeskAnswer:
    """Take a house rule back: it stays in the settings, with who took it back, when and why."""
    form = asked.form
    try:
        signed(asked)
        with writing(asked.site.workspace.settings):
            if form.get("version") != rules_version(asked.site.config):
                raise StaleError(STALE)
            end_rule(asked.site.config, form.get("at", ""), asked.name, datetime.now(UTC).date(), form.get("why", ""))
    except KourosError as problem:
        return DeskAnswer("house.html", house_context(asked, problem=_words(problem), typed=form), _status(problem))
    return DeskAnswer(to=address("/house", saved="back"))


def say_errand(asked: Asked) -> DeskAnswer:
    """Write down that somebody takes an errand, gives it to somebody, has done it, or puts it back."""
    form, key = asked.form, asked.form.get("key", "")
    entry = errand_named(asked, key)
    try:
        signed(asked)
        with writing(asked.site.workspace.settings):
            entry = errand_named(asked, key)
            if form.get("version") != entry.version:
                raise StaleError(STALE)
            engine = asked.site.workspace.engine
            if form.get("kind") == "done" and form.get("ticks"):
                _tick(asked, key)
            say(engine, entry, form.get("kind", ""), asked.name, whose=form.get("whose", ""), note=form.get("note", ""))
    except KourosError as problem:
        return DeskAnswer(
            "errand.html", errand_context(asked, key, problem=_words(problem), typed=form), _status(problem)
        )
    return DeskAnswer(to=address("/errand", key=key, saved=form["kind"]))


def _tick(asked: Asked, key: str) -> None:
    """Write down for each object that was ticked that the errand's measure is installed: all of them or none."""
    entry, form, site = errand_named(asked, key), asked.form, asked.site
    ticked = asked.lists.get("object", ())
    if not ticked:
        raise DeskError("tick the objects at which it is installed")
    numbers = [one.object_number for one in entry.errand.objects]
    wishes = []
    for number in ticked:
        if number not in numbers:
            raise DeskError(f"object {number[:60]!r} is not of this errand")
        words = _installed(asked, entry.errand.measure, form, f"{numbers.index(number)}.")
        why = form.get("note", "").strip() or f"errand done: {entry.errand.title}"
        wishes.append(Wish(number, DecisionKind.INSTALLED, words, why, asked.name))
    for dry in (True, False):
        # What would be refused is refused before anything is written.
        for wish in wishes:
            decide(site.workspace, wish, dry_run=dry)


def signed(asked: Asked) -> None:
    """Refuse what nobody says.

    Raises
    ------
    DeskError
        Where the name is missing, or is none.
    """
    if not asked.name:
        raise DeskError("write your name: it stands beside what you say")
    if len(asked.name) > WHO_LIMIT or not asked.name.isprintable():
        raise DeskError(f"a name has at most {WHO_LIMIT} characters, on one line")


def _seen(asked: Asked, number: str) -> ObjectFacts:
    facts = asked.site.facts(number)
    if asked.form.get("version") != facts.version:
        raise StaleError(STALE)
    return facts


def _object_again(asked: Asked, number: str, problem: KourosError, section: str) -> DeskAnswer:
    if isinstance(problem, NotThereError):
        raise problem
    typed = dict(asked.form)
    if isinstance(problem, CellsError):
        typed |= {f"wrong.{name}": text for name, text in problem.cells.items()}
    context = object_context(asked, number, problem=_words(problem), typed=typed, section=section)
    return DeskAnswer("object.html", context, _status(problem))


def _words(problem: KourosError) -> str:
    text = str(problem)
    for option, word in (("--why", "the reason"), ("--who", "your name"), ("--until", "the last day"),
                         ("--on", "the day"), ("--model", "what it is about"), ("--level", "the level")):  # fmt: skip
        text = text.replace(option, word)
    return text


def _status(problem: KourosError) -> int:
    return 409 if isinstance(problem, StaleError) else 422 if isinstance(problem, InputError) else 503
