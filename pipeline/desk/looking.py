"""Pages of the desk that only show: search, an object, what to measure on the way, errands, house rules."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from math import ceil
from typing import Any

from pipeline.analysis.house.questions import VOCABULARIES
from pipeline.analysis.house.rule import CRITERIA, QUANTITIES, HouseRule, Span
from pipeline.analysis.survey import measurables
from pipeline.collection.inventory import items_named
from pipeline.desk.asking import Asked, DeskAnswer, page_number
from pipeline.desk.entering import labels, rules_version
from pipeline.desk.errands import ErrandEntry, entries
from pipeline.desk.guard import NotThereError
from pipeline.desk.numbers import cell_unit, shown_number
from pipeline.desk.object_facts import ObjectFacts, cells, vocabulary
from pipeline.desk.run_facts import SHOWN, ListedObject, RunFacts
from pipeline.planning.efforts import EffortSpan
from pipeline.quantities import sorting_key
from pipeline.records import DecisionKind, Support, in_force
from pipeline.records.likelihood import CLASS
from pipeline.report.assumed import assumed
from pipeline.report.language import _, local, said
from pipeline.report.pages.chances import MOUNT, class_title, name_of
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.errand_views import priced, spanned, title_of, trade_word
from pipeline.report.pages.notes import page_notes
from pipeline.report.pages.scene_words import STATED, stated_told, word_told
from pipeline.report.pages.views import STATES, DecisionView, State
from pipeline.report.text import words
from pipeline.report.units import Units, by_hand
from pipeline.tables import table


def lasting(minutes: float) -> str:
    """Return how long something takes, in hours where it is more than one and a half."""
    if minutes <= _LONG:
        return _("%(minutes)s\u00a0min") % {"minutes": f"{minutes:.0f}"}
    hours = minutes / 60.0
    return _("%(hours)s\u00a0h") % {
        "hours": local(f"{hours:.1f}".removesuffix(".0") if hours < _MANY else f"{hours:.0f}")
    }


_LONG, _MANY = 90.0, 5.0


def name_told(name: str) -> str:
    """Return the name of a field as a label."""
    told = words(name)
    return told[:1].upper() + told[1:]


_ERRANDS_SHOWN = 100
_NAMED = 3
"""Of the objects, galleries or materials that a rule is for: how many the list of rules names."""


@dataclass(frozen=True, slots=True)
class ParameterView:
    """A number of a measure that is installed: its key, what it is, its unit for the reader, what is advised."""

    key: str
    meaning: str
    unit: str
    value: str


@dataclass(frozen=True, slots=True)
class Burn:
    """What is to be measured in a gallery: how many objects, how many of them are measured since, minutes left."""

    gallery: str
    asked: int
    done: int
    minutes: int

    @property
    def percent(self) -> int:
        """Share that is done."""
        return round(100.0 * self.done / self.asked) if self.asked else 100


def search(asked: Asked) -> DeskAnswer:
    """Show the objects that a search finds, the most urgent ones where nothing is asked for."""
    run, query = asked.site.run, asked.query
    words, gallery, state = query.get("q", "")[:200], query.get("gallery", ""), query.get("state", "")
    page = page_number(query)
    narrowed = bool(words.strip() or gallery or state)
    hits = run.found(words, gallery, state) if narrowed else iter(run.urgent)
    found = list(islice(hits, SHOWN * (page - 1), SHOWN * page + 1))
    context = {
        "found": found[:SHOWN], "more": len(found) > SHOWN, "page": page, "q": words, "gallery": gallery,
        "state": state, "galleries": run.gallery_names, "total": len(run.objects),
        "states": run.states, "asked": narrowed, "fragment": asked.site.fragment, "part": asked.fragment,
    }  # fmt: skip
    return DeskAnswer("found.html" if asked.fragment else "search.html", context)


def object_page(asked: Asked) -> DeskAnswer:
    """Show an object."""
    return DeskAnswer("object.html", object_context(asked, asked.query.get("number", "")))


def object_context(
    asked: Asked, object_number: str, *, problem: str = "", typed: Mapping[str, str] | None = None, section: str = ""
) -> dict[str, Any]:
    """Return what an object's page shows, with what somebody entered that could not be saved.

    Parameters
    ----------
    section : str, optional
        Which form is open.

    Returns
    -------
    mapping of str to Any
    """
    facts, run = asked.site.facts(object_number, asked.newest), asked.site.run
    listed = run.by_number.get(object_number)
    query, typed = asked.query, dict(typed or {})
    installable = asked.site.workspace.measures.installable
    named = (typed.get("measure"), query.get("measure"), _advised(facts))
    measure = next((one for one in named if one in installable), next(iter(installable), ""))
    return {
        "facts": facts, "item": facts.item, "o": facts.view, "gallery": facts.gallery, "listed": listed,
        "notes": page_notes(facts.gallery.objects) if facts.gallery else None,
        "decisions": _decided(facts, run), "cells": cells(facts, run.units),
        "recorded": _recorded(facts, run),
        "doubts": [(name_told(p.field), assumed(p.message, run.units), assumed(p.remedy, run.units))
                   for p in facts.item.problems], "problem": problem, "typed": typed,
        "section": section or query.get("open", ""), "saved": query.get("saved", ""),
        "measures": tuple((name, said(one.row.title)) for name, one in installable.items()), "measure": measure,
        "parameters": parameters(asked, facts, measure), "classes": run.class_titles,
        "word_told": word_told, "fragment": asked.site.fragment,
        "findings": _findings(facts), "neighbours": _beside(run, listed), "several_levels": run.several,
    }  # fmt: skip


def _decided(facts: ObjectFacts, run: RunFacts) -> list[tuple[DecisionView, int]]:
    views = Decided(facts.decisions, run.units).all()
    return list(zip(views, (standing.decision.id for standing in facts.decisions), strict=True))


def measure_fields(asked: Asked) -> DeskAnswer:
    """Show the cells of a measure that is said to be installed (htmx)."""
    facts = asked.site.facts(asked.query.get("number", ""))
    context = {"parameters": parameters(asked, facts, asked.query.get("measure", "")), "typed": {}}
    return DeskAnswer("parameters.html", context)


def parameters(asked: Asked, facts: ObjectFacts, measure: str) -> list[ParameterView]:
    """Return the numbers of a measure, with those that are advised for the object."""
    known = asked.site.workspace.measures.installable.get(measure)
    if known is None:
        return []
    units = asked.site.run.units
    advice = facts.assessment.recommendations if facts.assessment else ()
    told = next((dict(r.parameters) for r in advice if r.measure == measure), {})
    return [
        ParameterView(
            q.name, q.meaning, cell_unit(q.unit, units), shown_number(told[q.name], q.unit, units) if q.name in told
            else "",
        )
        for q in known.parameters
    ]  # fmt: skip


def _advised(facts: ObjectFacts) -> str:
    return facts.view.measures[0].measure if facts.view and facts.view.measures else ""


def _findings(facts: ObjectFacts) -> list[tuple[str, str, str]]:
    """Return model, level and title of what the last run found, for whoever accepts or overrules one of them."""
    found = facts.assessment.findings if facts.assessment else ()
    return list(dict.fromkeys((f.model, f.level, said(f.title)) for f in found))


def _recorded(facts: ObjectFacts, run: RunFacts) -> list[tuple[str, str, str]]:
    """Return the record of an object: what, its value in the reader's units, and who says so."""
    item, notes = facts.item, {of.field: of for of in facts.item.provenance}
    texts = ("object_name", "classification", "medium", "dimensions", "gallery", "case")
    # As the cells take them: eighths of an inch, not 12.4 for 12 3/8; what is recorded in centimetres is not rounded.
    written = by_hand(run.units) if run.units.pounds else lambda _name, value, unit: run.units.text(value, unit)
    out = [(name_told(name), str(getattr(item, name)), "") for name in texts if getattr(item, name)]
    for one in measurables():
        value = getattr(item, one.field, None)
        if value is None:
            continue
        shown = (
            word_told(one.field, value)
            if vocabulary(one.field)
            else written(one.field, value, "" if one.unit == "-" else one.unit)
        )
        of = notes.get(one.field)
        # Where in the text it stands, nobody at the desk asks.
        why = of.note.partition("; characters ")[0] if of else ""
        out.append(
            (
                labels()[one.field],
                shown,
                "; ".join(filter(None, (of.written, assumed(why, run.units)))) if of else "",
            )
        )
    return out


