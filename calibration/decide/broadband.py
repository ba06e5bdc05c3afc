"""Effects without a phase: broadband torque (wind), and lines of the full rate (pick-up)."""

from __future__ import annotations

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.frame import Frame, fill
from calibration.balances.problem import Problem
from calibration.decide.thresholds import FEWEST_BLOCKS, FEWEST_VALIDATED
from calibration.finding import UNKNOWN, Finding, Parameter, deviation
from calibration.statistics.tails import middle as middle_of
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

# --- a line on the currents

# times the median power: noise of 60 000 rows reaches 16 by arithmetic, a motor's harmonics more. ASSUMPTION
PEAK = 400.0
COUNTS = 0.8  # counts of the converter, amplitude: a smaller line is a beat of quantised columns. ASSUMPTION
FASTEST_BAND_HZ = 15.0  # Hz: slower, it is within the analysis band, or a motor's. ASSUMPTION
# Hz within which the runs' lines are the same one. ASSUMPTION: the bins of a run of seven seconds
SAME_HZ = 0.15
CALM_A = 0.1  # A per row: a current that changes faster is a transient. ASSUMPTION
FLOWS_A = 0.05  # A: a smaller current is cut off at zero. ASSUMPTION: eight counts
FEWEST_ROWS = 1000  # rows of a run, fewest, for a spectrum. ASSUMPTION


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


def pick_up(frame: Frame) -> Finding | None:
    """A line at fixed Hz on the currents that keeps its frequency in every run, beyond the analysis band."""
    if frame.get("current_a") is None:
        return None
    same = np.zeros((0, 5))
    for name in ("current_a", "current_b"):
        found = _lines(frame, name)
        strong = found[(found[:, 1] > PEAK) & (found[:, 2] > COUNTS * frame.scale["adc_A_per_count"])]
        if len(strong) < max(3, len(found) // 2):
            continue
        near = strong[np.abs(strong[:, 0] - np.median(strong[:, 0])) < SAME_HZ]
        if len(near) >= 0.7 * len(strong) and len(near) > len(same):
            same = near
    if not len(same):
        return None
    hertz, power, size, share, bins = same.T
    middle, rate = float(np.median(hertz)), 1 / frame.period_s
    return Finding(
        UNKNOWN,
        "E",
        "time",
        frequency=middle,
        # a bin of a periodogram over its median is exponential with mean 1/ln 2; so many bins were looked at
        evidence=float(np.sum((power * np.log(2) - np.log(bins)) / np.log(10))),
        share=float(np.median(share)),
        note=f"a line at {middle:.2f} Hz on the currents at every speed (sampled at {rate:.0f} Hz)",
        parameters={"amplitude": middle_of(size, "A")},
    )


def _lines(frame: Frame, name: str) -> Array:
    """The strongest fast line of a current in every run (n, 5).

    Hz, power over the median, amplitude in A, share of the fast current's variance, bins looked at.
    """
    out = []
    dt = frame.period_s
    x, ok = fill(frame.columns[name], frame.run)
    for k in np.unique(frame.run):
        rows = frame.run == k
        part = x[rows] - np.convolve(np.pad(x[rows], 4, mode="edge"), np.ones(9) / 9, "valid")
        busy = np.abs(np.gradient(x[rows])) < CALM_A
        part = np.where(ok[rows] & busy & (x[rows] > FLOWS_A), part, 0.0)
        used = int(np.count_nonzero(part))
        if used < FEWEST_ROWS:
            continue
        power = np.abs(np.fft.rfft(part)) ** 2
        hertz = np.fft.rfftfreq(len(part), dt)
        power[hertz < FASTEST_BAND_HZ] = 0.0
        j = int(np.argmax(power))
        level = float(np.median(power[hertz > FASTEST_BAND_HZ])) or 1e-30
        amplitude = 2 * float(np.sqrt(power[j])) / used
        share = amplitude**2 / 2 / max(float(np.sum(part**2)) / used, 1e-300)
        bins = int(np.sum(hertz > FASTEST_BAND_HZ))
        out.append((float(hertz[j]), float(power[j] / level), amplitude, min(share, 1.0), bins))
    return np.array(out).reshape(-1, 5)
