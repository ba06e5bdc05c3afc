"""E10: tuning rules on a model that is identified on the emulator."""

from math import exp, log

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.identify import identify
from scenarios.studies.paper.starts import Benches
from scenarios.studies.paper.tuning import RULES, Gains


def factor(one: Gains, other: Gains) -> float:
    """Return the larger of the two factors between gains, 1 or more."""
    return exp(max(abs(log(one.kp / other.kp)), abs(log(one.ki / other.ki))))


def measure(benches: Benches) -> Figures:
    """Factors between the plant file's gains and those of each rule for the identified model."""
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


ROW = row("E10", measure, tuple((name, "factor") for name in RULES))
