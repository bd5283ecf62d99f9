"""Output to a person: progress bars on a terminal, plain lines elsewhere, one screen at the end."""

import re
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import ExitStack
from math import isnan
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TextIO
from unicodedata import category

from pipeline.operations.event_log import note
from pipeline.quantities import counted, figures

if TYPE_CHECKING:
    from rich.progress import Progress as Bars

    from pipeline.operations.run_summary import Summary
    from pipeline.verification.tradeoff import Tradeoff


_STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)

_COMPILING = "compiling models"


class Console:
    """Reports progress on standard error, so that standard output stays a result.

    Parameters
    ----------
    quiet : bool
        Say nothing but errors.
    verbose : bool
        A line for each step even on a terminal.
    """

    def __init__(self, *, quiet: bool = False, verbose: bool = False) -> None:
        self.quiet = quiet
        self._bars: Bars | None = None
        self._tasks: dict[str, Any] = {}
        self._last: dict[str, int] = {}
        self._plain = verbose or not sys.stderr.isatty()
        self._entered = ExitStack()

    def __enter__(self) -> Self:
        from pipeline.records.protocols import told_of_compiling

        self._entered.enter_context(told_of_compiling(self._compiling))
        if not self.quiet and not self._plain:
            from rich.console import Console as Rich
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

            columns = (TextColumn("{task.description:<16}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
            # To the terminal itself: the bars steer it on purpose.
            self._bars = Progress(*columns, console=Rich(file=sys.__stderr__), transient=True)
            self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._entered.close()
        if self._bars is not None:
            self._bars.stop()

    def _compiling(self, done: int, begun: int) -> None:
        """Say that the models are made ready for this machine, a minute in which nothing else may move."""
        if self._bars is not None:
            self.step(_COMPILING, done, begun)
        elif not (self.quiet or _COMPILING in self._last):
            self._last[_COMPILING] = begun
            print(f"{_COMPILING}: once for each version of Kouros", file=sys.stderr, flush=True)

    def step(self, what: str, done: int, total: int) -> None:
        """Show how much of a step is finished.

        Parameters
        ----------
        what : str
            The pieces that are worked on.
        done, total : int
            How many are finished, and of how many.
        """
        if done in (0, total) and what != _COMPILING:
            note("step", what=what, done=done, total=total)
        if self.quiet:
            return
        if self._bars is not None:
            if what not in self._tasks:
                self._tasks[what] = self._bars.add_task(what, total=total)
            self._bars.update(self._tasks[what], completed=done, total=total)
            return
        # Plain lines: the beginning, every tenth, the end.
        tenth = 10 * done // max(total, 1)
        if self._last.get(what) != tenth:
            self._last[what] = tenth
            print(f"{what}: {done} of {total}", file=sys.stderr, flush=True)


def summary_lines(summary: "Summary") -> list[str]:
    """Return a run's result as lines that fit one screen."""
    width = max(len(f"{summary.on_display:,}"), 5)

    def count(number: int, words: str) -> str:
        return f"  {number:>{width},}  {words}"

    open_ = sum(summary.open_for.values())
    lines = [
        printable(f"{summary.museum or 'Collection'} under {summary.site}"),
        "",
        count(summary.on_display, f"objects on display, in {summary.galleries:,} galleries"),
        count(summary.assessed, f"assessed ({summary.findings:,} findings), of which"),
        count(summary.act, "  to act on: harm is possible or likelier"),
        *([count(summary.check, "    of these, the record is to be checked first")] if summary.check else []),
        count(summary.watch, "  to watch: harm is unlikely"),
        count(summary.fine, "  are fine: harm is very unlikely, or excluded"),
        *([count(open_, "  of these, one measurement may change what is decided")] if open_ else []),
        count(summary.cannot, "cannot be assessed" + (", because this is not recorded:" if summary.cannot else "")),
    ]
    reasons = list(summary.missing.items())
    lines += [f"  {'':>{width}}    {number:>4}  {_short(reason)}" for reason, number in reasons[:5]]
    if len(reasons) > 5:
        lines.append(f"  {'':>{width}}    {sum(n for _, n in reasons[5:]):>4}  for other reasons, named in the report")
    if summary.faults:
        lines.append(
            count(summary.faults, "of all these met a fault of Kouros: see the log, and please tell its makers")
        )
    if len(summary.levels) > 1:
        lines += ["", "  By level of shaking, an object's own state being that at which harm is likeliest:"]
        lines += [
            f"    {printable(level['name'])}: {level['act']:,} to act on, {level['watch']:,} to watch, "
            f"{level['fine']:,} fine"
            for level in summary.levels
        ]
    lines += ["", "  Recommended, each run again and passing, by the best estimates at least:"]
    lines += [count(number, title) for title, number in summary.measures.items()]
    if summary.worth is not None:
        took = f"; finding them took {summary.survey_seconds:.1f} s" if summary.survey_seconds else ""
        noun = "measurement" if summary.worth == 1 else "measurements"
        told = f"{noun} may change what is decided, or make a check possible{took}"
        lines += ["", count(summary.worth, told)]
    lines += effort_lines(summary.efforts)
    if summary.first:
        lines += ["", "  First:", *(f"    {printable(text)}" for text in summary.first)]
    lines += _decision_lines(summary)
    lines += _stored_lines(summary)
    if summary.changes is not None:
        from pipeline.report.pages.news import sentences

        changes = summary.changes
        lines += [
            "",
            *(f"  {printable(sentence)}" for sentence in sentences(changes)),
            f"  Since the last run: {len(changes.added)} objects new, {len(changes.removed)} gone, "
            f"{len(changes.moved)} moved, {len(changes.inputs)} changed; of single checks {len(changes.worsened)} no "
            f"longer pass, {len(changes.fixed)} failed and pass, {len(changes.others)} are otherwise than they were; "
            f"{len(changes.motions)} motions changed",
        ]
    lines += ["", *_reading_lines(summary)]
    if summary.report is not None:
        lines += ["", f"Report: {summary.report}"]
    return lines


def _reading_lines(summary: "Summary") -> list[str]:
    from pipeline.night.reading_summary import in_line, to_look_at, unsaid

    read = summary.reading
    look = "" if read is None or not to_look_at(read) else ": look"
    at = f" at {summary.report.with_name('reading.html')}" if look and summary.report is not None else ""
    lines = [f"  read: {in_line(read)}{look}{at}"]
    if read is not None:
        told = [printable(f"{one['message']}; {one['remedy']}") for one in read["suspicions"]]
        lines += [f"    the whole file: {text}" for text in told]
        chosen = [printable(f"{one['message']}; {one['remedy']}") for one in read.get("choices", ())]
        lines += [f"    settled by choice: {text}" for text in chosen]
        lines += [f"  {unsaid(read['unsaid'])}"] if read["unsaid"] else []
    return lines


def _stored_lines(summary: "Summary") -> list[str]:
    stored, found = summary.objects - summary.on_display, summary.stores
    if not stored:
        return []
    if found is None:
        return ["", f"  not on display: {counted(stored, 'object')}, not assessed (set [display] stores = true)"]
    told = (
        f"{found.act:,} to act on, {found.watch:,} to watch, {found.fine:,} fine, {found.cannot:,} cannot be assessed"
    )
    return ["", f"  not on display, counted apart: {stored:,} objects: {told}"]


def _decision_lines(summary: "Summary") -> list[str]:
    if not summary.decisions:
        return []
    words = {"accept": "risks accepted", "installed": "measures installed", "class": "classes", "verdict": "verdicts"}
    told = ", ".join(f"{words[kind]} {number:,}" for kind, number in summary.decisions.items())
    lines = ["", f"  Decided by people: {told}"]
    shown = summary.doubted[:5]
    lines += [f"    to be looked at again: {_short(printable(text), 160)}" for text in shown]
    if len(summary.doubted) > len(shown):
        lines.append(f"    and {len(summary.doubted) - len(shown):,} more, named in the report")
    return lines


def printable(text: str) -> str:
    """Return text in one line without the characters by which it could steer a terminal.

    Spaces that do not break, as between a number and its unit, are spaces: Python calls them not printable.
    """
    return "".join(c if c.isprintable() else " " if category(c) == "Zs" else "\ufffd" for c in text)


class Guarded:
    """A stream of texts that lets nothing through by which a museum's text could steer a terminal.

    Control characters but for line ends and tabs, marks of writing direction and lone surrogates become U+FFFD, whoever
    writes; JSON writes them as escapes, and loses nothing.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, made harmless."""
        self._stream.write(_STEERING.sub("\ufffd", text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write texts, made harmless."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def effort_lines(efforts: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return by what the verdicts of each model were decided, and how many needed a history at all."""
    if not efforts:
        return []
    lines = ["", f"  {'Decided by':<30}{'bound':>9}{'chart':>9}{'history':>9}{'any history for':>18}"]
    for e in efforts:
        share = e["needing_history"] / max(e["analyses"], 1)
        lines.append(f"    {e['title']:<28}{e['certificate']:>9,}{e['chart']:>9,}{e['history']:>9,}{share:>17.0%}")
    return lines


def _short(text: str, most: int = 84) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"


def tradeoff_lines(found: "Tradeoff", wanted: float) -> list[str]:
    """Return the table of a measurement, and the cheapest setting of each model that keeps the wanted error.

    Parameters
    ----------
    found : Tradeoff
        The measurement.
    wanted : float
        Relative error.

    Returns
    -------
    list of str
        Lines.
    """
    lines = [
        f"Relative error of the first output against ns per object and sample, under {', '.join(found.motions)}",
        f"{'':<34}{'ns':>10}{'median':>10}{'95 %':>10}{'worst':>10}{'wrong outcomes':>16}",
    ]
    for sample in found.samples:
        told = f"{sample.model}: {sample.objects} objects from {sample.source}, {sample.moved} responses counted"
        doubt = f", {sample.sensitive} left out: 1 % of the amplitude would change their outcome"
        lines.append(told + (doubt if sample.sensitive else ""))
        lines += [
            f"    {s.setting:<30}{s.cost:>10.2f}{s.median:>10.1e}{s.p95:>10.1e}{s.worst:>10.1e}{s.wrong or '':>16}"
            for s in found.settings
            if s.model == sample.model
        ]
    lines += ["", f"Cheapest step that keeps {wanted:g} for every object, with every outcome right:"]
    for name, setting in found.cheapest(wanted).items():
        told = "none of these" if setting is None else f"{setting.setting}, {setting.cost:.2f} ns"
        lines.append(f"    {name:<30}{told}")
    if found.probabilities:
        objects = found.probabilities[0].objects
        lines += [
            "",
            f"Probabilities of harm of {objects} objects, against other samples of the same objects:",
            f"{'':<34}{'samples':>10}{'CPU s':>10}{'rms':>10}{'stated':>10}{'worst':>10}{'right words':>16}",
        ]
    lines += [
        f"    {s.setting:<30}{s.samples:>10.0f}{s.seconds:>10.1f}{s.rms:>10.4f}{s.stated:>10.4f}{s.worst:>10.3f}"
        f"{s.right:>16.1%}"
        for s in found.probabilities
    ]
    return lines


def listed(title: str, lines: Sequence[str], most: int = 10) -> None:
    """Print lines of one kind, the first of them only where they are many: JSON has all.

    Parameters
    ----------
    title : str
        What stands above them.
    lines : sequence of str
        What is listed.
    most : int
        How many are printed.
    """
    for line in lines[:most]:
        print(f"  {title}: {printable(line)}")
    if len(lines) > most:
        print(f"  {title}: and {len(lines) - most:,} more (--json lists all)")


def aligned(head: Sequence[str], cells: Sequence[Sequence[str]], words: Collection[int] = ()) -> list[str]:
    """Return a table as lines, its columns as wide as they need.

    Parameters
    ----------
    head : sequence of str
        The columns.
    cells : sequence of sequence of str
        The rows.
    words : collection of int
        Columns that are set to the left; numbers go to the right.

    Returns
    -------
    list of str
        Lines.
    """
    widths = [max(map(len, column)) for column in zip(head, *cells, strict=True)]
    return [
        "  ".join(
            f"{cell:<{w}}" if i in words else f"{cell:>{w}}"
            for i, (cell, w) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in (head, *cells)
    ]


def response_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the rows of `respond` as a table; what is not known is empty."""
    names = list(rows[0])
    words = {i for i, name in enumerate(names) if isinstance(rows[0][name], str)}
    return aligned(names, [[_cell(row[name]) for name in names] for row in rows], words)


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if isnan(value) else figures(value, 6)
    return printable(str(value))
