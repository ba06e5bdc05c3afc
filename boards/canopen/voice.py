"""A board's CANopen: NMT slave, heartbeat, SDO server and EMCY beside its own firmware.

The services are those of the `canopen` package's local node; here they get the board's CAN controller and
clock instead of threads. The documented frames are PDOs, so they flow while the node is OPERATIONAL.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Final

import canopen
from canopen.objectdictionary import ODVariable
from canopen.sdo.exceptions import SdoAbortedError

from boards.canopen.dictionary import EMCY_BASE, PARAMETERS, STATUS_BASE, dictionary
from boards.core import Board
from bus.can import Frame
from bus.protocol import HEARTBEAT_BASE, Health, Result

_LOOK_NS: Final = 100_000_000
"""How often health and supply are looked at. ASSUMPTION: ten times per heartbeat."""
_AGAIN_NS: Final = 500_000
"""A frame that found no transmit buffer tries again."""
_BASES: Final = 0x780
_FIRMWARE: Final = (0x080, 0x100, 0x200, 0x300)
"""Documented frames that come in where they always did."""
_RESET_NODE: Final = 0x81
_RANGE: Final = 0x06090030
"""Abort code: value out of range (CiA 301, table 22)."""
_CODES: Final = (
    (Health.DROPPED, 0x8110, 0x11),
    (Health.BUS, 0x8120, 0x11),
    (Health.SENSOR, 0x5000, 0x21),
    (Health.FAULT, 0xFF01, 0x81),
    (Health.LIMIT, 0xFF02, 0x81),
    (Health.OVERRUN, 0x6100, 0x81),
    (Health.STALE, 0x8100, 0x11),
)
"""Health bit, emergency error code and error register (CiA 301, tables 26 and 48), the first that is set: CAN
overrun, error passive, device hardware, two of the device's own, internal software, communication."""


class _Task:
    """A periodic frame on the board's crystal; what `canopen` expects of one."""

    def __init__(self, voice: Voice, identifier: int, data: bytes, period_ns: int) -> None:
        self._voice, self._identifier, self._data, self._period = voice, identifier, bytes(data), period_ns
        self._alive = True
        self._arm(voice.board.queue.now_ns)

    def _arm(self, t_ns: int) -> None:
        crystal = self._voice.board.oscillator
        self._voice.board.queue.at(crystal.true_ns(crystal.local_ns(t_ns) + self._period), self._tick)

    def _tick(self, t_ns: int) -> None:
        if self._alive:
            self._voice.send_message(self._identifier, self._data)
            self._arm(t_ns)

    def stop(self) -> None:
        """No more."""
        self._alive = False

    def update(self, data: bytes) -> None:
        """Other bytes from the next one on."""
        self._data = bytes(data)


class Voice(canopen.Network):
    """Put between `board` and its CAN controller. node: the package's local node; number: the device type."""

    def __init__(self, board: Board) -> None:
        super().__init__()
        self.board = board
        self.faults = Health(0)
        self._waiting: deque[Frame] = deque()
        self._was_on = False
        self._send = board.send
        receive = board.port.on_receive
        assert receive is not None
        self._firmware: Callable[[int, Frame], None] = receive
        self.node = canopen.LocalNode(board.device_type, dictionary(board))
        self.node.add_read_callback(self._read)
        self.node.add_write_callback(self._write)
        self.node.associate_network(self)
        self.node.emcy.cob_id = EMCY_BASE + board.device_type
        board.send = self._pdo
        board.port.on_receive = self._receive
        board.port.accept(None)
        self._look(board.queue.now_ns)

    @property
    def operational(self) -> bool:
        """Whether PDOs flow."""
        return bool(self.node.nmt.state == "OPERATIONAL")

    # --- to the bus -------------------------------------------------------------------------------
    def _pdo(self, frame: Frame, ready_ns: int) -> bool:
        """A documented frame of the firmware's; outside OPERATIONAL it is not sent and not missed."""
        if not self.operational:
            return True
        if frame.identifier & _BASES == HEARTBEAT_BASE:
            frame = frame.moved(frame.identifier - HEARTBEAT_BASE + STATUS_BASE)
        return self._send(frame, ready_ns)

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """What the package has to say; waits for a transmit buffer. STOPPED leaves the heartbeat (CiA 301,
        table 39)."""
        stopped = self.node.nmt.state == "STOPPED" and can_id & _BASES != HEARTBEAT_BASE
        if self.board.on and not stopped:
            self._waiting.append(Frame(can_id, bytes(data), remote=remote))
            self._drain(self.board.queue.now_ns)

    def _drain(self, t_ns: int) -> None:
        while self._waiting and self._send(self._waiting[0], t_ns):
            self._waiting.popleft()
        if self._waiting:
            self.board.queue.at(t_ns + _AGAIN_NS, self._drain)

    def send_periodic(self, can_id: int, data: Any, period: float, remote: bool = False) -> Any:
        """The heartbeat."""
        return _Task(self, can_id, data, round(period * 1e9))

    # --- from the bus -----------------------------------------------------------------------------
    def _receive(self, t_ns: int, frame: Frame) -> None:
        identifier = frame.identifier
        if frame.extended or not self.board.on:
            return
        base = identifier & _BASES
        if base in _FIRMWARE and identifier != 0x080:
            if self.operational:
                self._firmware(t_ns, frame)
        elif base == STATUS_BASE and self.operational:
            self._firmware(t_ns, frame.moved(identifier - STATUS_BASE + HEARTBEAT_BASE))
        elif identifier in self.subscribers and not frame.remote:
            self.notify(identifier, bytearray(frame.data), t_ns * 1e-9)
            if not identifier:
                self._commanded(t_ns, frame.data)

    def _commanded(self, t_ns: int, data: bytes) -> None:
        """Carry out a reset: of the board, or of its communication alone."""
        if self.node.nmt.state != "INITIALISING":
            return
        if data[0] == _RESET_NODE:
            self.board.power_off(t_ns)
            self.board.power_on(t_ns)
            self._was_on = False
        else:
            self._boot_up()

    def _boot_up(self) -> None:
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    # --- objects ----------------------------------------------------------------------------------
    def _read(self, index: int, od: ODVariable, **_: object) -> int | None:
        if index == 0x1001:
            return self._register()
        answer = self.board.parameters.get(index - PARAMETERS) if index > PARAMETERS else None
        return None if answer is None or answer.result != Result.OK else answer.value

    def _write(self, index: int, od: ODVariable, data: bytes, **_: object) -> None:
        if index > PARAMETERS:
            value = int.from_bytes(data, "little", signed=True)
            if self.board.parameters.set(index - PARAMETERS, value).result != Result.OK:
                raise SdoAbortedError(_RANGE)

    # --- faults -----------------------------------------------------------------------------------
    def _register(self) -> int:
        return next((register for bit, _, register in _CODES if self.faults & bit), 0)

    def _look(self, t_ns: int) -> None:
        """Boot-up after power; EMCY when a fault comes, and its reset when the last has gone."""
        if self.board.on and not self._was_on:
            self._boot_up()
        self._was_on = self.board.on
        if self.board.on:
            known = self.board.health() & sum(bit for bit, _, _ in _CODES)
            new = known & ~self.faults
            gone = self.faults and not known
            self.faults = Health(known)
            for bit, code, _ in _CODES:
                if new & bit:
                    self.node.emcy.send(code, self._register(), int(known).to_bytes(2, "little"))
            if gone:
                self.node.emcy.reset()
        self.board.queue.at(t_ns + _LOOK_NS, self._look)
