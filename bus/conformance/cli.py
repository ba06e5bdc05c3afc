"""`schmidt conformance --can INTERFACE:CHANNEL [--json FILE] [--speed X] [--motion] [--tolerance R]`."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import can
from rich.console import Console
from rich.table import Table

from bus.conformance.result import CheckResult, summary
from bus.conformance.run import run
from bus.conformance.settings import Settings
from bus.external import SpecError, open_bus
from bus.protocol import Device


def conformance_command(
    spec: str,
    json_path: Path | None = None,
    speed: float = 1.0,
    motion: bool = False,
    tolerance: float = 0.02,
    devices: Sequence[Device] = tuple(Device),
) -> int:
    """Check the boards `devices` behind `spec`; 0 when every `must` holds, 1 when one fails.

    Raises SpecError (a ValueError) when the bus cannot be opened or breaks, or `json_path` cannot be written.
    """
    with open_bus(spec) as bus:
        try:
            settings = Settings(speed=speed, motion=motion, period_tolerance=tolerance)
            return check(bus, json_path, settings, devices)
        except can.CanError as error:
            raise SpecError(f'"{spec}": the bus broke down: {error}') from None


def check(
    bus: can.BusABC,
    json_path: Path | None,
    settings: Settings,
    devices: Sequence[Device] = tuple(Device),
) -> int:
    """Check the boards on an open bus, print what failed, write the results; 0 or 1 as above."""
    console = Console()
    with console.status("listening") as status:

        def show(result: CheckResult) -> None:
            status.update(f"{result.check}: {result.subject}")

        results = run(bus, devices=devices, settings=replace(settings, each=show))
    found = summary(results)
    if json_path is not None:
        try:
            json_path.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
        except OSError as error:
            raise SpecError(f"{json_path}: cannot be written: {error.strerror}") from None
    if failed := [result for result in results if not result.passed]:
        console.print(_table(failed))
    console.print(
        f"{found['checks']} checks, {found['failed_must']} of what must hold failed, "
        f"{found['failed_should']} of what should"
    )
    return 0 if found["passed"] else 1


def _table(failed: list[CheckResult]) -> Table:
    table = Table("level", "check", "subject", "expected", "observed", title="failed")
    for result in failed:
        table.add_row(str(result.level), result.check, result.subject, result.expected, result.observed)
    return table
