"""Drives with a rig file: what was done to their columns is found and undone, names are right where
the truth is known."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate, show_rig
from calibration.errors import CalibrationInputError
from calibration.inputs.matlab import read_matlab
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import quantum
from calibration.names import NAMES
from plant.effects import REGISTRY as CATALOGUE

FORCE = """rig: bench
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: m}
  effort: {column: u, unit: N}
response: {channel: effort, unit: N}
estimate: [inertia, viscous, coulomb, offset]
"""
SENSORS = """rig: joint
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  position2: {column: u, unit: rad}
response: {channel: position2, unit: rad, ratio: 0.02}
"""
PERIOD = 0.005
MASS, VISCOUS, COULOMB = 2.0, 4.0, 3.0


def motion(seconds: float = 30.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, position and the force of a mass with Coulomb and viscous friction, exactly."""
    t = np.arange(0, seconds, PERIOD)
    w = 2 * np.pi * np.array([0.25, 0.61])
    size = np.array([0.3, 0.1])
    x = (size * np.sin(np.outer(t, w))).sum(1)
    v = (size * w * np.cos(np.outer(t, w))).sum(1)
    a = -(size * w**2 * np.sin(np.outer(t, w))).sum(1)
    force = MASS * a + VISCOUS * v + COULOMB * np.sign(v)
    return t, x, force + 0.02 * np.random.default_rng(1).standard_normal(len(t))


def answer(folder: Path, text: str, *tables: tuple[np.ndarray, ...], header: str = "t,x,u") -> dict[str, Any]:
    """The report on tables of t, x, u, or what `header` says."""
    (folder / "rig.yaml").write_text(text)
    logs = []
    for k, table in enumerate(tables):
        logs.append(folder / f"run{k}.csv")
        np.savetxt(logs[-1], np.column_stack(table), delimiter=",", header=header, comments="", fmt="%.9g")
    assert calibrate(logs, folder / "rig.yaml", [], folder / "out", plots=False) == 0
    data: dict[str, Any] = json.loads((folder / "out" / "report.json").read_text())
    return data


def found(data: dict[str, Any]) -> list[str]:
    return [e["name"] for e in data["effects"]]


def mass(data: dict[str, Any]) -> float:
    return float(data["calibrated"]["inertia"]["value"])


def test_a_sound_drive_gets_no_name_and_its_numbers(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, motion())
    assert found(data) == []
    for name, truth in (("inertia", MASS), ("viscous", VISCOUS), ("coulomb", COULOMB)):
        assert data["calibrated"][name]["value"] == pytest.approx(truth, rel=0.03)


@pytest.mark.parametrize("sizes", [(0.2, -0.2, 0.2, 0.2, -0.2), (0.2, -0.25, 0.2, 0.3, -0.05)])
def test_spikes_are_bad_samples_and_the_mass_stays(tmp_path: Path, sizes: tuple[float, ...]) -> None:
    t, x, u = motion()
    x = np.round(x / 1e-5) * 1e-5
    x[[800, 1700, 2600, 3500, 4400]] += np.array(sizes)  # one far smaller than the next is a spike, too
    data = answer(tmp_path, FORCE, (t, x, u))
    assert found(data) == ["sample_loss"]
    assert data["effects"][0]["parameters"]["count"]["value"] == 5
    assert mass(data) == pytest.approx(MASS, rel=0.03)


def test_a_counter_that_nobody_declared_is_joined(tmp_path: Path) -> None:
    t, x, u = motion()
    counts = np.round(x / 1e-6) % 65536
    data = answer(tmp_path, FORCE.replace("unit: m}", "unit: m, scale: 1e-6}"), (t, counts, u))
    assert found(data) == ["log_wrap"]
    assert mass(data) == pytest.approx(MASS, rel=0.03)


def test_signed_numbers_written_unsigned_are_repaired(tmp_path: Path) -> None:
    t, x, u = motion()
    counts = np.round(u / 0.01) % 65536
    data = answer(
        tmp_path, FORCE.replace("unit: N}\nresponse", "unit: N, scale: 0.01}\nresponse"), (t, x, counts)
    )
    assert found(data) == ["log_wrap"]
    assert mass(data) == pytest.approx(MASS, rel=0.03)


@pytest.mark.slow
def test_a_hole_in_the_table_changes_little(tmp_path: Path) -> None:
    t, x, u = motion()
    keep = (t < 9) | (t > 11)
    whole, holed = tmp_path / "whole", tmp_path / "holed"
    whole.mkdir(), holed.mkdir()
    a, b = answer(whole, FORCE, (t, x, u)), answer(holed, FORCE, (t[keep], x[keep], u[keep]))
    assert b["error"]["torque"]["after"] == pytest.approx(a["error"]["torque"]["after"], rel=0.2)
    assert any("1 gap, 2.01 s without rows" in r for r in b["reasons"])


