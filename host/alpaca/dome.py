"""IDomeV3: azimuth of the slit, shutter, and the slit following the telescope."""

import asyncio
from collections.abc import Callable

from bus.protocol import Reply
from host.alpaca.device import Device, Member, table, unknown
from host.alpaca.requests import Parameters, within
from host.procedures.dome import BOARD as DOME_BOARD
from host.telescope import Job, Telescope

_OPEN, _CLOSED, _OPENING, _CLOSING, _BETWEEN = range(5)
"""ASCOM's ShutterState; a shutter that rests between its ends is its "error"."""
_NEXT_S = 0.1
"""The board's frames are this far apart: from the next one on it says that it moves."""
_LOOK_S, _MOST_S = 0.02, 3.0
"""Wall time between looks for that frame, and at most."""


class DomeDevice(Device):
    """Commands are taken by the board before they are answered: it refuses to open in bad weather."""

    kind = "dome"
    interface_version = 3
    description = "Dome of the 50/80 cm Schmidt telescope"
    unique_id = "8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d0003"

    def reading(self) -> dict[str, float]:
        """The board's last frame."""
        found = self.desk.telescope.house.fresh(DOME_BOARD.name)
        if found is None:
            raise unknown()
        return found

    def _shutter(self, now: dict[str, float]) -> int:
        if now["ShutterMoving"]:
            return _OPENING if self.desk.telescope.house.opening and not now["BadWeather"] else _CLOSING
        return _OPEN if now["Opened"] else _CLOSED if now["Closed"] else _BETWEEN

    def state(self) -> dict[str, object]:
        """Operational properties; dome or shutter slew."""
        now = self.reading()
        slewing = bool(now["Moving"] or now["ShutterMoving"])
        return {"Azimuth": now["Azimuth"], "ShutterStatus": self._shutter(now), "Slewing": slewing}

    async def command(self, act: Callable[[Telescope], Job[Reply]]) -> None:
        """Have the board do it; answered when its frames show it."""
        await self.run(act)
        taken_s, house = self.now.t_s, self.desk.telescope.house
        for _ in range(round(_MOST_S / _LOOK_S)):
            if house.heard_s(DOME_BOARD.name) > taken_s + _NEXT_S:
                return
            await asyncio.sleep(_LOOK_S)


async def _slave(device: DomeDevice, given: Parameters) -> None:
    on = given.truth("Slaved")
    await device.do(lambda t: t.house.slave(on))


async def _turn(device: DomeDevice, given: Parameters) -> None:
    azimuth = within("Azimuth", given.number("Azimuth"), 0, 360)
    await device.command(lambda t: t.house.turn(azimuth % 360))


DomeDevice.members = table(
    "dome",
    Member("Slaved", lambda device, _: device.desk.telescope.house.slaved, _slave),
    Member("AbortSlew", put=lambda device, _: device.command(lambda t: t.house.stop())),
    Member("CloseShutter", put=lambda device, _: device.command(lambda t: t.house.shutter(False))),
    Member("OpenShutter", put=lambda device, _: device.command(lambda t: t.house.shutter(True))),
    Member("SlewToAzimuth", put=_turn),
)
