"""Noise floors: repeats, a column's own noise, the position's through the inertia, steps of two sensors."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

from calibration.balances import floors
from calibration.balances.filters import Filter
from calibration.balances.floors import floor_of, passed, resolved_rows, sensors_floor
from calibration.balances.repeats import repeat_lag
from calibration.inputs.declaration import Response
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 12_000
FORCE = Response("force", "N")


def white(size: float, seed: int = 1, rows: int = ROWS) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(rows)


def sine(period: float = 400.0, rows: int = ROWS) -> np.ndarray:
    return np.asarray(np.sin(2 * np.pi * np.arange(rows) / period))


def scene(x: np.ndarray, noise: float = 0.0, **more: Any) -> Any:
    """A force of 1 N and white noise; `noise` of the position."""
    more.setdefault("columns", {"force": 1.0 + white(0.1, rows=len(x))})
    more.setdefault("y", more["columns"].get("force", np.zeros(len(x))))
    made = drive(x, response=more.pop("response", FORCE), base=more.pop("base", np.ones((len(x), 1))), **more)
    made.view.__dict__["noise"] = noise
    return made


def test_repeats_of_the_motion_tell_the_floor_behind_the_declared_terms() -> None:
    """Half of the mean square by which repeats differ."""
    s = scene(sine())
    lag = s.problem.y[400:] - s.problem.y[:-400]
    size, source = floor_of(s.view, s.problem)
    assert size == pytest.approx(np.sqrt(np.mean(lag**2) / 2)) == pytest.approx(0.1, rel=0.03)
    assert source == "repeats of the motion every 4 s"


def test_strokes_tell_it_where_no_accelerations_are_held() -> None:
    x = back_and_forth(12, 1000)
    s = scene(x, dynamic=False)
    size, source = floor_of(s.view, s.problem)
    assert size == pytest.approx(0.1 * np.sqrt(1.0), rel=0.25)
    assert source == "strokes that are made again, place by place"
    s.view.dynamic = True
    assert floor_of(s.view, s.problem)[1] == "repeats of the motion every 20 s"


def test_without_repeats_the_columns_tell_it_or_nothing_does() -> None:
    straight = np.linspace(0.0, 1.0, ROWS)
    s = scene(straight)
    size, source = floor_of(s.view, s.problem)
    assert size == pytest.approx(0.1, rel=0.05)
    assert source == "the columns' noise from row to row, and travel that the position does not resolve"
    s.problem.channel, s.problem.floor = "E", 0.25
    assert floor_of(s.view, s.problem) == (0.25, "the columns' noise from row to row")
    s.problem.floor = 0.0
    nothing = "the motion does not repeat itself, and the columns' noise cannot be estimated"
    assert floor_of(s.view, s.problem) == (None, nothing)


@pytest.mark.parametrize(("step", "told"), [(1, True), (4, True), (9, True), (7, True), (21, False)])
def test_a_repeat_is_one_of_fitted_rows(step: int, told: bool) -> None:
    """Of 1000 rows one is left by nines; six by sevens, a small part of fifty steps; and 13 by 21."""
    s = scene(sine(1000, 10_000))
    assert repeat_lag(s.view) == 1000
    s.view.rows = np.arange(0, 10_000, step)
    p = s.problem
    p.y, p.base, p.valid, p.held = (z[::step] for z in (p.y, p.base, p.valid, p.held))
    p.session = p.session[::step]
    assert floor_of(s.view, p)[1].startswith("repeats") == told


def test_repeats_agree_in_place_and_are_fifty_rows() -> None:
    s = scene(sine(rows=1000))
    v, p = s.view, s.problem
    e = p.y
    assert floors._by_lag(v, p, e, 400) is not None
    assert floors._by_lag(v, p, e, 401) is None  # 0.016 of it elsewhere
    assert floors._by_lag(v, p, e, 0) is None and floors._by_lag(v, p, e, 1000) is None
    some = np.where(np.arange(1000) < 450, e, np.nan)
    assert floors._by_lag(v, p, some, 400) is not None
    assert floors._by_lag(v, p, np.where(np.arange(1000) < 449, e, np.nan), 400) is None
    p.session = np.arange(1000) // 500
    again = floors._by_lag(v, p, e, 400)
    rows = np.r_[0:100, 500:600]
    assert again == pytest.approx(np.sqrt(np.mean((e[rows + 400] - e[rows]) ** 2) / 2))


def test_a_column_s_noise_is_what_the_filter_leaves_of_it() -> None:
    """The median over files; a column that is read every fourth row knows four times less."""
    x = np.linspace(0.0, 1.0, ROWS)
    files = np.repeat([0, 1, 2], ROWS // 3)
    noise = white(1.0) * np.array([0.1, 0.2, 5.0])[files]
    v = scene(x, files=files).view
    assert passed(v, noise) == pytest.approx(0.2, rel=0.06)
    v.filter = Filter(4.0)
    left = np.sqrt(1 / (2 * np.sqrt(np.pi) * 4))
    assert passed(v, noise) == pytest.approx(0.2 * left, rel=0.06)
    v.seldom["force"] = 4
    held = np.interp(np.arange(ROWS), np.arange(0, ROWS, 4), noise[::4])
    assert passed(v, held) == pytest.approx(0.2 * left * 2, rel=0.1)
    v.seldom["force"] = 100
    assert passed(v, np.tile(noise[::100], 100)) is None  # of forty readings a file
    assert passed(scene(x[:150]).view, x[:150]) is None


def test_a_loop_s_answer_to_the_position_s_steps_is_no_noise() -> None:
    shaken = white(1.0)
    v = scene(shaken).view
    assert passed(v, 3 * shaken + white(0.05, 2), shaken) == pytest.approx(0.05, rel=0.1)
    assert passed(v, 3 * shaken) == pytest.approx(3.0, rel=0.05)


def test_of_an_acceleration_the_floor_is_its_column_s_or_the_position_s_bend() -> None:
    given = Response("acceleration", "m/s2", gain=-2.0)
    x = np.linspace(0.0, 1.0, ROWS)
    s = scene(x, 1e-4, response=given, columns={"acceleration": white(0.3)})
    assert sensors_floor(s.view, s.problem) == pytest.approx(0.6, rel=0.05)
    del s.view.columns["acceleration"]
    s.view.filter = Filter(3.0)
    bent = np.sqrt(3 / (8 * np.sqrt(np.pi)) / 3**5)
    assert sensors_floor(s.view, s.problem) == pytest.approx(2 * 1e-4 * bent / PERIOD_S**2)
    assert resolved_rows(s.view, s.problem) is None


def test_a_force_s_floor_holds_the_position_through_the_inertia() -> None:
    x = np.linspace(0.0, 1.0, ROWS)
    a = white(1.0, 5)
    s = scene(x, 1e-4, base=a[:, None], y=-3 * a, filter=Filter(3.0), rates=6.0)
    s.problem.base_labels = [("inertia", "kg")]
    own = 0.1 * np.sqrt(1 / (2 * np.sqrt(np.pi) * 3))
    bent = 3 * 1e-4 * np.sqrt(3 / (8 * np.sqrt(np.pi)) / 6**5) / PERIOD_S**2
    assert sensors_floor(s.view, s.problem) == pytest.approx(np.hypot(own, bent), rel=0.03)
    s.view.rates = 0.0
    bent = 3 * 1e-4 * np.sqrt(3 / (8 * np.sqrt(np.pi)) / 3**5) / PERIOD_S**2
    assert sensors_floor(s.view, s.problem) == pytest.approx(np.hypot(own, bent), rel=0.03)


def test_steps_of_a_force_are_its_noise_at_least_unless_it_is_divided() -> None:
    x = np.linspace(0.0, 1.0, ROWS)
    s = scene(x, response=Response("force", "N", gain=-2.0), columns={"force": np.ones(ROWS)})
    s.view.quanta["force"] = 0.5
    s.view.filter = Filter(3.0)
    left = np.sqrt(1 / (2 * np.sqrt(np.pi) * 3))
    assert sensors_floor(s.view, s.problem) == pytest.approx(2 * 0.5 / np.sqrt(12) * left)
    divided = Response("force", "N", divide_by="load")
    s = scene(x, response=divided, columns={"force": np.ones(ROWS), "load": np.ones(ROWS)})
    s.view.quanta["force"] = 0.5
    assert sensors_floor(s.view, s.problem) == 0.0


def turning(coulomb: float = 2.0, noise: float = 0.05, **more: Any) -> Any:
    """Strokes of 500 rows over a unit; friction is no term of the base, which is noise."""
    x = back_and_forth(4)
    way = np.sign(np.gradient(x))
    base, own = np.column_stack([way, white(1.0, 7, 2000)]), white(0.1, rows=len(x))
    s = scene(x, noise, y=coulomb * way + own, base=base, dynamic=True, columns={"force": own}, **more)
    s.problem.base_labels = [("coulomb", "N"), ("other", "N")]
    return s


def test_friction_after_a_reversal_is_open_as_far_as_the_position_is() -> None:
    """Twice Coulomb's times the root of the chance that noise of two places hides the way."""
    s = turning()
    v, p = s.view, s.problem
    coulomb = p.plain_fit(p.train)[0]["coulomb"]
    column = 2 * coulomb * np.sqrt(norm.cdf(-np.abs(v.since) / (np.sqrt(2) * 0.05)))
    left = column - p.base @ np.linalg.lstsq(p.base, column, rcond=None)[0]
    own = passed(v, v.columns["force"], v.x)
    assert own is not None
    assert sensors_floor(v, p) == pytest.approx(np.hypot(own, np.sqrt(np.mean(left**2))), rel=1e-3)
    found = resolved_rows(v, p)
    assert found is not None and found[1] == pytest.approx(own)
    assert np.array_equal(found[0], np.abs(left) < own) and 0.3 < found[0].mean() < 0.99


