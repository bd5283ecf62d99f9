"""The plan as a page: what to do with the hours and the money there are, errand by errand, to be ticked off."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10

from markupsafe import Markup

from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.mitigate.saying import ANCHORED, AT_BEST, HEAVIEST, SIZED
from pipeline.planning.efforts import TRADES, EffortSpan
from pipeline.planning.errands import Advised, Errand
from pipeline.planning.plan import ErrandPlan
from pipeline.report.language import Language, _, ngettext, said, speaking
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.environment import environment, fill
from pipeline.report.plots.effort_curve import effort_curve
from pipeline.report.text import clean, count, short
from pipeline.report.units import percent, significant

SHOWN = 300
"""Errands on the page: about ten printed pages; the list beside it has all."""

BEGIN = 5
"""Kinds of errands that the first layer names: what is done in one gallery, or one case of it, by one measure."""

DOUBTFUL = 60
"""Errands that take objects from view, on the page."""

FEW = 4
"""Objects that a line of the first layer names."""

_HEAVIEST = re.compile(re.escape(HEAVIEST.partition(";")[0]).replace(re.escape("{heaviest}"), r"[^;]{1,40}?"))
"""What a sentence says of the most that an object may weigh, with the number filled in."""

_CLAUSE = re.compile(r"; |(?<=[^\W\d_A-Z])\. |(?<=\))\. |(?<=。)")
"""Where the words of an advice go on with why it holds, and what to mind."""

NAMED = 8
"""Objects of an errand that are named; of more it says how many."""


@dataclass(frozen=True, slots=True)
class ErrandView:
    """An errand: where, what for, what to do; hours and cost with their ranges, and the share of the loss it avoids.

    Attributes
    ----------
    objects : tuple[tuple[str, str, str], ...]
        Number, short title and place in the report of the first of them.
    more : int
        Objects that are not named.
    first : str
        Title of the errand that has to be done first, "" for none.
    """

    number: int
    gallery: str
    case: str
    title: str
    told: tuple[str, ...]
    objects: tuple[tuple[str, str, str], ...]
    more: int
    trade: str
    hours: str
    hours_span: str
    cost: str
    avoids: str
    first: str = ""


@dataclass(frozen=True, slots=True)
class BeginView:
    """What is done in one gallery, or one case of it, by one measure, in a line."""

    title: str
    gallery: str
    case: str
    objects: tuple[tuple[str, str, str], ...]
    more: int
    trade: str
    hours: str
    avoids: str
    first: str = ""


@dataclass(frozen=True, slots=True)
class PlanView:
    """The plan's page; all texts are ready to be shown.

    Attributes
    ----------
    lede : str
        What is avoided with what there is.
    takes : str
        What the plan takes, with the ranges.
    half : str
        How soon half of it is avoided, "" where nothing is.
    gap : str
        How far from the best choice it may be; "" where it is proven that there is none better.
    left : str
        What no errand avoids.
    trades : tuple[tuple[str, str, str], ...]
        Trade, errands, hours.
    walking : bool
        Whether the errands are in walking order, else what avoids most for an hour comes first.
    hidden : int
        Errands of the plan that are only in the list beside the page.
    away : tuple of ErrandView
        Errands that take objects from view, and how much more they would avoid.
    priced : bool
        Whether costs have a currency.
    """

    lede: str
    takes: str
    half: str
    gap: str
    left: str
    trades: tuple[tuple[str, str, str], ...]
    begin: tuple[BeginView, ...]
    errands: tuple[ErrandView, ...]
    walking: bool
    hidden: int
    total: int
    away: tuple[ErrandView, ...]
    away_hidden: int
    away_avoids: str
    curve: Markup
    priced: bool


def plan_page(plan: ErrandPlan, head: PageHead, language: Language, *, alone: bool = False) -> str:
    """Return the page of a plan as HTML.

    Parameters
    ----------
    plan : ErrandPlan
        What it shows.
    head : PageHead
        Of what run.
    language : Language
        The reader's.
    alone : bool
        Whether it lies outside of a report: it has no links then.
    """
    with speaking(language):
        view = plan_view(plan, linked=not alone, sentences=language.code.partition("-")[0].lower() == "en")
        context = {"museum": head, "plan": view, "here": "plan", "alone": alone, "planned": True}
        return fill(environment(language), "plan.html", context)


def plan_view(plan: ErrandPlan, *, linked: bool = True, sentences: bool = True) -> PlanView:
    """Return what the page of a plan shows.

    Parameters
    ----------
    plan : ErrandPlan
        The plan.
    linked : bool
        Whether objects lead to their entries.
    sentences : bool
        Whether the words of the advice are shown: the exports have them in English only.
    """
    walking = not plan.terms.limits.open
    first = plan.best_first
    # As on the first page of the report, nobody begins with what hardly stands as it is recorded.
    sound = [at for at in first if not plan.errands[at].check]
    listed = sorted(first[:SHOWN]) if walking else first[:SHOWN]
    away = sorted(plan.away, key=lambda at: (-plan.errands[at].avoided, at))
    views = {at: _errand(plan, at, linked=linked, sentences=sentences) for at in (*listed, *away[:DOUBTFUL])}
    return PlanView(
        lede=_lede(plan),
        takes=_takes(plan),
        half=_half(plan),
        gap=_gap(plan),
        left=_left(plan),
        trades=tuple(
            (_TRADES[trade](), count(sum(one.trade == trade for one in plan.chosen)), spanned(hours))
            for trade, hours in plan.by_trade.items()
        ),
        begin=tuple(_begun(plan, places, linked=linked) for places in plan.together(sound)[:BEGIN]),
        errands=tuple(views[at] for at in listed),
        walking=walking,
        hidden=len(first) - len(listed),
        total=len(plan.errands),
        away=tuple(views[at] for at in away[:DOUBTFUL]),
        away_hidden=max(0, len(away) - DOUBTFUL),
        away_avoids=_share(plan.share_of(sum(plan.errands[at].avoided for at in away))),
        curve=_curve(plan),
        priced=bool(plan.terms.currency),
    )


def said_of(errand: Errand) -> tuple[str, ...]:
    """Return the words of an errand's advice: once where they are the same for all its objects, else object by object.

    Of furniture that is fastened for the sake of what is done in it, that alone.
    """
    if errand.prepares:
        return (ANCHORED,)
    words = list(dict.fromkeys(one.sentence for one in errand.objects))
    if len(words) == 1:
        return (words[0],)
    return tuple(f"{one.object_number}: {one.sentence}" for one in errand.objects)


def title_of(errand: Errand) -> str:
    """Return what an errand is called: where sizes are doubtful, that these are checked before it is begun."""
    title = said(clean(errand.title))
    return _("Check the sizes first, then: %(what)s") % {"what": title} if errand.check else title


def number(value: float) -> str:
    """Write hours or a cost with two significant digits: they are judgement, with wide ranges."""
    return count(round(round(value, 1 - floor(log10(value))))) if value >= 99.5 else significant(value, 2)


def given(value: float) -> str:
    """Write hours or a cost that somebody gave, as it is."""
    return count(round(value)) if value >= 99.5 else significant(value, 3)


def priced(amount: str, currency: str) -> str:
    """Return a cost with its currency, where the museum names one."""
    return f"{amount}\u00a0{clean(currency)}" if currency else amount


def trade_word(trade: str) -> str:
    """Return what whoever does an errand is called."""
    return _TRADES[trade]()


def spanned(span: EffortSpan) -> str:
    """Write an amount with its range."""
    if span.low == span.high:
        return number(span.value)
    return _("%(value)s (%(low)s to %(high)s)") % {
        "value": number(span.value),
        "low": number(span.low),
        "high": number(span.high),
    }


def _errand(plan: ErrandPlan, at: int, *, linked: bool, sentences: bool) -> ErrandView:
    one = plan.errands[at]
    named = one.objects[:NAMED]
    told = said_of(one)
    if not sentences:
        told = (said(ANCHORED),) if one.prepares else ()
    return ErrandView(
        number=at + 1,
        gallery=clean(one.gallery),
        case=clean(one.case),
        title=title_of(one),
        told=tuple(clean(_brief(text)) for text in told[:NAMED]),
        objects=tuple(_named(each, linked=linked) for each in named),
        more=len(one.objects) - len(named),
        trade=_TRADES[one.trade](),
        hours=number(one.hours.value),
        hours_span=_("%(low)s to %(high)s") % {"low": number(one.hours.low), "high": number(one.hours.high)},
        cost=priced(number(one.cost.value), plan.terms.currency),
        avoids="" if one.prepares else _share(plan.share_of(one.avoided)),
        first="" if one.needs is None else said(clean(plan.errands[one.needs].title)),
    )


def _begun(plan: ErrandPlan, places: Sequence[int], *, linked: bool) -> BeginView:
    some = [plan.errands[at] for at in places]
    objects = [one for errand in some for one in errand.objects]
    return BeginView(
        title_of(some[0]),
        clean(some[0].gallery),
        clean(some[0].case),
        tuple(_named(one, linked=linked) for one in objects[:FEW]),
        len(objects) - len(objects[:FEW]),
        _TRADES[some[0].trade](),
        number(sum(one.hours.value for one in some)),
        _share(plan.share_of(sum(one.avoided for one in some))),
        "" if some[0].needs is None else said(clean(plan.errands[some[0].needs].title)),
    )


def _named(one: Advised, *, linked: bool) -> tuple[str, str, str]:
    return clean(one.object_number), short(one.title, 60), clean(one.page) if linked else ""


def _brief(sentence: str) -> str:
    """Return what is to be done, without why it holds: the object's entry says that.

    What its numbers hang on stays: the most that an object may weigh is no number to buy a clamp by.
    """
    # That its furniture is fastened first is an errand of its own.
    text = sentence.removeprefix(ANCHORED).strip() or sentence
    told = [_CLAUSE.split(text, maxsplit=1)[0].rstrip(".") + "."]
    heaviest = _HEAVIEST.search(text)
    if heaviest is not None:
        told.append(f"{heaviest[0]}.")
    if NAMED_FIRST in text:
        told.append("Say first what it is.")
    elif heaviest is not None or AT_BEST in text or SIZED in text:
        told.append("Weigh it first.")
    return " ".join(told)


def _share(share: float) -> str:
    """Write a share of the expected loss."""
    if share <= 0.0:
        return percent(0.0)
    return percent(share) if share >= 0.095 else f"{significant(100.0 * share, 2)}\u00a0%"


def _lede(plan: ErrandPlan) -> str:
    limits, avoided = plan.terms.limits, _share(plan.share)
    if not plan.errands:
        return _("Nothing is advised, so there is nothing to plan.")
    if not plan.chosen:
        return _("With what there is nothing can be done that avoids any loss.")
    if limits.open:
        phrase = ngettext(
            "The one errand that helps avoids %(share)s of what an earthquake of this level is expected to cost.",
            "All %(count)s errands together avoid %(share)s of what an earthquake of this level is expected to cost.",
            len(plan.chosen),
        )
        return phrase % {"count": count(len(plan.chosen)), "share": avoided}
    there = []
    if limits.hours is not None:
        there.append(_("%(hours)s hours") % {"hours": given(limits.hours)})
    there += [
        _("%(hours)s hours of a %(trade)s") % {"hours": given(limits.trades[trade]), "trade": _TRADES[trade]()}
        for trade in TRADES
        if trade in limits.trades
    ]
    if limits.cost is not None:
        there.append(_("a cost of %(cost)s") % {"cost": priced(given(limits.cost), plan.terms.currency)})
    told = _("With %(there)s you avoid %(share)s of what an earthquake of this level is expected to cost.")
    return told % {"there": _joined(there), "share": avoided}


def _joined(parts: Sequence[str]) -> str:
    if len(parts) == 1:
        return parts[0]
    return _("%(parts)s and %(last)s") % {"parts": ", ".join(parts[:-1]), "last": parts[-1]}


def _takes(plan: ErrandPlan) -> str:
    if not plan.chosen:
        return ""
    phrase = ngettext(
        "It is %(count)s errand in %(galleries)s, and takes %(hours)s, and %(cost)s for material and outside work.",
        "These are %(count)s errands in %(galleries)s, and take %(hours)s, and %(cost)s for material and outside work.",
        len(plan.chosen),
    )
    rooms = len(plan.choice.galleries)
    galleries = ngettext("%(count)s gallery", "%(count)s galleries", rooms) % {"count": count(rooms)}
    return phrase % {
        "count": count(len(plan.chosen)),
        "galleries": galleries,
        "hours": _("%(hours)s hours (%(low)s to %(high)s)")
        % {"hours": number(plan.hours.value), "low": number(plan.hours.low), "high": number(plan.hours.high)},
        "cost": priced(spanned(plan.cost), plan.terms.currency),
    }


def _half(plan: ErrandPlan) -> str:
    if not plan.terms.limits.open or plan.choice.avoided <= 0.0:
        return ""
    at = next(corner for corner in plan.curve if corner.avoided >= 0.5 * plan.choice.avoided)
    told = _("Half of that is avoided by the first %(hours)s hours, which cost %(cost)s.")
    return told % {"hours": number(at.hours), "cost": priced(number(at.cost), plan.terms.currency)}


def _gap(plan: ErrandPlan) -> str:
    if plan.choice.gap <= 0.0:
        return ""
    told = _("No other choice avoids more than %(share)s of this beyond it.")
    return told % {"share": _share(plan.choice.gap)}


def _left(plan: ErrandPlan) -> str:
    if plan.loss <= 0.0:
        return ""
    told = _(
        "All errands that leave objects in view avoid %(most)s together; the rest of the loss none of them avoids."
    )
    return told % {"most": _share(plan.most)}


def _curve(plan: ErrandPlan) -> Markup:
    if len(plan.curve) < 2 or plan.loss <= 0.0:
        return Markup("")
    hours, limit = plan.hours, plan.terms.limits.hours
    whole = plan.curve[-1].hours
    # The whole curve would press a small plan against its axis.
    reach = max(10.0 * hours.value, 1.1 * hours.high, 2.0 * (limit or 0.0)) if plan.chosen else whole
    most = max(min(whole, reach), hours.high if plan.terms.limits.open else 0.0)
    corners = [(corner.hours, 1.0 - plan.share_of(corner.avoided)) for corner in plan.curve]
    return effort_curve(corners, (hours.value, hours.low, hours.high), 1.0 - plan.share, limit, most)


# Looked up in the language of the page.
_TRADES = {
    "handler": lambda: _("handler"),
    "mount-maker": lambda: _("mount-maker"),
    "engineer": lambda: _("engineer"),
}
