"""The lab network with somebody who commands it, and one set of arguments for every fault of the table."""

from functools import cache
from typing import Any

from bus.can import Frame
from bus.can.candump import CandumpWriter
from bus.outside.node import OutsideNode
from bus.protocol import COMMAND_BASE, Device, Opcode, pack_command
from plant.kernels import layout as at
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wired

EXAMPLES: dict[str, dict[str, Any]] = {
    "bit_errors": {"probability": "20 %"},
    "babbler": {"identifier": 0},
    "partition": {"nodes": ["AXIS_RA", "POSITION_RA"]},
    "wrong_bitrate": {"node": "DISPLAY", "bitrate": "125 kbit/s"},
    "duplicate_node": {"node": "AXIS_RA", "period": "5 ms"},
    "forged_sender": {"identifier": 0x203, "data": 0x03},
    "stuck_dominant": {},
    "node_off": {"node": "POSITION_RA"},
    "brown_out": {"node": "POSITION_RA"},
    "reset": {"node": "POSITION_RA", "every": "40 ms"},
    "hang": {"node": "POSITION_RA"},
    "crystal_drift": {"node": "POSITION_RA", "ppm": 5000},
    "late_interrupts": {"node": "POSITION_RA"},
    "frame_loss": {"node": "POSITION_RA"},
    "deaf_controller": {"node": "AXIS_RA"},
    "endat_line": {"axis": "ra", "probability": 1.0},
    "serial_noise": {"node": "POSITION_RA", "probability": 1.0},
    "pwm_stuck": {"axis": "ra"},
    "sensor_stuck": {"sensor": "ra.absolute"},
    "sensor_noise": {"sensor": "ra.absolute", "deviation": 1000},
    "sensor_bias": {"sensor": "ra.absolute", "offset": 1000},
    "sensor_scale": {"sensor": "ra.absolute", "factor": 0.5},
    "sensor_delayed": {"sensor": "ra.absolute", "delay": "20 ms"},
    "sensor_intermittent": {"sensor": "ra.absolute", "probability": "50 %"},
    "motor_open": {"axis": "ra", "motor": "a"},
    "mosfet_short": {"axis": "ra", "motor": "a"},
    "emergency_stop": {},
    "weak_supply": {"factor": "50 %"},
    "friction_change": {"axis": "ra", "factor": 3.0},
    "load_change": {"axis": "ra", "factor": 3.0},
    "play_change": {"axis": "ra", "angle": "10 arcmin"},
}


@cache
def _parts() -> Any:
    return chosen()


class Lab:
    """Eleven boards, parked. frames: (t_end_ns, frame, sender) of everything on the wire."""

    def __init__(self) -> None:
        scenario, model = _parts()
        self.network, self.faults = wired(scenario, model)
        self.node = OutsideNode(self.network.queue, self.network.wire)
        self.log = CandumpWriter(None)
        self.frames: list[tuple[int, Frame, str]] = []
        self.network.wire.tap(self.log.take)
        self.network.wire.tap(lambda t_ns, frame, sender: self.frames.append((t_ns, frame, sender)))

    @property
    def now_ns(self) -> int:
        return self.network.queue.now_ns

    def run(self, seconds: float) -> "Lab":
        self.network.run_until(self.now_ns + round(seconds * 1e9))
        return self

    def command(self, device: Device, opcode: Opcode, *arguments: int) -> None:
        self.node.arrive(Frame(COMMAND_BASE + device, pack_command(device, opcode, *arguments)))

    def pull(self, effort: int = 1500) -> "Lab":
        """Motors of the hour axis on, loop open."""
        self.run(0.05)  # the axis board wants to know where it is
        self.command(Device.AXIS_RA, Opcode.POWER, 1)
        self.run(0.05)
        self.command(Device.AXIS_RA, Opcode.OPEN_LOOP, effort)
        return self.run(0.05)

    def since(self, t_ns: int) -> list[tuple[int, Frame, str]]:
        return [each for each in self.frames if each[0] > t_ns]

    def senders(self, t_ns: int) -> set[str]:
        return {sender for _, _, sender in self.since(t_ns)}

    def world(self, place: int, axis: int = 0) -> float:
        value: float = self.network.plant.view[axis * at.WIDTH + place]
        return value

    def positions(self, t_ns: int) -> list[tuple[int, int]]:
        """(flags, position) of the hour axis' position board."""
        frames = [frame for _, frame, _ in self.since(t_ns) if frame.identifier == 0x200 + Device.POSITION_RA]
        return [(frame.data[1], int.from_bytes(frame.data[2:6], "little")) for frame in frames]
