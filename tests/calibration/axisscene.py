"""The scene of an axis with two motors without a log: rows as they are, no filter."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.frame import Frame
from calibration.balances.motion import motion_of
from calibration.balances.problem import Problem
from calibration.inputs.rigfile import telescope
from calibration.look.scene import scene_of_balance
from calibration.names.pair import Pair
from calibration.names.scene import Scene


def stacked(problem: Problem, position: Array, declared: dict[str, float]) -> Scene:
    """Of motor A's rows, then motor B's; `position` (n,) rad of the axis on a motor's rows."""
    n = len(position)
    zero, label = np.zeros(n), np.zeros(n, dtype=np.int64)
    t = problem.t[:n]
    frame = Frame(
        runs=[],
        period_s=problem.period_s,
        t=t,
        clock=zero,
        run=problem.run[:n],
        session=label,
        columns={"position": position},
        scale={},
        rig=telescope("ra"),
    )
    pair = Pair(motion=motion_of(frame, 1), motor=np.repeat([0.0, 1.0], n))
    return scene_of_balance(pair, problem, np.zeros(2 * n), declared)