def test_without_friction_noise_or_accelerations_no_reversal_is_open() -> None:
    for s in (turning(coulomb=-2.0), turning(noise=0.0), turning()):
        if s.view.noise > 0 and s.problem.y[5] > 0:
            assert resolved_rows(s.view, s.problem) is not None
            s.view.dynamic = False
        assert resolved_rows(s.view, s.problem) is None
        own = passed(s.view, s.view.columns["force"], s.view.x)
        assert sensors_floor(s.view, s.problem) == pytest.approx(own)
    s = turning()
    s.problem.valid[:] = False
    s.problem.held[:] = False
    assert floors._of_force(s.view, s.problem)[1] is None


def test_two_sensors_have_the_noise_of_both() -> None:
    x = sine(1300.0)
    given = Response("position2", "m", gain=-3.0, ratio=2.0)
    s = scene(x, 0.01, response=given, columns={"position2": x + white(0.02)})
    assert sensors_floor(s.view, s.problem) == pytest.approx(np.hypot(3 * 0.02, 2 * 0.01), rel=0.03)
    s.view.filter = Filter(4.0)
    left = np.sqrt(1 / (2 * np.sqrt(np.pi) * 4))
    assert sensors_floor(s.view, s.problem) == pytest.approx(left * np.hypot(0.06, 0.02), rel=0.03)
    del s.view.columns["position2"]
    assert sensors_floor(s.view, s.problem) is None


