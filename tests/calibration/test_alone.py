"""Shapes without a name that look like sums of names: a slip, an end stop, what hangs on a measured load."""

from pathlib import Path

import numpy as np
import pytest

from calibration.balances.view import view_of
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table
from calibration.look.said import place_of
from calibration.names.unknown_shapes import over
from tests.calibration.test_drives import COULOMB, FORCE, MASS, PERIOD, SENSORS, VISCOUS, motion
from tests.calibration.test_drives import answer as answer_of
from tests.calibration.test_strangers import LONG, answer, domains, rate

RATIO = 0.02  # of the second sensor to the first
QUIET = 2e-7  # rad, rms, of the second sensor
LOADED = SENSORS.replace("response:", "  effort: {column: load, unit: N m}\nresponse:")


def sensors(seconds: float = LONG) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, motor and output of a gear with nothing in it."""
    t, x, _ = motion(seconds)
    return t, x, RATIO * x + QUIET * np.random.default_rng(2).standard_normal(len(t))


@pytest.mark.slow
@pytest.mark.parametrize("files", [1, 3])
def test_slips_have_their_sizes_and_the_rest_is_as_if_there_were_none(tmp_path: Path, files: int) -> None:
    """At other times in each file: no file tells of another's slip."""
    tables, largest = [], 4e-5
    for k in range(files):
        t, x, y = sensors()
        steps = largest * (t > 22.0 + 7.0 * k) - 1.5e-5 * (t > 41.0 - 3.0 * k)
        tables.append((t, np.round(x, 5), y + steps))
    data = answer_of(tmp_path, SENSORS, *tables)
    assert [e["name"] for e in data["effects"]] == ["roller_slip"]
    first = data["effects"][0]
    assert first["parameters"]["step"]["value"] == pytest.approx(largest, rel=0.02)
    assert first["note"].count(" of file ") == 2 * files
    error = data["error"]["position"]
    assert error["after"] < 1.2 * error["floor"] < error["before"]


def test_a_bracket_that_swings_is_a_line_over_time_between_two_sensors(tmp_path: Path) -> None:
    t, x, y = sensors()
    data = answer_of(tmp_path, SENSORS, (t, np.round(x, 5), y + 4e-7 * np.sin(2 * np.pi * 1.37 * t)))
    (found,) = data["effects"]
    assert (found["name"], found["domain"]) == ("unknown", "time")
    assert found["frequency_Hz"] == pytest.approx(1.37, rel=0.002)
    error = data["error"]["position"]
    assert error["after"] < 1.2 * error["floor"]


def test_no_slip_is_smaller_than_a_count(tmp_path: Path) -> None:
    """A drift through one count of the second sensor looks like a step of it."""
    t, x, y = sensors()
    counts = np.round((y + 1e-5 * (t / t[-1]) ** 8) / 2e-5) * 2e-5
    assert "roller_slip" not in [e["name"] for e in answer_of(tmp_path, SENSORS, (t, x, counts))["effects"]]


def test_a_gap_that_every_reversal_crosses_is_no_slip(tmp_path: Path) -> None:
    t, x, y = sensors()
    way = np.sign(rate(x))
    data = answer(tmp_path, SENSORS, (t, x, y - 2e-5 * way))
    assert [e["name"] for e in data["effects"]] == ["play"]


@pytest.mark.slow
def test_an_end_stop_is_one_function_of_the_place(tmp_path: Path) -> None:
    """A buffer that is pressed over the last third of the stroke."""
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, u + 150.0 * np.maximum(x - 0.12, 0.0) ** 2))
    assert domains(data) == {("unknown", "axis_angle")}
    (stop,) = data["effects"]
    assert stop["parameters"]["begin"]["value"] == pytest.approx(0.12, abs=0.01)
    assert data["error"]["torque"]["after"] < 1.2 * data["error"]["torque"]["floor"]


