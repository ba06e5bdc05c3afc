"""What a session does from an instant on, as one digest: a snapshot's replay is held against it."""

import struct
from hashlib import sha256

from bus.can.candump import CandumpWriter
from plant.kernels import layout
from plant.plant import Plant
from scenarios.doors.livenetwork import LiveNetwork


def state_of(plant: Plant) -> bytes:
    """Every number that the plant's future depends on: all but what is recorded of it."""
    world = plant.world.copy()
    world[:, layout.TRUTH : layout.DELAYS] = 0.0
    world[:, [layout.RECORD_EVERY, layout.RECORDED]] = 0.0
    return world.tobytes() + struct.pack("<d", plant.focus.position(plant.now_ns))


class Rest:
    """From now on: every frame on the bus, and at its end the plant to the last bit."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._log = CandumpWriter(None)
        served.network.wire.tap(self._log.take)

    def digest(self) -> str:
        """Until now: SHA-256 over the log of the bus and the state of the plant."""
        plant = self._served.network.plant
        plant.advance(self._served.now_ns)
        return sha256(self._log.hexdigest().encode() + state_of(plant)).hexdigest()
