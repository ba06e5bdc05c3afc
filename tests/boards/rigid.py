"""A rigid axis with smooth friction, the simplest thing the boards can move. Not the project's plant."""

import math

COUNTS_PER_RAD = 112_896_000 / (2 * math.pi)
STEPS_PER_RAD = (1 << 29) / (2 * math.pi)
GEAR = 360.48864
STEP_NS = 500_000


class RigidAxis:
    """Inertia 1760 kg m2, viscous 6700 N m s/rad, 229 N m of Coulomb friction; motors 0.39 N m/A, 2.2 ohm."""

    def __init__(self, start_steps: int = 1 << 28) -> None:
        self.start_steps = start_steps
        self.angle = 0.0
        self.rate = 0.0
        self.t_ns = 0
        self.duties = (0.0, 0.0)
        self.pending: list[tuple[int, float, float]] = []

    def drive(self, t_ns: int, duty_a: float, duty_b: float) -> None:
        self.pending.append((t_ns, duty_a, duty_b))

    def advance(self, t_ns: int) -> None:
        while self.t_ns + STEP_NS <= t_ns:
            while self.pending and self.pending[0][0] <= self.t_ns:
                _, a, b = self.pending.pop(0)
                self.duties = (a, b)
            dt = STEP_NS * 1e-9
            current = ((self.duties[0] - self.duties[1]) * 24.0 - 0.39 * self.rate * GEAR) / 2.2
            torque = 0.39 * current * GEAR - 229.0 * math.tanh(self.rate / 5e-5)
            self.rate = (self.rate + torque / 1760.0 * dt) / (1 + 6700.0 / 1760.0 * dt)
            self.angle += self.rate * dt
            self.t_ns += STEP_NS

    def incremental(self, t_ns: int) -> int:
        self.advance(t_ns)
        return math.floor((self.angle + self.rate * (t_ns - self.t_ns) * 1e-9) * COUNTS_PER_RAD)

    def absolute(self, t_ns: int) -> int:
        self.advance(t_ns)
        angle = self.angle + self.rate * (t_ns - self.t_ns) * 1e-9
        return (self.start_steps + math.floor(angle * STEPS_PER_RAD)) & 0x1FFFFFFF

    def tachometer(self, t_ns: int, _motor: int) -> int:
        self.advance(t_ns)
        angle = self.angle + self.rate * (t_ns - self.t_ns) * 1e-9
        return math.floor(angle * GEAR * 4096 / (2 * math.pi))

    def current(self, t_ns: int, motor: int) -> float:
        self.advance(t_ns)
        return self.duties[motor] * 24.0 / 2.2
