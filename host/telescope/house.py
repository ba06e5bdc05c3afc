"""Dome, weather and power (H7): what their boards say, and the few things they can be told."""

from collections.abc import Generator
from functools import cache

from bus.protocol import Device
from bus.protocol.nodes import DOME, KINDS, POWER, FrameCodec, Kind, arguments_of, messages_of
from host.client import Client
from host.telescope.jobs import Activity, Job, Side
from host.telescope.refused import Reason, Refused

DOME_BOARD = DOME.device("DOME")


class House:
    """Commands are jobs beside the others; they are refused where there is no such board."""

    def __init__(self, client: Client, side: Side) -> None:
        self._client = client
        self._side = side

    def reading(self, board: str) -> dict[str, float] | None:
        """Signals of a declared board's last measurement frame in their units; None: none has come."""
        codec = _codecs().get(board)
        data = None if codec is None else self._client.link.measurements.get(codec.identifier & 0x7F)
        return None if codec is None or data is None else codec.unpack(data)

    def boards(self, kind: Kind) -> list[str]:
        """Names of the boards of a kind that have been heard."""
        return [name for name, number in kind.nodes.items() if number in self._client.link.measurements]

    def turn(self, azimuth_deg: float) -> Job[None]:
        """Turn the slit to an azimuth, 0 up to 360°."""
        if not 0 <= azimuth_deg < 360:
            raise Refused(Reason.VALUE, f"azimuth {azimuth_deg:g}° is not within 0..360°")
        return self._tell(DOME, DOME_BOARD, "DOME_GOTO", round(azimuth_deg * 100) % 36000)

    def shutter(self, opened: bool) -> Job[None]:
        """Open or close; the board refuses to open in bad weather."""
        return self._tell(DOME, DOME_BOARD, "DOME_SHUTTER", int(opened))

    def stop(self) -> Job[None]:
        """Stop dome and shutter; commands that still wait are given up, as a stop is not queued."""
        self._client.forget(DOME_BOARD)
        return self._tell(DOME, DOME_BOARD, "DOME_STOP")

    def relay(self, board: str, channel: int, on: bool) -> Job[None]:
        """Switch a relay, 1 to 8, of a power board."""
        if board not in POWER.nodes or not 1 <= channel <= 8:
            raise Refused(Reason.VALUE, f"{board} has no relay {channel}")
        return self._tell(POWER, POWER.device(board), "RELAY", channel, int(on))

    def _tell(self, kind: Kind, device: Device, opcode: str, *arguments: int) -> Job[None]:
        if device not in self._client.link.measurements:
            raise Refused(Reason.SILENT, f"{device.name} is not on this network, or silent")
        number = next(each for each in arguments_of(kind) if each.name == opcode)

        def procedure() -> Generator[None, None, None]:
            yield from self._client.ask(device, number, *arguments)

        return self._side.start(Job(f"{device.name} {opcode}", procedure(), Activity.IDLE))


@cache
def _codecs() -> dict[str, FrameCodec]:
    """By board name."""
    found = [FrameCodec(m) for kind in KINDS for m in messages_of(kind) if 0x200 <= m.frame_id < 0x280]
    names = {int(device): device.name for kind in KINDS for device in kind.devices()}
    return {names[codec.identifier & 0x7F]: codec for codec in found}
