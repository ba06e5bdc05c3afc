"""Words of the `unknown` effect: where it acts, and the signal it depends on."""

from plant.effects import signals as sig
from plant.effects.signals import Hook

TARGETS: dict[str, Hook] = {
    "torque": Hook.AXIS_TORQUE,  # N m at the axis
    "motor_torque": Hook.MOTOR_TORQUE,  # N m at each motor
    "voltage": Hook.SUPPLY,  # V
    "resistance": Hook.RESISTANCE,  # ohm, of each winding
    "transmission": Hook.TRANSMISSION,  # rad at the axis, twist of both trains
    "command": Hook.COMMAND,  # duty of each motor
    "incremental": Hook.INCREMENTAL,  # rad
    "absolute": Hook.ABSOLUTE,  # rad
    "auxiliary": Hook.AUXILIARY,  # rad
    "current": Hook.CURRENT,  # A, of each reading
}

DOMAINS: dict[str, int] = {
    "axis_angle": sig.ANGLE,
    "motor_angle": sig.MOTOR_ANGLE,
    "time": sig.TIME,
    "velocity": sig.RATE,
    "reversal": sig.REVERSAL,
    "current": sig.CURRENT,
    "command": sig.COMMAND,
    "temperature": sig.TEMPERATURE,
    "torque": sig.TORQUE,
    "acceleration": sig.ACCELERATION,
}
