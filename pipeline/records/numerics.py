"""Numerics: the fineness at which demands are found, which a result depends on besides object, model and motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

AUTO, CHART = "auto", "chart"
"""The fidelities that choose for each verdict, and for each parameter set, what is looked up and what is integrated."""

SCAN = "scan"
"""The fidelity of what is only looked at, or only an end of a range: the coarsest step, the worst direction as that
finds it, no estimate of the error."""

REFINE = {SCAN: 1, "history": 2, "reference": 16}
"""How much finer than the coarsest step each fidelity integrates."""

TOLERANCE = 1e-3
"""Relative error that a chart's interpolation is granted."""

AZIMUTH_STEP = 10.0
"""Degrees between the directions of which the worst counts when the orientation is unknown (RotD100)."""

SCAN_STEP = 20.0
"""The same of a scan."""


@dataclass(frozen=True, slots=True)
class Numerics:
    """The fineness at which demands are found.

    Attributes
    ----------
    fidelity : str
        Of one run "screen", "bound", "scan", "chart", "history" or "reference"; of verdicts besides the last three
        "auto", which goes from bounds over charts to histories as far as each verdict needs; of pictures, and of ends
        of ranges that no verdict hangs on, "scan".
    azimuth_step : float
        Degrees between the directions of which the worst counts, above 0 and at most 90.
    tolerance : float
        Of a chart's interpolation, relative to max(value, 1 % of the largest value on the chart).
    first : bool
        Whether that tolerance is asked of the model's first output alone.
    """

    fidelity: str = AUTO
    azimuth_step: float = AZIMUTH_STEP
    tolerance: float = TOLERANCE
    first: bool = False

    @property
    def integrated(self) -> Numerics:
        """The same for what is integrated whatever happens: at "reference" where that was asked, else at "history"."""
        return replace(self, fidelity="reference" if self.fidelity == "reference" else "history")

    @property
    def scanning(self) -> Numerics:
        """The same for the ends of a range that no verdict hangs on."""
        return replace(self, fidelity=SCAN, azimuth_step=max(SCAN_STEP, self.azimuth_step))

    def at(self, fidelity: str) -> Numerics:
        """Return the same at another fidelity."""
        return replace(self, fidelity=fidelity)


VERDICTS = Numerics()
"""How verdicts are found unless said otherwise."""

HISTORIES = Numerics("history")
"""Everything integrated."""
