"""The command residual: change of effort less what the incremental PI law makes of set point and velocity.

The loop runs at 5 ms, every second tick is logged: the velocity between is what the absolute encoder moved
less the count. dU = Kp (E - E'') + Ki (E + E'), errors of a tick, the one before, and before that.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from calibration.arrays import Array, Mask, by_median
from calibration.balances import thresholds as limits
from calibration.balances.frame import Frame
from calibration.balances.law import Law, Rate
from calibration.balances.problem import Problem
from calibration.finding import UNKNOWN, Finding
from calibration.statistics.tails import middle, share_log10
from plant.units import ARCSEC

STRAIGHT = 1e-4  # arcsec/s: three units of the set point's Q16; what a position loop adds is more. ASSUMPTION
REGIME = 51  # rows over which the set point's kind is told. ASSUMPTION
CREEP_RATE = 200.0  # arcsec/s, boards/axis/config.py. definition
ROUNDING = float(np.sqrt(2 / 12))  # steps of the effort: of a change between two efforts, each in whole steps
LIMITS = np.geomspace(20.0, 5000.0, 57)  # arcsec/s, a tenth apart: where a law may change (ASSUMPTION)
FEW = 0.03  # of the rows, on one side of such a limit (ASSUMPTION)
EDGE = 0.4  # of the large spikes: smaller ones are no edges of theirs (ASSUMPTION)
REGULAR = 0.6  # fraction of pulses that must keep the period. ASSUMPTION
LEAST_PULSES = 32  # regular spikes, more than which are pulses: a quarter of them is eight. arithmetic


def incremental_law(frame: Frame, held: Mask, own: bool = False) -> Law | None:
    """The law at the log's full rate; None without set point or velocity, or with too few rows.

    `own`: the emulator's boards made the log, whose gains depend on the mode: one regime is looked at.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return None
    window, per_count = frame.scale["velocity_window_s"], frame.scale["velocity_arcsec_per_count"] * ARCSEC
    u = frame.columns["effort"] * frame.scale["effort_full_scale"]
    unit = f"1/{frame.scale['effort_full_scale']:g}"  # of the supply
    v, s = (x * window / per_count for x in (velocity, setpoint))
    between = np.diff(frame.columns["position"] / per_count, prepend=np.nan) - v
    errors = np.column_stack([s - v, s - between])
    base = np.hstack([errors, np.vstack([np.full((1, 2), np.nan), errors[:-1]])])
    y = np.diff(u, prepend=np.nan)
    effort, _ = frame.filled("effort")
    top = float(np.nanmax(np.abs(effort)))
    limited = (np.abs(effort) > limits.AT_LIMIT * top) & (top > limits.LIMITED)
    valid = np.isfinite(y) & np.isfinite(base).all(axis=1) & ~limited & ~resting(setpoint, frame.run)
    valid[1:] &= frame.run[1:] == frame.run[:-1]
    valid &= ~frame.transients()
    if own:
        valid &= usual_regime(setpoint / ARCSEC, valid)
    if valid.sum() < limits.FEWEST_FOR_A_LAW:
        return None
    base = np.where(valid[:, None], base, 0.0)
    labels = [(f"gain_{k}", f"{unit} per count") for k in range(4)]
    problem = Problem(
        channel="S",
        unit=unit,
        y=np.where(valid, y, 0.0),
        base=base,
        base_labels=labels,
        t=frame.t,
        run=frame.run,
        session=frame.session,
        valid=valid,
        held=held,
        period_s=frame.period_s,
        ar_order=4,
        block_s=3.0,
        floor=ROUNDING if np.allclose(u, np.round(u), atol=0.01, equal_nan=True) else 0.0,
    )
    speeds = {"set_point_limit": setpoint, "rate_limit": velocity}
    size = {name: np.abs(np.nan_to_num(x)) / ARCSEC for name, x in speeds.items()}
    rates = {name: Rate(x, likeliest_limit(problem, x), "arcsec/s") for name, x in size.items()}
    return Law(problem=problem, labels=labels, terms=base, rates=rates)


def likeliest_limit(p: Problem, rate: Array) -> list[float]:
    """The LIMIT of `rate` (n,), arcsec/s, at which two laws leave least; none with hardly rows on a side."""
    rows = p.train
    x, y = p.base[rows], p.y[rows]
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
    return [float(LIMITS[max(tried, key=taken)])] if tried else []


def resting(setpoint: Array, run: NDArray[np.int64]) -> Mask:
    """Rows at a zero set point, on the ramp into it, and two after it: there the board follows no rate."""
    s = np.abs(np.nan_to_num(setpoint))
    falling = np.zeros(len(s), dtype=bool)
    falling[:-1] = (s[1:] < s[:-1]) & (run[1:] == run[:-1])
    out: Mask = np.asarray(s == 0.0)
    for k in range(len(s) - 2, -1, -1):
        out[k] |= out[k + 1] and falling[k]
    return np.asarray(maximum_filter1d(out, 3, origin=1, mode="nearest"))


def usual_regime(setpoint: Array, valid: Mask) -> Mask:
    """Rows of the commonest of three sets of gains: set rates, pointing while creeping, pointing faster.

    `setpoint` in arcsec/s. A set rate is constant or a ramp; a position loop corrects it at every tick.
    """
    second = np.full(len(setpoint), np.inf)
    second[1:-1] = np.abs(setpoint[2:] - 2 * setpoint[1:-1] + setpoint[:-2])
    straight = np.convolve((second < STRAIGHT).astype(float), np.ones(REGIME), "same") > REGIME / 2
    creeping = np.abs(setpoint) < CREEP_RATE
    regimes = (straight, ~straight & creeping, ~straight & ~creeping)
    return max(regimes, key=lambda rows: int((rows & valid).sum()))


def pulses(problem: Problem, e: Array) -> Finding | None:
    """Pulses at a fixed period in the residual e (n,), with -log10 p of gaps that regular; None without."""
    rows = problem.train
    x = np.where(rows, e, 0.0)
    sigma = by_median(x[rows]) or 1.0
    limit = 5.0 * sigma
    if (high := np.abs(x[np.abs(x) > limit])).size:  # between its edges a pulse moves the integrator, too
        limit = max(limit, EDGE * float(np.quantile(high, 0.9)))
    spikes = np.where(np.abs(x) > limit, np.sign(x), 0.0)
    count = int(np.abs(spikes).sum())
    if count < limits.FEWEST_SPIKES:
        return None
    sizes = np.abs(x[spikes != 0])
    times = problem.t[spikes > 0]
    gaps = np.diff(times)
    gaps = gaps[gaps > 5 * problem.period_s]
    if len(gaps) < limits.FEWEST_GAPS:
        return None
    period = float(np.median(gaps))
    turns = np.round(gaps / period)
    kept = (np.abs(gaps / period - turns) < limits.OFF_PERIOD) & (turns > 0)
    regular = float(np.mean(kept))
    if regular <= REGULAR or count * regular <= LEAST_PULSES:
        return None
    evidence = share_log10(float(kept.sum()), len(gaps), 0.1)
    share = float(np.sum(sizes**2) / np.sum(x[rows] ** 2))
    note = f"pulses on the command, every {period:.2f} s"
    found = {"size": middle(sizes, problem.unit), "period": middle(gaps[kept] / turns[kept], "s")}
    return Finding(UNKNOWN, "S", "command", evidence=evidence, share=share, note=note, parameters=found)
