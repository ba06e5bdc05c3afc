"""Two sensors of one motion, of which one is late: the delay is a time, whatever either of them counts in."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import PERIOD, SENSORS, answer, motion

LATE_S = 0.03


@pytest.mark.parametrize(("unit", "per_rad", "reads"), [("rad", 1.0, 0.02), ("counts", 4000.0, -0.6)])
def test_a_late_sensor_is_late_by_its_own_delay(
    tmp_path: Path, unit: str, per_rad: float, reads: float
) -> None:
    t, x, _ = motion()
    luck = np.random.default_rng(3).standard_normal(len(t))
    second = reads * np.interp(t - LATE_S, t, x) + 1e-5 * luck
    text = SENSORS.replace(", ratio: 0.02", "").replace(
        "{column: x, unit: rad}", f"{{column: x, unit: {unit}}}"
    )
    (found,) = answer(tmp_path, text, (t, per_rad * x, second))["effects"]
    assert found["name"] == "channel_delay"
    assert found["parameters"]["delay"]["value"] == pytest.approx(LATE_S, abs=0.1 * PERIOD)
