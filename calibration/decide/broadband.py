"""Effects without a phase: broadband torque (wind), and volts of one sector of a motor (a brush)."""

from __future__ import annotations

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.problem import Problem
from calibration.decide.thresholds import FEWEST_BLOCKS, FEWEST_VALIDATED
from calibration.finding import UNKNOWN, Finding, Parameter, deviation
from calibration.statistics.tails import rms_interval, variance_log10
from calibration.statistics.whitening import autocovariance, white_noise

MEAN_S = 1.0  # s, of a mean: far slower than the sensors' noise, faster than friction's history. ASSUMPTION
WHOLE = 0.9  # share of such a mean's rows that must be usable. ASSUMPTION
EVEN = 0.17  # times the sensors' noise per row that the means of white noise have, rms. arithmetic
WIND = 0.9  # times that noise that the means of a wind have, rms: five times EVEN. ASSUMPTION
LONGEST_S = 20.0  # s over which half of the variance is looked for. ASSUMPTION: longer, it is a slow change
FEWEST_TURNS = 3  # turns of the motion, fewest, that tell whether a torque turns over with it. ASSUMPTION
# correlation, part of 1, of a second before a turn with the one after: friction has -1, wind none. ASSUMPTION
OVER = 0.6
LUCK = 3.0  # deviations of that correlation, which scatters by 1 / sqrt(turns) in a quick wind. ASSUMPTION
SURELY = 0.95  # part of 1, that the correlation must reach at most. ASSUMPTION
# cycles of a wind at its correlation time, that its deviation is known by at least. ASSUMPTION
FEWEST_CYCLES = 4.0
# rad/s: quicker, the bristles are saturated, and their history cannot look like wind. ASSUMPTION
SLIDING = 1e-4
FEWEST_HELD = 8  # means of held-out rows, fewest, that must show the same. ASSUMPTION
# times a balance's step that a wind must have, rms. ASSUMPTION: two converters' rounding averages out slowly
STEPS = 2.0
# times the variance squared, a kurtosis: a few hundred gusts of Gaussian wind have 3 +- 0.3. arithmetic
BURSTS = 5.0
VOLTS = 2.0  # times the quiet noise that the volts have, rms. ASSUMPTION
# share: deviation of the power over a turn, of its mean; one sector of sixteen alone has 3.9. ASSUMPTION
SECTOR = 0.6
BINS = 16  # bins of a motor's turn. ASSUMPTION: narrower than a brush
FEWEST_IN_BIN = 20  # rows of a bin, fewest, for its mean. ASSUMPTION


def rate_of(torque: Problem) -> Array:
    """Of the axis, rad/s: what its viscous friction goes by."""
    return torque.base[:, torque.place("viscous")]


def slow_ratio(e: Array, problem: Problem, white: float, rows: Mask, fewest: int = 21) -> float | None:
    """rms of means over MEAN_S over white noise's, while the axis slides; None where means are fewer."""
    rows = rows & (np.abs(rate_of(problem)) > SLIDING)
    size = max(round(MEAN_S / problem.period_s), 2)
    n = len(e) // size * size
    ok = rows[:n].reshape(-1, size).mean(axis=1) > WHOLE
    means = np.where(rows, e, 0.0)[:n].reshape(-1, size).mean(axis=1)[ok]
    return float(np.sqrt(np.mean(means**2)) / max(white, 1e-12)) if len(means) >= fewest else None


def kurtosis(e: Array) -> float:
    """Fourth moment over the variance squared: 3 for a Gaussian."""
    x = e - np.mean(e)
    return float(np.mean(x**4) / max(float(np.mean(x**2)) ** 2, 1e-300))


def unexplained_volts(e: Array, problem: Problem, turns: Array) -> Finding | None:
    """Volts above the sensors' noise in one sector of a motor's `turns` (n,), on all rows: a brush."""
    rows = problem.train
    white = white_noise(e, rows, bursts=False)
    if problem.blocks < FEWEST_BLOCKS or problem.test.sum() < FEWEST_VALIDATED or white <= 0:
        return None
    size, low, high = rms_interval(e[rows], problem.block)
    contrasts = [_contrast(e[k] ** 2, turns[k]) for k in (rows, problem.test)]
    if size < VOLTS * white or min(contrasts) < SECTOR:
        return None
    evidence = variance_log10((size / white) ** 2, rows.sum() / problem.block)
    share, found = 1 - (white / size) ** 2, {"rms": Parameter(size, "V", low, high)}
    note = f"volts {size / white:.1f} times the quiet noise, in a sector of the motor's turn"
    return Finding(UNKNOWN, "E", "motor_angle", evidence=evidence, share=share, note=note, parameters=found)


