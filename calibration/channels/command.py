"""The command residual: change of effort less what the incremental PI law makes of set point and velocity.

The loop runs at 5 ms and every second tick is logged. The velocity of the tick between is what the absolute
encoder
moved over the row less what the logged tick counted. The gains are fitted: dU = Kp (E - E'') + Ki (E + E'),
with
E, E', E'' the errors of the logged tick, the one before and the one before that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate
from calibration.channels.frame import Frame, fill
from calibration.channels.problem import Problem
from calibration.channels.torque import transients
from calibration.readers.run import Array
from calibration.statistics.tails import share_log10
from calibration.statistics.whitening import Mask

ARCSEC_PER_RAD = 206264.806
STRAIGHT = 1e-4  # arcsec/s: three units of the set point's Q16; what a position loop adds is more
REGIME = 51  # rows over which the set point's kind is told
CREEP_RATE = 200.0  # arcsec/s, boards/axis/config.py
ROUNDING = float(np.sqrt(2 / 12))  # steps of the effort: of a change between two efforts, each in whole steps
LIMITS = np.geomspace(20.0, 5000.0, 57)  # arcsec/s, a tenth apart: where a law may change (ASSUMPTION)
FEW = 0.03  # of the rows, on one side of such a limit (ASSUMPTION)
EDGE = 0.4  # of the large spikes: smaller ones are no edges of theirs (ASSUMPTION)
REGULAR = 0.6  # fraction of pulses that must keep the period


def command_problem(
    frame: Frame, held: Mask, own: bool = False
) -> tuple[Problem, tuple[Array, Array]] | None:
    """The problem at the log's full rate, set point and measured rate in arcsec/s; None without set point or
    velocity.

    `own`: the emulator's boards made the log, whose gains depend on the mode: one regime is looked at.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return None
    dt, window = frame.period_s, frame.scale["velocity_window_s"]
    u = frame.columns["effort"] * frame.scale["effort_full_scale"]
    unit = f"1/{frame.scale['effort_full_scale']:g}"  # of the supply
    per_count = frame.scale["velocity_arcsec_per_count"] * 4.84813681e-6
    v = velocity * window / per_count
    theta = frame.columns["position"] / per_count
    moved = np.full(len(u), np.nan)
    moved[1:] = np.diff(theta)
    between = moved - v
    s = setpoint * window / per_count
    error, middle = s - v, s - between
    before = np.full(len(u), np.nan)
    before[1:] = error[:-1]
    before2 = np.full(len(u), np.nan)
    before2[1:] = middle[:-1]
    y = np.full(len(u), np.nan)
    y[1:] = np.diff(u)
    same = np.ones(len(u), dtype=bool)
    same[1:] = frame.run[1:] == frame.run[:-1]
    base = np.column_stack([error, middle, before, before2])
    effort = fill(frame.columns["effort"], frame.run)[0]
    limit = (
        np.abs(effort) > 0.98 * np.nanmax(np.abs(effort))
        if np.nanmax(np.abs(effort)) > 0.9
        else np.zeros(len(u), bool)
    )
    valid = np.isfinite(y) & np.isfinite(base).all(axis=1) & same & ~limit
    near = transients(frame, effort)
    valid &= ~near | (np.abs(effort) > 2)
    valid &= ~resting(setpoint, frame.run)
    if own:
        valid &= usual_regime(setpoint * ARCSEC_PER_RAD, frame.run, valid)
    if valid.sum() < 1000:
        return None
    problem = Problem(
        "S",
        unit,
        np.where(valid, y, 0.0),
        np.where(valid[:, None], base, 0.0),
        [("gain", f"{unit} per count")] * 4,
        frame.t,
        frame.run,
        frame.session,
        valid,
        held,
        dt,
        ar_order=4,
        block_s=3.0,
        sensor="command",
        floor=ROUNDING if np.allclose(u, np.round(u), atol=0.01, equal_nan=True) else 0.0,
    )
    return problem, (np.nan_to_num(setpoint) * ARCSEC_PER_RAD, np.nan_to_num(velocity) * ARCSEC_PER_RAD)


def resting(setpoint: Array, run: NDArray[np.int64]) -> Mask:
    """Rows at a zero set point, on the ramp into it, and two after it: stopping, standing or off, the board
    follows no rate."""
    s = np.abs(np.nan_to_num(setpoint))
    falling = np.zeros(len(s), dtype=bool)
    falling[:-1] = (s[1:] < s[:-1]) & (run[1:] == run[:-1])
    out: Mask = np.asarray(s == 0.0)
    for k in range(len(s) - 2, -1, -1):
        out[k] |= out[k + 1] and falling[k]
    for _ in range(2):
        out[1:] |= out[:-1].copy()
    return out


def usual_regime(setpoint: Array, run: NDArray[np.int64], valid: Mask) -> Mask:
    """Rows of the commonest of three sets of gains: set rates, pointing while creeping, pointing faster.

    `setpoint` in arcsec/s. A set rate is constant or a straight ramp; a position loop corrects its set point
    at every tick (boards/axis/motion.py).
    """
    second = np.full(len(setpoint), np.inf)
    second[1:-1] = np.abs(setpoint[2:] - 2 * setpoint[1:-1] + setpoint[:-2])
    straight = np.convolve((second < STRAIGHT).astype(float), np.ones(REGIME), "same") > REGIME / 2
    creeping = np.abs(setpoint) < CREEP_RATE
    regimes = (straight, ~straight & creeping, ~straight & ~creeping)
    return max(regimes, key=lambda rows: int((rows & valid).sum()))


