"""The pins of an axis: what a board may drive, and how wide the counters are."""

from math import pi

import pytest

from plant.kernels import layout as at
from plant.plant import Plant
from tests.plant.bench import bare


@pytest.fixture
def plant() -> Plant:
    return Plant(bare(), 1)


@pytest.mark.parametrize("duties", [(-0.01, 0.0), (0.0, -0.01), (1.01, 0.0), (0.0, 1.01), (0.0, 2.0)])
def test_a_duty_outside_of_the_whole_range_is_an_error(plant: Plant, duties: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="duty cycles must lie within"):
        plant.ra.drive(0, *duties)
    plant.ra.drive(0, 0.0, 1.0)
    plant.ra.drive(0, 1.0, 0.0)


def test_a_duty_within_a_grid_step_counts_for_the_rest_of_it(plant: Plant) -> None:
    """A quarter of the step is over, so that three quarters of it are driven."""
    plant.ra.drive(plant.grid_ns // 4, 0.8, 0.4)
    mean = plant.world[0, at.MEAN_DUTY : at.MEAN_DUTY + 2]
    assert mean == pytest.approx([0.6, 0.3], rel=1e-3)


def reads(plant: Plant, reading: int, count: float) -> None:
    """Let a counter of the plant stand at a count."""
    plant.world[0, at.OUT + reading] = count
    plant.world[0, at.OUT + reading + 1] = 0.0


@pytest.mark.parametrize("count", [-7, -1, 0, 1, 2, 70_001])
def test_counts_since_the_start_have_no_bounds(plant: Plant, count: int) -> None:
    pins = {
        at.OUT_INCREMENTAL: plant.ra.incremental,
        at.OUT_TACH_A: plant.ra.tachometer_a,
        at.OUT_TACH_B: plant.ra.tachometer_b,
    }
    for reading, pin in pins.items():
        reads(plant, reading, count + 0.5)
        assert pin(0) == count


@pytest.mark.parametrize("turns", [-1, 0, 3])
def test_positions_return_after_a_turn(plant: Plant, turns: int) -> None:
    """29 bit of the encoder on the shaft, 17 of the geared one (paper, section 2)."""
    for reading, pin, bits in (
        (at.OUT_ABSOLUTE, plant.ra.absolute, 29),
        (at.OUT_AUXILIARY, plant.ra.auxiliary, 17),
    ):
        for step in (0, 1, 2, 2 ** (bits - 1), 2**bits - 1):
            reads(plant, reading, turns * 2**bits + step + 0.5)
            assert pin(0) == step


def test_a_drive_turns_the_encoders_by_their_steps() -> None:
    plant = Plant(bare(), 1)
    before = plant.ra.absolute(0), plant.ra.auxiliary(0)
    plant.ra.drive(0, 0.5, 0.05)
    after_ns = 20_000_000_000
    angle, rate = plant.ra.truth(after_ns)
    assert angle > 0 and rate > 0
    turned = (plant.ra.absolute(after_ns) - before[0]) % 2**29
    assert turned == pytest.approx(angle / (2 * pi) * 2**29, rel=1e-3)


def test_the_truth_is_that_of_the_time_that_is_asked_for() -> None:
    plant, other = Plant(bare(), 1), Plant(bare(), 1)
    for each in (plant, other):
        each.ra.drive(0, 0.5, 0.05)
    later_ns = 50_000_000
    other.advance(later_ns)
    assert plant.ra.truth(later_ns) == other.ra.truth(later_ns)
    assert plant.now_ns == other.now_ns > 0