def _beside(run: RunFacts, listed: ListedObject | None) -> tuple[str, str]:
    """Return the numbers of the objects before and after one on the way through its gallery."""
    walk = run.in_gallery(listed.gallery) if listed is not None and listed.on_display else []
    at = next((i for i, one in enumerate(walk) if one is listed), None)
    if at is None:
        return "", ""
    return walk[at - 1].number if at else "", walk[at + 1].number if at + 1 < len(walk) else ""


# ---------------------------------------------------------------------------------------------------------------------
# What to measure


def survey(asked: Asked) -> DeskAnswer:
    """Show what is worth measuring: all galleries, or one in walking order with minutes."""
    run, gallery = asked.site.run, asked.query.get("gallery")
    if gallery is None:
        wanted = [name for name in run.order if any(one.asks for one in run.in_gallery(name))]
        burns = [_burn(asked, name) for name in wanted]
        walk = [one for name in wanted for one in run.in_gallery(name) if one.asks]
        missing = sum(one.state == State.UNKNOWN for one in walk)
        context: dict[str, Any] = {"burns": burns, "total": _summed(burns), "lasting": lasting}
        return DeskAnswer("survey.html", context | {"missing": missing, "open": len(walk) - missing})
    walk = [one for one in run.in_gallery(gallery) if one.asks]
    if not walk:
        raise NotThereError(f"there is nothing to measure in {gallery[:60]!r}")
    done = _measured(asked, walk)
    entry = [(one, labels().get(field) or name_of(field), _minutes(field), one.number in done, field) for one in walk
             for field in (one.asks,)]  # fmt: skip
    following = next((one.number for one, *_rest, is_done, _field in entry if not is_done), "")
    context = {"burn": _burn(asked, gallery), "walk": entry, "following": following, "name": gallery}
    context["lasting"] = lasting
    return DeskAnswer("survey_gallery.html", context)


