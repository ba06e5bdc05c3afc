"""A joint whose motor stage is declared, quicker than its encoder resolves: the balance keeps its numbers."""

import json
from pathlib import Path

import pytest

from calibration.command import calibrate
from tests.blind.world.case import seal
from tests.blind.world.cells import SETS

KEY = "world-nothing-arm-none-5"


@pytest.mark.slow
def test_a_quick_stage_behind_a_coarse_encoder_biases_no_declared_term(tmp_path: Path) -> None:
    order = next(each for each in SETS["everything"]() if each.key == KEY)
    seal(order, 1900, tmp_path / "logs", tmp_path / "truth")
    logs = sorted((tmp_path / "logs" / KEY).glob("*.csv"))
    assert calibrate(logs, tmp_path / "logs" / KEY / "rig.yaml", out=tmp_path / "out", plots=False) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))
    drive = json.loads((tmp_path / "truth" / f"{KEY}.json").read_text(encoding="utf-8"))["drive"]
    assert report["effects"] == []
    for name, hidden in (("inertia", "INERTIA"), ("coulomb", "COUL"), ("gravity_sin", "GRAV")):
        assert report["calibrated"][name]["value"] == pytest.approx(drive[hidden], rel=0.15), name
