"""All checks, in order, on one bus."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import can

from bus.conformance.commands import check_commands
from bus.conformance.link import Link
from bus.conformance.misuse import check_misuse, check_unknown_identifier
from bus.conformance.result import CheckResult, Level
from bus.conformance.settings import Settings
from bus.conformance.telemetry import check_telemetry
from bus.protocol import Device, Opcode
from bus.protocol.nodes import documented

if TYPE_CHECKING:
    from cantools.database import Database


def run(
    bus: can.BusABC,
    dbc: "Database | None" = None,
    devices: Sequence[Device] = tuple(Device),
    settings: Settings | None = None,
) -> list[CheckResult]:
    """Check every one of `devices` on `bus` against `dbc` (None: the project's own).

    Never raises for what boards do or fail to do; a bus that breaks raises can.CanError. Nobody else
    should be sending commands meanwhile.
    """
    settings = settings or Settings()
    results = []
    for result in _checks(Link(bus, settings), dbc or documented(devices), devices):
        settings.each(result)
        results.append(result)
    return results


def _checks(link: Link, dbc: "Database", devices: Sequence[Device]) -> Iterator[CheckResult]:
    yield from check_telemetry(link, dbc, {device.name for device in devices})
    for device in devices:
        if not (link.ask(device, Opcode.PING) or link.ask(device, Opcode.PING)):
            # Once is enough: waiting for the answer to every command of a board that is not there takes
            # minutes.
            subject = f"{device.name} PING"
            yield CheckResult("answers", subject, Level.MUST, False, "a reply", "none, twice", 0.0)
            continue
        yield from check_commands(link, device)
        yield from check_misuse(link, device)
        yield from check_unknown_identifier(link, device)