def _measured(asked: Asked, walk: Sequence[ListedObject]) -> set[str]:
    wanted = [one for one in walk if one.asks not in (CLASS, MOUNT)]
    items = items_named(asked.site.workspace.engine, [one.number for one in wanted])
    done = {one.number for one in wanted if one.number in items and getattr(items[one.number], one.asks) is not None}
    named = (one.number for one in walk if one.asks == CLASS)
    return done | {
        number for number in named if any(d.kind is DecisionKind.CLASS for d in in_force(asked.site.log(number)))
    }


def _burn(asked: Asked, gallery: str) -> Burn:
    walk = [one for one in asked.site.run.in_gallery(gallery) if one.asks]
    done = _measured(asked, walk)
    left = sum(_minutes(one.asks) for one in walk if one.number not in done)
    return Burn(gallery, len(walk), len(done), ceil(left))


def _summed(burns: Sequence[Burn]) -> Burn:
    return Burn("", *(sum(getattr(b, name) for b in burns) for name in ("asked", "done", "minutes")))


def _minutes(field: str) -> float:
    known = {row["field"]: float(row["minutes"]) for row in table("minutes")}
    return known.get(field, 5.0)


# ---------------------------------------------------------------------------------------------------------------------
# Errands


def errands(asked: Asked) -> DeskAnswer:
    """Show the errands of the plan in walking order."""
    run, query = asked.site.run, asked.query
    every = errand_entries(asked)
    gallery, whose, state = query.get("gallery", ""), query.get("whose", ""), query.get("state", "")
    chosen = [
        e for e in every
        if gallery in ("", e.errand.gallery) and whose in ("", e.whose) and state in ("", e.state)
        and (e.chosen or e.words)
    ]  # fmt: skip
    page = page_number(query)
    shown = chosen[_ERRANDS_SHOWN * (page - 1) : _ERRANDS_SHOWN * page]
    context = {
        "entries": shown, "page": page, "more": len(chosen) > _ERRANDS_SHOWN * page, "count": len(chosen),
        "gallery": gallery, "whose": whose, "state": state, "lasting": lasting, "trade_word": trade_word,
        "title_of": title_of, "galleries": sorted({e.errand.gallery for e in every}, key=sorting_key),
        "people": sorted({e.whose for e in every if e.whose}),
        "plan": run.plan, "done": sum(e.state == "done" for e in chosen),
    }  # fmt: skip
    return DeskAnswer("errands.html", context)


def errand_entries(asked: Asked) -> list[ErrandEntry]:
    """Return all errands of the plan."""
    plan = asked.site.run.plan
    return [] if plan is None else entries(plan, asked.site.words)


def errand_named(asked: Asked, key: str) -> ErrandEntry:
    """Return an errand.

    Raises
    ------
    NotThereError
        Where the newest plan has none of that key.
    """
    found = next((one for one in errand_entries(asked) if one.key == key), None)
    if found is None:
        raise NotThereError("there is no such errand in the newest plan: it may be done, or its objects moved")
    return found


def errand_page(asked: Asked) -> DeskAnswer:
    """Show an errand, with a row for each of its objects to be ticked off."""
    return DeskAnswer("errand.html", errand_context(asked, asked.query.get("key", "")))


