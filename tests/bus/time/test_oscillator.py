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


@pytest.mark.parametrize(("ppm", "drift"), [(10_000.0, 10.0), (-10_000.0, -10.0)])
def test_a_crystal_at_the_very_limit_is_one(ppm: float, drift: float) -> None:
    oscillator = Oscillator(ppm, 0, drift)
    assert oscillator.ppm == pytest.approx(ppm, abs=1e-8)


def test_a_refusal_names_the_limit() -> None:
    with pytest.raises(OscillatorError, match=r"20000\.0 ppm is outside ±10000 ppm"):
        Oscillator(20_000.0, 0)
    with pytest.raises(OscillatorError, match=r"drift -10\.5 ppm/h, limit ±10 ppm/h"):
        Oscillator(0.0, 0, -10.5)


@given(oscillators, times, st.integers(-300, 300))
def test_a_crystal_that_is_pulled_goes_on_from_where_it_is(
    oscillator: Oscillator, t_ns: int, ppm: int
) -> None:
    before, plain = oscillator.local_ns(t_ns), oscillator.ppm
    later_ns = t_ns + 1_000_000_000
    unpulled = oscillator.local_ns(later_ns)
    oscillator.pull(t_ns, ppm)
    assert oscillator.local_ns(t_ns) == before
    assert oscillator.ppm == pytest.approx(plain + ppm, abs=1e-6)
    assert oscillator.local_ns(later_ns) - unpulled == pytest.approx(ppm * 1_000, abs=2)  # 1 ppm of a second
    oscillator.pull(later_ns, -ppm)
    assert oscillator.ppm == plain


def test_nobody_pulls_a_crystal_beyond_its_limit() -> None:
    oscillator = Oscillator(9_000.0, 0)
    oscillator.pull(0, 999.9)
    for ppm in (0.2, -20_000.0):
        with pytest.raises(OscillatorError):
            oscillator.pull(0, ppm)
    assert oscillator.ppm == pytest.approx(9_999.9, abs=1e-6)
    with pytest.raises(OscillatorError, match=r"pulled by 5\.0 ppm, outside ±10000 ppm"):
        oscillator.pull(0, 5.0)
    oscillator.pull(0, -19_999.8)
    assert oscillator.ppm == pytest.approx(-9_999.9, abs=1e-6)


def test_a_crystal_without_a_drift_has_none() -> None:
    assert Oscillator(0.0, 5).local_ns(NIGHT_NS) == NIGHT_NS + 5
    assert Oscillator(0.0, 5).true_ns(NIGHT_NS + 5) == NIGHT_NS
    assert Oscillator(0.0, 0, 10.0).local_ns(NIGHT_NS) - NIGHT_NS == pytest.approx(1_800_000_000, abs=2)


@pytest.mark.parametrize("ppm", [0.0, 10_000.0, -10_000.0])
@pytest.mark.parametrize("drift", [10.0, -10.0, 0.001])
def test_a_crystal_that_drifts_still_fires_at_the_first_nanosecond(ppm: float, drift: float) -> None:
    """A night's ageing of 10 ppm/h moves a fire by 1.8 s; the rate's per cent slows Newton down."""
    crystal = Oscillator(ppm, 0, drift)
    for local_ns in range(-NIGHT_NS, NIGHT_NS, NIGHT_NS // 40 + 1):
        true = crystal.true_ns(local_ns)
        assert crystal.local_ns(true) >= local_ns > crystal.local_ns(true - 1)
