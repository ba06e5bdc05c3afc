"""What a host loads into the axis boards before a programme: the parameters of a firmware, a compensation."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from boards.axis.observer import ANGLE_SHIFT, EFFORT_SHIFT, Observer
from bus.protocol import HARMONICS, AxisParameter
from bus.protocol.scales import COUNTS_PER_TURN
from bus.units import ARCSEC_PER_TURN
from host.client import Client, Procedure
from host.procedures import manual
from host.procedures.manual import AXES
from plant.compensation import FORMAT
from plant.deadzone import bias_steps
from plant.observer import sections
from plant.parts import AxisModel, PlantModel
from scenarios.language.document import ScenarioError, read
from scenarios.language.model import Scenario, Step
from scenarios.language.validate import check, schema

_Q8, _Q16 = 256, 65536
SCHEMA_FILE = Path(__file__).with_name("compensation.schema.json")
"""What a file may say."""


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
    """axis: ra or dec. friction_steps: effort of sliding friction, PWM steps; it turns in travel_arcsec."""

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
            Line(o, scale * (c * cosine + s * sine), scale * (s * cosine - c * sine))
            for o, c, s in map(dataclasses.astuple, self.lines)
        )
        return dataclasses.replace(self, lines=lines, friction_steps=scale * self.friction_steps)


def load_compensation(file: Path) -> Compensation:
    """Read and check what `schmidt calibrate` wrote; raises `ScenarioError` with what and where."""
    document = read(file)
    data = document.data
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise ScenarioError(f"{file}: is not a compensation file, 'format: {FORMAT}' is missing")
    check(document, schema(SCHEMA_FILE))
    lines = [
        Line(*(float(row[name]) for name in ("order", "cosine_steps", "sine_steps")))
        for row in data.get("lines", [])
    ]
    friction = data["friction"]
    return Compensation(
        data["axis"], tuple(lines), float(friction["steps"]), float(friction["travel_arcsec"])
    )


BLEND_SHIFT = 11
"""10.2 s: four encoder lines when tracking. A roller ratio that is wrong by 1e-4 then costs 0.015 arcsec."""


NO_OBSERVER = "firmware observer: there is none for this plant's drive; take fine, or a softer or damped gear"


def parameters_of(name: str, model: PlantModel, axis: str = "ra") -> Mapping[int, int]:
    """Return the parameters of a firmware on an axis of a plant: its bias follows from the power stage.

    paper: everything off. fine: what docs/results/one-arcsecond.md proposes, without compensation. observer:
    the same, with a state observer on the axis that tracks.
    """
    if name == "paper":
        return {}
    part: AxisModel = getattr(model.axes, axis)
    fine: dict[int, int] = {
        AxisParameter.DUTY_FRACTION: 1,
        AxisParameter.RATE_LOCK: 1,
        AxisParameter.POSITION_BLEND: BLEND_SHIFT,
        AxisParameter.COUNTER_BIAS_Q8: bias_steps(model, part.motor) * 256,
    }
    return fine | observer(model, part) if name == "observer" and axis == "ra" else fine


def observer(model: PlantModel, part: AxisModel) -> dict[int, int]:
    """Coefficients of a drive's observer, and its switch behind them; ScenarioError where it has none."""
    try:
        found, through = sections(model, part)
    except np.linalg.LinAlgError:
        raise ScenarioError(NO_OBSERVER) from None
    effort, angle = 1 << EFFORT_SHIFT, 1 << ANGLE_SHIFT
    scales = (effort, effort, effort, effort, angle, angle)
    values = [round(value * scale) for section in found for value, scale in zip(section, scales, strict=True)]
    board = Observer()
    board.coefficients = [*values, round(through * angle)]
    if max(map(abs, board.coefficients)) >= 1 << 31 or not board.sound():
        raise ScenarioError(NO_OBSERVER)
    return dict(enumerate(board.coefficients, AxisParameter.OBSERVER_FIRST)) | {AxisParameter.OBSERVER: 1}


def firmware(client: Client, of_axes: Mapping[str, Mapping[int, int]]) -> Procedure:
    """Set the parameters of a firmware on both axis boards."""
    for axis, device in AXES.items():
        yield from manual.load(client, device, of_axes[axis].items())


def with_firmware(scenario: Scenario, name: str) -> Scenario:
    """The scenario with a step in front that makes the boards what `name` says."""
    return _with_step(scenario, 0, "firmware", f"firmware {name}", use=name)


def with_compensation(scenario: Scenario, wanted: Compensation) -> Scenario:
    """The scenario with a compensation loaded before everything except the firmware."""
    behind = int(scenario.steps[0].action == "firmware")
    return _with_step(scenario, behind, "compensation", "compensation", table=wanted)


def _with_step(scenario: Scenario, place: int, action: str, name: str, **arguments: Any) -> Scenario:
    steps = list(scenario.steps)
    steps.insert(place, Step(name=name, action=action, arguments=arguments, where="command line"))
    return dataclasses.replace(scenario, steps=tuple(steps))


def completed(scenario: Scenario, model: PlantModel) -> Scenario:
    """Firmware steps that know what their firmware is on the drives of a plant, compensation steps with their
    tables; raises `ScenarioError`."""
    return dataclasses.replace(
        scenario, steps=tuple(_completed(scenario, model, each) for each in scenario.steps)
    )


def _completed(scenario: Scenario, model: PlantModel, step: Step) -> Step:
    found: dict[str, Any] = {}
    if step.action == "firmware":
        found["of_axes"] = {axis: parameters_of(step.arguments["use"], model, axis) for axis in AXES}
    elif step.action == "compensation" and "table" not in step.arguments:
        name = step.arguments["file"]
        places = Path(name), scenario.file.parent / name  # from here, then beside the scenario
        try:
            file = next((path for path in places if path.is_file()), Path(name))
            found["table"] = load_compensation(file)
        except ScenarioError as error:
            raise ScenarioError(f"{step.where}: compensation: {error}") from None
    return dataclasses.replace(step, arguments={**step.arguments, **found})
