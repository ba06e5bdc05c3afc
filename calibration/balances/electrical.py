"""The electrical balance of two motors: duty times supply less R i less K omega, both motors stacked.

A motor pulls one way only. Dragged backwards it has a back-EMF by a diode alone, declared or `diode_braking`.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation

from calibration.arrays import Array, Mask
from calibration.balances.bridge import add_bridge, add_sampling, adopt, duties, shares
from calibration.balances.frame import Frame
from calibration.balances.motion import Motion
from calibration.balances.torque import STEP
from calibration.balances.volts import Counter, Volts, Windings
from calibration.inputs.declaredplant import Declared

# counts of the tachometer per row, five times what rounding leaves after the means (0.15). ASSUMPTION
APART = 0.75
CLIPPED = 4.0  # counts expected: below, noise is cut off at zero and the mean is not the current. ASSUMPTION


def electrical_problem(
    frame: Frame, m: Motion, held: Mask, declared: Declared, softness: float | None = None
) -> Volts | None:
    """The E channel; None without a current. `softness`: wind-up of a train, rad of the axis per ampere."""
    if frame.get("current_a") is None or frame.get("current_b") is None:
        return None
    if softness is None:
        softness = declared.torque_constant * frame.scale["gear_ratio"] / declared.stiffness
    effort, known = frame.filled("effort")
    bad = frame.transients() | ~known | ~m.ok | (m.speed == 0)
    spins, engaged = zip(*(_spin(frame, m, key, softness) for key in "ab"), strict=True)
    w = _windings(frame, m, effort, np.concatenate(spins), declared)
    assert w.counter is not None
    volts = np.split(w.duty * w.supply, 2)
    driving_volts, opened = volts, 1.0 - w.duty
    if declared.diode_drop:
        driving_volts = [v - declared.diode_drop * o for v, o in zip(volts, np.split(opened, 2), strict=True)]
        # an open switch takes itself and the sense resistor out of the declared loop
        volts = np.split(np.concatenate(volts) + declared.switch * opened * w.current, 2)
    conducts = [_conducts(frame, m, key, v, declared) for key, v in zip("ab", driving_volts, strict=True)]
    problem = m.problem(
        held,
        [
            ("resistance", "ohm", w.at(w.current)),
            ("torque_constant", "N m/A", w.rate),
            ("electrical_lag", "s", w.at(np.concatenate([np.gradient(v, frame.period_s) for v in volts]))),
            *([("diode_drop", "V", w.at(opened))] if declared.diode_drop else []),
        ],
        channel="E",
        unit="V",
        y=w.at(np.concatenate(volts)),
        valid=np.concatenate([m.clear(bad, ~c) & e for c, e in zip(conducts, engaged, strict=True)]),
        step=STEP * frame.scale["adc_A_per_count"] * declared.resistance,
    )
    add_bridge(problem, w, frame, effort)
    if not declared.diode_drop:
        # turned against its pull, a leading motor's back-EMF drives its current where the bridge lets it
        driving = -np.where(w.counter.lagging > 0, 0.0, w.counter.dragged)
        adopt(problem, driving, "emf_of_a_dragged_leader", "N m/A", declared.torque_constant / 2)
    if declared.ripple is None:
        add_sampling(problem, w, frame.scale["adc_A_per_count"])
    fit = problem.named(problem.fit())
    constant = fit["torque_constant"]
    w = replace(w, resistance=fit["resistance"].value, constant=constant.value)
    return Volts(problem=problem, windings=w, constant_error=constant.error)


def _windings(frame: Frame, m: Motion, effort: Array, spin: Array, declared: Declared) -> Windings:
    """Both motors' columns; `spin` (2 n_analysis,) rad/s the way each pulls."""
    dragged = np.zeros_like(spin) if declared.diode_drop else np.maximum(-spin, 0.0)
    logged = frame.get("supply") is not None
    supply = frame.filled("supply")[0] if logged else np.full(len(effort), frame.scale["supply_V"])
    return Windings(
        at=lambda full: np.concatenate([m.at(x) for x in np.split(full, 2)]),
        current=np.concatenate([frame.filled(f"current_{k}")[0] for k in "ab"]),
        rate=spin + dragged,
        clock=np.tile(frame.one_clock[m.rows], 2),
        duty=duties(frame, effort),
        supply=np.tile(supply, 2),
        counter=Counter(
            share=shares(frame, effort),
            lagging=np.concatenate([side * m.at(effort) < 0 for side in (1.0, -1.0)]).astype(float),
            dragged=dragged,
        ),
    )


def _spin(frame: Frame, m: Motion, key: str, softness: float) -> tuple[Array, Mask]:
    """rad/s (n_analysis,) of a motor the way it pulls, and the rows in which it turns as the axis makes it.

    A motor is ahead of the axis by its train's wind-up. In a leap out of stiction it stands while the axis
    turns, which makes the constant up to 0.7 % too small. One that crosses the play has an EMF of its own.
    """
    ratio, side = frame.scale["gear_ratio"], 1.0 if key == "a" else -1.0
    current, _ = frame.filled(f"current_{key}")
    spin = side * m.speed[m.rows] * ratio + m.at(np.gradient(current, frame.period_s)) * softness * ratio
    if frame.get(f"motor_{key}") is None:
        return spin, np.ones(len(spin), dtype=bool)
    count = 2 * np.pi / frame.scale["tach_counts_per_turn"] / frame.period_s
    own, known = frame.filled(f"motor_{key}")
    off = known[m.rows] & (np.abs(m.at(own) - side * spin) > APART * count)
    return spin, ~binary_dilation(off)


def _conducts(frame: Frame, m: Motion, key: str, volts: Array, declared: Declared) -> Mask:
    """Rows (n,) whose current is measured: known, not cut off at zero, and not at the converter's end."""
    current, known = frame.filled(f"current_{key}")
    pull = (m.speed if key == "a" else -m.speed) * frame.scale["gear_ratio"]
    pull = pull if declared.diode_drop else np.maximum(pull, 0.0)
    expected = (volts - declared.torque_constant * pull) / declared.resistance
    flows = (volts > 0) | bool(declared.diode_drop)
    flows &= expected >= CLIPPED * frame.scale["adc_A_per_count"]
    return np.asarray(known & flows & ~frame.saturated(current))
