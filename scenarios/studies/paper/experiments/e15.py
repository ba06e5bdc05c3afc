"""E15: one pair of gains for both preloads."""

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import peak_percent
from scenarios.studies.paper.starts import Benches

SPEEDS = (600.0, 1000.0, 7200.0)


def measure(benches: Benches) -> Figures:
    """Peaks at high preload with the controller of the low one."""
    assert benches.plants["low"].controller == benches.plants["high"].controller
    found = {}
    for speed in SPEEDS:
        log = benches("high").closed_loop(speed, 16.0).after(8.0)
        found[f"peak {speed:g}"] = peak_percent(log.rate, speed)
    return found


ROW = row("E15", measure)
