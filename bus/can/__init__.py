"""CAN 2.0: frames, their bits, one wire with arbitration and error confinement, candump logs."""

from bus.can.disturbance import Flip
from bus.can.frame import Frame, FrameError
from bus.can.port import Port
from bus.can.wire import Wire

__all__ = ["Flip", "Frame", "FrameError", "Port", "Wire"]
