"""The emulator beside models of it: equation (6) with the same PI, and tuning rules (E9, E10)."""

from math import exp, log

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.identify import identify
from scenarios.studies.paper.linear import beside
from scenarios.studies.paper.runs import STEP_TO, step
from scenarios.studies.paper.starts import Benches
from scenarios.studies.paper.tuning import RULES, Gains


@row("E9")
def equation_6(benches: Benches) -> Figures:
    """Difference of the two responses from rest to 600 arcsec/s, and their settled efforts."""
    measured = step(benches("low"))
    _, rate, effort = beside(benches, measured)
    rate, effort = rate[1::2], effort[1::2]  # the log has every second tick
    late = slice(-rate.size // 3, None)
    return {
        "difference": float(np.sqrt(np.mean((measured.rate - rate) ** 2)) / STEP_TO * 100.0),
        "effort": (float(effort[late].mean()) / float(measured.effort[late].mean()) - 1.0) * 100.0,
    }


@row("E10", tuple((name, "factor") for name in RULES))
def tuning_rules(benches: Benches) -> Figures:
    """Factors between the plant file's gains and those of each rule, for a model identified on the
    emulator."""
    model = identify(lambda: benches("low"))
    own = Gains(*benches.gains)
    found = {name: factor(own, rule(model)) for name, rule in RULES.items()}
    nearest = sorted(found.values())
    return {
        "nearest": nearest[0],
        "second": nearest[1],
        "gain": model.gain,
        "lag": model.lag_s * 1e3,
        "dead time": model.dead_s * 1e3,
    } | found


def factor(one: Gains, other: Gains) -> float:
    """Return the larger of the two factors between gains, 1 or more."""
    return exp(max(abs(log(one.kp / other.kp)), abs(log(one.ki / other.ki))))
