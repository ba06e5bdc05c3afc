"""E10: tuning rules on a model that is identified on the emulator."""

from math import exp, log

from scenarios.studies.paper.experiments.experiment import Experiment, Figures, Limit
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


ROW = Experiment(
    id="E10",
    limits=(
        Limit(figure="nearest", unit="1", low=1.0, high=1.5, words="factor to the nearest rule", scale=0.4),
        Limit(figure="second", unit="1", low=1.0, high=2.0, words="factor to the second", scale=0.6),
    ),
    measure=measure, beside=(
        ("gain", "counts/step"), ("lag", "ms"), ("dead time", "ms"), *((name, "factor") for name in RULES),
    ),
)  # fmt: skip
