"""Pins over a kernel whose readings are straight lines of the time: in between, late, and of either axis."""

from math import floor

import numpy as np
import pytest
from numpy.typing import NDArray

from plant import grid as grid_of
from plant.axis import AxisPort
from plant.grid import Grid
from plant.kernels import layout as at

STEP_NS = 500_000
PROMPT = dict.fromkeys(("effort", "position", "velocity", "currents", "tachometers"), 0)
PINS = {
    "incremental": (at.OUT_INCREMENTAL, "velocity", -1),
    "absolute": (at.OUT_ABSOLUTE, "position", 2**29 - 1),
    "auxiliary": (at.OUT_AUXILIARY, "position", 2**17 - 1),
    "tachometer_a": (at.OUT_TACH_A, "tachometers", -1),
    "tachometer_b": (at.OUT_TACH_B, "tachometers", -1),
}
TIMES = (0, 499_999, 500_000, 500_001, 1_250_000, 3_000_000, 7_000_000, 7_000_001, 300_000_000, 301_700_000)


def line(axis: int, reading: int) -> tuple[float, float]:
    """Count at the start and counts per ns: a nanosecond beyond a grid point is a count more."""
    return 1000.0 * (axis + 1) + 10.0 * reading + 0.9995, 0.001 * (1 + axis + reading)


def ampere(axis: int, motor: int, step: int) -> float:
    return 100.0 * axis + 10.0 * motor + 0.001 * step


@pytest.fixture
def grid(monkeypatch: pytest.MonkeyPatch) -> Grid:
    def advance(world: NDArray[np.float64], steps: int) -> None:
        for axis, w in enumerate(world):
            for _ in range(max(steps, 1)):
                w[at.STEP] += min(steps, 1)
                step = int(w[at.STEP])
                out = np.zeros(at.OUT_SIZE)
                for reading in range(0, at.OUT_CURRENT_A, 2):
                    first, slope = line(axis, reading)
                    out[reading : reading + 2] = first + slope * step * STEP_NS, slope
                out[at.OUT_CURRENT_A :] = [ampere(axis, motor, step) for motor in (0, 1)]
                w[at.OUT : at.OUT + at.OUT_SIZE] = out
                ring = at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE
                w[ring : ring + at.OUT_SIZE] = out
                w[at.RATE] = 7.0 + axis

    monkeypatch.setattr(grid_of, "advance", advance)
    made = Grid(np.zeros((2, at.WIDTH)), STEP_NS)
    advance(made.world, 0)
    return made


def port(grid: Grid, row: int, **delays: int) -> AxisPort:
    return AxisPort(grid, row, PROMPT | delays, 29, 17)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("name", PINS)
def test_a_counter_is_read_between_grid_points_by_its_rate(grid: Grid, row: int, name: str) -> None:
    reading, _, mask = PINS[name]
    first, slope = line(row, reading)
    pin = getattr(port(grid, row), name)
    for t_ns in TIMES:
        assert pin(t_ns) == floor(first + slope * t_ns) & mask
        assert grid.now_ns == t_ns // STEP_NS * STEP_NS, "the plant has gone along"


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("name", PINS)
@pytest.mark.parametrize("delay_ns", [1, 500_000, 2_300_000, 120_000_000])
def test_a_late_counter_is_what_it_was_and_at_first_that_of_the_start(
    grid: Grid, row: int, name: str, delay_ns: int
) -> None:
    reading, column, mask = PINS[name]
    first, slope = line(row, reading)
    pin = getattr(port(grid, row, **{column: delay_ns}), name)
    for t_ns in TIMES:
        assert pin(t_ns) == floor(first + slope * max(0, t_ns - delay_ns)) & mask
        assert grid.now_ns == t_ns // STEP_NS * STEP_NS


def test_a_delay_of_another_column_changes_nothing(grid: Grid) -> None:
    for name, (reading, column, mask) in PINS.items():
        others = {word: 1_000_000 for word in PROMPT if word != column}
        first, slope = line(0, reading)
        assert getattr(port(grid, 0, **others), name)(9_000_000) == floor(first + slope * 9e6) & mask


def test_a_motor_has_its_own_tachometer(grid: Grid) -> None:
    pins = port(grid, 1)
    assert pins.tachometer(4_000_000, 0) == pins.tachometer_a(4_000_000)
    assert pins.tachometer(4_000_000, 1) == pins.tachometer_b(4_000_000) != pins.tachometer_a(4_000_000)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("motor", [0, 1])
@pytest.mark.parametrize("delay_ns", [0, 700_000, 120_000_000])
def test_a_current_is_that_of_a_grid_point(grid: Grid, row: int, motor: int, delay_ns: int) -> None:
    pins = port(grid, row, currents=delay_ns)
    for t_ns in TIMES:
        step = max(0, t_ns - delay_ns) // STEP_NS
        assert pins.current(t_ns, motor) == pytest.approx(ampere(row, motor, step), abs=1e-9)
        assert grid.now_ns == t_ns // STEP_NS * STEP_NS


@pytest.mark.parametrize("row", [0, 1])
def test_the_truth_is_read_between_grid_points(grid: Grid, row: int) -> None:
    first, slope = line(row, at.OUT_ANGLE)
    for t_ns in TIMES:
        assert port(grid, row).truth(t_ns) == pytest.approx((first + slope * t_ns, 7.0 + row), rel=1e-12)


@pytest.mark.parametrize("row", [0, 1])
def test_duties_count_from_when_they_are_set(grid: Grid, row: int) -> None:
    """A fifth of the step at 0, two at (0.5, 0.2) and two at (1, 0): 0.6 and 0.08 are its means."""
    pins = port(grid, row)
    base = 3 * STEP_NS
    pins.drive(base + 100_000, 0.5, 0.2)
    assert grid.now_ns == base
    pins.drive(base + 300_000, 1.0, 0.0)
    w = grid.world[row]
    assert w[at.DUTY : at.DUTY + 2].tolist() == [1.0, 0.0]
    assert w[at.MEAN_DUTY : at.MEAN_DUTY + 2] == pytest.approx([0.6, 0.08])
    assert not grid.world[1 - row, at.DUTY : at.OUT].any()


def test_a_duty_at_a_grid_point_is_that_of_the_next_step(grid: Grid) -> None:
    pins = port(grid, 0)
    pins.drive(STEP_NS, 0.5, 0.25)
    assert grid.now_ns == STEP_NS
    assert grid.world[0, at.MEAN_DUTY : at.MEAN_DUTY + 2].tolist() == [0.5, 0.25]
    with pytest.raises(ValueError, match=r"within 0\.\.1, not 1\.5, 0\.0"):
        pins.drive(STEP_NS, 1.5, 0.0)
