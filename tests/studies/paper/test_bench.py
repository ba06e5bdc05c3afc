import numpy as np
import pytest

from plant.model import load
from scenarios.studies.paper.runs import TRIALS, low_speed
from scenarios.studies.paper.starts import EmulatorBench
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.synthetic import log_of

MODEL = load("low_preload")


def test_the_compiled_loop_and_the_emulator_agree_on_a_steady_run():
    runs = {}
    for maker in (CompiledBench, EmulatorBench):
        log = maker(MODEL, gains=(0.5, 0.02)).closed_loop(800.0, 8.0).after(4.0)
        runs[maker.__name__] = log
        assert log.rate.mean() == pytest.approx(800.0, rel=0.01)  # a slow disturbance rides on it
    efforts = [log.effort.mean() for log in runs.values()]
    # crystals, interrupt latency and start differ: half a PWM step
    assert max(efforts) - min(efforts) < 0.5
    currents = [log.current_a.mean() for log in runs.values()]
    assert max(currents) == pytest.approx(min(currents), rel=0.02)


def test_a_log_has_one_sample_every_10_ms_and_goes_on_from_run_to_run():
    bench = EmulatorBench(MODEL)
    first, second = bench.closed_loop(600.0, 1.0), bench.open_loop(0, 1.0)
    assert first.t_s.size == pytest.approx(100, abs=1)
    assert np.diff(np.concatenate([first.t_s, second.t_s])) == pytest.approx(0.010, abs=2e-4)
    assert not second.effort[5:].any()


def test_two_benches_of_one_seed_leave_the_same_log():
    one, two = (EmulatorBench(MODEL, seed=3).closed_loop(300.0, 2.0) for _ in range(2))
    assert np.array_equal(one.counts, two.counts)
    assert np.array_equal(one.adc_a, two.adc_a)


def test_a_command_that_the_board_refuses_is_an_error():
    with pytest.raises(ValueError, match="SET_RATE"):
        EmulatorBench(MODEL).closed_loop(20_000.0, 1.0)  # 5.6 deg/s


def test_gains_are_set_over_the_bus():
    quiet = EmulatorBench(MODEL, gains=(0.0, 0.0)).closed_loop(600.0, 0.5)
    assert not quiet.effort.any()


class FakeAxis:
    """Runs at 10 arcsec/s per step of effort above 90 steps, stands still at or below it."""

    def closed_loop(self, arcsec_s, seconds):
        rate = np.full(round(seconds * 100), arcsec_s)
        return log_of(rate, effort=np.full(rate.size, 98.0))

    def open_loop(self, effort, seconds):
        rate = np.full(round(seconds * 100), 10.0 * (effort - 80) if effort > 90 else 0.0)
        return log_of(rate, effort=np.full(rate.size, float(effort)))


def test_E6_the_staircase_ends_where_the_axis_stays_put():
    _, running = low_speed(FakeAxis)
    assert [round(float(log.effort.mean())) for log in running] == [98, 97, 96, 95, 94, 93, 92, 91]
    assert running[-1].rate.mean() == pytest.approx(110.0)  # at 90 it stays put
    assert len(running) < TRIALS
