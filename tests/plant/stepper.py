"""The focus motor with its currents, inertia and load: steps are lost when the load is more than it can hold.

Two-phase hybrid motor (K: any text on stepping motors). Electrical angle e = 50 x mechanical angle; one
electrical turn is eight half steps.

    L di/dt = v - R i - emf;       emf_a = -K w sin e,  emf_b = K w cos e;

    torque  = K (i_b cos e - i_a sin e);
    J dw/dt = torque - load - friction sign(w) - damping w.

`FocusPort` (kinematic) is what the night runs on. `MotorFocusPort` is its reference: it has the same pins and
gives the same positions once the rotor is at rest.
"""

from dataclasses import dataclass
from math import cos, pi, sin, sqrt, tanh

from plant.focus import PHASES, FocusPort
from plant.parts import FocusModel

_STEP_NS = 20_000
"""Of the integration: a hundredth of the electrical time constant."""
_COILS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Sign of the voltage on coils a and b in each phase."""
_HALF_STEP_RAD = 2.0 * pi / PHASES
"""Electrical."""
_SLOW_RAD_S = 0.05
"""Mechanical; friction turns around within this, and below a tenth of it the rotor may stick."""
_STILL = 1e-6
"""Relative change of the currents below which they have settled."""


@dataclass(frozen=True, slots=True)
class Motor:
    """KM062, hardware.md 1.3: 4 V and 1.2 A a coil. The rest are ASSUMPTIONS for a motor of its size."""

    resistance: float = 4.0 / 1.2
    """Ohm, from 4 V and 1.2 A."""
    inductance: float = 5e-3
    """H, bounds 2 to 15 mH (hardware.md 1.3)."""
    voltage: float = 4.0
    """V."""
    teeth: int = 50
    """1.8 deg a full step."""
    torque_constant: float = 0.41
    """N m/A: 0.7 N m held with both coils at 1.2 A. ASSUMPTION."""
    inertia: float = 2.4e-5
    """kg m2, rotor and as much of belt and screw. ASSUMPTION."""
    friction: float = 0.02
    """N m, Coulomb. ASSUMPTION."""
    damping: float = 4e-3
    """N m s/rad, belt and screw. ASSUMPTION."""

    @property
    def holding(self) -> float:
        """Torque with both coils on, N m: sqrt 2 times that of one."""
        return sqrt(2.0) * self.torque_constant * self.voltage / self.resistance


MOTOR = Motor()
"""The one of the focus."""


class Stepper:
    """One motor. half_steps: where the rotor is at the start. load: torque against positive motion, N m; it
    cannot turn an unpowered motor (a ball screw with friction holds).

    State is plain numbers, brought forward by `advance(t_ns)` on a fixed grid.
    """

    def __init__(self, motor: Motor, half_steps: float, load: float = 0.0) -> None:
        self.motor = motor
        self.load = load
        self.angle = half_steps * _HALF_STEP_RAD
        """Electrical, rad."""
        self.rate = 0.0
        """Mechanical, rad/s."""
        self.current_a = self.current_b = 0.0
        self.phase = 0
        self.driven = False
        self.shorted = False
        self.now_ns = 0
        self.resting = True

    def drive(self, t_ns: int, phase: int, energised: bool, shorted: bool) -> None:
        """The bridges' outputs from `t_ns` on."""
        self.advance(t_ns)
        self.phase, self.driven, self.shorted = phase, energised, shorted
        if not energised and not shorted:
            self.current_a = self.current_b = 0.0  # open: the diodes empty the coils at once
        self.resting = False

    @property
    def half_steps(self) -> float:
        """Where the rotor is."""
        return self.angle / _HALF_STEP_RAD

    def advance(self, t_ns: int) -> None:
        """Bring the state to `t_ns`; a motor at rest costs nothing."""
        while self.now_ns + _STEP_NS <= t_ns:
            if self.resting:
                self.now_ns += (t_ns - self.now_ns) // _STEP_NS * _STEP_NS
                return
            self._step(_STEP_NS * 1e-9)
            self.now_ns += _STEP_NS

    def _step(self, dt: float) -> None:
        """Semi-implicit: currents, rate, angle."""
        motor = self.motor
        change = self._currents(dt)
        torque = motor.torque_constant * (self.current_b * cos(self.angle) - self.current_a * sin(self.angle))
        if not self.driven:
            torque += self.load  # what the screw's friction takes
        push = torque - self.load
        stuck = abs(self.rate) < 0.1 * _SLOW_RAD_S and abs(push) <= motor.friction
        if stuck:
            self.rate = 0.0
        else:
            drag = motor.friction * tanh(self.rate / _SLOW_RAD_S)
            self.rate += (push - drag) / motor.inertia * dt
            self.rate /= 1.0 + motor.damping / motor.inertia * dt
            self.angle += motor.teeth * self.rate * dt
        self.resting = stuck and change < _STILL

    def _currents(self, dt: float) -> float:
        """Both coils; returns the larger change relative to the rated current."""
        motor = self.motor
        if not self.driven and not self.shorted:
            return 0.0
        signs = _COILS[self.phase] if self.driven else (0, 0)
        emf = motor.torque_constant * self.rate
        share = dt / motor.inductance
        keep = 1.0 / (1.0 + motor.resistance * share)
        a = (self.current_a + share * (signs[0] * motor.voltage + emf * sin(self.angle))) * keep
        b = (self.current_b + share * (signs[1] * motor.voltage - emf * cos(self.angle))) * keep
        change = max(abs(a - self.current_a), abs(b - self.current_b))
        self.current_a, self.current_b = a, b
        return change * motor.resistance / motor.voltage


class MotorFocusPort(FocusPort):
    """The focus with this motor behind the same pins. load: N m, as `Stepper`'s."""

    def __init__(
        self, model: FocusModel, start_steps: float = 0.0, motor: Motor | None = None, load: float = 0.0
    ) -> None:
        super().__init__(model, start_steps)
        self.motor = Stepper(motor or MOTOR, start_steps, load)

    def coils(self, t_ns: int, phase: int, energised: bool, hold: bool) -> None:
        """Set the coils, as `FocusPort.coils`."""
        self.motor.drive(t_ns, phase, energised, hold)

    def position(self, t_ns: int) -> float:
        """Return the true position, half steps; the carriage stops at the ends of its travel."""
        motor = self.motor
        motor.advance(t_ns)
        at = motor.half_steps
        if abs(at) > self._limit:
            at = self._limit if at > 0 else -self._limit
            motor.angle, motor.rate = at * _HALF_STEP_RAD, 0.0
        return at
