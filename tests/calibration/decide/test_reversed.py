"""A control that the declared terms make by themselves tests nothing."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import SENSORS, answer

DELAY_S, NOISE_RAD = 0.005, 0.002


def test_a_motion_at_one_frequency_keeps_the_name_of_a_late_sensor(tmp_path: Path) -> None:
    """Its rate in reversed time is made of the place and the rate: a sine of the other phase."""
    quarter = 1 / 12  # s, by which the log ends before its motion comes round
    t, w = np.arange(0, 40.0 - quarter, 0.005), 2 * np.pi * 3.0
    noise = NOISE_RAD * np.random.default_rng(4).standard_normal(len(t))
    table = t, 0.3 * np.sin(w * t), 0.3 * np.sin(w * (t - DELAY_S)) + noise
    data = answer(tmp_path, SENSORS.replace(", ratio: 0.02", ""), table)
    assert [e["name"] for e in data["effects"]] == ["channel_delay"]
    assert data["effects"][0]["parameters"]["delay"]["value"] == pytest.approx(DELAY_S, rel=0.1)
    (told,) = (c for c in data["controls"] if "reversed" in c["what"])
    assert told["note"].startswith("no test here") and not told["accepted"]
