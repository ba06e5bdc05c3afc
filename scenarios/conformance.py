"""`schmidt conformance [SCENARIO] [--network NAME] [--can BUS] [--board TYPE:ID]`: the checks."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bus.conformance import Settings, board_of, parse
from bus.conformance.cli import check, conformance_command
from bus.pythoncan import SchmidtBus
from scenarios.networks import config_from, devices_of
from scenarios.served import chosen, wire


def command(
    spec: str | None,
    json_path: Path | None = None,
    boards: Sequence[str] = (),
    settings: Settings | None = None,
    scenario_file: Path | None = None,
    network_name: str | None = None,
) -> int:
    """Check the bus that `spec` names, or (None) a network in this process; returns the exit status.

    boards: TYPE:ID each; none named: those of scenario_file or network_name, the lab network's when neither
    is given.
    """
    settings = settings or Settings()
    scenario, model = chosen(scenario_file, network_name=network_name)
    devices = devices_of(config_from(scenario.network, {}, scenario.file.parent))
    named = [parse(board) for board in boards] or [board_of(device) for device in devices]
    if spec is not None:
        return conformance_command(spec, json_path, named, settings)
    with SchmidtBus(wire(scenario, model).wire) as bus:
        return check(bus, json_path, replace(settings, stamps_s=0.0), named)
