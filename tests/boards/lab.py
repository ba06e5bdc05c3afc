"""A small bench: the RA boards on a wire, a rigid axis behind them, a PC on the bus."""

from dataclasses import dataclass, field
from typing import Any

from boards.axis.config import AxisConfig, AxisPeers, AxisPins
from boards.axis.firmware import AxisBoard
from boards.motor_velocity.firmware import MotorVelocityBoard
from boards.position.firmware import PositionBoard
from bus.can import Frame, Wire
from bus.protocol import Device, Reply, pack_command, unpack_reply
from bus.time import EventQueue, Oscillator
from bus.units import ARCSEC, ARCSEC_PER_TURN
from tests.boards.places import place
from tests.boards.rigid import RigidAxis

CENTRE = 1 << 28
STEP_ARCSEC = ARCSEC_PER_TURN / (1 << 29)
RA = Device.AXIS_RA


def axis_config(**changes: Any) -> AxisConfig:
    """Of an axis whose drive is `RigidAxis`."""
    gains = {"kp": 3.4, "ki": 0.037, "kp_pointing": 1.0, "ki_pointing": 0.08, "ki_creep": 0.15}
    drive = {"counter_split": 10, "pwm_steps": 3000, "pwm_hz": 20_000, "kp_gust": 1.5, "ki_gust": 0.075}
    bounds = {"low": 0, "high": (1 << 29) - 1, "frame_ns": 120_000}
    return AxisConfig(**{**gains, **drive, **bounds, **changes})


@dataclass
class Lab:
    config: AxisConfig = field(default_factory=axis_config)

    def __post_init__(self) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue)
        self.plant = RigidAxis(CENTRE)
        self.frames: list[tuple[int, Frame]] = []
        self.replies: list[Reply] = []
        self.packets: list[tuple[int, bytes]] = []
        self.pc = self.wire.attach("pc")
        self.pc.on_receive = self._hear
        plant = self.plant
        self.axis = AxisBoard(
            place(Device.AXIS_RA, self.wire, Oscillator(12.0, 77_777_777)),
            AxisPins(encoder=plant.incremental, drive=plant.drive, current=plant.current),
            self.config,
            AxisPeers(position=Device.POSITION_RA, motor_a=Device.MOTOR_RA_A, motor_b=Device.MOTOR_RA_B),
        )
        self.axis.uart.sink = lambda t_ns, packet: self.packets.append((t_ns, packet))
        self.position = PositionBoard(
            place(Device.POSITION_RA, self.wire, Oscillator(-31.0, 1_234_567)), plant.absolute
        )
        motors = [
            MotorVelocityBoard(
                place(device, self.wire, Oscillator(5.0 * k, k)),
                lambda t_ns, k=k: plant.tachometer(t_ns, k),
            )
            for k, device in enumerate((Device.MOTOR_RA_A, Device.MOTOR_RA_B))
        ]
        self.boards = [self.axis, self.position, *motors]
        for board in self.boards:
            board.begin()

    def _hear(self, t_ns: int, frame: Frame) -> None:
        self.frames.append((t_ns, frame))
        if 0x100 <= frame.identifier < 0x200:
            self.replies.append(unpack_reply(frame.data))

    def run(self, seconds: float) -> None:
        self.queue.run_until(self.queue.now_ns + round(seconds * 1e9))

    def send(self, device: int, data: bytes) -> None:
        assert self.pc.send(Frame(0x080 + device, data), self.queue.now_ns)

    def command(self, opcode: int, *arguments: int, device: int = RA) -> Reply:
        """Send one command and return its one reply."""
        before = len(self.replies)
        self.send(device, pack_command(device, opcode, *arguments))
        self.run(0.005)
        assert len(self.replies) == before + 1
        return self.replies[-1]

    @property
    def angle_arcsec(self) -> float:
        """True angle from the start."""
        return self.plant.angle / ARCSEC
