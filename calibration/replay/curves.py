"""The function that an `unknown` of the torque channel is, over a signal of the plant, with its interval."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.view import View
from calibration.decide.selection import Selection
from calibration.decide.thresholds import MODEL_ERROR
from calibration.finding import Curve
from calibration.names.unknown import SLOW_RATE
from calibration.statistics.tails import student_reach
from plant.evaluate import evaluate_function

# knots: three for each of a smooth function's eight splines. ASSUMPTION
POINTS = 24
# part of the normal matrix: holds knots in a gap of the data to a straight line. ASSUMPTION
STIFF = 1e-6


def places(domain: str, u: Array) -> Array:
    """Knots over the range of `u`, denser around zero speed."""
    low, high = float(u.min()), float(u.max())
    if domain != "velocity":
        return np.linspace(low, high, POINTS)
    first, last = (float(np.sign(x) * np.log1p(abs(x) / SLOW_RATE)) for x in (low, high))
    z = np.linspace(first, last, POINTS)
    return np.asarray(np.sign(z) * np.expm1(np.abs(z)) * SLOW_RATE)


def curve_of(s: Selection, index: int, view: View) -> Curve | None:
    """The torque on the axis that chosen effect `index` adds, over its domain; None where it is no function.

    Least squares of the plant's own interpolation through the effect's contribution on training rows. The
    half-widths follow from the covariance of its coefficients, with Student's reach over blocks.
    """
    chosen, rows = s.chosen[index].candidate, s.problem.train
    signals = {**view.columns, "axis_angle": view.x, "velocity": view.speed, "time": view.clock}
    torque = chosen.domain == "current"  # in whose stead the plant has the torque
    if chosen.kind == "line" or not (torque or chosen.domain in signals):
        return None
    domain = "torque" if torque else chosen.domain
    u = (s.problem.y if torque else signals[domain][view.rows])[rows]
    x = chosen.columns[rows]
    y = -(x @ s.sizes(index))
    variance = np.einsum("ij,jk,ik->i", x, s.covariance(index), x)
    if float(np.ptp(u)) <= 0.0:
        return None
    knots = places(domain, u)
    basis = np.column_stack([evaluate_function(knots, e, u) for e in np.eye(len(knots))])
    bend = np.diff(np.eye(len(knots)), 2, axis=0)
    weight = STIFF * float(np.trace(basis.T @ basis)) / len(knots)
    normal = basis.T @ basis + weight * bend.T @ bend
    values = np.linalg.solve(normal, basis.T @ y)
    spread = np.sqrt(np.maximum(np.linalg.solve(normal, basis.T @ variance), 0.0))
    blocks = max(int(rows.sum() / s.problem.block), 5)
    half = student_reach(max(blocks - 2, 3)) * np.hypot(spread, MODEL_ERROR * values)
    return Curve(domain, "N m", tuple(map(float, knots)), tuple(map(float, values)), tuple(map(float, half)))
