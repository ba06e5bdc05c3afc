"""Parameters of a board, one after the other, each confirmed by the value in force."""

from collections.abc import Iterable

from bus.protocol import Device, Opcode
from host.client import Client, ClientError, Procedure


def load(client: Client, device: Device, rows: Iterable[tuple[int, int]]) -> Procedure:
    """Set parameters (number, value) in their order; raises `ClientError` if a board keeps another one."""
    count = 0
    for number, value in rows:
        reply = yield from client.ask(device, Opcode.SET_PARAMETER, number, value)
        if reply.value != value:
            raise ClientError(f"{device.name}: parameter {number} is {reply.value}, not {value}")
        count += 1
    client.logs.status(client.now_ns, "HOST", f"{device.name}: {count} parameters loaded")
