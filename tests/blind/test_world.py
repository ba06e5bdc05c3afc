"""The third family: physics against closed forms, seals, formats, what is right, an answer to every kind."""

import hashlib
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from calibration.inputs.rigfile import load_rig
from tests.blind.drives.one import one
from tests.blind.drives.order import Order
from tests.blind.drives.score import fits, holds_zero, score
from tests.blind.world import arm_kernel, cells, gears, guide, logfile, motor, phd2, sky
from tests.blind.world.case import inner, seal
from tests.blind.world.logfile import Column, Log, Style
from tests.blind.world.made import TURN, Array, clock

NAMES = {
    line[3:].strip()
    for line in (Path(__file__).parents[2] / "docs/reference/effects.md").read_text().splitlines()
    if line.startswith("## ")
}


def free_joint(seconds: float, start: float, **values: float) -> Array:
    """A joint without a motor, let go at an angle; rows at 1 ms."""
    p = {"INERTIA": 1.0, "VS": 0.01, "TOP": 1.0, "STEP": 1e-9, "EFFORT_STEP": 1.0, **values}
    n = int(seconds / 1e-3)
    zero = np.zeros(n)
    return np.asarray(arm_kernel.drive(arm_kernel.vector(p), np.full(n, start), zero, zero, zero, 1e-3, 0.0))


def test_a_joint_that_hangs_swings_as_a_pendulum() -> None:
    x = free_joint(10.0, 1.2, GRAV=30.0)[:, arm_kernel.X]
    crossings = np.flatnonzero(np.diff(np.sign(x)) != 0)
    period = 2.0 * np.mean(np.diff(crossings)) * 1e-3
    assert period == pytest.approx(4.0 * ellipk(math.sin(0.6) ** 2) / math.sqrt(30.0), rel=2e-3)


def test_dry_friction_takes_the_same_from_every_swing() -> None:
    x = free_joint(25.0, 1.0, CABLE=40.0, COUL=0.5, STIC=0.5)[:, arm_kernel.X]
    peaks = [x[k] for k in range(1, len(x) - 1) if x[k - 1] < x[k] >= x[k + 1]]
    assert np.diff(peaks)[:5] == pytest.approx(-4 * 0.5 / 40.0, rel=0.03)
    assert abs(x[-1]) < 0.5 / 40.0 and x[-1] == x[-200]  # it sticks where the spring is weaker than friction


def test_a_loop_without_integral_stands_beside_its_goal_by_the_weight() -> None:
    n = 4000
    goal, zero = np.full(n, 0.5), np.zeros(n)
    p = {"INERTIA": 0.1, "VISC": 2.0, "VS": 0.1, "GAIN": 2.0, "KP": 50.0, "TOP": 100.0, "STEP": 1e-6,
         "EFFORT_STEP": 1e-6, "GRAV": 3.0}  # fmt: skip
    rows = arm_kernel.drive(arm_kernel.vector(p), goal, zero, zero, zero, 2e-3, 0.0)
    x = float(rows[-1, arm_kernel.X])
    assert 0.5 - x == pytest.approx(3.0 * math.sin(x) / (2.0 * 50.0), rel=1e-3)


def test_a_speed_loop_answers_a_disturbance_as_its_transfer_function() -> None:
    m = motor.draw(np.random.default_rng(1), False)
    m.period_s, m.rows, m.bandwidth = 1e-3, 4000, 4.0
    lines = (np.array([0.0]), np.array([7.0]), np.array([0.5]), np.array([0.3]))
    w = motor.spun(m.rows, m.period_s, 3.0, motor.loop_of(m), *lines)[2000:, 0]
    t = clock(2000, 1e-3)
    amplitude = 2.0 * abs(complex(np.mean((w - 3.0) * np.exp(1j * TURN * 7.0 * t))))
    p, i = motor.loop_of(m)
    s = 1j * TURN * 7.0
    assert amplitude == pytest.approx(0.5 * abs(s / (s * s + p * s + i)), rel=5e-3)


