"""What stands above the floor of a channel of an axis when the answer is given, and where it lives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.decide.missing import above_floor, lives_in
from calibration.decide.verdict import Verdict
from calibration.readers.drive import ARCSEC
from calibration.twomotors.result import SENSORS, AxisResult

#: of the report's domains, in words
SPOKEN = {
    "axis angle": "axis_angle",
    "speed and direction": "velocity",
    "time": "time",
    "motor angle": "motor_angle",
}

# floors that are left before they are an effect without a name, or a reason not to say "nothing": the
# emulator's own sound logs, whose boards keep clocks of their own, leave 4.1 at most
# (tests/calibration/test_own_logs.py), a brush that sticks at times 5.5 (development seed 1043)
EFFECT = 5.0
# of what is left, over one domain: fewer floors are an effect, too. The same sound logs have 0.29 at most, a
# drag with the square of the speed 0.49 (development seed 1061)
MOST = 0.4


@dataclass(frozen=True)
class Above:
    """A channel that is still above twice its floor: the domain it lives in, where one shows it, and so in
    words; `effect` where so much is left that it is more than how boards keep time."""

    channel: str
    domain: str | None
    text: str
    effect: bool


def still_missing(result: AxisResult, v: Verdict) -> list[Above]:
    """Every channel that is still above twice its floor."""
    m = result.motion
    n = len(m.pick)
    turn, rate = m.theta[m.pick] / (2 * np.pi), m.rate[m.pick] / ARCSEC
    values = (
        turn,
        np.sign(rate) * np.log1p(np.abs(rate)),
        result.frame.t[m.pick],
        (turn * result.frame.train.ratio) % 1.0,
    )
    domains = dict(zip(SPOKEN, values, strict=True))
    rows = {row: key for key, row in SENSORS.items()}
    out = []
    for row, ratio in above_floor(v.error).items():
        key = rows[row]
        s = result.selections[key]
        long = {k: np.resize(x, len(s.problem.y)) for k, x in domains.items()}
        times, rest = divmod(len(s.problem.y), n)
        place, share, where = lives_in(s, long, times) if rest == 0 else (None, 0.0, "not looked for")
        text = f"something is still missing in {row}: {ratio:.1f} floors are left, {where}"
        out.append(Above(key, SPOKEN[place] if place else None, text, ratio > EFFECT or share > MOST))
    return out