def errand_context(
    asked: Asked, key: str, *, problem: str = "", typed: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Return what an errand's page shows."""
    entry = errand_named(asked, key)
    rows = []
    for one in entry.errand.objects:
        facts = asked.site.facts(one.object_number)
        there = any(
            s.decision.kind is DecisionKind.INSTALLED and s.decision.measure == entry.errand.measure
            for s in facts.decisions
        )
        rows.append((one, facts, parameters(asked, facts, entry.errand.measure), there))
    installable = entry.errand.measure in asked.site.workspace.measures.installable
    return {
        "entry": entry, "rows": rows, "installable": installable and not entry.errand.prepares, "problem": problem,
        "typed": dict(typed or {}), "hours": _hours(entry.errand.hours),
        "cost": priced(spanned(entry.errand.cost), asked.site.workspace.plan_terms.currency),
        "trade_word": trade_word, "title_of": title_of,
        "saved": asked.query.get("saved", ""),
    }  # fmt: skip


def _hours(span: EffortSpan) -> str:
    """Say how long an errand takes, with its range."""
    low, value, high = (lasting(60.0 * one) for one in (span.low, span.value, span.high))
    return value if low == high else _("%(value)s (%(low)s to %(high)s)") % {"value": value, "low": low, "high": high}


# ---------------------------------------------------------------------------------------------------------------------
# House rules


def house(asked: Asked) -> DeskAnswer:
    """Show the house rules, and the form that adds one."""
    return DeskAnswer("house.html", house_context(asked))


def house_context(asked: Asked, *, problem: str = "", typed: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return what the page of house rules shows."""
    run, rules = asked.site.run, asked.site.workspace.settings.house
    # What the form does not offer is not chosen: it would show "all", and count none.
    offered = {"class": run.classes, "gallery": run.galleries, "states": STATED}
    given = {name: asked.query.get(name, "") for name in offered}
    given = {name: text if text in offered[name] else "" for name, text in given.items()} | dict(typed or {})
    states = given.get("states") or "hanging"
    about = [one for one in run.objects if one.on_display and given["class"] in ("", one.object_class)
             and given["gallery"] in ("", one.gallery)]  # fmt: skip
    return {
        "asked": run.rule_questions,
        "rules": [(at, *_rule_words(rule, run.units)) for at, rule in enumerate(rules) if rule.holds],
        "ended": [(*_rule_words(rule, run.units), rule.taken_back_by, rule.taken_back_on, rule.taken_back_why)
                  for rule in rules if not rule.holds],
        "classes": sorted(run.classes, key=class_title), "class_told": class_title, "word_told": word_told,
        "counts": run.classes,
        "galleries": run.gallery_names, "vocabularies": VOCABULARIES, "quantities": QUANTITIES,
        "stated": {name: stated_told(name) for name in STATED}, "states": states,
        "unit": cell_unit(QUANTITIES[states][0], run.units) if states in QUANTITIES else "",
        "supports": tuple(Support), "about": len(about), "typed": given, "problem": problem,
        "version": rules_version(asked.site.config), "saved": asked.query.get("saved", ""),
        "named": bool(given["class"] or given["gallery"]),
    }  # fmt: skip


def _rule_words(rule: HouseRule, units: Units) -> tuple[str, str, str]:
    """Return what a rule is for, what it states in the reader's units, and who says so."""
    told = []
    for name, value in rule.states.values():
        if isinstance(value, Span):
            unit = QUANTITIES[name][0]
            shown = units.text(value.best, unit)
            shown += f" ({units.bare(value.low, value.high, unit)})" if value.low != value.high else ""
        else:
            shown = word_told(name, str(value))
        told.append(f"{stated_told(name)}: {shown}")
    values = {name: getattr(rule, name) for name in CRITERIA if getattr(rule, name)}
    values |= {"object_class": tuple(map(class_title, rule.object_class))} if rule.object_class else {}
    about = [" / ".join(map(str, those[:_NAMED])) + (" …" if len(those) > _NAMED else "") for those in values.values()]
    return "; ".join(about), ", ".join(told), rule.source


def house_fields(asked: Asked) -> DeskAnswer:
    """Show the cells of what a house rule states (htmx)."""
    return DeskAnswer("house_fields.html", house_context(asked))


def galleries(asked: Asked) -> DeskAnswer:
    """Show all galleries with how many objects there are in each state."""
    run = asked.site.run
    rows = [(name, run.galleries[name], run.counts[name], run.sheets(name)) for name in run.order]
    return DeskAnswer("galleries.html", {"rows": rows, "states_of": STATES, "State": State})
