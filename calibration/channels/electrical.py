"""The electrical residual: duty times supply less R i less K omega, both motors stacked.

A motor pulls one way only; its back-EMF counts while it turns the way it pulls (a motor that is dragged
backwards has
none unless its freewheel diode conducts, which is the effect `diode_braking`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.channels.between import unlogged_errors
from calibration.channels.frame import Frame, fill
from calibration.channels.motion import Motion
from calibration.channels.problem import Problem
from calibration.channels.register import register_error
from calibration.channels.torque import STEP, saturated, transients
from calibration.declaredplant import Declared
from calibration.readers.run import Array
from calibration.statistics.regression import gls, under
from calibration.statistics.whitening import Mask

APART = 0.75  # counts of the tachometer per row, five times what rounding leaves after the means (0.15)
CLIPPED = (
    4.0  # counts expected: below it the converter's noise is cut off at zero and its mean is not the current
)
RIPPLE = (0.004, 0.03)  # R / (2 L f): L/R of 0.8 to 5 ms and 20 kHz (hardware.md 1.2, 2.4), a quarter of room
TRUNCATION = (0.25, 0.8)  # counts that a converter which rounds down reads too low, 0.5 at even spread
SURE = 4.0  # standard errors
MORE = 25.0  # log likelihood that the converter must explain beyond what a supply that gives way explains
AS_GOOD = 0.1  # of its gain, that it may explain less where it is to stand for all of it


@dataclass
class Electrical:
    """The E problem and the columns its candidates are made of, all (2 n,): motor A's rows, then motor
    B's."""

    problem: Problem
    duty: Array
    current: Array  # A
    pulling: Array  # rad/s of the motor, wind-up included, while it turns the way it pulls, else zero
    dragged: Array  # rad/s of the motor while it is dragged backwards, else zero
    sum_power: Array  # A, sum over motors of duty times current
    lagging: Array  # 1 where the motor holds the counter torque
    motor: Array  # 0 for A, 1 for B
    supply: Array  # V
    resistance: float
    constant: float  # V s/rad
    constant_error: float  # standard error of the constant
    ampere_per_count: float


def electrical_problem(
    frame: Frame, m: Motion, held: Mask, declared: Declared, softness: float | None = None
) -> Electrical | None:
    """Build the E channel; None when the log lacks a current. `softness`: rad of the axis that an ampere
    winds a train up by, the declared one without it."""
    if frame.get("current_a") is None or frame.get("current_b") is None:
        return None
    n, ratio = len(m.pick), frame.scale["gear_ratio"]
    effort, te = fill(frame.columns["effort"], frame.run)
    supply_column = frame.get("supply")
    supply = (
        fill(supply_column, frame.run)[0]
        if supply_column is not None
        else np.full(len(effort), frame.scale["supply_V"])
    )
    near = transients(frame, effort)
    parts: dict[str, list[Array]] = {
        k: [] for k in ("y", "i", "pull", "drag", "duty", "ok", "lag", "power", "v", "lags")
    }
    rate = m.rate[m.pick] * ratio
    current = {k: fill(frame.columns[f"current_{k}"], frame.run) for k in "ab"}
    duty = _duties(frame, effort)
    power = m.at(duty["a"] * current["a"][0] + duty["b"] * current["b"][0])
    if softness is None:
        softness = declared.torque_constant * ratio / declared.stiffness
    for key, sign in (("a", 1.0), ("b", -1.0)):
        i, ti = current[key]
        volts = duty[key] * supply
        parts["y"].append(m.at(volts))
        parts["i"].append(m.at(i))
        # a motor is ahead of the axis by its train's wind-up: in a leap out of stiction it stands while the
        # axis turns, and without this the constant comes out up to 0.7 % too small
        unwinding = m.at(np.gradient(i, frame.period_s)) * softness * ratio
        own = sign * rate + unwinding
        parts["pull"].append(np.maximum(own, 0.0))
        parts["drag"].append(np.maximum(-own, 0.0))
        parts["duty"].append(m.at(duty[key]))
        parts["v"].append(m.at(supply))
        slope = np.gradient(volts, frame.period_s)
        parts["lag"].append(m.at(slope))
        bad = near | saturated(frame, i) | (volts <= 0) | ~ti | ~te | ~m.trusted
        emf = declared.torque_constant * ratio * np.maximum(sign * m.rate, 0.0)
        expected = (volts - emf) / declared.resistance  # only to tell which rows should carry current
        bad |= expected < CLIPPED * frame.scale["adc_A_per_count"]
        crossing = np.abs(np.sign(m.rate)) < 0.5
        off = _off_its_teeth(frame, m, key, rate + sign * unwinding)
        parts["ok"].append(((m.smooth((bad | crossing).astype(float))[m.pick] < 1e-9) & ~off).astype(float))
        parts["power"].append(power)
        parts["lags"].append((sign * m.at(effort) < 0).astype(float))
    c = {k: np.concatenate(v) for k, v in parts.items()}
    base = np.column_stack([c["i"], c["pull"], c["lag"]])
    labels = [("resistance", "ohm"), ("torque_constant", "N m/A"), ("electrical_lag", "s")]
    problem = Problem(
        "E",
        "V",
        c["y"],
        base,
        labels,
        _twice(frame.t[m.pick]),
        _twice(frame.run[m.pick]),
        _twice(frame.session[m.pick]),
        c["ok"] > 0,
        _twice(held[m.pick]),
        m.period_s,
        ar_order=4,
        block_s=3.0,
        sensor="voltage",
    )
    problem.step = STEP * frame.scale["adc_A_per_count"] * declared.resistance
    _between_rows(problem, frame, m, effort, supply)
    _held_register(problem, frame, m, effort, supply)
    # turned against its pull, a leading motor's back-EMF drives its current where the bridge lets it
    driving = -np.where(c["lags"] > 0, 0.0, c["drag"])
    _adopt(problem, driving, "emf_of_a_dragged_leader", "N m/A", declared.torque_constant / 2)
    if declared.ripple is None:
        _sampling(problem, c["duty"], c["v"], c["power"], frame.scale["adc_A_per_count"])
    fit = gls(problem.y, problem.base, problem.train, 4, problem.block)
    error = float(np.sqrt(fit.covariance[1, 1]))
    motor = np.concatenate([np.zeros(n), np.ones(n)])
    return Electrical(
        problem,
        c["duty"],
        c["i"],
        c["pull"],
        c["drag"],
        c["power"],
        c["lags"],
        motor,
        c["v"],
        float(fit.beta[0]),
        float(fit.beta[1]),
        error,
        frame.scale["adc_A_per_count"],
    )


