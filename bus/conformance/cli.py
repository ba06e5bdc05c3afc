"""`schmidt conformance --can INTERFACE:CHANNEL [--board TYPE:ID] [--json FILE] ...`: runs, prints, writes."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import can
from rich.console import Console
from rich.table import Table

from bus.conformance.boards import Board
from bus.conformance.result import CheckResult, summary
from bus.conformance.run import run
from bus.conformance.settings import Settings
from bus.external import SpecError, open_bus
from bus.protocol import Device


def conformance_command(
    spec: str, json_path: Path | None = None, boards: Sequence[Board] = (), settings: Settings | None = None
) -> int:
    """Check `boards` (none named: every board of the protocol) behind `spec`; 0 without an error, else 1.

    Raises SpecError (a ValueError) when the bus cannot be opened or breaks, or `json_path` cannot be written.
    """
    with open_bus(spec) as bus:
        try:
            return check(bus, json_path, settings or Settings(), boards)
        except can.CanError as error:
            raise SpecError(f'"{spec}": the bus broke down: {error}') from None


def check(bus: can.BusABC, json_path: Path | None, settings: Settings, boards: Sequence[Board] = ()) -> int:
    """Check boards on an open bus, print what is wrong, write the results; 0 or 1 as above."""
    console = Console()
    with console.status("listening") as status:

        def show(result: CheckResult) -> None:
            status.update(f"{result.check}: {result.subject}")

        results = run(bus, devices=boards or tuple(Device), settings=replace(settings, each=show))
    found = summary(results)
    if json_path is not None:
        try:
            json_path.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
        except OSError as error:
            raise SpecError(f"{json_path}: cannot be written: {error.strerror}") from None
    if wrong := [result for result in results if not result.passed]:
        console.print(_table(wrong))
    console.print(
        f"{found['checks']} checks: {found['ok']} ok, {found['info']} info, {found['issue']} issues, "
        f"{found['error']} errors"
    )
    return 0 if found["passed"] else 1


def _table(wrong: list[CheckResult]) -> Table:
    table = Table("level", "check", "subject", "expected", "observed", title="not as it should be")
    for result in wrong:
        table.add_row(str(result.level), result.check, result.subject, result.expected, result.observed)
    return table
