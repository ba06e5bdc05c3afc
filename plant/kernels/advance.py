"""Advance whole axes over whole grid steps: the one call that the plant makes into compiled code."""

from plant.compiled import Floats, inner, kernel
from plant.kernels import layout as at
from plant.kernels.readings import keep, read, record
from plant.kernels.step import axis_step


@inner
def advance_axis(w: Floats, steps: int) -> None:
    """Advance one axis by `steps` grid steps and fill its readings (0 steps: the readings only)."""
    h = w[at.GRID]
    every = int(w[at.RECORD_EVERY])
    delayed = w[at.DELAY_ON] > 0.0
    for _ in range(steps):
        t = w[at.STEP] * h
        axis_step(w, t, h)
        for m in range(2):
            w[at.MEAN_DUTY + m] = w[at.DUTY + m]
        if every > 0 and int(w[at.STEP]) % every == 0:
            record(w, t + h)
        if delayed:
            read(w)
            keep(w)
    if not delayed or steps == 0:
        read(w)
    if delayed and steps == 0:
        keep(w)


@kernel
def advance(world: Floats, steps: int) -> None:
    """Advance every axis (rows of `world`, see layout.py) by `steps` grid steps."""
    for k in range(world.shape[0]):
        advance_axis(world[k], steps)
