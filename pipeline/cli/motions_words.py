"""Words of what changes when one motion takes another's place."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pipeline.tools.compare_motions import Pair, Swap


def swap_lines(swap: "Swap", most: int = 20) -> list[str]:
    """Return what a swap changes as lines: the measures of each motion, then the verdicts, of which most are listed."""
    lines = [f"from {swap.old}", f"to   {swap.new}"]
    for pair in swap.pairs:
        lines += ["", f"{pair.level}: {pair.before or 'nothing'} -> {pair.after or 'nothing'}"]
        lines += ["  the same samples"] if pair.same else _measure_lines(pair)
    lines += ["", f"Verdicts: {swap.basis}"]
    lines += [f"  {number:>6,}  {words}" for words, number in swap.moved.items()]
    lines += [
        f"  {v.object_number} ({v.gallery}) {v.model}, {v.level}: {v.before or 'none'} -> {v.after or 'none'}"
        for v in swap.verdicts[:most]
    ]
    if len(swap.verdicts) > most:
        lines.append(f"  and {len(swap.verdicts) - most:,} more (--json lists all)")
    if not swap.verdicts and swap.basis.startswith("the "):
        lines.append("  none changes")
    return lines


def _measure_lines(pair: "Pair") -> list[str]:
    from pipeline.report import Units

    units = {"pga": "m/s2", "pgv": "m/s", "pgd": "m", "duration": "s", "pulse_period": "s", "pulse_pgv": "m/s"}
    lines = []
    for name, (before, after) in pair.measures.items():
        unit = next((u for stem, u in units.items() if name.startswith(stem)), "")
        told = [
            ("-" if value is None else Units().text(value, unit) if unit else f"{value:.3g}")
            for value in (before, after)
        ]
        change = f"{after / before - 1:+.1%}" if before and after is not None else ""
        lines.append(f"  {name:<16}{told[0]:>14} -> {told[1]:<14}{change}".rstrip())
    return lines
