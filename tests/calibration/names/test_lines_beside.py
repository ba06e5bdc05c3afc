"""Lines of no stage: where they stand out, how far they may move; and what a motor's line is in a plant."""

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.names.inplant import Facts
from calibration.names.lines import beside_stage, cell, movable, over_motor, peaks_over_place, stage_lines
from tests.calibration.names.made import PERIOD_S, back_and_forth
from tests.calibration.names.test_drive_lines import SWING, pair, scene, stage


def rubbed(*rates: float) -> np.ndarray:
    return np.asarray(sum(np.cos(2 * np.pi * r * SWING + 0.7) for r in rates))


def test_a_peak_over_the_place_is_found_where_it_is_and_five_times_at_least() -> None:
    s = scene(residual=rubbed(3.3))
    (found, *_) = peaks_over_place(s, 1)
    assert found == pytest.approx(3.3, abs=0.5 / 6.0)
    slow = peaks_over_place(scene(residual=rubbed(0.6)), 1)  # 3.6 within the travel of 6
    assert all(rate >= 5.0 / 6.0 for rate in slow)


@pytest.mark.parametrize(("off", "count"), [(0.2, 1), (-0.2, 1), (0.6, 0)])
@pytest.mark.parametrize("harmonics", [1, 3])
def test_a_line_beside_a_stages_is_none_of_its_own(off: float, count: int, harmonics: int) -> None:
    """Between 0.05 and 0.35 of a resolution cell, which is 1 / travel."""
    x = back_and_forth(strokes=8, travel=20.0)
    rate, travel = 3.0 + off / 20.0, float(np.ptp(x))
    luck = 0.1 * np.random.default_rng(1).standard_normal(len(x))
    left = np.cos(2 * np.pi * rate * x + 0.7) + luck
    s = scene(stage(harmonics / 3.0, harmonics), x=x, residual=left)
    near = [c for c in beside_stage(s, s.view.rig.stages[0]) if abs((c.apart or 0.0) - 3.0) < 0.2]
    assert len(near) == count
    for c in near:
        low, high = sorted(3.0 + np.sign(off) * part / travel for part in (0.05, 0.35))
        assert c.apart == pytest.approx(rate, abs=0.1 / 20.0)
        for asked, taken in ((0.0, low), (99.0, high)):
            moved = c.moved(np.array([asked]))
            assert moved.columns == pytest.approx(pair(x, taken)) and moved.at_order == pytest.approx(taken)
        assert c.name == "bearing_pass" and low < (c.apart or 0.0) < high
    told = [len(c.neighbours) for c in stage_lines(s, "gear_mesh")]
    assert told and set(told) == {len(beside_stage(s, s.view.rig.stages[0]))}


def test_a_line_of_no_stage_moves_by_a_tenth_of_its_cell() -> None:
    s = scene(turn=4.0)
    (c,) = movable(s, 3.0, (2.9, 3.1))
    assert c.fixed["order"] == (12.0, "1/turn") and c.steps == (pytest.approx(0.1 * 4.0 / 6.0),)
    assert (c.apart, c.searched, c.twins) == (3.0, 1, ())
    assert movable(scene(), 3.0, (2.9, 3.1))[0].fixed["order"] == (3.0, "1/m")
    files = scene(files=np.repeat([0, 1], 2000))
    one, own = movable(files, 3.0, (2.9, 3.1))
    for each in (one, own):
        assert each.shape is not None
        assert each.shape(np.array([3.0])) == pytest.approx(each.columns)
    x = 0.2 * PERIOD_S * np.arange(4000)
    assert movable(scene(x=x), 3.0, (2.9, 3.1))[0].twins == ("command_disturbance",)


def test_a_cell_is_one_over_the_travel_about_its_rate() -> None:
    assert cell(3.0, 4.0) == (2.875, 3.125)


def cogging(**sizes: float) -> Finding:
    parameters = {k: Parameter(v, "") for k, v in sizes.items()}
    return Finding("motor_cogging", "T", "motor_angle", harmonic=6, parameters=parameters)


def test_over_a_motors_angle_the_phase_is_half_the_play_off_the_axis() -> None:
    """Motor A's angle lies that ahead, motor B's behind: six cycles of it, and a quarter from cos to sin."""
    facts = Facts("a.log", half_play=0.02)
    for motor, off in ((1.0, -0.12), (2.0, 0.12)):
        made = over_motor(cogging(amplitude=0.3, phase=0.5, motor=motor), facts, "amplitude", 0.25)
        (effect,) = made.effects
        written = {k: n.value for k, n in effect.parameters.items()}
        assert written["phase"] == pytest.approx(0.75 + off)
        assert (written["amplitude"], written["motor"], written["cycles"]) == (0.3, motor, 6.0)
        assert made.remarks == []


def test_a_finding_of_both_motors_is_two_effects_and_of_neither_one_for_both() -> None:
    facts = Facts("a.log", half_play=0.02)
    both = over_motor(
        cogging(amplitude=0.3, phase=0.5, amplitude_2=0.2, phase_2=1.0), facts, "amplitude", 0.0
    )
    told = [
        (e.parameters["motor"].value, e.parameters["amplitude"].value, round(e.parameters["phase"].value, 9))
        for e in both.effects
    ]
    assert told == [(1.0, 0.3, 0.38), (2.0, 0.2, 1.12)] and both.remarks == []
    neither = over_motor(cogging(amplitude=0.3, phase=0.5), facts, "amplitude", 0.0)
    (effect,) = neither.effects
    assert effect.parameters["motor"].value == 0.0
    assert effect.parameters["phase"].value == pytest.approx(0.5)
    assert neither.remarks == ["motor_cogging: the log does not say on which motor, written to both"]
