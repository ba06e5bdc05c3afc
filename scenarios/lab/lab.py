"""A network in your own process: `with schmidt.Lab("lab", seed=1) as lab:`."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from bus.can import Frame
from bus.outside.node import OutsideNode
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, Reply, pack_command, unpack_reply
from plant.grid import TRUTH_COLUMNS
from scenarios.lab.faults.place import SENSORS
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wired
from scenarios.language.units import parse

if TYPE_CHECKING:
    from cantools.database import Database
    from matplotlib.figure import Figure

    from boards.core import Board
    from bus.outside.pythoncan import SchmidtBus

Table = npt.NDArray[np.void]
"""A structured array: columns by name, and `pandas.DataFrame(table)` takes it as it is."""
_FRAME = [("t_s", "f8"), ("identifier", "u4"), ("sender", "U16"), ("data", "U16")]
_ANSWER_NS, _PIECE_NS = 100_000_000, 1_000_000
"""A reply takes a few milliseconds (docs/reference/protocol.md)."""


class Lab(AbstractContextManager["Lab"]):
    """Boards, bus and plant, parked and powered; simulated time goes on in `run` and `ask` only.

    network: `lab`, `serial`, `final`, or a scenario's file, whose steps are not run. plant: a file, or the
    name of a built-in one. Any number of labs stand beside each other. Raises ValueError with one line.
    boards: by name. faults: `start`, `clear`, `running`, `evidence`. plant: the pins' other side.
    """

    def __init__(self, network: str | Path = "lab", *, plant: str | None = None, seed: int | None = None):
        file = Path(network) if Path(network).suffix else None
        scenario, model = chosen(file, seed, plant, None if file else str(network))
        self.network, self.faults = wired(scenario, model)
        self.boards: dict[str, Board] = self.network.boards
        self.plant = self.network.plant
        self._node = OutsideNode(self.network.queue, self.network.wire, "you")
        self._frames: list[tuple[int, Frame, str]] = []
        self._truth: dict[str, list[npt.NDArray[np.float64]]] = {"ra": [], "dec": []}
        self.network.wire.tap(lambda t_ns, frame, sender: self._frames.append((t_ns, frame, sender)))
        self.plant.record(lambda axis, rows: self._truth[axis].append(rows.copy()))

    def __exit__(self, *_error: object) -> None:
        """Record no more; what was recorded stays."""
        self.plant.record(None)

    @property
    def now_s(self) -> float:
        """Simulated time, s."""
        return self.network.queue.now_ns * 1e-9

    def run(self, span: str | float) -> Lab:
        """Let time go on by `2 s`, or a number of seconds; the lab, for one line of several calls."""
        seconds = parse(span, "time") if isinstance(span, str) else float(span)
        self.network.run_until(self.network.queue.now_ns + round(seconds * 1e9))
        return self

    @cached_property
    def bus(self) -> SchmidtBus:
        """A python-can bus on the wire; its `recv` lets time go on, too."""
        from bus.outside.pythoncan import SchmidtBus

        return SchmidtBus(self.network.wire)

    def ask(self, board: str, command: str, *arguments: int) -> Reply:
        """Send a command, such as `POWER`, 1, and let time go on to the reply; raises ValueError without."""
        try:
            device, opcode = Device[self.network.board(board).name], Opcode[command]
        except KeyError as error:
            known = ", ".join(Opcode.__members__)
            raise ValueError(f"{board}: no command {error}; use one of {known}") from None
        heard, queue = len(self._frames), self.network.queue
        self._node.arrive(Frame(COMMAND_BASE + device, pack_command(device, opcode, *arguments)))
        end_ns = queue.now_ns + _ANSWER_NS
        while queue.now_ns < end_ns:
            queue.run_until(queue.now_ns + _PIECE_NS)
            for _, frame, _ in self._frames[heard:]:
                if frame.identifier == REPLY_BASE + device:
                    return unpack_reply(frame.data)
            heard = len(self._frames)
        raise ValueError(f"{board} does not answer {command}")

    def pin(self, sensor: str) -> Any:
        """What a board reads of `ra.absolute` now: counts, A or V (docs/reference/faults.md lists them)."""
        if sensor not in SENSORS:
            raise ValueError(f"no sensor {sensor!r}; use one of {', '.join(SENSORS)}")
        owner, name, motor = self.faults.place.pin(sensor)
        read = owner[name] if isinstance(owner, dict) else getattr(owner, name)
        return read(self.network.queue.now_ns, *(() if motor is None else (motor,)))

    def frames(self, sender: str = "") -> Table:
        """Frames that ended so far, of one board or of all: t_s, identifier, sender, data (hexadecimal)."""
        rows = [
            (t_ns * 1e-9, frame.identifier, name, frame.data.hex())
            for t_ns, frame, name in self._frames
            if sender in ("", name)
        ]
        return np.array(rows, _FRAME)

    def signals(self, message: str) -> Table:
        """A message of the DBC, such as `AXIS_RA_MOTION`: t_s and signals in the DBC's units, else nan."""
        try:
            found = self._database.get_message_by_name(message)
        except KeyError:
            known = ", ".join(each.name for each in self._database.messages)
            raise ValueError(f"no message {message!r}; use one of {known}") from None
        names = [signal.name for signal in found.signals]
        rows = []
        for t_ns, frame, _ in self._frames:
            if frame.identifier == found.frame_id:
                values: Any = found.decode(frame.data, decode_choices=False)
                rows.append((t_ns * 1e-9, *(values.get(name, np.nan) for name in names)))
        return np.array(rows, [(name, "f8") for name in ("t_s", *names)])

    @cached_property
    def _database(self) -> Database:
        from bus.protocol.nodes.messages import documented

        return documented(self.network.devices)

    def truth(self, axis: str) -> Table:
        """What the axis `ra` or `dec` really did, every 10 ms. Columns: `TRUTH_COLUMNS` of the plant, in SI
        units, with `t_s` for the time."""
        self.plant.advance(self.network.queue.now_ns)
        self.plant.flush()
        rows = np.concatenate(self._truth[axis] or [np.empty((0, len(TRUTH_COLUMNS)))])
        return np.rec.fromarrays(rows.T, [(str(name), "f8") for name in ("t_s", *TRUTH_COLUMNS[1:])])

    def plot(self, *curves: str) -> Figure:
        """One plot below another: `ra.rate` is of the truth, `AXIS_RA_MOTION.Velocity` a signal."""
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(len(curves), sharex=True, squeeze=False)
        for curve, place in zip(curves, axes[:, 0], strict=True):
            name, _, column = curve.partition(".")
            table = self.truth(name) if name in self._truth else self.signals(name)
            place.plot(table["t_s"], table[column], drawstyle="steps-post")
            place.set_ylabel(curve)
        axes[-1, 0].set_xlabel("simulated time, s")
        return figure
