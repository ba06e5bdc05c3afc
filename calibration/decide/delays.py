"""Late columns: the lag between redundant columns, taken from the coefficients of their rates (effects.md,
lesson 2)."""

from __future__ import annotations

import numpy as np

from calibration.decide.accept import FEWEST_BLOCKS
from calibration.decide.judge import design
from calibration.decide.select import Selection
from calibration.declaredplant import Declared
from calibration.finding import Finding, Parameter
from calibration.statistics.regression import gls
from calibration.statistics.tails import student_reach

SMALLEST_S = 1.2e-4  # shorter lags than this are within an interrupt's latency
WINDOW_DELAY_S = 0.0025  # the velocity column counts over the last 5 ms: half of it
ELECTRICAL_S = (
    0.003,
    0.0105,
)  # one tick of the loop, L/R of 0.5 to 5 ms and the output latch: what a sound log shows


# of the volts on sound logs: 0.0051 to 0.0068 on the plant's own and on development logs (seeds 1024 to
# 1027), a tick and what the winding needs beyond it
SOUND_LAG_S = 0.006
# a measurement behind another frame on the bus, 130 bits each at 1 Mbit/s (FIDELITY.md: not in its age)
BUS_WAIT_S = 2.6e-4
TICK_S = 0.005  # paper 3.3
COLUMN = {"K": 2, "S": 0}  # of the delay in the channel's base
CONFIRMED = 0.6  # of the delay seen against the effort, that the torque must lag the motion
SLACK_S = 0.002  # beyond that range before the volts alone call a column late
MATTERS = 0.05  # of the mean square: a delay that explains less is a nuisance
LATE_CURRENT_S = 0.0015  # against the encoder; a converter's own delay is well below a tick


def gain_of_column(s: Selection, column: int) -> float:
    """Share of the training mean square that the base's `column` takes away."""
    p = s.problem
    x = design(p, [c.candidate for c in s.chosen])
    without = gls(p.y, np.delete(x, column, axis=1), p.train, p.ar_order, p.block).residual[p.train]
    return 1.0 - float(np.mean(s.after.residual[p.train] ** 2)) / max(float(np.mean(without**2)), 1e-300)


def delay_findings(selections: dict[str, Selection], declared: Declared) -> list[Finding]:
    """Compare every lag with what a sound log shows; one finding, on the column that is late.

    On a log of the emulator's own boards the plant file's gear train may make torque lag the currents
    (damping over stiffness), a measurement may have waited for the bus, and the effort's second tick is not
    logged.
    """
    allowed = BUS_WAIT_S if declared.own else 0.0
    lags: dict[str, tuple[float, float]] = {}
    for key, nominal in (("K", 0.0), ("S", WINDOW_DELAY_S)):
        index = COLUMN[key]
        p = selections[key].problem if key in selections else None
        if p is not None and p.train.sum() >= FEWEST_BLOCKS * p.block:
            s = selections[key]
            value, error = -float(s.after.beta[index]), float(np.sqrt(s.after.covariance[index, index]))
            lags[key] = (value - nominal, error * student_reach(60))
    late = {
        k: v for k, (v, e) in lags.items() if abs(v) > SMALLEST_S + allowed and abs(v) > 2.5 * e and e < 3e-4
    }
    late = {k: v for k, v in late.items() if gain_of_column(selections[k], COLUMN[k]) > MATTERS}
    name = None
    if "K" in late and "S" in late and abs(late["K"] - late["S"]) < 0.3 * abs(late["K"]):
        name, key, value = "position", "K", -late["K"]
    elif "K" in late:
        name, key, value = "tachometers", "K", late["K"]
    elif "S" in late:
        name, key, value = "velocity", "S", late["S"]
    if name is None and "T" in selections:
        s = selections["T"]
        at = [label for label, _ in s.problem.base_labels].index("current_delay")
        # the torque is what the currents say: currents that come late lead it by minus the delay
        value = -float(s.after.beta[at]) - declared.gear_lag_s
        error = float(np.sqrt(s.after.covariance[at, at])) * student_reach(60)
        if value > LATE_CURRENT_S and value > 3 * error and "E" in selections:
            lag = float(selections["E"].after.beta[2])
            # a loop that changes its effort from tick to tick, of which every second one is logged, makes
            # sound
            # currents look late against the effort, but not against the motion
            telling = lag - SOUND_LAG_S > CONFIRMED * value and gain_of_column(s, at) > MATTERS
            if telling and value > CONFIRMED * (lag - sum(ELECTRICAL_S) / 2):
                lags["T"] = (value, error)
                name, key = "current", "T"
    if name is None and "E" in selections and not selections["E"].chosen:
        s = selections["E"]
        value, error = float(s.after.beta[2]), float(np.sqrt(s.after.covariance[2, 2])) * student_reach(60)
        slack = SLACK_S + (TICK_S if declared.own else 0.0)
        off = value < ELECTRICAL_S[0] - slack or value > ELECTRICAL_S[1] + slack
        if off and error < 1e-3 and gain_of_column(s, 2) > MATTERS:
            lags["E"] = (abs(value - sum(ELECTRICAL_S) / 2), error)
            name, key, value = ("current or effort", "E", lags["E"][0])
    if name is None:
        return []
    error = lags[key][1]
    z = value / max(error / student_reach(60), 1e-12)
    return [
        Finding(
            "channel_delay",
            "S",
            "clock",
            evidence=z * z / 2 / np.log(10),
            share=1.0,
            note=f"the {name} column is late",
            parameters={"delay": Parameter(value, "s", value - error, value + error)},
        )
    ]
