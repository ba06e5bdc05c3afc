"""An effort that is its loop's law to its noise says nothing of forces."""

import re
from pathlib import Path

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.report.pictures import TRACE
from calibration.report.plots import GATE
from tests.calibration.test_drives import FORCE, MASS, PERIOD, VISCOUS, answer, motion
from tests.calibration.test_strangers import rate

GAIN, SET_POINT = 40.0, 0.5


def looped(disturbed: float = 0.0, gain: float = GAIN) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t, x and u = gain (set point - x) of a mass with friction, swinging in; and a force nobody logs."""
    t = np.arange(0, 20.0, PERIOD)
    x = SET_POINT * (1 - np.exp(-0.15 * t) * np.cos(2.1 * t)) + 0.05 * np.exp(-0.1 * t) * np.sin(5.0 * t)
    u = gain * (SET_POINT - x) + disturbed * np.sin(0.7 * t)
    return t, x, u + 0.005 * np.random.default_rng(3).standard_normal(len(t))


def test_the_law_is_told_in_place_of_a_force(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, looped())
    assert data["verdict"] == "cannot tell" and not data["effects"]
    told = re.search(r"effort is (\S+) N - (\S+) N/m x position\. That is the law of a loop", str(data))
    assert told is not None
    assert float(told[1]) == pytest.approx(GAIN * SET_POINT, rel=0.01)
    assert float(told[2]) == pytest.approx(GAIN, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("disturbed", "gain"), [(1.0, GAIN), (0.0, -GAIN)])
def test_a_spring_or_another_force_is_none(tmp_path: Path, disturbed: float, gain: float) -> None:
    """A spring pulls the other way: the effort grows with the place."""
    data = answer(tmp_path, FORCE, looped(disturbed, gain))
    assert "law of a loop" not in str(data)


def test_a_mass_that_swings_at_one_frequency_keeps_its_numbers(tmp_path: Path) -> None:
    """Its force is as the place, too, and its declared terms say as much."""
    t, w = np.arange(0, 20.0, PERIOD), 2 * np.pi * 0.5
    x = 0.2 * np.sin(w * t)
    u = -MASS * w**2 * x + VISCOUS * 0.2 * w * np.cos(w * t)
    data = answer(tmp_path, FORCE, (t, x, u + 0.005 * np.random.default_rng(3).standard_normal(len(t))))
    assert "law of a loop" not in str(data)
    assert data["calibrated"]["inertia"]["value"] == pytest.approx(MASS, rel=0.02)


def test_a_page_has_no_empty_picture_or_table_where_nothing_was_looked_for(tmp_path: Path) -> None:
    answer(tmp_path, FORCE, looped())
    assert calibrate([tmp_path / "run0.csv"], tmp_path / "rig.yaml", [], tmp_path / "seen") == 0
    page = (tmp_path / "seen" / "report.html").read_text()
    assert TRACE.split(",")[0] in page
    assert not any(x in page for x in (GATE, "Declared model, re-calibrated", "Gate and negative controls"))


REFERENCE = FORCE.replace("response:", "  reference: {column: r, unit: m}\nresponse:")


@pytest.mark.slow
@pytest.mark.parametrize("forces", [True, False])
def test_a_loop_with_a_moving_reference_is_told_where_forces_say_less(tmp_path: Path, forces: bool) -> None:
    """u = 80 (r - x) - 5 v holds exactly; what x answers is the drive of the rig, or somebody's hands."""
    t, x, u = motion()
    u = u if forces else 6.0 * np.sin(2.3 * t) + 4.0 * np.sin(3.9 * t + 1.0)
    r = x + (u + 5.0 * rate(x)) / 80.0
    data = answer(tmp_path, REFERENCE, (t, x, u, r), header="t,x,u,r")
    told = re.search(r"(\S+) N/m x \(reference - position\) - (\S+) N s/m x velocity leaves", str(data))
    assert (told is None) == forces
    if told:
        assert [float(x) for x in told.groups()] == [pytest.approx(80, rel=0.05), pytest.approx(5, rel=0.2)]


@pytest.mark.slow
def test_an_effort_without_its_sign_is_asked_for_it(tmp_path: Path) -> None:
    """A sensor that tells a size only; a weight that is larger than all friction has one sign, too."""
    t, x, u = motion()
    assert "is it a size?" in str(answer(tmp_path, FORCE, (t, x, np.abs(u))))
    assert "is it a size?" not in str(answer(tmp_path, FORCE, (t, x, u + 40.0)))


@pytest.mark.parametrize("digits", [3, 5, 9])
def test_a_floor_far_above_what_is_left_is_told(tmp_path: Path, digits: int) -> None:
    t, x, u = motion()
    data = answer(tmp_path, FORCE, (t, np.round(x, digits), u))
    error = data["error"]["torque"]
    far = not data["effects"] and error["floor"] > 2.0 * error["after"]
    assert ("times what is left: what is smaller" in str(data)) == far
