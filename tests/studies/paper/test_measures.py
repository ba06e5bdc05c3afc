import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.paper.measures import (
    cycles,
    line_amplitude,
    means,
    peak_percent,
    stalled,
    strongest_line,
)
from scenarios.studies.paper.scales import COUNT_RATE
from tests.studies.paper.synthetic import log_of

T = np.arange(0.0, 72.0, 0.01)


def test_peak_of_a_sine():
    rate = 100.0 + 7.0 * np.sin(2 * np.pi * 0.5 * T)
    assert peak_percent(rate, 100.0) == pytest.approx(7.0, rel=1e-4)


def test_E1_the_published_25_percent_is_one_and_a_half_counts():
    # hardware.md 2.1: the sequence 5..8 counts reads -23.5 % to +22.4 % at 15 arcsec/s
    counts = np.tile([5.0, 6.0, 7.0, 8.0], 500)
    assert peak_percent(counts * COUNT_RATE, 15.0) == pytest.approx(23.47, abs=0.05)
    assert peak_percent(means(counts * COUNT_RATE), 15.0) < 1.0


def test_quantised_steady_motion_is_no_limit_cycle():
    travel = np.floor(np.cumsum(np.full(4000, 15.0 / COUNT_RATE)))
    rate = np.diff(travel) * COUNT_RATE
    assert 5.0 < peak_percent(rate, 15.0) < 9.0
    assert cycles(rate, 15.0) == 0


def test_E2_stick_slip_is_counted_once_per_cycle():
    one = np.concatenate([np.zeros(300), np.full(100, 60.0)])
    assert cycles(np.tile(one, 7), 15.0) == 7


@given(st.floats(0.03, 0.18), st.floats(1.0, 30.0), st.floats(0.0, 6.2))
def test_E6_the_strongest_line_is_found(frequency, amplitude, phase):
    rate = 100.0 + amplitude * np.sin(2 * np.pi * frequency * T + phase) + 0.05 * T
    found = strongest_line(rate, 0.01, 0.2)
    # two periods and more, beside a trend that takes some of the sine with it: a third of the resolution
    assert found.frequency_hz == pytest.approx(frequency, abs=0.3 / 72.0)
    assert found.amplitude == pytest.approx(amplitude, rel=0.25)
    assert line_amplitude(rate, frequency) == pytest.approx(amplitude, rel=0.25)


def test_E6_a_slow_swing_is_not_mistaken_for_offset_and_trend():
    # a fit with offset and trend of its own finds any amplitude it likes at 0.7 periods per record
    rate = 100.0 + 5.0 * np.sin(2 * np.pi * 0.05 * T)
    assert strongest_line(rate, 0.01, 0.2).frequency_hz == pytest.approx(0.05, abs=0.002)


def test_a_record_too_short_for_a_line_is_an_error():
    with pytest.raises(ValueError, match="cannot show lines"):
        strongest_line(np.ones(100), 0.01, 0.2)
    assert strongest_line(np.ones(100), 0.9, 1.0).amplitude == pytest.approx(0.0, abs=1e-9)  # one period


def test_standing_still_for_a_second_is_a_stall():
    rate = np.full(500, 100.0)
    assert not stalled(rate)
    rate[200:300] = 0.0
    assert stalled(rate)


def test_means_leave_out_the_incomplete_window():
    assert means(np.arange(250.0)).tolist() == [49.5, 149.5]
    with pytest.raises(ValueError, match="fewer than one window"):
        means(np.ones(50))


def test_start_up_can_be_discarded_but_not_everything():
    log = log_of(np.arange(1000.0))
    assert log.after(4.0).rate[0] == pytest.approx(400.0)
    assert log.last(1.0).rate.size == 100
    with pytest.raises(ValueError, match="nothing after"):
        log.after(10.0)