def _off_its_teeth(frame: Frame, m: Motion, key: str, spin: Array) -> Mask:
    """Analysis rows in which a motor turns otherwise than the axis makes it (`spin`, rad/s, its wind-up
    included): it crosses the play, and its back-EMF is its own."""
    if frame.get(f"motor_{key}") is None:
        return np.zeros(len(spin), dtype=bool)
    count = 2 * np.pi / frame.scale["tach_counts_per_turn"] / frame.period_s
    own, known = fill(frame.columns[f"motor_{key}"], frame.run)
    off: Mask = known[m.pick] & (np.abs(m.at(own) - spin) > APART * count)
    off[1:] |= off[:-1].copy()
    off[:-1] |= off[1:].copy()
    return off


def _between_rows(p: Problem, frame: Frame, m: Motion, effort: Array, supply: Array) -> None:
    """Add what the unlogged tick's effort differed by to the base, as far as the log shows it: by the motion,
    and by a set point that was held between the rows."""
    logged = _duties(frame, effort)
    for error, label in zip(
        unlogged_errors(frame), ("gain_between_rows", "gain_of_held_set_point"), strict=False
    ):
        duty = _duties(frame, effort + error / frame.scale["effort_full_scale"])
        column = -np.concatenate([m.at((duty[k] - logged[k]) * supply) for k in "ab"])
        _adopt(p, column, label)


def _held_register(p: Problem, frame: Frame, m: Motion, effort: Array, supply: Array) -> None:
    """Add a lagging register that waits for a whole step to the base, where the log shows it."""
    off = register_error(frame, effort, _share(frame)) * supply / frame.scale["effort_full_scale"]
    column = -np.concatenate([m.at(np.where(s * effort < 0, off, 0.0)) for s in (1.0, -1.0)])
    _adopt(p, column, "held_counter_register")


def _adopt(p: Problem, column: Array, label: str, unit: str = "1", least: float = 0.0) -> None:
    """Add a column to the base whose coefficient is surely positive and above `least`, if it explains more
    than chance."""
    base = np.column_stack([p.base, column])
    fit = gls(p.y, base, p.train, p.ar_order, p.block)
    gained = fit.loglik - under(p.y, p.base, p.train, fit.whitener)
    if gained > MORE and fit.beta[-1] > max(SURE * np.sqrt(fit.covariance[-1, -1]), least):
        p.base = base
        p.base_labels.append((label, unit))


def _share(frame: Frame) -> Array:
    """Counter torque of every row, of the effort."""
    share = np.full(len(frame.t), frame.scale["counter_torque"])
    for k, r in enumerate(frame.runs):
        share[frame.run == k] = r.scales["counter_torque"]
    return share


