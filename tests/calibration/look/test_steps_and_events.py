"""Jumps, slips and events in what is left: where they are, how large, and what is none."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.balances.problem import Problem
from calibration.decide.selection import Selection
from calibration.inputs.declaration import Response
from calibration.look import event, jumps, slips
from tests.calibration.names.made import drive

ROWS = 1500


def noise(size: float = 1.0, seed: int = 1, rows: int = ROWS) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(rows)


def problem(y: np.ndarray, run: np.ndarray | None = None, **more: Any) -> Problem:
    n = len(y)
    label = np.zeros(n, dtype=np.int64) if run is None else run
    given: dict[str, Any] = {
        "base": np.ones((n, 1)), "base_labels": [("offset", "arcsec")], "t": 3.0 * np.arange(n), "run": label,
        "session": label, "valid": np.ones(n, dtype=bool), "held": np.arange(n) % 300 > 250, "period_s": 3.0,
        "ar_order": 0, "block_s": 60.0, **more,
    }  # fmt: skip
    return Problem(channel="K", unit="arcsec", y=y, **given)


def test_a_step_is_told_beside_an_offset_and_a_slope() -> None:
    """Least squares over six rows on either side."""
    run = np.zeros(60, dtype=np.int64)
    x = 3.0 + 0.2 * np.arange(60) + 5.0 * (np.arange(60) >= 30)
    found = jumps._steps(x, run, 6)
    assert found[30] == pytest.approx(5.0) and found[6:20] == pytest.approx(0.0, abs=1e-9)
    assert np.isnan(found[:6]).all() and np.isnan(found[55:]).all() and np.isfinite(found[6:55]).all()
    two = jumps._steps(x, np.repeat([0, 1], 30), 6)
    assert np.isnan(two[25:36]).all() and np.isfinite(two[[24, 36]]).all()
    assert np.isnan(jumps._steps(x[:12], run[:12], 6)).all()
    gap = x.copy()
    gap[20] = np.nan
    assert np.isnan(jumps._steps(gap, run, 6)[15:26]).all()


def left(y: np.ndarray, run: np.ndarray | None = None) -> Selection:
    return Selection.of(problem(y, run))


@pytest.mark.parametrize("size", [8.0, -8.0])
def test_a_jump_is_found_at_its_row(size: float) -> None:
    y = noise() + size * (np.arange(ROWS) >= 700)
    (at,) = jumps.jumps_of(left(y), 5.0)
    assert abs(at - 700) <= 1
    assert jumps.jumps_of(left(noise()), 5.0) == []


def test_jumps_come_in_the_order_of_time_and_many_are_none() -> None:
    rows = np.arange(ROWS)
    y = noise() + 9.0 * (rows >= 300) + 20.0 * (rows >= 900)
    found = jumps.jumps_of(left(y), 5.0)
    assert len(found) == 2 and abs(found[0] - 300) <= 1 and abs(found[1] - 900) <= 1
    stairs = noise(0.1) + 9.0 * (rows // 100 * np.where(rows // 100 % 2, 1.0, -1.0))
    assert jumps.jumps_of(left(stairs), 4.0) == []  # fourteen


def test_a_wave_is_no_jump() -> None:
    wave = noise() + 30.0 * np.sin(2 * np.pi * np.arange(ROWS) / 400)
    assert jumps.jumps_of(left(wave), 5.0) == []


def test_a_step_of_a_run_goes_on_to_its_end() -> None:
    run = np.repeat([0, 1], 750)
    one, two = jumps._steps_at(problem(noise(), run), [100, 800])
    assert np.flatnonzero(one).tolist() == list(range(100, 750))
    assert np.flatnonzero(two).tolist() == list(range(800, 1500))


def test_jumps_are_told_with_size_and_time_where_they_take_a_quarter() -> None:
    y = noise() + 8.0 * (np.arange(ROWS) >= 700)
    s, (f,) = jumps.with_jumps(left(y), lambda row: f"row {row}")
    assert len(s.chosen) == 1 and f.parameters == {} and f.domain == "time"
    words = f.note.split()
    assert (
        words[0] == "jumps:"
        and float(words[1]) == pytest.approx(8.0, abs=0.3)
        and words[2:4] == ["arcsec", "at"]
    )
    assert f.share == pytest.approx(1 - (s.held.after / s.held.before) ** 2)
    assert jumps.with_jumps(left(noise()), str)[1] == []
    weak = noise() + 0.9 * (np.arange(ROWS) >= 700)
    assert jumps.with_jumps(left(weak), str)[1] == []


def test_least_absolute_deviations_hear_no_outliers() -> None:
    x = np.column_stack([np.ones(ROWS), np.arange(ROWS) / ROWS])
    y = x @ [3.0, -2.0] + noise(0.01)
    y[::5] += 50.0
    assert event._robust(x, y) == pytest.approx([3.0, -2.0], abs=0.01)


def pushed(size: float = 40.0, rows: slice = slice(400, 430), **more: Any) -> Problem:
    y = noise()
    y[rows] += size
    return problem(y, **{"held": np.arange(ROWS) >= 1200, **more})


def stretches(p: Problem, least: float = 1.0) -> list[int]:
    return np.flatnonzero(event._stretches(p, np.ones((len(p.y), 1)), least)).tolist()


def test_one_short_stretch_that_holds_most_is_an_event() -> None:
    assert stretches(pushed()) == list(range(400, 430))
    assert stretches(pushed(), 39.0) == list(range(400, 430)) and stretches(pushed(), 41.0) == []
    assert stretches(pushed(0.0)) == []
    assert stretches(pushed(rows=slice(400, 519))) and stretches(pushed(rows=slice(400, 521))) == []
    p = pushed()
    p.y[800:830] += 40.0
    assert stretches(p) == []  # it comes back
    edge = pushed(rows=slice(1190, 1215))
    assert stretches(edge) == list(range(1190, 1215))


def test_the_usual_square_is_of_held_rows_without_the_event() -> None:
    p = pushed(rows=slice(1300, 1400))
    at = np.zeros(ROWS, dtype=bool)
    at[1300:1400] = True
    x = np.ones((ROWS, 1))
    rest = p.y[(np.arange(ROWS) >= 1200) & ~at]
    mean = p.y[:1200].mean()
    usual = (1.4826 * np.median(np.abs(rest - mean))) ** 2
    assert event._usual(p, x, at, np.zeros_like(at)) == pytest.approx(usual, rel=1e-6)
    spoiled = pushed(4000.0, slice(100, 200))
    out = np.zeros(ROWS, dtype=bool)
    out[100:200] = True
    none = np.zeros_like(out)
    assert event._usual(spoiled, x, none, out) < 2.0 < event._usual(spoiled, x, none, none)
    assert np.isnan(event._usual(p, x, np.ones_like(at), none))


def view(sigma: float = 0.0, **more: Any) -> Any:
    x = np.sin(2 * np.pi * np.arange(ROWS) / 300)
    files = np.repeat([0, 1], ROWS // 2)
    return drive(
        x, response=Response("position2", "m", ratio=2.0), files=files, filter=Filter(sigma), **more
    ).view


def test_a_slip_is_a_step_of_its_file_behind_the_filter() -> None:
    sharp = slips._step(view(), 300)
    assert np.flatnonzero(sharp).tolist() == list(range(300, 750)) and set(sharp) == {0.0, 1.0}
    soft = slips._step(view(4.0), 300)
    ideal = np.convolve(
        np.repeat([0.0, 1.0], 750), np.exp(-(np.arange(-40, 41.0) ** 2) / 32) / np.sqrt(32 * np.pi), "same"
    )
    assert soft[260:340] == pytest.approx(ideal[710:790], abs=2e-3) and not soft[750:].any()


def test_turns_are_the_first_rows_the_other_way_in_a_file() -> None:
    v = view()
    way = np.array([1.0, 1.0, 0.0, -1.0, -1.0, 1.0, 1.0, 0.0, 1.0, -1.0])
    v.rows, v.direction = np.arange(10), way
    p: Any = problem(noise(rows=10), np.repeat([0, 1], [5, 5]))
    assert slips._turns(v, p).tolist() == [3, 9]


def test_slips_are_sure_beyond_their_errors_and_half_a_count() -> None:
    v = view()
    step = slips._step(v, 300)
    y = noise(0.1) + 0.5 * step
    p = problem(y)
    s = Selection.of(p)
    assert list(slips._sure(s, p, {300: step}, v)) == [300]
    v.quanta = {"position2": 0.9}
    assert list(slips._sure(s, p, {300: step}, v)) == [300]
    v.quanta = {"position2": 1.1}
    assert slips._sure(s, p, {300: step}, v) == {}
    v.quanta = {"position": 0.45}
    assert list(slips._sure(s, p, {300: step}, v)) == [300]
    v.quanta = {"position": 0.55}
    assert slips._sure(s, p, {300: step}, v) == {} == slips._sure(s, p, {}, v)
    v.quanta = {}
    weak = problem(noise(0.1) + 0.01 * step)
    assert slips._sure(Selection.of(weak), weak, {300: step}, v) == {}


def test_every_stretch_between_slips_has_an_offset_of_its_own() -> None:
    p = problem(noise())
    steps = [slips._step(view(), 300), slips._step(view(), 900)]
    apart = slips._apart(p, steps)
    assert apart.base_labels == [("offset", "arcsec"), ("slow_offset", "arcsec"), ("slow_offset", "arcsec")]
    assert apart.fresh is not None and np.array_equal(apart.fresh, np.column_stack(steps))
    again = slips._apart(replace(p, fresh=np.ones((ROWS, 1))), steps)
    assert again.fresh is not None and again.fresh.shape == (ROWS, 3)


def test_a_slip_is_placed_where_it_leaves_least() -> None:
    v = view(2.0)
    v.rows = np.arange(0, ROWS, 5)
    rows = len(v.rows)
    y = noise(0.05, rows=rows) + slips._step(v, 303) - 2 * slips._step(v, 1111)
    s = Selection.of(problem(y, np.repeat([0, 1], rows // 2), held=np.zeros(rows, dtype=bool)))
    placed = slips._placed(s, [60, 223], v)
    one, two = placed
    assert abs(one - 303) <= 1 and abs(two - 1111) <= 1 and np.array_equal(placed[one], slips._step(v, one))


def test_the_largest_slip_is_the_finding_and_all_are_in_its_note() -> None:
    v = view()
    steps = [slips._step(v, 300), slips._step(v, 900)]
    p = slips._apart(problem(noise(0.01) + 0.5 * steps[0] - 2.0 * steps[1]), steps)
    f = slips._finding(Selection.of(p), [300, 900], v, 0.7)
    assert f.name == "roller_slip" and f.share == 0.7 and f.channel == "K"
    step = f.parameters["step"]
    assert step.value == pytest.approx(-2.0, abs=0.01) and step.low is not None and step.low < -2.0 + 0.01
    assert f.parameters["time"].value == pytest.approx(1.5)
    assert f.note == "slips: 0.5 arcsec at 3 s of file 1, -2 arcsec at 1.5 s of file 2"
