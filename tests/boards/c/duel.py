"""The axis board in Python and the one in C beside each other: random commands and faults, first difference.

`python -m tests.boards.c.duel lab:1 final:2 [--steps N] [--file FILE]` runs some from the command line.
"""

import random
from pathlib import Path
from typing import Any

import click

from boards.axis.commands import RATE_LIMIT
from boards.c.board import FirmwareBoard
from bus.can import Frame
from bus.outside.node import OutsideNode
from bus.protocol import COMMAND_BASE, HEARTBEAT_BASE, MEASUREMENT_BASE, Device, Opcode, pack_command
from bus.protocol.scales import rate_q16
from plant.model import load
from plant.plant import Plant
from scenarios.lab.faults.live import Faults
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig, NodeConfig
from scenarios.lab.prepare import chosen
from scenarios.language.configure import parameters_of
from scenarios.native import compiled
from tests.boards.c.members import members
from tests.scenarios.lab.faults.lab import EXAMPLES

AXIS_C = Path(__file__).parents[3] / "boards" / "axis" / "axis.c"
RA = Device.AXIS_RA
PARK = 1 << 28
_AXIS_BOARDS = 4
"""RA's four come first in every network."""
_OTHER = ("POSITION_RA", "MOTOR_RA_A", "MOTOR_RA_B")
_EDGES = (0, 1, -1, 2, 3000, -3000, 3001, RATE_LIMIT, RATE_LIMIT + 1, (1 << 31) - 1, -(1 << 31))
_USUAL = {
    2: 14000, 3: 150, 4: PARK - (1 << 22), 5: PARK + (1 << 22), 6: 51380, 14: 20 << 8, 15: 3000, 40: 40 << 8,
}  # fmt: skip
"""Values of parameters with which the axis can be moved."""
_SAME = {
    "position": "motion.position", "target": "motion.profile.target", "remaining": "motion.profile.remaining",
    "speed": "motion.profile.speed", "rate": "motion.rate", "setpoint_q16": "motion.setpoint_q16",
    "wanted_q16": "motion.wanted_q16", "near_ticks": "motion.near_ticks", "velocity": "velocity",
    "effort": "effort", "poscnt": "poscnt", "effort_q16": "pi.effort_q16", "waiting": "inbox",
    "kp": "pi.kp_q12", "ki": "pi.ki_q12",
}  # fmt: skip
"""State of the C file: the Python board's name of it. A wrong line may show here long before in a frame."""
_NO_AXIS = ("wrong_bitrate", "endat_line", "serial_noise", "weak_supply", "emergency_stop")


class Difference(AssertionError):
    """The boards differ; says where, with both states."""


class Side:
    """One network, with what its axis board says."""

    def __init__(self, name: str, firmware: Path | None, seed: int) -> None:
        _, model = chosen()
        nodes = {} if firmware is None else {"AXIS_RA": NodeConfig(firmware=firmware)}
        size = _AXIS_BOARDS if name == "lab" else None
        config = NetworkConfig(name=name, nodes=nodes, size=size)
        self.network = build(config, Plant(model, seed, {"ra": PARK, "dec": PARK, "focus": 0.0}), seed)
        self.faults = Faults(self.network, seed)
        self.node = OutsideNode(self.network.queue, self.network.wire)
        self.said: list[tuple[int, str, Any]] = []
        self.network.wire.tap(lambda t_ns, frame, sender: self.said.append((t_ns, sender, frame)))
        self.network.uarts["AXIS_RA"].sink = lambda t_ns, packet: self.said.append((t_ns, "RS232", packet))

    def state(self) -> dict[str, Any]:
        """Every number of the axis board, by name."""
        board = self.network.boards["AXIS_RA"]
        if isinstance(board, FirmwareBoard):
            found = members(board.memory.file, board.memory.bytes)
            return {name: value for name, value in found.items() if name != "packet"}
        return {**dict(_numbers(board, 3)), "inbox": len(board.inbox)}


def _numbers(owner: Any, depth: int, path: str = "") -> list[tuple[str, Any]]:
    found = []
    for name, value in getattr(owner, "__dict__", {}).items():
        if isinstance(value, (int, list)) or value is None:
            found.append((path + name, value))
        elif depth and type(value).__module__.startswith("boards.axis"):
            found += _numbers(value, depth - 1, f"{path}{name}.")
    return found


