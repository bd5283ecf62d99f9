"""From what fails to what helps: the least intrusive measure of the table that passes when its models are run again."""

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from pipeline.analysis.context import Context
from pipeline.analysis.figures import chart_key
from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.bench import Bench, Carriage, Trial, checks, passes, why_not
from pipeline.mitigate.means import LAST, STORED, STORED_SENTENCE, STORED_TITLE, Means, Measure, own_means
from pipeline.mitigate.measures import MEASURES, TOGETHER
from pipeline.mitigate.offers import Need, Offer, Proposal, Way
from pipeline.mitigate.shared import SHARED, case_of, company
from pipeline.models import settled_by_room
from pipeline.records import Check, Finding, Mark, Numerics, Recommendation, Scene, Verdict
from pipeline.records.numerics import VERDICTS
from pipeline.tables import TableError

ROOM = ("clearance", "rubber_pads", "restrain")
"""Measures worth advising where only the assumed room leaves the verdict open."""

ONLY_HERE = "At another level of shaking it is not enough, and nothing that was tried is enough at all of them."
"""Follows the sentence of a measure that holds at one level only."""

Unit = tuple[Need, ...]
"""Objects that one measure is for: one, or all that share a support."""


def advise(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    context: Context,
    numerics: Numerics = VERDICTS,
    *,
    means: Means | None = None,
    carriage: Carriage | None = None,
) -> list[list[Recommendation]]:
    """Recommend a measure for each object and level at which something fails, or is open for want of room alone.

    A measure is a changed scene, and it passes where every model of that scene passes under all motions of all levels,
    by the best estimates and at every combination of the ends of its uncertain inputs.  So an object whose sliding
    fails while its rocking is open is not told to keep clear: what is advised also keeps it from rocking.  And what is
    advised for a weak level is built for the strong one too: one measure for all of them.  Only where there is none is
    one sought for each level alone, and its sentence says so.  Where nothing fails and something else than room is
    open, nothing is advised: a measurement may settle that (`pipeline.analysis.survey`).

    levels   : of shaking, with the motions that the findings were made under
    means    : the measures and isolators that there are; None: Kouros's own tables
    context, numerics : as the findings were made
    carriage : what isolators pass on, kept from one call to the next; None: for this call only
    returns  : the recommendations of each scene, in the order of the scenes and of the levels
    raises   : TableError where the last measure of the table is not removal
    """
    have = means or own_means()
    if not have.measures or have.measures[-1].name != LAST:
        raise TableError("measures.csv: the last measure must always be possible (remove)")
    carriage = carriage or Carriage()
    unassessed = _unassessed(scenes, findings)
    rounds = [tuple(levels), *((level,) for level in levels if len(levels) > 1)]
    advised: dict[tuple[int, str], Recommendation] = {}
    for at, some in enumerate(rounds):
        # What holds at all levels stands; the others are looked at level by level.
        stands = {key for key, found in advised.items() if found.measure not in (LAST, STORED)}
        bench = Bench(some, have, context, numerics, carriage)
        search = _Search(bench, _needs(scenes, findings, some, stands), unassessed)
        for done, measure in enumerate(have.measures, start=1):
            search.tries(measure)
            context.progress.step("recommendations", at * len(have.measures) + done, len(rounds) * len(have.measures))
        alone = len(some) < len(levels)
        advised |= {key: _alone(found) if alone else found for key, found in search.recommended.items()}
    return [
        [advised[index, level.name] for level in levels if (index, level.name) in advised]
        for index in range(len(scenes))
    ]


def _alone(found: Recommendation) -> Recommendation:
    return found if found.measure in (LAST, STORED) else replace(found, sentence=f"{found.sentence} {ONLY_HERE}")


def _needs(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    stands: Container[tuple[int, str]],
) -> list[Need]:
    """Return the objects with findings at these levels; for those that stand already nothing more is wanted."""
    names = [level.name for level in levels]
    out = []
    for index, (scene, found) in enumerate(zip(scenes, findings, strict=True)):
        here = tuple(f for f in found if f.level in names)
        wanted = [name for name in names if _wanted([f for f in here if f.level == name])] if _wanted(here) else []
        if here:
            out.append(Need(index, scene, here, tuple(name for name in wanted if (index, name) not in stands)))
    return out


def _wanted(findings: Sequence[Finding]) -> bool:
    return any(f.verdict is Verdict.FAIL for f in findings) or _for_room_alone(findings)


def _for_room_alone(findings: Sequence[Finding]) -> bool:
    still = [f for f in findings if f.verdict is Verdict.UNDETERMINED]
    return bool(still) and all(settled_by_room(f.model) for f in still)


def _unassessed(
    scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]]
) -> Mapping[tuple[str, str], tuple[str, ...]]:
    out: dict[tuple[str, str], tuple[str, ...]] = {}
    for scene, found in zip(scenes, findings, strict=True):
        case = case_of(scene)
        if case is not None and not found:
            out[case] = (*out.get(case, ()), scene.item.object_number)
    return out


