"""A bench that writes its commands down and answers with an axis that is at once where it should be."""

from collections.abc import Callable

import numpy as np

from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.scales import LOG_PERIOD_S
from tests.studies.paper.synthetic import log_of

Rate = Callable[[float], float]
Command = tuple[str, float, float]


class Commanded:
    """opened: speed by effort, closed: by set point, arcsec/s. In closed loop the effort is a tenth of it."""

    def __init__(self, opened: Rate = lambda effort: 10.0 * effort, closed: Rate = lambda at: at) -> None:
        self.opened, self.closed = opened, closed
        self.commands: list[Command] = []
        self.rows = 0

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        self.commands.append(("closed", arcsec_s, round(seconds, 6)))
        return self._log(self.closed(arcsec_s), arcsec_s / 10.0, seconds)

    def open_loop(self, effort: int, seconds: float) -> Log:
        self.commands.append(("open", effort, round(seconds, 6)))
        return self._log(self.opened(effort), float(effort), seconds)

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        count = round(seconds / LOG_PERIOD_S)
        made = log_of(np.full(count, rate), np.full(count, effort))
        t_s = np.arange(self.rows, self.rows + count, dtype=np.float64) * LOG_PERIOD_S
        self.rows += count
        return Log(t_s, made.counts, made.effort, made.adc_a, made.adc_b, made.true_rate)
