"""`schmidt conformance [SCENARIO] [--network NAME] [--can INTERFACE:CHANNEL]`: the checks."""

from pathlib import Path

from bus.conformance import Settings
from bus.conformance.cli import check, conformance_command
from bus.pythoncan import SchmidtBus
from scenarios.network import config_from, devices_of
from scenarios.served import chosen, wire


def command(
    spec: str | None,
    json_path: Path | None = None,
    speed: float = 1.0,
    motion: bool | None = None,
    tolerance: float = 0.02,
    scenario_file: Path | None = None,
    network_name: str | None = None,
) -> int:
    """Check the bus that `spec` names, or (None) a network in this process; returns the exit status.

    scenario_file, network_name: whose boards; the lab network's when neither is given.
    motion None: commands that move something are sent in process only; a bus may be a real telescope's.
    """
    scenario, model = chosen(scenario_file, network_name=network_name)
    devices = devices_of(config_from(scenario.network, {}, scenario.file.parent))
    if spec is not None:
        return conformance_command(spec, json_path, speed, bool(motion), tolerance, devices)
    with SchmidtBus(wire(scenario, model).wire) as bus:
        return check(
            bus, json_path, Settings(motion=motion is not False, period_tolerance=tolerance), devices
        )
