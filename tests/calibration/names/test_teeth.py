"""A damaged tooth: the pulse of a row that sweeps, where it is looked for, and what the plant has of it."""

from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Stage
from calibration.names import damaged_tooth as tooth
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.names.made import drive

ROWS = 6000
X: np.ndarray = 0.002 * np.arange(ROWS)  # 12 turns of a part with the period 1


def scene(period: float | None = 1.0, x: np.ndarray = X, kind: str | None = None, **more: Any) -> Scene:
    stages = (Stage("gear", period, None, 1, kind),)
    return drive(x, rig={"stages": stages}, **more)


def bump(x: np.ndarray, centre: float, width: float) -> np.ndarray:
    away = np.abs((x - centre + 0.5) % 1.0 - 0.5)
    return np.where(away < width / 2, np.cos(np.pi * away / width) ** 2, 0.0)


def test_a_pulse_is_a_raised_cosine_once_a_turn() -> None:
    phase = np.array([0.3, 1.3, 0.35, 0.4, 0.25, 0.8])
    found = tooth.pulse(phase, 0.3, 0.2, np.zeros(6))
    assert found == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.5, 0.0], abs=1e-12)
    over_end = tooth.pulse(np.array([0.99, 0.01]), 0.0, 0.08, np.zeros(2))
    assert over_end == pytest.approx(np.full(2, 0.5 * (1 + np.cos(2 * np.pi * 0.01 / 0.08))))


def test_a_row_that_sweeps_more_than_the_pulse_widens_it_and_keeps_its_area() -> None:
    found = tooth.pulse(np.array([0.5, 0.6]), 0.5, 0.1, np.full(2, 0.4))
    assert found == pytest.approx([0.25, 0.25 * 0.5])


@pytest.mark.parametrize(("centre", "width"), [(0.25, 0.04), (0.7, 0.018), (0.01, 0.085)])
def test_pulses_that_take_most_are_tried(centre: float, width: float) -> None:
    phase = (np.arange(240 * 50) + 0.5) / (240 * 50)
    found = tooth.folded(phase, -bump(phase, centre, width), 3)
    assert len(found) == 3 and len(tooth.folded(phase, phase, 2)) == 2
    best, about = found[0]
    assert abs((best - centre + 0.5) % 1.0 - 0.5) <= 1.5 / 240
    assert about in tooth.WIDTHS and width / 1.6 <= about <= width * 1.6


def test_a_pulse_of_three_rows_is_a_spike() -> None:
    """Of two rows a bin a raised cosine weighs 3/8 of its width: 0.018 turns are 3.2 rows, 0.012 are 2.2."""
    e = np.zeros(240)
    e[100] = 1.0
    phase = (np.arange(240) + 0.5) / 240
    widest = tooth.folded(np.tile(phase, 2), np.tile(e, 2), 1)
    assert widest[0][1] == 0.018


def test_a_tooth_is_found_on_its_part_with_minus_its_force() -> None:
    s = scene(residual=-3 * bump(X, 0.4, 0.04), turn=5.0)
    found = tooth.columns(s)
    assert len(found) == 3 and {c.stage for c in found} == {"gear"}
    c = found[0]
    assert (c.order, c.least, c.domain) == (5.0, 14.0, "axis_angle") and c.labels == (("amplitude", "N"),)
    assert c.fixed["phase"][0] == pytest.approx(0.4, abs=0.007) and c.fixed["phase"][1] == "turn"
    width = c.fixed["width"][0]
    assert c.steps == pytest.approx((0.003, 0.1 * width)) and c.searched == 2
    at = c.fixed["phase"][0]
    away = np.abs((X - at + 0.5) % 1.0 - 0.5)
    inside = away < 0.4 * width
    expected = -0.5 * (1 + np.cos(2 * np.pi * away / width))
    assert c.columns[inside, 0] == pytest.approx(expected[inside])
    assert c.shape is not None and c.shape(np.array([at, 1e-6]))[:, 0].min() == pytest.approx(-1, abs=1.0)


def test_the_motor_s_tooth_is_over_its_angle() -> None:
    assert {c.domain for c in tooth.columns(scene(kind="motor", residual=X % 1.0))} == {"motor_angle"}


def test_a_part_turns_once_and_slowly_enough() -> None:
    """0.9 turns; rows that sweep less than 0.12 of one; fifty of them."""
    assert tooth.columns(scene(13.2, residual=X % 1.0)) and not tooth.columns(scene(13.4, residual=X % 1.0))
    assert not tooth.columns(scene(None))
    quick = 0.119 * np.arange(ROWS)
    assert tooth.columns(scene(x=quick, residual=X % 1.0))
    assert not tooth.columns(scene(x=0.121 * np.arange(ROWS), residual=X % 1.0))
    s = scene(residual=X % 1.0)
    s.problem.valid = np.arange(ROWS) < 50
    assert tooth.columns(s)
    s.problem.valid = np.arange(ROWS) < 49
    assert not tooth.columns(s)


def test_what_a_log_lacks_for_a_tooth() -> None:
    missing = "a declared stage with its period, and a turn of it"
    assert tooth.lacks(scene(13.2)) == "" and tooth.lacks(scene(13.4)) == tooth.lacks(scene(None)) == missing


def test_a_plant_s_pulse_is_a_gaussian_of_the_same_height_and_area() -> None:
    """Area of a raised cosine: half its width; of a Gaussian sqrt(2 pi) deviations."""
    given = {
        "amplitude": Parameter(5.0, "N m"),
        "phase": Parameter(0.2, "turn"),
        "width": Parameter(0.04, "turn"),
    }
    f = Finding("damaged_tooth", "T", "axis_angle", stage="shaft1", harmonic=1, parameters=given)
    (effect,) = tooth.to_plant(f, Facts("log")).effects
    assert effect.parameters["amplitude"].value == 5.0
    assert effect.parameters["phase"].value == pytest.approx(0.4 * np.pi)
    assert effect.parameters["width"].value * np.sqrt(2 * np.pi) == pytest.approx(0.04 * 2 * np.pi / 2)
