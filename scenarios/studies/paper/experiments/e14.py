"""E14: a motor at rest draws 6 A at 24 V."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.friction_map import data_sheet, ripple_free
from scenarios.studies.paper.runs import BROKEN_AWAY, break_away
from scenarios.studies.paper.scales import EFFORT_SCALE
from scenarios.studies.paper.starts import Benches


def measure(benches: Benches) -> Figures:
    """Stalled current at full duty, from the current of an effort that does not move the axis yet."""
    log = break_away(benches("high"), 1)
    gone = np.nonzero(np.abs(log.counts) > BROKEN_AWAY)[0]
    end = max(40, (int(gone[0]) if gone.size else log.t_s.size) - 20)
    held = slice(end - 40, end)
    current = ripple_free(log, data_sheet(benches.plants["high"]))[0][held]
    duty = log.effort[held] / EFFORT_SCALE
    return {"stall": float(current @ duty / (duty @ duty)), "break-away current": float(current[-5:].mean())}


ROW = row("E14", measure)