def _duties(frame: Frame, effort: Array) -> dict[str, Array]:
    """Duty of each motor, 0..1: the effort on the one that leads, the counter torque's share on the other."""
    share = _share(frame)
    return {
        "a": np.where(effort > 0, effort, -share * effort),
        "b": np.where(effort > 0, share * effort, -effort),
    }


def mean_currents(frame: Frame, e: Electrical, beta: Array) -> None:
    """Turn sampled currents into mean ones, in place, by what `_sampling` found; `beta` is the E channel's
    fit."""
    found = dict(zip((name for name, _ in e.problem.base_labels), beta, strict=False))
    if "conversion_offset" not in found:
        return
    ripple, offset = found.get("current_ripple", 0.0), found["conversion_offset"]
    volts, full = frame.scale["supply_V"], frame.scale["adc_A_per_count"]
    duty = _duties(frame, fill(frame.columns["effort"], frame.run)[0])
    for key in "ab":
        i, d = frame.columns[f"current_{key}"], duty[key]
        wrong = ripple * volts * d * (1 - d) - offset * full
        sound = (i > 0) & ~saturated(frame, i)
        frame.columns[f"current_{key}"] = np.where(sound, i - wrong / beta[0], i)


def undo_sampling(frame: Frame, ripple: float) -> None:
    """Turn sampled currents into mean ones, in place, by what a plant file declares.

    `ripple` in A/V: at the falling edge the current is ripple V d (1 - d) above its mean; a converter that
    rounds down reads half a count too low.
    """
    duty = _duties(frame, fill(frame.columns["effort"], frame.run)[0])
    for key in "ab":
        i, d = frame.columns[f"current_{key}"], duty[key]
        wrong = ripple * frame.scale["supply_V"] * d * (1 - d) - 0.5 * frame.scale["adc_A_per_count"]
        sound = (i > 0) & ~saturated(frame, i)
        frame.columns[f"current_{key}"] = np.where(sound, i - wrong, i)


def _sampling(p: Problem, duty: Array, supply: Array, power: Array, ampere: float) -> None:
    """Add how the converter samples to the base, where the log shows it.

    Sampled at the falling edge of the PWM (paper 3.3) the current reads V d (1-d) / (2 L f) above its mean,
    and a
    converter that rounds down half a count below. Both are declared, both are bounded; a log sampled
    otherwise keeps
    its base, and what looks like a ripple but fits better as a supply that gives way is left to that effect.
    """
    ripple, offset = -supply * duty * (1 - duty), np.full(len(duty), ampere)
    sag = duty * power

    def fit(*columns: Array) -> tuple[float, Array, Array]:
        x = np.column_stack([p.base, *columns])
        f = gls(p.y, x, p.train, p.ar_order, p.block)
        loglik = under(p.y, x, p.train, common)
        return loglik, f.beta, np.sqrt(np.maximum(np.diag(f.covariance), 1e-300))

    richest = np.column_stack([p.base, ripple, offset, sag])
    common = gls(p.y, richest, p.train, p.ar_order, p.block).whitener

    at = p.base.shape[1]

    def sound(beta: Array, error: Array) -> bool:
        counts = float(beta[at + 1] / beta[0])
        return bool(
            RIPPLE[0] < beta[at] < RIPPLE[1]
            and TRUNCATION[0] < counts < TRUNCATION[1]
            and beta[at] > SURE * error[at]
            and beta[at + 1] > SURE * error[at + 1]
        )

    other = fit(sag, offset)[0]
    without = fit()[0]
    alone, beta, error = fit(ripple, offset)
    both, beta2, error2 = fit(ripple, offset, sag)
    as_good = other - alone < AS_GOOD * (alone - without)
    if (as_good and sound(beta, error)) or (both > other + MORE and sound(beta2, error2)):
        p.base = np.column_stack([p.base, ripple, offset])
        p.base_labels += [("current_ripple", "1"), ("conversion_offset", "ohm")]
        return
    # efforts that hardly differ leave the ripple to the resistance, but not the half count of a converter
    # that rounds down; a supply must explain twice as much to be heard instead
    rounded, beta3, error3 = fit(offset)
    counts = float(beta3[at] / beta3[0]) if beta3[0] > 0 else 0.0
    sure = TRUNCATION[0] < counts < TRUNCATION[1] and beta3[at] > SURE * error3[at]
    if sure and rounded > without + MORE and fit(sag)[0] - rounded < rounded - without:
        p.base = np.column_stack([p.base, offset])
        p.base_labels += [("conversion_offset", "ohm")]


def _twice(x: NDArray[Any]) -> NDArray[Any]:
    """Motor A's rows, then motor B's."""
    return np.concatenate([x, x])
