"""Response spectra: 200 periods, 5 damping ratios, three components of 20,000 samples, beside pyrotd and eqsig.

eqsig takes one step of the record after the other in numpy, all periods together: what an oscillator costs falls with
their number, from 150 ms alone to 1 ms among 200.  Beside those 200 a hundred times is the most that can be: the C
program of `native` itself takes 0.54 ns a sample.  What its users call is `AccSignal`, which has 100 periods of its own
and refines the record first; that row, with those periods, is the one with an aim.
"""

from typing import Any

import numpy as np

from pipeline.motions.spectra import response_spectra, standard_periods
from pipeline.quantities import Array, G
from pipeline.records import Motion
from tests.benchmarks.common import Comparison, fastest, least, relative, shaking
from tests.benchmarks.peers import peer
from tests.benchmarks.truth import oscillator_peak

DAMPING = np.array([0.01, 0.02, 0.05, 0.1, 0.2])
CHECKED = slice(5, None, 10)
"""The periods, of 200, at which errors are measured."""

QUIET = 2_010
"""Samples of silence at the end: longer than the longest period, so that every peak lies within the record."""


def quiet_end() -> Motion:
    """Return the benchmarks' record with its last 20 s silent."""
    motion = shaking()
    a = motion.acceleration.copy()
    a[:, -QUIET:] = 0.0
    return Motion(motion.dt, a, motion.name)


def comparisons() -> list[Comparison]:
    """Compare the spectral displacements of all three components."""
    motion = quiet_end()
    periods = standard_periods(200)
    w = 2.0 * np.pi / periods
    truth = np.array(
        [[[oscillator_peak(a, motion.dt, f, z) for f in w[CHECKED]] for z in DAMPING] for a in motion.acceleration]
    )

    def ours() -> Array:
        found = response_spectra(motion, periods, DAMPING, "xyz")
        return np.array([found[name].displacement for name in "xyz"])

    oscillators = 3 * DAMPING.size * periods.size
    fast = least(ours, 2) / oscillators
    our_errors = relative(ours()[:, :, CHECKED], truth)
    rows = []
    work = "spectra, 20,000"
    if pyrotd := peer("pyrotd"):
        pyrotd.processes = 1  # by default it starts a process a core; ours runs in one thread here

        def by_fourier() -> Array:
            found = [
                [pyrotd.calc_spec_accels(motion.dt, a / G, 1.0 / periods, z).spec_accel * G / w**2 for z in DAMPING]
                for a in motion.acceleration
            ]
            return np.array(found)

        errors = relative(by_fourier()[:, :, CHECKED], truth)
        seconds = fastest(by_fourier, 2) / oscillators
        rows.append(Comparison(work, f"pyrotd {pyrotd.__version__}", seconds, fast, errors, our_errors, 50.0))
    if eqsig := peer("eqsig"):
        from eqsig.sdof import pseudo_response_spectra

        def by_samples() -> Array:
            found = [
                [pseudo_response_spectra(a, motion.dt, periods, z)[0] for z in DAMPING] for a in motion.acceleration
            ]
            return np.array(found)

        errors = relative(by_samples()[:, :, CHECKED], truth)
        seconds = fastest(by_samples, 2) / oscillators
        rows.append(Comparison(work, f"eqsig {eqsig.__version__}", seconds, fast, errors, our_errors))
        rows.append(_as_it_comes(eqsig, motion))
    return rows


def _as_it_comes(eqsig: Any, motion: Motion) -> Comparison:
    """Compare the spectrum that eqsig gives unasked: 5 % of damping, 100 periods from 0.1 to 5 s."""
    along = motion.acceleration[0]
    signal = eqsig.AccSignal(along, motion.dt)
    theirs = fastest(signal.generate_response_spectrum, 2)
    periods = np.asarray(signal.response_times)

    def ours() -> Array:
        return response_spectra(motion, periods, np.array([0.05]), "x")["x"].displacement[0]

    fast = least(ours, 5)
    truth = np.array([oscillator_peak(along, motion.dt, f, 0.05) for f in 2.0 * np.pi / periods[CHECKED]])
    errors, our_errors = relative(signal.s_d[CHECKED], truth), relative(ours()[CHECKED], truth)
    n = periods.size
    work, name = "spectrum, 20,000", "eqsig AccSignal, as it comes"
    return Comparison(work, name, theirs / n, fast / n, errors, our_errors, 200.0)
