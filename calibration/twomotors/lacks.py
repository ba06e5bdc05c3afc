"""What logs of an axis would need before "nothing" could be said of them: seconds, speeds, columns."""

from __future__ import annotations

import numpy as np

from calibration.answers import lacking
from calibration.decide.tolerance import unsettled_reading
from calibration.readers.run import Array
from calibration.twomotors.result import AxisResult

COLUMNS = {
    "T": "the currents (adc_a, adc_b): without them there is neither torque nor volts",
    "S": "the incremental encoder (velocity)",
    "K": "the motors' encoders (tach_a, tach_b)",
}
SLOW = 5e-6  # rad/s, an arcsec/s: slower is no direction
ONE_SPEED = 3.0  # quotient of the 95 % and 30 % speeds below which friction has one speed only
ONE_SIDE = 0.02  # of the rows that move the other way, below which there is one direction only


def lacks(result: AxisResult) -> list[str]:
    """Reasons why "nothing" would be more than the log can say; empty for a log that could have shown the
    effects of its channels. A column the log never had is a reason only for the torque, which most effects
    need."""
    out = [text for key in "TEKS" if key in result.selections for text in _short(result, key)]
    if "T" not in result.selections:
        out.append(COLUMNS["T"])
    unsettled = unsettled_reading(result.calibrated.get("stiffness"), result.declared)
    if not out:
        return [unsettled] if unsettled else []
    rate = result.motion.rate[result.motion.pick]
    out += motion_lacks(rate[result.motion.trusted[result.motion.pick]])
    return [*out, unsettled] if unsettled else out


def _short(result: AxisResult, key: str) -> list[str]:
    s = result.selections[key]
    if key == "T" and not s.looked_at:
        return ["channel T: too little sliding to tell a torque from the bristles' history"]
    return lacking(s, f"channel {key}: ")


def motion_lacks(rate: Array) -> list[str]:
    """Speeds and directions that a motion of these rates (n,) rad/s does not have."""
    size = np.abs(rate[np.abs(rate) > SLOW])
    if len(size) == 0:
        return ["a motion"]
    out = []
    if np.quantile(size, 0.95) < ONE_SPEED * np.quantile(size, 0.3):
        out.append("a second speed")
    if min(np.mean(rate > SLOW), np.mean(rate < -SLOW)) < ONE_SIDE:
        out.append("the other direction")
    return out


def absent_columns(result: AxisResult) -> list[str]:
    """Sentences on channels that the log has no columns for."""
    return [
        f"channel {key} was not looked at: the log lacks {what}"
        for key, what in COLUMNS.items()
        if key not in result.selections
    ]