def test_coarse_steps_beat_through_the_filter() -> None:
    """A slow motion stays on a step for longer than the filter: a uniform error of both is left, nearly."""
    x = np.linspace(0.0, 1.0, ROWS)
    given = Response("position2", "m", ratio=1.0)
    s = scene(x, 0.0, response=given, columns={"position2": x}, filter=Filter(4.0))
    s.view.quanta.update(position=0.1)
    assert floors._of_two(s.view) == pytest.approx(0.1 / np.sqrt(12), rel=0.06)
    s.view.quanta = {"position2": 0.1}
    one = floors._of_two(s.view)
    assert one is not None and one == pytest.approx(0.1 / np.sqrt(12), rel=0.2)
    s.view.quanta = {"position": 0.1, "position2": 0.1}
    # zeros 0.8, 0.4, 0.2, 0.6 of a step apart: a square wave of a step d has the variance d (1 - d)
    expected = 0.1 * np.sqrt(np.mean([d * (1 - d) for d in (0.8, 0.4, 0.2, 0.6)]))
    assert floors._of_two(s.view) == pytest.approx(expected, rel=0.06)


def test_a_sensor_rounds_from_its_own_zero() -> None:
    path = np.array([0.0, 0.1, 0.19, 0.26, 1.0])
    at = path / 0.5 + 0.1
    assert floors._rounded(path, 0.5, 0.1) == pytest.approx(0.5 * (np.round(at) - at))
    assert not floors._rounded(path, None, 0.1).any() and len(floors._rounded(path, None, 0.1)) == 5
