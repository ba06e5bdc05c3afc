"""Linear theory of rows E1 to E6 for many points at once: where in the space a search is worth its time.

Frequency responses of the axis (load, two trains, two motors, PI loop), quasi-static friction in open loop,
and the eigenvalues of the sampled loop with the bristle linearised at 15 arcsec/s. Approximations
throughout: it proposes, the compiled loop and the emulator dispose. Arrays have one entry per point; SI
units at the axis unless told.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.paper.log import Array
from scenarios.paper.published import INERTIA, TABLE_2
from scenarios.paper.scales import ARCSEC, CONTROL_PERIOD_S, COUNT_RATE, GEAR_RATIO
from scenarios.paper.statics import COUNTER, SUPPLY_V

Complex = NDArray[np.complex128]
Points = dict[str, Array]
STIFFNESS = 3.08e6
"""N m/rad, both trains (Table 1)."""
PWM_STEPS = 3000.0
TURN_ARCSEC = 1_296_000.0


@dataclass(frozen=True)
class Axis:
    """A batch of axes as linear theory needs them."""

    points: Points
    scale: float

    def table(self, preload: str, name: str) -> float:
        """Return a number of Table 2 in N m at the axis, under the reading of the torques."""
        return TABLE_2[preload][name] * (self.scale if name in ("coulomb", "stiction") else 1.0)

    @property
    def volt_torque(self) -> Array:
        """K N / R: N m at the axis per volt."""
        return self.points["torque_constant"] * GEAR_RATIO / self.points["resistance"]

    @property
    def damping(self) -> Array:
        """(K N)^2 / R, N m s/rad."""
        return self.volt_torque * self.points["torque_constant"] * GEAR_RATIO

    @property
    def rotor(self) -> Array:
        """Rotor inertia at the axis, kg m2."""
        return self.points["rotor_inertia"] * GEAR_RATIO**2

    def slope(self, preload: str, rate: float | Array) -> Array:
        """Return how steeply sliding friction falls at a rate, without the viscous part, N m s/rad."""
        vs = self.table(preload, "stribeck_rate")
        drop = self.table(preload, "stiction") - self.table(preload, "coulomb")
        delta = self.points["exponent"]
        x = (rate / vs) ** delta
        return np.asarray(drop * delta / rate * x * np.exp(-x), dtype=np.float64)

    def sliding(self, preload: str, rate: float) -> Array:
        """Return the bristles' torque in steady sliding, N m."""
        x = (rate / self.table(preload, "stribeck_rate")) ** self.points["exponent"]
        coulomb = self.table(preload, "coulomb")
        return np.asarray(
            coulomb + (self.table(preload, "stiction") - coulomb) * np.exp(-x), dtype=np.float64
        )

    def responses(self, frequency_hz: float, gains: tuple[Array, Array], rate: float) -> tuple[Array, Array]:
        """Return |rate per disturbance torque| in open and in closed loop at a frequency, low preload.

        rate: rad/s, at which the axis slides; its bristles follow with the time constant g / rate.
        """
        s = 2j * np.pi * frequency_hz
        p = self.points
        spring = STIFFNESS / 2.0 / s + p["gear_damping"]
        bristle = self.sliding("low", rate) / p["bristle_stiffness"] / rate
        slope = self.slope("low", rate) / (1.0 + s * bristle)
        coil = 1.0 / (1.0 + s * p["electrical_time"])
        lead = self.rotor * s + self.damping * coil
        lag = self.rotor * s
        lead_path, lag_path = lead * spring / (lead + spring), lag * spring / (lag + spring)
        load = (INERTIA - 2.0 * self.rotor) * s + self.table("low", "viscous") - slope
        compliance = 1.0 / (load + lead_path + lag_path)
        # effort to rate: the leading motor forward, the counter motor back
        drive = self.volt_torque * coil * compliance * (lead_path / lead - COUNTER * lag_path / lag)
        z = np.exp(s * CONTROL_PERIOD_S)
        hold = (1.0 - 1.0 / z) / (s * CONTROL_PERIOD_S)
        pi = gains[0] + gains[1] / (1.0 - 1.0 / z)
        loop = pi * hold * hold * drive * SUPPLY_V / PWM_STEPS / ARCSEC / COUNT_RATE
        return np.abs(compliance), np.abs(compliance / (1.0 + loop))


def responses_at(
    axis: Axis, order: float, gains: tuple[Array, Array], speeds: Sequence[float]
) -> tuple[Array, Array]:
    """Return (open, closed) responses to a torque of an order at speeds in arcsec/s, shape (speeds,
    points)."""
    pairs = [axis.responses(order_hz(order, v), gains, v * ARCSEC) for v in speeds]
    return np.stack([pair[0] for pair in pairs]), np.stack([pair[1] for pair in pairs])


def order_hz(order: float, arcsec_s: float) -> float:
    """Return the frequency of an order, cycles per axis turn, at a rate."""
    return order * arcsec_s / TURN_ARCSEC


