"""What an experiment needs: an axis that takes commands and leaves logs. The emulator is one, the compiled
loop another."""

from typing import Protocol

from scenarios.studies.paper.log import Log


class Bench(Protocol):
    """One axis with its controller, powered, at rest at the start. Time goes on from run to run."""

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point, arcsec/s, for `seconds`."""
        ...

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort, 1/3000 of the supply, for `seconds`."""
        ...
