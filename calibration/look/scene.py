"""The balances of an axis with two motors as the names see them."""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.frame import fill
from calibration.balances.problem import Problem
from calibration.balances.torque import Torque
from calibration.inputs.declaration import Response
from calibration.look.axis_result import AxisResult
from calibration.names.pair import Pair
from calibration.names.scene import Scene

#: what a balance's response is, by its channel
RESPONSES = {"T": "current", "E": "voltage", "K": "motor", "S": "rate"}
#: columns of the log that a scene holds at full rate, gaps bridged
FILLED = ("current_a", "current_b", "effort", "motor_a", "motor_b", "velocity", "temperature", "supply")


def scene_of_pair(result: AxisResult, torque: Torque, residual: Array) -> Scene:
    """Of the torque; `residual` (n_analysis,) N m of the declared model."""
    frame, m, drive = result.frame, result.motion, torque.drive
    a, b = (fill(frame.columns[f"current_{k}"], frame.run)[0] for k in "ab")
    torques = (drive.per_ampere * m.at(drive.left["a"] * a), -drive.per_ampere * m.at(drive.left["b"] * b))
    effort = m.at(fill(frame.columns["effort"], frame.run)[0])
    turns = frame.scale["gear_ratio"] / (2 * np.pi)
    pair = Pair(
        motion=m,
        sliding=torque.friction,
        torque=torques,
        turns=tuple((m.x[m.rows] + x / drive.stiffness) * turns for x in torques),
        lagging=np.where(effort > 0, torques[1], torques[0]),
        load=torque.problem.y - residual,
        softness_s2=drive.softness_s2,
    )
    declared = {"coulomb": torque.friction.coulomb, "viscous": torque.friction.viscous}
    return scene_of_balance(pair, torque.problem, residual, declared)


def scene_of_balance(pair: Pair, problem: Problem, residual: Array, declared: dict[str, float]) -> Scene:
    """Of any balance of the axis; `residual` of the declared model."""
    m, frame = pair.motion, pair.motion.frame
    columns = {k: fill(frame.columns[k], frame.run)[0] for k in FILLED if frame.get(k) is not None}
    rig, rows = m.rig, m.rows if pair.motor is None else np.tile(m.rows, 2)
    if problem.channel == "S":  # the roller's encoder, not its gear, is between the two
        own = [g for g in rig.stages if g.name == pair.train.one("roller")]
        rig = replace(rig, stages=tuple(replace(g, kind="encoder_eccentricity") for g in own))
    response = Response(RESPONSES[problem.channel], problem.unit)
    view = replace(m, rig=rig, response=response, columns=m.columns | columns, rows=rows)
    return Scene(view, problem, declared, residual, np.zeros((len(residual), 0)), pair=pair)
