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

from calibration.channels.bridge import adopt, between_rows, held_register
from calibration.channels.duties import duties
from calibration.channels.frame import Frame, fill
from calibration.channels.motion import Motion
from calibration.channels.problem import Problem
from calibration.channels.sampling import add_sampling
from calibration.channels.torque import STEP, saturated, transients
from calibration.declaredplant import Declared
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.statistics.whitening import Mask

APART = 0.75  # counts of the tachometer per row, five times what rounding leaves after the means (0.15)
CLIPPED = (
    4.0  # counts expected: below it the converter's noise is cut off at zero and its mean is not the current
)


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
    duty = duties(frame, effort)
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
    between_rows(problem, frame, m, effort, supply)
    held_register(problem, frame, m, effort, supply)
    # turned against its pull, a leading motor's back-EMF drives its current where the bridge lets it
    driving = -np.where(c["lags"] > 0, 0.0, c["drag"])
    adopt(problem, driving, "emf_of_a_dragged_leader", "N m/A", declared.torque_constant / 2)
    if declared.ripple is None:
        add_sampling(problem, c["duty"], c["v"], c["power"], frame.scale["adc_A_per_count"])
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


def _twice(x: NDArray[Any]) -> NDArray[Any]:
    """Motor A's rows, then motor B's."""
    return np.concatenate([x, x])
