"""A drive with one motor whose friction has a declared shape: a dip from rest, bristles, both."""

from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import load_rig
from calibration.report.rigview import show_rig
from tests.calibration.test_drives import FORCE, PERIOD, answer, found

MASS, COULOMB, VISCOUS = 2.0, 3.0, 4.0
RATIO, SPEED, TRAVEL = 1.6, 0.05, 0.03  # of friction from rest; rad/s; rad
SUBSTEPS = 40
RIG = FORCE.replace("unit: m}", "unit: rad}").replace("unit: N}", "unit: N m}")
LAW = (
    f"friction_law: {{stiction_ratio: {RATIO}, stribeck_speed: {SPEED}, bristle_travel: {TRAVEL},"
    " source: test}\n"
)


def lugre(v: np.ndarray) -> np.ndarray:
    """Friction at the rates `v` (n,), rad/s: the bristles' own equation in small steps (Canudas de Wit)."""
    stiffness, z, h = COULOMB / TRAVEL, 0.0, PERIOD / SUBSTEPS
    out = np.empty(len(v))
    for k, rate in enumerate(v):
        steady = COULOMB * (1 + (RATIO - 1) * np.exp(-((rate / SPEED) ** 2)))
        for _ in range(SUBSTEPS):
            z += h * (rate - stiffness * abs(rate) / steady * z)
        out[k] = stiffness * z
    return out


def log(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, angle in steps of 1e-6 and effort of 60 s."""
    t = np.arange(0.0, 60.0, PERIOD)
    rng = np.random.default_rng(seed)
    w, size = 2 * np.pi * np.array([0.05, 0.13]), np.array([0.5, 0.2])
    at = rng.uniform(0, 2 * np.pi, 2)
    x, v, a = ((size * w**k * np.sin(np.outer(t, w) + at + k * np.pi / 2)).sum(1) for k in range(3))
    u = MASS * a + VISCOUS * v + lugre(v) + 0.02 * rng.standard_normal(len(t))
    return t, np.round(x, 6), u


@pytest.mark.slow
def test_what_the_declared_law_says_is_no_effect(tmp_path: Path) -> None:
    tables = [log(k) for k in range(3)]
    (tmp_path / "without").mkdir()
    (tmp_path / "with").mkdir()
    bare = answer(tmp_path / "without", RIG, *tables)
    assert {"presliding", "stribeck_change"} & set(found(bare))
    data = answer(tmp_path / "with", RIG + LAW, *tables)
    assert found(data) == []
    row = data["error"]["torque"]
    assert row["after"] < 1.5 * row["floor"]
    assert row["after"] < 0.1 * bare["error"]["torque"]["before"]
    assert data["calibrated"]["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.02)


def test_what_is_understood_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(RIG + LAW)
    said = "friction law: 1.6 times Coulomb's from rest, Stribeck 0.05 rad/s; bristles of 0.03 rad"
    assert said in show_rig(path, [], None).splitlines()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (RIG + "friction_law: {stiction_ratio: 1.5, source: s}\n", "'stribeck_speed' is missing"),
        (RIG + "friction_law: {source: s}\n", "says nothing"),
        (RIG.replace("coulomb, ", "") + LAW, "estimate it"),
    ],
)
def test_a_law_that_says_too_little_is_refused(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text)
    with pytest.raises(CalibrationInputError, match=told):
        load_rig(path)
