"""Effects that are a declared number being another one: named only when re-calibration leaves the declared
tolerance.

A declared friction, stiffness or inertia that is off by up to a fifth is calibration, not an effect: the
paper's own
figures disagree by that much (hardware.md 2.3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.channels.declared import Friction
from calibration.channels.problem import Problem
from calibration.channels.torque import Torque
from calibration.decide.accept import FEWEST_BLOCKS
from calibration.decide.select import Selection
from calibration.declaredplant import Declared
from calibration.finding import Finding, Parameter
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls
from calibration.statistics.tails import student_reach

# of a calibrated number, standard error: scatter about the truth beyond what noise allows, mechanical and
# electrical ones; from the opened seeds 20261129 to 20261202, where 0.0025 held 97.4 % (99.4 % electrical)
MODEL_ERROR, ELECTRICAL_ERROR = 0.0015, 0.0005
INERTIA_ERROR = 0.006  # likewise: gear trains and rotors beyond a rigid balance
TOLERANCE = 1.29  # factor either way: clear of 20 % and of the scatter of an estimate
SIGMA_TOLERANCE = (
    2.2  # sigma_0 is not published: only a factor beyond 1.7 with the scatter of an estimate is a change
)


# of a parameter's variance by the other columns (1 / (1 - R squared)): beyond it the motion does not hold the
# number apart from the others, and the linear correction of the friction curve is no correction
INFLATION = 100.0
COLUMNS = (
    "inertia",
    "viscous",
    "coulomb",
    "stiction",
    "stribeck_speed",
    "sigma_0",
)  # the base's first columns
LARGEST_CORRECTION = 3.0  # of a logarithm: only keeps the number finite where INFLATION refuses it anyway


def inflation(x: Array) -> Array:
    """Variance inflation of every column of x (n, p); infinite for a column of zeros."""
    size = np.linalg.norm(x, axis=0)
    z = x / np.where(size > 0, size, 1.0)
    out = np.full(x.shape[1], np.inf)
    for k in np.flatnonzero(size > 0):
        others = np.delete(z, k, axis=1)
        rest = z[:, k] - others @ np.linalg.lstsq(others, z[:, k], rcond=None)[0]
        out[k] = 1.0 / max(float(rest @ rest), 1e-12)
    return out


def beyond(value: float, error: float, declared: float, factor: float, sure: float = 5.0) -> bool:
    """Whether value differs from declared by more than `factor` either way, and significantly so."""
    if value <= 0 or error <= 0:
        return False
    return abs(np.log(value / declared)) - np.log(factor) > 0 and abs(value - declared) > sure * error


# (speed / Stribeck speed)^exponent: where the dip is seen, and where it is over (e^-6)
SLOW, QUICK = (0.0025, 0.64), 6.25
SEEN = (0.004, 0.02)  # of the rows used, at such speeds, before the log can tell
SPREAD = 3.0  # of the speeds beyond the dip, before Coulomb and viscous friction come apart


TELLING = 0.05  # of the mean square, that holding a declared number must cost


@dataclass(frozen=True)
class Seen:
    """What the rows of a fit can tell of friction, from their speeds."""

    sliding: bool  # beyond the Stribeck dip
    spread: bool  # at speeds that differ
    dip: bool  # within it, too


def seen_speeds(rate: Array, d: Declared) -> Seen:
    """From the speeds (rad/s) of the rows that are fitted; nothing is seen where there are none."""
    if not len(rate):
        return Seen(False, False, False)
    w = np.abs(rate)
    dip = (w / d.stribeck_speed) ** d.stribeck_exponent
    quick = dip > QUICK
    sliding = bool(np.mean(quick) > SEEN[1])
    spread = sliding and float(np.quantile(w[quick], 0.95)) > SPREAD * float(np.quantile(w[quick], 0.05))
    slow = bool(np.mean((dip > SLOW[0]) & (dip < SLOW[1])) > SEEN[0])
    return Seen(sliding, spread, slow and sliding)


def torque_changes(
    torque: Torque, after: Fit, used: Array, d: Declared, seen: Seen, scale_error: float
) -> tuple[list[Finding], dict[str, Parameter]]:
    """Friction findings beyond tolerance, and every calibrated parameter with its interval.

    `after` is a fit whose first columns are the torque problem's base; `used` (rows, p) are its columns on
    the fitted rows, whose speeds are `seen`. `scale_error`: relative standard error of the N m that an ampere
    is worth, which all of them share.
    """
    rows = len(used)
    beta, cov = after.beta, after.covariance
    error = np.sqrt(np.maximum(np.diag(cov), 0.0))
    blocks = max(rows // torque.problem.block, 5)
    reach = student_reach(blocks - 2)
    coulomb = float(beta[2])
    f = torque.friction
    logs = {
        "ratio": (np.log(f.ratio), 3),
        "speed": (np.log(f.stribeck_speed), 4),
        "stiffness": (np.log(f.stiffness), 5),
    }
    limit = LARGEST_CORRECTION
    moved = {k: (v + float(np.clip(beta[i], -limit, limit)), error[i]) for k, (v, i) in logs.items()}
    ratio, speed, stiffness = (float(np.exp(moved[k][0])) for k in ("ratio", "speed", "stiffness"))
    stiction = coulomb * ratio
    stiction_error = stiction * float(np.hypot(moved["ratio"][1], error[2] / max(coulomb, 1e-9)))
    sigma_0 = coulomb * stiffness
    sigma_error = sigma_0 * float(np.hypot(moved["stiffness"][1], error[2] / max(coulomb, 1e-9)))
    speed_error = speed * float(moved["speed"][1])

    def span(value: float, e: float, unit: str, model: float = MODEL_ERROR) -> Parameter:
        e = float(np.linalg.norm((e, model * value, scale_error * value)))
        return Parameter(value, unit, value - reach * e, value + reach * e)

    calibrated = {
        "inertia": span(float(beta[0]), float(error[0]), "kg m2", INERTIA_ERROR),
        "viscous": span(float(beta[1]), float(error[1]), "N m s/rad"),
        "coulomb": span(coulomb, float(error[2]), "N m"),
        "stiction": span(stiction, stiction_error, "N m"),
        "stribeck_speed": span(speed, speed_error, "rad/s"),
        "sigma_0": span(sigma_0, sigma_error, "N m/rad"),
    }
    apart = inflation(used[:, : len(COLUMNS)]) < INFLATION
    for name in (n for n, good in zip(COLUMNS, apart, strict=True) if not good):
        del calibrated[name]
    if rows < FEWEST_BLOCKS * torque.problem.block or coulomb <= 0 or not all(apart[1:4]):
        return [], calibrated
    found = []
    if seen.sliding and beyond(coulomb, float(error[2]), d.coulomb, TOLERANCE):
        found.append(
            Finding(
                "coulomb_change",
                "T",
                "velocity",
                parameters={"coulomb": calibrated["coulomb"]},
                evidence=_evidence(coulomb, d.coulomb, float(error[2])),
            )
        )
    if seen.spread and beyond(float(beta[1]), float(error[1]), d.viscous, TOLERANCE):
        found.append(
            Finding(
                "viscous_change",
                "T",
                "velocity",
                parameters={"sigma_2": calibrated["viscous"]},
                evidence=_evidence(float(beta[1]), d.viscous, float(error[1])),
            )
        )
    known = seen.dip and apart[4] and stiction_error < 0.1 * stiction and speed_error < 0.15 * speed
    if known and (
        beyond(stiction, stiction_error, d.stiction, TOLERANCE)
        or beyond(speed, speed_error, d.stribeck_speed, TOLERANCE)
    ):
        found.append(
            Finding(
                "stribeck_change",
                "T",
                "velocity",
                parameters={
                    "breakaway": calibrated["stiction"],
                    "stribeck_velocity": calibrated["stribeck_speed"],
                },
                evidence=_evidence(stiction, d.stiction, stiction_error),
            )
        )
    if apart[5] and sigma_error < 0.2 * sigma_0 and beyond(sigma_0, sigma_error, d.sigma_0, SIGMA_TOLERANCE):
        found.append(
            Finding(
                "presliding",
                "T",
                "reversal",
                parameters={"sigma_0": calibrated["sigma_0"]},
                evidence=_evidence(sigma_0, d.sigma_0, sigma_error),
            )
        )
    return found, calibrated


def held_numbers(changed: set[str], beta: Array, d: Declared, f: Friction) -> dict[int, float]:
    """Coefficients of the torque base (place -> value) that keep the changed numbers within tolerance."""

    def clip(value: float, declared: float, factor: float) -> float:
        return float(np.clip(value, declared / factor, declared * factor))

    def shift(value: float, declared: float, factor: float) -> float:
        return float(np.log(clip(value, declared, factor) / value))

    fixed: dict[int, float] = {}
    if "coulomb_change" in changed:
        fixed[2] = clip(float(beta[2]), d.coulomb, TOLERANCE)
    if "viscous_change" in changed:
        fixed[1] = clip(float(beta[1]), d.viscous, TOLERANCE)
    if "stribeck_change" in changed:
        fixed[3] = shift(f.ratio, d.stiction / f.coulomb, TOLERANCE)
        fixed[4] = shift(f.stribeck_speed, d.stribeck_speed, TOLERANCE)
    if "presliding" in changed:
        fixed[5] = shift(f.stiffness, d.sigma_0 / f.coulomb, SIGMA_TOLERANCE)
    return fixed


def telling(found: list[Finding], p: Problem, x: Array, d: Declared, f: Friction) -> list[Finding]:
    """Those findings whose declared numbers, held within their tolerance, fit clearly worse.

    `x` are the columns of the fit, the base first. The numbers of an ill-conditioned fit wander far at no
    cost, and a change that makes held-out rows worse is none.
    """
    free = gls(p.y, x, p.train, p.ar_order, p.block)
    out = []
    for one in found:
        fixed = held_numbers({one.name}, free.beta, d, f)
        keep = [k for k in range(x.shape[1]) if k not in fixed]
        y = p.y - sum(x[:, k] * value for k, value in fixed.items())
        held = gls(y, x[:, keep], p.train, p.ar_order, p.block)
        e0, e1 = y - x[:, keep] @ held.beta, p.y - x @ free.beta
        costs = [float(np.mean(e0[rows] ** 2) / np.mean(e1[rows] ** 2)) for rows in (p.train, p.test)]
        if costs[0] > 1 + TELLING and (p.test.sum() < 100 or costs[1] > 1 - TELLING):
            out.append(one)
    return out


def compliance_change(
    selection: Selection, d: Declared, scale_error: float
) -> tuple[list[Finding], dict[str, Parameter]]:
    """Stiffness of one train from the wind-up line; `scale_error` as in `torque_changes`."""
    value, error = float(selection.after.beta[0]), float(np.sqrt(selection.after.covariance[0, 0]))
    if value <= 0 or selection.problem.train.sum() < FEWEST_BLOCKS * selection.problem.block:
        return [], {}
    blocks = max(int(selection.problem.train.sum() / selection.problem.block), 5)
    stiffness, spread = 1 / value, error / value**2
    reach = student_reach(blocks - 2) * float(
        np.linalg.norm((spread, MODEL_ERROR * stiffness, scale_error * stiffness))
    )
    p = Parameter(stiffness, "N m/rad", stiffness - reach, stiffness + reach)
    found = []
    declared = min((d.stiffness * r for r in d.readings), key=lambda k: abs(float(np.log(stiffness / k))))
    if error < 0.05 * value and beyond(stiffness, spread, declared, TOLERANCE):
        found.append(
            Finding(
                "shaft_compliance",
                "K",
                "current",
                parameters={"stiffness": p},
                evidence=_evidence(stiffness, declared, spread),
            )
        )
    return found, {"stiffness": p}


def unsettled_reading(stiffness: Parameter | None, d: Declared) -> str:
    """What keeps a stiffness from being called declared or changed: it agrees with another reading of the
    declared number only than the first. Empty where it agrees with the first, or with none."""
    if stiffness is None:
        return ""
    near = [
        r for r in d.readings if abs(float(np.log(stiffness.value / (d.stiffness * r)))) < np.log(TOLERANCE)
    ]
    if not near or d.readings[0] in near:
        return ""
    times = stiffness.value / d.stiffness
    return (
        f"channel K: shaft_compliance was close: a train's stiffness of {stiffness.value:.3g} N m/rad is"
        f" {times:.2f} of Table 1's, if that is one train's, and as declared if it is both trains': a plant"
        " file (--plant) or the log's header (train_stiffness_Nm_per_rad) says which"
    )


def _evidence(value: float, declared: float, error: float) -> float:
    z = (value - declared) / error
    return float(min(z * z / 2 / np.log(10), 1e4))
