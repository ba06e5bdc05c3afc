"""A push that lasts a moment is left out and said; a push that comes back is no event."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, MASS, SENSORS, answer, motion

PUSH_N = 60.0


def pushed(*begins_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The motion of a mass, on which somebody pulls for half a second now and then."""
    t, x, force = motion(60.0)
    for begin in begins_s:
        force = force + PUSH_N * np.sin(np.pi * np.clip((t - begin) / 0.5, 0, 1))
    return t, x, force


@pytest.mark.slow
def test_one_push_is_told_and_spoils_no_number(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, pushed(4.0))
    found = [e for e in data["effects"] if e["domain"] == "time"]
    assert [e["name"] for e in data["effects"]] == ["unknown"], data["effects"]
    begin, end = (float(x) for x in found[0]["note"].split(" s of file")[0].split("from ")[1].split(" to "))
    assert 3.9 < begin < 4.2 < 4.3 < end < 4.6
    assert data["calibrated"]["inertia"]["value"] == pytest.approx(MASS, rel=0.02)
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.05)


@pytest.mark.slow
def test_what_comes_back_is_no_event(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, pushed(*np.arange(2.0, 58.0, 3.7)))
    assert not any("left out" in e["note"] for e in data["effects"])


@pytest.mark.slow
def test_a_sound_motion_has_no_event(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, pushed())
    assert data["verdict"] == "nothing"


def test_an_effect_that_names_the_stretch_is_no_event(tmp_path: Path) -> None:
    """A slip between two sensors in a short file keeps its name."""
    t, x, _ = motion(4.0)
    y = 0.02 * x + 1e-5 * np.random.default_rng(5).standard_normal(len(t))
    data = answer(tmp_path, SENSORS, (t, x, y + 2e-3 * (t > 2.0)), (t, x, y))
    assert [e["name"] for e in data["effects"]] == ["roller_slip"]
    assert "left out" not in str(data)


@pytest.mark.slow
def test_a_push_in_each_of_two_files_is_told_of_both(tmp_path: Path) -> None:
    files = [pushed(4.0), pushed(17.0), pushed(), pushed()]
    data = answer(tmp_path, FORCE, *files)
    (found,) = [e for e in data["effects"] if e["domain"] == "time"]
    assert "s of file 1, " in found["note"] and "s of file 2 only" in found["note"]
    assert data["calibrated"]["inertia"]["value"] == pytest.approx(MASS, rel=0.02)
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.05)
