"""What volts show beyond the names: a current that follows the other motor's, brushes."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.balances.candidate import Candidate, waves
from calibration.finding import UNKNOWN, Finding
from calibration.names.candidates import candidate
from calibration.names.lines import line, of_stage
from calibration.names.scene import Scene
from calibration.names.unnamed import HARMONICS

# share: a lagging motor's current that follows the leading one's has 1. ASSUMPTION
FOLLOWS = 2.0


def of_volts(s: Scene) -> list[Candidate]:
    """Columns of an electrical balance that have no name in the catalogue."""
    w = s.windings
    if w is None or w.counter is None or s.pair is None:
        return _brushes(s)
    c, (a, b) = w.counter, np.split(w.rate, 2)
    # a lagging motor whose current follows the leading one's lacks that one's back-EMF, times its share
    leading = np.tile(np.where(c.lagging[: len(a)] > 0, b, a), 2)
    column, size = w.constant * w.at(c.share) * c.lagging * leading, ("following", "1")
    following = candidate(UNKNOWN, column, size, domain="current", sign=1, most=FOLLOWS)
    # brushes over the angle of either motor, as a resistance and as a voltage
    turned = waves(s.view.x[s.view.rows] * s.pair.train.ratio, range(1, HARMONICS + 1))
    more: dict[str, Any] = {"domain": "motor_angle", "kind": "line", "stage": "motor", "harmonic": 1}
    brushes = [
        candidate(UNKNOWN, turned * weight[:, None], ("amplitude", unit), fixed=motor, **more)
        for rows, motor in s.motors
        for weight, unit in ((rows, "V"), (rows * w.at(w.current), "ohm"))
    ]
    return [following, *brushes]


def _brushes(s: Scene) -> list[Candidate]:
    """A resistance over the declared motor's angle, harmonic by harmonic: a rig's zero may move."""
    motors = [replace(g, harmonics=HARMONICS, listed=()) for g in s.view.rig.stages if g.of_motor]
    blank = line(s, UNKNOWN, 0.0, ("amplitude", "ohm"), domain="motor_angle")
    return [c for g in motors for c in of_stage(s, g, blank, s.view.columns["current"])]


def followed(f: Finding) -> Finding:
    """A current that follows the other motor's, said in words: the catalogue has no name for it."""
    if "following" not in f.parameters:
        return f
    return replace(f, note="the lagging motor's current follows the leading one's, not its own duty")
