"""The records of a drive on one grid: gaps, filters, rates, directions and runs."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from calibration.balances import view as made
from calibration.balances.filters import Filter
from calibration.balances.view import acceleration, fade, least_travel, view_of
from calibration.balances.width import told_by_noise
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Response, Rig, Stage
from calibration.inputs.run import Run
from calibration.statistics.thresholds import SURE_Z
from tests.calibration.names.made import drive

PERIOD_S = 0.01
FORCE, SENSOR = Response("force", "N"), Response("position2", "m")


def rig(response: Response = FORCE, **more: Any) -> Rig:
    given = {"estimate": ("inertia", "viscous", "coulomb"), "stages": (), **more}
    return Rig("made", Path("made.yaml"), {"position": Column("m")}, (response,), **given)


def record(rows: int = 3000, name: str = "a.csv", drop: slice | None = None, **more: Any) -> Run:
    """A sine over 5 s with little noise, unless columns say more; without the rows `drop`."""
    t = PERIOD_S * np.arange(rows)
    x = np.sin(2 * np.pi * t / 5) + 1e-7 * np.random.default_rng(1).standard_normal(rows)
    fields = {k: more.pop(k) for k in ("start_s", "in_order", "logged") if k in more}
    columns = {"t": t, "position": x, "force": 0 * t, "position2": x, **more}
    keep = np.delete(np.arange(rows), drop) if drop else np.arange(rows)
    columns = {k: v[keep] for k, v in columns.items()}
    return Run(name=name, path=Path(name), session=name, columns=columns, period_s=PERIOD_S, **fields)


def test_a_record_without_three_rows_in_a_line_is_no_record() -> None:
    with pytest.raises(CalibrationInputError, match="no three rows follow each other in time"):
        view_of([record(2)], rig(), FORCE)


def test_records_stand_one_after_the_other_on_one_clock() -> None:
    v = view_of([record(1000, start_s=100.0), record(2000, "b.csv", start_s=500.0)], rig(), FORCE)
    assert np.bincount(v.file).tolist() == [1000, 2000] and np.array_equal(v.run, v.file)
    assert v.t[[0, 999, 1000]] == pytest.approx([0.0, 9.99, 0.0])
    assert v.clock[[0, 999, 1000]] == pytest.approx([100.0, 109.99, 500.0])
    assert v.segment[0] == 1 and np.flatnonzero(np.diff(v.segment)).tolist() == [999]
    assert set(v.columns) == {"position", "force", "position2"}
    assert v.period_s == pytest.approx(PERIOD_S) and v.dynamic and v.turn is None and not v.in_order
    assert view_of([record()], rig(turn=2.0), FORCE).turn == 2.0


@pytest.mark.parametrize(
    ("flags", "told"), [((True,), False), ((True, False), True), ((False, False), False)]
)
def test_the_order_of_several_files_may_be_all_that_is_known(flags: tuple[bool, ...], told: bool) -> None:
    records = [record(500, f"{k}.csv", in_order=flag) for k, flag in enumerate(flags)]
    assert view_of(records, rig(), FORCE).in_order == told


@pytest.mark.parametrize(
    ("response", "estimate", "dynamic"),
    [
        (FORCE, ("inertia",), True), (FORCE, ("coulomb",), False), (SENSOR, ("inertia",), False),
        (Response("acceleration", "m/s2"), ("coulomb",), True),
    ],
)  # fmt: skip
def test_a_balance_holds_accelerations_where_an_inertia_is_asked_for(
    response: Response, estimate: tuple[str, ...], dynamic: bool
) -> None:
    v = view_of([record()], rig(response, estimate=estimate), response)
    assert v.dynamic == dynamic
    width = told_by_noise(v.x, v.file, v.noise)
    assert v.filter.sigma == (pytest.approx(width) if dynamic else v.filter.sigma)
    assert v.rates == (pytest.approx(width) if dynamic else 0.0)
    known = rig(response, estimate=("coulomb",), constants={"inertia": 2.0})
    assert view_of([record()], known, response).dynamic == (dynamic or response is FORCE)


def test_a_rig_file_may_say_the_filter_of_five_deviations() -> None:
    v = view_of([record()], rig(smooth_s=0.3), FORCE)
    assert v.sigma == pytest.approx(0.3 / 5 / PERIOD_S) == v.rates
    quick = Stage("worm", 0.05, None, 1, None)
    v = view_of([record()], rig(smooth_s=0.3, stages=(quick,)), FORCE)
    assert v.sigma == 2.0 and v.rates == pytest.approx(6.0) and v.wide == v.rates


def test_steps_and_readings_of_columns_are_those_that_were_logged() -> None:
    t = PERIOD_S * np.arange(3000)
    steps = np.round(np.sin(2 * np.pi * t / 5) / 0.01) * 0.01
    v = view_of([record(position2=steps)], rig(), FORCE)
    assert v.quanta["position2"] == pytest.approx(0.01) and "force" not in v.quanta
    assert v.seldom == {}
    for rows, told in ((2000, {}), (1500, {"force": 2}), (600, {"force": 5})):
        v = view_of([record(logged={"force": np.arange(float(rows))})], rig(), FORCE)
        assert v.seldom == told


def test_rows_in_a_gap_and_in_long_stretches_without_numbers_are_not_ok() -> None:
    force = np.ones(400)
    force[100:103] = np.nan
    force[200:204] = np.nan
    run = record(400, drop=slice(300, 310), force=force, run=np.repeat([1.0, 2.0], 200))
    found = made._regular(run, PERIOD_S)
    assert len(found["t"]) == 400 and found["t"][-1] == pytest.approx(3.99)
    assert np.flatnonzero(found["gap"]).tolist() == list(range(300, 310))
    assert np.flatnonzero(found["ok"] == 0).tolist() == [200, 201, 202, 203]
    assert np.isfinite(found["force"]).all() and set(found["run"]) == {1.0, 2.0}
    assert found["position"][305] == pytest.approx(
        (run.columns["position"][299] + run.columns["position"][300]) * 0.5, abs=0.01
    )
    # two missing rows make no gap: 2.5 periods are the least
    assert not made._regular(record(400, drop=slice(300, 301)), PERIOD_S)["gap"].any()
    assert made._regular(record(400, drop=slice(300, 302)), PERIOD_S)["gap"].sum() == 2


def test_short_gaps_are_filtered_over() -> None:
    gap = np.zeros(40, dtype=bool)
    gap[5:8] = gap[20:24] = True
    assert np.flatnonzero(made._filtered_over(gap, 4.0) & gap).tolist() == [5, 6, 7]
    assert not (made._filtered_over(gap, 3.0) & gap).any()


def test_a_balance_without_accelerations_goes_over_gaps_in_which_little_moves() -> None:
    x = np.concatenate([0.01 * np.arange(100.0), np.full(100, 0.99), 2 + 0.01 * np.arange(100.0)])
    gap = np.zeros(300, dtype=bool)
    gap[120:150] = gap[195:200] = True
    gap[240:260] = True
    stood = made._stood_over(x, gap, rig())
    assert stood[120:150].all() and not stood[195:200].any() and not stood[240:260].any()
    worm = Stage("worm", 4.0, None, 5, None)  # a quarter of 0.8 units are 0.2
    stood = made._stood_over(x, gap, rig(stages=(worm, Stage("axis", 10.0, None, 1, None))))
    assert stood[240:260].sum() == 0 and stood[120:150].all()
    gap[240:260] = False
    gap[240:258] = True  # from row 239 to 258 it goes 0.19
    assert made._stood_over(x, gap, rig(stages=(worm,)))[240:258].all()
    assert not made._stood_over(x, np.zeros(300, dtype=bool), rig()).any()


def test_rates_and_second_differences_stay_within_segments() -> None:
    t = PERIOD_S * np.arange(200)
    x = np.where(np.arange(200) < 100, 3 * t**2, 7 - 2 * t)
    v = drive(x, segment=np.repeat([0, 1], 100)).view
    assert v.rate(x)[1:99] == pytest.approx(6 * t[1:99]) and v.rate(x)[100:] == pytest.approx(-2.0)
    second = v.second(x)
    assert second[1:99] == pytest.approx(6.0) and second[100:] == pytest.approx(0.0, abs=1e-9)
    assert second[0] == second[99] == 0.0
    short = drive(x[:102], segment=np.repeat([0, 1], [100, 2])).view
    assert not short.rate(x[:102])[100:].any()


def test_a_late_column_is_moved_forward_within_its_segment() -> None:
    x = np.arange(20.0)
    v = drive(x, segment=np.repeat([0, 1], 10)).view
    assert v.delayed(x, 0.0) is x
    assert v.delayed(x, 0.015)[[0, 5, 9, 10]] == pytest.approx([1.5, 6.5, 9.0, 11.5])
    assert v.delayed(x, -0.015)[[0, 5, 10, 15]] == pytest.approx([0.0, 3.5, 10.0, 13.5])


def test_rates_are_smoothed_where_the_filter_is_narrower() -> None:
    x = np.random.default_rng(1).standard_normal(300)
    narrow, wide = drive(x, filter=Filter(2.0), rates=4.0).view, drive(x, filter=Filter(4.0), rates=4.0).view
    assert narrow.smoothed(x) == pytest.approx(gaussian_filter1d(x, 4.0, mode="nearest"))
    assert wide.smoothed(x) is x and (narrow.wide, wide.wide) == (4.0, 4.0)
    assert drive(x, filter=Filter(4.0)).view.wide == 4.0


def test_what_a_view_says_of_its_motion() -> None:
    x = np.cumsum(np.linspace(0, 2, 1001)) * PERIOD_S
    v = drive(x, speed=np.linspace(-2, 2, 1001)).view
    assert v.top == pytest.approx(2 * 0.95, rel=1e-2) and v.step == 1
    v.rows = np.arange(0, 1001, 7)
    assert v.step == 7
    v.rows = v.rows[:1]
    assert v.step == 1
    v.ok = np.zeros(1001, dtype=bool)
    assert v.top == 0.0
    assert v.resolved == pytest.approx(6 * np.sqrt(12) * v.noise)
    assert least_travel(np.linspace(0, 10.0, 1001)) == pytest.approx(1e-4 * 9.8)
    zigzag = np.where(np.arange(1001) % 2, 0.25, -0.25)
    assert least_travel(zigzag) == pytest.approx(12 * 1.0)
    fade(v, 0.1)
    assert v.standstill == 0.0
    v.ok[:] = True
    fade(v, 0.1)
    assert v.standstill == pytest.approx(0.1 * v.top)
    assert v.direction == pytest.approx(np.tanh(v.speed / v.standstill))


def test_an_acceleration_is_as_smooth_as_the_noise_asks_for() -> None:
    v = view_of([record()], rig(), FORCE)
    assert acceleration(v)[300:-300] == pytest.approx(-((2 * np.pi / 5) ** 2) * v.x[300:-300], abs=0.03)


def test_a_driven_axis_has_directions_that_fade_and_stands_when_it_is_slow() -> None:
    v = view_of([record(rows=6000)], rig(), FORCE)
    top = 2 * np.pi / 5 * np.sin(0.95 * np.pi / 2)
    assert v.top == pytest.approx(top, rel=0.01)
    assert v.slow == pytest.approx(0.01 * v.top, rel=1e-3)
    assert v.standstill == pytest.approx(0.005 * v.top, rel=1e-3)
    inner = slice(300, -300)
    assert v.speed[inner] == pytest.approx(2 * np.pi / 5 * np.cos(2 * np.pi * v.t[inner] / 5), abs=0.01)
    sensors = view_of([record(rows=6000)], rig(SENSOR), SENSOR)
    assert sensors.slow == 0.0 and set(np.sign(sensors.direction[inner])) == {-1.0, 1.0}
    assert np.abs(v.since).max() == pytest.approx(2.0, abs=0.01)


def test_a_noisy_position_does_not_tell_a_slow_motion() -> None:
    """SURE_Z times the smoothed noise of a rate: z noise / (dt sqrt(4 sqrt(pi)) width^1.5)."""
    rng = np.random.default_rng(2)
    x = 1e-3 * np.sin(2 * np.pi * PERIOD_S * np.arange(6000) / 5) + 1e-4 * rng.standard_normal(6000)
    v = view_of([record(6000, position=x)], rig(smooth_s=0.4), FORCE)
    width = max(v.rates, told_by_noise(x, v.file, v.noise)) / 2
    expected = SURE_Z * v.noise / PERIOD_S / np.sqrt(4 * np.sqrt(np.pi)) / width**1.5
    assert v.slow == pytest.approx(expected)


def test_runs_are_files_or_turning_points() -> None:
    plain = view_of([record(), record(500, "b.csv")], rig(), FORCE)
    assert np.bincount(plain.run).tolist() == [3000, 500]
    turning = view_of([record()], rig(runs={"by": "turning_points", "minimum_travel": 0.5}), FORCE)
    edges = np.flatnonzero(np.diff(turning.run)) * PERIOD_S
    assert edges == pytest.approx(np.arange(1.25, 30.0, 2.5), abs=0.05)
    none = view_of([record()], rig(runs={"by": "turning_points", "minimum_travel": 2.5}), FORCE)
    assert not none.run.any()
