"""What goes out to both motors when duties are finer than a step, and what the routine then costs."""

import math

import pytest

from bus.protocol import AxisMode, AxisParameter, Result
from tests.boards.lab import Lab

FIRST = AxisParameter.HARMONIC_FIRST
CONSTANT = {FIRST + 1: 50 << 8, AxisParameter.COMPENSATION: 1}
"""A line of order 0: fifty steps everywhere."""


def put(lab: Lab, values: dict[int, int]) -> None:
    for number, value in values.items():
        assert lab.axis.parameters.set(number, value) == (Result.OK, number, value)


def driven(lab: Lab, effort: float, command: int | None = None) -> tuple[float, float, int]:
    """Duties in steps, and the effort that is told, of one tick with this effort of the loop."""
    axis = lab.axis
    axis.pi.replace(round(effort * 65536))
    now_ns = lab.queue.now_ns
    assert axis.fine is not None
    told = axis.fine.drive(now_ns, axis.clock_ns(now_ns), 0, 0, command)
    _, duty_a, duty_b = lab.plant.pending[-1]
    return round(duty_a * 3000, 4), round(duty_b * 3000, 4), told


@pytest.mark.parametrize(("effort", "duties"), [
    (100.0, (150, 15, 150)), (100.4, (150, 15, 150)), (100.6, (151, 15, 151)), (-200.0, (15, 150, -150)),
    (2999.0, (3000, 300, 3000)), (-20.0, (30, 3, 30)),
])  # fmt: skip
def test_B1_the_compensation_is_added_up_to_the_supply(
    lab: Lab, effort: float, duties: tuple[int, int, int]
) -> None:
    """Fifty steps, then a tenth of the sum for the motor that lags; whole steps."""
    put(lab, CONSTANT)
    assert driven(lab, effort) == duties


def test_B1_without_a_position_or_with_a_command_nothing_is_added(lab: Lab) -> None:
    put(lab, CONSTANT)
    lab.axis.counter.follow(70, 0)
    assert driven(lab, 100.0, command=70) == (70, 7, 70)
    assert driven(lab, 100.0, command=-70) == (7, 70, -70)
    lab.axis.motion.forget()
    assert driven(lab, 100.0) == (100, 10, 100)


@pytest.mark.parametrize(("effort", "duties"), [(100.0, (140, 50, 100)), (-100.0, (50, 140, -100))])
def test_B1_the_bias_comes_on_top_of_both_while_there_is_power(
    lab: Lab, effort: float, duties: tuple[int, int, int]
) -> None:
    put(lab, {AxisParameter.COUNTER_BIAS_Q8: 40 << 8})
    assert driven(lab, effort) == duties
    lab.axis.motion.off()
    assert driven(lab, effort)[:2] == (duties[0] - 40, duties[1] - 40)


def test_B1_a_compensation_that_is_switched_on_begins_without_friction(lab: Lab) -> None:
    put(lab, {**CONSTANT, AxisParameter.FRICTION_LEVEL_Q8: 80 << 8})
    lab.axis.output.compensator.effort_q16(0, 0, 1 << 16)
    assert driven(lab, 100.0)[2] == 230
    put(lab, {AxisParameter.COMPENSATION: 0})
    assert lab.axis.fine is None
    put(lab, {AxisParameter.COMPENSATION: 1})
    assert driven(lab, 100.0)[2] == 150


@pytest.mark.parametrize(("values", "cycles"), [
    ({AxisParameter.COUNTER_BIAS_Q8: 1}, 10), ({AxisParameter.RATE_LOCK: 1}, 140),
    ({AxisParameter.POSITION_BLEND: 3}, 100), ({AxisParameter.COMPENSATION: 1}, 60),
    ({AxisParameter.OBSERVER_FIRST + 2: 1 << 28, AxisParameter.OBSERVER: 1}, 900),
    ({AxisParameter.COMPENSATION: 1, FIRST + 22: 1, FIRST + 20: -1}, 60 + 2 * 120),
])  # fmt: skip
def test_B1_each_addition_books_its_cycles_and_gives_them_back(
    lab: Lab, values: dict[int, int], cycles: int
) -> None:
    put(lab, values)
    assert lab.axis.cost_ns == math.ceil((1200 + cycles) * 1e9 / 30e6)
    put(lab, dict.fromkeys(values, 0))
    assert lab.axis.cost_ns == 40_000
    assert lab.axis.motion.mode is AxisMode.STOP


@pytest.mark.parametrize(
    "number", [AxisParameter.DUTY_FRACTION, AxisParameter.COMPENSATION, AxisParameter.COUNTER_BIAS_Q8]
)
def test_B1_the_papers_way_is_left_for_what_needs_it_alone(lab: Lab, number: int) -> None:
    put(lab, {AxisParameter.RATE_LOCK: 1, AxisParameter.POSITION_BLEND: 9})
    assert lab.axis.fine is None
    put(lab, {number: 1})
    assert lab.axis.fine is lab.axis.output
    put(lab, {number: 0})
    assert lab.axis.fine is None


def test_B1_a_coefficient_that_changes_switches_the_observer_off(lab: Lab) -> None:
    on, first = AxisParameter.OBSERVER, AxisParameter.OBSERVER_FIRST
    assert lab.axis.parameters.set(on, 1) == (Result.OK, on, 0)  # no observer yet
    put(lab, {first + 2: 1 << 28, on: 1, first + 24: 5})
    assert lab.axis.parameters.get(on).value == 0
    assert lab.axis.parameters.set(on, 2).result == Result.OUT_OF_RANGE