@pytest.mark.slow
def test_a_square_wave_on_the_command_is_found_at_its_frequency(tmp_path: Path) -> None:
    t, x, u = motion()
    data = answer(tmp_path, FORCE, (t, x, u + 0.8 * np.sign(np.sin(2 * np.pi * 1.3 * t))))
    assert found(data)[0] == "command_disturbance"
    assert data["effects"][0]["frequency_Hz"] == pytest.approx(1.3, rel=1e-3)


@pytest.mark.slow
def test_a_late_effort_is_named_and_taken_out(tmp_path: Path) -> None:
    t, x, u = motion()
    late = np.interp(t - 0.012, t, u)
    data = answer(tmp_path, FORCE, (t, x, late))
    assert found(data)[0] == "channel_delay"
    assert data["effects"][0]["parameters"]["delay"]["value"] == pytest.approx(0.012, abs=0.001)
    assert data["error"]["torque"]["after"] < 0.3 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_a_weight_is_gravity(tmp_path: Path) -> None:
    t, x, u = motion()
    angle = 5 * x
    data = answer(
        tmp_path, FORCE.replace("unit: m}", "unit: rad}"), (t, angle, u + 6.0 * np.cos(angle - 0.4))
    )
    assert found(data) == ["gravity_imbalance"]
    amplitude = data["effects"][0]["parameters"]["amplitude"]
    assert amplitude["low"] < 6.0 < amplitude["high"]


@pytest.mark.slow
def test_warmth_from_file_to_file_is_no_preload(tmp_path: Path) -> None:
    t, x, u = motion(15.0)
    v = np.gradient(x, t)
    files = []
    for k in range(8):
        clock = t + 40.0 * k
        files.append((clock, x, u + 2.0 * np.sign(v) * np.exp(-clock / 100.0)))
    data = answer(tmp_path, FORCE, *files)
    assert found(data)[0] == "friction_warmup"
    assert data["effects"][0]["parameters"]["time_constant"]["value"] == pytest.approx(100.0, rel=0.3)