def command_candidates(problem: Problem, rates: tuple[Array, Array], e: Array) -> list[Candidate]:
    """Lines at fixed Hz (a disturbance on the command), and a law that changes with the set point or with the
    measured rate, `rates` in arcsec/s (no catalogue name)."""
    rows = problem.train
    dt = problem.period_s
    size = 1 << int(np.bincount(problem.run - problem.run.min()).max() - 1).bit_length()
    hertz = np.fft.rfftfreq(size, dt)
    score = np.zeros(len(hertz))
    for k in np.unique(problem.run[rows]):
        power = np.abs(np.fft.rfft(np.where(rows & (problem.run == k), e, 0.0)[problem.run == k], size)) ** 2
        score += power / max(float(np.median(power)), 1e-12)
    score[(hertz < 0.1) | (hertz > 0.49 / dt)] = 0
    out = []
    for _ in range(3):
        k = int(np.argmax(score))
        f0 = float(hertz[k])
        score[max(k - 8, 0) : k + 9] = 0
        shape = _line(problem.t, problem.run, dt)
        out.append(
            Candidate(
                "command_disturbance",
                "time",
                shape(np.array([f0])),
                (("amplitude", problem.unit),),
                kind="line",
                frequency=f0,
                fixed={"frequency": (f0, "Hz")},
                shape=shape,
                steps=(1.0 / (size * dt),),
                per_run=True,
            )
        )
    for name, rate in zip(("set_point_limit", "rate_limit"), rates, strict=True):
        limit = likeliest_limit(problem, np.abs(rate))
        if limit is not None:
            out.append(
                Candidate(
                    "unknown",
                    "command",
                    problem.base * (np.abs(rate) < limit)[:, None],
                    tuple((f"gain_below_{k}", f"{problem.unit} per count") for k in range(4)),
                    fixed={name: (limit, "arcsec/s")},
                )
            )
    return out


def likeliest_limit(problem: Problem, rate: Array) -> float | None:
    """The one of LIMITS of `rate` (n,), arcsec/s, below and above which two laws leave least on training
    rows; None where the log has hardly any rows on one side of every one."""
    rows = problem.train
    x, y = problem.base[rows], problem.y[rows]
    bins = np.digitize(rate[rows], LIMITS)
    count = np.cumsum(np.bincount(bins, minlength=len(LIMITS) + 1))
    parts = [bins == k for k in range(len(LIMITS) + 1)]
    gram = np.cumsum([x[b].T @ x[b] for b in parts], axis=0)
    moment = np.cumsum([x[b].T @ y[b] for b in parts], axis=0)

    def taken(k: int) -> float:  # by the law below the limit, and by the one above
        sides = ((gram[k], moment[k]), (gram[-1] - gram[k], moment[-1] - moment[k]))
        return sum(float(m @ np.linalg.lstsq(g, m, rcond=1e-10)[0]) for g, m in sides)

    least = FEW * count[-1]
    tried = [k for k in range(len(LIMITS)) if least < count[k] < count[-1] - least]
    return float(LIMITS[max(tried, key=taken)]) if tried else None


def _line(t: Array, run: NDArray[np.int64], dt: float) -> Callable[[Array], Array]:
    """Row-to-row change of a sine with a phase of its own in every run (the runs' start times are whole
    seconds)."""

    def shape(p: Array) -> Array:
        x = 2 * np.pi * float(p[0]) * t
        y = x - 2 * np.pi * float(p[0]) * dt
        pair = np.column_stack([np.cos(x) - np.cos(y), np.sin(x) - np.sin(y)])
        return np.hstack([np.where((run == k)[:, None], pair, 0.0) for k in np.unique(run)])

    return shape


@dataclass(frozen=True)
class Pulses:
    """Pulses that come back: sizes (the problem's unit) and gaps (s, in whole periods) as found; `score`
    decides, `evidence` is -log10 p of gaps within a twentieth of the period by chance, `share` of the mean
    square they hold."""

    sizes: Array
    period: float
    gaps: Array
    score: float
    evidence: float
    share: float


def pulses(problem: Problem, e: Array) -> Pulses | None:
    """Pulses at a fixed period in the residual of the command; None without any."""
    rows = problem.train
    x = np.where(rows, e, 0.0)
    sigma = 1.4826 * float(np.median(np.abs(x[rows]))) or 1.0
    limit = 5.0 * sigma
    if (high := np.abs(x[np.abs(x) > limit])).size:  # between its edges a pulse moves the integrator, too
        limit = max(limit, EDGE * float(np.quantile(high, 0.9)))
    spikes = np.where(np.abs(x) > limit, np.sign(x), 0.0)
    count = int(np.abs(spikes).sum())
    if count < 12:
        return None
    sizes = np.abs(x[spikes != 0])
    times = problem.t[spikes > 0]
    gaps = np.diff(times)
    gaps = gaps[gaps > 5 * problem.period_s]
    if len(gaps) < 6:
        return None
    period = float(np.median(gaps))
    turns = np.round(gaps / period)
    kept = (np.abs(gaps / period - turns) < 0.05) & (turns > 0)
    regular = float(np.mean(kept))
    if regular <= REGULAR:
        return None
    share = float(np.sum(sizes**2) / np.sum(x[rows] ** 2))
    chance = share_log10(float(kept.sum()), len(gaps), 0.1)
    return Pulses(sizes, period, gaps[kept] / turns[kept], count * regular / 4, chance, share)
