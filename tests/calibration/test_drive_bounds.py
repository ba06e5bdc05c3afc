"""What a drive's answer may not say: sizes of a sign that physics excludes, files apart by whole counters, a
floor below what is made again; and what it says of a rate or a delay that it cannot name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.balances.agreement import velocity_against_position
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.balances.view import view_of
from calibration.decide.energy import signed
from calibration.decide.select import select
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from tests.calibration.test_drives import FORCE, SENSORS, answer, found, motion

SHARED = FORCE.replace("unit: m}", "unit: rad}") + "runs: {origin: shared}\n"


def loops(rng: np.random.Generator, n: int, second: float) -> tuple[Problem, Candidate]:
    """A response of two columns, the second with a size that may be of either sign."""
    x = rng.standard_normal((n, 2))
    y = 3.0 * x[:, 0] + second * x[:, 1] + 0.1 * rng.standard_normal(n)
    zero = np.zeros(n, dtype=np.int64)
    held = np.arange(n) > 0.6 * n
    one, good = np.ones((n, 1)), np.ones(n, dtype=bool)
    t = np.arange(n, dtype=np.float64) * np.float64(0.01)
    problem = Problem(
        channel="T",
        unit="N",
        y=y,
        base=one,
        base_labels=[("offset", "N")],
        t=t,
        run=zero,
        session=zero,
        valid=good,
        held=held,
        period_s=0.01,
        ar_order=0,
        block_s=0.5,
    )
    return problem, Candidate("presliding", "reversal", x, (("first", "N"), ("second", "N")))


@pytest.mark.parametrize(("second", "left"), [(0.5, ["first", "second"]), (-0.5, ["first"])])
def test_a_part_of_an_effect_with_the_wrong_sign_is_left_out_of_it(second: float, left: list[str]) -> None:
    rng = np.random.default_rng(0)
    problem, free = loops(rng, 6000, second)
    s = select(problem, [free], rng)
    assert len(s.chosen) == 1
    bound = type(free)(**{**free.__dict__, "sign": 1})
    s.chosen[0] = type(s.chosen[0])(**{**s.chosen[0].__dict__, "candidate": bound})
    ((c, beta),) = signed(s).fitted
    assert [n for n, _ in c.labels] == left and (beta > 0).all()


@pytest.mark.slow
def test_files_that_share_a_zero_through_a_counter_are_put_together(tmp_path: Path) -> None:
    tables = []
    for least in (0.3, -0.5, 0.9):  # rad: one file begins below the counter's edge
        t, x, u = motion()
        angle = 5 * x
        begin = int(np.argmax(np.abs(angle - least) < 0.02))
        counts = np.round((angle + 4.096) / 1.25e-4) % 32768
        table = (t, counts, u + 6.0 * np.cos(angle - 0.4))
        tables.append(tuple(c[begin:] for c in table))
    data = answer(tmp_path, SHARED.replace("unit: rad}", "unit: rad, scale: 1.25e-4}"), *tables)
    assert set(found(data)) == {"gravity_imbalance", "log_wrap"}


def test_a_gap_has_a_width_whichever_way_the_difference_was_taken(tmp_path: Path) -> None:
    t = np.arange(0, 60, 0.01)
    motor = 2.0 * np.sin(2 * np.pi * 0.13 * t) + 0.7 * np.sin(2 * np.pi * 0.31 * t)
    joint, y = np.zeros(len(t)), 0.0
    for k, m in enumerate(motor):  # the play operator, by hand
        y = min(max(y, m - 0.25), m + 0.25)
        joint[k] = y
    difference = motor - joint + 2e-3 * np.random.default_rng(2).standard_normal(len(t))
    data = answer(tmp_path, SENSORS.replace("ratio: 0.02", "ratio: 0"), (t, motor, difference))
    assert found(data) == ["play"] and "first sensor less the second" in data["effects"][0]["note"]
    gap = data["effects"][0]["parameters"]["gap"]
    assert 0 < gap["low"] < 0.5 < gap["high"]


@pytest.mark.slow
def test_a_rate_of_another_scale_or_sign_is_told(tmp_path: Path) -> None:
    t, x, u = motion()
    rig = FORCE.replace("\nresponse", "\n  velocity: {column: v, unit: m/s}\nresponse")
    for factor in (-1.0, 1.03):
        folder = tmp_path / str(factor)
        folder.mkdir()
        (folder / "rig.yaml").write_text(rig)
        v = factor * np.gradient(x, t) + 1e-4 * np.random.default_rng(4).standard_normal(len(t))
        table = np.column_stack([t, x, u, v])
        np.savetxt(folder / "a.csv", table, delimiter=",", header="t,x,u,v", comments="", fmt="%.9g")
        from calibration.command import calibrate

        assert calibrate([folder / "a.csv"], folder / "rig.yaml", [], folder / "out", plots=False) == 0
        assert f"velocity reads {factor:.4g} times the position's rate" in (
            folder / "out" / "report.json"
        ).read_text().replace("-1.000", "-1").replace("1.030", "1.03")


def test_a_sound_rate_agrees_with_the_position_whatever_shakes_it(tmp_path: Path) -> None:
    """A wave of nine rows: the position's difference dims it, and filtered noise is not white."""
    t, x, u = motion(60.0)
    quick = 2 * np.pi / (9 * (t[1] - t[0]))
    shaken = x + 2e-4 * np.sin(quick * t)
    rate = np.gradient(x, t) + 2e-4 * quick * np.cos(quick * t)
    rng = np.random.default_rng(6)
    rate += 0.01 * np.std(rate) * rng.standard_normal(len(t))
    shaken += 1e-6 * rng.standard_normal(len(t))
    (tmp_path / "rig.yaml").write_text(
        FORCE.replace("\nresponse", "\n  velocity: {column: v, unit: m/s}\nresponse")
    )
    table = np.column_stack([t, shaken, u, rate])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,x,u,v", comments="", fmt="%.9g")
    drive = read_drive([tmp_path / "a.csv"], load_rig(tmp_path / "rig.yaml"))
    assert drive.rig is not None
    view = view_of(drive.runs, drive.rig, drive.rig.responses[0])
    found = velocity_against_position(view, np.arange(len(view.rows)) > 0.7 * len(view.rows))
    assert found is not None and not found.late
    assert 0.5 < found.left < 1.5
    assert found.hardly
    apart = replace(view, columns={**view.columns, "velocity": rate + 0.05 * np.sin(t)})
    seen = velocity_against_position(apart, np.arange(len(view.rows)) > 0.7 * len(view.rows))
    assert seen is not None and not seen.hardly


@pytest.mark.slow
def test_strokes_that_are_made_again_are_the_floor_of_a_friction_test(tmp_path: Path) -> None:
    rig = FORCE.replace("inertia, ", "")
    rng = np.random.default_rng(5)
    t = np.arange(0, 200, 0.02)
    x = 0.1 * np.sin(2 * np.pi * t / 4.017)  # a period of no whole number of rows
    way = np.sign(np.gradient(x, t))
    # differs from stroke to stroke, smooth from row to row
    slow = np.convolve(rng.standard_normal(len(t)), np.ones(25) / 5, "same")
    u = 3.0 * way + 0.1 * slow
    data = answer(tmp_path, rig, (t, x, u))
    assert data["error"]["torque"]["floor"] == pytest.approx(0.1 * float(np.std(slow)), rel=0.25)
    assert any("strokes that are made again" in r for r in data["reasons"])
