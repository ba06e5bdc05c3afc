"""Advance whole axes over whole grid steps: the one call that the plant makes into compiled code."""

from plant.compiled import Floats, inner, kernel
from plant.kernels import layout as at
from plant.kernels.readings import keep, read, record
from plant.kernels.step import axis_step


@inner
def one_step(w: Floats) -> None:
    """Advance one axis by a grid step."""
    h = w[at.GRID]
    t = w[at.STEP] * h
    axis_step(w, t, h)
    for m in range(2):
        w[at.MEAN_DUTY + m] = w[at.DUTY + m]
    every = int(w[at.RECORD_EVERY])
    if every > 0 and int(w[at.STEP]) % every == 0:
        record(w, t + h)
    if w[at.DELAY_ON] > 0.0:
        read(w)
        keep(w)


@inner
def show(w: Floats, steps: int) -> None:
    """Fill the readings of one axis after `steps` grid steps."""
    delayed = w[at.DELAY_ON] > 0.0
    if not delayed or steps == 0:
        read(w)
    if delayed and steps == 0:
        keep(w)


@inner
def advance_axis(w: Floats, steps: int) -> None:
    """Advance one axis alone by `steps` grid steps and fill its readings (0 steps: the readings only)."""
    for _ in range(steps):
        one_step(w)
    show(w, steps)


@kernel
def advance(world: Floats, steps: int) -> None:
    """Advance every axis (rows of `world`, see layout.py) by `steps` grid steps, on one supply."""
    for _ in range(steps):
        drawn = 0.0
        for k in range(world.shape[0]):
            drawn += world[k, at.SUPPLY_CURRENT]
        for k in range(world.shape[0]):
            others = drawn - world[k, at.SUPPLY_CURRENT]
            world[k, at.OTHERS_SAG] = world[k, at.SUPPLY_RESISTANCE] * others
        for k in range(world.shape[0]):
            one_step(world[k])
    for k in range(world.shape[0]):
        show(world[k], steps)
