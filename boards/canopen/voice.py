"""A board's CANopen: NMT slave, heartbeat, SDO server and EMCY beside its own firmware.

The services are those of the `canopen` package's local node; here they get the board's CAN controller and
clock instead of threads. The documented frames are PDOs (`boards/canopen/pdo.py`), so they flow while the
node is OPERATIONAL.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import canopen
from canopen.objectdictionary import ODArray, ODVariable
from canopen.sdo.exceptions import SdoAbortedError

from boards.canopen.dictionary import (
    EMCY_BASE,
    FRAMES,
    HISTORY,
    MASTERS,
    PARAMETERS,
    SENT,
    STATUS_BASE,
    SYNC,
    dictionary,
)
from boards.canopen.masters import ALL, Host, Watched
from boards.canopen.pdo import RECEIVE, Pdos
from boards.canopen.server import Server
from boards.core import Board
from boards.silicon.hid import HidEndpoint
from bus.can import Frame
from bus.protocol import COMMAND_BASE, HEARTBEAT_BASE, Health, Result

logging.getLogger("canopen").addHandler(logging.NullHandler())
"""A client's mistake is answered on the bus; the package's logger would print it to the screen."""
_LOOK_NS: Final = 100_000_000
"""How often health and supply are looked at. ASSUMPTION: ten times per heartbeat."""
_AGAIN_NS: Final = 500_000
"""A frame that found no transmit buffer tries again."""
_BASES: Final = 0x780
_FIRMWARE: Final = (0x080, 0x100, 0x200, 0x300)
"""Documented frames that come in where they always did."""
_SYNC_BASES: Final = (0x180, 0x400, 0x480, 0x500)
"""Where else a SYNC may be: between the documented frames, 0x380 among them, and SDO."""
_RESET_NODE: Final = 0x81
_NMT: Final = frozenset((0x01, 0x02, 0x80, _RESET_NODE, 0x82))
"""Start, stop, pre-operational, reset node, reset communication (CiA 301, table 32)."""
_RANGE: Final = 0x06090030
_NO_DATA: Final = 0x08000024
_INCOMPATIBLE: Final = 0x06040043
_UNSTORED: Final = 0x08000020
_NO_SUBINDEX: Final = 0x06090011
"""CiA 301, table 22: value out of range, no data, incompatible parameter, not stored, no such sub-index."""
_SAVE: Final = int.from_bytes(b"save", "little")
_LOAD: Final = int.from_bytes(b"load", "little")
"""What 0x1010 and 0x1011 take (CiA 301, 7.5.2.13 and 7.5.2.14)."""
_COMMUNICATION: Final = range(0x1000, 0x2000)
_SILENT: Final = (0x8130, 0x11)
_SHORT: Final = (0x8210, 0x11)
"""Emergencies: heartbeat error; PDO not processed, too short."""
_NUMBER: Final = {base: number for number, (_, base) in enumerate(SENT)}
_CODES: Final = (
    (Health.DROPPED, 0x8110, 0x11),
    (Health.BUS, 0x8120, 0x11),
    (Health.SENSOR, 0x5000, 0x21),
    (Health.FAULT, 0xFF01, 0x81),
    (Health.LIMIT, 0xFF02, 0x81),
    (Health.OVERRUN, 0x6100, 0x81),
    (Health.STALE, 0x8100, 0x11),
)
"""Health bit, emergency error code and error register (CiA 301, tables 26 and 48), the first that is set. In
order: CAN overrun, error passive, device hardware, two of the device's own, internal software,
communication."""


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


def _member(subindex: int, found: ODVariable) -> None:
    """The package takes any sub-index of an object that has none, and of an array."""
    beyond = isinstance(found.parent, ODArray) and subindex not in found.parent.subindices
    if beyond or subindex != found.subindex:
        raise SdoAbortedError(_NO_SUBINDEX)


class Voice(canopen.Network):
    """Put between `board` and its CAN controller. node: the package's local node; number: the device type."""

    def __init__(self, board: Board) -> None:
        super().__init__()
        self.board = board
        self.number = board.device_type
        self.faults = Health(0)
        self._waiting: deque[Frame] = deque()
        self._was_on = False
        self.host: Host | None = None
        self.history: list[int] = []
        """Errors for 0x1003, the newest first."""
        self._saved: dict[int, dict[int, bytes]] = {}
        self._first = {row.number: row.read() for row in board.parameters.rows()}
        self._restored = self._alone = False
        self._send = board.send
        receive = board.port.on_receive
        assert receive is not None
        self._firmware: Callable[[int, Frame], None] = receive
        self.node = canopen.LocalNode(board.device_type, dictionary(board))
        self.node.sdo = Server(self.node, board.device_type)
        self.node.add_read_callback(self._read)
        self.node.add_write_callback(self._write)
        self.node.associate_network(self)
        self.node.emcy.cob_id = EMCY_BASE + board.device_type
        self.pdos = Pdos(self.node)
        self.watched = Watched(board.queue, board.oscillator, self._master)
        hid = getattr(board, "hid", None)
        if isinstance(hid, HidEndpoint):
            self.host = Host(hid, self._rule)
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
        base = frame.identifier - self.number
        number = _NUMBER.get(STATUS_BASE if base == HEARTBEAT_BASE else base)
        if number is None:  # the gateway's commands to others
            return self._send(frame, ready_ns)
        sent = self.pdos.event(number, frame.data)
        return sent is None or self._send(sent, ready_ns)

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """What the package says, once a buffer is free. STOPPED leaves the heartbeat (CiA 301, table 39)."""
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
        if self.operational and not frame.remote and identifier == self.pdos.of(RECEIVE).identifier:
            data = self.pdos.take(frame.data)
            if data is not None:
                self._carry_out(t_ns, data)
        elif base in _FIRMWARE and identifier not in (SYNC, COMMAND_BASE + self.number):
            if self.operational:
                self._firmware(t_ns, frame)
        elif base == STATUS_BASE and self.operational:
            self._firmware(t_ns, frame.moved(identifier - STATUS_BASE + HEARTBEAT_BASE))
        elif frame.remote:
            return
        elif identifier == int.from_bytes(self.node.get_data(0x1005, 0), "little"):
            if self.operational:
                self._sync(t_ns)
        elif base == HEARTBEAT_BASE and len(frame.data) == 1:
            self.watched.heard(identifier - base, t_ns)
            if self.host is not None and frame.data == b"\0":
                self.host.booted(identifier - base)
        elif not identifier:
            self._commanded(t_ns, frame.data)
        elif identifier == self.node.sdo.rx_cobid and self.node.nmt.state != "STOPPED":
            self.node.sdo.on_request(identifier, bytearray(frame.data), t_ns * 1e-9)

    def _sync(self, t_ns: int) -> None:
        frames, waiting = self.pdos.sync()
        for frame in frames:
            self._waiting.append(frame)
        self._drain(t_ns)
        if waiting is not None:
            self._carry_out(t_ns, waiting)

    def _carry_out(self, t_ns: int, data: bytes) -> None:
        """Data of RPDO1: the documented COMMAND is the firmware's, whatever its length."""
        if self.pdos.command():
            self._firmware(t_ns, Frame(COMMAND_BASE + self.number, data))
        elif not self.pdos.carry_out(data):
            self._emergency(*_SHORT)

    def _rule(self, specifier: int, node: int) -> None:
        """An NMT command of the host's: to the others, and to this node, which does not hear itself."""
        self.send_message(0, bytes((specifier, node)))
        if node == ALL:
            self._commanded(self.board.queue.now_ns, bytes((specifier, node)))

    def _master(self, node: int, there: bool) -> None:
        """A watched heartbeat stops: PRE-OPERATIONAL, as 0x1029 says by default; or is back."""
        if not there:
            self._emergency(*_SILENT, bytes((node,)))
            if self.operational:
                self.node.nmt.state = "PRE-OPERATIONAL"
        elif not self.faults and not self.watched.lost:
            self.node.emcy.reset()

    def _commanded(self, t_ns: int, data: bytes) -> None:
        """Carry out an NMT command, two bytes; a reset is of the board, or of its communication alone."""
        if len(data) != 2 or data[0] not in _NMT or data[1] not in (0, self.number):
            return
        self.node.nmt.on_command(0, data, t_ns * 1e-9)
        if self.node.nmt.state != "INITIALISING":
            return
        if data[0] == _RESET_NODE:
            self.board.power_off(t_ns)
            self.board.power_on(t_ns)
            self._was_on = False
            if self._restored:
                self._restored = False
                for number, value in self._first.items():
                    self.board.parameters.set(number, value)
        else:
            self._boot_up()

    def _boot_up(self) -> None:
        """Communication begins with what was saved, else with the defaults."""
        self.node.data_store = {index: dict(members) for index, members in self._saved.items()}
        self.pdos.forget()
        self.watched.set(self._masters())
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"
        if self._alone:
            self.node.nmt.state = "OPERATIONAL"

    def start_alone(self) -> None:
        """No master reaches the board: it goes OPERATIONAL by itself after every boot-up, and now."""
        self._alone = True
        self.node.nmt.state = "OPERATIONAL"

    # --- objects ----------------------------------------------------------------------------------
    def _read(self, index: int, subindex: int, od: ODVariable) -> int | None:
        _member(subindex, od)
        if index == 0x1001:
            return self._register()
        if index == 0x1003:
            if od.subindex > len(self.history):
                raise SdoAbortedError(_NO_DATA)
            return self.history[od.subindex - 1] if od.subindex else len(self.history)
        if index == FRAMES and od.subindex:
            return int.from_bytes(self.pdos.frames.get(od.subindex, b""), "little")
        answer = self.board.parameters.get(index - PARAMETERS) if index > PARAMETERS else None
        return None if answer is None or answer.result != Result.OK else answer.value

    def _write(self, index: int, subindex: int, od: ODVariable, data: bytes) -> None:
        _member(subindex, od)
        value = int.from_bytes(data, "little", signed=index > PARAMETERS)
        if index > PARAMETERS:
            if self.board.parameters.set(index - PARAMETERS, value).result != Result.OK:
                raise SdoAbortedError(_RANGE)
        elif index == FRAMES:
            self._firmware(self.board.queue.now_ns, Frame(COMMAND_BASE + self.number, bytes(data)))
        elif index == 0x1003 and value:
            raise SdoAbortedError(_RANGE)
        elif index == 0x1003:
            self.history.clear()
        elif index == 0x1005 and not (value == SYNC or (value & _BASES in _SYNC_BASES and value < 0x800)):
            raise SdoAbortedError(_RANGE)
        elif index in (0x1010, 0x1011):
            self._store(index, value)
        elif index == 0x1016:
            others = self._masters()
            del others[od.subindex - 1]
            if value & 0xFFFF and value >> 16 in {each >> 16 for each in others if each & 0xFFFF}:
                raise SdoAbortedError(_INCOMPATIBLE)
            others.insert(od.subindex - 1, value)
            self.watched.set(others)
        else:
            self.pdos.check(index, od.subindex, value)

    def _masters(self) -> list[int]:
        read = self.node.get_data
        return [int.from_bytes(read(0x1016, sub), "little") for sub in range(1, MASTERS + 1)]

    def _store(self, index: int, value: int) -> None:
        """Save communication parameters (the board's own stay as they are set), or drop what was saved."""
        if value != (_SAVE if index == 0x1010 else _LOAD):
            raise SdoAbortedError(_UNSTORED)
        store = self.node.data_store
        own = {at: dict(members) for at, members in store.items() if at in _COMMUNICATION}
        self._saved = own if index == 0x1010 else {}
        self._restored = index == 0x1011

    # --- faults -----------------------------------------------------------------------------------
    def _register(self) -> int:
        register = next((register for bit, _, register in _CODES if self.faults & bit), 0)
        return register | (_SILENT[1] if self.watched.lost else 0)

    def _emergency(self, code: int, register: int, more: bytes = b"") -> None:
        """Send an error, and remember it."""
        self.history = [code, *self.history][:HISTORY]
        self.node.emcy.send(code, register, more)

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
                    self._emergency(code, self._register(), int(known).to_bytes(2, "little"))
            if gone and not self.watched.lost:
                self.node.emcy.reset()
        self.board.queue.at(t_ns + _LOOK_NS, self._look)
