"""E4: closed loop at 1 to 3 deg/s."""

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import peak_percent
from scenarios.studies.paper.runs import SLOW_SLEW, slow_slew
from scenarios.studies.paper.starts import Benches


def measure(benches: Benches) -> Figures:
    """Peaks at 1, 2 and 3 deg/s."""
    return {
        f"peak {speed / 3600:g}": peak_percent(slow_slew(benches("low"), speed).rate, speed)
        for speed in SLOW_SLEW
    }


ROW = row("E4", measure)
