"""`schmidt conformance --can INTERFACE:CHANNEL [--board TYPE:ID] [--json FILE] ...`: runs, prints, writes."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import can
from rich.console import Console
from rich.table import Table

from bus.conformance.boards import Board
from bus.conformance.result import CheckResult, summary
from bus.conformance.run import run
from bus.conformance.settings import Settings
from bus.outside.external import SpecError, open_bus
from bus.protocol import Device

if TYPE_CHECKING:
    from cantools.database import Database


def conformance_command(
    spec: str,
    json_path: Path | None = None,
    boards: Sequence[Board] = (),
    settings: Settings | None = None,
    dbc: "Database | None" = None,
) -> int:
    """Check `boards` (none named: every board of the protocol) behind `spec` against `dbc` (None: the
    project's own); 0 without an error, else 1.

    Raises SpecError (a ValueError) when the bus cannot be opened or breaks, or `json_path` cannot be written.
    """
    with open_bus(spec) as bus:
        try:
            return check(bus, json_path, settings or Settings(), boards, dbc)
        except can.CanError as error:
            raise SpecError(f'"{spec}": the bus broke down: {error}') from None


def check(
    bus: can.BusABC,
    json_path: Path | None,
    settings: Settings,
    boards: Sequence[Board] = (),
    dbc: "Database | None" = None,
) -> int:
    """Check boards on an open bus, print what is wrong, write the results; 0 or 1 as above.

    `settings.each` may show how far it is.
    """
    console = Console()
    results = run(bus, dbc, boards or tuple(Device), settings)
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
