"""The loop's parts by themselves, and some ticks of it by hand; the whole of it: tests/plant/test_loop.py."""

from math import nan

import numpy as np
import pytest

from plant.compiled import Floats
from plant.kernels import control
from plant.kernels import layout as at
from plant.kernels.advance import advance_axis
from plant.kernels.control import apply_effort, control_loop, counter_steps, reading
from plant.loop import LOG_COLUMNS, TRUTH_COLUMNS

H = 1e-3


def test_a_reading_of_before_is_the_kept_one_and_goes_on_with_its_slope() -> None:
    """At step 600 the ring of 512 has gone round; 2.25 steps ago is three quarters of a step behind 597."""
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.STEP] = H, 600.0
    w[at.OUT : at.OUT + at.OUT_SIZE] = range(50, 50 + at.OUT_SIZE)
    row = at.DELAYS + (597 - at.DELAY_ROWS) * at.OUT_SIZE
    w[row + at.OUT_ABSOLUTE], w[row + at.OUT_ABSOLUTE + 1] = 7.0, 4e-6  # counts, counts per ns
    w[row + at.OUT_CURRENT_A], w[row + at.OUT_CURRENT_B] = 3.0, 1e9
    w[row + at.OUT_ANGLE], w[row + at.OUT_ANGLE + 1] = 8.0, 4e-6
    assert reading(w, at.OUT_ABSOLUTE, 0.0) == 52.0
    assert reading(w, at.OUT_ABSOLUTE, 2.25 * H) == pytest.approx(7.0 + 0.75 * 1e6 * 4e-6)
    assert reading(w, at.OUT_ANGLE, 2.25 * H) == pytest.approx(8.0 + 0.75 * 1e6 * 4e-6)
    assert reading(w, at.OUT_CURRENT_A, 2.25 * H) == 3.0  # a current is a sample: it has no slope


def test_a_reading_of_before_the_start_is_the_first() -> None:
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.STEP] = H, 1.0
    w[at.DELAYS + at.OUT_TACH_A], w[at.DELAYS + at.OUT_TACH_A + 1] = 9.0, 1.0
    assert reading(w, at.OUT_TACH_A, 3.5 * H) == 9.0


@pytest.mark.parametrize(("size", "split", "register", "expected"), [
    (1000, 10, 0, 100), (1005, 10, 0, 101), (1004, 10, 0, 100),  # to the nearest step
    (1009, 10, 100, 100), (1010, 10, 100, 101), (991, 10, 100, 100), (990, 10, 100, 99),  # a whole step off
    (107, 7, 0, 7), (0, 10, 1, 0), (0, 10, 0, 0),
])  # fmt: skip
def test_the_counter_torque_stays_until_it_is_a_whole_step_off(
    size: int, split: int, register: int, expected: int
) -> None:
    assert counter_steps(size, split, register) == expected


@pytest.mark.parametrize(("effort", "duties"), [(900, (0.3, 0.1)), (-900, (0.1, 0.3)), (0, (0.0, 0.1))])
def test_an_effort_leads_with_one_motor_after_the_latency(effort: int, duties: tuple[float, float]) -> None:
    """3000 steps of PWM, a counter torque of 300; 0.25 of a grid step is over when the duty changes."""
    w, s = np.zeros(at.WIDTH), np.zeros(control.SETTINGS)
    w[at.GRID], s[control.STEPS], s[control.LATENCY] = H, 3000.0, 0.25 * H
    before = (0.6, 0.2)
    w[at.DUTY : at.DUTY + 2] = w[at.MEAN_DUTY : at.MEAN_DUTY + 2] = before
    apply_effort(w, effort, 300, s)
    assert w[at.DUTY : at.DUTY + 2] == pytest.approx(duties)
    mean = [0.25 * old + 0.75 * new for old, new in zip(before, duties, strict=True)]
    assert w[at.MEAN_DUTY : at.MEAN_DUTY + 2] == pytest.approx(mean)


def coasting(counts_per_s: float = 2000.0) -> Floats:
    """An axis without friction, whose incremental encoder counts 10 a tick of 5 ms; motors run along."""
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.RATE], w[at.RATE_BEFORE] = H, 1.0, 1.0
    w[at.ANGLE] = 0.5 * H + 1.25e-4  # between two counts, so that no rounding decides
    w[[at.INERTIA, at.ROTOR_INERTIA, at.RATIO, at.RESISTANCE, at.STRIBECK]] = 1e12, 1e12, 1.0, 1.0, 1.0
    w[at.DECLARED_FRICTION : at.DECLARED_FRICTION + at.FRICTION_SIZE - 1] = 1.0
    w[[at.INCREMENTAL_SCALE, at.ABSOLUTE_SCALE, at.AUXILIARY_SCALE, at.TACH_SCALE]] = (
        counts_per_s, 3 * counts_per_s, 5 * counts_per_s, counts_per_s,
    )  # fmt: skip
    for m, rate in ((0, 1.5), (1, -0.5)):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_RATE] = w[o + at.M_RATE_BEFORE] = rate
        w[o + at.M_ANGLE], w[at.TACH_ZERO + m] = 0.5 * H * rate + 1.25e-4, 0.0
    for m, current in ((0, 1.23), (1, 200.0)):
        w[at.MOTORS + m * at.MOTOR_SIZE + at.M_CURRENT] = w[at.OUT + at.OUT_CURRENT_A + m] = current
    w[[at.VOLTAGE, at.CURRENT_DECAY, at.CURRENT_BLEND]] = 0.0, 1.0, 1.0  # currents go on
    return w


