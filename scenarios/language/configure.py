"""What a host loads into the axis boards before a programme: a firmware's parameters, a compensation."""

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from host.client import Client, Procedure
from host.procedures import manual
from host.procedures.manual import AXES
from plant.parts import PlantModel
from scenarios.language import compensation
from scenarios.language.document import ScenarioError
from scenarios.language.firmware import parameters_of
from scenarios.language.model import Scenario, Step

_COMMAND_LINE = "command line"


def firmware(client: Client, of_axes: Mapping[str, Mapping[int, int]]) -> Procedure:
    """Set the parameters of a firmware on both axis boards."""
    for axis, device in AXES.items():
        yield from manual.load(client, device, of_axes[axis].items())


def compensate(client: Client, wanted: compensation.Compensation) -> Procedure:
    """Load a compensation into its axis board."""
    yield from manual.load(client, AXES[wanted.axis], wanted.parameters())


def with_firmware(scenario: Scenario, name: str) -> Scenario:
    """The scenario with a step in front that makes the boards what `name` says."""
    return _before(scenario, _step("firmware", f"firmware {name}", use=name))


def with_compensation(scenario: Scenario, wanted: compensation.Compensation) -> Scenario:
    """The scenario with a compensation loaded before everything except the firmware."""
    step = _step("compensation", "compensation", table=wanted)
    first, *rest = scenario.steps
    if first.action == "firmware":
        return dataclasses.replace(scenario, steps=(first, step, *rest))
    return _before(scenario, step)


def with_parameters(scenario: Scenario, model: PlantModel) -> Scenario:
    """The scenario whose firmware steps know what their firmware is on the drives of a plant."""
    return dataclasses.replace(scenario, steps=tuple(_known(step, model) for step in scenario.steps))


def _known(step: Step, model: PlantModel) -> Step:
    if step.action != "firmware":
        return step
    of_axes = {axis: parameters_of(step.arguments["use"], model, axis) for axis in AXES}
    return dataclasses.replace(step, arguments={**step.arguments, "of_axes": of_axes})


def _step(action: str, name: str, **arguments: Any) -> Step:
    return Step(name=name, action=action, arguments=arguments, where=_COMMAND_LINE)


def _before(scenario: Scenario, step: Step) -> Scenario:
    return dataclasses.replace(scenario, steps=(step, *scenario.steps))


def read_tables(scenario: Scenario) -> Scenario:
    """Read the files of the scenario's `compensation` steps: from here, then beside the scenario."""
    return dataclasses.replace(scenario, steps=tuple(_read(scenario.file.parent, scenario.steps)))


def _read(beside: Path, steps: tuple[Step, ...]) -> Iterator[Step]:
    for step in steps:
        if step.action != "compensation" or "table" in step.arguments:
            yield step
            continue
        name = step.arguments["file"]
        found = next((path for path in (Path(name), beside / name) if path.is_file()), Path(name))
        try:
            table = compensation.load(found)
        except ScenarioError as error:
            raise ScenarioError(f"{step.where}: compensation: {error}") from None
        yield dataclasses.replace(step, arguments={**step.arguments, "table": table})