@pytest.mark.slow
def test_an_end_stop_is_no_function_of_the_load_that_it_makes(tmp_path: Path) -> None:
    """It pushes 25 times as hard as mass and friction together, which must not turn the sign of the force."""
    t, x, u = motion(LONG)
    stop = 2000.0 * np.maximum(x - 0.12, 0.0) ** 2
    data = answer(tmp_path, FORCE, (t, x, u + stop))
    assert data["effects"][0]["domain"] == "axis_angle"
    assert data["effects"][0]["parameters"]["begin"]["value"] == pytest.approx(0.12, abs=0.001)
    assert data["error"]["torque"]["after"] < 0.02 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_iron_that_saturates_is_a_function_of_the_current(tmp_path: Path) -> None:
    """The force that the motion needs is what is left of the effort, less a tenth of its square at 8 N."""
    t, x, force = motion(LONG)
    bend = 0.1 / 8.0  # effort less bend times its square is the force: the root of that
    effort = np.sign(force) * (1 - np.sqrt(1 - 4 * bend * np.abs(force))) / (2 * bend)
    data = answer(tmp_path, FORCE, (t, x, effort))
    assert domains(data) == {("unknown", "current")}
    assert data["error"]["torque"]["after"] < 0.3 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_what_hangs_on_a_load_is_a_function_of_it_and_not_of_place_and_way(tmp_path: Path) -> None:
    """Teeth that stiffen; the load is a weight that is lifted, and what it rubs."""
    t, x, y = sensors()
    load = np.sin(3.0 * x) + 0.4 * np.tanh(rate(x) / 0.05)
    y = y - 4e-5 * load**3
    seen = load + 0.01 * np.random.default_rng(5).standard_normal(len(t))
    data = answer_of(tmp_path, LOADED, (t, np.round(x, 5), y, seen), header="t,x,u,load")
    assert domains(data) <= {("unknown", "current"), ("shaft_compliance", "current")}
    assert data["error"]["position"]["after"] < 0.3 * data["error"]["position"]["before"]


@pytest.mark.slow
def test_friction_grows_with_what_two_joints_weigh(tmp_path: Path) -> None:
    """The weight of the next joint is a load as well, though the offset shares what it makes."""
    t, x, u = motion(LONG)
    joint = 0.8 * np.sin(2 * np.pi * 0.17 * t)
    weight = 6.0 * np.sin(x) + 9.0 * np.sin(x + joint + 0.4)
    rubbing = 0.08 * np.abs(weight + u - COULOMB * np.sign(rate(x))) * np.sign(rate(x))
    text = FORCE.replace("unit: m}", "unit: rad}").replace("offset]", "offset, gravity]")
    text = text.replace("response:", "  joint: {column: q, unit: rad}\nresponse:")
    data = answer_of(tmp_path, text, (t, np.round(x, 5), u + weight + rubbing, joint), header="t,x,u,q")
    first = data["effects"][0]
    assert first["name"] == "load_friction"
    assert first["parameters"]["coefficient"]["value"] == pytest.approx(0.08, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("period", "harmonics", "width"), [(0.25, 3, 0.02), (0.8, 6, 0.06)])
def test_a_dent_is_one_place_and_no_harmonics(
    tmp_path: Path, period: float, harmonics: int, width: float
) -> None:
    """Of a tape: 8 µrad high, where a stage of three turns or of one has harmonics that could make it."""
    t, x, y = sensors()
    dent = 8e-6 * np.exp(-0.5 * ((x + 0.07) / width) ** 2)
    rig = SENSORS + f"stages:\n  - {{name: disc, period: {period}, harmonics: {harmonics}}}\n"
    data = answer_of(tmp_path, rig, (t, np.round(x, 5), y + dent))
    assert domains(data) == {("unknown", "axis_angle")}
    (only,) = data["effects"]
    assert only["parameters"]["place"]["value"] == pytest.approx(-0.07, abs=0.002)
    assert only["parameters"]["amplitude"]["value"] == pytest.approx(8e-6, rel=0.1)
    assert data["error"]["position"]["after"] < 1.5 * data["error"]["position"]["floor"]


def test_a_slip_that_is_long_past_is_found(tmp_path: Path) -> None:
    """In the first third of one file, whose end is held out: no held-out row sees it."""
    t, x, y = sensors()
    data = answer_of(tmp_path, SENSORS, (t, np.round(x, 5), y + 4e-5 * (t > 17.0)))
    assert [e["name"] for e in data["effects"]] == ["roller_slip"]
    assert data["effects"][0]["parameters"]["time"]["value"] == pytest.approx(17.0, abs=0.05)


