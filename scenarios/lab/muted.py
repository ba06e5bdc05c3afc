"""`schmidt run --mute BOARD --feed LOG`: a board's frames from a candump log; the rest compared."""

from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

from bus.can import Frame
from bus.can.bits import INTERMISSION_BITS
from bus.can.candump import parsed
from bus.can.length import frame_bits
from bus.outside.node import OutsideNode
from bus.protocol import COMMAND_BASE, REPLY_BASE
from plant.yamltext import TextError, check_regular
from scenarios.lab.network import Network

_LONGEST = 200
"""Characters of a line read at once: candump's are shorter, and a file without lines may be large."""
_ERROR = 0x2000_0000  # CAN_ERR_FLAG (linux/can.h).


class Logged(NamedTuple):
    """A frame and when it ended, ns."""

    t_ns: int
    frame: Frame


def read(file: Path) -> Iterator[Logged]:
    """Frames of a `candump -L` log, its error frames left out; raises ValueError."""
    try:
        check_regular(file)
        with file.open(encoding="ascii", errors="replace") as lines:
            for number, line in enumerate(iter(partial(lines.readline, _LONGEST), ""), 1):
                found = parsed(line.rstrip("\n"))
                if found is None:
                    raise ValueError(f"{file}:{number}: not a line of candump -L: {line[:60]!r}")
                if not found[1].identifier & _ERROR:
                    yield Logged(*found)
    except TextError as error:
        raise ValueError(f"{file}: {error.what}") from None
    except OSError as error:
        raise ValueError(f"{file}: {error.strerror}") from None


def says(device: int, frame: Frame) -> bool:
    """Whether a frame is one that the board with this device type sends (commands to it are not)."""
    own = frame.identifier & 0x7F == device and not frame.extended
    return own and not COMMAND_BASE <= frame.identifier < REPLY_BASE


class Feed:
    """Sends a muted board's frames when the log has them: each is offered at its start of frame."""

    def __init__(self, network: Network, board: str, file: Path) -> None:
        if board not in network.boards:
            raise ValueError(
                f"--mute {board}: there is no such board; use one of {', '.join(network.boards)}"
            )
        muted = network.boards[board]
        muted.send = lambda _frame, _ready_ns: True  # in the place of its transmit buffers
        self._queue, bit_ns = network.queue, network.wire.bit_ns
        self._node = OutsideNode(self._queue, network.wire, f"{board} from the log")
        self._coming = deque(
            (logged.t_ns - (frame_bits(logged.frame) - INTERMISSION_BITS) * bit_ns, logged.frame)
            for logged in read(file)
            if says(muted.device_type, logged.frame)
        )
        if not self._coming:
            raise ValueError(f"{file}: no frame of {board} is in it")
        self._queue.at(max(0, self._coming[0][0]), self._next)

    def _next(self, t_ns: int) -> None:
        self._node.arrive(self._coming.popleft()[1])
        if self._coming:
            self._queue.at(max(t_ns, self._coming[0][0]), self._next)


@dataclass
class Rest:
    """What the other boards said, against the log. Frames that are the same, frames in the log, frames in the
    run, and the largest difference of their times."""

    same: int
    logged: int
    heard: int
    late_us: float

    def text(self) -> str:
        """One line."""
        return (
            f"the rest: {self.same} of {self.logged} frames as in the log ({self.heard} were sent), "
            f"times within {self.late_us:g} us"
        )


def compare(log: Path, run: Path, device: int) -> Rest:
    """Frames of all but one board in two logs: per identifier, in their order."""
    sides: list[dict[int, list[Logged]]] = [defaultdict(list), defaultdict(list)]
    for side, file in zip(sides, (log, run), strict=True):
        for logged in read(file):
            if not says(device, logged.frame):
                side[logged.frame.identifier].append(logged)
    same, late_ns = 0, 0
    for identifier, before in sides[0].items():
        for one, other in zip(before, sides[1].get(identifier, []), strict=False):
            if one.frame == other.frame:
                same += 1
                late_ns = max(late_ns, abs(one.t_ns - other.t_ns))
    counts = [sum(len(each) for each in side.values()) for side in sides]
    return Rest(same, counts[0], counts[1], late_ns / 1000)
