"""An effort of few values, as a relay's or torque steps: no balance of it is tested, but its motion is."""

from dataclasses import replace

import numpy as np

from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.decide.thresholds import PLAINLY
from calibration.inputs.declaration import Response
from calibration.inputs.run import Run, numbers
from calibration.look.delay import Make

MOVES = ("effort", "current", "force")  # channels that accelerate a drive


def few_values(view: View, records: list[Run], made: Make) -> tuple[str, str]:
    """Why a response of fewer values than the model has terms tests nothing; and what is explained instead.

    Where the motion follows it, that is the acceleration, by it as `applied`: then the view's response.
    One of the two texts is empty, both where the response has more values.
    """
    channel, problem = view.response.channel, made(0.0)
    terms, logged = problem.base.shape[1], numbers(records, channel)
    values = len(np.unique(logged if len(logged) else problem.y))
    if values > terms:
        return "", ""
    why = f"{channel} holds {values} values, the model has {terms} terms"
    before = view.rig, view.response, view.columns
    if channel in MOVES and "inertia" in view.rig.estimate and not view.rig.constants:
        _turn_round(view)
        if _takes(made(0.0)) > PLAINLY:
            return (
                "",
                f"{why}: the acceleration is explained, per unit of the inertia, by {channel} as `applied`",
            )
        view.rig, view.response, view.columns = before
    as_response = "as response take a measured force, or `acceleration` with it as `applied`"
    return f"{why}: it tests no balance; {as_response}", ""


def _turn_round(view: View) -> None:
    r, rig = view.response, view.rig
    terms = tuple("applied" if name == "inertia" else name for name in rig.estimate)
    effort = replace(rig.columns[r.channel], unit=r.unit)
    view.rig = replace(rig, estimate=terms, columns={**rig.columns, "applied": effort})
    view.columns = {**view.columns, "applied": view.columns[r.channel] * r.gain}
    view.response = Response("acceleration", f"{view.angle_unit}/s2")


def _takes(p: Problem) -> float:
    """Share of the square on fitted rows that what is applied takes, beside the other terms."""
    k = p.place("applied")
    without = replace(
        p, base=np.delete(p.base, k, axis=1), base_labels=[*p.base_labels[:k], *p.base_labels[k + 1 :]]
    )
    left, more = (float(np.sum(q.plain_fit(p.train)[1][p.train] ** 2)) for q in (p, without))
    return 1 - left / more if more > 0 else 0.0
