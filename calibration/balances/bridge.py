"""Either motor's duty, and what board, bridges and converters do to a row, where the log shows it.

A register that followed every step would jerk a motor that only holds the counter torque: it may wait. Half a
step of a small effort is some per cent of the volts, as much as a counter torque partly lost.

The loop runs at 5 ms, every second tick is logged, and a winding settles in 2 ms. The current of a row is of
the tick before. That one's effort is the mean of two logged ones plus the gain times its error less the mean
of its neighbours'. The errors are known. The absolute encoder says how far the axis went over the row, the
incremental one what of it fell to the logged tick. Without this a set point that is held over a row passes
for a supply that gives way.
"""

import numpy as np

from calibration.arrays import Array
from calibration.balances.filters import boxcar
from calibration.balances.frame import Frame
from calibration.balances.problem import Problem
from calibration.balances.volts import Windings
from calibration.statistics.regression import Fit, under
from calibration.statistics.thresholds import SURE_Z
from plant.compiled import entry
from plant.units import ARCSEC

MORE = 25.0  # log likelihood that a column must explain beyond the base without it. ASSUMPTION
LARGEST = 300.0  # counts: a rate that leaps between two rows says nothing of the tick between. ASSUMPTION
SLOW_ROWS = 25  # 0.25 s: a disagreement of encoders that lasts is no tick's. ASSUMPTION
RIPPLE = (0.004, 0.03)  # R / (2 L f): L/R of 0.8 to 5 ms and 20 kHz (hardware.md 1.2, 2.4), a quarter of room
# counts that a converter which rounds down reads too low, 0.5 at even spread. ASSUMPTION
TRUNCATION = (0.25, 0.8)
HALF = 0.5  # counts: what such a converter reads too low at even spread. arithmetic
AS_GOOD = 0.1  # of its gain, that it may explain less where it is to stand for all of it. ASSUMPTION


def counter_share(frame: Frame) -> Array:
    """Counter torque of every row (n,), of the effort."""
    share = np.full(len(frame.t), frame.scale["counter_torque"])
    for k, r in enumerate(frame.runs):
        share[frame.run == k] = r.scales["counter_torque"]
    return share


def shares(frame: Frame, effort: Array) -> Array:
    """Part of the effort (n,) that is each motor's duty (2 n,), A before B: all of the leading motor's."""
    counter = counter_share(frame)
    return np.concatenate([np.where(effort > 0, 1.0, counter), np.where(effort > 0, counter, 1.0)])


def duties(frame: Frame, effort: Array) -> Array:
    """Duty of each motor (2 n,), A before B, 0..1."""
    return np.asarray(shares(frame, effort) * np.tile(np.abs(effort), 2))


@entry
def _register(share: Array, fresh: Array) -> Array:
    """The lack (n,), in steps, of a register that waits for a whole step."""
    out = np.zeros(len(share))
    held = 0.0
    for k in range(len(share)):
        if fresh[k] > 0.0 or abs(share[k] - held) >= 1.0:
            held = np.floor(share[k] + 0.5)
        out[k] = held - share[k]
    return out


def register_error(frame: Frame, effort: Array) -> Array:
    """Duty (2 n,) by which a lagging motor's register is off, else zero; `effort` (n,) of the supply."""
    full_scale = frame.scale["effort_full_scale"]
    fresh = np.diff(frame.run, prepend=frame.run[:1] - 1) != 0
    off = _register(np.abs(effort) * full_scale * counter_share(frame), fresh.astype(float)) / full_scale
    return np.asarray(np.concatenate([np.where(side * effort < 0, off, 0.0) for side in (1.0, -1.0)]))


def unlogged_errors(frame: Frame) -> list[Array]:
    """Counts (n,) by which the tick before errs beyond its neighbours: by the motion, by a held set point.

    Without the encoders' slow disagreement. Zero in open loop and beside gaps; none without their columns.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return []
    per_count = frame.scale["velocity_arcsec_per_count"] * ARCSEC
    counted = velocity * frame.scale["velocity_window_s"] / per_count
    wanted = setpoint * frame.scale["velocity_window_s"] / per_count
    moved = _step(frame, frame.filled("position")[0] / per_count)
    slower = 0.5 * (counted + _before(frame, counted)) - (moved - counted)
    lifted = -0.5 * _step(frame, wanted)  # not a number in open loop
    slower, held = (np.where(np.isfinite(lifted) & (np.abs(x) < LARGEST), x, 0.0) for x in (slower, lifted))
    return [np.where(slower != 0.0, slower - boxcar(slower, SLOW_ROWS), 0.0), held]


def _before(frame: Frame, x: Array) -> Array:
    """The row before, NaN at a run's first."""
    first = np.diff(frame.run, prepend=-1) != 0
    return np.where(first, np.nan, np.roll(x, 1))


