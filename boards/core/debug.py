"""The debug port that every board has (B9): a serial line with the board's own frames as text.

The text is the LAWICEL protocol (`slcan`) that python-can and Linux know: `O` opens, `C` closes, `tIIILDD..`
is a frame. The board takes COMMANDs for itself from the port, as if they had come by CAN. It repeats on the
port what it has put on the bus. ASSUMPTION: the paper says "serial debugging" and no more.
"""

import re
from typing import Final

from boards.core.board import Board
from boards.silicon.uart import BAUD, Sink
from bus.can import Frame, Wire
from bus.protocol import COMMAND_BASE

BITS_PER_BYTE: Final = 10
BUFFER_BYTES: Final = 256
"""Of each direction; what does not fit is lost and counted. ASSUMPTION."""
_END: Final = b"\r"
_DONE, _WRONG = b"\r", b"\a"
_VERSION: Final = b"V1013\r"
_PLAIN: Final = frozenset(b"SsWmMZXF")
"""Set-up commands of LAWICEL adapters: there is nothing to set up, but drivers send them."""
_PIECE: Final = re.compile(rb"[^\r]*\r|[^\r]+")
"""Up to the end of a line: only then does the firmware do something."""
_FRAME: Final = re.compile(rb"t([0-7][0-9A-Fa-f]{2})([0-8])((?:[0-9A-Fa-f]{2})*)")


def line_of(frame: Frame) -> bytes:
    """A standard data frame as text."""
    return f"t{frame.identifier:03X}{len(frame.data)}{frame.data.hex().upper()}".encode() + _END


def frame_of(line: bytes) -> Frame | None:
    """The frame of a line (without its end), or None when it is none."""
    found = _FRAME.fullmatch(line)
    if found is None:
        return None
    data = bytes.fromhex(found[3].decode())
    return Frame(int(found[1], 16), data) if len(data) == int(found[2]) else None


class DebugPort:
    """sink: whoever listens, called with (t_ns of the last bit, bytes). lost: bytes of lines that
    found no room in a buffer, both ways."""

    def __init__(self, board: Board, wire: Wire, baud: int = BAUD) -> None:
        self.board = board
        self.wire = wire
        self.baud = baud
        self.sink: Sink | None = None
        self.lost = 0
        self.opened = False
        self.tapped = False
        self.out_ns = 0
        self.in_ns = 0
        self.in_since_ns = 0
        self.in_bytes = 0
        self.out: list[bytes] = []
        self.incoming: list[bytes] = []
        self.partial = b""

    def write(self, t_ns: int, data: bytes) -> None:
        """The PC sends bytes from `t_ns` on; the firmware reads a line when its last byte is through."""
        room = BUFFER_BYTES - sum(map(len, self.incoming))
        self.lost += max(0, len(data) - room)
        if self.in_ns <= t_ns:
            self.in_since_ns, self.in_bytes = t_ns, 0
        for piece in _PIECE.findall(data[:room]):
            self.incoming.append(piece)
            self.in_bytes += len(piece)  # counted from the first on: rounded once, however they are cut
            self.in_ns = self.in_since_ns + self._duration_ns(self.in_bytes)
            self.board.queue.at(self.in_ns, self._read)

    def _duration_ns(self, length: int) -> int:
        return length * BITS_PER_BYTE * 1_000_000_000 // self.baud

    def _read(self, t_ns: int) -> None:
        data = self.incoming.pop(0)
        if not self.board.on:
            self.partial = b""
            return
        *lines, self.partial = (self.partial + data).split(_END)
        self.partial = self.partial[:BUFFER_BYTES]  # its head: the end of a long line is no line
        for line in lines:
            self._say(t_ns, self._obey(line))

    def _obey(self, line: bytes) -> bytes:
        """One line; returns what is said to it."""
        if not line or line[0] in _PLAIN:
            return _DONE
        if line == b"O":
            self._open()
            return _DONE
        if line == b"C":
            self.opened = False
            return _DONE
        if line == b"V":
            return _VERSION
        frame = frame_of(line)
        board = self.board
        if frame is None or frame.identifier != COMMAND_BASE + board.device_type or not self.opened:
            return _WRONG
        board.take_command(frame.data)
        return b"z" + _DONE

    def _open(self) -> None:
        self.opened = True
        if not self.tapped:
            self.tapped = True
            self.wire.tap(self._hear)

    def _hear(self, t_ns: int, frame: Frame, sender: str) -> None:
        if sender == self.board.name and self.opened:
            self._say(t_ns, line_of(frame))

    def _say(self, t_ns: int, data: bytes) -> None:
        if sum(map(len, self.out)) + len(data) > BUFFER_BYTES:
            self.lost += len(data)
            return
        self.out.append(data)
        self.out_ns = max(self.out_ns, t_ns) + self._duration_ns(len(data))
        self.board.queue.at(self.out_ns, self._through)

    def _through(self, t_ns: int) -> None:
        data = self.out.pop(0)
        if self.sink is not None:
            self.sink(t_ns, data)
