"""The compiled loop over a few samples: its settings by hand, what it starts from and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from plant import loop
from plant.kernels import control
from plant.loop import ADC_COUNTS_PER_A, LATENCY_S, Excitation, simulate
from plant.model import with_effects, with_value
from plant.parts import EffectModel, Number, PlantModel
from plant.units import ARCSEC, TURN
from tests.plant.bench import bare

GAINS = {"kp": 0.285, "ki": 0.0245, "counter_split": 0.1, "pwm_steps": 3000.0}


def model(**controller: float) -> PlantModel:
    made = bare()
    for name, value in {**GAINS, **controller}.items():
        made = with_value(made, f"controller.{name}", value)
    return made


def late(column: int, seconds: float) -> EffectModel:
    given = {"column": Number(float(column), "1", ""), "delay": Number(seconds, "s", "")}
    return EffectModel("channel_delay", parameters=given)


def test_settings_are_those_of_the_board() -> None:
    """Gains in Q12, a split in per cent; 0.1 ohm, gain 8, 5 V and 10 bit; delays in the log's order."""
    assert ADC_COUNTS_PER_A == pytest.approx(0.1 * 8 * 1024 / 5) == pytest.approx(163.84)
    delays = tuple(late(column, 0.001 * (column + 1)) for column in range(5))
    part = with_effects(bare(), "ra", delays).axes.ra
    made = loop._settings(model(ki=2.5, counter_split=0.8), part, 77.0)
    expected = [1167, 10240, 3000, 80, 10, 65e-6, 77.0, 0.001, 0.002, 0.003, 0.004, 0.005]
    assert made.tolist() == pytest.approx(expected, rel=1e-12)  # 0.285 * 4096 = 1167.4
    assert len(made) == control.SETTINGS and LATENCY_S == 65e-6


def test_a_tick_is_a_whole_number_of_grid_steps_each_longer_than_the_latency() -> None:
    def settings(grid_us: float, period_ms: float) -> float:
        made = with_value(with_value(model(), "numerics.grid", grid_us), "controller.period", period_ms)
        ticks: float = loop._settings(made, made.axes.ra, 1.0)[control.TICK_STEPS]
        return ticks

    assert settings(250.0, 5.0) == 20
    assert settings(65.0, 6.5) == 100
    for grid_us, period_ms in ((300.0, 5.0), (50.0, 5.0), (64.0, 6.4)):
        with pytest.raises(ValueError, match=rf"a multiple of the grid step, {grid_us * 1000:.0f} ns"):
            settings(grid_us, period_ms)


def test_efforts_become_steps_and_between_two_samples_lies_their_mean() -> None:
    effort = np.array([30.0, 60.0, -90.0])
    assert loop._between(effort, model()).tolist() == [30, 45, 60, -15, -90, -90]
    assert loop._between(effort, model(pwm_steps=1500.0)).tolist() == [15, 22.5, 30, -7.5, -45, -45]


def test_the_truth_tells_the_duties_before_the_tick() -> None:
    """The lagging motor has a tenth, rounded, once it is a whole step off."""
    log = simulate(model(), "ra", 0.03, Excitation(effort=np.array([100.0, 300.0, -900.0])))
    assert log.effort.tolist() == [100, 300, -900]
    assert np.isnan(log.setpoint).all()
    assert log.truth["duty_a"] * 3000 == pytest.approx([0, 200, 30])
    assert log.truth["duty_b"] * 3000 == pytest.approx([0, 20, 300])
    assert log.t.tolist() == pytest.approx([0.0, 0.01, 0.02], abs=1e-12)


def test_one_effort_is_that_of_every_sample() -> None:
    assert simulate(model(), "ra", 0.03, Excitation(effort=42.0)).effort.tolist() == [42] * 3
    closed = simulate(model(), "ra", 0.02, Excitation(setpoint=0.0))  # no effort is none
    assert closed.effort.tolist() == [0, 0] and not closed.truth["rate"].any()


def test_a_set_point_becomes_counts_of_a_tick() -> None:
    """3600 arcsec/s is 1/360 turn/s of 4 608 000 * 24.5 counts, in 5 ms: 1568. The first effort is of both
    gains: (1167 + 100) * 1568 / 4096 = 485.02."""
    log = simulate(model(), "ra", 0.01, Excitation(setpoint=3600.0))
    assert log.effort.tolist() == [485]
    assert log.setpoint.tolist() == [3600.0]


def test_the_kernel_gets_set_points_in_q16_and_efforts_in_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[list[float]] = []

    def control_loop(_: object, __: object, ticks: np.ndarray, effort: np.ndarray, *___: object) -> None:
        asked.extend((ticks.tolist(), effort.tolist()))

    monkeypatch.setattr(loop, "control_loop", control_loop)
    simulate(model(), "ra", 0.01, Excitation(setpoint=3600.0, effort=90.0))
    assert asked == [[1568 * 65536] * 2, [90.0] * 2]


