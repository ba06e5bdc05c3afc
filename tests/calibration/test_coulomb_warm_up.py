"""Friction that warms up without its viscous part, anew in every file: named alone, with size and time."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, answer, found, motion


@pytest.mark.slow
@pytest.mark.parametrize("rise", [0.25, 0.4])
def test_the_coulomb_part_alone_warms_up(tmp_path: Path, rise: float) -> None:
    tables = []
    for k in range(3):
        t, x, u = motion()
        rng = np.random.default_rng(k)
        warm = rise * COULOMB * np.exp(-t / 8.0) * np.sign(np.gradient(x))
        tables.append((t, x, u + warm + 0.02 * rng.standard_normal(len(t))))
    data = answer(tmp_path, FORCE, *tables)
    assert found(data) == ["friction_warmup"]
    told = data["effects"][0]["parameters"]
    assert told["depth"]["value"] == pytest.approx(-rise, rel=0.05)
    assert told["of_coulomb"]["value"] == 1.0
    assert told["time_constant_in_run"]["value"] == pytest.approx(8.0, rel=0.1)
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.02)
