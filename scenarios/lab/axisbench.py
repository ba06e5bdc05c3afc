"""The smallest bench: the RA axis board and its EnDat board on a bus, told what to do by CAN frames."""

from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, pack_command, unpack_reply
from plant.parts import PlantModel
from plant.plant import Plant
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig

AXIS = Device.AXIS_RA
_BOARDS = 2  # The first of the lab network's order.
_ANSWER_S = 0.02
_HEARD_S = 0.2  # The EnDat board has to be heard before the motors may be switched on.


class AxisBench:
    """Time goes on in `wait` and `command` only. start_steps: where the axis stands, absolute encoder."""

    def __init__(self, model: PlantModel, seed: int, start_steps: float) -> None:
        self.plant = Plant(model, seed, {"ra": start_steps})
        self.network = build(NetworkConfig(size=_BOARDS), self.plant, seed)
        self._port = self.network.wire.attach("bench")
        self._port.accept([(0x7FF, REPLY_BASE + AXIS)])
        self._port.on_receive = self._hear
        self._results: dict[int, int] = {}
        self._now_ns = 0
        self.wait(_HEARD_S)

    def wait(self, seconds: float) -> None:
        """Let simulated time go on."""
        self._now_ns += round(seconds * 1e9)
        self.network.run_until(self._now_ns)

    def command(self, opcode: Opcode, *arguments: int) -> None:
        """Send a command and wait for its answer; raises ValueError when it is not "ok"."""
        self._results.clear()
        self._port.send(Frame(COMMAND_BASE + AXIS, pack_command(AXIS, opcode, *arguments)), self._now_ns)
        self.wait(_ANSWER_S)
        result = self._results.get(opcode)
        if result != 0:
            told = f"not answered within {_ANSWER_S * 1e3:g} ms" if result is None else f"refused: {result}"
            raise ValueError(f"axis board: {opcode.name} {arguments} was {told}")

    def _hear(self, _t_ns: int, frame: Frame) -> None:
        reply = unpack_reply(frame.data)
        self._results[reply.opcode] = reply.result
