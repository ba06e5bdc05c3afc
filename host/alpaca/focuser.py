"""IFocuserV4: the focus drive in half steps of 6.25 µm, 0 at the inner end."""

from host.alpaca.device import Device, Member, fixed, missing, missing_put, table, unknown
from host.alpaca.errors import within
from host.alpaca.parameters import Parameters
from host.procedures.focus import TRAVEL_HALF_STEPS
from host.telescope import FocusState

MAX_STEP = 2 * TRAVEL_HALF_STEPS
STEP_UM = 6.25
"""One half step (P11)."""


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

    def focus(self) -> FocusState:
        """The last frame."""
        if self.now.focus is None:
            raise unknown()
        return self.now.focus

    @property
    def position(self) -> int:
        """Half steps from the inner end."""
        return self.focus().half_steps + TRAVEL_HALF_STEPS

    @property
    def moving(self) -> bool:
        """A move is under way."""
        return self.focus().moving or self.desk.telescope.focuser.moving

    def state(self) -> dict[str, object]:
        """Operational properties."""
        return {"IsMoving": self.moving, "Position": self.position}


async def _move(device: FocuserDevice, given: Parameters) -> None:
    position = int(within("Position", given.integer("Position"), 0, MAX_STEP))
    await device.do(lambda t: t.focuser.move_to(position - TRAVEL_HALF_STEPS))


FocuserDevice.members = table(
    Member("Absolute", fixed(True)),
    Member("IsMoving", lambda device, _: device.moving),
    Member("MaxIncrement", fixed(MAX_STEP)),
    Member("MaxStep", fixed(MAX_STEP)),
    Member("Position", lambda device, _: device.position),
    Member("StepSize", fixed(STEP_UM)),
    Member("TempComp", fixed(False), missing_put("TempComp")),
    Member("TempCompAvailable", fixed(False)),
    Member("Temperature", missing("Temperature")),
    Member("Halt", put=lambda device, _: device.run(lambda t: t.focuser.hold())),
    Member("Move", put=_move),
)
