"""E11: low gains give stick-slip."""

from scenarios.paper.bench import Bench
from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.experiments.stickslip import stick_slips
from scenarios.paper.runs import TRACKING, tracking
from scenarios.paper.starts import Benches, viscous_only

FACTORS = (0.5, 0.25, 0.1)
LEAP = 1.5


def measure(benches: Benches) -> Figures:
    """Cycles with lowered gains, less those that the same axis shows without Coulomb friction: gears alone
    can push a loop that is weak enough through zero and beyond, which is no stick-slip."""
    kp, ki = benches.gains
    smooth = viscous_only(benches.plants["low"])

    def cycles(bench: Bench) -> int:
        return stick_slips(tracking(bench, 120.0, 40.0), TRACKING, LEAP)

    found = {}
    for factor in FACTORS:
        gains = (kp * factor, ki * factor)
        found[f"at {factor:g}"] = float(cycles(benches("low", gains)) - cycles(benches.of(smooth, gains)))
    return {"most": max(found.values()), "own": float(cycles(benches("low")))} | found


ROW = Experiment(
    "E11", "low gains", "section 4", "stick slip",
    "our simulation results showed oscillations due to stiction which may be reduced by reducing the PI "
    "gains. But at low gains, the actual system exhibits stick slip motion hence we preferred keeping the "
    "gains high.",
    "Low preload, 15″/s, 120 s after 40 s, both gains at a half, a quarter and a tenth: at one of them at "
    "least three stick phases, each followed by more than 1.5 set points, beyond those that the same axis "
    "shows without Coulomb friction; with the plant file's gains none.",
    (
        Limit("most", "1", 3.0, EVER, "stick-slip cycles with low gains", 2.0),
        Limit("own", "1", 0.0, 0.0, "cycles with the plant file's gains", 2.0),
    ),
    measure,
    tuple((f"at {factor:g}", "cycles") for factor in FACTORS),
)  # fmt: skip
