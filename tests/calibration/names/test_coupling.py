"""An arm's other joint, whose angle is declared: what its motion and a weight behind it do to this one."""

from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.declaration import Response
from calibration.names.coupling import coupling
from tests.calibration.names.made import drive
from tests.calibration.test_drives import FORCE, answer

ARM = FORCE.replace("unit: m}", "unit: rad}").replace("unit: N}", "unit: N m}")
ARM = ARM.replace("  effort:", "  joint: {column: q2, unit: rad}\n  effort:")
PERIOD_S = 0.004
WEIGHT = 1.5  # N m
COUPLED = 0.15  # kg m2, of the second link: its mass times both lengths


def moving(seed: int) -> tuple[np.ndarray, ...]:
    """Time, both angles, and the torque of a first joint that turns an inertia with friction, alone."""
    t = np.arange(0, 30.0, PERIOD_S)
    q1 = 0.7 * np.sin(2 * np.pi * 0.37 * t) + 0.3 * np.sin(2 * np.pi * 0.9 * t + 1)
    q2 = 0.9 * np.sin(2 * np.pi * 0.53 * t + 0.4) + 0.2 * np.sin(2 * np.pi * 1.1 * t)
    rate, bent = np.gradient(q1, PERIOD_S), np.gradient(np.gradient(q1, PERIOD_S), PERIOD_S)
    noise = np.random.default_rng(seed).standard_normal(len(t))
    return t, q1, q2, bent + 0.5 * np.sign(rate) + 0.3 * rate + 0.05 * noise


def reported(folder: Path, t: np.ndarray, q1: np.ndarray, q2: np.ndarray, torque: np.ndarray):  # type: ignore[no-untyped-def]
    return answer(folder, ARM, (t, q1, torque, q2), header="t,x,u,q2")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_coupled_inertia_has_no_name_and_is_told(tmp_path: Path, seed: int) -> None:
    """Both joints of a planar arm (Craig, Introduction to Robotics, chapter 6)."""
    t, q1, q2, torque = moving(seed)
    (v1, a1), (v2, a2) = ((v := np.gradient(q, PERIOD_S), np.gradient(v, PERIOD_S)) for q in (q1, q2))
    torque += COUPLED * (np.cos(q2) * (2 * a1 + a2) - np.sin(q2) * (2 * v1 * v2 + v2**2)) + 0.1 * a2
    data = reported(tmp_path, t, q1, q2, torque)
    top = data["effects"][0]
    assert top["name"] == "unknown" and "motion of joint" in top["note"]
    assert data["error"]["torque"]["after"] < 0.1 * data["error"]["torque"]["before"]


def test_a_joint_that_does_nothing_is_no_effect(tmp_path: Path) -> None:
    assert reported(tmp_path, *moving(3))["effects"] == []


@pytest.mark.parametrize(("response", "own"), [("force", 1), ("acceleration", 0)])
def test_an_acceleration_does_not_explain_itself(response: str, own: int) -> None:
    t = 0.01 * np.arange(400)
    s = drive(
        np.sin(t), response=Response(response, "N"), unit="rad", columns={"joint": 0.001 * np.cos(3 * t)}
    )
    labels = [label for label, _ in coupling(s)[1].labels]
    assert labels.count("own_acceleration_by_cos_of_joint") == own and len(labels) == 6 + own
    assert coupling(s)[1].columns.shape == (400, 6 + own)


@pytest.mark.slow
def test_a_weight_behind_a_parallel_joint_lies_over_both_angles(tmp_path: Path) -> None:
    t, q1, q2, torque = moving(4)
    top, *more = reported(tmp_path, t, q1, q2, torque + WEIGHT * np.cos(q1 + q2))["effects"]
    assert not more and top["name"] == "gravity_imbalance"
    assert top["parameters"]["amplitude"]["value"] == pytest.approx(WEIGHT, rel=0.05)
