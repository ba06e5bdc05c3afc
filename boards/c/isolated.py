"""The memory of a board in a process of its own: whatever its firmware writes to, nothing else is lost.

Both ends send tuples over a pair of sockets: a call goes one way, what firmware asks meanwhile the other.
"""

import os
import subprocess
import sys
import weakref
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from socket import socketpair

from boards.c.library import Ask, Memory

_CHILD = "import sys; sys.path[:] = {path!r}; from {module} import main; main({fd}, {file!r}, {flags!r})"


class IsolatedMemory(Memory):
    """Like its base, some ten times slower: every call goes to the other process and back."""

    def __init__(self, file: Path, flags: Sequence[str] = (), ask: Ask | None = None) -> None:
        super().__init__(file, flags, ask)
        ours, theirs = socketpair()
        with theirs:
            fd = theirs.fileno()
            code = _CHILD.format(path=sys.path, module=__name__, fd=fd, file=str(file), flags=self.flags)
            self._process = subprocess.Popen([sys.executable, "-c", code], pass_fds=[fd])
        self._line = Connection(ours.detach())
        weakref.finalize(self, _end, self._line, self._process)
        self.run = lambda _block, *routine: self._over(False, *routine)
        self.frame = lambda _block, *frame: self._over(True, *frame)

    def _over(self, *order: object) -> int:
        """A routine over there; a process that dies has ended with that signal."""
        try:
            self._line.send(order)
            while isinstance(heard := self._line.recv(), tuple):
                self._line.send(self._answer(*heard))
        except (EOFError, OSError):
            return -self._process.wait()
        return int(heard)

    def _answer(self, call: int, a: int, b: int, data: bytes) -> int:
        if self.error is None and self.ask is not None:
            try:
                return self.ask(call, a, b, data)
            except BaseException as error:
                self.error = error
        return 0

    @property
    def bytes(self) -> bytes:
        """All of the board's memory."""
        self._line.send(None)
        found: bytes = self._line.recv()
        return found

    @bytes.setter
    def bytes(self, data: bytes) -> None:
        self._line.send(data)


def unbuilt(isolated: bool) -> Memory:
    """A memory as a snapshot begins it; its state builds it."""
    kind = IsolatedMemory if isolated else Memory
    return kind.__new__(kind)


def _end(line: Connection, process: subprocess.Popen[bytes]) -> None:
    line.close()
    process.kill()  # it has nothing to keep, and may be past ending by itself
    process.wait()


def main(fd: int, file: str, flags: tuple[str, ...]) -> None:
    """The other process: serves until the line is closed."""
    line = Connection(fd)

    def ask(*question: object) -> int:
        line.send(question)
        return int(line.recv())

    memory = Memory(Path(file), flags, ask)
    try:
        while True:
            order = line.recv()
            if isinstance(order, tuple):
                call = memory.frame if order[0] else memory.run
                line.send(call(memory.block, *order[1:]))
                memory.raise_error()  # the line is closed
            elif order is None:
                line.send(memory.bytes)
            else:
                memory.bytes = order
    except (EOFError, OSError):
        os._exit(0)  # firmware may have written to the interpreter's own memory, which would be tidied up now
