"""What `schmidt calibrate` prints: the verdict, effects with size and errors, remarks, the next step."""

from pathlib import Path
from typing import Any

import pytest

from calibration.report.terminal import show

TORQUE = {"unit": "N m", "before": 5.25, "after": 1.5, "floor": 1.25}
VOLTS = {"unit": "V", "before": 0.02, "after": 0.02, "floor": None}
GEAR: dict[str, Any] = {
    "name": "gear_eccentricity",
    "equivalent": [],
    "stage": "shaft2",
    "harmonic": 2,
    "channel": "T",
    "domain": "axis_angle",
    "order": 83.5,
    "frequency_Hz": None,
    "parameters": {
        "phase": {"value": 0.5, "unit": "rad", "low": 0.4, "high": 0.6},
        "amplitude": {"value": 7.125, "unit": "N m", "low": 7.0, "high": 7.25},
    },
}
PUSH: dict[str, Any] = {
    **GEAR,
    "name": "friction_asymmetry",
    "stage": None,
    "harmonic": None,
    "order": None,
    "parameters": {"coulomb_asymmetry": {"value": 0.25, "unit": "1", "low": None, "high": None}},
}
FOUND: dict[str, Any] = {
    "verdict": "found",
    "effects": [GEAR, PUSH],
    "error": {"torque": TORQUE, "electrical": VOLTS},
    "separating_experiment": None,
    "reasons": [],
}
NOTHING = {**FOUND, "verdict": "nothing", "effects": []}
LACKS = {**NOTHING, "verdict": "cannot tell", "error": {}, "separating_experiment": "200 rows of motion"}


def printed(data: dict[str, Any], out: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    show(data, ["something is still missing in torque"], out)
    return capsys.readouterr().out.splitlines()


def test_every_effect_has_its_place_its_size_and_its_errors(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    verdict, *table, remark, report = printed(FOUND, tmp_path, capsys)
    assert verdict == (
        "found: The declared model lacks gear_eccentricity on shaft2 (amplitude 7.12 N m), and 1 more."
    )
    assert [" ".join(row.split()) for row in table] == [
        "effect where size (95 % interval) held-out error before after floor",
        "gear_eccentricity shaft2, harmonic 2 amplitude 7.125 (7 to 7.25) N m torque, N m 5.25 1.5 1.25",
        "friction_asymmetry coulomb asymmetry 0.25 torque, N m 5.25 1.5 1.25",
        "(no effect) electrical, V 0.02 0.02 not known",
    ]
    assert remark == "! something is still missing in torque"
    assert report == f"Report: {tmp_path / 'report.html'}"


def test_a_line_of_no_stage_has_its_order_or_its_frequency(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bearing = {**GEAR, "name": "bearing_pass", "stage": None, "harmonic": None, "order": 20.25}
    mains = {**PUSH, "name": "command_disturbance", "frequency_Hz": 50.0}
    rows = printed({**FOUND, "effects": [bearing, mains]}, tmp_path, capsys)[2:4]
    assert [" ".join(row.split())[:32] for row in rows] == [
        "bearing_pass order 20.25 amplitu",
        "command_disturbance 50 Hz coulom",
    ]


def test_the_next_step_is_the_experiment_else_the_corrected_plant(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plant.yaml").write_text("")
    plant = f"Next: run the corrected drive, schmidt run SCENARIO --plant {tmp_path / 'plant.yaml'}"
    assert printed(FOUND, tmp_path, capsys)[-2] == plant
    apart = {**FOUND, "verdict": "ambiguous", "separating_experiment": "a run at another rate"}
    assert printed(apart, tmp_path, capsys)[-2] == "Next, to be sure: a run at another rate"
    assert not [x for x in printed(NOTHING, tmp_path, capsys) if x.startswith("Next")]


def test_a_log_that_cannot_tell_says_once_what_it_lacks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    two = {**LACKS, "separating_experiment": "200 rows of motion; a second speed"}
    verdict, remark, *lacks, _ = printed(two, tmp_path, capsys)
    assert verdict == "cannot tell: This log cannot tell whether something is missing."
    assert remark.startswith("!") and lacks == ["It lacks: 200 rows of motion", "It lacks: a second speed"]
