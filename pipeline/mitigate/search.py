"""The search for what helps: the least intrusive measure that passes when the models of the object are run again."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from pipeline.analysis.assess import assess
from pipeline.analysis.context import Context
from pipeline.analysis.figures import chart_key
from pipeline.analysis.furniture import FurnitureFilter, fastened, filter_of, loose
from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.catalogue import MeasureCatalogue, own_catalogue
from pipeline.mitigate.deficiencies import deficiencies, levels_asked, may_fall, of_unassessed
from pipeline.mitigate.evidence import checks, passes, passes_at_best, shortfall
from pipeline.mitigate.isolation import TransmittedMotions
from pipeline.mitigate.measures import Measure
from pipeline.mitigate.measures.anchor import Anchor
from pipeline.mitigate.measures.base import UNKNOWN_FREQUENCY, bends
from pipeline.mitigate.measures.remove import LAST_RESORTS
from pipeline.mitigate.proposals import (
    UNCONCERNED,
    Candidate,
    Case,
    Deficiency,
    Option,
    Proposal,
    case_of,
    company,
    refused,
)
from pipeline.mitigate.saying import ANCHORED, ONLY_HERE, said_besides
from pipeline.mitigate.trials import HarmAim, Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.records import Finding, Likelihood, Mark, Numerics, Recommendation, Scene, Verdict
from pipeline.records.numerics import VERDICTS
from pipeline.tables.limit_rows import limit
from pipeline.tables.mount_rows import mount_rows

Unit = tuple[Deficiency, ...]
"""Objects that one measure is for: one, or all that share a support."""


def advise(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    context: Context,
    numerics: Numerics = VERDICTS,
    *,
    catalogue: MeasureCatalogue | None = None,
    transmitted: TransmittedMotions | None = None,
    chances: Sequence[Sequence[Likelihood]] | None = None,
    aim: HarmAim | None = None,
) -> list[list[Recommendation]]:
    """Recommend a measure for each object and level at which something fails, or is open for want of room alone.

    A measure is a changed scene, and it passes where every model of that scene passes under all motions of all levels,
    by the best estimates and at every combination of the ends of its uncertain inputs.  So an object whose sliding
    fails while its rocking is open is not told to keep clear: what is advised also keeps it from rocking.  And what is
    advised for a weak level is built for the strong one too: one measure for all of them.  Only where there is none is
    one sought for each level alone, and its sentence says so.  A measure that fastens is also advised where it passes
    by the best estimates only and no other fastening is sure: its sentence says so, and no isolator takes its place.
    Where nothing fails and something else than room is open, nothing is advised: a measurement may settle that
    (`pipeline.analysis.survey`); only furniture that is not fastened and may fall is better fastened.  Where nothing
    helps in such furniture, what helps in it once it is fastened is advised together with fastening it.

    Where it is known how likely harm is, and an aim is given, it is likelihood that asks for a measure: where harm is
    the aim at least.  A measure that passes by the best estimates is enough then if it brings harm below the aim,
    everything that is uncertain being drawn together; what remains is told.

    Parameters
    ----------
    scenes : sequence of Scene
    findings : sequence of sequence of Finding
        Of each scene, under these levels.
    levels : sequence of LevelMotions
        Levels of shaking of the floor, with the motions that the findings were made under.  Measures are tried under
        what the furniture of each object passes on: an isolator stands in it.
    context : Context
        Where trials are run, and who is told how far they are.
    numerics : Numerics, optional
        How finely: as the findings were made.
    catalogue : MeasureCatalogue, optional
        The measures and isolators that there are; Kouros's own where it is left out.
    transmitted : TransmittedMotions, optional
        What isolators pass on, kept from one call to the next.
    chances : sequence of sequence of Likelihood, optional
        Of each scene, how likely it comes to harm at each level.
    aim : HarmAim, optional
        How unlikely harm has to become.

    Returns
    -------
    list of list of Recommendation
        Those of each scene, in the order of the scenes and of the levels.
    """
    have = catalogue or own_catalogue()
    transmitted = transmitted or TransmittedMotions()
    unassessed = of_unassessed(scenes, findings)
    groups: dict[FurnitureFilter | None, list[int]] = {}
    for index, furniture in enumerate(_furniture(scenes)):
        groups.setdefault(furniture, []).append(index)
    out: list[list[Recommendation]] = [[] for _ in scenes]
    for furniture, members in groups.items():
        some, found = [scenes[index] for index in members], [findings[index] for index in members]
        runner = partial(
            TrialRunner,
            isolators=have.isolators,
            context=context,
            numerics=numerics,
            transmitted=transmitted,
            values=have.values,
            furniture=furniture,
            aim=aim,
        )
        likely = None if chances is None or aim is None else [levels_asked(chances[index], aim) for index in members]
        for index, one in zip(members, _advised(some, found, levels, have, runner, unassessed, likely), strict=True):
            out[index] = one
    still = [at for at, scene in enumerate(scenes) if loose(scene) and any(r.measure in LAST_RESORTS for r in out[at])]
    if still:
        # What is advised for a case is for all that stand in it.
        cases = {case_of(scenes[at]) for at in still} - {None}
        all_in = [at for at, scene in enumerate(scenes) if at in still or case_of(scene) in cases]
        firm = [fastened(scenes[at]) if loose(scenes[at]) else scenes[at] for at in all_in]
        _, judged = assess(firm, levels, context.silent, numerics)
        mine = None if chances is None else [chances[at] for at in all_in]
        again = advise(
            firm, judged, levels, context, numerics, catalogue=have, transmitted=transmitted, chances=mine, aim=aim
        )
        starts = tuple(f"{measure.row.title}: " for measure in have.measures if isinstance(measure, Anchor))
        for at, better in zip(all_in, again, strict=True):
            if at in still:
                helped = {one.level: one for one in better if one.measure not in LAST_RESORTS}
                out[at] = [_fastened_too(one, helped.get(one.level), findings[at], starts) for one in out[at]]
    if chances is not None and aim is not None:
        # What was asked for only because its furniture may fall, and is unlikely to be harmed, stays on display.
        for at in still:
            asked = levels_asked(chances[at], aim)
            out[at] = [one for one in out[at] if one.measure not in LAST_RESORTS or one.level in asked]
    return out


def _furniture(scenes: Sequence[Scene]) -> list[FurnitureFilter | None]:
    """Return the furniture that measures for each scene are tried in: of all in one case alike.

    If one of them meets its own frequency among those that the case may have, they all are shaken by it at each.
    """
    each = [filter_of(scene) for scene in scenes]
    meeting = {case_of(scene) for scene, one in zip(scenes, each, strict=True) if one is not None and one.resonant}
    meeting -= {None}
    return [
        replace(one, resonant=True) if one is not None and case_of(scene) in meeting else one
        for scene, one in zip(scenes, each, strict=True)
    ]


def _fastened_too(
    found: Recommendation, better: Recommendation | None, before: Sequence[Finding], starts: tuple[str, ...]
) -> Recommendation:
    """Return what helps in fastened furniture, beside what was found of the object as it stands.

    starts : with what the words begin why fastening its furniture alone is not enough
    """
    if better is None or found.measure not in LAST_RESORTS:
        return found
    demands = {finding.model: finding.demand for finding in before if finding.level == found.level}
    return replace(
        better,
        sentence=f"{ANCHORED} {better.sentence}",
        checks=tuple(
            check if check.before is None else replace(check, before=demands.get(check.model))
            for check in better.checks
        ),
        rejected=(*(text for text in found.rejected if text.startswith(starts)), *better.rejected),
    )


def _advised(
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    have: MeasureCatalogue,
    runner_of: Callable[[Sequence[LevelMotions]], TrialRunner],
    unassessed: Mapping[Case, tuple[str, ...]],
    likely: Sequence[frozenset[str]] | None,
) -> list[list[Recommendation]]:
    """Return what is recommended for scenes that all stand in the same furniture.

    likely : of each the levels at which harm is too likely; None: verdicts ask for measures
    """
    rounds = [tuple(levels), *((level,) for level in levels if len(levels) > 1)]
    advised: dict[tuple[int, str], Recommendation] = {}
    for at, some in enumerate(rounds):
        # What holds at all levels stands; the others are looked at level by level.
        stands = {key for key, found in advised.items() if found.measure not in LAST_RESORTS}
        runner = runner_of(some)
        search = _Search(runner, deficiencies(scenes, findings, some, stands, likely), unassessed)
        for done, measure in enumerate(have.measures, start=1):
            if measure.isolator or measure.last_resort:
                # A platform under it may leave less than a fastening that leaves too much.
                search.settles(enough=bool(measure.isolator) and not measure.mounts)
            search.tries(measure)
            runner.progress.step("recommendations", at * len(have.measures) + done, len(rounds) * len(have.measures))
        alone = len(some) < len(levels)
        advised |= {key: _alone(found) if alone else found for key, found in search.recommended.items()}
    return [
        [advised[index, level.name] for level in levels if (index, level.name) in advised]
        for index in range(len(scenes))
    ]


def _alone(found: Recommendation) -> Recommendation:
    return found if found.measure in LAST_RESORTS else replace(found, sentence=f"{found.sentence} {ONLY_HERE}")


@dataclass(frozen=True)
class _AtBest:
    """A fastening that passes by the best estimates only: of those that leave as much harm the gentlest.

    rejected : what was tried before it, and why not
    """

    unit: Unit
    measure: Measure
    candidate: Candidate
    results: Mapping[int, Sequence[Finding]]
    left: Mapping[int, Mapping[str, Likelihood]]
    rejected: Sequence[str]

    @property
    def remaining(self) -> list[Mapping[str, Likelihood]]:
        """How likely harm is that it leaves, of each trial by level."""
        return [self.left.get(id(trial), {}) for trial in self.candidate.trials]

    @property
    def remains(self) -> float:
        """How likely harm is that it leaves, at the worst level; 0 where nobody drew it."""
        return max((one.expected for each in self.remaining for one in each.values()), default=0.0)


@dataclass
class _Search:
    """The objects that still need something under the levels of a runner, and what was tried for them.

    unassessed  : numbers of what no model could be run for, by the case that it stands in
    recommended : by the place of the scene and the name of the level
    at_best     : the fastening that passes by the best estimates and leaves least, by the place of the scene
    fastened    : places of the scenes for which that stands: no isolator takes its place
    """

    runner: TrialRunner
    objects: Sequence[Deficiency]
    unassessed: Mapping[Case, tuple[str, ...]]
    recommended: dict[tuple[int, str], Recommendation] = field(default_factory=dict)
    rejected: dict[int, list[str]] = field(default_factory=dict)
    helped: set[int] = field(default_factory=set)
    at_best: dict[int, _AtBest] = field(default_factory=dict)
    fastened: set[int] = field(default_factory=set)

    def tries(self, measure: Measure) -> None:
        """Try a measure on everything that still needs one: all first candidates together, then all second ones."""
        pending = [one for one in self.objects if one.wanted and one.index not in self.helped]
        if not self.runner.aims:
            # What is only open for want of room is no reason to take it off display.
            pending = [
                one for one in pending if measure.for_room or any(f.verdict is Verdict.FAIL for f in one.findings)
            ]
        measure.prepare(pending, self.runner)
        open_: list[tuple[Unit, Proposal, Iterator[Candidate]]] = []
        for unit in self._units(pending, measure):
            proposal = self._proposed(unit, measure)
            open_.append((unit, proposal, iter(proposal.candidates)))
        last: dict[Unit, str] = {}
        while open_:
            open_ = self._round(open_, measure, last)

    def _proposed(self, unit: Unit, measure: Measure) -> Proposal:
        mounts = [one.scene.mount for one in unit if one.wanted]
        if not any(mount is None or measure.name in mount_rows()[mount].measures for mount in mounts):
            return refused(N_("it is not for what lies or is held as this is"))
        if measure.isolator and any(_band_unknown(one.scene) for one in unit):
            return UNKNOWN_FREQUENCY
        if measure.isolator and any(may_fall(one.findings) for one in unit):
            return refused(N_("what it would stand in is not fastened and may fall"))
        if measure.fastens and any(_takes_along(one) for one in unit):
            return refused(N_("what it would be fixed to is not fastened and may fall"))
        return measure.propose_shared(unit, self.runner) if measure.shared else measure.propose(unit[0], self.runner)

    def settles(self, *, enough: bool = False) -> None:
        """Let what passes by the best estimates stand, where nothing that fastens is sure.

        Parameters
        ----------
        enough : bool, optional
            Only what leaves as little harm as is wanted.
        """
        for index, found in list(self.at_best.items()):
            if enough and self.runner.aims and not self.runner.reaches_aim(found.remaining):
                continue
            del self.at_best[index]
            if index not in self.helped:
                self.rejected[index] = list(found.rejected)
                self._recommend(found.unit, found.measure, found.candidate, (), found.results, found.left, at_best=True)

    def _units(self, pending: Sequence[Deficiency], measure: Measure) -> list[Unit]:
        if not measure.shared:
            return [(one,) for one in pending]
        cases = {case_of(one.scene) for one in pending} - {None}
        units: list[Unit] = [tuple(one for one in self.objects if case_of(one.scene) == case) for case in cases]
        units += [(one,) for one in pending if case_of(one.scene) is None]
        return sorted(units, key=lambda unit: unit[0].index)

    def _round(
        self, units: Sequence[tuple[Unit, Proposal, Iterator[Candidate]]], measure: Measure, last: dict[Unit, str]
    ) -> list[tuple[Unit, Proposal, Iterator[Candidate]]]:
        asked = []
        for unit, proposal, candidates in units:
            candidate = next(candidates, None)
            if candidate is None and proposal is not UNCONCERNED:
                self._reject(unit, measure, proposal.reason or last.get(unit, N_("not enough")))
            elif candidate is not None:
                asked.append((unit, proposal, candidates, candidate))
        every = [trial for *_, candidate in asked for trial in candidate.every]
        results = {id(trial): found for trial, found in zip(every, self.runner.run(every), strict=True)}
        # What passes by the best estimates is worth drawing; a verdict counts neither the scatter of the models nor,
        # where the mean of the motions decides, that of the motions.
        worth = [trial for trial in every if passes_at_best(results[id(trial)])]
        left = {id(trial): left for trial, left in zip(worth, self.runner.remaining(worth), strict=True)}

        def holds(trials: Sequence[Trial]) -> bool:
            if self.runner.aims:
                return self.runner.reaches_aim([left.get(id(trial), {}) for trial in trials])
            return all(passes(results[id(trial)]) for trial in trials)

        still = []
        for unit, proposal, candidates, candidate in asked:
            # What it does itself and what stands on it harm together.
            own = candidate.trials
            options = [next((o for o in some if holds([*own, o.trial])), None) for _, some in candidate.options]
            failing = [trial for trial in candidate.trials if not holds([trial])]
            held = all(check.passes for _, check in candidate.checks)
            if holds(candidate.trials) and held and all(option is not None for option in options):
                self._recommend(unit, measure, candidate, [one for one in options if one is not None], results, left)
                continue
            if candidate.at_best and held and all(passes_at_best(results[id(t)]) for t in candidate.trials):
                self._keep(unit, measure, candidate, results, left)
            last[unit] = shortfall(failing, candidate, results, left)
            still.append((unit, proposal, candidates))
        return still

    def _keep(
        self,
        unit: Unit,
        measure: Measure,
        candidate: Candidate,
        results: Mapping[int, Sequence[Finding]],
        left: Mapping[int, Mapping[str, Likelihood]],
    ) -> None:
        found = _AtBest(unit, measure, candidate, results, left, ())
        for one in unit:
            kept = self.at_best.get(one.index)
            if kept is None or found.remains < kept.remains:
                before = tuple(self.rejected.get(one.index, ()))
                self.at_best[one.index] = replace(found, unit=(one,), rejected=before)

    def _reject(self, unit: Unit, measure: Measure, reason: str) -> None:
        for one in unit:
            if one.wanted and one.index not in self.helped:
                self.rejected.setdefault(one.index, []).append(f"{measure.row.title}: {reason}")

    def _recommend(
        self,
        unit: Unit,
        measure: Measure,
        candidate: Candidate,
        options: Sequence[Option],
        results: Mapping[int, Sequence[Finding]],
        left: Mapping[int, Mapping[str, Likelihood]],
        *,
        at_best: bool = False,
    ) -> None:
        """Record the measure for every object of the unit that needs one.

        What a support does for one object it does for all on it: it takes the place of a lesser measure on each.
        """
        for at, one in enumerate(unit):
            if not one.wanted or (measure.isolator and one.index in self.fastened):
                continue
            trials = [*candidate.trials, *([options[at].trial] if options else [])]
            ran = [f for trial in trials for f in results[id(trial)]]
            # Without an aim nothing was drawn.
            drawn = [left[id(trial)] for trial in trials if left.get(id(trial))]
            unsure = not all(passes(results[id(trial)]) for trial in trials)
            words = dict(candidate.words)
            if options:
                case = case_of(one.scene)
                unknown = self.unassessed.get(case, ()) if case is not None else ()
                words |= {"what": company(unit, one, unknown), "how": options[at].said}
            numbers = {**candidate.numbers, **candidate.finish(ran)}
            name, title, sentence = measure.called(one.scene.item)
            first, more, added = said_besides(measure, candidate, one, numbers, self.runner, at_best=at_best)
            numbers |= added
            self.helped.add(one.index)
            if measure.fastens:
                self.fastened.add(one.index)
            for level in one.levels:
                here = [f for f in ran if f.level == level]
                before = [f for f in one.findings if f.level == level]
                self.recommended[one.index, level] = Recommendation(
                    object_number=one.number,
                    gallery=one.scene.item.gallery,
                    level=level,
                    measure=name,
                    title=title,
                    sentence=" ".join((*first, _filled(sentence, words).rstrip(), *more)),
                    parameters={key: value for key, (value, _) in numbers.items()},
                    units={key: unit_ for key, (_, unit_) in numbers.items()},
                    checks=(
                        *(check for of, check in candidate.checks if of in ("", level)),
                        *checks(here, before, at_best=at_best or unsure),
                    ),
                    rejected=tuple(self.rejected.get(one.index, ())),
                    mark=self._mark(candidate, here, measure.row.title, level),
                    source=measure.row.source,
                    remaining=min(1.0, sum(one[level].expected for one in drawn)) if drawn else None,
                )

    def _mark(self, candidate: Candidate, ran: Sequence[Finding], title: str, level: str) -> Mark | None:
        if level in candidate.marks:
            kind, x, y = candidate.marks[level]
            shaking = next(one for one in self.runner.levels if one.name == level)
            # Charts are drawn of the motions of the floor.
            return None if shaking.passed_on else Mark(chart_key(kind, shaking.motions[0]), x, y, title)
        marks = [f.mark for f in ran if f.model == candidate.mark_of and f.mark is not None]
        return replace(marks[0], label=title) if marks else None


def _filled(sentence: str, words: Mapping[str, str]) -> str:
    """Put words into a sentence, whose numbers are filled in later: a brace in them is no placeholder."""

    def said(found: re.Match[str]) -> str:
        text = words.get(found[1])
        return found[0] if text is None else text.replace("{", "{{").replace("}", "}}")

    return re.sub(r"{(\w+)}", said, sentence)


def _takes_along(one: Deficiency) -> bool:
    """Say whether what an object would be fixed to is loose, and light enough to be taken along by it."""
    mass = one.scene.parameters.get("mass")
    return mass is not None and mass.value >= limit("takes_along").value and may_fall(one.findings)


def _band_unknown(scene: Scene) -> bool:
    # What an isolator does to an object that bends hangs on how fast it sways: a range of that is no basis for one.
    frequency = scene.parameters.get("frequency")
    return frequency is not None and frequency.low < frequency.high and bends(scene)
