"""Axis logs on one grid: gaps, sessions, clocks, transients; and the motion by the encoder."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.balances import frame as frames
from calibration.balances.frame import Frame, build_frame, fill
from calibration.balances.motion import acceleration_of, motion_of, rate_of
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run

PERIOD_S = 0.01
SCALES = {"sample_period_s": PERIOD_S, "adc_end_A": 5.0}


def run(rows: int = 100, missing: slice | None = None, session: str = "a", **more: Any) -> Run:
    """The axis turns at 0.1 rad/s, effort 0.3, unless columns say more."""
    t = PERIOD_S * np.arange(rows)
    start = more.pop("start_s", None)
    columns = {"t": t, "position": 0.1 * t, "effort": np.full(rows, 0.3), **more}
    if missing is not None:
        columns = {k: np.delete(x, missing) for k, x in columns.items()}
    header = {"axis": "ra"}
    return Run("log", Path("log"), session, columns, scales=dict(SCALES), header=header, start_s=start)


def test_runs_follow_each_other_ten_rows_apart_with_sessions_as_they_were_named() -> None:
    f = build_frame([run(100), run(50, session="b"), run(30)])
    assert np.bincount(f.run).tolist() == [100, 50, 30]
    assert [int(f.session[f.run == k][0]) for k in range(3)] == [0, 1, 0]
    assert f.t[[0, 99, 100]] == pytest.approx([0.0, 0.99, 0.99 + 0.1])
    assert f.columns["position"][100] == 0.0 and np.isnan(f.columns["velocity"]).all()
    assert f.period_s == PERIOD_S and f.scale == SCALES and f.rig == telescope("ra") and f.jumps == []
    assert f.clock == pytest.approx(np.zeros(180)) and f.present.all() and f.gaps == []


def test_missing_rows_are_no_numbers() -> None:
    f = build_frame([run(100, slice(40, 45))])
    assert len(f.t) == 100 and np.flatnonzero(~f.present).tolist() == [40, 41, 42, 43, 44]
    assert f.gaps == [5] and np.isnan(f.columns["effort"][40:45]).all()
    assert f.columns["position"][45] == pytest.approx(0.1 * 0.45)


@pytest.mark.parametrize(("step", "rows"), [(1.5, 1), (1.59, 1), (1.61, 2), (2.4, 2), (3.2, 3), (0.3, 1)])
def test_a_stamp_that_leaps_by_less_than_1_6_periods_is_one_row(step: float, rows: int) -> None:
    t = np.array([0.0, 1.0, 1.0 + step, 2.0 + step]) * PERIOD_S
    assert frames._steps(t, PERIOD_S).tolist() == [1, rows, 1]


def test_a_clock_that_was_set_is_no_gap() -> None:
    t = PERIOD_S * np.arange(400)
    set_on = t + np.where(np.arange(400) >= 200, 7.0, 0.0)
    f = build_frame([run(400, t=set_on)])
    assert len(f.t) == 400 and f.jumps == pytest.approx([7.0]) and f.clock == pytest.approx(np.zeros(400))


def test_a_column_is_there_from_a_twentieth_of_the_rows_on() -> None:
    few = np.full(100, np.nan)
    few[:5] = 1.0
    more = few.copy()
    more[5] = 1.0
    f = build_frame([run(100, current_a=few, current_b=more)])
    assert f.get("current_a") is None and f.get("current_b") is not None and f.get("strange") is None
    zeros, known = f.filled("current_a")
    assert not zeros.any() and known.all() and len(zeros) == 100


def test_only_short_gaps_within_a_run_are_trusted() -> None:
    x = np.arange(30.0)
    x[5:8] = x[12:16] = x[0] = x[29] = np.nan
    one = np.zeros(30, dtype=np.int64)
    filled, trusted = fill(x, one)
    assert np.flatnonzero(~trusted).tolist() == [0, 12, 13, 14, 15, 29]
    assert filled[1:29] == pytest.approx(np.arange(1.0, 29.0)) and filled[0] == 1.0 and filled[29] == 28.0
    assert not fill(x, (np.arange(30) > 6).astype(np.int64))[1][5:8].any()
    nothing, trusted = fill(np.full(4, np.nan), one[:4])
    assert not nothing.any() and not trusted.any()


def test_a_jump_of_the_effort_is_a_transient_for_a_quarter_of_a_second() -> None:
    effort = np.full(200, 0.3)
    effort[100:] = 0.321
    f = build_frame([run(200, effort=effort)])
    assert np.flatnonzero(f.transients()).tolist() == list(range(98, 126))
    effort = np.where(np.arange(200) < 100, 0.3, 0.3199)
    assert not build_frame([run(200, effort=effort)]).transients().any()
    between = build_frame([run(100), run(100, effort=np.full(100, 0.9))])
    assert not between.transients().any()  # another run's effort is no jump


def test_a_current_at_its_converter_s_end_is_saturated() -> None:
    f = build_frame([run(3)])
    assert f.saturated(np.array([4.9, 5.0, 5.1])).tolist() == [False, True, True]


def test_one_clock_is_that_of_the_runs_starts() -> None:
    told = build_frame([run(100, start_s=50.0), run(100, start_s=40.0)])
    assert told.one_clock[[0, 99, 100]] == pytest.approx([10.0, 10.99, 0.0])
    partly = build_frame([run(100, start_s=50.0), run(100)])
    assert np.array_equal(partly.one_clock, partly.t)
    # 109 rows' time and fifty times as much are not one session
    far = build_frame([run(100, start_s=0.0), run(100, start_s=50 * 2.08 + 1.0)])
    assert np.array_equal(far.one_clock, far.t)
    near = build_frame([run(100, start_s=0.0), run(100, start_s=50 * 2.08 - 1.0)])
    assert near.one_clock[100] == pytest.approx(50 * 2.08 - 1.0)


@pytest.mark.parametrize("width", [1, 3, 5])
def test_rates_of_a_parabola_are_exact_between_the_ends(width: int) -> None:
    t: np.ndarray = PERIOD_S * np.arange(100)
    x, inner = 1.5 * t**2, slice(2 * width, -2 * width)
    assert rate_of(x, width, PERIOD_S)[inner] == pytest.approx(3 * t[inner])
    assert acceleration_of(x, width, PERIOD_S)[inner] == pytest.approx(3.0)


@pytest.mark.parametrize("width", [1, 3, 5])
def test_a_rate_is_the_filter_s_of_the_true_one(width: int) -> None:
    """Of a sine the two boxcars leave (sin(D a) / (D sin a))^2, a half of its phase per row."""
    w = 2 * np.pi / 40
    x = np.sin(w * np.arange(400))
    gain = (np.sin(width * w / 2) / (width * np.sin(w / 2))) ** 2
    inner = slice(30, -30)
    bend = acceleration_of(x, width, 1.0)[inner]
    assert bend == pytest.approx(-gain * (2 * np.sin(w / 2)) ** 2 * x[inner], abs=1e-9)
    if width > 1:
        slope = rate_of(x, width, 1.0)[inner]
        assert slope == pytest.approx(gain * w * np.cos(w * np.arange(400))[inner], rel=0.01, abs=1e-3)


def test_rows_near_ends_starts_and_gaps_are_not_analysed() -> None:
    f = build_frame([run(200), run(200, slice(100, 110))])
    m = motion_of(f, 3)
    assert isinstance(f, Frame) and (m.width, m.turn, m.unit) == (3, 2 * np.pi, "N m")
    assert m.cell_s == pytest.approx(0.03) and m.rows[:3].tolist() == [1, 4, 7] and m.dynamic
    used = np.flatnonzero(m.ok)
    assert used.tolist() == [*range(10, 197), *range(210, 297), *range(320, 397)]
    assert np.flatnonzero(m.starts).tolist() == [200]
    assert np.flatnonzero(m.fresh).tolist() == [0, 200, 310]
    assert m.speed[5:190] == pytest.approx(0.1) and m.direction[5:190] == pytest.approx(1.0)
    assert m.since[150] == pytest.approx(0.15)


def test_rows_that_the_motors_carried_on_say_nothing_of_accelerations() -> None:
    unseen = np.where((np.arange(200) >= 80) & (np.arange(200) < 90), 1.0, 0.0)
    m = motion_of(build_frame([run(200, unseen=unseen)]), 3)
    assert np.flatnonzero(~m.ok[10:197]).tolist() == list(range(67, 83))
    assert np.flatnonzero(m.fresh).tolist() == [0]


def test_stages_of_a_motion_have_periods_in_radians() -> None:
    m = motion_of(build_frame([run()]), 3)
    train = m.frame.train
    assert m.rig.columns["position"].unit == "rad" and m.rig.runs == {"origin": "shared"}
    names = [name for name, kind in train.kinds.items() if kind not in ("axis", "sensor")]
    assert [g.name for g in m.rig.stages] == names and names
    for g in m.rig.stages:
        assert g.period == pytest.approx(2 * np.pi / train.orders[g.name])
        assert g.kind == ("gear_eccentricity" if g.name in train.shafts else train.kinds[g.name])
