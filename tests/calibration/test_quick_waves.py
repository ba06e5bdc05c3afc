"""Declared waves that are quick against the filter, and logs whose rows come when something moves."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.arrays import Array
from calibration.balances.view import view_of
from calibration.command import calibrate
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table

RIG = """rig: a brushless motor
columns:
  time: {{column: t, unit: s}}
  position: {{column: x, unit: rad}}
  current: {{column: i, unit: A}}
response: {{channel: current, unit: A}}
estimate: [{terms}]
stages:
  - {{name: motor, period: 6.283185307179586, harmonics: {harmonics}, kind: motor_cogging}}
"""
COGGING = {18: 0.04, 72: 0.18}  # A by order, as such motors of 36 slots have them


def table(folder: Path, t: Array, x: Array, i: Array, terms: str, harmonics: int = 80) -> Path:
    """The log and its rig file; the encoder has 8000 steps a turn."""
    step = 2 * np.pi / 8000
    columns = np.column_stack([t, np.round(x / step) * step, i])
    np.savetxt(folder / "d.csv", columns, "%.7g", ",", header="t,x,i", comments="")
    (folder / "rig.yaml").write_text(RIG.format(terms=terms, harmonics=harmonics))
    return folder / "d.csv"


def cogging(x: Array) -> Array:
    """A of both orders."""
    return np.sum([a * np.cos(n * x + 0.3 * n) for n, a in COGGING.items()], axis=0)


def told_of(path: Path) -> Any:
    """The report."""
    folder = path.parent
    calibrate([path], folder / "rig.yaml", [], folder / "out", plots=False)
    return json.loads((folder / "out" / "report.json").read_text())


@pytest.mark.slow
def test_a_map_of_holding_currents_is_read_although_its_rows_are_events(tmp_path: Path) -> None:
    """One turn there and back in steps; a burst of rows at each place, up to a second between bursts."""
    rng = np.random.default_rng(4)
    place = np.concatenate([np.arange(0, 2 * np.pi, 0.004), np.arange(2 * np.pi, 0, -0.004)])
    x = np.repeat(place, 6)
    wait = np.tile([0.3, 0.013, 0.013, 0.013, 0.013, 0.013], len(place)) * rng.uniform(0.5, 2.0, len(x))
    i = 0.05 * np.sign(np.repeat(np.gradient(place), 6)) + cogging(x) + 0.01 * rng.standard_normal(len(x))
    report = told_of(table(tmp_path, np.cumsum(wait), x, i, "coulomb, offset"))
    found = {e["harmonic"]: e["parameters"]["amplitude"] for e in report["effects"] if e["harmonic"]}
    assert {e["name"] for e in report["effects"]} == {"motor_cogging"} and found.keys() == COGGING.keys()
    for order, size in COGGING.items():
        assert found[order]["value"] == pytest.approx(size, rel=0.1)


@pytest.mark.slow
def test_a_steady_motor_shows_its_cogging_though_accelerations_are_noise(tmp_path: Path) -> None:
    """At a turn a second order 72 is 72 Hz; two speeds, so that angle and clock differ."""
    rng = np.random.default_rng(5)
    t = 0.001 * np.arange(24_000)
    rate = 2 * np.pi * np.where(t < 12, 1.0, 1.4) + 0.3 * np.sin(2 * np.pi * 0.7 * t)
    x = np.cumsum(rate) * 0.001
    i = (
        0.05
        + 0.002 * rate
        + 2e-4 * np.gradient(rate, 0.001)
        + cogging(x)
        + 0.02 * rng.standard_normal(len(t))
    )
    report = told_of(table(tmp_path, t, x, i, "inertia, viscous, coulomb, offset"))
    found = {e["harmonic"]: e for e in report["effects"] if e["name"] in ("motor_cogging", "torque_ripple")}
    assert found.keys() == COGGING.keys(), report["effects"]
    for order, size in COGGING.items():
        assert found[order]["parameters"]["amplitude"]["value"] == pytest.approx(size, rel=0.1)


@pytest.mark.parametrize(("harmonics", "left"), [(40, 0.6), (8, 0.6), (1, 0.6)])
def test_the_filter_leaves_the_quickest_declared_wave_its_size(
    tmp_path: Path, harmonics: int, left: float
) -> None:
    """Arithmetic: a Gaussian of s rows leaves exp(-2 (pi f s)^2) of a sine of f cycles per row."""
    t = 0.001 * np.arange(8000)
    x = 2 * np.pi * 1.5 * t
    path = table(tmp_path, t, x, 0.1 * np.ones(len(t)), "inertia, offset", harmonics)
    rig = load_rig(tmp_path / "rig.yaml")
    view = view_of(read_table(path, rig), rig, rig.responses[0])
    assert float(view.filter.gain(harmonics * 1.5 * 0.001)) > left
