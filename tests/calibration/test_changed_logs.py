"""Measured logs, changed on purpose: what was done to them is named, and nothing else that the log as it was
measured does not show."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from tests.calibration.test_measured import DATA, RIGS

pytestmark = [
    pytest.mark.slow,
    pytest.mark.long,
    pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/measured is absent"),
]

Columns = dict[str, np.ndarray]
RNG = 0  # generator of the places of spikes


def emps() -> tuple[list[Columns], str]:
    """The screw axis: t s, qm m, vir V, qg m."""
    from scipy.io import loadmat

    m = loadmat(DATA / "emps" / "DATA_EMPS.mat")
    run = {k: np.asarray(m[k].ravel(), dtype=float) for k in ("t", "qm", "vir", "qg")}
    return [run], (RIGS / "emps.yaml").read_text()


def pendulum() -> tuple[list[Columns], str]:
    """The free pendulum: t s, q rad, v rad/s; four files."""
    from scipy.io import loadmat

    m = loadmat(DATA / "pendulum" / "multiarm_single_runs.mat")
    text = (RIGS / "pendulum.yaml").read_text()
    for old, new in (("Time_id{*}", "t"), ("Y_id{*}(1,:)", "q"), ("Y_id{*}(2,:)", "v")):
        text = text.replace(f'"{old}"', new)
    runs = zip(m["Time_id"].ravel(), m["Y_id"].ravel(), strict=True)
    return [{"t": t.ravel(), "q": y[0], "v": y[1]} for t, y in runs], text


def square(c: Columns, y: str) -> None:
    """A square of 1 Hz on the effort."""
    c[y] = c[y] + 0.15 * np.std(c[y]) * np.sign(np.sin(2 * np.pi * c["t"] + 0.3))


def mains(c: Columns, y: str) -> None:
    """50 Hz on the effort."""
    c[y] = c[y] + 0.2 * np.std(c[y]) * np.sin(2 * np.pi * 50.0 * c["t"] + 0.7)


def late(c: Columns, y: str) -> None:
    """The column 3.3 ms late."""
    c[y] = np.interp(c["t"] - 0.0033, c["t"], c[y])


def drag(c: Columns, y: str) -> None:
    """More friction from 35 % of the log on."""
    c[y] = c[y] + 0.3 * np.std(c[y]) * (c["t"] > 0.35 * c["t"][-1]) * np.sign(np.gradient(c["qm"]))


def spikes(c: Columns, y: str) -> None:
    """Five rows of the position far off."""
    rng = np.random.default_rng(RNG)
    at = rng.choice(np.arange(50, len(c["t"]) - 50), 5, replace=False)
    x = next(k for k in ("qm", "q") if k in c)
    c[x] = c[x].copy()
    c[x][at] += 0.6 * np.ptp(c[x]) * rng.choice([-1, 1], 5)


@cache
def sound(drive: Callable[[], Any]) -> dict[str, Any]:
    """The report on the log as it was measured."""
    with TemporaryDirectory() as folder:
        return answer(drive, None, "", Path(folder))


def answer(drive: Callable[[], Any], change: Any, column: str, folder: Path) -> dict[str, Any]:
    runs, text = drive()
    folder.mkdir(exist_ok=True)
    (folder / "rig.yaml").write_text(text)
    logs = []
    for k, run in enumerate(runs):
        if change is not None:
            change(run, column)
        logs.append(folder / f"run{k}.csv")
        table = np.column_stack(list(run.values()))
        np.savetxt(logs[-1], table, delimiter=",", header=",".join(run), comments="", fmt="%.12g")
    assert calibrate(logs, folder / "rig.yaml", [], folder / "out", plots=False) == 0
    data: dict[str, Any] = json.loads((folder / "out" / "report.json").read_text())
    return data


def names(data: dict[str, Any]) -> set[str]:
    return {n for e in data["effects"] for n in (e["name"], *e["equivalent"])}


def value(data: dict[str, Any], name: str, parameter: str) -> float:
    (effect,) = [e for e in data["effects"] if e["name"] == name]
    return float(effect["parameters"][parameter]["value"])


@pytest.mark.parametrize(
    ("drive", "change", "column", "name"),
    [
        (emps, square, "vir", "command_disturbance"),
        (emps, drag, "vir", "brake_drag"),
        (emps, spikes, "vir", "sample_loss"),
        (emps, mains, "vir", "command_disturbance"),
        (emps, late, "vir", "channel_delay"),
        (pendulum, late, "v", "channel_delay"),
        (pendulum, spikes, "v", "sample_loss"),
    ],
    ids=lambda x: getattr(x, "__name__", x),
)
def test_what_was_done_to_a_measured_log_is_named_and_nothing_else(
    tmp_path: Path, drive: Any, change: Any, column: str, name: str
) -> None:
    data = answer(drive, change, column, tmp_path / "changed")
    assert name in names(data)
    twins = {"structural_mode"} if change is mains else set()
    assert names(data) <= names(sound(drive)) | {name, "unknown"} | twins
    if change is square:
        line = next(e for e in data["effects"] if e["name"] == name)
        assert line["frequency_Hz"] == pytest.approx(1.0, rel=0.002)
    if change is mains:
        assert any(e["frequency_Hz"] == pytest.approx(50.0, rel=0.001) for e in data["effects"])
    if change is drag:
        assert value(data, name, "start") == pytest.approx(0.35 * 24.84, abs=0.1)
    if change is late:
        was = value(sound(drive), name, "delay")
        assert value(data, name, "delay") == pytest.approx(was + 0.0033, abs=0.0001)
    if drive is pendulum:
        assert data["effects"][0]["name"] == "gravity_imbalance"
