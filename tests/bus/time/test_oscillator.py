from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.time import Oscillator
from bus.time.oscillator import OscillatorError

NIGHT_NS = 36_000_000_000_000
oscillators = st.builds(
    Oscillator,
    st.floats(-500, 500),
    st.integers(-1_000_000_000, 1_000_000_000),
    st.sampled_from([0.0, 0.001, -0.001, 0.5, -0.5, 3.0]),
)
times = st.integers(0, NIGHT_NS)


@given(oscillators, times, st.integers(0, 1_000_000))
def test_both_directions_are_monotone(oscillator: Oscillator, t_ns: int, later: int) -> None:
    assert oscillator.local_ns(t_ns) <= oscillator.local_ns(t_ns + later)
    assert oscillator.true_ns(t_ns) <= oscillator.true_ns(t_ns + later)


@given(oscillators, times)
def test_a_timer_fires_at_the_first_nanosecond_that_reaches_it(oscillator: Oscillator, local_ns: int) -> None:
    true = oscillator.true_ns(local_ns)
    assert oscillator.local_ns(true) >= local_ns > oscillator.local_ns(true - 1)


@given(st.integers(-500, 500), st.integers(0, 10**9), times, st.sampled_from([0, 1, -1]))
def test_the_rate_is_what_it_says(ppm: int, phase: int, t_ns: int, drift: int) -> None:
    hour = 3_600_000_000_000
    exact = phase + t_ns * (1 + Fraction(ppm, 10**6)) + Fraction(drift, 10**6) * t_ns**2 / (2 * hour)
    # ppm is kept to 1e-9 ppm: 36 ns in ten hours would be 1e-6 ppm.
    assert abs(Oscillator(ppm, phase, drift).local_ns(t_ns) - exact) <= 2


@pytest.mark.parametrize(("ppm", "drift"), [(20_000.0, 0.0), (float("nan"), 0.0), (0.0, 11.0)])
def test_a_crystal_no_board_has_is_refused(ppm: float, drift: float) -> None:
    with pytest.raises(OscillatorError, match="oscillator"):
        Oscillator(ppm, 0, drift)
