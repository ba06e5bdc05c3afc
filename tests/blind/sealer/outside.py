"""Effects that are not in the catalogue: the right answer is `unknown`, in one of the domains given."""

import math

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn

Rng = np.random.Generator


def mains_pickup(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """50 Hz on one current channel (folds to a slow beat against the 10 ms rows)."""
    fixed = {"MAINS_F": rng.uniform(49.9, 50.1), "MAINS_SIDE": float(rng.integers(2))}
    return Drawn("outside_mains", "E", ("time", "clock", "current"), {"MAINS": 1.0}, fixed)


def preisach(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Hysteresis element of six stops, loops of arc minutes to a degree."""
    fixed = {"PREI_W": math.radians(rng.uniform(0.1, 0.8))}
    return Drawn("outside_preisach", "T", ("reversal", "axis_angle"), {"PREI_A": 2.0}, fixed)


def sticking_brush(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A brush of motor A loses contact over a sector of its turn, in bursts."""
    fixed = {"BRUSH_PH": rng.uniform(0, d.TURN), "BRUSH_WIDTH": rng.uniform(0.05, 0.3)}
    return Drawn("outside_brush", "E", ("motor_angle", "time", "current"), {"BRUSH_A": 0.1}, fixed)


def other_axis(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """The other axis moves and its acceleration pushes on this one."""
    return Drawn(
        "outside_other_axis", "T", ("time",), {"OTHER": 2.0}, {"OTHER_PERIOD": rng.uniform(7.0, 15.0)}
    )


def command_pulse(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Square pulses on the executed set point that the logged one does not show."""
    fixed = {"PULSE_PERIOD": rng.uniform(4.0, 9.0), "PULSE_LENGTH": rng.uniform(0.2, 0.6)}
    return Drawn("outside_command_pulse", "S", ("command", "time"), {"PULSE": 1.5}, fixed)


def gain_bug(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """The proportional gain is wrong above a speed."""
    factor = 1.0 / (1.0 + 0.3 * ratio) if rng.random() < 0.5 else 1.0 + 0.15 * ratio
    fixed = {"BUG_V": rng.uniform(200.0, 900.0) * d.ROLLER_COUNTS / 1_296_000 * d.TICK_S, "BUG_F": factor}
    return Drawn("outside_gain_bug", "S", ("velocity", "command"), {}, fixed, how="fraction")


def square_drag(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A drag that grows with the square of the speed (a fan on the axis)."""
    return Drawn("outside_square_drag", "T", ("velocity",), {"QUAD": 5000.0}, {})


OUTSIDE = (mains_pickup, preisach, sticking_brush, other_axis, command_pulse, gain_bug, square_drag)
