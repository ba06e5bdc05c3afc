"""Dome, weather and power (H7): what their boards say, and the few things they can be told."""

import math
from collections.abc import Callable
from typing import Final

from bus.protocol import Device, Reply
from bus.protocol.nodes import DOME, WEATHER, Kind
from host.client import TICK_NS, Client
from host.procedures.dome import BOARD as DOME_BOARD
from host.procedures.dome import centidegrees, codecs, opcode, reading
from host.sky.observed import Observed
from host.telescope.jobs import Activity, Job, Reason, Refused, Side
from host.telescope.state import MISSED

_FOLLOW_NS: Final = 1_000_000_000
_FOLLOW_DEG: Final = 2.0
"""A slit this far from the beam is moved: the board stops within 0.5°. ASSUMPTION: the slit is wider."""
_ZENITH_RAD: Final = math.radians(88.0)
"""Above this azimuth turns faster than a dome, and the slit is over the tube anyway. ASSUMPTION."""


class House:
    """Commands are jobs beside the others; they are refused where there is no such board.

    aim: where the telescope points or is going to; None: nobody knows. slaved: the slit follows it, as if
    the mount's axes crossed in the middle of the dome (ASSUMPTION: the paper gives no offsets).
    """

    def __init__(self, client: Client, side: Side, aim: Callable[[], Observed | None]) -> None:
        self._client = client
        self._side = side
        self._aim = aim
        self._follow_ns = 0
        self.slaved = False
        self.opening = False
        """The last command to the shutter was to open."""

    def reading(self, board: str) -> dict[str, float] | None:
        """Signals of a declared board's last measurement frame in their units; None: none has come."""
        return reading(self._client, board)

    def heard_s(self, board: str) -> float:
        """When its last measurement came; before all times when none has."""
        codec = codecs().get(board)
        heard_ns = None if codec is None else self._client.link.measured_ns.get(codec.identifier & 0x7F)
        return -math.inf if heard_ns is None else heard_ns * 1e-9

    def stale(self, board: str) -> bool:
        """Whether its measurement is older than it may be."""
        oldest_ns = MISSED * codecs()[board].period_ns + TICK_NS
        return self._client.now_s - self.heard_s(board) > oldest_ns * 1e-9

    def fresh(self, board: str) -> dict[str, float] | None:
        """The same as `reading`; None also when it is stale."""
        return None if self.stale(board) else self.reading(board)

    def expected(self, kind: Kind) -> list[str]:
        """Names of the boards of a kind that this network should have."""
        return [device.name for device in kind.devices() if device in self._client.devices]

    def unsafe(self) -> list[str]:
        """What speaks against an open dome, station by station; empty: nothing, or there is no station."""
        found = []
        for name in self.expected(WEATHER):
            reading = self.fresh(name)
            if reading is None:
                found.append(f"{name} is silent")
            elif reading["Unsafe"]:
                causes = [word.lower() for word in ("Rain", "Windy", "Humid") if reading[word]]
                found.append(f"{name}: {', '.join(causes) or 'bad a moment ago'}")
        return found

    def boards(self, kind: Kind) -> list[str]:
        """Names of the boards of a kind that have been heard."""
        return [name for name, number in kind.nodes.items() if number in self._client.link.measurements]

    def turn(self, azimuth_deg: float) -> Job[Reply]:
        """Turn the slit to an azimuth, 0 up to 360°."""
        if not 0 <= azimuth_deg < 360:
            raise Refused(Reason.VALUE, f"azimuth {azimuth_deg:g}° is not within 0..360°")
        if self.slaved:
            raise Refused(Reason.SLAVED, "the dome follows the telescope; end that first")
        return self._turn(azimuth_deg)

    def slave(self, on: bool) -> None:
        """Have the slit follow the telescope, or stay where it is."""
        self._there()
        self.slaved = on

    def tick(self) -> None:
        """Follow the telescope."""
        aim = self._aim() if self.slaved and self._client.now_ns >= self._follow_ns else None
        now = self.reading(DOME_BOARD.name)
        if aim is None or now is None or aim.altitude_rad > _ZENITH_RAD:
            return
        self._follow_ns = self._client.now_ns + _FOLLOW_NS
        wanted = math.degrees(aim.azimuth_rad) % 360
        slit = now["Target"] if now["Moving"] else now["Azimuth"]
        if abs(math.remainder(wanted - slit, 360)) > _FOLLOW_DEG:
            self._turn(wanted)

    def _turn(self, azimuth_deg: float) -> Job[Reply]:
        return self._tell(DOME, DOME_BOARD, "DOME_GOTO", centidegrees(azimuth_deg))

    def shutter(self, opened: bool) -> Job[Reply]:
        """Open or close; the board refuses to open in bad weather."""
        self.opening = opened
        return self._tell(DOME, DOME_BOARD, "DOME_SHUTTER", int(opened))

    def stop(self) -> Job[Reply]:
        """Stop dome, shutter and following; commands that still wait are given up: a stop is not queued."""
        self.slaved = False
        self._client.forget(DOME_BOARD)
        return self._tell(DOME, DOME_BOARD, "DOME_STOP")

    def _tell(self, kind: Kind, device: Device, name: str, *arguments: int) -> Job[Reply]:
        self._there(device)
        asked = self._client.ask(device, opcode(kind, name), *arguments)
        return self._side.start(Job(f"{device.name} {name}", asked, Activity.IDLE))

    def _there(self, device: Device = DOME_BOARD) -> None:
        if device not in self._client.link.measurements:
            raise Refused(Reason.SILENT, f"{device.name} is not on this network, or silent")
