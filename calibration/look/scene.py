"""The balances of an axis with two motors as the names see them."""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.context import direction_of, since_reversal
from calibration.balances.frame import Frame, fill
from calibration.balances.friction import Sliding, path_of
from calibration.balances.motion import Motion
from calibration.balances.problem import Problem
from calibration.balances.torque import Torque
from calibration.balances.view import View
from calibration.inputs.declaration import Response, Rig, Stage
from calibration.inputs.thresholds import HARMONICS
from calibration.inputs.train import SHAFT, Train
from calibration.look.axis_result import AxisResult
from calibration.names.pair import Pair
from calibration.names.scene import Scene

# rad, 0.4 arcsec: more than the encoder's noise, less than the pre-sliding range. ASSUMPTION
DIRECTION_TRAVEL = 2e-6
#: what a balance's response is, by its channel
RESPONSES = {"T": "current", "E": "voltage", "K": "motor", "S": "rate"}
#: columns of the log that a scene holds at full rate, gaps bridged
FILLED = ("current_a", "current_b", "effort", "motor_a", "motor_b", "velocity", "temperature", "supply")


def scene_of_pair(result: AxisResult, torque: Torque, residual: Array) -> Scene:
    """Of the torque; `residual` (n_analysis,) N m of the declared model."""
    frame, m, drive = result.frame, result.motion, torque.drive
    step = np.gradient(m.theta)
    sliding = Sliding(
        law=torque.friction.law,
        path=path_of(m),
        side=np.sign(step),
        speed=step * m.width / m.period_s,
        coulomb=torque.friction.coulomb,
        viscous=torque.friction.viscous,
    )
    a, b = (fill(frame.columns[f"current_{k}"], frame.run)[0] for k in "ab")
    torques = (drive.per_ampere * m.at(drive.left["a"] * a), -drive.per_ampere * m.at(drive.left["b"] * b))
    effort = m.at(fill(frame.columns["effort"], frame.run)[0])
    turns = frame.scale["gear_ratio"] / (2 * np.pi)
    pair = Pair(
        frame=frame,
        motion=m,
        sliding=sliding,
        torque=torques,
        turns=tuple((m.theta[m.pick] + x / drive.stiffness) * turns for x in torques),
        lagging=np.where(effort > 0, torques[1], torques[0]),
        load=torque.problem.y - residual,
        softness_s2=drive.softness_s2,
    )
    declared = {"coulomb": torque.friction.coulomb, "viscous": torque.friction.viscous}
    return scene_of_balance(pair, torque.problem, residual, declared)


def scene_of_balance(pair: Pair, problem: Problem, residual: Array, declared: dict[str, float]) -> Scene:
    """Of any balance of the axis; `residual` of the declared model."""
    frame, m, train = pair.frame, pair.motion, pair.train
    view = view_of_pair(frame, m)
    view.response = Response(RESPONSES[problem.channel], problem.unit)
    view.columns |= {k: fill(frame.columns[k], frame.run)[0] for k in FILLED if frame.get(k) is not None}
    view.since = since_reversal(m.theta, direction_of(m.theta, frame.run, DIRECTION_TRAVEL), frame.run)
    if pair.motor is not None:
        view.rows = np.tile(m.pick, 2)
    if problem.channel == "S":  # the roller's encoder, not its gear, is between the two
        own = [g for g in view.rig.stages if g.name == train.one("roller")]
        view.rig = replace(view.rig, stages=tuple(replace(g, kind="encoder_eccentricity") for g in own))
    return Scene(view, problem, declared, residual, np.zeros((len(residual), 0)), pair=pair)


def view_of_pair(frame: Frame, m: Motion) -> View:
    """The motion's columns at full rate, rad and s."""
    return View(
        rig=_in_radians(frame.rig, frame.train),
        response=Response("current", "N m"),
        period_s=frame.period_s,
        filter=m.filter,
        t=frame.t,
        clock=frame.one_clock,
        file=frame.run,
        segment=frame.run,
        run=frame.run,
        columns={"position": m.theta},
        ok=m.trusted,
        rows=m.pick,
        dynamic=True,
        turn=2 * np.pi,
        speed=m.rate,
        direction=np.sign(np.gradient(m.theta)),
    )


def _in_radians(rig: Rig, train: Train) -> Rig:
    """The rig with the stages whose torque the axis feels, periods in rad; its position is absolute."""
    shafts = dict.fromkeys(train.shafts, SHAFT)
    stages = tuple(
        Stage(name, 2 * np.pi / order, None, HARMONICS, shafts.get(name, train.kinds[name]))
        for name, order in train.orders.items()
        if train.kinds[name] not in ("axis", "sensor")  # a sensor may be on a shaft of its own
    )
    return replace(rig, stages=stages, runs={"origin": "shared"})
