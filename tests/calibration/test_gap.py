"""Two encoders on both sides of a gap that nobody has crossed when a file begins."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_coarse_steps import SENSORS
from tests.calibration.test_drives import answer

GAP, NOISE, PERIOD_S = 0.03, 3e-4, 0.005  # rad, rad, s


def follower(x: np.ndarray, start: float) -> np.ndarray:
    """What a side behind a gap does while the other goes `x`; the log begins `start` off its middle."""
    y = np.empty_like(x)
    y[0] = x[0] + start
    for k in range(1, len(x)):
        y[k] = min(max(y[k - 1], x[k] - GAP / 2), x[k] + GAP / 2)
    return y


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_a_gap_is_found_although_files_begin_by_creeping_within_it(tmp_path: Path, seed: int) -> None:
    """Nine seconds at 0.2 mrad/s, each file at another place of the gap: a sixth of all rows."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 60.0, PERIOD_S)
    moving = 0.6 * np.sin(2 * np.pi * (t - 9.0) / 7.0) + 0.2 * np.sin(2 * np.pi * (t - 9.0) / 3.1)
    tables = []
    for start in rng.uniform(-0.4, 0.4, 2) * GAP:
        x = np.cumsum(np.where(t < 9.0, 2e-4, moving)) * PERIOD_S
        both = (x, follower(x, float(start)))
        tables.append((t, *(one + NOISE * rng.standard_normal(len(t)) for one in both)))
    report = answer(tmp_path, SENSORS, *tables, header="t,x,y")
    (found,) = report["effects"]
    assert found["name"] == "play"
    assert found["parameters"]["gap"]["value"] == pytest.approx(GAP, rel=0.02)
    row = report["error"]["position"]
    assert row["after"] < 1.5 * row["floor"]
