"""Whether the boards that steps and faults speak of are on the scenario's network."""

from __future__ import annotations

from scenarios.document import ScenarioError
from scenarios.model import Scenario

_NEEDS = {"display": "DISPLAY", "focus": "FOCUS"}
"""Board by action; every network has the axes."""


def check_boards(scenario: Scenario) -> None:
    """Raise `ScenarioError` for the first step or fault that speaks of a board which is not there."""
    from scenarios.networks import config_from, devices_of

    config = config_from(scenario.network, {}, scenario.file.parent)
    names = [device.name for device in devices_of(config)]
    wanted = [(step.where, _NEEDS[step.action]) for step in scenario.steps if step.action in _NEEDS]
    wanted += [
        (fault.where, fault.arguments["node"]) for fault in scenario.faults if "node" in fault.arguments
    ]
    for where, board in wanted:
        if board not in names:
            raise ScenarioError(f"{where}: the network '{config.name}' has no board {board}")
