"""Late columns: the lag between redundant columns, taken from the coefficients of their rates (effects.md,
lesson 2)."""

from __future__ import annotations

import numpy as np

from plant.calibration.decide.finding import Finding, Parameter
from plant.calibration.decide.select import Selection
from plant.calibration.statistics.tails import student_reach

SMALLEST_S = 1.2e-4  # shorter lags than this are within an interrupt's latency
WINDOW_DELAY_S = 0.0025  # the velocity column counts over the last 5 ms: half of it
ELECTRICAL_S = (
    0.003,
    0.0105,
)  # one tick of the loop, L/R of 0.5 to 5 ms and the output latch: what a sound log shows


CONFIRMED = 0.3  # of the delay seen against the effort, that the torque must lag the motion


def _late_torque(selections: dict[str, Selection], delay: float) -> bool:
    """Whether the torque balance sees late currents too. The effort of every second tick is not logged: a loop that
    changes its effort from tick to tick makes sound currents look late against it, but not against the motion."""
    s = selections.get("T")
    labels = [name for name, _ in s.problem.base_labels] if s is not None else []
    if s is None or "current_delay" not in labels:
        return True
    return bool(-s.after.beta[labels.index("current_delay")] > CONFIRMED * delay)


def delay_findings(selections: dict[str, Selection]) -> list[Finding]:
    """Compare every lag with what a sound log shows; one finding, on the column that is late."""
    lags: dict[str, tuple[float, float]] = {}
    for key, index, nominal in (("K", 2, 0.0), ("S", 0, WINDOW_DELAY_S)):
        if key in selections:
            s = selections[key]
            value, error = -float(s.after.beta[index]), float(np.sqrt(s.after.covariance[index, index]))
            lags[key] = (value - nominal, error * student_reach(60))
    late = {k: v for k, (v, e) in lags.items() if abs(v) > SMALLEST_S and abs(v) > 2.5 * e and e < 3e-4}
    name = None
    if "K" in late and "S" in late and abs(late["K"] - late["S"]) < 0.3 * abs(late["K"]):
        name, key, value = "position", "K", -late["K"]
    elif "K" in late:
        name, key, value = "tachometers", "K", late["K"]
    elif "S" in late:
        name, key, value = "velocity", "S", late["S"]
    if name is None and "E" in selections:
        s = selections["E"]
        value, error = float(s.after.beta[2]), float(np.sqrt(s.after.covariance[2, 2])) * student_reach(60)
        middle = sum(ELECTRICAL_S) / 2
        beyond = value < ELECTRICAL_S[0] or (value > ELECTRICAL_S[1] and _late_torque(selections, value - middle))
        if beyond and error < 1e-3:
            lags["E"] = (value - middle, error)
            name, key, value = ("current" if value > middle else "effort"), "E", value - middle
    if name is None:
        return []
    error = lags[key][1]
    return [
        Finding(
            "channel_delay",
            "S",
            "clock",
            evidence=50.0,
            share=1.0,
            note=f"the {name} column is late",
            parameters={"delay": Parameter(value, "s", value - error, value + error)},
        )
    ]
