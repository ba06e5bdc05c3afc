"""The compiled velocity loop: the paper's arithmetic, the log's columns, and agreement with the plant's own
pins.
"""

import numpy as np
import pytest

from plant import model
from plant.loop import LATENCY_S, Excitation, LogColumns, simulate
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import bare

COUNT_ARCSEC = 1296000 / (4.608e6 * 24.5)


def by_hand(setpoint_arcsec_s: float, samples: int) -> dict[str, list[int]]:
    """Run the paper's incremental PI in plain integers over the pins of a Plant."""
    plant = Plant(model.load(), 7)
    c = model.load().controller
    kp, ki = round(c.kp.si * 4096), round(c.ki.si * 4096)
    limit = 3000 << 16
    wanted = round(setpoint_arcsec_s / COUNT_ARCSEC / 200 * 65536)
    effort = last_error = counter = 0
    got: dict[str, list[int]] = {"effort": [], "velocity": [], "position": [], "adc_a": [], "tach_a": []}
    last = plant.ra.incremental(0)
    last_tach = plant.ra.tachometer(0, 0)
    for tick in range(2 * samples):
        t = tick * 5_000_000
        count = plant.ra.incremental(t)
        velocity, last = count - last, count
        error = wanted - (velocity << 16)
        effort = max(-limit, min(limit, effort + ((kp * (error - last_error) + ki * error) >> 12)))
        last_error = error
        steps = (effort + 32768) >> 16
        share = abs(steps) * 10 / 100
        if abs(share - counter) >= 1:  # the lagging motor's register is a whole step off: it moves
            counter = int(share + 0.5)
        if tick % 2 == 0:
            tach = plant.ra.tachometer(t, 0)
            got["effort"].append(steps)
            got["velocity"].append(velocity)
            got["position"].append(plant.ra.absolute(t))
            got["adc_a"].append(min(1023, int(plant.ra.current(t, 0) * 0.8 / 5 * 1024)))
            got["tach_a"].append(tach - last_tach)
            last_tach = tach
        pair = (steps, counter) if steps >= 0 else (counter, -steps)
        plant.ra.drive(t + round(LATENCY_S * 1e9), pair[0] / 3000, pair[1] / 3000)
    return got


def test_B1_loop_is_the_plant_with_the_papers_pi_bit_by_bit() -> None:
    expected = by_hand(600.0, 400)
    got = simulate(model.load(), "ra", 4.0, Excitation(setpoint=600.0), seed=7)
    for word, column in expected.items():
        assert np.array_equal(getattr(got, word), column), word
    assert max(expected["velocity"]) > 200  # it did move


def test_log_columns_are_those_of_the_axis_log() -> None:
    log = simulate(bare(), "ra", 2.0, Excitation(setpoint=1000.0, start_steps=2**29 - 1000))
    assert len(log.t) == 200
    assert np.allclose(np.diff(log.t), 0.010)
    assert log.position.min() >= 0 and log.position.max() < 2**29
    assert log.position[0] == 2**29 - 1000
    assert (np.diff(log.position) < -(2**28)).sum() == 1  # the 29-bit wrap
    assert log.adc_a.max() <= 1023 and log.adc_a.min() >= 0
    assert np.abs(log.effort).max() <= 3000
    assert set(log.truth) >= {"angle", "rate", "current_a", "gear_torque_b", "bristle"}


def test_E1_counts_at_15_arcsec_per_s_alternate_around_6_53() -> None:
    log = simulate(model.load(), "ra", 60.0, Excitation(setpoint=15.0))
    tail = log.velocity[4000:]
    assert tail.mean() == pytest.approx(6.5333, rel=0.02)
    assert np.array_equal(tail, np.rint(tail))


def test_open_loop_replay_follows_the_recorded_run() -> None:
    """Efforts logged every 10 ms, put back open loop, give the motion again."""
    recorded = simulate(bare(), "ra", 20.0, Excitation(setpoint=3600.0))
    replayed = simulate(bare(), "ra", 20.0, Excitation(effort=recorded.effort))
    late = slice(500, None)
    assert np.isnan(replayed.setpoint).all()
    difference = replayed.truth["rate"][late] - recorded.truth["rate"][late]
    assert np.abs(difference).max() < 0.02 * 3600 * ARCSEC


def test_start_in_motion_needs_no_run_up() -> None:
    log = simulate(bare(), "ra", 1.0, Excitation(setpoint=3600.0, start_rate=3600.0))
    assert log.truth["rate"][0] == pytest.approx(3600 * ARCSEC)


def test_setpoint_may_change_per_sample_and_open_up() -> None:
    wanted = np.full(400, 2000.0)
    wanted[200:] = np.nan
    log: LogColumns = simulate(bare(), "ra", 4.0, Excitation(setpoint=wanted, effort=0.0))
    assert abs(log.truth["rate"][199] / ARCSEC - 2000.0) < 200
    assert abs(log.truth["rate"][-1] / ARCSEC) < 20.0  # what the bristles still ring


def test_same_seed_same_log() -> None:
    first, second = (simulate(model.load(), "dec", 2.0, Excitation(setpoint=600.0), seed=3) for _ in range(2))
    assert np.array_equal(first.truth["angle"], second.truth["angle"])
    assert np.array_equal(first.tach_b, second.tach_b)


def test_errors_are_one_line() -> None:
    with pytest.raises(ValueError, match="expected ra or dec"):
        simulate(bare(), "x", 1.0, Excitation(setpoint=1.0))
    with pytest.raises(ValueError, match="give a set point or an effort"):
        simulate(bare(), "ra", 1.0, Excitation())
    with pytest.raises(ValueError, match="3 values for 100 samples"):
        simulate(bare(), "ra", 1.0, Excitation(setpoint=np.zeros(3)))


@pytest.mark.slow
def test_loop_runs_hundreds_of_times_faster_than_real_time() -> None:
    import time

    simulate(model.load(), "ra", 1.0, Excitation(setpoint=15.0))
    best = min(_timed(time.perf_counter) for _ in range(5))
    assert 20.0 / best > 300  # the aim of 1000 is measured by the benchmark; machines under load are slower


def _timed(clock: object) -> float:
    start = clock()  # type: ignore[operator]
    simulate(model.load(), "ra", 20.0, Excitation(setpoint=15.0))
    return float(clock() - start)  # type: ignore[operator]


def test_E7_torque_over_rate_is_table_2() -> None:
    """In steady slow sliding the friction torque of the truth is that of the LuGre fit."""
    rate = 2000.0
    log = simulate(bare(), "ra", 20.0, Excitation(setpoint=rate))
    expected = 229 + 392 * np.exp(-((rate * ARCSEC / 4e-4) ** 2)) + 6700 * rate * ARCSEC
    assert log.truth["friction"][1000:].mean() == pytest.approx(expected, rel=0.01)


def test_E8_run_down_gives_the_published_inertia() -> None:
    """J dw/dt = -friction with J = 1.76e6 N mm s2, rotors included, when power is cut at 1 deg/s."""
    start = 3600.0
    log = simulate(bare(), "ra", 0.3, Excitation(effort=0.0, start_rate=start))
    rate = log.truth["rate"]
    moving = rate > 1200 * ARCSEC
    k = int(moving.sum()) - 1
    friction = log.truth["friction"]
    impulse = float(np.sum(0.5 * (friction[1 : k + 1] + friction[:k])) * 0.01)
    assert impulse / (rate[0] - rate[k]) == pytest.approx(1760.0, rel=0.05)