class Duel:
    """Two sides that get the same. name: of the network; `final` has an auxiliary encoder."""

    def __init__(self, seed: int, file: Path = AXIS_C, name: str = "lab") -> None:
        self.random = random.Random(seed)
        self.sides = [Side(name, firmware, seed) for firmware in (None, file)]
        self.running: list[int] = []
        self.last = "nothing"
        self.compared = 0

    def run(self, steps: int) -> None:
        """So many random steps; raises Difference."""
        self.both(0.08)
        self.command(Opcode.POWER, 1)
        for _ in range(steps):
            self.step()

    def step(self) -> None:
        """Something at random, and some time."""
        draw = self.random.random()
        if draw < 0.62:
            self.command(*self.order())
        elif draw < 0.74:
            self.command(Opcode.SET_PARAMETER, *self.parameter())
        elif draw < 0.78:
            self.random.choice((self.compensate, self.observe, self.corner, self.settle, self.cut))()
        elif draw < 0.86:
            self.stray()
        elif not self.running or (draw < 0.92 and len(self.running) < 3):
            self.fault()
        else:
            self.clear()
        if self.random.random() < 0.1:
            self.command(Opcode.POWER, 1)
        self.both(self.random.choice((0.0, 0.004, 0.02, 0.1, 0.3, self.random.random())))

    def order(self) -> tuple[int, ...]:
        """A command, mostly one that is obeyed."""
        draw = self.random
        rates = [round(draw.uniform(-1, 1) * RATE_LIMIT * share) for share in (1e-4, 0.02, 1)]
        rate = draw.choice((draw.choice(_EDGES), *rates))
        here = PARK + draw.choice([0, *(draw.randint(-far, far) for far in (3000, 1 << 24, PARK))])
        offset = draw.choice((draw.choice(_EDGES[:5]), *(draw.randint(-far, far) for far in (2000, 1 << 30))))
        orders = {
            Opcode.PING: (),
            Opcode.GET_PARAMETER: (draw.randint(0, 70),),
            Opcode.POWER: (draw.choice((0, 1, 1, 1, 1, 1, 2)),),
            Opcode.STOP: (),
            Opcode.SET_RATE: (rate,),
            Opcode.SET_CLASS: (draw.randint(0, 6), draw.randint(-2, 2)),
            Opcode.MOVE_TO: (here, draw.randint(0, 6)),
            Opcode.TRACK_RATE: (rate,),
            Opcode.OPEN_LOOP: (draw.choice((*_EDGES[:7], draw.randint(-3000, 3000))),),
            Opcode.NUDGE: (offset,),
        }
        opcode = draw.choice(list(orders))
        return opcode, *orders[opcode]

    def parameter(self) -> tuple[int, int]:
        """A number and a value, within its bounds or at their edges."""
        draw = self.random
        numbers = [draw.randint(*span) for span in ((0, 43), (12, 18), (40, 42), (4, 5))]
        number = draw.choice(numbers)
        row = self.sides[0].network.boards["AXIS_RA"].parameters._rows.get(number)
        if row is None:
            return number, draw.choice(_EDGES)
        usual = _USUAL.get(number, row.high if row.high < 30 else row.high // 50)
        inside = (usual, round(usual * draw.random()), draw.randint(row.low, row.high))
        value = draw.choice((*inside, row.low, row.low - 1, row.high, row.high + 1))
        return number, max(-(1 << 31), min((1 << 31) - 1, value))

    def compensate(self) -> None:
        """Firmware as for a compensation: spread duty, waves, friction, and a motion in which they act."""
        draw = self.random
        waves = [draw.randint(-5000, 5000) for _ in range(6)]
        waves[::3] = draw.randint(1, 90) << 16, draw.randint(1, 90) << 16
        friction = ((14, draw.randint(1, 50) << 8), (15, draw.randint(1, 3000)))
        for number, value in (*friction, *enumerate(waves, 16), (12, 1), (13, 1)):
            self.command(Opcode.SET_PARAMETER, number, value)
            self.both(0.002)
        self.command(Opcode.SET_CLASS, draw.randint(2, 5), draw.choice((-1, 1)))

    def observe(self) -> None:
        """An observer, at times with a coefficient of another, and the rate that it was made for."""
        wanted = parameters_of("observer", load("high_preload_motor_units"))
        for place, (number, value) in enumerate(wanted.items(), 1):
            self.command(Opcode.SET_PARAMETER, number, value + (self.random.random() < 0.01) * (1 << 27))
            if place % 6 == 0:  # as many as wait at a board
                self.both(0.01)
        order = self.random.choice(((Opcode.SET_CLASS, 5, 1), (Opcode.TRACK_RATE, rate_q16(15.041))))
        self.command(*order)
        self.both(self.random.uniform(0.5, 4.0))

    def corner(self) -> None:
        """Fast towards a soft limit that lies near, the axis board's own or the encoder board's."""
        draw = self.random
        whose = draw.choice((RA, RA, Device.POSITION_RA))
        board = self.sides[0].network.boards["AXIS_RA"]
        here, way = board.motion.position, draw.choice((-1, 1))
        for number, away in ((4, -1), (5, 1)):
            limit = here + away * draw.choice((draw.randint(1 << 17, 1 << 20), 1 << 26))
            self.command(Opcode.SET_PARAMETER, number, max(0, min((1 << 29) - 1, limit)), device=whose)
            self.both(0.002)
        self.command(Opcode.POWER, 1)
        self.both(0.002)
        self.command(Opcode.SET_CLASS, draw.randint(1, 2), way)
        self.both(draw.uniform(0.5, 2.0))

    def settle(self) -> None:
        """Short moves, each until it has settled: that shows in a tick of fifty."""
        draw = self.random
        self.command(Opcode.POWER, 1)
        self.both(0.002)
        for _ in range(12):
            here = self.sides[0].network.boards["AXIS_RA"].motion.position
            self.command(Opcode.MOVE_TO, here + draw.randint(-2000, 2000), 3)
            self.both(draw.uniform(0.7, 1.0))

    def cut(self) -> None:
        """The supply fails while commands wait."""
        for _ in range(12):
            self.command(*self.order())
        for _ in range(200):
            self.both(1e-5)
            if len(self.sides[0].network.boards["AXIS_RA"].inbox) > 1:
                break
        numbers = [side.faults.start("node_off", node="AXIS_RA") for side in self.sides]
        self.both(0.004)
        for side, number in zip(self.sides, numbers, strict=True):
            side.faults.clear(number)
        self.both(0.5)

    def stray(self) -> None:
        """Frames that nobody should send, and many commands at once."""
        draw = self.random
        device = int(draw.choice((RA, Device.POSITION_RA, Device.MOTOR_RA_A, Device.MOTOR_RA_B)))
        base = COMMAND_BASE if device == RA else draw.choice((MEASUREMENT_BASE, HEARTBEAT_BASE))
        for _ in range(draw.choice((1, 1, 12))):
            data = bytes((draw.choice((device, device, 0x55)), *draw.randbytes(draw.choice((0, 3, 7, 7, 7)))))
            frame = Frame(base + device, data, draw.random() < 0.1, draw.random() < 0.1)
            self.last = repr(frame)
            for side in self.sides:
                side.node.arrive(frame)

    def fault(self) -> None:
        """One of the table."""
        draw = self.random
        name = draw.choice([each for each in EXAMPLES if each not in _NO_AXIS])
        given = dict(EXAMPLES[name])
        if "node" in given:
            given["node"] = draw.choice(("AXIS_RA", "AXIS_RA", *_OTHER))
        if "sensor" in given:
            given["sensor"] = draw.choice(
                ("ra.incremental", "ra.absolute", "ra.tachometer_a", "ra.current_b")
            )
        self.last = f"fault {name} {given}"
        if name not in [each.name for each in self.sides[0].faults.running]:  # some bear no second one
            self.running.append(self.sides[0].faults.start(name, **given))
            assert self.sides[1].faults.start(name, **given) == self.running[-1]

    def clear(self) -> None:
        """A fault that is on ends."""
        number = self.running.pop(self.random.randrange(len(self.running)))
        self.last = f"clear {number}"
        for side in self.sides:
            side.faults.clear(number)

    def command(self, opcode: int, *arguments: int, device: Device = RA) -> None:
        """One to both."""
        self.last = f"{Opcode(opcode).name} {arguments} to {device.name}"
        for side in self.sides:
            side.node.arrive(Frame(COMMAND_BASE + device, pack_command(device, opcode, *arguments)))

    def both(self, seconds: float) -> None:
        """Let time go on and compare."""
        for side in self.sides:
            side.network.run_until(side.network.queue.now_ns + round(seconds * 1e9))
        one, other = (side.said for side in self.sides)
        self.compared += len(one)
        if one != other:
            pairs = enumerate(zip(one, other, strict=False))
            k = next((k for k, pair in pairs if pair[0] != pair[1]), min(len(one), len(other)))
            told = [f"after {self.last}, {self.compared - len(one) + k} equal ones; Python, then C:"]
            for side in self.sides:
                told += [f"  {side.said[k] if k < len(side.said) else 'nothing'}", f"    {side.state()}"]
            raise Difference("\n".join(told))
        self.compare_states()
        for side in self.sides:
            side.said.clear()

    def compare_states(self) -> None:
        """Numbers that both firmwares keep; the library does not show the Python board's."""
        if compiled():
            return
        python, c = (side.state() for side in self.sides)
        apart = [
            f"{one} {c[one]}, {other} {python[other]}"
            for one, other in _SAME.items()
            if c[one] != python[other]
        ]
        if apart and self.sides[0].network.boards["AXIS_RA"].on:
            raise Difference(
                f"after {self.last}, {self.compared} equal frames; C, then Python: {'; '.join(apart)}"
            )


@click.command()
@click.argument("duels", nargs=-1, required=True)
@click.option("--steps", default=300)
@click.option("--file", type=click.Path(path_type=Path), default=AXIS_C)
def main(duels: tuple[str, ...], steps: int, file: Path) -> None:
    """Run DUELS, each NETWORK:SEED, until one ends with a difference."""
    for each in duels:
        name, _, seed = each.partition(":")
        duel = Duel(int(seed), file, name)
        duel.run(steps)
        print(f"{each}: {duel.compared} frames and packets are the same")


if __name__ == "__main__":
    from tests.boards.c.duel import main as command  # its errors have the module's name

    command()