def test_without_a_set_point_and_an_effort_nothing_pulls() -> None:
    open_loop = simulate(model(), "ra", 0.02, Excitation(setpoint=np.array([np.nan, np.nan])))
    assert open_loop.effort.tolist() == [0, 0]


def test_a_set_point_may_be_one_of_every_tick() -> None:
    ticks = np.array([0.0, 3600.0, 100.0, 200.0])
    log = simulate(model(), "ra", 0.02, Excitation(setpoint=ticks))
    assert log.setpoint.tolist() == [0.0, 100.0]
    assert log.effort[0] == 0
    assert log.truth["duty_a"][1] * 3000 == pytest.approx(485)
    per_sample = simulate(model(), "ra", 0.02, Excitation(setpoint=ticks[:2]))
    assert per_sample.setpoint.tolist() == [0.0, 3600.0] and per_sample.effort.tolist() == [0, 485]


def test_an_axis_starts_where_and_when_it_is_told() -> None:
    still = simulate(model(), "ra", 0.01, Excitation(effort=0.0))
    assert (still.t[0], still.position[0], still.truth["rate"][0]) == (0.0, 0.0, 0.0)
    later = simulate(model(), "dec", 0.01, Excitation(effort=0.0, start_s=12.5, start_steps=1000.5))
    assert later.t[0] == pytest.approx(12.5)
    assert later.position[0] == 1000


@pytest.mark.parametrize("steps", [-3.5, 2**29 + 7.5])
def test_positions_are_those_of_a_turn(steps: float) -> None:
    """29 bit, and 17 of the geared encoder, 10.8 turns of it in one of the axis."""
    log = simulate(model(), "ra", 0.01, Excitation(effort=0.0, start_steps=steps))
    assert log.position[0] == np.floor(steps) % 2**29
    assert log.aux[0] == np.floor(steps * 10.8 / 2**12) % 2**17


def test_before_the_start_a_late_reading_is_that_of_the_start() -> None:
    """10.25 ms late and 3600 arcsec/s: at 10 ms still the start's, at 20 ms that of 9.75 ms."""
    made = with_effects(model(), "ra", (late(1, 0.01025),))
    excitation = Excitation(setpoint=3600.0, start_rate=3600.0, start_s=3.0, start_steps=5000.5)
    log = simulate(made, "ra", 0.03, excitation)
    assert log.position[:2].tolist() == [5000, 5000]
    moved = np.diff(log.truth["angle"])[0] / TURN * 2**29
    assert log.position[2] - 5000 == pytest.approx(0.975 * moved, rel=0.005)
    prompt = simulate(model(), "ra", 0.02, replace(excitation, start_s=0.0))
    assert prompt.position.tolist() == [5000, np.floor(5000.5 + moved)]
    assert prompt.truth["rate"][0] == pytest.approx(3600 * ARCSEC)


def test_the_seed_is_that_of_where_counters_wake_up() -> None:
    """Motors at 0.2 counts of their encoders per sample: by the seed, a count comes sooner or later."""
    slow = Excitation(setpoint=0.05, start_rate=4.0)

    def counts(**seed: int) -> list[float]:
        log = simulate(model(), "ra", 0.1, slow, **seed)
        return [*log.tach_a, *log.tach_b, *log.velocity]

    assert counts() == counts(seed=0)
    assert counts() != counts(seed=1)


def test_the_current_is_in_counts_of_the_converter() -> None:
    """10 ms after a step of the voltage with the motor in its play: V / R and a rise of exp(-R t / L)."""
    few, many = (
        simulate(model(), "ra", 0.05, Excitation(effort=300.0), adc_counts_per_A=scale).adc_a[3]
        for scale in (100.0, 400.0)
    )
    assert many == pytest.approx(4 * few, abs=4)
    plain = simulate(model(), "ra", 0.05, Excitation(effort=300.0)).adc_a[3]
    assert plain == pytest.approx(1.6384 * few, abs=2)


def test_what_it_refuses() -> None:
    with pytest.raises(ValueError, match=r"at least one sample of 0\.01 s"):
        simulate(bare(), "ra", 0.004, Excitation(effort=0.0))
    assert len(simulate(bare(), "ra", 0.006, Excitation(effort=0.0)).t) == 1
    for wrong in (
        Excitation(effort=np.zeros(4)),
        Excitation(effort=np.zeros((2, 2))),
        Excitation(setpoint=np.zeros((4, 1))),
    ):
        with pytest.raises(ValueError, match="4 values for 2 samples"):
            simulate(bare(), "ra", 0.02, wrong)