@pytest.mark.parametrize("seed", range(4))
def test_an_offset_that_walks_has_no_slips(tmp_path: Path, seed: int) -> None:
    """A random walk of ten times the noise over the file: every row is a step of it."""
    t, x, y = sensors()
    walk = np.cumsum(np.random.default_rng(seed).standard_normal(len(t))) * 10 * QUIET / np.sqrt(len(t))
    data = answer_of(tmp_path, SENSORS, (t, np.round(x, 5), y + walk))
    assert "roller_slip" not in [e["name"] for e in data["effects"]]


@pytest.mark.slow
def test_a_declared_mass_is_a_load_as_well(tmp_path: Path) -> None:
    t, x, u = motion(LONG)
    load = MASS * rate(rate(x))
    rubbing = 0.3 * np.abs(load) * np.sign(rate(x))
    mass = f"constants: {{inertia: {{value: {MASS}, unit: kg, source: a scale}}}}\n"
    rig = FORCE.replace("[inertia, ", "[") + mass
    data = answer_of(tmp_path, rig, (t, np.round(x, 5), u + rubbing))
    first = data["effects"][0]
    assert first["name"] == "load_friction"
    assert first["parameters"]["coefficient"]["value"] == pytest.approx(0.3, rel=0.1)


def turning(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place and force of the mass: to and fro for 40 s, then nine tenths of the time one way."""
    v = np.where(t < 40.0, 0.5 * np.sin(1.3 * t), 0.42 + 0.45 * np.sin(1.3 * t))
    v = np.convolve(np.pad(v, 50, "edge"), np.ones(101) / 101, "valid")
    force = MASS * np.gradient(v, PERIOD) + VISCOUS * v + COULOMB * np.sign(v)
    return np.cumsum(v) * PERIOD, force


@pytest.mark.slow
@pytest.mark.parametrize("drags", [True, False])
def test_an_offset_that_changes_is_no_brake_although_most_goes_one_way(tmp_path: Path, drags: bool) -> None:
    """From 44 s on; a brake turns over with the motion in the tenth that is left."""
    t = np.arange(0, 80.0, PERIOD)
    x, force = turning(t)
    more = 0.15 * (t > 44.0) * (np.sign(np.gradient(x)) if drags else 1.0)
    noise = 0.1 * np.random.default_rng(6).standard_normal(len(t))
    data = answer_of(tmp_path, FORCE, (t, np.round(x, 5), force + more + noise))
    names = [e["name"] for e in data["effects"]]
    assert names == ["brake_drag"] if drags else set(names) <= {"unknown"}


def test_a_function_of_a_load_is_drawn_over_the_load(tmp_path: Path) -> None:
    t, x, y = sensors(10.0)
    rig = tmp_path / "rig.yaml"
    rig.write_text(LOADED, "utf-8")
    table = np.column_stack((t, np.round(x, 5), y, np.sin(3.0 * x)))
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,x,u,load", comments="")
    declared = load_rig(rig)
    view = view_of(read_table(tmp_path / "a.csv", declared), declared, declared.responses[0])
    values, label = place_of(view, over("current", np.zeros((len(view.rows), 1)), ("square", "rad")))
    assert label == "effort, N m"
    assert values == pytest.approx(np.sin(3.0 * view.x[view.rows]), abs=0.05)


@pytest.mark.slow
def test_a_curve_over_the_place_stays_where_one_file_goes_on_alone(tmp_path: Path) -> None:
    """Of four files one goes 150 mm further, where the cable slackens: no other tells that."""
    t, x, u = motion(15.0)
    tables = []
    for k in range(4):
        place = x + 0.02 * k + 0.15 * (k == 2)
        tables.append((t, place, u + 12.0 * np.tanh(place / 0.1) - 72.0 * np.maximum(place - 0.42, 0.0)))
    data = answer_of(tmp_path, FORCE, *tables)
    assert data["effects"][0]["domain"] == "axis_angle"
    assert data["error"]["torque"]["after"] < 0.3 * data["error"]["torque"]["before"]
