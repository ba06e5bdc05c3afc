"""A board whose firmware is compiled C: the chips around it, and the calls that lead to them."""

import logging
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NoReturn

from boards.c.library import CALLS, DUTIES_FROM, ROUTINES, FirmwareError, Memory, told
from boards.core.commands import Answer, ParameterTable
from boards.core.declared import BoardError
from boards.core.interrupts import Source
from boards.core.periodic import PeriodicBoard
from boards.core.place import Place
from boards.silicon.adc import CurrentAdc
from boards.silicon.endat import EndatMaster
from boards.silicon.pwm import MotorPwm
from boards.silicon.qei import Qei
from boards.silicon.uart import Uart
from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE, Opcode, Result, pack_command, unpack_reply

_RESET, _TIMER, _FRAME, _CAN, _SENT, _INIT = range(len(ROUTINES))
(
    _CRYSTAL_100US, _READ_ENCODER, _READ_CURRENT, _READ_ENDAT, _WRITE_PWM_Q16, _CAN_FILTER, _CAN_SEND,
    _CAN_WITHDRAW, _CAN_FREE, _CAN_STATE, _CAN_TEC, _REQUEST_CAN, _CAN_NOTIFY, _UART_SEND, _BOOK_CYCLES,
    _LOST_INTERRUPTS, _COUNT_DROPPED, _DEBUG_LINE,
) = range(len(CALLS))  # fmt: skip
_PWM_PRIORITY: Final = 1 << 16
_FILTERS: Final = 6
"""Of an MCP2515."""
_STATES: Final = ("active", "passive", "bus_off")
_STAMP_NS: Final = 100_000
_ALARM, _WRONG_CRC = 1 << 30, 1 << 31
_NO_DUTIES: Final = (1 << DUTIES_FROM) - 1
_log = logging.getLogger("schmidt.firmware")


@dataclass(frozen=True, kw_only=True)
class Chips:
    """Those that a board has, beside its CAN controller and its UART."""

    qei: Qei | None = None
    pwm: MotorPwm | None = None
    adc: CurrentAdc | None = None
    endat: EndatMaster | None = None


