"""`unknown`: what no name fits enters the plant as a function of the domain it was found in."""

from __future__ import annotations

import numpy as np

from calibration.corrected.making import Facts, Made, motor_of, value
from calibration.finding import Curve, Finding
from plant.effects.unknown import KNOTS

#: radii in rad of the sum of loops, in the order of its parameters (candidates/axis_unknown.py)
LOOPS = (3e-4, 1e-3, 3e-3, 8e-3, 0.02)
HARMONICS = 6


def unnamed(f: Finding, facts: Facts) -> Made:
    """An `unknown` effect of the plant file, its uncertainty in the source of its function; or why not."""
    made = Made()
    if f.curve is not None:
        _curve(made, f.curve, facts)
    elif f.channel == "T" and f.domain == "reversal":
        _loops(made, f, facts)
    elif f.channel == "T" and f.domain == "time" and f.frequency:
        _in_time(made, f, facts)
    elif f.channel == "E" and f.domain == "motor_angle" and "amplitude" in f.parameters:
        _brush(made, f, facts)
    elif f.channel == "E" and f.domain == "time" and f.frequency:
        size, period = value(f, "amplitude"), 1.0 / f.frequency
        x = np.linspace(0.0, period, KNOTS)
        made.function(
            "current",
            "time",
            _knots(x, _closed(size * np.sin(2 * np.pi * x / period))),
            f"fitted to {facts.name}",
            period=period,
        )
        made.remarks.append("unknown on the currents: size and frequency are the log's, its phase is none")
    elif f.domain == "command":
        made.remarks.append(
            "unknown on the command: left out of the plant, it is the controller's law that differs, "
            "and the plant file has one set of gains and no set point"
        )
    else:
        made.remarks.append(
            f"unknown over {f.domain.replace('_', ' ')} in channel {f.channel}: left out, the report gives "
            "no function of a signal that the plant has"
        )
    return made


def _knots(x: np.ndarray, y: np.ndarray) -> list[tuple[float, float]]:
    return [(float(a), float(b)) for a, b in zip(x, y, strict=True)]


def _closed(y: np.ndarray) -> np.ndarray:
    """The same with its end at its start, exactly."""
    y = y.copy()
    y[-1] = y[0]
    return y


def _curve(made: Made, c: Curve, facts: Facts) -> None:
    half = np.array(c.half)
    source = (
        f"fitted to {facts.name}; 95 % within +-{float(np.median(half)):.2g} {c.unit}, "
        f"at worst +-{float(half.max()):.2g} {c.unit}"
    )
    made.function("torque", c.domain, list(zip(c.x, c.y, strict=True)), source)


def _loops(made: Made, f: Finding, facts: Facts) -> None:
    """Stops over the axis angle; the motors' counter-torque is minus the torque on the axis."""
    if "loop" in f.parameters:
        p = f.parameters["loop"]
        found = [(value(f, "travel"), p.value, p.half)]
    else:
        found = [
            (
                radius,
                f.parameters[f"loop_{k}"].value,
                f.parameters[f"loop_{k}"].half,
            )
            for k, radius in enumerate(LOOPS)
            if f"loop_{k}" in f.parameters
        ]
    source = f"fitted to {facts.name}; heights 95 % within +-{max(h for _, _, h in found):.2g} N m"
    made.function("torque", "axis_angle", [(r, -height) for r, height, _ in found], source, "stop")


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


def _in_time(made: Made, f: Finding, facts: Facts) -> None:
    assert f.frequency is not None
    period = 1.0 / f.frequency
    x = np.linspace(0.0, period, KNOTS)
    y = _closed(-_waves(f, 2 * np.pi * x / period))
    source = f"fitted to {facts.name}, whose first row is time 0; 95 % within +-{_spread(f):.2g} N m"
    made.function("torque", "time", _knots(x, y), source, period=period)


def _brush(made: Made, f: Finding, facts: Facts) -> None:
    """Ohms over the motor's angle, or volts that are lost: as a duty that is lost."""
    number = motor_of(f)
    side = 0.0 if number is None else 1.0 - 2.0 * number
    x = np.linspace(0.0, 2 * np.pi, KNOTS)
    y = _closed(_waves(f, x - side * facts.half_play))
    ohms = f.parameters["amplitude"].unit == "ohm"
    source = f"fitted to {facts.name}; 95 % within +-{_spread(f):.2g} {'ohm' if ohms else 'V'}"
    target, factor = ("resistance", 1.0) if ohms else ("command", -1.0 / facts.supply)
    made.function(
        target,
        "motor_angle",
        _knots(x, factor * y),
        source,
        period=2 * np.pi,
        motor=0 if number is None else number + 1,
    )