@dataclass
class _Search:
    """The objects that still need something under the levels of a bench, and what was tried for them.

    unassessed  : numbers of what no model could be run for, by the case that it stands in
    recommended : by the place of the scene and the name of the level
    """

    bench: Bench
    needs: Sequence[Need]
    unassessed: Mapping[tuple[str, str], tuple[str, ...]]
    recommended: dict[tuple[int, str], Recommendation] = field(default_factory=dict)
    rejected: dict[int, list[str]] = field(default_factory=dict)
    helped: set[int] = field(default_factory=set)

    def tries(self, measure: Measure) -> None:
        """Try a measure on everything that still needs one: all first offers together, then all second ones."""
        pending = [need for need in self.needs if need.wanted and need.index not in self.helped]
        # What is only open for want of room is no reason to take it off display.
        pending = [n for n in pending if measure.name in ROOM or any(f.verdict is Verdict.FAIL for f in n.findings)]
        if measure.name in TOGETHER:
            TOGETHER[measure.name](pending, self.bench, measure)
        open_: list[tuple[Unit, Proposal, Iterator[Offer]]] = []
        for unit in self._units(pending, measure):
            proposal = (
                SHARED[measure.name](unit, self.bench, measure)
                if measure.name in SHARED
                else MEASURES[measure.name](unit[0], self.bench, measure)
            )
            open_.append((unit, proposal, iter(proposal.offers)))
        last: dict[Unit, str] = {}
        while open_:
            open_ = self._round(open_, measure, last)

    def _units(self, pending: Sequence[Need], measure: Measure) -> list[Unit]:
        if measure.name not in SHARED:
            return [(need,) for need in pending]
        cases = {case_of(need.scene) for need in pending} - {None}
        units: list[Unit] = [tuple(n for n in self.needs if case_of(n.scene) == case) for case in cases]
        units += [(need,) for need in pending if case_of(need.scene) is None]
        return sorted(units, key=lambda unit: unit[0].index)

    def _round(
        self, units: Sequence[tuple[Unit, Proposal, Iterator[Offer]]], measure: Measure, last: dict[Unit, str]
    ) -> list[tuple[Unit, Proposal, Iterator[Offer]]]:
        asked = []
        for unit, proposal, offers in units:
            offer = next(offers, None)
            if offer is None:
                self._reject(unit, measure, proposal.reason or last.get(unit, "not enough"))
            else:
                asked.append((unit, proposal, offers, offer))
        found = iter(self.bench.run([trial for *_, offer in asked for trial in offer.every]))
        still = []
        for unit, proposal, offers, offer in asked:
            results = {id(trial): next(found) for trial in offer.every}
            stands = [next((w for w in ways if passes(results[id(w.trial)])), None) for _, ways in offer.stands]
            failing = [trial for trial in offer.trials if not passes(results[id(trial)])]
            held = all(check.passes for _, check in offer.checks)
            if not failing and held and all(way is not None for way in stands):
                self._recommend(unit, measure, offer, [way for way in stands if way is not None], results)
                continue
            last[unit] = _said(failing, offer, results)
            still.append((unit, proposal, offers))
        return still

    def _reject(self, unit: Unit, measure: Measure, reason: str) -> None:
        for need in unit:
            if need.wanted and need.index not in self.helped:
                self.rejected.setdefault(need.index, []).append(f"{measure.title}: {reason}")

    def _recommend(
        self,
        unit: Unit,
        measure: Measure,
        offer: Offer,
        ways: Sequence[Way],
        results: Mapping[int, Sequence[Finding]],
    ) -> None:
        """Record the measure for every object of the unit that needs one.

        What a support does for one object it does for all on it: it takes the place of a lesser measure on each.
        """
        for at, need in enumerate(unit):
            if not need.wanted:
                continue
            ran = [f for trial in offer.trials for f in results[id(trial)]]
            words = dict(offer.words)
            if ways:
                ran += results[id(ways[at].trial)]
                case = case_of(need.scene)
                unknown = self.unassessed.get(case, ()) if case is not None else ()
                words |= {"what": company(unit, need, unknown), "how": ways[at].said}
            numbers = {**offer.numbers, **offer.finish(ran)}
            mine = measure
            if measure.name == LAST and not need.scene.item.on_display:
                mine = replace(measure, name=STORED, title=STORED_TITLE, sentence=STORED_SENTENCE)
            self.helped.add(need.index)
            for level in need.levels:
                here = [f for f in ran if f.level == level]
                before = [f for f in need.findings if f.level == level]
                self.recommended[need.index, level] = Recommendation(
                    object_number=need.number,
                    gallery=need.scene.item.gallery,
                    level=level,
                    measure=mine.name,
                    title=mine.title,
                    sentence=_sentence(mine.sentence, words),
                    parameters={name: value for name, (value, _) in numbers.items()},
                    units={name: unit_ for name, (_, unit_) in numbers.items()},
                    checks=(*(check for of, check in offer.checks if of in ("", level)), *checks(here, before)),
                    rejected=tuple(self.rejected.get(need.index, ())),
                    mark=self._mark(offer, here, measure.title, level),
                    source=measure.source,
                )

    def _mark(self, offer: Offer, ran: Sequence[Finding], title: str, level: str) -> Mark | None:
        if level in offer.marks:
            kind, x, y = offer.marks[level]
            motions = next(one.motions for one in self.bench.levels if one.name == level)
            return Mark(chart_key(kind, motions[0]), x, y, title)
        marks = [f.mark for f in ran if f.model == offer.mark_of and f.mark is not None]
        return replace(marks[0], label=title) if marks else None


def _said(failing: Sequence[Trial], offer: Offer, results: Mapping[int, Sequence[Finding]]) -> str:
    if failing:
        return why_not(failing[0].scene, results[id(failing[0])])
    short: list[Check] = [check for _, check in offer.checks if not check.passes]
    return f"{short[0].title.lower()} is not enough" if short else ""


def _sentence(sentence: str, words: Mapping[str, str]) -> str:
    """Put words into a sentence, whose numbers are filled in later: a brace in them is no placeholder."""

    def said(found: re.Match[str]) -> str:
        text = words.get(found[1])
        return found[0] if text is None else text.replace("{", "{{").replace("}", "}}")

    return re.sub(r"{(\w+)}", said, sentence)
