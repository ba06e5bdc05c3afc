"""IFocuserV4: the focus drive in half steps of 6.25 µm, 0 at the inner end."""

from bus.protocol import FocusFlag
from host.alpaca.device import Device, Member, fixed, missing_put, table, unknown
from host.alpaca.requests import Parameters, within
from host.procedures.focus import TRAVEL_HALF_STEPS

MAX_STEP = 2 * TRAVEL_HALF_STEPS


class FocuserDevice(Device):
    """Absolute; `Reference` finds the origin, which is lost whenever the drive is freed."""

    kind = "focuser"
    interface_version = 4
    description = "Focus of the 50/80 cm Schmidt telescope"
    unique_id = "8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d0002"
    actions = {  # noqa: RUF012
        "Reference": lambda telescope: telescope.focuser.reference(),
        "Hold": lambda telescope: telescope.focuser.hold(),
        "Free": lambda telescope: telescope.focuser.free(),
    }

    def state(self) -> dict[str, object]:
        """Operational properties: a move is under way, half steps from the inner end."""
        now = self.now.focus
        if now is None:
            raise unknown()
        moving = bool(now.flags & FocusFlag.MOVING) or self.desk.telescope.focuser.moving
        return {"IsMoving": moving, "Position": now.position + TRAVEL_HALF_STEPS}


async def _move(device: FocuserDevice, given: Parameters) -> None:
    position = int(within("Position", given.integer("Position"), 0, MAX_STEP))
    await device.do(lambda t: t.focuser.move_to(position - TRAVEL_HALF_STEPS))


FocuserDevice.members = table(
    "focuser",
    Member("MaxIncrement", fixed(MAX_STEP)),
    Member("MaxStep", fixed(MAX_STEP)),
    Member("TempComp", fixed(False), missing_put("TempComp")),
    Member("Halt", put=lambda device, _: device.run(lambda t: t.focuser.hold())),
    Member("Move", put=_move),
)
