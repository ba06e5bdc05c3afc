"""`unknown`: what no name fits enters the plant as a function of the domain it was found in."""

from collections.abc import Callable

import numpy as np

from calibration.arrays import Array
from calibration.finding import Finding
from calibration.names.inplant import SIDES, Facts, Knots, Made, motor_of, value
from plant.effects.unknown import KNOTS

#: rad, radii of the sum of loops of an axis, in the order of its parameters. ASSUMPTION: 1 arcmin to 1 deg
LOOPS = (3e-4, 1e-3, 3e-3, 8e-3, 0.02)
HARMONICS = 6  # harmonics of the motor's turn: brushes and commutator segments. ASSUMPTION


def to_plant(f: Finding, facts: Facts) -> Made:
    """An `unknown` effect of the plant file, its uncertainty in the source of its function; or why not."""
    made, source = Made(), f"fitted to {facts.name}"
    period = float(1.0 / f.frequency) if f.frequency else 0.0
    if f.curve is not None:
        c, half = f.curve, np.array(f.curve.half)
        source += f"; 95 % within +-{float(np.median(half)):.2g} {c.unit}"
        source += f", at worst +-{float(half.max()):.2g} {c.unit}"
        made.function("torque", c.domain, list(zip(c.x, c.y, strict=True)), source)
    elif f.channel == "T" and f.domain == "reversal":
        _loops(made, f, facts)
    elif f.channel == "T" and f.domain == "time" and period:
        source += f", whose first row is time 0; 95 % within +-{_spread(f):.2g} N m"
        made.function("torque", "time", _wave(period, lambda x: -_waves(f, x)), source, period=period)
    elif f.channel == "E" and f.domain == "motor_angle" and "amplitude" in f.parameters:
        _brush(made, f, facts)
    elif f.channel == "E" and f.domain == "time" and period:
        knots = _wave(period, lambda x: value(f, "amplitude") * np.sin(x))
        made.function("current", "time", knots, source, period=period)
        made.remarks.append("unknown on the currents: size and frequency are the log's, its phase is none")
    elif f.domain == "command":
        why = "the controller's law that differs, and the plant file has one set of gains and no set point"
        made.remarks.append(f"unknown on the command: left out of the plant, it is {why}")
    else:
        where = f"{f.domain.replace('_', ' ')} in channel {f.channel}"
        none = "the report gives no function of a signal that the plant has"
        made.remarks.append(f"unknown over {where}: left out, {none}")
    return made


def _wave(period: float, wave: Callable[[Array], Array]) -> Knots:
    """Knots over a period of `wave`, a function of the phase in rad; the end is at the start, exactly."""
    x = np.linspace(0.0, period, KNOTS)
    y = wave(2 * np.pi * x / period)
    y[-1] = y[0]
    return list(zip(x.tolist(), y.tolist(), strict=True))


def _loops(made: Made, f: Finding, facts: Facts) -> None:
    """Stops over the axis angle; the motors' counter-torque is minus the torque on the axis."""
    loops = {f"loop_{k}": radius for k, radius in enumerate(LOOPS)} | {"loop": value(f, "travel")}
    found = [(radius, f.parameters[name]) for name, radius in loops.items() if name in f.parameters]
    half = max(p.half for _, p in found)
    source = f"fitted to {facts.name}; heights 95 % within +-{half:.2g} N m"
    made.function("torque", "axis_angle", [(r, -p.value) for r, p in found], source, interpolation="stop")


def _waves(f: Finding, x: np.ndarray) -> np.ndarray:
    """Sum of A cos(k x + phase) over the harmonics a finding has."""
    y = np.zeros(len(x))
    for k in range(1, HARMONICS + 1):
        word = "" if k == 1 else f"_{k}"
        if "amplitude" + word in f.parameters:
            y += value(f, "amplitude" + word) * np.cos(k * x + value(f, "phase" + word))
    return y


def _spread(f: Finding) -> float:
    """95 % half-width of a sum of lines: its harmonics' in quadrature."""
    halves = [p.half for name, p in f.parameters.items() if name.startswith("amplitude")]
    return float(np.hypot.reduce(halves)) if halves else 0.0


def _brush(made: Made, f: Finding, facts: Facts) -> None:
    """Ohms over the motor's angle, or volts that are lost: as a duty that is lost."""
    ohms, shift = f.parameters["amplitude"].unit == "ohm", SIDES[motor_of(f)] * facts.half_play
    source = f"fitted to {facts.name}; 95 % within +-{_spread(f):.2g} {'ohm' if ohms else 'V'}"
    target, factor = ("resistance", 1.0) if ohms else ("command", -1.0 / facts.supply)
    knots = _wave(2 * np.pi, lambda x: factor * _waves(f, x - shift))
    made.function(target, "motor_angle", knots, source, period=2 * np.pi, motor=motor_of(f))
