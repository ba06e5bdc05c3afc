"""Effects that are another declared number: named only where it leaves its tolerance.

A fifth is calibration, not an effect: the paper's own figures disagree by that (hardware.md 2.3).
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.friction import Sliding
from calibration.balances.problem import Estimate, Problem
from calibration.balances.thresholds import FALLING_ROWS, SLIDING_ROWS
from calibration.balances.torque import Torque
from calibration.decide.parameters import interval
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_BLOCKS, FEWEST_VALIDATED, MARGIN
from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import Declared
from calibration.names import NAMES
from calibration.names.name import TOLERANCE
from calibration.statistics.regression import Fit, inflation
from plant.effects import REGISTRY

# share of a mechanical number, standard error beyond noise (opened seeds 20261129 to 20261202: 0.0025 held
# 97.4 %). Smaller than an effect's MODEL_ERROR (decide/thresholds.py): an effect is small beside the numbers
NUMBER_ERROR = 0.0015
ELECTRICAL_ERROR = 0.0005  # share of an electrical number, likewise (the same seeds: 0.0025 held 99.4 %)
# share of the inertia, likewise: gear trains and rotors beyond a rigid balance (the same seeds)
INERTIA_ERROR = 0.006
# times a variance by the other columns (1 / (1 - R squared)): beyond, the motion does not hold numbers apart.
# ASSUMPTION. A rig says from 30 on that two terms move together (look/said.py): there it is only a remark
INFLATION = 100.0
# part of 1 of a logarithm: keeps the number finite where INFLATION refuses it anyway. arithmetic
LARGEST_CORRECTION = 3.0
# standard errors from the declared number. ASSUMPTION: errors of coloured residuals are estimates, too
SURE = 5.0
# part of 1, (speed / Stribeck speed)^exponent, between which the dip is seen. ASSUMPTION
DIP = (0.0025, 0.64)
QUICK = 6.25  # times, likewise: where the dip is over, e^-6 of it is left. arithmetic
# times: the quick speeds over the slow ones, before Coulomb and viscous friction come apart. ASSUMPTION
SPREAD = 3.0


#: numbers of a drive, as `Declared` calls them, that the torque balance holds, with their units
LINEAR = {"inertia": "kg m2", "viscous": "N m s/rad", "coulomb": "N m"}
#: likewise those whose logarithm it corrects, in columns `log_<number>`: times Coulomb's torque or not
CURVED = {"stiction": "N m", "stribeck_speed": "rad/s", "sigma_0": "N m/rad"}
OF_COULOMB = ("stiction", "sigma_0")
UNITS = {**LINEAR, **CURVED, "stiffness": "N m/rad"}
NEEDED = {"viscous", "coulomb", "stiction"}  # without which no friction is known
CHANGES = {name: n.changed for name, n in NAMES.items() if n.changed is not None}


def beyond(one: Estimate, declared: float, factor: float) -> bool:
    """Whether a number differs from the declared one by more than `factor` either way, significantly so."""
    if one.value <= 0 or one.error <= 0:
        return False
    return abs(np.log(one.value / declared)) > np.log(factor) and abs(one.value - declared) > SURE * one.error


def seen_speeds(rate: Array, d: Declared) -> set[str]:
    """What speeds (rad/s) tell of friction: "moved", "sliding" beyond the dip, "spread" there, the "dip"."""
    if not len(rate):
        return set()
    w = np.abs(rate)
    part = (w / d.stribeck_rate) ** d.stribeck_exponent
    quick = part > QUICK
    if np.mean(quick) <= SLIDING_ROWS:
        return {"moved"}
    out = {"moved", "sliding"}
    if np.quantile(w[quick], 0.95) > SPREAD * np.quantile(w[quick], 0.05):
        out.add("spread")
    if np.mean((part > DIP[0]) & (part < DIP[1])) > FALLING_ROWS:
        out.add("dip")
    return out


def fitted_numbers(torque: Torque, after: Fit, largest: float = LARGEST_CORRECTION) -> dict[str, Estimate]:
    """The drive's numbers, SI, from a fit of the torque's base; logarithms corrected by `largest` at most."""
    fit = torque.problem.named(after)
    out = {name: fit[name] for name in LINEAR}
    for name, start in torque.friction.law.numbers.items():
        correction, of = fit[f"log_{name}"], fit["coulomb"] if name in OF_COULOMB else Estimate(1.0, 0.0)
        value = start * float(np.exp(np.clip(correction.value, -largest, largest))) * of.value
        relative = float(np.hypot(correction.error, of.error / max(of.value, 1e-9)))
        out[name] = Estimate(value, value * relative)
    return out


def calibrated_numbers(
    torque: Torque, after: Fit, used: Array, scale_error: float, blocks: Array
) -> tuple[dict[str, Estimate], dict[str, Parameter]]:
    """The drive's numbers that the motion holds apart, SI, and with their 95 % intervals.

    `after`: a fit behind the torque's base; `used` (rows, p): its fitted rows. `scale_error`: relative
    standard error of the N m per ampere, which all share. `blocks` (p,): that carry each coefficient.
    """
    p = torque.problem
    places = {n: p.place(n) for n in LINEAR} | {n: p.place(f"log_{n}") for n in CURVED}
    apart = inflation(used[:, list(places.values())]) < INFLATION
    fitted = fitted_numbers(torque, after)
    numbers = {n: fitted[n] for n, good in zip(places, apart, strict=True) if good}
    return numbers, {n: _span(n, one, scale_error, blocks[places[n]]) for n, one in numbers.items()}


def _span(name: str, one: Estimate, scale_error: float, blocks: float) -> Parameter:
    """With its 95 % interval, of independent `blocks` of rows."""
    model = float(np.hypot(INERTIA_ERROR if name == "inertia" else NUMBER_ERROR, scale_error)) * one.value
    return Parameter(one.value, UNITS[name], *interval(one.value, one.error, int(blocks), model))


def changes(
    numbers: Mapping[str, Estimate], spans: Mapping[str, Parameter], declared: Declared, seen: set[str]
) -> list[Finding]:
    """Findings of names that are `numbers` beyond tolerance; see `calibrated_numbers`, `seen_speeds`."""
    out = []
    for name, changed in CHANGES.items():
        found = {n: numbers[n] for n in changed.numbers if n in numbers}
        if len(found) < len(changed.numbers) or changed.seen not in seen:
            continue
        if any(found[n].error >= most * found[n].value for n, most in changed.precise.items()):
            continue
        said = {n: nearest(declared, n, one.value) for n, one in found.items()}
        if any(beyond(one, said[n], changed.factor) for n, one in found.items()):
            effect, first = REGISTRY[name], next(iter(changed.numbers))
            z = (found[first].value - said[first]) / found[first].error
            sizes = {}
            for n, parameter in changed.numbers.items():
                factor = any(p.name == parameter for p in effect.parameters)
                sizes[parameter] = replace(spans[n].times(1 / said[n]), unit="1") if factor else spans[n]
            evidence = float(min(z * z / 2 / np.log(10), 1e4))
            out.append(Finding(name, effect.channel, effect.domain, parameters=sizes, evidence=evidence))
    return out


def nearest(d: Declared, name: str, value: float) -> float:
    """A declared number, of several readings of it the one nearest to `value`."""
    readings = [d.stiffness * r for r in d.readings] if name == "stiffness" else [d.number(name)]
    return min(readings, key=lambda k: abs(float(np.log(max(value, 1e-300) / k))))


def held_numbers(names: Iterable[str], p: Problem, beta: Array, d: Declared, f: Sliding) -> dict[int, float]:
    """Coefficients of the torque base (place -> value) that keep the changed numbers within tolerance."""
    fixed: dict[int, float] = {}
    for changed in (CHANGES[n] for n in names if n in CHANGES):
        for name in (n for n in changed.numbers if n in LINEAR or n in CURVED):
            low, high = d.number(name) / changed.factor, d.number(name) * changed.factor
            if name in LINEAR:
                fixed[p.place(name)] = float(np.clip(beta[p.place(name)], low, high))
            else:
                start = f.law.numbers[name] * (f.coulomb if name in OF_COULOMB else 1.0)
                fixed[p.place(f"log_{name}")] = float(np.log(np.clip(start, low, high) / start))
    return fixed


def telling(found: list[Finding], p: Problem, x: Array, d: Declared, f: Sliding) -> list[Finding]:
    """Those findings whose declared numbers, held within their tolerance, fit clearly worse.

    `x`: columns, the base first. Numbers of an ill-conditioned fit wander far at no cost.
    """
    free, effects = p.fit(x), x[:, p.base.shape[1] :]
    out = []
    for one in found:
        held = p.holding(held_numbers([one.name], p, free.beta, d, f))
        e0, e1 = held.fit(np.hstack([held.base, effects])).residual, free.residual
        fitted, held_out = (float(np.mean(e0[k] ** 2) / np.mean(e1[k] ** 2)) for k in (p.train, p.test))
        if fitted > 1 + MARGIN and (p.test.sum() < FEWEST_VALIDATED or held_out > 1 - MARGIN):
            out.append(one)
    return out


def train_stiffness(s: Selection, scale_error: float) -> tuple[dict[str, Estimate], dict[str, Parameter]]:
    """Of one train, from the wind-up line; `scale_error` and what is returned as in `calibrated_numbers`."""
    compliance, blocks = s.problem.named(s.after)["compliance"], s.problem.blocks
    if compliance.value <= 0 or blocks < FEWEST_BLOCKS:
        return {}, {}
    one = Estimate(1 / compliance.value, compliance.error / compliance.value**2)
    return {"stiffness": one}, {"stiffness": _span("stiffness", one, scale_error, blocks)}


def unsettled_reading(stiffness: Parameter | None, d: Declared) -> str:
    """Why a stiffness is neither declared nor changed: it agrees with another reading than the first."""
    if stiffness is None:
        return ""
    times = stiffness.value / d.stiffness
    near = [r for r in d.readings if abs(np.log(times / r)) < np.log(TOLERANCE)]
    if not near or d.readings[0] in near:
        return ""
    return (
        f"channel K: shaft_compliance was close. A train's stiffness of {stiffness.value:.3g} N m/rad is"
        f" {times:.2f} of Table 1's, if that is one train's, and as declared if it is both trains'. A plant"
        " file (--plant) or the log's header (train_stiffness_Nm_per_rad) says which"
    )
