"""Where the benches put a board."""

from boards.core import Place
from bus.can import Wire
from bus.protocol import Device
from bus.time import Oscillator


def place(device: Device, wire: Wire, oscillator: Oscillator) -> Place:
    """A board of the lab, on `wire` and in its time."""
    number = int(device)
    return Place(name=device.name, device_type=number, queue=wire.queue, wire=wire, oscillator=oscillator)
