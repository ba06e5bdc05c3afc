"""A line of a fixed frequency beside a motion that repeats itself: which multiples are the motion's."""

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.names import command_disturbance as named
from tests.calibration.names.made import PERIOD_S, drive
from tests.calibration.names.test_command_disturbance import NOISE, ROWS, T, X, scene


def frequencies(hertz: float, follows: np.ndarray, x: np.ndarray = X) -> list[float]:
    return [c.frequency or 0.0 for c in named.lines(scene(hertz, x), follows, large_first=False)]


def test_a_multiple_of_the_motion_is_left_out_where_the_declared_part_has_more_of_it() -> None:
    """2.1 Hz is the 21st of a motion that comes again after 10 s; a friction has it and those beside it."""
    t = 2 * np.pi * T
    corners = 3.0 * (np.cos(2.1 * t) + np.cos(2.2 * t) + np.cos(1.9 * t))
    assert not any(abs(f - 2.1) < 0.04 for f in frequencies(2.1, corners))
    assert any(abs(f - 2.1) < 0.04 for f in frequencies(2.1, 0.1 * corners))
    assert any(abs(f - 2.1371) < 0.04 for f in frequencies(2.1371, corners))  # between two multiples


@pytest.mark.parametrize(("period_s", "multiple", "left_out"), [
    (13.0, 49, True), (13.0, 53, False), (10.0, 49, True), (10.0, 53, True),
])  # fmt: skip
def test_a_motion_that_hardly_comes_again_has_fifty_multiples(
    period_s: float, multiple: int, left_out: bool
) -> None:
    """Less than two and a half times: later ones lie too close for a frequency between them."""
    x = np.sin(2 * np.pi * 2 / period_s * T) + 0.4 * np.cos(2 * np.pi * 5 / period_s * T)
    hertz = multiple / period_s
    corners = sum(3.0 * np.cos(2 * np.pi * (multiple + k) / period_s * T) for k in (-2, -1, 0, 1, 2))
    found = frequencies(hertz, np.asarray(corners), x)
    assert any(abs(f - hertz) < 0.04 for f in found) is not left_out


def test_a_motion_that_never_comes_again_has_no_multiples() -> None:
    corners = sum(3.0 * np.cos(2 * np.pi * f * T) for f in (1.0, 2.0, 3.0, 4.0, 5.0))
    assert any(abs(f - 3.0) < 0.02 for f in frequencies(3.0, np.asarray(corners), T**2))


@pytest.mark.parametrize(("part", "is_found"), [(0.9, True), (1.1, False)])
def test_a_wave_was_commanded_from_a_hundredth_of_the_motion_on(part: float, is_found: bool) -> None:
    """Of the rms."""
    alone = np.cos(2 * np.pi * 2.1 * T)
    moved = X + part * 0.01 * np.std(X) * np.sqrt(2) * alone
    assert any(abs(f - 2.1) < 0.04 for f in frequencies(2.1, 3.0 * alone, moved)) is is_found


def test_five_lines_are_tried() -> None:
    hertz = np.array([3.03, 4.13, 5.27, 6.31, 7.43, 8.57, 9.71])
    wave = sum((1 + k) * np.sin(2 * np.pi * f * T + k) for k, f in enumerate(hertz))
    s = drive(X, residual=np.asarray(wave) + NOISE, y=np.asarray(wave))
    found = sorted({c.frequency or 0.0 for c in named.columns(s)})
    assert len(found) == 5
    assert all(np.abs(hertz - f).min() < 0.02 for f in found)


def test_a_line_is_dimmed_by_the_filter_and_told_as_finely_as_its_rows_go_on() -> None:
    held = np.arange(ROWS) >= 2400
    s = scene(filter=Filter(2.0), held=held)
    c, square, *_ = named.columns(s)
    assert c.steps == (pytest.approx(0.1 / T[2399]),)
    f = c.fixed["frequency"][0]
    for k, pair in ((1, square.columns[:, :2]), (3, square.columns[:, 2:4])):
        dim = np.exp(-2 * (np.pi * k * f * PERIOD_S * 2.0) ** 2)
        assert np.hypot(*pair.T) == pytest.approx(dim)


def test_what_stands_alone_shakes_the_drive_unless_it_was_commanded() -> None:
    alone = 3.0 * np.cos(2 * np.pi * 2.1 * T)
    assert any(abs(f - 2.1) < 0.04 for f in frequencies(2.1, alone))
    commanded = X + 0.05 * np.cos(2 * np.pi * 2.1 * T)  # 5 % of the motion: somebody has moved it so
    assert not any(abs(f - 2.1) < 0.04 for f in frequencies(2.1, alone, commanded))


@pytest.mark.parametrize(("tones", "hertz", "joints"), [
    ((0.25, 0.75), 2.0, True), ((0.25, 0.75), 2.1371, False), ((0.25, 0.75), 2.034, False),
    ((0.3, 0.5), 2.0, False),
])  # fmt: skip
def test_a_line_on_a_multiple_may_be_another_joints(
    tones: tuple[float, float], hertz: float, joints: bool
) -> None:
    """Of a motion that comes again after 4 s, seven times; after 10 s it has hardly come again."""
    x = sum(np.sin(2 * np.pi * f * T + f) for f in tones)
    found = named.lines(scene(hertz, np.asarray(x)), np.zeros(ROWS), large_first=False)
    here = [c for c in found if abs((c.frequency or 0.0) - hertz) < 0.02]
    assert here and all(("unknown" in c.twins) is joints for c in here)


def test_a_peak_among_multiples_stands_alone_above_ten_times_its_three_neighbours() -> None:
    """On either side; beyond the ends there are none."""
    power = np.ones(12)
    power[[0, 5, 9, 11]] = [10.5, 11.0, 9.5, 10.5]
    assert np.flatnonzero(named._alone(power)).tolist() == [0, 5]  # not the last one, beside 9.5
    power[9], power[11] = 1.0, 10.0
    assert np.flatnonzero(named._alone(power)).tolist() == [0, 5]
    power[8] = 1.2
    assert np.flatnonzero(named._alone(power)).tolist() == [0]
    power[8], power[2] = 1.0, 1.2
    assert np.flatnonzero(named._alone(power)).tolist() == []


def test_the_fourth_neighbour_says_nothing() -> None:
    power = np.ones(12)
    power[[2, 6]] = 11.0
    assert np.flatnonzero(named._alone(power)).tolist() == [2, 6]


def test_powers_are_those_of_every_file_whatever_its_phase() -> None:
    """Of a sine of amplitude A over n rows: (A n / 2)^2 each."""
    files = np.repeat([0, 1], 1500)
    held = np.arange(ROWS) >= 2700
    s = scene(files=files, held=held)
    t = s.view.t
    y = np.where(files == 0, 2.0 * np.cos(2 * np.pi * 2.0 * t), 4.0 * np.sin(2 * np.pi * 2.0 * t))
    found = named._powers(s, (y, 0 * y), 1.0, 3)
    assert found.shape == (2, 3) and not found[1].any()
    rows = float((~held & (files == 1)).sum())
    assert found[0, 1] == pytest.approx(1500.0**2 + (2 * rows) ** 2, rel=1e-3)
    assert found[0, [0, 2]] == pytest.approx(0.0, abs=1e-2 * found[0, 1])