def open_loop_room(axis: Axis, lowest: float) -> tuple[Array, Array]:
    """Return (disturbance torque, N m; fold, arcsec/s): what pushes the axis, running at `lowest` arcsec/s
    in open loop, just to the fold where friction falls faster than the motor's torque rises."""
    rates = np.linspace(8.0, lowest, 60) * ARCSEC
    rise = np.stack([axis.damping + axis.table("low", "viscous") - axis.slope("low", rate) for rate in rates])
    stable = np.flip(np.logical_and.accumulate(np.flip(rise > 0.0, 0), 0), 0)
    room = np.sum(np.where(stable, rise, 0.0), 0) * (rates[1] - rates[0])
    fold = np.where(stable.any(0), rates[np.argmax(stable, 0)] / ARCSEC, np.inf)
    return np.asarray(room, dtype=np.float64), np.asarray(fold, dtype=np.float64)


def rule_gains(axis: Axis) -> tuple[Array, Array]:
    """Return the tuning rule's (Kp, Ki) for equation (6), as tuning.py has them, for a batch."""
    p = axis.points
    inertia, viscous = INERTIA, axis.table("low", "viscous")
    a1 = 1.0 / p["electrical_time"] + viscous / inertia
    a0 = (viscous + axis.damping) / inertia / p["electrical_time"]
    root = np.sqrt(np.maximum(0.0, a1 * a1 / 4.0 - a0))
    real = a1 * a1 / 4.0 > a0
    slow = np.where(real, 1.0 / (a1 / 2.0 - root), 1.0 / np.sqrt(a0))
    fast = np.where(real, 1.0 / (a1 / 2.0 + root), 1.0 / np.sqrt(a0))
    rate_per_step = axis.volt_torque / (axis.damping + viscous) * SUPPLY_V * (1.0 - COUNTER) / PWM_STEPS
    gain = rate_per_step / ARCSEC / COUNT_RATE
    tau, theta = slow + fast / 2.0, CONTROL_PERIOD_S + fast / 2.0
    kp = tau / (gain * (p["closed_time"] + theta))
    return kp, kp * CONTROL_PERIOD_S / np.minimum(tau, 4.0 * (p["closed_time"] + theta))


def spectral_radius(axis: Axis, preload: str, gains: tuple[Array, Array], rate: float) -> Array:
    """Return the largest eigenvalue of the sampled loop at a steady rate, rad/s, the axis angle's own 1 left
    out."""
    from scipy.linalg import expm

    p = axis.points
    n = p["exponent"].size
    stiff = p["bristle_stiffness"] * (p["stiffness_ratio"] if preload == "high" else 1.0)
    passive = axis.table(preload, "viscous") * axis.table(preload, "coulomb")
    passive = passive / (axis.table(preload, "stiction") - axis.table(preload, "coulomb"))
    sigma1 = p["bristle_damping"] * passive
    g = axis.sliding(preload, rate) / stiff
    z_w = -axis.slope(preload, rate) / stiff * rate / g  # dz'/dw = |w| g'/g; g' < 0
    z_z = -rate / g
    load = INERTIA - 2.0 * axis.rotor
    k, c = STIFFNESS / 2.0, p["gear_damping"]
    current = p["torque_constant"] * GEAR_RATIO
    # states: w, z, (twist, rate) of A and B, currents of A and B; inputs: volts; twist = motor - axis
    a = np.zeros((n, 8, 8))
    b = np.zeros((n, 8, 1))
    a[:, 0, 0] = -(axis.table(preload, "viscous") + sigma1 * z_w + 2.0 * c) / load
    a[:, 0, 1] = -(stiff + sigma1 * z_z) / load
    a[:, 1, 0], a[:, 1, 1] = z_w, z_z
    for m, (twist, speed, coil, sign) in enumerate(((2, 3, 6, 1.0), (4, 5, 7, -1.0))):
        a[:, 0, twist], a[:, 0, speed] = k / load, c / load
        a[:, twist, speed], a[:, twist, 0] = 1.0, -1.0
        a[:, speed, twist], a[:, speed, speed], a[:, speed, 0] = (
            -k / axis.rotor,
            -c / axis.rotor,
            c / axis.rotor,
        )
        a[:, speed, coil] = sign * current / axis.rotor
        a[:, coil, coil] = -1.0 / p["electrical_time"]
        if m == 0:
            a[:, coil, speed] = -current / (p["resistance"] * p["electrical_time"])
        b[:, coil, 0] = (1.0 if m == 0 else COUNTER) / (p["resistance"] * p["electrical_time"])
    # travelled angle as a ninth state, input as a tenth: one exponential gives the sampled system
    big = np.zeros((n, 10, 10))
    big[:, :8, :8], big[:, :8, 9:] = a, b
    big[:, 8, 0] = 1.0
    step = expm(big * CONTROL_PERIOD_S)
    volt = SUPPLY_V / PWM_STEPS
    counts = 1.0 / ARCSEC / COUNT_RATE / CONTROL_PERIOD_S
    # sampled state: x (8), last travel in counts, its error before, effort in steps
    loop = np.zeros((n, 11, 11))
    kp, ki = gains
    loop[:, 10, 10] = 1.0
    loop[:, 10, 8], loop[:, 10, 9] = -(kp + ki), kp
    apply = loop[:, 10, :].copy()
    loop[:, :8, :8] = step[:, :8, :8]
    loop[:, :8, :] += step[:, :8, 9:] * volt * apply[:, None, :]
    loop[:, 8, :8] = step[:, 8, :8] * counts
    loop[:, 8, :] += step[:, 8, 9:] * volt * counts * apply
    loop[:, 9, 8] = 1.0
    return np.asarray(np.max(np.abs(np.linalg.eigvals(loop)), axis=1), dtype=np.float64)