def test_play_between_two_encoders(tmp_path: Path) -> None:
    t = np.arange(0, 60, 0.01)
    motor = 2.0 * np.sin(2 * np.pi * 0.13 * t) + 0.7 * np.sin(2 * np.pi * 0.31 * t)
    joint, y = np.zeros(len(t)), 0.0
    for k, m in enumerate(motor):  # the play operator, by hand
        y = min(max(y, m - 0.25), m + 0.25)
        joint[k] = 0.02 * y
    joint += 2e-4 * np.random.default_rng(2).standard_normal(len(t))
    data = answer(tmp_path, SENSORS, (t, motor, joint))
    assert found(data) == ["play"]
    gap = data["effects"][0]["parameters"]["gap"]
    assert gap["low"] < 0.01 < gap["high"]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("scale: 2e-7", "scale: 2e-7, scale: 1", "'scale' is given twice"),
        ("estimate:", "regulator: {law: P}\nestimate:", "unknown field 'regulator'"),
        ("unit: N}\nresponse", "unit: N}\n  current: {column: i, unit: A}\nresponse", "nothing uses it"),
        (
            "estimate: [inertia",
            "constants: {inertia: {value: 1, unit: kg, source: s}}\nestimate: [inertia",
            "known or estimated",
        ),
        ("effort, unit: N}", "effort, unit: N, ratio: 1}", "is for a second sensor"),
    ],
)
def test_keys_that_say_nothing_are_refused(tmp_path: Path, old: str, new: str, says: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(FORCE.replace("unit: m}", "unit: m, scale: 2e-7}"))
    assert load_rig(path).columns["position"].scale == 2e-7
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(CalibrationInputError, match=says):
        load_rig(path)


def test_a_column_that_stands_twice_or_nowhere_says_so(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text(FORCE)
    for name, text, says in (
        ("a.csv", "t,x,x,u\n0,1,2,3\n1,2,3,4\n", "stands more than once"),
        ("b.json", '[{"t": 0}]', "no such column; the file has t"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(CalibrationInputError, match=says):
            show_rig(tmp_path / "rig.yaml", [tmp_path / name])


def test_matlab_in_its_own_words(tmp_path: Path) -> None:
    from scipy.io import savemat

    cells = np.empty((2, 1), dtype=object)
    cells[0, 0], cells[1, 0] = np.arange(6.0).reshape(2, 3), np.arange(6.0, 12.0).reshape(2, 3)
    savemat(tmp_path / "a.mat", {"Y": cells, "log": {"q": np.arange(3.0)}, "m": np.eye(3)})
    runs = read_matlab(tmp_path / "a.mat", ["Y{*}(2,:)", "log.q", "m(:,3)"])
    assert [r["Y{*}(2,:)"].tolist() for r in runs] == [[3, 4, 5], [9, 10, 11]]
    assert runs[1]["log.q"].tolist() == [0, 1, 2] and runs[0]["m(:,3)"].tolist() == [0, 0, 1]
    for name, says in (
        ("Y{3}(1,:)", "2 cells"),
        ("m", "is a matrix"),
        ("log", "a struct with q"),
        ("z", "no such"),
    ):
        with pytest.raises(CalibrationInputError, match=says):
            read_matlab(tmp_path / "a.mat", [name])


def test_schmidt_rig_shows_the_columns_and_a_plot(tmp_path: Path) -> None:
    t, x, u = motion(5.0)
    (tmp_path / "rig.yaml").write_text(FORCE)
    np.savetxt(
        tmp_path / "a.csv",
        np.column_stack([t, np.round(x, 3), u]),
        delimiter=",",
        header="t,x,u",
        comments="",
    )
    text = show_rig(tmp_path / "rig.yaml", [tmp_path / "a.csv"], tmp_path / "a.png")
    assert "1000 rows" in text and "200 Hz" in text and "0.001" in text
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_the_quantum_is_the_step_of_a_rounded_column_and_none_of_a_smooth_one() -> None:
    x = np.cumsum(np.random.default_rng(0).standard_normal(2000))
    assert quantum(np.round(x / 0.25) * 0.25) == pytest.approx(0.25)
    assert quantum(x) is None


def test_every_name_is_of_the_catalogue_and_says_how_to_be_told_apart() -> None:
    for name in NAMES.values():
        assert name.name in CATALOGUE and name.experiment


def several(count: int = 3) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Files of one drive that share the position's zero, each at its own speed and noise."""
    out = []
    for k in range(count):
        t = np.arange(0, 24.0, PERIOD)
        w = 2 * np.pi * np.array([0.21, 0.53]) * (1 + 0.07 * k)
        size = np.array([0.3, 0.1])
        x = (size * np.sin(np.outer(t, w))).sum(1)
        v = (size * w * np.cos(np.outer(t, w))).sum(1)
        a = -(size * w**2 * np.sin(np.outer(t, w))).sum(1)
        noise = 0.02 * np.random.default_rng(k).standard_normal(len(t))
        out.append((t, x, MASS * a + VISCOUS * v + COULOMB * np.sign(v) + noise))
    return out


@pytest.mark.slow
def test_a_gear_is_found_though_a_whole_file_is_held_out(tmp_path: Path) -> None:
    stage = FORCE + "stages:\n  - {name: screw, period: 0.05}\n"
    tables = [(t, x, u + 0.5 * np.cos(2 * np.pi * x / 0.05 + 1.0)) for t, x, u in several()]
    data = answer(tmp_path, stage, *tables)
    assert found(data)[:1] == ["gear_eccentricity"]
    assert data["effects"][0]["parameters"]["amplitude"]["value"] == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
def test_a_gear_whose_zero_differs_from_file_to_file_is_found_too(tmp_path: Path) -> None:
    stage = FORCE + "stages:\n  - {name: screw, period: 0.05}\n"
    tables = [
        (t, x, u + 0.5 * np.cos(2 * np.pi * x / 0.05 + 2.1 * k)) for k, (t, x, u) in enumerate(several())
    ]
    data = answer(tmp_path, stage, *tables)
    assert found(data)[:1] == ["gear_eccentricity"]


@pytest.mark.slow
def test_friction_in_waves_of_no_stage_is_found_with_their_length(tmp_path: Path) -> None:
    tables = [
        (
            t,
            x,
            u + 0.4 * np.gradient(x, t) / np.abs(np.gradient(x, t)).clip(1e-6) * np.cos(2 * np.pi * x / 0.13),
        )
        for t, x, u in several()
    ]
    data = answer(tmp_path, FORCE, *tables)
    assert found(data)[:1] == ["position_friction"]
    assert 1 / data["effects"][0]["order"] == pytest.approx(0.13, rel=0.02)


@pytest.mark.slow
def test_half_a_sample_of_delay_either_way_is_a_sound_loop(tmp_path: Path) -> None:
    for k, shift in enumerate((-0.5, 0.5)):
        tables = [(t, x, np.interp(t - shift * PERIOD, t, u)) for t, x, u in several()]
        folder = tmp_path / str(k)
        folder.mkdir()
        assert found(answer(folder, FORCE, *tables)) == []
