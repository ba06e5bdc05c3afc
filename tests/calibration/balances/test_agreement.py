"""A measured velocity against the position's rate: how late, of what scale, how well they agree."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances import agreement
from calibration.balances.agreement import Agreement, velocity_against_position
from calibration.balances.filters import Filter
from calibration.inputs.declaration import Column
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 6000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
PARTS = ((1.0, 2.0), (0.4, 3.7), (0.15, 11.0))  # amplitude, rad/s
HELD = T > 45


def motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = sum(a * np.sin(w * t) for a, w in PARTS)
    return np.asarray(x), np.asarray(sum(a * w * np.cos(w * t) for a, w in PARTS))


def compared(
    late_s: float = 0.0, scale: float = 1.0, noise: float = 1e-4, offset: float = 0.0, **more: Any
) -> Agreement:
    found = told(late_s, scale, noise, offset, **more)
    assert found is not None
    return found


def told(
    late_s: float = 0.0, scale: float = 1.0, noise: float = 1e-4, offset: float = 0.0, **more: Any
) -> Agreement | None:
    """The velocity (m/s) is late, times a scale, with white noise and an offset."""
    rng = np.random.default_rng(1)
    shaken = more.pop("shaken", 1e-9)
    x = motion(T)[0] + shaken * rng.standard_normal(ROWS)
    v = offset + scale * motion(T - late_s)[1] + noise * rng.standard_normal(ROWS)
    given = drive(x, columns={"velocity": v}, filter=Filter(0.0), dynamic=True, **more).view
    given.rig.columns["velocity"] = Column("m/s")
    given.__dict__["noise"] = shaken
    return velocity_against_position(given, HELD)


@pytest.mark.parametrize("late_s", [0.02, -0.013, 0.1])
def test_a_late_velocity_is_told_with_its_delay(late_s: float) -> None:
    found = compared(late_s)
    assert found.delay_s == pytest.approx(late_s, abs=1e-4) and found.late
    assert (found.channel, found.unit, found.scaled) == ("velocity", "m/s", "")
    # late by d it errs by d times the acceleration, at first order
    bend = np.sqrt(sum((a * w**2) ** 2 / 2 for a, w in PARTS))
    assert found.before == pytest.approx(abs(late_s) * bend, rel=0.15)
    assert found.after < 0.02 * found.before
    assert found.size == pytest.approx(np.sqrt(sum((a * w) ** 2 / 2 for a, w in PARTS)), rel=0.05)


def test_a_velocity_on_time_is_not_late() -> None:
    found = compared(offset=3.0)
    assert abs(found.delay_s) < 2e-5 and not found.late and found.scaled == ""
    assert found.before == pytest.approx(found.after, rel=0.05)


@pytest.mark.parametrize("late_s", [0.3, -0.3])
def test_beyond_twenty_rows_no_delay_is_looked_for(late_s: float) -> None:
    found = compared(late_s)
    assert found.delay_s == pytest.approx(np.sign(late_s) * 0.2) and not found.late


def test_a_delay_within_a_tenth_of_a_row_is_the_reading_s_own() -> None:
    assert not compared(0.0009, noise=0.0).late and compared(0.0012, noise=0.0).late


def test_a_delay_that_noise_hides_is_not_told() -> None:
    assert compared(0.02, noise=0.05).late and not compared(0.002, noise=2.0).late


@pytest.mark.parametrize("scale", [1.05, -1.0, 0.5, 57.3])
def test_another_scale_or_sign_is_told(scale: float) -> None:
    found = compared(0.02, scale=scale)
    assert found.scale == pytest.approx(scale, rel=2e-3)
    assert found.scaled == (
        f"velocity reads {found.scale:.4g} times the position's rate: its unit, scale or sign"
    )
    assert found.delay_s == pytest.approx(0.02, abs=2e-4) and found.late == (abs(scale) > 0.3)
    assert not compared(0.02, scale=0.25).late


def test_a_scale_over_a_noisy_rate_is_not_told() -> None:
    """A rate whose noise is more than a fifth of it makes every slope over it too small."""
    assert compared(scale=1.05, shaken=0.004).scale == pytest.approx(1.05, rel=0.01)
    assert compared(scale=1.05, shaken=0.05).scale == 1.0


def test_few_rows_a_constant_velocity_and_none_say_nothing() -> None:
    x, v = motion(T)
    view = drive(x, columns={"velocity": v}).view
    view.rig.columns["velocity"] = Column("m/s")
    assert velocity_against_position(view, HELD) is not None
    view.columns["velocity"] = 0 * v
    assert velocity_against_position(view, HELD) is None
    del view.columns["velocity"]
    assert velocity_against_position(view, HELD) is None
    view.columns["velocity"] = v
    view.ok = np.arange(ROWS) < 199
    assert velocity_against_position(view, HELD) is None
    view.ok = np.arange(ROWS) < 600
    assert velocity_against_position(view, HELD) is not None  # every second row is used
    view.ok = np.arange(ROWS) < 390
    assert velocity_against_position(view, HELD) is None


def test_the_floor_is_the_noise_of_both_behind_the_smoothing() -> None:
    """Two deviations of rows: of a mean over [1, 4, 1] / 6, and of a central difference."""
    found = compared(noise=0.3, shaken=0.004)
    at = np.arange(-60.0, 61.0)
    bell = np.exp(-(at**2) / 8) / np.sqrt(8 * np.pi)
    mean = np.linalg.norm(np.convolve(bell, np.array([1, 4, 1]) / 6))
    slope = np.linalg.norm(np.convolve(bell, np.array([1, 0, -1]) / 2))
    expected = np.hypot(0.3 * mean, 0.004 / PERIOD_S * slope)
    assert found.floor == pytest.approx(expected, rel=0.05)
    assert found.after == pytest.approx(expected, rel=0.1)
    assert found.left == pytest.approx(1.0, rel=0.1)


def test_a_mean_over_two_rows_is_simpson_s_rule() -> None:
    x = np.array([0.0, 0.0, 6.0, 0.0, 0.0, 12.0])
    assert agreement._over_two_rows(x) == pytest.approx([0.0, 1.0, 4.0, 1.0, 2.0, 10.0])


@pytest.mark.parametrize("sigma", [2.0, 4.0])
def test_white_noise_behind_a_gaussian_is_known(sigma: float) -> None:
    plain = agreement._passed(lambda x: x, sigma)
    assert plain == pytest.approx(np.sqrt(1 / (2 * np.sqrt(np.pi) * sigma)), rel=1e-3)
    slope = agreement._passed(np.gradient, sigma)
    assert slope == pytest.approx(np.sqrt(1 / (4 * np.sqrt(np.pi) * sigma**3)), rel=0.1)


def test_single_files_tell_the_error_of_a_delay() -> None:
    rng = np.random.default_rng(1)
    x = np.column_stack([rng.standard_normal(900), np.ones(900), rng.standard_normal(900)])
    files = np.repeat([0, 1, 2], 300)
    delays = np.array([1.0, 2.0, 4.0])
    y = x[:, 0] + 3 + delays[files] * x[:, 2]
    every = np.ones(900, dtype=bool)
    spread = np.sqrt(((1 - 7 / 3) ** 2 + (2 - 7 / 3) ** 2 + (4 - 7 / 3) ** 2) / 2)
    assert agreement._scatter(files, x, y, every) == pytest.approx(spread / np.sqrt(3))
    assert agreement._scatter(files, x, y, files < 2) == 0.0
    assert agreement._scatter(files, x, y, np.arange(900) < 800) == 0.0  # 200 of the third
    assert agreement._scatter(files, x, y, np.arange(900) < 801) > 0.0


def test_the_velocity_s_sum_over_the_way_between_reversals_is_its_scale() -> None:
    x, v = motion(T)
    for scale in (1.0, -0.7):
        view = drive(x, columns={"velocity": scale * v}).view
        assert agreement._of_the_travel(view) == pytest.approx(scale, rel=1e-3)
        view.segment = np.repeat([0, 1], ROWS // 2)
        assert agreement._of_the_travel(view) == pytest.approx(scale, rel=1e-3)
    still = drive(0 * T, columns={"velocity": v}).view
    assert agreement._of_the_travel(still) == 0.0


PLAIN = Agreement("velocity", "m/s", 0.02, 1e-3, 4.0, 3.0, 2.0, True, size=400.0)


def test_what_an_agreement_says() -> None:
    assert (PLAIN.left, replace(PLAIN, late=False).left) == (1.5, 2.0)
    assert replace(PLAIN, floor=0.0).left == 0.0 == replace(PLAIN, floor=float("nan")).left
    assert replace(PLAIN, after=float("nan")).left == 0.0
    assert PLAIN.hardly and not replace(PLAIN, late=False).hardly
    assert not replace(PLAIN, size=300.0).hardly
    assert PLAIN.scaled == "" == replace(PLAIN, scale=1.009).scaled
    assert replace(PLAIN, scale=1.02).scaled.startswith("velocity reads 1.02 times")
    wide = replace(PLAIN, scale=1.02, scale_error=0.02)
    assert wide.scaled == ""
