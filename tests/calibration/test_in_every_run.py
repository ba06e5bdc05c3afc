"""The plant's own loop, whose clock starts anew with every run: what begins in each keeps its name and size;
what only looks like wind, or like another law of the command, is neither."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.decide.broadband import follows_direction, wind
from plant.model import default_files, load
from plant.parts import EffectModel
from tests.calibration.logs import effect, write_logs
from tests.calibration.test_statistics import regression


def answer(folder: Path, one: EffectModel) -> dict[str, Any]:
    declared = default_files()["low_preload"]
    out = folder / "out"
    assert calibrate(write_logs(folder, [one]), out=out, plant=declared, plots=False, replay=False) == 0
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


@pytest.mark.slow
def test_a_preload_that_changes_in_every_run(tmp_path: Path) -> None:
    """Half of Ts and sigma2 from 12 s on: a part of what was before, which the first fit does not know."""
    change = effect("preload_change", change=(0.5, "1"), start=(12.0, "s"), duration=(1.0, "s"))
    report = answer(tmp_path, change)
    assert [e["name"] for e in report["effects"]] == ["preload_change"]
    found = report["effects"][0]["parameters"]
    assert found["change"]["value"] == pytest.approx(0.5, rel=0.05)
    assert found["start_in_run"]["low"] < 12.5 and found["start_in_run"]["high"] > 12.0
    assert report["error"]["torque"]["after"] < 2 * report["error"]["torque"]["floor"]
    (written,) = (e for e in load(tmp_path / "out" / "plant.yaml").axes.ra.effects if e.name == change.name)
    assert written.parameters["change"].value == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
def test_a_warm_up_that_begins_in_every_run(tmp_path: Path) -> None:
    report = answer(tmp_path, effect("friction_warmup", depth=(-0.3, "1"), time_constant=(20.0, "s")))
    # a bristle answers a change of a third in the first order only: that may be left, without a name
    assert [e["name"] for e in report["effects"] if e["name"] != "unknown"] == ["friction_warmup"]
    found = report["effects"][0]["parameters"]
    assert found["depth"]["value"] == pytest.approx(-0.3, rel=0.1)
    assert found["time_constant_in_run"]["value"] == pytest.approx(20.0, rel=0.15)


def ornstein_uhlenbeck(tau_s: float, seconds: float, period_s: float, seed: int) -> np.ndarray:
    """A torque of 1 N m rms that forgets in `tau_s`."""
    rng = np.random.default_rng(seed)
    keep = np.exp(-period_s / tau_s)
    out = np.zeros(round(seconds / period_s))
    for k in range(1, len(out)):
        out[k] = keep * out[k - 1] + np.sqrt(1 - keep**2) * rng.standard_normal()
    return out


@pytest.mark.parametrize("tau", [0.5, 2.0])
def test_a_wind_has_its_corner(tau: float) -> None:
    e = ornstein_uhlenbeck(tau, 4000.0, 0.05, 3)
    rate = 1e-3 * np.sign(np.sin(2 * np.pi * np.arange(len(e)) * 0.05 / 40.0))
    found = wind(e, regression(e, np.column_stack([np.ones(len(e)), rate]), 0.05), 0.1)
    assert found is not None and found.name == "wind_torque"
    # the corner, 1 / (2 pi time), is what the 15 % belong to: it is read from the lag of half the correlation
    assert 1 / found.parameters["correlation_time"].value == pytest.approx(1 / tau, rel=0.15)
    assert found.parameters["deviation"].value == pytest.approx(1.0, rel=0.1)


def test_what_turns_over_with_the_direction_is_no_wind() -> None:
    e = ornstein_uhlenbeck(20.0, 2000.0, 0.05, 4)
    rate = 1e-3 * np.sign(np.sin(2 * np.pi * np.arange(len(e)) * 0.05 / 40.0))
    for torque, friction in ((e, False), (e * np.sign(rate), True)):
        p = regression(torque, np.column_stack([np.ones(len(e)), rate]), 0.05)
        assert follows_direction(torque, p) is friction
        found = wind(torque, p, 0.1)
        assert found is not None and (found.name == "unknown") is friction


@pytest.mark.slow
def test_a_compliant_train_has_no_other_law_of_the_command(tmp_path: Path) -> None:
    """A stiffness of two fifths: the error of the command is at the rounding of the effort."""
    report = answer(tmp_path, effect("shaft_compliance", compliance=(0.1, "arcsec/(N m)")))
    assert [e["name"] for e in report["effects"]] == ["shaft_compliance"]
