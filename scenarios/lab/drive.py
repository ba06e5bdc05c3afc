"""Commissioning: what the axis boards are set to for a plant's drive."""

from math import pi

from boards.axis.config import TICK_NS, AxisConfig
from bus.protocol.scales import COUNTS_PER_TURN
from plant.deadzone import step_torque
from plant.gears import RATIO
from plant.parts import AxisModel, PlantModel
from plant.plant import Plant

_FRAME_BITS = 120
"""Bits of a full frame with some stuffing, for the age of measurements (111 to 135, hardware.md 3.3)."""
POINTING_BANDWIDTH = 22.0
"""rad/s, of the velocity loop inside the position loop, at least. ASSUMPTION: a sixth of the mode of the
rotors against the axis (about 130 rad/s, 5 % damped). Otherwise 10 ms of delay would drive that mode."""
_POINTING_KI = 0.08  # Ki/Kp while the axis slides: 16 rad/s. ASSUMPTION.
_CREEP_KI = {"ra": 0.1, "dec": 0.2}
"""Ki/Kp while it creeps: 20 and 40 rad/s. ASSUMPTION: on the axis that tracks, more of it hunts between two
PWM steps. Declination stands, and its effort has the dead zone of the power stage to cross."""
_GUST_BANDWIDTH = 33.0  # rad/s, while it creeps in wind, at least. ASSUMPTION: a quarter of that mode.
_GUST_KI = 0.05
"""Ki/Kp then: 10 rad/s. ASSUMPTION: with less of it the axis swings less between 1 and 8 Hz, where wind is. A
slow torque then leaves twice as much, so these gains are for wind alone."""


def _bandwidth(axis: AxisModel) -> float:
    """rad/s, of that loop: where the trains damp well it may be as fast as the rotors' swing dies away."""
    rotor = axis.motor.rotor_inertia.si * RATIO**2
    return max(POINTING_BANDWIDTH, 0.5 * axis.gear.damping.si / (2.0 * rotor))


def _unit_gain(model: PlantModel, axis: AxisModel) -> float:
    """PWM steps that accelerate the axis by 1 count/5 ms in a second. Behind a power stage the lagging motor
    hardly conducts where the axis is slow."""
    lagging = 0.0 if axis.motor.diode_drop else model.controller.counter_split.si
    torque_per_step = step_torque(model, axis.motor) * (1.0 - lagging)
    counts_per_rad_s = COUNTS_PER_TURN / (2 * pi) * TICK_NS * 1e-9
    inertia = axis.inertia.si + 2 * axis.motor.rotor_inertia.si * RATIO**2  # load and both rotors, kg m2
    return inertia / (torque_per_step * counts_per_rad_s)


def axis_config(plant: Plant, axis: str, limits: tuple[int, int], bitrate: int) -> AxisConfig:
    """Settings of an axis board that follow from the plant's drive: gains, split, PWM.

    The file's Kp and Ki are those of the RA axis; the other axis gets them scaled by its inertia.
    """
    model = plant.model
    controller = model.controller
    part: AxisModel = getattr(model.axes, axis)
    scale = _unit_gain(model, part) / _unit_gain(model, model.axes.ra)
    pointing = _bandwidth(part) * _unit_gain(model, part)
    gust = max(_GUST_BANDWIDTH, _bandwidth(part)) * _unit_gain(model, part)
    return AxisConfig(
        kp=controller.kp.si * scale,
        ki=controller.ki.si * scale,
        kp_pointing=pointing,
        ki_pointing=pointing * _POINTING_KI,
        ki_creep=pointing * _CREEP_KI[axis],
        kp_gust=gust,
        ki_gust=gust * _GUST_KI,
        counter_split=round(controller.counter_split.si * 100),
        pwm_steps=round(controller.pwm_steps.si),
        pwm_hz=round(controller.pwm_frequency.si),
        low=limits[0],
        high=limits[1],
        frame_ns=_FRAME_BITS * round(1e9 / bitrate),
    )
