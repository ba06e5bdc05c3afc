"""E9: equation (6) with the same PI, rest to 600 arcsec/s."""

import numpy as np

from scenarios.paper.experiments.experiment import Experiment, Figures, Limit
from scenarios.paper.linear import linear_axis, simulate_loop
from scenarios.paper.runs import STEP_TO, step
from scenarios.paper.scales import LOG_PERIOD_S
from scenarios.paper.starts import Benches

RAMP_ARCSEC_S2 = 7200.0
"""The firmware's acceleration limit, 2 deg/s2 (Table 1)."""


def measure(benches: Benches) -> Figures:
    """Difference of the two responses, and their settled efforts."""
    plant = benches.plants["low"]
    log = step(benches("low"))
    seconds = log.t_s.size * LOG_PERIOD_S
    steps = round(plant.controller.pwm_steps.si)
    _, rate, effort = simulate_loop(
        linear_axis(plant), benches.gains, steps, STEP_TO, seconds, RAMP_ARCSEC_S2
    )
    rate, effort = rate[1::2], effort[1::2]  # the log has every second tick
    late = slice(-rate.size // 3, None)
    return {
        "difference": float(np.sqrt(np.mean((log.rate - rate) ** 2)) / STEP_TO * 100.0),
        "effort": (float(effort[late].mean()) / float(log.effort[late].mean()) - 1.0) * 100.0,
    }


ROW = Experiment(
    "E9", "linear model at 600″/s", "Figs. 10, 11", "similar responses",
    "Since the friction is mostly linear at these speeds and the approximated linear model is valid, the "
    "response of the actual telescope and simulated model are similar.",
    "Low preload, rest to 600″/s, 3 s: rms of emulator minus equation (6) with the same PI ≤ 5 % of the set "
    "point, settled effort of equation (6) within 20 % of the emulator's.",
    (
        Limit("difference", "%", 0.0, 5.0, "rms of the difference", 1.5),
        Limit("effort", "%", -20.0, 20.0, "settled effort off", 8.0),
    ),
    measure,
)  # fmt: skip