def test_a_motor_with_cogging_runs_as_an_independent_solver_has_it() -> None:
    loop = np.array([6.0, 9.0])
    lines = (np.array([12.0]), np.array([0.0]), np.array([40.0]), np.array([0.5]))
    rows = motor.spun(1000, 1e-3, 1.5, loop, *lines)

    def rate(_t: float, y: Array) -> list[float]:
        return [
            -6.0 * (y[0] - 1.5) - 9.0 * y[2] + 40.0 * math.cos(TURN * 12.0 * y[1] + 0.5),
            y[0],
            y[0] - 1.5,
        ]

    told = solve_ivp(rate, (0, 1), [1.5, 0.0, 0.0], rtol=1e-9, atol=1e-10, t_eval=[0.25, 0.5, 0.9])
    assert rows[[250, 500, 900], 0] == pytest.approx(told.y[0], abs=1e-6)
    assert rows[[250, 500, 900], 1] == pytest.approx(told.y[1], abs=1e-6)


def test_a_gap_is_as_wide_as_its_loop() -> None:
    x = np.sin(np.linspace(0.0, 20.0, 5000))
    beside = gears.behind(x, 0.1)[1000:] - x[1000:]
    assert np.ptp(beside) == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("dither_s", [0.0, 120.0])
def test_a_guide_log_holds_the_worm_whatever_was_guided(dither_s: float) -> None:
    rng = np.random.default_rng(4)
    s, g = sky.draw(rng), phd2.draw(rng)
    g = replace(g, hit=1.0, lost=0.0, dither_s=dither_s, dither_px=4.0)
    s = replace(s, seeing=0.2, wander=0.0, drift=10.0)
    error = sky.worm(rng, 480.0)
    error.periods, error.amplitudes, error.phases = [480.0], [6.0], [1.0]
    lines, _, _ = phd2.section(rng, s, g, "EQMOD HEQ5/6", error, "gaussian", 0.0, 2400.0)
    t, y = guide.open_loop("\n".join(lines))
    assert guide.amplitude(t, y * g.scale, 480.0) == pytest.approx(6.0, rel=0.02)
    assert any("DITHER" in line for line in lines) == (dither_s > 0)


def test_sign_magnitude_words_are_those_of_the_documentation() -> None:
    column = logfile.encode(Column("effort", "u", "1", np.array([-1.0, 1.0, 0.0, -7.0])), 10)
    assert list(column.values) == [1025.0, 1.0, 0.0, 1031.0] and "sign_bit: 10" in column.told()


def test_tables_hold_the_same_numbers_in_every_shape() -> None:
    values = np.array([1.5, -2.25, 3.0])
    log = Log(np.array([0.0, 0.1, 0.2]), [Column("position", "x", "m", values)], 3600.0)
    rng = np.random.default_rng(0)
    assert logfile.write(log, Style("s", "semicolon"), rng).splitlines()[2] == "0.100000;-2.25"
    iso = logfile.write(log, Style("iso", "comma"), rng).splitlines()[2]
    assert iso == "2024-03-09T21:15:07.100000Z,-2.25"
    rows = [json.loads(line) for line in logfile.write(log, Style("ms", "lines"), rng).splitlines()]
    assert rows[1] == {"t": 100.0, "x": -2.25}
    assert json.loads(logfile.write(log, Style("s", "lists"), rng)) == {
        "t": [0.0, 0.1, 0.2],
        "x": list(values),
    }
    assert logfile.write(log, Style("s", "long"), rng).splitlines()[2] == "0.100000,x,-2.25"


def test_names_are_the_catalogues_and_keys_are_unique() -> None:
    orders = cells.everything()
    assert len({o.key for o in orders}) == len(orders)
    told = {"worm": "gear_eccentricity", "before": "gear_eccentricity"}
    for order in orders:
        for name in order.names:
            assert name.startswith("outside") or told.get(name, name) in NAMES
    count = {cell: sum(o.cell == cell for o in orders) for cell in ("nothing", "single", "outside", "short")}
    assert (
        count["nothing"] >= 40 and count["single"] >= 100 and count["outside"] >= 25 and count["short"] >= 10
    )
    assert len(cells.develop()) == pytest.approx(40, abs=4) and len(cells.strata()) == pytest.approx(
        60, abs=5
    )


