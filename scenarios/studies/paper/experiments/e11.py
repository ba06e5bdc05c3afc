"""E11: low gains give stick-slip."""

from scenarios.studies.paper.bench import Bench
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.stickslip import stick_slips
from scenarios.studies.paper.runs import TRACKING, tracking
from scenarios.studies.paper.starts import Benches, viscous_only

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


ROW = row("E11", measure, tuple((f"at {factor:g}", "cycles") for factor in FACTORS))
