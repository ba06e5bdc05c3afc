"""compensation.yaml as parameters of the axis board, in the order a host sends them."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

from bus.protocol import HARMONICS, AxisParameter
from bus.protocol.scales import COUNTS_PER_TURN
from bus.units import ARCSEC_PER_TURN
from scenarios.language.document import ScenarioError, read
from scenarios.language.validate import check

FORMAT = "schmidt-compensation 1"
_Q8, _Q16 = 256, 65536
_MOST_STEPS = 3000


def _block(**fields: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "required": list(fields), "properties": fields}


def _number(low: float, **high: float) -> dict[str, Any]:
    return {"type": "number", "minimum": low, **high}


_WAVE = _number(-_MOST_STEPS, maximum=_MOST_STEPS)
_ROW = _block(order=_number(0, exclusiveMaximum=32768), cosine_steps=_WAVE, sine_steps=_WAVE)
_LANGUAGE = _block(
    axis={"enum": ["ra", "dec"]},
    friction=_block(
        steps=_number(0, maximum=_MOST_STEPS),
        travel_arcsec={"type": "number", "exclusiveMinimum": 0, "maximum": ARCSEC_PER_TURN},
    ),
)
_LANGUAGE["properties"]["lines"] = {"type": "array", "maxItems": HARMONICS, "items": _ROW}
"""What a file may say; orders are cycles per turn, with 16 bits before the point."""


@dataclasses.dataclass(frozen=True)
class Line:
    """A wave of the effort over the absolute encoder's angle.

    order: cycles per turn of the axis. cosine, sine: PWM steps.
    """

    order: float
    cosine: float
    sine: float


@dataclasses.dataclass(frozen=True)
class Compensation:
    """axis: ra or dec. friction_steps: effort of sliding friction, PWM steps. travel_arcsec: in which it
    turns."""

    axis: str
    lines: tuple[Line, ...]
    friction_steps: float
    travel_arcsec: float

    def parameters(self) -> list[tuple[int, int]]:
        """Parameter numbers and values in the order to send them: off first and on last, so that a table that
        is half loaded never acts."""
        first, on = AxisParameter.HARMONIC_FIRST, int(AxisParameter.COMPENSATION)
        travel = max(1, round(self.travel_arcsec / ARCSEC_PER_TURN * COUNTS_PER_TURN))
        wanted = [(on, 0)]
        for k, line in enumerate(self.lines + (Line(0.0, 0.0, 0.0),) * (HARMONICS - len(self.lines))):
            numbers = round(line.order * _Q16), round(line.cosine * _Q8), round(line.sine * _Q8)
            wanted += [(first + 3 * k + place, number) for place, number in enumerate(numbers)]
        wanted.append((int(AxisParameter.FRICTION_TRAVEL_COUNTS), travel))
        wanted.append((int(AxisParameter.FRICTION_LEVEL_Q8), round(self.friction_steps * _Q8)))
        return [*wanted, (on, 1)]

    def wrong(self, scale: float, turn_rad: float) -> Compensation:
        """The same with every wave `scale` times as large and turned by `turn_rad`: how far may it be off?"""
        cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
        lines = tuple(
            Line(
                each.order,
                scale * (each.cosine * cosine + each.sine * sine),
                scale * (each.sine * cosine - each.cosine * sine),
            )
            for each in self.lines
        )
        return dataclasses.replace(self, lines=lines, friction_steps=scale * self.friction_steps)


def load(file: Path) -> Compensation:
    """Read and check what `schmidt calibrate` wrote; raises `ScenarioError` with what and where."""
    document = read(file)
    data = document.data
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise ScenarioError(f"{file}: is not a compensation file, 'format: {FORMAT}' is missing")
    check(document, _LANGUAGE)
    lines = [
        Line(*(float(row[name]) for name in ("order", "cosine_steps", "sine_steps")))
        for row in data.get("lines", [])
    ]
    friction = data["friction"]
    return Compensation(
        data["axis"], tuple(lines), float(friction["steps"]), float(friction["travel_arcsec"])
    )