def run(
    setpoint: list[float], effort: list[float], w: Floats | None = None, **settings: float
) -> tuple[dict[str, Floats], Floats, Floats]:
    """Log by name, truth and the row of a run from rest; gains one half and one eighth, 100 PWM steps."""
    w, s = coasting() if w is None else w, np.zeros(control.SETTINGS)
    given = {"KP": 2048, "KI": 512, "STEPS": 100, "SPLIT": 50, "TICK_STEPS": 5, "AMPERE": 100.0}
    for word, value in (given | settings).items():
        s[getattr(control, word)] = value
    rows = len(setpoint) // 2
    log, truth = np.zeros((rows, control.LOG_SIZE)), np.zeros((rows, control.TRUTH_SIZE))
    advance_axis(w, 0)  # the readings of the start
    control_loop(w, s, np.array(setpoint) * 65536.0, np.array(effort), log, truth)
    return dict(zip(LOG_COLUMNS, log.T, strict=True)), truth, w


def test_a_closed_loop_by_hand() -> None:
    """Set point 14 counts a tick, of which 10 come (none at the first): errors 14, then 4, in counts.

    Held: 7 + 1.75 = 8.75, then 8.75 - 5 + 0.5 = 4.25, then half a step more each tick: 9, 4, 5, 5, 6, 6.
    Half of it, once a whole step off: 5, 2, 2, 2, 3, 3.
    """
    log, truth, w = run([14.0] * 6, [0.0] * 6)
    assert log["t"] == pytest.approx([0.0, 0.01, 0.02])
    assert log["setpoint"].tolist() == [14 * 65536.0] * 3
    assert log["velocity"].tolist() == [0.0, 10.0, 10.0]
    assert log["effort"].tolist() == [9 * 30.0, 5 * 30.0, 6 * 30.0]  # 1/3000
    assert log["position"].tolist() == [0.0, 60.0, 120.0] and log["aux"].tolist() == [1.0, 101.0, 201.0]
    assert log["tach_a"].tolist() == [0.0, 30.0, 30.0] and log["tach_b"].tolist() == [0.0, -10.0, -10.0]
    assert log["adc_a"].tolist() == [123.0] * 3 and log["adc_b"].tolist() == [1023.0] * 3
    assert truth[:, TRUTH_COLUMNS.index("rate")] == pytest.approx([1.0] * 3)
    assert truth[:, control.DUTY_A].tolist() == [0.0, 0.04, 0.05]  # of the tick before
    assert truth[:, control.DUTY_B].tolist() == [0.0, 0.02, 0.02]
    assert w[at.DUTY : at.DUTY + 2].tolist() == [0.06, 0.03] and w[at.STEP] == 30.0


@pytest.mark.parametrize("sign", [1, -1])
def test_the_effort_is_held_within_the_pwm(sign: int) -> None:
    """An error of 10 000 counts asks for 6 250 steps of 100; its end asks for 5 000 the other way."""
    log, _, w = run([sign * 1e4] * 2 + [10.0] * 4, [0.0] * 6)
    assert log["effort"].tolist() == [sign * 3000.0, -sign * 3000.0, -sign * 3000.0]
    assert w[at.DUTY : at.DUTY + 2].tolist() == ([0.5, 1.0] if sign > 0 else [1.0, 0.5])


@pytest.mark.parametrize(("given", "steps"), [(30.4, 30), (30.5, 31), (-30.6, -31), (2e2, 100), (-2e2, -100)])
def test_an_open_loop_holds_what_it_is_given_and_closes_from_there(given: float, steps: int) -> None:
    """Closing, the error of 4 counts counts in full: 2.5 more, then half a step each tick."""
    log, _, _ = run([nan] * 2 + [14.0] * 4, [given] * 6)
    assert np.isnan(log["setpoint"]).tolist() == [True, False, False]
    wanted = [steps, min(100, steps + 3), min(100, steps + 4)]
    assert log["effort"].tolist() == [30.0 * each for each in wanted]


@pytest.mark.parametrize(("late", "column", "expected"), [
    ("LATE_POSITION", "position", [0, 18, 78]), ("LATE_POSITION", "aux", [1, 31, 131]),
    ("LATE_VELOCITY", "velocity", [0, 6, 10]),
    ("LATE_TACH", "tach_a", [0, 9, 30]), ("LATE_TACH", "tach_b", [0, -3, -10]),
    ("LATE_CURRENT", "adc_a", [123, 15, 0]), ("LATE_CURRENT", "adc_b", [1023, 1023, 2]),
])  # fmt: skip
def test_late_readings_are_those_of_before(late: str, column: str, expected: list[int]) -> None:
    """7 ms ago, or the first: rows show 0, 3 and 13 ms. Currents of 1.23 and 200 A halve every ms."""
    w = coasting()
    w[at.DELAY_ON], w[at.CURRENT_DECAY] = 1.0, 0.5
    log, _, _ = run([nan] * 6, [0.0] * 6, w, **{late: 7 * H})
    assert log[column].tolist() == expected


def test_no_reading_is_late_unless_told() -> None:
    w = coasting()
    w[at.CURRENT_DECAY] = 0.5
    log, _, _ = run([nan] * 4, [0.0] * 4, w, LATE_POSITION=7 * H)
    assert log["velocity"].tolist() == [0, 10] and log["tach_a"].tolist() == [0, 30]
    assert log["adc_b"].tolist() == [1023, 19]  # 200 A / 1024


@pytest.mark.parametrize(("q16", "steps"), [(32767, 0), (32768, 1)])
def test_half_a_step_is_one_and_less_is_none(q16: int, steps: int) -> None:
    """A gain of one: the effort is the error. Half of one step is no counter torque yet."""
    log, _, w = run([q16 / 65536.0, nan], [0.0, 1.0], KP=4096, KI=0)
    assert log["effort"].tolist() == [30.0 * steps]
    assert w[at.DUTY : at.DUTY + 2].tolist() == [0.01, 0.0]
