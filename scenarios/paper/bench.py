"""What an experiment needs: an axis that takes commands and leaves logs. The emulator is one, the compiled
loop another."""

from typing import Protocol

from scenarios.paper.log import Log


class Bench(Protocol):
    """One axis with its controller, powered, at rest at the start. Time goes on from run to run."""

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point, arcsec/s, for `seconds`."""
        ...

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort, 1/3000 of the supply, for `seconds`."""
        ...


class BenchMaker(Protocol):
    """Makes a fresh bench: same plant, same seed, at rest."""

    def __call__(self, preload: str, gains: tuple[float, float] | None = None) -> Bench:
        """Return a bench with preload "low" or "high"; other gains (Kp, Ki) than the plant file's when
        given."""
        ...
