"""What a board and its bridges do to the volts of a row, taken into the base where the log shows it."""

from __future__ import annotations

import numpy as np

from calibration.channels.between import unlogged_errors
from calibration.channels.duties import counter_share, duties
from calibration.channels.frame import Frame
from calibration.channels.motion import Motion
from calibration.channels.problem import Problem
from calibration.channels.register import register_error
from calibration.readers.run import Array
from calibration.statistics.regression import gls, under

SURE = 4.0  # standard errors
MORE = 25.0  # log likelihood that a column must explain beyond the base without it


def between_rows(p: Problem, frame: Frame, m: Motion, effort: Array, supply: Array) -> None:
    """Add what the unlogged tick's effort differed by to the base, as far as the log shows it: by the motion,
    and by a set point that was held between the rows."""
    logged = duties(frame, effort)
    for error, label in zip(
        unlogged_errors(frame), ("gain_between_rows", "gain_of_held_set_point"), strict=False
    ):
        duty = duties(frame, effort + error / frame.scale["effort_full_scale"])
        column = -np.concatenate([m.at((duty[k] - logged[k]) * supply) for k in "ab"])
        adopt(p, column, label)


def held_register(p: Problem, frame: Frame, m: Motion, effort: Array, supply: Array) -> None:
    """Add a lagging register that waits for a whole step to the base, where the log shows it."""
    off = register_error(frame, effort, counter_share(frame)) * supply / frame.scale["effort_full_scale"]
    column = -np.concatenate([m.at(np.where(s * effort < 0, off, 0.0)) for s in (1.0, -1.0)])
    adopt(p, column, "held_counter_register")


def adopt(p: Problem, column: Array, label: str, unit: str = "1", least: float = 0.0) -> None:
    """Add a column to the base whose coefficient is surely positive and above `least`, if it explains more
    than chance."""
    base = np.column_stack([p.base, column])
    fit = gls(p.y, base, p.train, p.ar_order, p.block)
    gained = fit.loglik - under(p.y, p.base, p.train, fit.whitener)
    if gained > MORE and fit.beta[-1] > max(SURE * np.sqrt(fit.covariance[-1, -1]), least):
        p.base = base
        p.base_labels.append((label, unit))
