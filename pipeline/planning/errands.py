"""Errands: what is advised for the objects of one case by one measure is one piece of work."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from math import fsum

from pipeline.analysis.stakes import expected_loss, to_check
from pipeline.mitigate.saying import ANCHORED
from pipeline.planning.efforts import Efforts, EffortSpan
from pipeline.quantities import sorting_key
from pipeline.records import Assessment, Recommendation


@dataclass(frozen=True, slots=True)
class Advised:
    """An object to act on, and what is advised for it at the level of shaking that decides.

    Attributes
    ----------
    object_number, title, gallery, case : str
        Of the object.
    measure, measure_title, sentence : str
        Name, title and words of what is advised, numbers filled in.
    loss, left : float
        What is expected to be lost as it stands, and with the measure, in objects of class C.
    page : str
        Page and place of the object in the report; "" where there is none.
    check : bool
        Whether its sizes are to be checked first: what is advised for sizes that nobody believes is not built.
    """

    object_number: str
    title: str
    gallery: str
    case: str
    measure: str
    measure_title: str
    sentence: str
    loss: float
    left: float
    page: str = ""
    check: bool = False

    @property
    def anchored(self) -> bool:
        """Whether it is enough only where its furniture is fastened too."""
        return self.sentence.startswith(ANCHORED)


def loss_left(loss: float, probability: float, remaining: float | None) -> float:
    """Return what is expected to be lost with a measure: the loss in proportion to the harm that remains.

    Parameters
    ----------
    loss : float
        Expected without it.
    probability : float
        Of harm without it.
    remaining : float or None
        Probability of harm that it leaves; None where its checks exclude harm.

    Returns
    -------
    float
        Never more than without it.
    """
    if remaining is None:
        return 0.0
    return loss * min(1.0, remaining / probability) if probability > 0.0 else loss


def deciding(assessment: Assessment) -> Recommendation | None:
    """Return what is advised for an object on display at the level where harm is likeliest; None for nothing."""
    found = assessment.likelihood
    if found is None or not assessment.scene.item.on_display:
        return None
    return next((one for one in assessment.recommendations if one.level == found.level), None)


def advised(assessment: Assessment, sentence: str, page: str = "") -> Advised | None:
    """Return what is advised for an object, None where nothing is or where nobody knows how likely harm is.

    Parameters
    ----------
    assessment : Assessment
        Of the object.
    sentence : str
        Of the recommendation that `deciding` names, with its numbers filled in.
    page : str
        Page and place of the object in the report.
    """
    found, advice = assessment.likelihood, deciding(assessment)
    if found is None or advice is None:
        return None
    item, loss = assessment.scene.item, expected_loss(assessment)
    return Advised(
        item.object_number,
        item.called,
        item.gallery,
        item.case.strip(),
        advice.measure,
        advice.title,
        sentence,
        loss,
        loss_left(loss, found.probability, advice.remaining),
        page,
        to_check(assessment),
    )


@dataclass(frozen=True)
class Errand:
    """A piece of work in one place: one measure, for one object or for all of a case that it is advised for.

    Attributes
    ----------
    gallery, case : str
        Where.
    measure, title : str
        Name and title of the measure.
    trade : str
        Who does it.
    objects : tuple of Advised
        What it is done for; of furniture that is only fastened for what is done in it, what that is done for.
    hours, cost : EffortSpan
        What it takes.
    needs : int or None
        Place in the list of the errand that has to be done first.
    prepares : bool
        Whether it avoids nothing by itself, and something else needs it.
    away : bool
        Whether it takes the objects from view.
    """

    gallery: str
    case: str
    measure: str
    title: str
    trade: str
    objects: tuple[Advised, ...]
    hours: EffortSpan
    cost: EffortSpan
    needs: int | None = None
    prepares: bool = False
    away: bool = False

    @property
    def check(self) -> bool:
        """Whether the sizes of its objects are to be checked before it is begun."""
        return all(one.check for one in self.objects)

    @cached_property
    def loss(self) -> float:
        """What is expected to be lost of its objects without it; 0 where it only prepares."""
        return 0.0 if self.prepares else fsum([one.loss for one in self.objects])

    @cached_property
    def left(self) -> float:
        """What of this is expected to be lost with it."""
        return 0.0 if self.prepares else fsum([one.left for one in self.objects])

    @property
    def avoided(self) -> float:
        """What it avoids."""
        return self.loss - self.left


_Key = tuple[str, str, str, bool, str, bool]
"""Gallery, case, measure, whether its furniture is fastened first, the object where it is in no case, and whether sizes
are to be checked before."""


def errands_of(found: Iterable[Advised], efforts: Efforts, order: Mapping[str, int]) -> tuple[Errand, ...]:
    """Return the errands for objects, in walking order: by gallery, then case, then object number.

    Parameters
    ----------
    found : iterable of Advised
        The objects to act on.
    efforts : Efforts
        What each measure takes.
    order : mapping of str to int
        Place of each gallery on the way; one that is not named comes last.

    Returns
    -------
    tuple of Errand
        What has to be done first stands before what needs it.
    """
    groups: dict[_Key, list[Advised]] = {}
    fastened: dict[_Key, list[Advised]] = {}
    for one in found:
        alone = "" if one.case else one.object_number
        # Furniture is fastened once for all that is in it.
        check = one.check and one.measure != efforts.anchor
        groups.setdefault((one.gallery, one.case, one.measure, one.anchored, alone, check), []).append(one)
        if one.anchored:
            fastened.setdefault((one.gallery, one.case, efforts.anchor, False, alone, False), []).append(one)
    keys = [*groups, *(key for key in fastened if key not in groups)]
    # Galleries, cases and measures are few where objects are many.
    sorting = cache(sorting_key)

    @cache
    def taken(measure: str, objects: int) -> tuple[str, EffortSpan, EffortSpan]:
        row = efforts.of(measure)
        return row.trade, row.hours_of(objects), row.cost_of(objects)

    members = {key: _in_order(groups.get(key) or fastened[key]) for key in keys}

    def walked(key: _Key) -> tuple[int, str, str, str, bool, str, str, bool]:
        gallery, case, measure, anchored, alone, check = key
        # What is in no case is by itself; its furniture is fastened before what is done on it.
        first = sorting_key(members[key][0].object_number)
        place = order.get(gallery, len(order)), sorting(gallery)
        return *place, sorting(case), sorting_key(alone), anchored, first, measure, check

    keys.sort(key=walked)
    at = {key: place for place, key in enumerate(keys)}
    out = []
    for key in keys:
        gallery, case, measure, anchored, alone, check = key
        those = members[key]
        trade, hours, cost = taken(measure, len(those))
        prepares = key not in groups
        title = efforts.titles.get(measure, measure) if prepares else those[0].measure_title
        out.append(
            Errand(
                gallery,
                case,
                measure,
                title,
                trade,
                tuple(those),
                hours,
                cost,
                needs=at[gallery, case, efforts.anchor, False, alone, False] if anchored else None,
                prepares=prepares,
                away=measure in efforts.away,
            )
        )
    return tuple(out)


def _in_order(those: list[Advised]) -> list[Advised]:
    return sorted(those, key=lambda one: sorting_key(one.object_number)) if len(those) > 1 else those
