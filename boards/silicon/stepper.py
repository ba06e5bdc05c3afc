"""Half stepping of a bipolar motor by a dual H-bridge: eight states of two coils (KM062, paper, 3.2)."""

from collections.abc import Callable

HALF_STEPS: tuple[tuple[int, int], ...] = (
    (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1),
)  # fmt: skip
"""Current direction of coils A and B in each phase; one row on is +0.9° of the motor."""


class StepperDriver:
    """coils: the bridge's outputs, (t_ns, phase 0..7, energised, hold)."""

    def __init__(self, coils: Callable[[int, int, bool, bool], None]) -> None:
        self.coils = coils
        self.phase = 0
        self.energised = False
        self.hold = False

    def step(self, t_ns: int, direction: int) -> None:
        """One half step, full current."""
        self.phase = (self.phase + direction) % len(HALF_STEPS)
        self.energised = True
        self.hold = False
        self.coils(t_ns, self.phase, True, False)

    def rest(self, t_ns: int) -> None:
        """Hold: the coils short through the free-wheeling diodes, no supply current."""
        self.energised = False
        self.hold = True
        self.coils(t_ns, self.phase, False, True)

    def release(self, t_ns: int) -> None:
        """Free: control power off, nothing holds the shaft."""
        self.energised = False
        self.hold = False
        self.coils(t_ns, self.phase, False, False)
