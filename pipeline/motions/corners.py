"""Corner of the high-pass of a raw record: the lowest that its length, noise, source and displacement allow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from pipeline.errors import InputError
from pipeline.motions.doubts import UNDECIDED
from pipeline.motions.filtering import POLES, highpass, pad_seconds, remove_baseline
from pipeline.motions.intensity import integrate, strong_part
from pipeline.motions.onset import first_arrival, samples_before
from pipeline.quantities import Array
from pipeline.records import Motion

CYCLES = 3.0
"""Periods of the corner frequency that a record must hold."""

NOISE_MARGIN = 3.0
"""Least ratio of what is recorded during the event to the noise before it, in the displacement above the corner.

Three in all are two of the event itself over its noise.  All frequencies above the corner count together, each as much
as it moves the ground: between the lines of its spectrum an event is as quiet as the noise, and a gap above 0.5 Hz says
nothing of what is below.

source : Ancheta, T. D. et al. (2013), PEER NGA-West2 database, PEER 2013/03; Boore and Bommer (2005)
"""

DRIFT_SHARE = 0.02
"""Largest polynomial that may be left in the displacement, relative to its peak.

A polynomial of DRIFT_DEGREE follows only what is slower than the record's shaking: a bent or drifting baseline, but not
the coda or the waves of a basin that still run when the record ends.

source : Ramos-Sepulveda, M. E., Brandenberg, S. J., Buckreis, T., Parker, G. A. and Stewart, J. P. (2025), High-pass
         corner frequency selection and review tool for use in ground-motion processing, SRL; the share, the degree and
         the taper as the USGS's gmprocess 2.8.0 (CC0) has them
"""

DRIFT_DEGREE = 5

DRIFT_TAPER = 0.1
"""Share of the record that cosine tapers take before the polynomial is fitted, a twentieth at each end.

Without them the waves that still run at the last sample would bend the polynomial's ends.
"""

DOUBT_SHARE = 0.1
"""Drift with which a lower corner is still possible, where it would change the motion (judgement)."""

DOUBT_PGV = 1.05
"""Ratio of the PGV at two possible corners from which on the record alone does not decide between them (judgement)."""

HIGHEST_CORNER = 1.0
"""Hz: a record that would need a higher corner is not usable for displacement."""

SOURCE_SHARE = 0.1
"""Share of the source's corner frequency below which its velocity has nothing that counts: it falls as f there."""

STEP = 2.0 ** (1.0 / 12.0)
"""Ratio of one corner that is tried to the one before."""

LEAST_NOISE = 5.0
"""s: noise before an arrival that was found is compared with the event when it is at least so long.

Of noise so long the lowest frequency, one over its length, bounds the corner as well: below it nobody knows how much of
the record is noise, and gmprocess, too, takes a ratio of signal to noise from there on only."""


@dataclass(frozen=True, slots=True)
class Corner:
    """A corner for the high-pass of a record.

    Attributes
    ----------
    frequency : float
        In Hz.
    reason : str
        Which of record length, noise, source and displacement decided, with what each of them asked for, and the PGV of
        the larger horizontal channel, unturned and unscaled, at this corner, at half and at double of it.
    """

    frequency: float
    reason: str


