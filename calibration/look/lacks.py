"""What logs of an axis cannot tell, and what they need before "nothing": seconds, speeds, columns."""

from collections.abc import Sequence

import numpy as np

from calibration.arrays import Array
from calibration.balances import thresholds as limits
from calibration.decide.tolerance import unsettled_reading
from calibration.look.axis_result import AxisResult
from calibration.look.looked import Balance

#: what a log lacks that has no such channel
COLUMNS = {
    "T": "the currents (adc_a, adc_b): without them there is neither torque nor volts",
    "S": "the incremental encoder (velocity)",
    "K": "the motors' encoders (tach_a, tach_b)",
}


def lacks(result: AxisResult, balances: Sequence[Balance]) -> list[str]:
    """Reasons why "nothing" would be more than the log can say; empty for a log that could have shown the
    effects of its channels. A column that is not logged is a reason only for the torque."""
    found = {b.key: b for b in balances}
    out = [text for key in "TEKS" if key in found for text in found[key].short]
    if "T" in found and not found["T"].selection.looked_at:
        out.insert(0, "channel T: too little sliding to tell a torque from the bristles' history")
    if "T" not in found:
        out.append(COLUMNS["T"])
    if out:
        rate = result.motion.speed[result.motion.rows]
        out += motion_lacks(rate[result.motion.ok[result.motion.rows]])
    unsettled = unsettled_reading(result.calibrated.get("stiffness"), result.declared)
    return [*out, unsettled] if unsettled else out


def motion_lacks(rate: Array) -> list[str]:
    """Speeds and directions that a motion of these rates (n,) rad/s does not have."""
    if not np.any(np.abs(rate) > limits.SLOW_RATE):
        return ["a motion"]
    more = (_one_speed(rate), "a second speed"), (_one_way(rate), "the other direction")
    return [what for missing, what in more if missing]


def _one_speed(rate: Array) -> bool:
    size = np.abs(rate[np.abs(rate) > limits.SLOW_RATE])
    return len(size) == 0 or bool(np.quantile(size, 0.95) < limits.ONE_SPEED * np.quantile(size, 0.3))


def _one_way(rate: Array) -> bool:
    ways = (np.mean(rate > limits.SLOW_RATE), np.mean(rate < -limits.SLOW_RATE))
    return bool(min(ways) < limits.ONE_WAY)


def not_identifiable(result: AxisResult) -> list[str]:
    """Parameters this motion cannot tell, by its coverage and the conditioning, not by the fit."""
    m, e, vs = result.motion, result.electrical, result.declared.stribeck_rate
    rate = m.speed[m.rows]
    size, (low, high) = np.abs(rate), (part * vs for part in limits.FALLING)
    slow, quick = np.mean((size > low) & (size < high)), np.mean(size > limits.SLIDING * vs)
    unsure = {
        "stiction": (dip := slow < limits.FALLING_ROWS or quick < limits.SLIDING_ROWS),
        "stribeck_speed": dip,
        "viscous": _one_speed(rate),
        "friction_asymmetry (one direction only)": _one_way(rate),
        "inertia": np.quantile(np.abs(m.acceleration[m.rows]), 0.99) < limits.LEAST_ACCELERATION,
        "sigma_0": np.mean(np.abs(m.since) < limits.TURNING) < limits.TURNING_ROWS,
        "sigma_1": True,
        "torque_constant": e is None or e.constant_error > limits.OPEN_CONSTANT * abs(e.windings.constant),
        "resistance": e is None,
    }
    return [name for name, open_ in unsure.items() if open_]
