"""Guiding by exposures: how long a pulse is, where the star is looked for, and what is told of each."""

from collections.abc import Iterator
from math import cos, radians
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.units import ARCSEC_PER_RAD
from host.client import TICK_NS
from host.procedures.autoguide import Guided, Guiding, _exposures, _pulse_s
from host.sky.tracks import GUIDE_ARCSEC_S, RAMP_S, Pulse

HALF = 15.041067 / 2
"""arcsec/s: half the sidereal rate."""


@pytest.mark.parametrize(
    ("off", "share", "seconds"),
    [
        (0.19, 1.0, 0.0), (-0.19, 1.0, 0.0), (0.2, 1.0, 0.027), (3.0, 1.0, 0.399), (-3.0, 0.5, -0.199),
        (18.0, 1.0, 2.393), (30.0, 1.0, 2.5), (-30.0, 1.0, -2.5), (30.0, 0.5, 1.995),
    ],
)  # fmt: skip
def test_a_pulse_takes_out_a_share_of_what_is_seen_and_is_bounded(
    off: float, share: float, seconds: float
) -> None:
    """Share times the error over the speed, in whole ms, 2.5 s at most; nothing below 0.2 arcsec."""
    assert _pulse_s(off, share, HALF) == pytest.approx(seconds, abs=1e-9)


@pytest.mark.parametrize("seconds", [0.1, 0.3, 2.0])
def test_a_pulse_makes_its_way_with_ramps(seconds: float) -> None:
    """In all rate times length; half of it in the middle; nothing before, and it stays behind its end."""
    pulse = Pulse(0, 7.5, 10.0, seconds)
    assert pulse.end_s == pytest.approx(10.0 + seconds + 0.3)
    assert pulse.arcsec(9.0) == pulse.arcsec(10.0) == 0.0
    assert pulse.arcsec(10.0 + (seconds + 0.3) / 2) == pytest.approx(7.5 * seconds / 2)
    assert pulse.arcsec(pulse.end_s) == pulse.arcsec(99.0) == pytest.approx(7.5 * seconds)
    least = min(seconds, 0.3)
    assert pulse.arcsec(10.0 + least) == pytest.approx(7.5 * least**2 / (2 * 0.3))


class Clock:
    """A client that only waits: whole ticks of its own time pass."""

    def __init__(self) -> None:
        self.now_ns = 0

    @property
    def now_s(self) -> float:
        return self.now_ns * 1e-9

    def wait(self, seconds: float) -> Iterator[None]:
        end_ns = self.now_ns + round(seconds * 1e9)
        while self.now_ns < end_ns:
            yield
            self.now_ns += TICK_NS


def guided(places: list[tuple[float, float]], declination: float, share: float) -> Any:
    """Exposures of 2 s with the star at these places, arcsec of hour angle and declination."""
    client: Any = Clock()
    looked, told, made = list[int](), list[Guided](), ([], [])
    tracks: Any = tuple(Some(star=Some(declination_rad=declination), guide=each.append) for each in made)

    def eye(_star: Any, t_ns: int) -> tuple[float, float]:
        looked.append(t_ns)
        return tuple(x / ARCSEC_PER_RAD for x in places[len(looked) - 1])  # type: ignore[return-value]

    how = Guiding(seconds=0.0, exposure_s=2.0, aggressiveness=share, by_rate=False)
    run = _exposures(client, tracks, eye, how, told.append)
    while len(told) < len(places):
        next(run)
    return looked, told, made


def test_the_star_is_looked_at_in_the_middle_and_led_back_to_its_first_place() -> None:
    declination, ha, dec = radians(60.0), 4.0, -3.0
    looked, told, made = guided([(10.0, 20.0), (10.0 + ha, 20.0 + dec), (10.0, 20.0)], declination, 0.7)
    assert looked[0] * 1e-9 == pytest.approx(1.0, abs=1.5 * TICK_NS * 1e-9)
    west = ha * cos(declination)  # on the sky
    assert told[0].off == (0.0, 0.0) and told[0].pulses_s == (0.0, 0.0)
    assert told[1].off == pytest.approx((west, dec))
    assert told[1].pulses_s == pytest.approx((0.7 * ha / HALF, 0.7 * dec / HALF), abs=5e-4)
    assert told[1].sent == pytest.approx((0.7 * west, 0.7 * dec), abs=5e-3)
    assert [t.t_s for t in told[:2]] == pytest.approx([2.0, 4.0], abs=3 * TICK_NS * 1e-9)
    longest = max(abs(each) for each in told[1].pulses_s)
    assert told[2].t_s - told[1].t_s == pytest.approx(2.0 + longest + RAMP_S, abs=4 * TICK_NS * 1e-9)
    for axis, sign in ((0, 1), (1, -1)):
        (pulse,) = made[axis]
        assert pulse.axis == axis and pulse.arcsec_s == sign * GUIDE_ARCSEC_S == pytest.approx(sign * HALF)
        assert pulse.begin_s == told[1].t_s and pulse.seconds == abs(told[1].pulses_s[axis])


def test_an_axis_that_is_on_its_place_gets_no_pulse() -> None:
    _, told, made = guided([(0.0, 0.0), (0.0, 2.0)], 0.0, 1.0)
    assert told[1].pulses_s == pytest.approx((0.0, 2.0 / HALF), abs=5e-4)
    assert made[0] == [] and len(made[1]) == 1
