"""A disturbance between the logged effort and the amplifier: the volts say what the effort does not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate
from calibration.candidates.electrical import share_of_effort
from calibration.channels.electrical import Electrical
from calibration.channels.frame import Frame, fill
from calibration.channels.motion import Motion
from calibration.readers.run import Array
from calibration.statistics.regression import solve

SLOWEST_HZ = 0.05
FINE = 16  # frequencies per resolution cell of the longest run
PHASES = 17  # tried in each of three searches, each within a step of the one before
LINES = 3  # strongest lines that are tried
STEP_CELLS = 0.05  # of a resolution cell, for the refinement of a frequency


def disturbances(e: Electrical, m: Motion, frame: Frame, residual: Array) -> list[Candidate]:
    """Sines and squares at the strongest fixed frequencies of what is added to the effort, (n,) full rate;
    `residual` (2 n_analysis,) V of the declared model. The phase is every run's own, amplitude in effort
    counts."""
    n = len(m.pick)
    effort = m.at(fill(frame.columns["effort"], frame.run)[0])
    side = np.where(effort > 0, -1.0, 1.0)
    full = frame.scale["effort_full_scale"]
    volts = np.concatenate([side, side]) * share_of_effort(e) * e.supply / full
    weight = np.where(e.problem.valid, volts, 0.0)
    power = weight[:n] ** 2 + weight[n:] ** 2
    seen = power > 0
    if seen.sum() < 1000:
        return []
    added = np.where(seen, (weight * residual)[:n] + (weight * residual)[n:], 0.0) / np.where(seen, power, 1)
    run = frame.run[m.pick]
    hertz, score = spectrum(np.where(e.problem.held[:n], 0.0, added), run, m.period_s)
    cell = 1.0 / (float(np.bincount(run - run.min()).max()) * m.period_s)
    out = []
    for _ in range(LINES):
        k = int(np.argmax(score))
        f0 = float(hertz[k])
        score[np.abs(hertz - f0) < 3 * cell] = 0.0
        if f0 <= 0:
            break
        for square in (False, True):
            shape = _wave(m, frame, added, volts, square)
            out.append(
                Candidate(
                    "command_disturbance",
                    "time",
                    shape(np.array([f0])),
                    (("amplitude", f"1/{full:g}"),),
                    sign=1,
                    frequency=f0,
                    fixed={"frequency": (f0, "Hz"), "shape": (float(square), "0 sine, 1 square")},
                    shape=shape,
                    steps=(STEP_CELLS * cell,),
                    searched=1 + len(frame.runs),
                )
            )
    return out


def spectrum(added: Array, run: NDArray[np.int64], period_s: float) -> tuple[Array, Array]:
    """Hz and the sum over runs of the power of `added` (n,), each over its median."""
    size = 1 << int(np.bincount(run - run.min()).max() * FINE - 1).bit_length()
    hertz = np.fft.rfftfreq(size, period_s)
    score = np.zeros(len(hertz))
    for k in np.unique(run):
        part = added[run == k]
        used = part != 0
        if not used.any():
            continue
        power = np.abs(np.fft.rfft(part - part[used].mean() * used, size)) ** 2
        score = score + power / max(float(np.median(power)), 1e-12)
    score[hertz < SLOWEST_HZ] = 0.0
    return np.asarray(hertz, dtype=np.float64), score


def _phase(x: Array, y: Array, square: bool) -> float:
    """Phase of sin(x + phase), or of its sign, that explains most of y beside a constant on uneven rows."""
    fit = solve(np.column_stack([np.ones(len(x)), np.cos(x), np.sin(x)]), y)
    best = float(np.arctan2(fit[1], fit[2]))
    if not square:
        return best
    y = y - np.mean(y)

    def taken(phase: float) -> float:
        wave = np.sign(np.sin(x + phase))
        wave = wave - np.mean(wave)
        return float(wave @ y) * abs(float(wave @ y)) / max(float(wave @ wave), 1e-300)

    reach = np.pi / 2
    for _ in range(3):  # the fundamental of uneven rows can be off by a good part of a quarter
        best = max(best + reach * np.linspace(-1, 1, PHASES), key=taken)
        reach *= 2.0 / PHASES
    return best


def _wave(m: Motion, frame: Frame, added: Array, volts: Array, square: bool) -> Callable[[Array], Array]:
    """Volts (2 n_analysis, 1) per effort count of a wave at p[0] Hz, in every run with the phase that its own
    rows show."""
    run = frame.run[m.pick]
    t = frame.t[m.pick]

    def shape(p: Array) -> Array:
        x = 2 * np.pi * float(p[0]) * t
        phase = np.zeros(len(frame.t))
        for k in np.unique(run):
            here = run == k
            rows = here & (added != 0)
            if rows.any():
                phase[frame.run == k] = _phase(x[rows], added[rows], square)
        wave = np.sin(2 * np.pi * float(p[0]) * frame.t + phase)
        one = m.at(np.sign(wave) if square else wave)
        return np.asarray(volts * np.concatenate([one, one]))[:, None]

    return shape
