"""Late columns of an axis: lags from coefficients of rates (effects.md, lesson 2), against sound logs'."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calibration.decide import thresholds as limits
from calibration.decide.selection import Selection
from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import Declared
from calibration.names.channel_delay import COLUMNS, late_column
from calibration.statistics.tails import student_reach

#: term of a channel's base that takes up a lag
TERM = {"K": "tachometer_delay", "S": "velocity_delay", "T": "current_delay", "E": "electrical_lag"}
#: s, least and most of that term on a sound log, where it is not zero
SOUND = {"S": (-limits.WINDOW_DELAY_S, -limits.WINDOW_DELAY_S), "E": limits.SOUND_VOLTS_LAG_S}
SOUND_MIDDLE_S = sum(limits.SOUND_VOLTS_LAG_S) / 2  # s, of the volts. arithmetic
REACH = student_reach(limits.LAG_FREEDOM)
Selections = Mapping[str, Selection]


@dataclass(frozen=True, kw_only=True)
class Late:
    """A column that is late by `delay` s, and the reach of its 95 % interval."""

    column: str
    delay: float
    reach: float


def delay_findings(selections: Selections, declared: Declared) -> list[Finding]:
    """One finding, on the column that is late: encoders tell most, volts alone least."""
    rules = (_of_encoders, _of_currents, _of_volts)
    late = next((x for x in (rule(selections, declared) for rule in rules) if x is not None), None)
    if late is None:
        return []
    found = late_column(f"the {late.column} column is late", late.delay, late.reach / REACH, reach=REACH)
    if late.column in COLUMNS:
        found = found.having(column=Parameter(float(COLUMNS[late.column]), "1"))
    return [found]


def _lag(s: Selection, key: str) -> tuple[float, float]:
    """Coefficient of the channel's term, s, and the reach of its interval."""
    lag = s.problem.named(s.after)[TERM[key]]
    return lag.value, lag.error * REACH


def _matters(s: Selection, key: str) -> bool:
    """Whether the term takes more of the training mean square than what a balance errs by."""
    p = s.problem
    without = p.fit(np.delete(s.columns, p.place(TERM[key]), axis=1)).residual[p.train]
    return 1.0 - s.fitted_square / max(float(np.mean(without**2)), 1e-300) > limits.MARGIN


def _of_encoders(selections: Selections, declared: Declared) -> Late | None:
    """On a log of the emulator's own boards a measurement may have waited for the bus."""
    least = limits.SMALLEST_LAG_S + (limits.BUS_WAIT_S if declared.own else 0.0)
    late: dict[str, Late] = {}
    for key, column in (("K", "tachometers"), ("S", "velocity")):
        s = selections.get(key)
        if s is None or s.problem.blocks < limits.FEWEST_BLOCKS:
            continue
        value, reach = _lag(s, key)
        delay = SOUND.get(key, (0.0, 0.0))[0] - value
        sure = abs(delay) > max(least, limits.LAG_OVER_ERROR * reach) and reach < limits.SURE_LAG_S
        if sure and _matters(s, key):
            late[key] = Late(column=column, delay=delay, reach=reach)
    both = len(late) == 2 and abs(late["K"].delay - late["S"].delay) < limits.SAME_LAG * abs(late["K"].delay)
    if both:  # what they are compared with
        return Late(column="position", delay=-late["K"].delay, reach=late["K"].reach)
    return late.get("K", late.get("S"))


def _of_currents(selections: Selections, declared: Declared) -> Late | None:
    """Currents that come late make a torque that leads by the delay, but for a train's lag.

    A loop may change its effort from tick to tick while only every second tick is logged. Sound currents then
    look late against the effort, but not against the motion. So both must show the delay.
    """
    if "T" not in selections or "E" not in selections:
        return None
    s = selections["T"]
    value, reach = _lag(s, "T")
    delay, volts = -value - declared.gear_lag_s, _lag(selections["E"], "E")[0]
    if delay <= max(limits.LATE_CURRENT_S, limits.CURRENT_OVER_ERROR * reach) or not _matters(s, "T"):
        return None
    by_volts = volts - limits.SOUND_LAG_S > limits.CONFIRMED * delay
    seen = by_volts and delay > limits.CONFIRMED * (volts - SOUND_MIDDLE_S)
    return Late(column="current", delay=delay, reach=reach) if seen else None


def _of_volts(selections: Selections, declared: Declared) -> Late | None:
    """Of which column is not known; the emulator's own boards log every second tick of the effort."""
    s = selections.get("E")
    if s is None or s.chosen:
        return None
    value, reach = _lag(s, "E")
    slack = limits.SLACK_S + (limits.TICK_S if declared.own else 0.0)
    sound = limits.SOUND_VOLTS_LAG_S[0] - slack <= value <= limits.SOUND_VOLTS_LAG_S[1] + slack
    if sound or reach >= limits.SURE_VOLTS_LAG_S or not _matters(s, "E"):
        return None
    return Late(column="current or effort", delay=abs(value - SOUND_MIDDLE_S), reach=reach)
