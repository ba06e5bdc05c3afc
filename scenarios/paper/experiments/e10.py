"""E10: tuning rules on a model that is identified on the emulator."""

from math import exp, log

from scenarios.paper.experiments.experiment import Experiment, Figures, Limit
from scenarios.paper.experiments.identify import identify
from scenarios.paper.starts import Benches
from scenarios.paper.tuning import RULES, Gains


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


ROW = Experiment(
    "E10", "tuning rules", "ref. 15", "O'Dwyer's handbook",
    "The overall system can be represented using a second order system plus dead time model and standard "
    "tuning rules of PI control can be applied.",
    "Low preload: gain, lag and dead time identified from open-loop steps about 600″/s. Kp and Ki of the "
    "plant file both within a factor 1.5 of what one of seven published rules gives for that model, and "
    "within a factor 2 of what a second one gives; rules with a free time constant at their author's advice.",
    (
        Limit("nearest", "1", 1.0, 1.5, "factor to the nearest rule", 0.4),
        Limit("second", "1", 1.0, 2.0, "factor to the second", 0.6),
    ),
    measure,
    (("gain", "counts/step"), ("lag", "ms"), ("dead time", "ms"), *((name, "factor") for name in RULES)),
)  # fmt: skip
