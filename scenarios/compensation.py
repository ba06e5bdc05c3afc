"""compensation.yaml as parameters of the axis board, in the order a host sends them."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import yaml

from boards.axis.config import COUNTS_PER_TURN
from bus.protocol import HARMONICS, AxisParameter

FORMAT = "schmidt-compensation 1"
_TURN_ARCSEC = 1_296_000
_Q8, _Q16 = 256, 65536
_MOST_STEPS = 3000


class CompensationError(ValueError):
    """A compensation file that cannot be used."""


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
        travel = max(1, round(self.travel_arcsec / _TURN_ARCSEC * COUNTS_PER_TURN))
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
    """Read and check what `schmidt calibrate` wrote; raises `CompensationError` with what and where."""
    try:
        data = yaml.safe_load(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise CompensationError(f"{file}: {(error.strerror or 'cannot be read').lower()}") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise CompensationError(f"{file}: is not YAML: {' '.join(str(error).split())}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise CompensationError(f"{file}: is not a compensation file, 'format: {FORMAT}' is missing")
    if data.get("axis") not in ("ra", "dec"):
        raise CompensationError(f"{file}: axis: expected ra or dec, not {data.get('axis')!r}")
    rows = data.get("lines", [])
    if not isinstance(rows, list) or len(rows) > HARMONICS:
        raise CompensationError(f"{file}: lines: expected a list of at most {HARMONICS}")
    lines = tuple(
        Line(*(_number(file, f"lines.{k}", row, word) for word in ("order", "cosine_steps", "sine_steps")))
        for k, row in enumerate(rows)
    )
    friction = data.get("friction", {})
    made = Compensation(
        data["axis"],
        lines,
        _number(file, "friction", friction, "steps"),
        _number(file, "friction", friction, "travel_arcsec"),
    )
    for line in lines:
        if not 0 <= line.order < 32768 or max(abs(line.cosine), abs(line.sine)) > _MOST_STEPS:
            raise CompensationError(
                f"{file}: a line of order {line.order:g} and {line.cosine:g}, {line.sine:g} steps: "
                f"orders go to 32767 cycles per turn, efforts to {_MOST_STEPS} steps"
            )
    if not 0 <= made.friction_steps <= _MOST_STEPS or not 0 < made.travel_arcsec <= _TURN_ARCSEC:
        raise CompensationError(f"{file}: friction: 0 to {_MOST_STEPS} steps over more than 0 arcsec")
    return made


def _number(file: Path, where: str, row: Any, word: str) -> float:
    value = row.get(word) if isinstance(row, dict) else None
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise CompensationError(f"{file}: {where}.{word}: expected a number, not {value!r}")
    return float(value)
