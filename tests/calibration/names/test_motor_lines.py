"""Lines of two motors: what the axis gets of a torque on a rotor, and which motor a residual says it is."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.names.lines import _waves, motor_lines
from calibration.names.scene import Scene

ROWS, RATIO, PERIOD_S = 4000, 20.0, 0.01
#: turns of the axis, 0.05 per s there and back
X = 0.3 * np.sin(2 * np.pi * np.arange(ROWS) / 2300)
A, B = (
    RATIO * (X + 0.002 * np.sin(np.arange(ROWS) / 90.0)),
    RATIO * (X - 0.003 * np.cos(np.arange(ROWS) / 70.0)),
)
NAME, SIZE = "motor_cogging", ("amplitude", "N m at the motor")


def scene(residual: np.ndarray, softness_s2: float = 0.0, boxcar: int = 0, **more: Any) -> Scene:
    speed = np.gradient(X, PERIOD_S) * 2 * np.pi
    parts = {
        "view": SimpleNamespace(
            speed=more.get("speed", speed),
            rows=np.arange(ROWS),
            filter=Filter(0.0, boxcar),
            period_s=PERIOD_S,
        ),
        "turn": 2 * np.pi,
        "unit": "N m",
        "pair": SimpleNamespace(
            softness_s2=softness_s2, turns=(A, B), train=SimpleNamespace(ratio=RATIO, motor="motor")
        ),
        "problem": SimpleNamespace(train=more.get("train", np.ones(ROWS, dtype=bool))),
        "residual": residual,
    }
    return cast(Scene, cast(Any, SimpleNamespace(**parts)))


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("part", [0.5, 1.0, 2.0])
def test_a_rotor_on_its_train_lifts_and_turns_a_line_as_any_resonance(part: float, way: float) -> None:
    """(1 + 2 z i r) / (1 - r^2 + 2 z i r), a tenth damped; backwards the line turns the other way."""
    softness = 1e-4  # a resonance at 100 rad/s
    speed = way * 100.0 * part / 6.0 / 1.0  # rad/s of the axis: an order of 6
    found = _waves(scene(X, softness, speed=np.full(ROWS, speed)), A, 6.0)
    damping = 0.2j * part
    gain = (1 + damping) / (1 - part**2 + damping)
    wave = (gain if way > 0 else np.conj(gain)) * np.exp(2j * np.pi * A)
    assert found == pytest.approx(np.column_stack([wave.real, wave.imag]))


def test_the_filter_dims_a_line_by_its_cycles_per_row() -> None:
    """Two boxcars of 5 rows: the squared quotient of sinc."""
    s = scene(X, boxcar=5, speed=np.full(ROWS, 2 * np.pi * 0.5))
    cycles = 0.5 * 6.0 * PERIOD_S
    dim = (np.sinc(5 * cycles) / np.sinc(cycles)) ** 2
    assert np.hypot(*_waves(s, A, 6.0).T) == pytest.approx(dim)


def test_the_residual_says_which_motor_and_which_order() -> None:
    luck = 0.1 * np.random.default_rng(2).standard_normal(ROWS)
    for turns, motor in ((A, 1.0), (B, 2.0)):
        found = motor_lines(scene(np.cos(2 * np.pi * 7 * turns) + luck), NAME, SIZE, (np.ones(ROWS),) * 2)
        assert len(found) == 6
        c = found[0]
        assert (c.harmonic, c.stage, c.fixed["motor"][0]) == (7, "motor", motor)
        assert c.order == pytest.approx(7 * RATIO) and c.labels == (SIZE,)
        angle = 2 * np.pi * 7 * turns
        assert c.columns == pytest.approx(np.column_stack([np.cos(angle), np.sin(angle)]))
    both = np.cos(2 * np.pi * 7 * A) + np.sin(2 * np.pi * 7 * B)
    c = motor_lines(scene(both + luck), NAME, SIZE, (np.full(ROWS, 2.0), np.full(ROWS, 3.0)))[0]
    assert c.harmonic == 7 and c.fixed == {} and c.width == 4
    for turns, size, pair in ((A, 2.0, c.columns[:, :2]), (B, 3.0, c.columns[:, 2:])):
        assert pair[:, 0] == pytest.approx(size * np.cos(2 * np.pi * 7 * turns))


@pytest.mark.parametrize(("order", "is_there"), [(1, False), (2, True), (72, True), (73, False)])
def test_orders_from_two_to_the_poles_times_slots_of_torque_motors(order: int, is_there: bool) -> None:
    slow = scene(np.cos(2 * np.pi * order * A))
    found = motor_lines(slow, NAME, SIZE, (np.ones(ROWS),) * 2)
    assert (order in {c.harmonic for c in found}) is is_there


def test_no_line_of_rows_that_are_not_fitted_or_of_a_drive_too_quick_for_the_filter() -> None:
    one = (np.ones(ROWS),) * 2
    assert motor_lines(scene(X, train=np.zeros(ROWS, dtype=bool)), NAME, SIZE, one) == []
    # 3 turns of an axis per s are 60 of a motor: at order 2 more than a cycle in 5 rows
    quick = np.full(ROWS, 2 * np.pi * 3.0)
    assert motor_lines(scene(X, boxcar=5, speed=quick), NAME, SIZE, one) == []
    # held-out rows have a stronger line of another order
    train = np.arange(ROWS) < 3000
    residual = np.where(train, np.cos(2 * np.pi * 7 * A), 9.0 * np.cos(2 * np.pi * 11 * A))
    assert motor_lines(scene(residual, train=train), NAME, SIZE, one)[0].harmonic == 7


def test_a_motor_that_adds_no_more_than_chance_is_not_taken_along() -> None:
    """A half of the mean square per column that is more."""
    residual = np.cos(2 * np.pi * 7 * A)
    found = motor_lines(scene(residual), NAME, SIZE, (np.ones(ROWS),) * 2)
    assert found[0].fixed["motor"][0] == 1.0 and found[0].width == 2