def choose_corner(
    motion: Motion,
    pre_event: float | None = None,
    *,
    magnitude: float | None = None,
    cycles: float = CYCLES,
    margin: float = NOISE_MARGIN,
    drift_share: float = DRIFT_SHARE,
) -> Corner:
    """Choose one high-pass corner for the three components of a raw record: the lowest that every reason allows.

    Length, noise and source give the lowest corner that is admissible; from there it rises until the
    displacement holds no drift.  Where a lower one is possible too and gives a PGV that is larger by DOUBT_PGV, the
    record does not decide: the stronger motion is used, and both are told.

    Noise and displacement are looked at in the horizontals only.  Of the vertical nothing but its acceleration is
    used, which a corner hardly changes; what would quiet its displacement would take long periods from the horizontals.

    Parameters
    ----------
    motion : Motion
        A raw record of at least 100 samples.
    pre_event : float or None
        Seconds of noise before the event at the start of the record; None: up to the first arrival, where one is found
        (see `onset.first_arrival`).
    magnitude : float or None
        Of the earthquake; None: not known, and its source asks for nothing.
    cycles : float
        The record must hold so many periods of the corner.
    margin : float
        The displacement above the corner, from Fourier amplitudes in bands of a third of an octave, is at least so many
        times that of the noise; nothing is known below 1 / pre_event, see LEAST_NOISE.
    drift_share : float
        A polynomial fitted to the displacement stays below this share of its peak, see DRIFT_SHARE.

    Returns
    -------
    Corner
        Its frequency in Hz, and what decided.

    Raises
    ------
    InputError
        When a corner above HIGHEST_CORNER would be needed, or a parameter is not usable.

    Notes
    -----
    Error: beside gmprocess 2.8.0 on ten raw records the corner is within a factor of 1.6 on eight, and the PGV within
    3.3 % of that at its corner. On the others, a near-fault and a very weak record, a corner 2.5 and 3.6 times lower is
    used, with a PGV 7 and 66 % larger: the record does not decide, and the stronger motion counts.

    References
    ----------
    Boore, D. M. and Bommer, J. J. (2005), Processing of strong-motion accelerograms: needs, options and consequences,
    SDEE 25, 93-115; Douglas, J. and Boore, D. M. (2011), High-frequency filtering of strong-motion records, BEE 9,
    395-409; Dawood, H. M. et al. (2016), A flatfile for the KiK-net database processed using an automated protocol,
    Earthquake Spectra 32, 1281-1302: noise and displacement as guides.  See DRIFT_SHARE for the polynomial.
    """
    if not (cycles > 0.0 and margin >= 1.0 and 0.0 < drift_share < 1.0):
        raise InputError("choose_corner: cycles must be above 0, margin at least 1, and drift_share between 0 and 1")
    if motion.samples < 100:
        raise InputError(f"choose_corner: a record of {motion.samples} samples is too short to choose a corner from")
    by_length = cycles / motion.duration
    reasons = [f"{cycles:g} periods in {motion.duration:g} s ask for {by_length:.3g} Hz"]
    least, decided = by_length, "record length"
    if magnitude is not None:
        by_source = SOURCE_SHARE * source_corner(magnitude)
        reasons.append(f"a source of magnitude {magnitude:g} sends nothing that counts below {by_source:.3g} Hz")
        if by_source > least:
            least, decided = by_source, "source"
    floor = least
    by_noise, unknown, said = _by_noise(motion, pre_event, margin)
    reasons.append(said)
    if max(by_noise, unknown) > least:
        least, decided = max(by_noise, unknown), "pre-event noise"
    drift = _Drift(motion)
    corner = _settled(drift, least, HIGHEST_CORNER, drift_share)
    possible = []
    # An arrival that was found may be a later wave of the event: what its noise asks for is no certainty, and no more
    # is what a noise too short to tell asks for.
    sure = floor if pre_event is None else max(floor, by_noise)
    if sure < least:
        possible.append(_settled(drift, sure, HIGHEST_CORNER, drift_share))
        if corner is None and possible[0] is not None:
            reasons.append("which no displacement bears out: an arrival within the event was found")
            corner, least, decided = possible[0], floor, "record length"
    if corner is not None:
        possible.append(_settled(drift, max(sure, 0.5 * corner), corner, max(DOUBT_SHARE, drift_share)))
    if corner is None:
        raise InputError(
            f"motion {motion.name!r}: no corner up to {HIGHEST_CORNER:g} Hz is enough ({'; '.join(reasons)}); give "
            f"highpass_hz, correct the baseline first, or use another record"
        )
    if corner > least:
        decided = "displacement drift"
        reasons.append(f"raised from {least:.3g} Hz, where the drift is {drift(least):.1%} of the displacement's peak")
    flat, _ = remove_baseline(motion.acceleration, motion.dt)
    pgv = _fastest(flat, motion.dt, corner)
    fastest = [(_fastest(flat, motion.dt, one), one) for one in possible if one is not None]
    stronger, lower = max(fastest, default=(pgv, corner))
    if stronger > DOUBT_PGV * pgv:
        reasons.append(
            f"{UNDECIDED}{lower:.3g} Hz, with a PGV of {100 * stronger:.3g} cm/s in its larger "
            f"horizontal channel, and {corner:.3g} Hz with {100 * pgv:.3g} cm/s: the stronger motion is used; "
            f"name highpass_hz to decide"
        )
        corner, pgv = lower, stronger
    half, double = (_fastest(flat, motion.dt, share * corner) for share in (0.5, 2.0))
    reasons.append(
        f"the drift is {drift(corner):.1%}, the PGV of the larger horizontal channel {100 * pgv:.3g} cm/s, "
        f"{100 * half:.3g} at half the corner and {100 * double:.3g} at double"
    )
    return Corner(corner, f"{decided}: " + "; ".join(reasons))