def a_case(kind: str, spoil: str = "", cell: str = "single") -> Order:
    """The first order of a kind."""
    found = [o for o in cells.everything() if o.kind == kind and o.cell == cell and spoil in o.spoil]
    return found[0]


KINDS = ("motor", "arm", "guide", "rate", "gear")


@pytest.mark.parametrize("kind", KINDS)
def test_same_seed_same_bytes_and_the_seal_is_the_hash_of_the_truth(tmp_path: Path, kind: str) -> None:
    order = a_case(kind)
    for name in ("one", "two"):
        seal(order, 1001, tmp_path / name / "logs", tmp_path / name / "truth")
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*") if p.is_file())
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    truth = (tmp_path / "one" / "truth" / f"{order.key}.json").read_bytes()
    folder = tmp_path / "one" / "logs" / order.key
    assert (folder / "SEAL").read_text().strip() == hashlib.sha256(truth).hexdigest()
    assert json.loads(truth)["effects"][0]["reached"] > 1.8


@pytest.mark.slow
@pytest.mark.parametrize("spoil", sorted({o.spoil for o in cells.tables()}))
def test_rig_files_are_read_and_tell_nothing_that_is_hidden(tmp_path: Path, spoil: str) -> None:
    order = next(o for o in cells.tables() if o.spoil == spoil)
    seal(order, 1002, tmp_path, tmp_path)
    rig = tmp_path / order.key / "rig.yaml"
    assert load_rig(rig).name
    assert not re.search("outside|imbalance|hidden|np[.]", rig.read_text())
    assert inner(order).kind in KINDS


def a_truth(**more: Any) -> dict[str, Any]:
    wanted = {
        "name": "motor_cogging", "class": ["motor_cogging"], "confounded": ["command_disturbance"],
        "stage": "motor", "channel": "T", "domain": ["motor_angle"], "ratio": 2.0, "reached": 2.0,
        "in_catalogue": True,
    }  # fmt: skip
    return {"key": "k", "cell": "single", "family": "motor", "kind": "gaussian", "spoil": "",
            "effects": [wanted], **more}  # fmt: skip


def test_a_confounded_name_is_right_in_a_class_and_wrong_alone() -> None:
    wanted = a_truth()["effects"][0]
    alone = {"name": "command_disturbance", "equivalent": []}
    assert not fits(alone, wanted)
    assert fits({**alone, "equivalent": ["motor_cogging"]}, wanted)
    assert not fits({**alone, "equivalent": ["motor_cogging", "play"]}, wanted)


def test_a_short_log_may_be_named_or_said_to_be_too_short_with_the_name() -> None:
    truth, told = a_truth(cell="short"), {"failure": None, "seconds": 1.0}
    nothing: dict[str, Any] = {"verdict": "nothing", "effects": [], "error": {}}
    assert not score(told, nothing, truth)["right"]
    short = {**nothing, "verdict": "cannot tell", "separating_experiment": "motor_cogging: twice as long"}
    assert score(told, short, truth)["right"]
    assert not score(told, {**short, "separating_experiment": "longer"}, truth)["right"]
    named = {**nothing, "verdict": "found", "effects": [{"name": "motor_cogging", "stage": "motor"}]}
    row = score(told, named, truth)
    assert row["right"] and row["stage_right"]


def test_a_size_whose_interval_holds_zero_is_counted() -> None:
    size = {"value": 0.1, "low": 0.0, "high": 0.3}
    assert holds_zero({"name": "play", "parameters": {"gap": size}})
    assert not holds_zero({"name": "play", "parameters": {"gap": {**size, "low": 0.05}, "phase": size}})


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*KINDS, "table"])
def test_a_case_of_every_kind_gets_an_answer(tmp_path: Path, kind: str) -> None:
    row = one(a_case(kind), 1001, tmp_path, "scenarios.cli:main", seal)
    assert row["answered"], row["failure"]
