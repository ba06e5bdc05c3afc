"""What is hidden in a drive: names of the catalogue and, below, things that it does not have."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from tests.blind.drives.families import Family

Rng = np.random.Generator
TURN = 2.0 * math.pi


@dataclass
class Hidden:
    """One effect: values that scale with its size, values that do not, and what counts as its name.

    how: "measured" (size set by its own force over the effort's noise), "given" (the ratio is in the values).
    sensor: values that the log's columns get (sensors.py) instead of the plant. powers: of the size, that a
    scaled value goes with, if not 1. most: size beyond which no such drive is published, or possible.
    """

    name: str
    channel: str
    domain: tuple[str, ...]
    scaled: dict[str, float] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    sensor: dict[str, float] = field(default_factory=dict)
    alike: tuple[str, ...] = ()
    how: str = "measured"
    second: bool = False  # needs the second position column
    law: bool = False  # needs the reference's column and the declared controller
    powers: dict[str, float] = field(default_factory=dict)
    most: float = math.inf
    least: float = 0.0  # size below which it is none: a sound drive shows as much
    size: float = 1.0

    def values(self) -> dict[str, float]:
        """The kernel's values at the present size."""
        return {**self.fixed, **{k: v * self.size ** self.powers.get(k, 1.0) for k, v in self.scaled.items()}}


SOFTEST = 4.0  # Hz, lowest resonance of a carriage on a long belt
LATEST = 0.05  # s, three turns of a USB adapter's latency timer of 16 ms
Draw = Callable[[Rng, Family, dict[str, float], float, float], Hidden]  # .., plant, turn, ratio


def position_friction(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Coulomb friction in two to five waves over the travel."""
    waves = {"POSF_K": rng.uniform(2.0, 5.0) * TURN / f.travel[1], "POSF_P": rng.uniform(0, TURN)}
    passive = 0.9 / 0.02  # of the Coulomb friction: more would drive the axis where it is weakest
    return Hidden(
        "position_friction", "T", ("axis_angle",), {"POSF": 0.02 * plant["COUL"]}, waves, most=passive
    )


def gravity_imbalance(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A mass off the axis of a rotary drive."""
    return Hidden(
        "gravity_imbalance", "T", ("axis_angle",),
        {"GRAV": 0.02 * plant["COUL"]}, {"GRAV_P": rng.uniform(0, TURN)},
        alike=("cable_wrap", "position_friction"),
    )  # fmt: skip


def gear_eccentricity(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A force once or twice per turn of the part that the maker tells."""
    values = {"LINE_K": float(rng.integers(1, 3)) * TURN / turn, "LINE_P": rng.uniform(0, TURN)}
    return Hidden(
        "gear_eccentricity", "T", ("axis_angle", "motor_angle"), {"LINE": 0.02 * plant["COUL"]}, values,
        alike=("gear_mesh", "motor_cogging", "torque_ripple"),
    )  # fmt: skip


def motor_cogging(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A reluctance torque, 12 to 44 per turn."""
    values = {
        "LINE_K": float(rng.choice([12, 18, 22, 24, 36, 44])) * TURN / turn,
        "LINE_P": rng.uniform(0, TURN),
    }
    return Hidden(
        "motor_cogging",
        "T",
        ("motor_angle",),
        {"LINE": 0.02 * plant["COUL"]},
        values,
        alike=("torque_ripple",),
    )


def bearing_pass(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A force at an order of no declared part."""
    values = {"LINE_K": rng.uniform(5.2, 5.8) * TURN / turn, "LINE_P": rng.uniform(0, TURN)}
    return Hidden(
        "bearing_pass", "T", ("axis_angle",), {"LINE": 0.02 * plant["COUL"]}, values, alike=("unknown",)
    )


def brake_drag(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """More Coulomb friction from some time of every run on."""
    return Hidden(
        "brake_drag", "T", ("time",), {"DRAG": 0.02 * plant["COUL"]}, {"DRAG_T": rng.uniform(0.25, 0.5)},
        alike=("preload_change", "friction_warmup"),
    )  # fmt: skip


def friction_warmup(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Friction that falls within the first part of every run."""
    return Hidden(
        "friction_warmup",
        "T",
        ("time",),
        {"WARM": 0.02 * plant["COUL"]},
        {"WARM_TAU": rng.uniform(0.15, 0.35)},
    )


def command_disturbance(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A sine or a square behind the logged effort."""
    values = {"UPSET_F": rng.uniform(0.7, 5.0), "UPSET_SQUARE": float(rng.random() < 0.5)}
    return Hidden("command_disturbance", "T", ("time", "command"), {"UPSET": 0.003 * plant["TOP"]}, values)


def structural_mode(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A second mass behind a spring; the declared model has one mass. The softer, the larger: what the spring
    adds to a rigid mass goes with the frequency squared."""
    second = plant["MASS"] * rng.uniform(0.2, 0.5)
    omega = TURN * rng.uniform(12.0, 30.0)
    return Hidden(
        "structural_mode", "T", ("time", "velocity"),
        {"STIFF": second * omega**2, "DAMP": 2 * 0.03 * second * omega}, {"MASS2": second},
        powers={"STIFF": -1.0, "DAMP": -0.5}, most=(omega / (TURN * SOFTEST)) ** 2,
    )  # fmt: skip


def presliding(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Bristles that give way over a visible travel."""
    travel = f.travel[1] * 0.004 * ratio
    return Hidden(
        "presliding",
        "T",
        ("reversal",),
        {},
        {"SIG0": plant["COUL"] / travel},
        alike=("stribeck_change", "play"),
        how="given",
    )


def stribeck_change(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Break-away well above Coulomb friction; the declared law has none."""
    values = {"STIC": plant["COUL"] * (1.0 + 0.3 * ratio), "VS": f.speed[0] * 0.4}
    return Hidden("stribeck_change", "T", ("velocity",), {}, values, how="given")


def channel_delay(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """The effort's column is late. Half a period is the hold of a sampled loop, which every log has."""
    late = f.period_s * rng.uniform(0.6, 1.2) * ratio
    return Hidden(
        "channel_delay", "S", ("clock",), {"LATE": late}, most=LATEST / late, least=0.8 * f.period_s / late
    )


def log_wrap(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """The position's counter has a bit less than the travel needs."""
    return Hidden("log_wrap", "S", ("clock", "axis_angle"), sensor={"WRAP": 1.0}, how="given")


def play(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """A gap before the second position sensor."""
    return Hidden(
        "play", "K", ("reversal", "velocity"), sensor={"GAP": 6.0 * ratio * f.step}, how="given", second=True
    )


def shaft_compliance(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Wind-up between the two position sensors, as the force."""
    return Hidden(
        "shaft_compliance", "K", ("current",), sensor={"WIND": 6.0 * ratio * f.step}, how="given", second=True
    )


def encoder_eccentricity(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """The second sensor sits off its centre: an error once per turn."""
    return Hidden(
        "encoder_eccentricity", "K", ("axis_angle",), how="given", second=True, alike=("gear_eccentricity",),
        sensor={"ECC": 4.0 * ratio * f.step, "ECC_K": TURN / turn, "ECC_P": rng.uniform(0, TURN)},
    )  # fmt: skip


# outside the catalogue
def preisach(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Hysteresis of six stops over a twentieth of the travel."""
    return Hidden(
        "outside_preisach", "T", ("reversal", "axis_angle"), {"PREISACH": 0.02 * plant["COUL"]},
        {"PREISACH_W": 0.05 * f.travel[1]},
    )  # fmt: skip


def sticking_brush(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """The motor loses part of its force over a sector of its turn, now and then."""
    return Hidden(
        "outside_brush",
        "T",
        ("axis_angle", "motor_angle", "time", "current"),
        {"BRUSH": 0.2},
        {"BRUSH_K": TURN / turn},
    )


def gain_scheduling(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Smaller gains below a speed that the drive often has; the rig file declares one set of them. Their
    size is an ASSUMPTION: by 0.3 at ratio 2, by 0.66 at ratio 5."""
    values = {"SCHEDULED": 0.06 + 0.12 * ratio, "SCHEDULED_V": rng.uniform(0.15, 0.4) * f.speed[0]}
    return Hidden("outside_scheduling", "U", ("command", "velocity"), {}, values, how="given", law=True)


def mains_beat(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """Mains picked up by the effort's column, folded by the sampling."""
    values = {"MAINS": 1.5 * ratio, "MAINS_F": rng.uniform(49.9, 50.1)}
    return Hidden(
        "outside_mains",
        "T",
        ("time", "clock", "command"),
        sensor=values,
        how="given",
        alike=("command_disturbance",),
    )


def thermal_bowing(rng: Rng, f: Family, plant: dict[str, float], turn: float, ratio: float) -> Hidden:
    """The second sensor bows away in proportion to the place, more and more with time."""
    return Hidden(
        "outside_bowing", "K", ("time", "axis_angle", "temperature"),
        sensor={"BOW": 6.0 * ratio * f.step}, how="given",
        second=True, alike=("encoder_thermal_drift",),
    )  # fmt: skip


ROTARY = ("servo", "table")
LINEAR = ("ball_screw", "belt")
WHERE: dict[Draw, tuple[str, ...]] = {
    position_friction: (*ROTARY, *LINEAR),
    gravity_imbalance: ROTARY,
    gear_eccentricity: LINEAR,
    motor_cogging: ("table",),
    bearing_pass: ("ball_screw", "table"),
    brake_drag: (*ROTARY, *LINEAR),
    friction_warmup: ("ball_screw", "table"),
    command_disturbance: (*ROTARY, *LINEAR),
    structural_mode: ("belt",),
    presliding: ("ball_screw", "servo"),
    stribeck_change: ("ball_screw", "table"),
    channel_delay: (*ROTARY, *LINEAR),
    log_wrap: ("ball_screw", "table"),
    play: ("servo", "belt"),
    shaft_compliance: ("belt", "table"),
    encoder_eccentricity: ROTARY,
}
OUTSIDE: dict[Draw, tuple[str, ...]] = {
    preisach: ("servo", "belt"),
    sticking_brush: ("servo", "ball_screw"),
    mains_beat: ("ball_screw", "table"),
    thermal_bowing: ("belt", "servo"),
    gain_scheduling: ("ball_screw", "table"),
}
"""`friction_asymmetry` is not drawn: beside a declared offset a constant force is no effect."""