def source_corner(magnitude: float) -> float:
    """Return the corner frequency of a source in Hz, for a stress drop of 10 bar: low, so that it hides nothing.

    Parameters
    ----------
    magnitude : float
        Moment magnitude.

    Returns
    -------
    float
        In Hz: 4.9e6 beta (stress drop / moment)^(1/3), with 3.7 km/s, bar and dyne cm.

    References
    ----------
    Brune, J. N. (1970), Tectonic stress and the spectra of seismic shear waves from earthquakes, JGR 75, 4997-5009;
    Hanks, T. C. and Kanamori, H. (1979), A moment magnitude scale, JGR 84, 2348-2350.
    """
    moment = 10.0 ** (1.5 * magnitude + 16.05)
    return float(4.9e6 * 3.7 * (10.0 / moment) ** (1.0 / 3.0))


class _Drift:
    """What drifts in the horizontal displacement of a record at a corner, relative to its peak; the worse component."""

    def __init__(self, motion: Motion) -> None:
        from scipy.signal import detrend
        from scipy.signal.windows import tukey

        self.dt = motion.dt
        taper = tukey(motion.samples, DRIFT_TAPER)
        self.rows = detrend(motion.acceleration[:2], axis=1) * taper
        self.known: dict[float, float] = {}

    def __call__(self, corner: float) -> float:
        if corner not in self.known:
            self.known[corner] = self._found(corner)
        return self.known[corner]

    def _found(self, corner: float) -> float:
        from scipy.fft import next_fast_len

        n, dt = self.rows.shape[1], self.dt
        length = next_fast_len(n + 2 * int(np.ceil(pad_seconds(corner) / dt)), real=True)
        # In the frequency domain, because many corners are tried: the same filter, and its displacement.
        lines = np.fft.rfft(self.rows, length, axis=1)
        f = np.fft.rfftfreq(length, dt)
        f[0] = 1.0
        lines /= -((2.0 * np.pi * f) ** 2) * (1.0 + (corner / f) ** (2 * POLES))
        lines[:, 0] = 0.0
        moved = np.fft.irfft(lines, length, axis=1)[:, :n]
        s = np.linspace(-1.0, 1.0, n)
        out = 0.0
        for row in moved:
            if peak := float(np.abs(row).max()):
                bent = Polynomial.fit(s, row, DRIFT_DEGREE, domain=[-1.0, 1.0])(s)
                out = max(out, float(np.abs(bent).max()) / peak)
        return out


def _settled(drift: _Drift, least: float, most: float, share: float) -> float | None:
    """The lowest corner from one to another whose drift is at most a share; None where there is none."""
    corner = least
    while corner <= most:
        if drift(corner) <= share:
            return corner
        corner *= STEP
    return None


def _fastest(flat: Array, dt: float, corner: float) -> float:
    """The larger horizontal PGV in m/s after the high-pass; the pads belong to the filtered motion (Boore 2005)."""
    if corner >= 0.5 / dt:
        return 0.0
    filtered, _, start = highpass(flat[:2], dt, corner)
    rows = np.vstack([filtered, np.zeros((1, flat.shape[1]))])
    speed, _ = integrate(Motion(dt, rows, start=(float(start[0]), float(start[1]), 0.0)))
    return float(np.abs(speed).max())


