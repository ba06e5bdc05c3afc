"""`schmidt conformance [--can INTERFACE:CHANNEL]`: the checks against a bus, or in process."""

from pathlib import Path

from bus.conformance import Settings
from bus.conformance.cli import check, conformance_command
from bus.pythoncan import SchmidtBus
from scenarios.served import network


def command(
    spec: str | None,
    json_path: Path | None = None,
    speed: float = 1.0,
    motion: bool | None = None,
    tolerance: float = 0.02,
) -> int:
    """Check the bus that `spec` names, or (None) the lab network in this process; returns the exit status.

    motion None: commands that move something are sent in process only; a bus may be a real telescope's.
    """
    if spec is not None:
        return conformance_command(spec, json_path, speed, bool(motion), tolerance)
    with SchmidtBus(network().wire) as bus:
        return check(bus, json_path, Settings(motion=motion is not False, period_tolerance=tolerance))
