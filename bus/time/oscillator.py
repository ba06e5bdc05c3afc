"""A board's crystal: local time against true time, in integer arithmetic."""

from typing import Final

# Fixed point of the rate error: 2**-50 of a second per second, 1e-9 ppm. Ten hours then resolve to < 1 ns.
_SHIFT: Final = 50
_ONE: Final = 1 << _SHIFT
# The ageing term is 1000x smaller still, so it has its own, finer scale.
_DRIFT_SHIFT: Final = 100
_NS_PER_HOUR: Final = 3_600_000_000_000
# Beyond this it is a broken board, not a crystal (ceramic resonators reach 5000 ppm).
_LIMIT_PPM: Final = 10_000.0
_LIMIT_DRIFT_PPM_PER_HOUR: Final = 10.0


class OscillatorError(ValueError):
    """A rate error no oscillator has."""


class Oscillator:
    """Local clock of one board: `local = phase + true * (1 + ppm) + drift * true**2 / 2`.

    ppm: rate error at true time 0, parts per million (positive runs fast).
    phase_ns: what the local clock reads at true time 0.
    drift_ppm_per_hour: linear ageing or warming of the rate.
    Both directions are monotone, and `local_ns(true_ns(x)) >= x > local_ns(true_ns(x) - 1)`. So a timer that
    is set for a local time fires at the first true nanosecond at which the local clock has reached it.
    """

    def __init__(self, ppm: float, phase_ns: int, drift_ppm_per_hour: float = 0.0) -> None:
        if not abs(ppm) <= _LIMIT_PPM:
            raise OscillatorError(f"oscillator: {ppm} ppm is outside ±{_LIMIT_PPM:g} ppm")
        if not abs(drift_ppm_per_hour) <= _LIMIT_DRIFT_PPM_PER_HOUR:
            raise OscillatorError(
                f"oscillator: drift {drift_ppm_per_hour} ppm/h, limit ±{_LIMIT_DRIFT_PPM_PER_HOUR:g} ppm/h"
            )
        self.phase_ns = phase_ns
        self._rate = _ONE + round(ppm * 1e-6 * _ONE)
        self._drift = round(drift_ppm_per_hour * 1e-6 / (2 * _NS_PER_HOUR) * (1 << _DRIFT_SHIFT))

    @property
    def ppm(self) -> float:
        """Rate error at true time 0, parts per million."""
        return (self._rate - _ONE) * 1e6 / _ONE

    def pull(self, true_ns: int, ppm: float) -> None:
        """Let the rate be `ppm` more from `true_ns` on; the reading does not jump.

        `pull` by the negative takes the rate back exactly. Raises OscillatorError beyond the limit.
        """
        before = self.local_ns(true_ns)
        rate = self._rate + round(ppm * 1e-6 * _ONE)
        if not abs(rate - _ONE) <= _LIMIT_PPM * 1e-6 * _ONE:
            raise OscillatorError(f"oscillator: pulled by {ppm} ppm, outside ±{_LIMIT_PPM:g} ppm")
        self._rate = rate
        self.phase_ns += before - self.local_ns(true_ns)

    def local_ns(self, true_ns: int) -> int:
        """What the local clock reads at true time `true_ns`, ns (rounded down)."""
        if self._drift:
            ageing = true_ns * true_ns * self._drift >> (_DRIFT_SHIFT - _SHIFT)
            return self.phase_ns + (true_ns * self._rate + ageing >> _SHIFT)
        return self.phase_ns + (true_ns * self._rate >> _SHIFT)

    def true_ns(self, local_ns: int) -> int:
        """First true nanosecond at which the local clock reads `local_ns` or more."""
        span = local_ns - self.phase_ns
        true = -((-span << _SHIFT) // self._rate)
        if self._drift:
            true = self._refine(local_ns, true)
        return true

    def _refine(self, local_ns: int, guess: int) -> int:
        # Newton with the undrifted slope converges by a factor of 1e4 or more a step; the rest is counting.
        for _ in range(4):
            error = self.local_ns(guess) - local_ns
            if not error:
                break
            guess -= error
        else:
            while self.local_ns(guess) < local_ns:
                guess += 1
        while self.local_ns(guess - 1) >= local_ns:
            guess -= 1
        return guess
