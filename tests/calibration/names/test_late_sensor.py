"""Two sensors of one motion, of which one is late: the delay is a time, whatever either of them counts in."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import PERIOD, SENSORS, answer, motion

LATE_S = 0.03


def test_a_column_of_the_difference_keeps_its_sign(tmp_path: Path) -> None:
    """A torque winds a shaft up; of the first sensor's motion the difference has a little, the other way."""
    t, x, _ = motion()
    torque = 3.0 * np.sin(1.7 * t) + np.sin(4.1 * t)
    second = 2e-3 * torque - 8e-3 * x + 1e-5 * np.random.default_rng(4).standard_normal(len(t))
    text = SENSORS.replace(", ratio: 0.02", "").replace(
        "response:", "  force: {column: f, unit: N m}\nresponse:"
    )
    data = answer(tmp_path, text, (t, x, second, torque), header="t,x,u,f")
    (found,) = data["effects"]
    assert found["name"] == "shaft_compliance" and "turned here" not in str(data)
    assert found["parameters"]["compliance"]["value"] == pytest.approx(2e-3, rel=0.02)


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
