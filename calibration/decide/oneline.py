"""Two lines that a log at one speed does not tell apart are one, whose size or rate changes along the log."""

from dataclasses import replace
from itertools import product

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.decide.heldout import compare
from calibration.decide.scan import Contender
from calibration.decide.selection import Selection
from calibration.names.lines import on_clock
from calibration.names.scene import Scene

# cycles by which two lines part within the travel, before it tells them apart (Rayleigh). definition
PARTED = 1.0


def one_line(s: Selection, scene: Scene) -> Selection:
    """Of a line of no stage and one on the clock beside it the latter stays, unless held-out rows refuse it.

    A line that fades in is a line and one next to it. The second has a name of its own by accident alone.
    """
    for place, clock in product(range(len(s.chosen)), repeat=2):
        if not _beside(scene, s.candidates[place], s.candidates[clock]):
            continue
        why = f"the log does not tell its line from that of {s.candidates[clock].say()}"
        on_the_clock = [s.put(clock, c).without(place, why) for c in _either(s, scene, place, clock)]
        rather = s.without(clock)
        held = (compare(s.problem, c.model, rather.model, rather.after.whitener) for c in on_the_clock)
        if not all(one.sure for one in held):
            return one_line(min(on_the_clock, key=lambda c: c.fitted_square), scene)
        why = f"the log does not tell its line from that of {s.candidates[place].say()}"
        return one_line(s.without(clock, why), scene)
    return s


def _either(s: Selection, scene: Scene, place: int, clock: int) -> list[Contender]:
    """The line on the clock as it was found, and where the one over the place was."""
    x, hertz = s.chosen[clock], _rate(scene, s.candidates[place]) * abs(scene.one_speed[0])
    return [x, replace(x, candidate=x.candidate.moved(np.array([hertz])))]


def _beside(scene: Scene, place: Candidate, clock: Candidate) -> bool:
    """Whether a line of no stage and one on the clock part by less than a cycle, where the speed is one."""
    if (place.kind, clock.kind) != ("line", "line") or place.order is None or place.stage is not None:
        return False
    rate = _rate(scene, place)
    if clock.shape is None or clock.free != ["frequency"] or not on_clock(scene, rate):
        return False
    return abs(rate - float(clock.point[0]) / abs(scene.one_speed[0])) * scene.span < PARTED


def _rate(scene: Scene, place: Candidate) -> float:
    """Cycles per position unit of a line over the place, as refined."""
    order, _ = place.fixed.get("order", (place.order or 0.0, ""))
    return order / scene.turn
