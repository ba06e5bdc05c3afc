"""What a host loads into the axis boards before a programme: a firmware's parameters, a compensation."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path

from bus.protocol import Device
from host.client import Client, Procedure
from host.procedures import parameters
from scenarios import compensation
from scenarios.document import ScenarioError
from scenarios.firmware import FIRMWARES
from scenarios.model import Scenario, Step

AXES = {"ra": Device.AXIS_RA, "dec": Device.AXIS_DEC}
_COMMAND_LINE = "command line"


def firmware(client: Client, name: str) -> Procedure:
    """Set the parameters of a firmware on both axis boards."""
    for device in AXES.values():
        yield from parameters.load(client, device, FIRMWARES[name].items())


def compensate(client: Client, wanted: compensation.Compensation) -> Procedure:
    """Load a compensation into its axis board."""
    yield from parameters.load(client, AXES[wanted.axis], wanted.parameters())


def with_firmware(scenario: Scenario, name: str) -> Scenario:
    """The scenario with a step in front that makes the boards what `name` says."""
    return _before(scenario, Step(f"firmware {name}", "firmware", {"use": name}, _COMMAND_LINE))


def with_compensation(scenario: Scenario, wanted: compensation.Compensation) -> Scenario:
    """The scenario with a compensation loaded before everything except the firmware."""
    step = Step("compensation", "compensation", {"table": wanted}, _COMMAND_LINE)
    first, *rest = scenario.steps
    if first.action == "firmware":
        return dataclasses.replace(scenario, steps=(first, step, *rest))
    return _before(scenario, step)


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
        except compensation.CompensationError as error:
            raise ScenarioError(f"{step.where}: compensation: {error}") from None
        yield dataclasses.replace(step, arguments={**step.arguments, "table": table})