def _contrast(power: Array, turns: Array) -> float:
    """Spread of the mean power over the sectors of a turn, over its mean; single rows are cut off."""
    power = np.minimum(power, 100 * float(np.median(power)))
    place = ((turns % 1.0) * BINS).astype(np.int64)
    count = np.bincount(place, minlength=BINS)
    if (count > FEWEST_IN_BIN).sum() < BINS // 2:
        return 0.0
    means = (np.bincount(place, power, BINS) / np.maximum(count, 1))[count > FEWEST_IN_BIN]
    return float(np.std(means) / max(float(np.mean(means)), 1e-300))


def wind(e: Array, problem: Problem, white: float) -> Finding | None:
    """A stationary, broadband, slow torque that no domain explains."""
    ratio = slow_ratio(e, problem, white, problem.train)
    held = slow_ratio(e, problem, white, problem.test, FEWEST_HELD)
    if ratio is None or ratio < WIND or (held is not None and held < max(WIND, ratio / 2)):
        return None  # what blows, blows on held-out rows, too
    r = autocovariance(e, problem.train, max(round(LONGEST_S / problem.period_s), 40))
    variance = max(float(r[1] + 0.5 * (r[1] - r[2])), 1e-9)
    below = np.flatnonzero(r < 0.5 * variance)
    time = max(int(below[0]), 1) * problem.period_s / np.log(2) if len(below) else None
    sigma = float(np.sqrt(variance))
    if sigma < STEPS * problem.step:
        return None  # two converters' rounding that a steady motion does not average out
    rows, turns_over = problem.train, follows_direction(e, problem)
    tails, logged_s = kurtosis(e[rows]), float(rows.sum()) * problem.period_s
    evidence = variance_log10((ratio / EVEN) ** 2, logged_s / MEAN_S)
    share = 1 - white**2 / float(np.mean(e[rows] ** 2))
    if tails > BURSTS or turns_over:
        size, low, high = rms_interval(e[rows], problem.block)
        bursts = f"bursts of torque (kurtosis {tails:.0f}; wind is Gaussian, 3)"
        domain, note = "time", f"{bursts} that no angle, speed or reversal explains"
        if turns_over:
            domain = "velocity"
            note = "torque that turns over with the direction: friction of no kind that has a name"
        rms = {"rms": Parameter(size, "N m", low, high)}
        return Finding(UNKNOWN, "T", domain, evidence=evidence, share=share, note=note, parameters=rms)
    turns = FEWEST_CYCLES if time is None else max(logged_s / (2 * np.pi * time), FEWEST_CYCLES)
    found = {"deviation": deviation(sigma, turns, "N m")}
    if time is not None:  # half of the variance is gone: no error known
        found["correlation_time"] = Parameter(float(time), "s")
    return Finding("wind_torque", "T", "time", parameters=found, evidence=evidence, share=share)


def follows_direction(e: Array, problem: Problem) -> bool:
    """Whether a torque turns over where the motion does: wind goes on as it was."""
    rate = rate_of(problem)
    size = max(round(MEAN_S / problem.period_s), 2)
    rows = np.flatnonzero(problem.train & (np.abs(rate) > SLIDING))
    one_run = np.diff(problem.run[rows]) == 0
    turns = np.flatnonzero((rate[rows[1:]] * rate[rows[:-1]] < 0) & one_run)
    pairs = [
        (float(e[rows[max(k + 1 - size, 0) : k + 1]].mean()), float(e[rows[k + 1 : k + 1 + size]].mean()))
        for k in turns.tolist()
    ]
    if len(pairs) < FEWEST_TURNS:
        return False
    a, b = np.array(pairs).T
    over = min(max(OVER, LUCK / np.sqrt(len(pairs))), SURELY)
    return bool(float(a @ b) < -over * np.sqrt(float(a @ a) * float(b @ b)))
