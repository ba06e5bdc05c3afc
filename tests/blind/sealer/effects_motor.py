"""Motors, supply and command: how each effect is drawn."""

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn

Rng = np.random.Generator
COGGING = (
    6,
    8,
    11,
    12,
    14,
    16,
    18,
    20,
    22,
    24,
    28,
    30,
    33,
    36,
)  # A: cycles per motor turn, none a mesh order


def motor_cogging(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Reluctance torque of motor A, with or without current."""
    n = int(rng.choice(COGGING))
    fixed = {"COG_N": float(n), "COG_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("COG_A", 1.0, "N m at the motor")}
    return Drawn(
        "motor_cogging",
        "T",
        ("motor_angle",),
        {"COG_A": 1.5 / d.GEAR_RATIO},
        fixed,
        names,
        "motor",
        n,
        n * d.GEAR_RATIO,
    )


def torque_ripple(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Torque constant of motor A waves with its angle."""
    n = int(rng.choice(COGGING))
    fixed = {"RIP_N": float(n), "RIP_PH": rng.uniform(0, d.TURN)}
    return Drawn(
        "torque_ripple",
        "T",
        ("motor_angle", "current"),
        {"RIP_A": 0.01},
        fixed,
        {"ripple": ("RIP_A", 1.0, "1")},
        "motor",
        n,
        n * d.GEAR_RATIO,
    )


def adc_offset(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """One current channel reads some counts too much or too little."""
    key = f"ADC_OFF_{rng.choice(['A', 'B'])}"
    sign = float(rng.choice([-1.0, 1.0]))
    return Drawn("adc_offset", "E", ("current",), {key: sign}, {}, {"offset": (key, 1.0, "counts")})


def adc_gain(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """One current channel reads in proportion too much or too little."""
    key = f"ADC_GAIN_{rng.choice(['A', 'B'])}"
    return Drawn(
        "adc_gain",
        "E",
        ("current",),
        {key: 0.01 * float(rng.choice([-1.0, 1.0]))},
        {},
        {"gain": (key, 1.0, "1")},
    )


def pwm_deadband(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """The first part of the duty does nothing."""
    return Drawn("pwm_deadband", "E", ("command",), {"DEADBAND": 0.002}, {}, {"u0": ("DEADBAND", 1.0, "1")})


def diode_braking(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Freewheel diode lets an aiding back-EMF drive current; share of full conduction."""
    return Drawn("diode_braking", "E", ("velocity",), {"DIODE": 0.02}, {}, {"fraction": ("DIODE", 1.0, "1")})


def supply_sag(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Source resistance of the supply."""
    return Drawn("supply_sag", "E", ("current",), {"SAG": 0.05}, {}, {"resistance": ("SAG", 1.0, "ohm")})


def winding_heating(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Copper warms with i2 t."""
    fixed = {"HEAT_TAU": rng.uniform(60.0, 300.0)}
    names = {"thermal_resistance": ("HEAT", 1.0, "K/W"), "tau": ("HEAT_TAU", 1.0, "s")}
    return Drawn("winding_heating", "E", ("time", "temperature"), {"HEAT": 0.5}, fixed, names)


def magnet_weakening(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Torque constant falls: one motor's for good, or both at a time or slowly (K itself is not known)."""
    if rng.random() < 0.5:
        fixed = {"MAG_T0": -1.0, "MAG_RAMP": 0.0, "MAG_SIDE": float(rng.integers(1, 3))}
    else:
        ramp = 0.0 if rng.random() < 0.5 else rng.uniform(60.0, 200.0)
        fixed = {"MAG_T0": rng.uniform(140.0, 240.0), "MAG_RAMP": ramp, "MAG_SIDE": 0.0}
    names = {"fraction": ("MAG_A", 1.0, "1"), "onset": ("MAG_T0", 1.0, "s")}
    return Drawn(
        "magnet_weakening", "T", ("time", "current"), {"MAG_A": 0.01}, fixed, names, one_session=True
    )


def command_disturbance(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A sine is added to the effort, unknown to the set point."""
    f = rng.uniform(0.3, 6.0)
    fixed = {"UPSET_F": f, "UPSET_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("UPSET", 1.0, "1/3000"), "frequency": ("UPSET_F", 1.0, "Hz")}
    return Drawn(
        "command_disturbance", "S", ("command", "time"), {"UPSET": 2.0}, fixed, names, frequency_hz=f
    )
