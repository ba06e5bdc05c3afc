"""What an arm may hide: its weight, its cable, its friction, its loop, and things without a name."""

from collections.abc import Callable
from dataclasses import dataclass, field

from tests.blind.world.arm import Arm
from tests.blind.world.made import TURN, Hidden, Rng, pick

LINES = ("gear_eccentricity", "gear_mesh", "motor_cogging", "torque_ripple")


@dataclass
class Effect:
    """scaled: values of the kernel that go with the size; fixed: that do not. most: largest size there is.

    law: the weight is declared, and estimated (the rig file's `gravity`).
    """

    hidden: Hidden
    scaled: dict[str, float]
    fixed: dict[str, float] = field(default_factory=dict)
    most: float = 1e9
    weight: bool = True

    def values(self, size: float) -> dict[str, float]:
        return {**self.fixed, **{k: v * size for k, v in self.scaled.items()}}


def gravity(rng: Rng, a: Arm, weight: float) -> Effect:
    """The weight, which the rig file does not tell of."""
    hidden = Hidden("gravity_imbalance", "T", ("axis_angle",))
    return Effect(hidden, {"GRAV": weight}, {"GRAV_P": float(rng.uniform(-0.6, 0.6))}, 1.6, weight=False)


def cable(rng: Rng, a: Arm, weight: float) -> Effect:
    """A bundle of wires that pulls to where it hangs straight."""
    hidden = Hidden("cable_wrap", "T", ("axis_angle",))
    return Effect(hidden, {"CABLE": 0.1 * weight / a.stroke}, {"CABLE_C": a.centre}, 15.0)


def uneven(rng: Rng, a: Arm, weight: float) -> Effect:
    """Coulomb friction in one to three waves over the stroke."""
    waves = {"POSF_K": TURN * rng.uniform(1.2, 3.0) / a.stroke, "POSF_P": rng.uniform(0, TURN)}
    return Effect(
        Hidden("position_friction", "T", ("axis_angle",)), {"POSF": 0.1 * a.values["COUL"]}, waves, 9.0
    )


def load(rng: Rng, a: Arm, weight: float) -> Effect:
    """Teeth that rub with the torque through them."""
    alike = ("coulomb_change",)
    return Effect(Hidden("load_friction", "T", ("current",), alike), {"LOADF": 0.05}, {}, 7.0)


def drag(rng: Rng, a: Arm, weight: float) -> Effect:
    """A brake that rubs from some time of every file on."""
    hidden = Hidden("brake_drag", "T", ("time",), ("preload_change",))
    return Effect(hidden, {"DRAG": 0.1 * a.values["COUL"]}, {"DRAG_T": rng.uniform(0.25, 0.6)})


def warm(rng: Rng, a: Arm, weight: float) -> Effect:
    """Friction that falls as grease warms, over all files together."""
    total = a.files * a.seconds
    hidden = Hidden("friction_warmup", "T", ("time",), ("preload_change",))
    return Effect(hidden, {"WARM": 0.2 * a.values["COUL"]}, {"WARM_TAU": total * rng.uniform(0.15, 0.4)})


def upset(rng: Rng, a: Arm, weight: float) -> Effect:
    """A fixed frequency behind the logged effort."""
    hidden = Hidden("command_disturbance", "T", ("time", "command"))
    return Effect(hidden, {"UPSET": 0.01 * a.values["TOP"]}, {"UPSET_F": rng.uniform(0.8, 5.0)}, 20.0)


def wave(rng: Rng, a: Arm, weight: float) -> Effect:
    """The wave generator of a strain wave gear: twice per motor turn (Tuttle, Seering 1996), or its turn."""
    order = a.gear * pick(rng, 1.0, 2.0)
    hidden = Hidden("gear_eccentricity", "T", ("axis_angle", "motor_angle"), LINES[1:], stage="motor")
    return Effect(hidden, {"LINE": 0.1 * a.values["COUL"]}, {"LINE_K": order, "LINE_P": rng.uniform(0, TURN)})


def coupled(rng: Rng, a: Arm, weight: float) -> Effect:
    """The other joint's acceleration, of which the log has nothing."""
    return Effect(Hidden("outside_coupling", "T", ("time",)), {"COUPLING": 0.3 * a.values["INERTIA"]})


def stop(rng: Rng, a: Arm, weight: float) -> Effect:
    """A rubber stop that begins within the stroke."""
    place = {"STOP_X": a.centre + 0.1 * a.stroke}
    return Effect(Hidden("outside_stop", "T", ("axis_angle",)), {"STOP": weight / a.stroke**2}, place)


def bend(rng: Rng, a: Arm, weight: float) -> Effect:
    """Torque that falls behind its effort, as iron saturates."""
    return Effect(Hidden("outside_saturation", "T", ("current", "command")), {"BEND": 0.1}, {}, 6.0)


Draw = Callable[[Rng, Arm, float], Effect]
WHERE: dict[str, Draw] = {
    "gravity_imbalance": gravity, "cable_wrap": cable, "position_friction": uneven, "load_friction": load,
    "brake_drag": drag, "friction_warmup": warm, "command_disturbance": upset, "gear_eccentricity": wave,
    "outside_coupling": coupled, "outside_stop": stop, "outside_saturation": bend,
}  # fmt: skip
