"""An effort whose zero walks: no effect of the drive, told, and no cover for effects that are there."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, answer, found, motion

PERIOD_S = 0.005


def walk(seed: int, size: float, seconds: float = 30.0) -> np.ndarray:
    """A random walk of `size` N rms after half a minute."""
    steps = np.random.default_rng(seed).standard_normal(round(seconds / PERIOD_S))
    return np.asarray(size * np.cumsum(steps) * np.sqrt(PERIOD_S / 30.0))


def files(seed: int, size: float, drag: float = 0.0) -> list[tuple[np.ndarray, ...]]:
    """Three files of one drive; `drag` against the motion in the second half of each."""
    out = []
    for k in range(3):
        t, x, u = motion()
        u = u + walk(10 * seed + k, size) + drag * np.sign(np.gradient(x)) * (t > 15.0)
        out.append((t, x, u))
    return out


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_walk_gets_no_name_and_is_told(tmp_path: Path, seed: int) -> None:
    data = answer(tmp_path, FORCE, *files(seed, 0.5))
    assert [n for n in found(data) if n != "unknown"] == []
    assert any("its offset wanders" in r for r in data["reasons"])
    assert data["error"]["torque"]["after"] < 0.2  # of 0.3 to 0.5 N that the walk leaves
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.02)
    assert "slow_offset" not in str(data["calibrated"]) + str(data["not_identifiable"])


@pytest.mark.slow
def test_a_brake_beside_a_walk_keeps_its_name_and_size(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, *files(4, 0.5, drag=0.8))
    top = data["effects"][0]
    assert top["name"] == "brake_drag"
    assert top["parameters"]["torque"]["value"] == pytest.approx(0.8, rel=0.1)


def test_a_still_offset_is_left_as_it_is(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, *files(5, 0.0))
    assert not any("wanders" in r for r in data["reasons"]) and found(data) == []


def test_a_force_that_comes_and_goes_is_no_walk(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, u = motion()
        tables.append((t, x, u + 0.5 * np.sin(2 * np.pi * t / 7.0 + k)))
    data = answer(tmp_path, FORCE, *tables)
    assert not any("wanders" in r for r in data["reasons"]) and found(data) != []


def test_a_constant_of_every_files_own_is_real_and_has_no_name(tmp_path: Path) -> None:
    """A weight of 40 N more in the second file."""
    t, x, u = motion()
    data = answer(tmp_path, FORCE, (t, x, u), (t[:4000], x[:4000], u[:4000] + 40.0))
    (effect,) = data["effects"]
    assert (effect["name"], effect["domain"]) == ("unknown", "time")
    assert "every file has a constant of its own" in effect["note"]
    error = data["error"]["torque"]
    assert error["after"] < 0.1 and error["before"] == pytest.approx(20.0, rel=0.1)
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.03)


@pytest.mark.parametrize(("drag", "named"), [(0.3, False), (2.5, True)])
def test_what_comes_within_a_file_is_more_than_files_differ_by(
    tmp_path: Path, drag: float, named: bool
) -> None:
    """Zeros of three files lie 0.4 N apart, rms: a drag of less may be a zero that moved."""
    tables = files(6, 0.0, drag)
    zeros = [(t, x, u + zero) for (t, x, u), zero in zip(tables, (0.5, -0.5, 0.1), strict=True)]
    data = answer(tmp_path, FORCE, *zeros)
    own = {"brake_drag", "friction_warmup", "preload_change"}
    assert bool(own & {e["name"] for e in data["effects"]}) is named
