"""Wind and brushes on residuals that are made up: means over a second, kurtosis, sectors, turns."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.broadband import (
    follows_direction,
    kurtosis,
    slow_ratio,
    unexplained_volts,
    wind,
)
from calibration.decide.thresholds import FEWEST_BLOCKS
from calibration.finding import UNKNOWN, Finding
from calibration.statistics.tails import rms_interval, variance_log10
from calibration.statistics.whitening import white_noise
from tests.calibration.decide.made import PERIOD_S, problem

SECOND = 20  # rows
ROWS = 400 * SECOND
T = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(101)
LUCK = RNG.standard_normal(ROWS)
ALTERNATING = np.where(np.arange(ROWS) % 2, 1.0, -1.0)  # of mean nothing over any second
QUICK = np.full(ROWS, 0.01)  # rad/s


def torque(rate: np.ndarray = QUICK, **more: Any) -> Problem:
    p = problem(np.zeros(ROWS), np.column_stack([np.ones(ROWS), rate]))
    p.base_labels = [("offset", "N m"), ("viscous", "N m s/rad")]
    return replace(p, **more)


def test_means_over_a_second_of_a_constant_are_it_and_of_what_alternates_nothing() -> None:
    p = torque()
    every = np.ones(ROWS, dtype=bool)
    assert slow_ratio(np.full(ROWS, 3.0), p, 0.5, every) == pytest.approx(6.0)
    assert slow_ratio(3.0 * ALTERNATING, p, 0.5, every) == pytest.approx(0.0)
    two = np.where(np.arange(ROWS) // SECOND % 2, 4.0, -3.0)
    assert slow_ratio(two, p, 1.0, every) == pytest.approx(np.sqrt(12.5))
    assert slow_ratio(LUCK, p, 1.0, every) == pytest.approx(1 / np.sqrt(SECOND), rel=0.15)
    assert slow_ratio(two[:-7], replace(p, base=p.base[:-7]), 1.0, every[:-7]) == pytest.approx(
        3.54, abs=0.01
    )


def test_the_shortest_mean_is_of_two_rows() -> None:
    p = torque(period_s=1.0)
    every = np.ones(ROWS, dtype=bool)
    assert slow_ratio(ALTERNATING, p, 1.0, every) == pytest.approx(0.0)
    pairs = np.where(np.arange(ROWS) // 2 % 2, 1.0, -1.0)
    assert slow_ratio(pairs, p, 1.0, every) == pytest.approx(1.0)


@pytest.mark.parametrize(("missing", "counts"), [(1, True), (2, False)])
def test_a_mean_needs_more_than_nine_tenths_of_its_rows(missing: int, counts: bool) -> None:
    """What is missing counts as nothing, and is no part of the mean's residual."""
    rows = np.arange(ROWS) % SECOND >= missing
    ratio = slow_ratio(np.where(rows, 2.0, 1e9), torque(), 1.0, rows)
    assert (ratio == pytest.approx(2.0 * 0.95)) if counts else ratio is None


@pytest.mark.parametrize(("seconds", "told"), [(21, True), (20, False)])
def test_twenty_one_means_are_the_fewest_while_the_axis_slides(seconds: int, told: bool) -> None:
    rows = np.arange(ROWS) < seconds * SECOND
    every = np.ones(ROWS, dtype=bool)
    assert (slow_ratio(LUCK, torque(), 1.0, rows) is not None) is told
    for still in (0.0, 1e-4, -1e-4):
        rate = np.where(rows, -0.01, still)
        assert (slow_ratio(LUCK, torque(rate), 1.0, every) is not None) is told
    assert slow_ratio(LUCK, torque(), 1.0, rows, seconds) is not None
    assert slow_ratio(LUCK, torque(), 1.0, rows, seconds + 1) is None


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_kurtosis_has_no_unit_and_no_mean(scale: float) -> None:
    assert kurtosis(scale * LUCK + 7.0 * scale) == pytest.approx(3.0, abs=0.3)
    assert kurtosis(scale * ALTERNATING) == pytest.approx(1.0)
    assert kurtosis(np.zeros(10)) == 0.0


def gusts(time_s: float = 2.0, rows: int = ROWS, seed: int = 3) -> np.ndarray:
    """Gaussian, of unit deviation: half of its variance is gone after `time_s` ln 2."""
    keep = np.exp(-PERIOD_S / time_s)
    luck = np.random.default_rng(seed).standard_normal(rows)
    out = np.zeros(rows)
    for k in range(1, rows):
        out[k] = keep * out[k - 1] + np.sqrt(1 - keep**2) * luck[k]
    return np.asarray(out / np.std(out))