def _step(frame: Frame, x: Array) -> Array:
    """Change from the row before, NaN at a run's first."""
    return x - _before(frame, x)


def add_bridge(p: Problem, w: Windings, frame: Frame, effort: Array) -> None:
    """Add what the unlogged tick differed by, from motion and held set point, and a register that waits."""
    labels = ("gain_between_rows", "gain_of_held_set_point")
    for error, label in zip(unlogged_errors(frame), labels, strict=False):
        unlogged = duties(frame, effort + error / frame.scale["effort_full_scale"])
        adopt(p, -w.at((unlogged - w.duty) * w.supply), label)
    adopt(p, -w.at(register_error(frame, effort) * w.supply), "held_counter_register")


def adopt(p: Problem, column: Array, label: str, unit: str = "1", least: float = 0.0) -> None:
    """Add a column that explains more than chance, surely positive and above `least`."""
    fit = p.fit(np.column_stack([p.base, column]))
    gained = fit.loglik - under(p.y, p.base, p.train, fit.whitener)
    if gained > MORE and fit.beta[-1] > max(SURE_Z * fit.errors[-1], least):
        p.add((label, unit, column))


def add_sampling(p: Problem, w: Windings, ampere: float) -> None:
    """Add how the converter samples, `ampere` a count, to the base, where the log shows it.

    The current reads V d (1-d) / (2 L f) above its mean, as it is sampled at the PWM's falling edge (paper
    3.3). The converter rounds down, half a count below. Both are bounded; what fits better as a supply
    that gives way is left to that effect.
    """
    columns = {
        "current_ripple": -w.at(w.supply * w.duty * (1 - w.duty)),
        "conversion_offset": np.full(len(p.y), ampere),
        "sag": w.at(w.duty * w.together(w.duty * w.current)),
    }
    richest = np.column_stack([p.base, *columns.values()])
    common = p.fit(richest).whitener

    def fit(*names: str) -> tuple[float, bool]:
        """Log likelihood beside these, and whether what is declared of them has a size that it may have."""
        x = np.column_stack([p.base, *(columns[n] for n in names)])
        f = p.fit(x)
        return under(p.y, x, p.train, common), _sound(p, f, names)

    def add(*names: str) -> None:
        p.add(*((n, "ohm" if n == "conversion_offset" else "1", columns[n]) for n in names))

    (other, _), (without, _) = fit("sag", "conversion_offset"), fit()
    alone, sound = fit("current_ripple", "conversion_offset")
    both, sound_beside = fit("current_ripple", "conversion_offset", "sag")
    as_good = other - alone < AS_GOOD * (alone - without)
    if (as_good and sound) or (both > other + MORE and sound_beside):
        add("current_ripple", "conversion_offset")
        return
    # efforts that hardly differ leave the ripple to the resistance, but not the half count of a converter
    # that rounds down; a supply must explain twice as much to be heard instead
    rounded, sound = fit("conversion_offset")
    if sound and rounded > without + MORE and fit("sag")[0] - rounded < rounded - without:
        add("conversion_offset")


def _sound(p: Problem, fit: Fit, names: tuple[str, ...]) -> bool:
    """Whether ripple and offset, behind the base, are surely there and within their bounds."""
    resistance, at = float(fit.beta[p.place("resistance")]), p.base.shape[1]
    low, high = (part * resistance for part in TRUNCATION)
    bounds = {"current_ripple": RIPPLE, "conversion_offset": (low, high)}
    asked = [(fit.beta[k], fit.errors[k], *bounds[n]) for k, n in enumerate(names, at) if n in bounds]
    return all(low < size < high and size > SURE_Z * error for size, error, low, high in asked)


def mean_currents(frame: Frame, p: Problem, fit: Fit) -> None:
    """Turn sampled currents into mean ones, in place, by what `add_sampling` found in the E channel."""
    found = p.named(fit)
    if "conversion_offset" not in found:
        return
    ripple = found["current_ripple"].value if "current_ripple" in found else 0.0
    ohm = found["resistance"].value
    undo_sampling(frame, ripple / ohm, found["conversion_offset"].value / ohm)


def undo_sampling(frame: Frame, ripple: float, counts: float = HALF) -> None:
    """Make currents means, in place: less `ripple` (A/V) V d (1 - d), plus `counts` of the converter."""
    both = np.split(duties(frame, frame.filled("effort")[0]), 2)
    for key, d in zip("ab", both, strict=True):
        i = frame.columns[f"current_{key}"]
        wrong = ripple * frame.scale["supply_V"] * d * (1 - d) - counts * frame.scale["adc_A_per_count"]
        sound = (i > 0) & ~frame.saturated(i)
        frame.columns[f"current_{key}"] = np.where(sound, i - wrong, i)