def _by_noise(motion: Motion, pre_event: float | None, margin: float) -> tuple[float, float, str]:
    """The corner in Hz that the noise before the event asks for, that below which it knows nothing, and words on both.

    Both are 0 for none.
    """
    if pre_event is None:
        found = first_arrival(motion)
        if found is None or found < LEAST_NOISE:
            return 0.0, 0.0, "no pre-event noise to compare with"
        # What leads to an arrival is noise; a record that is mostly quiet has more of it than is needed.
        end = min(int(found / motion.dt), motion.samples // 2)
        name = f"the {end * motion.dt:.3g} s before an arrival that was found"
        corner = _noise_corner(motion, end, margin)
        if corner is None:
            return 0.0, 0.0, f"no signal {margin:g} times the noise of {name}: it is not used"
    else:
        end = samples_before(motion, pre_event, "pre_event")
        if not 20 <= end <= motion.samples // 2:
            raise InputError(
                f"pre_event {pre_event:g} s holds {end} samples; noise needs at least 20 and at most half the record"
            )
        name = f"the first {pre_event:g} s"
        corner = _noise_corner(motion, end, margin)
        if corner is None:
            raise InputError(
                f"motion {motion.name!r}: the horizontal shaking is nowhere {margin:g} times the noise before it; "
                f"check pre_event, or use another record"
            )
    unknown = 1.0 / (end * motion.dt)
    asked = (
        f"asks for {corner:.3g} Hz" if corner > 0.0 else f"is there down to {unknown:.3g} Hz, below which it is unknown"
    )
    words = f"a signal {margin:g} times the noise of {name} {asked}"
    # A part that is exactly at rest has no noise of any frequency.
    counts = end * motion.dt >= LEAST_NOISE and bool(motion.acceleration[:2, :end].any())
    return corner, unknown if counts else 0.0, words


def _noise_corner(motion: Motion, count: int, margin: float) -> float | None:
    """The frequency in Hz down to which both horizontals stand out from the noise; 0: all the way; None: nowhere."""
    centres, noise = _displacements(motion.acceleration[:2, :count], motion.dt, count)
    # The strong part only: the quiet end of a long record would thin the event out.
    end = max(int(strong_part(motion)[1] / motion.dt) + 1, 2 * count)
    _, signal = _displacements(motion.acceleration[:2, count:end], motion.dt, count)
    worst = 0.0
    for loud, quiet in zip(signal, noise, strict=True):
        silent = quiet == 0.0
        ratio = np.where(silent, np.inf, loud / np.where(silent, 1.0, quiet))
        best = int(np.argmax(ratio))
        if ratio[best] < margin:
            return None
        below = np.flatnonzero(ratio[: best + 1] < margin)
        if below.size:
            worst = max(worst, float(centres[below[-1]]) * 2 ** (1 / 6))
    return worst


def _displacements(data: Array, dt: float, count: int) -> tuple[Array, Array]:
    """Root mean square displacement in and above each third of an octave from 1 / (count dt) up, in any one unit."""
    n = data.shape[1]
    window = np.hanning(n)
    level = data.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.rfft((data - level) * window, axis=1)) ** 2 / float(window @ window)
    frequency = np.fft.rfftfreq(n, dt)
    lowest = 2 ** (1 / 6) / (count * dt)
    centres = lowest * 2 ** (np.arange(max(1, int(np.floor(3 * np.log2(0.4 / dt / lowest))) + 1)) / 3)
    out = np.zeros((data.shape[0], centres.size))
    for k, centre in enumerate(centres):
        inside = (frequency >= centre * 2 ** (-1 / 6)) & (frequency < centre * 2 ** (1 / 6))
        if not inside.any():
            inside[np.argmin(np.abs(frequency - centre))] = True
        # The band is as wide as its centre is high, and the displacement is the acceleration over its square.
        out[:, k] = power[:, inside].mean(axis=1) / centre**3
    return np.asarray(centres, dtype=np.float64), np.sqrt(np.cumsum(out[:, ::-1], axis=1)[:, ::-1])
