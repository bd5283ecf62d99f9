"""Response spectra: 200 periods, 5 damping ratios, three components of 20,000 samples, beside pyrotd and eqsig."""

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
        rows.append(Comparison(work, f"eqsig {eqsig.__version__}", seconds, fast, errors, our_errors, 200.0))
    return rows