GUSTS = gusts()


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_a_gaussian_torque_that_goes_on_is_wind_with_its_size_and_time(scale: float) -> None:
    e = scale * (2.0 * GUSTS + 0.5 * LUCK)
    found = wind(e, torque(), 0.5 * scale)
    assert found is not None
    assert (found.name, found.channel, found.domain) == ("wind_torque", "T", "time")
    size, time = found.parameters["deviation"], found.parameters["correlation_time"]
    assert size.value == pytest.approx(2.0 * scale, rel=0.1) and size.unit == "N m"
    assert time.value == pytest.approx(2.0, rel=0.25) and time.unit == "s" and time.low is None
    p = torque()
    seconds = p.train.sum() * PERIOD_S
    cycles = seconds / (2 * np.pi * time.value)
    assert size.half == pytest.approx(1.96 * size.value / np.sqrt(2 * cycles))
    ratio = slow_ratio(e, p, 0.5 * scale, p.train)
    assert ratio is not None
    assert found.evidence == pytest.approx(variance_log10((ratio / 0.17) ** 2, seconds))
    assert found.share == pytest.approx(1 - 0.25 * scale**2 / np.mean(e[p.train] ** 2))


def test_the_variance_without_the_sensors_noise_is_the_first_lags_continued() -> None:
    """Of a pure sine the autocovariance is a cosine, which half a period later is below the half."""
    e = np.sqrt(2.0) * np.sin(2 * np.pi * T / 12.0)
    found = wind(e, torque(held=T < 0), 0.1)
    assert found is not None
    x = 2 * np.pi * PERIOD_S / 12.0
    expected = np.sqrt(np.cos(x) + 0.5 * (np.cos(x) - np.cos(2 * x)))
    assert found.parameters["deviation"].value == pytest.approx(expected, rel=1e-3)
    lags = np.arange(100)
    first = np.flatnonzero(np.cos(x * lags) * (1 - lags / ROWS) < 0.5 * expected**2)[0]
    time = found.parameters["correlation_time"].value
    assert time * np.log(2) == pytest.approx(first * PERIOD_S) and first == 40  # a sixth of the period
    alternating = np.where(np.arange(ROWS) // (2 * SECOND) % 2, 1.0, -1.0)
    assert wind(alternating, torque(held=T < 0), 0.1) is not None


def test_of_quick_gusts_the_second_lag_tells_what_the_first_one_lost() -> None:
    e = gusts(0.3)
    r = [float(e[k:] @ e[: ROWS - k]) / ROWS for k in range(3)]
    found = wind(e, torque(held=T < 0), 0.1)
    assert found is not None and r[0] > r[1] > r[2]
    assert found.parameters["deviation"].value == pytest.approx(np.sqrt(r[1] + 0.5 * (r[1] - r[2])))


def test_a_torque_of_hardly_a_cycle_has_no_correlation_time() -> None:
    """Half of its variance is there after 20 s still: four cycles are what its size is known by."""
    e = np.sqrt(2.0) * np.sin(2 * np.pi * T / 200.0)
    found = wind(e, torque(held=T < 0), 0.1)
    assert found is not None and list(found.parameters) == ["deviation"]
    assert found.parameters["deviation"].half == pytest.approx(1.96 / np.sqrt(8), rel=0.01)
    # of 100 s a sixth is 17 s, and a cycle of that time is so long that fewer than four are in the log
    slow = wind(np.sqrt(2.0) * np.sin(2 * np.pi * T / 100.0), torque(held=T < 0), 0.1)
    assert slow is not None
    assert slow.parameters["correlation_time"].value * np.log(2) == pytest.approx(16.7, abs=0.5)
    assert slow.parameters["deviation"].half == pytest.approx(1.96 / np.sqrt(8), rel=0.01)


@pytest.mark.parametrize(("ratio", "blows"), [(0.92, True), (0.88, False), (1.5, True)])
def test_a_wind_is_most_of_the_noise_in_means_of_a_second(ratio: float, blows: bool) -> None:
    e = np.where(np.arange(ROWS) // SECOND % 4 < 2, 1.0, -1.0) * ratio
    assert (wind(e, torque(held=T < 0), 1.0) is not None) is blows


@pytest.mark.parametrize(
    ("size", "seconds", "blows"),
    [
        (1.0, 100, True),
        (0.55, 100, True),
        (0.45, 100, False),  # half of what the fitted rows have
        (0.0, 100, False),
        (0.0, 8, False),
        (0.0, 7, True),  # too few to say so
    ],
)
def test_what_blows_blows_on_held_out_rows_too(size: float, seconds: int, blows: bool) -> None:
    p = torque()
    late = np.cumsum(p.held) <= seconds * SECOND
    p.valid = ~p.held | late
    e = np.where(p.held, size, 1.0) * 4.0 * np.where(np.arange(ROWS) // SECOND % 4 < 2, 1.0, -1.0)
    assert (wind(e, p, 1.0) is not None) is blows


def test_held_out_rows_must_have_a_wind_by_themselves() -> None:
    """Half of a weak one is none."""
    p = torque()
    e = np.where(p.held, 0.7, 1.0) * 1.1 * np.where(np.arange(ROWS) // SECOND % 4 < 2, 1.0, -1.0)
    assert wind(e, p, 1.0) is None and wind(e / 0.7, p, 1.0) is not None


@pytest.mark.parametrize(("step", "blows"), [(0.45, True), (0.6, False)])
def test_two_steps_of_the_converters_are_no_wind(step: float, blows: bool) -> None:
    assert (wind(GUSTS, torque(step=step, held=T < 0), 0.1) is not None) is blows
    assert (wind(10 * GUSTS, torque(step=10 * step, held=T < 0), 1.0) is not None) is blows


def unknown(found: Finding | None, domain: str) -> Finding:
    assert found is not None
    assert (found.name, found.channel, found.domain) == (UNKNOWN, "T", domain)
    return found


def test_bursts_and_a_torque_that_turns_over_are_no_wind() -> None:
    p = torque(held=T < 0)
    bursts = GUSTS * np.where(T % 40.0 < 4.0, 5.0, 0.5)
    found = unknown(wind(bursts, p, 0.1), "time")
    assert found.note.startswith(f"bursts of torque (kurtosis {kurtosis(bursts):.0f};")
    rms = found.parameters["rms"]
    assert (rms.value, rms.low, rms.high) == pytest.approx(
        rms_interval(bursts, p.block)
    ) and rms.unit == "N m"
    assert found.evidence > 0 and found.share > 0.9
    way = np.where(np.arange(ROWS) // (8 * SECOND) % 2, 1.0, -1.0)
    turned = unknown(wind(2.0 * way + 0.1 * LUCK, torque(0.01 * way, held=T < 0), 0.1), "velocity")
    assert turned.note.startswith("torque that turns over with the direction")
    peaks = way * np.where((T % 8.0 > 4.0) & (T % 8.0 < 4.3), 20.0, 1.0)
    assert kurtosis(peaks) > 5
    both = unknown(wind(peaks, torque(0.01 * way, held=T < 0), 0.1), "velocity")
    assert both.note == turned.note


@pytest.mark.parametrize(("loud", "bursts"), [(5.0, True), (4.4, False)])
def test_a_kurtosis_beyond_five_is_of_bursts(loud: float, bursts: bool) -> None:
    """`loud` for a tenth of the time: the mean fourth power over the square of the mean one."""
    size = np.where(T % 10.0 < 1.0, loud, 1.0)
    assert ((0.9 + 0.1 * loud**4) / (0.9 + 0.1 * loud**2) ** 2 > 5) is bursts
    e = size * np.where(T % 20.0 < 10.0, 1.0, -1.0)
    found = wind(e, torque(held=T < 0), 0.1)
    assert found is not None and (found.name == UNKNOWN) is bursts


HALF = 8 * SECOND  # rows from one turn to the next
BEYOND = 1e3


def turning(
    before: np.ndarray, after: np.ndarray, rest: float | None = None, edges: bool = False
) -> tuple[np.ndarray, Problem]:
    """A torque in the second before and after every turn, far more elsewhere; then the axis stands still.

    rest: rad/s for a second between the two, in which the axis stands. edges: it is zero but for one row.
    """
    e, rate = np.full(ROWS, BEYOND), np.zeros(ROWS)
    for k in range(len(before) + 1):
        rate[k * HALF : (k + 1) * HALF] = 0.01 if k % 2 else -0.02
    still = 0 if rest is None else SECOND
    for k, (a, b) in enumerate(zip(before, after, strict=True)):
        at = (k + 1) * HALF
        rate[at : at + still] = rest or 0.0
        if edges:
            e[at - SECOND : at + SECOND] = 0.0
            e[at - 1], e[at] = a, b
        else:
            e[at - SECOND : at] = a
            e[at + still : at + still + SECOND] = b
    return e, torque(rate, held=T < 0)


def over(turns: int, correlation: float, **more: Any) -> bool:
    """Before and after the turns of this correlation, of different sizes."""
    a = np.where(np.arange(turns) % 2, 1.0, -1.0)
    b = np.where(np.arange(turns) % 4 < 2, 1.0, -1.0)
    assert abs(a @ b) < 1e-9 or turns < 4
    mixed = correlation * a + np.sqrt(1 - correlation**2) * b
    return follows_direction(*turning(5.0 * a, 0.3 * mixed, **more))


@pytest.mark.parametrize("more", [{}, {"rest": 0.0}, {"rest": 1e-4}, {"edges": True}])
def test_a_torque_turns_over_from_the_second_before_a_turn_to_the_one_after(more: dict[str, Any]) -> None:
    assert over(12, -1.0, **more) and not over(12, 1.0, **more)


def test_just_a_second_of_rows_counts_before_a_turn_and_after() -> None:
    """Their means turn over; those of a row more or less, or of the last two rows, do not."""
    way = np.where(np.arange(12) % 2, 1.0, -1.0)
    e, p = turning(way, -way)
    for k, a in enumerate(way):
        at = (k + 1) * HALF
        e[at - SECOND : at] = -8.0 / 17 * a
        e[at - SECOND], e[at - 2 : at] = 30.0 * a, -a
        e[at : at + SECOND] = 40.0 / 18 * a
        e[at] = e[at + SECOND - 1] = -30.0 * a
        assert e[at - SECOND : at].mean() == pytest.approx(a)
        assert e[at : at + SECOND].mean() == pytest.approx(-a)
    assert follows_direction(e, p)


@pytest.mark.parametrize(("turns", "told"), [(2, False), (3, True)])
def test_two_turns_tell_nothing(turns: int, told: bool) -> None:
    assert over(turns, -1.0) is told


@pytest.mark.parametrize(
    ("turns", "correlation", "told"),
    [
        (48, -0.65, True),
        (48, -0.55, False),
        (16, -0.8, True),  # by luck it scatters by one over the root of the turns
        (16, -0.7, False),
        (4, -0.97, True),
        (4, -0.93, False),
    ],
)
def test_a_torque_turns_over_where_the_correlation_is_no_luck(
    turns: int, correlation: float, told: bool
) -> None:
    assert over(turns, correlation) is told


def test_turns_from_run_to_run_or_of_held_out_rows_are_none() -> None:
    e, p = turning(np.full(12, 1.0), np.full(12, -1.0))
    assert follows_direction(e, p)
    every = replace(p, run=np.arange(ROWS) // HALF)
    assert not follows_direction(e, every)
    way = np.where(np.arange(ROWS) // HALF % 2, 1.0, -1.0)
    late = np.arange(ROWS) >= 20 * HALF
    p = torque(0.01 * way, held=late)
    assert follows_direction(np.where(late, 50.0, way), p)


def test_a_turn_right_behind_the_first_row_has_that_row_before_it() -> None:
    way = np.where((np.arange(ROWS) + HALF - 1) // HALF % 2, 1.0, -1.0)
    assert way[0] * way[1] < 0
    assert follows_direction(way, torque(0.01 * way, held=T < 0))


TURNS = 0.02 * T  # of a motor


def volts(e: np.ndarray, turns: np.ndarray = TURNS, **more: Any) -> Finding | None:
    return unexplained_volts(e, replace(problem(np.zeros(ROWS)), channel="E", **more), turns)


def brush(loud: float, sector: float = 1 / 16, first: float = 0.25, turns: np.ndarray = TURNS) -> np.ndarray:
    """Quiet noise of one, `loud` in a sector of the turn."""
    return np.where((turns % 1.0 >= first) & (turns % 1.0 < first + sector), loud, 1.0) * LUCK


def test_volts_of_one_sector_are_a_brush_with_their_size() -> None:
    e = brush(12.0)
    found, p = volts(e), problem(np.zeros(ROWS))
    assert found is not None
    assert (found.name, found.channel, found.domain) == (UNKNOWN, "E", "motor_angle")
    white = white_noise(e, p.train, bursts=False)
    size = float(np.sqrt(np.mean(e[p.train] ** 2)))
    rms = found.parameters["rms"]
    assert rms.value == pytest.approx(size) and rms.unit == "V"
    assert (rms.low, rms.high) == pytest.approx(rms_interval(e[p.train], p.block)[1:])
    assert found.share == pytest.approx(1 - (white / size) ** 2)
    assert found.evidence == pytest.approx(variance_log10((size / white) ** 2, p.train.sum() / p.block))
    assert found.note == f"volts {size / white:.1f} times the quiet noise, in a sector of the motor's turn"


def test_volts_of_no_sector_or_within_the_noise_are_none() -> None:
    assert volts(LUCK) is None
    assert volts(brush(12.0), turns=RNG.random(ROWS)) is None  # anywhere in the turn
    bursts = np.where(np.arange(ROWS) % 10 < 2, 6.0, 1.0) * LUCK
    assert volts(bursts) is None
    assert volts(np.zeros(ROWS)) is None


def test_held_out_rows_must_have_the_sector_too() -> None:
    held = problem(np.zeros(ROWS)).held
    assert volts(np.where(held, LUCK, brush(12.0))) is None


@pytest.mark.parametrize(("sectors", "told"), [(4, True), (11, True), (12, False)])
def test_volts_of_most_of_a_turn_are_of_no_sector(sectors: int, told: bool) -> None:
    """Of a part p of a quiet turn that is loud, the spread over the mean is (1 / p - 1) to the half."""
    assert bool(np.sqrt(16 / sectors - 1) > 0.6) is told
    slow = np.where(np.arange(ROWS) // SECOND % 2, 6.0, -6.0)
    assert (volts(np.where(sectors / 16 > TURNS % 1.0, slow, 0.0) + 0.3 * LUCK) is not None) is told


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
@pytest.mark.parametrize(("loud", "told"), [(9.0, False), (11.0, True), (14.0, True)])
def test_a_brush_is_twice_as_loud_as_the_quiet_noise(loud: float, told: bool, scale: float) -> None:
    e = brush(loud)
    rows = problem(e).train
    assert bool(np.sqrt(np.mean(e[rows] ** 2)) > 2 * white_noise(e, rows, bursts=False)) is told
    assert (volts(scale * e) is not None) is told


def test_single_rows_are_no_sector() -> None:
    """Eight thousand rows have one that is a thousand times as loud in each part."""
    spikes = LUCK.copy()
    spikes[[1000, 7500]] = 1e3
    assert volts(spikes) is None


@pytest.mark.parametrize(("bins", "told"), [(8, True), (7, False)])
def test_a_motor_that_hardly_turns_half_way_shows_no_sector(bins: int, told: bool) -> None:
    turns = (np.arange(ROWS) % 1000 + 0.5) / 1000 * bins / 16
    assert (volts(brush(12.0, turns=turns), turns=turns) is not None) is told


@pytest.mark.parametrize(("blocks", "told"), [(FEWEST_BLOCKS, True), (FEWEST_BLOCKS - 1, False)])
def test_a_short_log_shows_no_brush(blocks: int, told: bool) -> None:
    """Twenty seconds are as many blocks, and two turns; of a sixteenth there are twenty-five rows."""
    turns, rows = 0.1 * T, np.arange(ROWS)
    valid = (rows < blocks * SECOND) | (rows >= 380 * SECOND)
    assert (volts(brush(12.0, turns=turns), turns=turns, valid=valid) is not None) is told


def test_a_part_of_the_turn_that_lasts_longer_is_no_louder() -> None:
    """The motor dwells in a quarter of its turn."""
    even = (T / 50.0) % 1.0
    turns = np.where(even < 0.8, even / 0.8 * 0.25, 0.25 + (even - 0.8) / 0.2 * 0.75)
    slow = np.where(np.arange(ROWS) // SECOND % 2, 6.0, -6.0)
    assert volts(slow + 0.3 * LUCK, turns=turns) is None
    assert volts(np.where(turns < 0.25, slow, 0.0) + 0.3 * LUCK, turns=turns) is not None


def test_a_sensor_without_noise_shows_no_brush() -> None:
    """It stands still within each half of the turn."""
    assert volts(np.where(TURNS % 1.0 < 0.5, 9.0, 1.0)) is None
