"""An effort whose zero walks: no effect of the drive, told, and no cover for effects that are there."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.look.forces import _of_the_zero
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


@pytest.mark.slow
def test_a_still_offset_is_left_as_it_is(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, *files(5, 0.0))
    assert not any("wanders" in r for r in data["reasons"]) and found(data) == []


@pytest.mark.slow
def test_a_force_that_comes_and_goes_is_no_walk(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, u = motion()
        tables.append((t, x, u + 0.5 * np.sin(2 * np.pi * t / 7.0 + k)))
    data = answer(tmp_path, FORCE, *tables)
    assert not any("wanders" in r for r in data["reasons"]) and found(data) != []


@pytest.mark.slow
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


ROWS = 4000
ZERO = Finding("unknown", "T", "time", parameters={"rms": Parameter(0.4, "N")})
DRAG = Finding("brake_drag", "T", "time", parameters={"torque": Parameter(0.3, "N")})


@pytest.mark.parametrize(
    ("moves", "size", "found", "named"),
    [
        (4, 0.3, DRAG, False),
        (40, 0.3, DRAG, True),
        (4, 1.5, DRAG, True),
        (4, 0.3, replace(DRAG, frequency=1.3), True),
    ],
)
def test_along_a_few_moves_a_zero_that_differs_from_file_to_file_is_no_brake(
    moves: int, size: float, found: Finding, named: bool
) -> None:
    """Nothing that wanders follows many moves, has a frequency, or goes far beyond what files show."""
    way = np.sign(np.sin(np.pi * moves * (np.arange(ROWS) + 0.5) / ROWS))
    view = SimpleNamespace(file=np.zeros(ROWS, dtype=np.int64), direction=way)
    told = _of_the_zero(found, size * way, ZERO, view)  # type: ignore[arg-type]
    assert (told.name == "brake_drag") is named
    assert named or told.equivalent == ("brake_drag",)
    assert _of_the_zero(found, size * way, None, view) is found  # type: ignore[arg-type]