class FirmwareBoard(PeriodicBoard):
    """memory: the board's, with its library. settings: what it is programmed with."""

    def __init__(self, place: Place, memory: Memory, chips: Chips, settings: Sequence[int] = ()) -> None:
        row = memory.row
        table = (Source("timer", *row.timer), Source("can", *row.can, level=True))
        super().__init__(place, row.fcy_hz, table, row.period_us * 1000)
        self.memory = memory
        self.qei, self.pwm, self.adc, self.endat = chips.qei, chips.pwm, chips.adc, chips.endat
        self.uart = Uart(place.queue)
        self._packet = b""
        self.parameters = _Asked(self)
        self._output_ns = 0
        self._sent: dict[int, Frame] = {}
        self._filters: tuple[list[int], list[int]] = [], []
        self._masks = [0, 0]
        self._asked: list[bytes] | None = None
        """Where replies go while a parameter is set without the bus."""
        memory.ask = self._ask
        packed = struct.pack(f"<{len(settings)}i", *settings)
        self._call(_INIT, 0, place.device_type, packed)
        groups = zip(self._masks, self._filters, strict=True)
        self.can.accept(*((mask, codes) for mask, codes in groups if codes))

    # --- what comes from outside ------------------------------------------------------------------
    def reset(self) -> None:
        """After power-up."""
        self._sent.clear()
        self._packet = b""
        self._call(_RESET, self.queue.now_ns)

    def unpowered(self, t_ns: int) -> None:
        """The gates fall without supply."""
        if self.pwm is not None:
            self.pwm.write(t_ns, 0, 0)

    def routine(self, t_ns: int) -> None:
        """Timer interrupt."""
        end = self.enter(t_ns)
        if end:
            memory, qei, epoch_ns = self.memory, self.qei, self.epoch_ns
            self._output_ns = end
            # what firmware reads first is handed in, not asked for
            there, count = (0, 0) if qei is None else (1, qei.poscnt(t_ns))
            ended = memory.run(memory.block, _TIMER, t_ns - epoch_ns, end - epoch_ns, count, there, b"")
            if ended or memory.error is not None:
                self._end(_TIMER, ended)

    def take_command(self, data: bytes) -> None:
        """A COMMAND by another way than CAN: the debug port."""
        self._receive(self.queue.now_ns, Frame(COMMAND_BASE + self.device_type, data))

    def _receive(self, t_ns: int, frame: Frame) -> None:
        if self.on:
            memory, data = self.memory, frame.data
            self._output_ns = t_ns
            now_ns, size = t_ns - self.epoch_ns, len(data)
            extended, remote = frame.extended, frame.remote
            ended = memory.frame(memory.block, now_ns, frame.identifier, extended, remote, size, data)
            if ended or memory.error is not None:
                self._end(_FRAME, ended)

    def _serve(self, t_ns: int) -> None:
        if self.on:
            self._call(_CAN, t_ns)

    def _reply_late(self, t_ns: int) -> None:
        if self._late is not None:
            self._late, self.port.on_sent = None, self._before
            self._call(_SENT, t_ns)

    def _call(self, routine: int, output_ns: int, number: int = 0, data: bytes = b"") -> None:
        memory, epoch_ns = self.memory, self.epoch_ns
        self._output_ns = output_ns
        now_ns, end_ns = self.queue.now_ns - epoch_ns, output_ns - epoch_ns
        ended = memory.run(memory.block, routine, now_ns, end_ns, number, len(data), data)
        if ended or memory.error is not None:
            self._end(routine, ended)

    def _end(self, routine: int, ended: int) -> None:
        """What a routine leaves behind."""
        if ended > _NO_DUTIES:
            self._write_pwm(ended)
            ended &= _NO_DUTIES
        self.memory.raise_error()
        if ended:
            self.on = False
            where = f"{self.memory.file}: board {self.name} fails at {self.queue.now_ns * 1e-9:.6g} s"
            raise BoardError(f"{where}: board_{ROUTINES[routine]} {told(ended)}")

    def command(self, opcode: Opcode, *arguments: int) -> Answer:
        """Have the firmware serve a command without bus and interrupt, before the simulation runs."""
        replies: list[bytes] = []
        self._asked = replies
        try:
            data = pack_command(self.device_type, opcode, *arguments)
            memory, identifier = self.memory, COMMAND_BASE + self.device_type
            now_ns = self.clock_ns(self.queue.now_ns)
            ended = memory.frame(memory.block, now_ns, identifier, False, False, len(data), data)
            self._end(_FRAME, ended)
            self._call(_CAN, self.queue.now_ns)
        finally:
            self._asked = None
        if not replies:
            raise FirmwareError(f"{self.memory.file}: board {self.name} does not answer {opcode.name}")
        _, _, result, parameter, value = unpack_reply(replies[0])
        return Answer(Result(result), parameter, value)

    # --- what the firmware calls ------------------------------------------------------------------
    def _ask(self, call: int, a: int, b: int, data: bytes) -> int:
        """The frequent ones first."""
        if call > _NO_DUTIES:
            self._write_pwm(call)
            call &= _NO_DUTIES
        if call == _READ_CURRENT:
            return (self.adc or self._lacks("ADC")).read(self.queue.now_ns, a)
        if call == _CAN_SEND:
            return self._can_send(a, data)
        if call == _READ_ENCODER:
            return (self.qei or self._lacks("encoder")).poscnt(self.queue.now_ns)
        if call == _WRITE_PWM_Q16:
            (self.pwm or self._lacks("PWM")).write_spread(self._output_ns, a, b)
            return 0
        if call == _READ_ENDAT:
            position, alarm, good = (self.endat or self._lacks("EnDat encoder")).poll(self.queue.now_ns)
            return position | _ALARM * alarm | _WRONG_CRC * (not good)
        if call == _CRYSTAL_100US:
            return self.oscillator.local_ns(self.queue.now_ns) // _STAMP_NS & 0xFFFF_FFFF
        return self._ask_can(call, a, b) if call <= _CAN_NOTIFY else self._ask_else(call, a, b, data)

    def _ask_can(self, call: int, a: int, b: int) -> int:
        if call == _CAN_FREE:
            return self.port.free_buffers
        if call == _CAN_STATE:
            return _STATES.index(self.port.state)
        if call == _CAN_TEC:
            return self.port.tec
        if call == _CAN_WITHDRAW:
            frame = self._sent.get(a)
            return 0 if frame is None else self.port.withdraw(frame)
        if call == _CAN_FILTER:
            if a >= _FILTERS:
                self._lacks(f"acceptance filter {a}")
            self._masks[a >= 2] = b >> 16
            self._filters[a >= 2].append(b & 0xFFFF)
        elif call == _REQUEST_CAN:
            if self._asked is None:
                self.cpu.lines["can"].request(self.queue.now_ns)
        elif self._late is None:  # _CAN_NOTIFY
            self._late, self._before, self.port.on_sent = b"", self.port.on_sent, self._freed
        return 0

    def _ask_else(self, call: int, a: int, b: int, data: bytes) -> int:
        if call == _UART_SEND:
            self._packet += data
            if a:
                self.uart.part(self._output_ns, data)
                return 1
            packet, self._packet = self._packet, b""
            return self.uart.send(self._output_ns, packet, len(data))
        if call == _LOST_INTERRUPTS:
            return self.cpu.overruns
        if call == _COUNT_DROPPED:
            self.dropped += 1
        elif call == _BOOK_CYCLES:
            cpu = self.cpu
            cpu.top.own_ns = cpu.cycles_ns(a)
            period_ns = 0 if self.pwm is None else self.pwm.period_ns
            cpu.steal(Source("pwm", _PWM_PRIORITY, 0, b) if b else None, period_ns)
            self.cost_ns = cpu.top.cost_ns
        elif call == _DEBUG_LINE:
            text = data.decode(errors="replace")
            _log.warning("%.6f s %s: %s", self.queue.now_ns * 1e-9, self.name, text)
        return 0

    def _lacks(self, what: str) -> NoReturn:
        raise BoardError(f"{self.memory.file}: board {self.name} has no {what}")

    def _write_pwm(self, duties: int) -> None:
        a, b = duties >> DUTIES_FROM + 16 & 0xFFFF, duties >> DUTIES_FROM & 0xFFFF
        (self.pwm or self._lacks("PWM")).write(self._output_ns, a, b)

    def _can_send(self, identifier: int, data: bytes) -> int:
        if self._asked is not None and identifier == REPLY_BASE + self.device_type:
            self._asked.append(data)
            return 1
        self._sent[identifier] = frame = Frame(identifier, data)
        return self.send(frame, self._output_ns)


class _Asked(ParameterTable):
    """The parameters as the firmware's own commands tell them."""

    def __init__(self, board: FirmwareBoard) -> None:
        super().__init__()
        self._board = board

    def get(self, number: int) -> Answer:
        """GET_PARAMETER."""
        return self._board.command(Opcode.GET_PARAMETER, number)

    def set(self, number: int, value: int) -> Answer:
        """SET_PARAMETER."""
        return self._board.command(Opcode.SET_PARAMETER, number, value)
