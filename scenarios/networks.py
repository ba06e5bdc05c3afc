"""Named networks: which boards are on the bus, in the order they are wired."""

from bus.protocol import Device
from bus.protocol.nodes import KINDS

LAB = (
    Device.AXIS_RA,
    Device.POSITION_RA,
    Device.MOTOR_RA_A,
    Device.MOTOR_RA_B,
    Device.AXIS_DEC,
    Device.POSITION_DEC,
    Device.MOTOR_DEC_A,
    Device.MOTOR_DEC_B,
    Device.GATEWAY,
    Device.FOCUS,
    Device.DISPLAY,
)
"""The ten nodes of L2 and the focus board; those that make up one axis first."""
SERIAL = (Device.AXIS_RA, Device.POSITION_RA, Device.AXIS_DEC, Device.POSITION_DEC, Device.FOCUS)
"""The five boards with RS232 (L3); the host reaches them by their serial lines."""
FINAL = (*LAB, *(Device(number) for kind in KINDS for number in kind.nodes.values()))
"""All, the paper's "over sixteen" (B8). Which they are is an ASSUMPTION."""

NETWORKS: dict[str, tuple[Device, ...]] = {"lab": LAB, "serial": SERIAL, "final": FINAL}
"""By the name a scenario and the command line give them."""
