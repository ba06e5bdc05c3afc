"""Steps, records and kept readings of an axis that coasts at constant rate; the supply of two axes."""

import numpy as np
import pytest

from plant.compiled import Floats
from plant.kernels import layout as at
from plant.kernels.advance import advance, advance_axis
from plant.plant import Plant
from tests.plant.bench import bare

H = 1e-3
RATE = 0.25


def coasting(record_every: float = 0.0, kept: float = 0.0) -> Floats:
    """No friction, no motors; angle 1 rad, half a step after the start."""
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.RATE], w[at.RATE_BEFORE], w[at.ANGLE] = H, RATE, RATE, 1.0
    w[[at.INERTIA, at.ROTOR_INERTIA, at.RATIO, at.RESISTANCE, at.STRIBECK]] = 1.0
    w[at.DECLARED_FRICTION : at.DECLARED_FRICTION + at.FRICTION_SIZE - 1] = 1.0
    w[[at.DECLARED_FRICTION + k for k in (at.F_SIGMA0, at.F_SIGMA1, at.F_SIGMA2)]] = 1e-12, 0.0, 0.0
    w[at.RECORD_EVERY], w[at.DELAY_ON], w[at.DUTY], w[at.DUTY + 1] = record_every, kept, 0.5, 0.25
    return w


def angle_after(steps: int) -> float:
    return 1.0 + (steps - 0.5) * RATE * H


@pytest.mark.parametrize(("every", "steps"), [(0, []), (1, [1, 2, 3, 4, 5]), (2, [2, 4]), (5, [5]), (6, [])])
def test_every_so_many_steps_are_recorded(every: int, steps: list[int]) -> None:
    w = coasting(record_every=every)
    advance_axis(w, 5)
    ring = w[at.TRUTH : at.TRUTH + at.TRUTH_ROWS * at.TRUTH_SIZE].reshape(-1, at.TRUTH_SIZE)
    assert w[at.STEP] == 5.0 and w[at.RECORDED] == len(steps)
    assert ring[: len(steps), 0] == pytest.approx([k * H for k in steps])
    assert ring[: len(steps), 1] == pytest.approx([angle_after(k) for k in steps], abs=1e-9)


def test_the_mean_duty_of_a_step_begun_is_the_one_in_force() -> None:
    w = coasting()
    w[at.MEAN_DUTY], w[at.MEAN_DUTY + 1] = 0.9, 0.8
    advance_axis(w, 1)
    assert w[at.MEAN_DUTY : at.MEAN_DUTY + 2].tolist() == [0.5, 0.25]


@pytest.mark.parametrize("kept", [0.0, 1.0])
@pytest.mark.parametrize("steps", [0, 3])
def test_readings_are_there_after_any_steps_and_kept_when_asked_for(steps: int, kept: float) -> None:
    w = coasting(kept=kept)
    advance_axis(w, steps)
    assert w[at.OUT + at.OUT_ANGLE] == pytest.approx(angle_after(steps), abs=1e-9)
    ring = w[at.DELAYS : at.DELAYS + at.DELAY_ROWS * at.OUT_SIZE].reshape(-1, at.OUT_SIZE)
    told = [0] if steps == 0 else [1, 2, 3]
    expected = np.zeros(at.DELAY_ROWS)
    expected[told] = [kept * angle_after(k) for k in told]
    assert ring[:, at.OUT_ANGLE] == pytest.approx(expected, abs=1e-9)


def test_P4_an_axis_sags_by_what_the_others_drew_in_the_step_before() -> None:
    world = Plant(bare(), 1).world
    world[:, at.SUPPLY_CURRENT] = 3.0, 5.0
    world[:, at.SUPPLY_RESISTANCE] = 0.5
    advance(world, 1)
    assert world[:, at.OTHERS_SAG] == pytest.approx([2.5, 1.5])
    drawn = world[:, at.SUPPLY_CURRENT].copy()
    advance(world, 1)
    assert world[:, at.OTHERS_SAG] == pytest.approx(0.5 * drawn[::-1])
    assert world[:, at.STEP].tolist() == [2.0, 2.0]


def test_readings_of_every_axis_are_filled() -> None:
    world = np.stack([coasting(), coasting()])
    advance(world, 3)
    assert world[:, at.OUT + at.OUT_ANGLE] == pytest.approx([angle_after(3)] * 2, abs=1e-9)
