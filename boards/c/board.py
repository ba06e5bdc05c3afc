"""A board whose firmware is compiled C: the chips around it, and the calls that lead to them."""

import logging
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from boards.c.library import CALLS, ROUTINES, FirmwareError, Memory, told
from boards.core.declared import BoardError
from boards.core.interrupts import Source
from boards.core.parameters import ParameterTable
from boards.core.periodic import PeriodicBoard
from boards.core.place import Place
from boards.core.results import Answer
from boards.silicon.adc import CurrentAdc
from boards.silicon.endat import EndatMaster
from boards.silicon.pwm import MotorPwm
from boards.silicon.qei import Qei
from boards.silicon.uart import Uart
from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE, Opcode, Result, pack_command, unpack_reply

_RESET, _TIMER, _FRAME, _CAN, _SENT, _INIT = range(len(ROUTINES))
_PWM_PRIORITY: Final = 1 << 16
_STATES: Final = ("active", "passive", "bus_off")
_STAMP_NS: Final = 100_000
_ALARM, _WRONG_CRC = 1 << 30, 1 << 31
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
        self.parameters = _Asked(self)
        self._answers = [getattr(self, f"_{name}") for name in CALLS]
        self._output_ns = 0
        self._sent: dict[int, Frame] = {}
        self._filters: tuple[list[int], list[int]] = [], []
        self._masks = [0, 0]
        self._asked: list[bytes] | None = None
        """Where replies go while a parameter is set without the bus."""
        memory.ask = self._ask
        self._call(_INIT, 0, place.device_type, 0, struct.pack(f"<{len(settings)}i", *settings))
        groups = zip(self._masks, self._filters, strict=True)
        self.can.accept(*((mask, codes) for mask, codes in groups if codes))

    # --- what comes from outside ------------------------------------------------------------------
    def reset(self) -> None:
        """After power-up."""
        self._sent.clear()
        self._call(_RESET, self.queue.now_ns)

    def unpowered(self, t_ns: int) -> None:
        """The gates fall without supply."""
        if self.pwm is not None:
            self.pwm.write(t_ns, 0, 0)

    def routine(self, t_ns: int) -> None:
        """Timer interrupt."""
        end = self.enter(t_ns)
        if end:
            self._call(_TIMER, end)

    def take_command(self, data: bytes) -> None:
        """A COMMAND by another way than CAN: the debug port."""
        self._receive(self.queue.now_ns, Frame(COMMAND_BASE + self.device_type, data))

    def _receive(self, t_ns: int, frame: Frame) -> None:
        if self.on:
            kind = frame.extended + 2 * frame.remote
            self._call(_FRAME, t_ns, frame.identifier, kind, frame.data)

    def _serve(self, t_ns: int) -> None:
        if self.on:
            self._call(_CAN, t_ns)

    def _reply_late(self, t_ns: int) -> None:
        if self._late is not None:
            self._late, self.port.on_sent = None, self._before
            self._call(_SENT, t_ns)

    def _call(self, routine: int, output_ns: int, number: int = 0, kind: int = 0, data: bytes = b"") -> None:
        now_ns, epoch_ns = self.queue.now_ns, self.epoch_ns
        self._output_ns = output_ns
        ended = self.memory.run(routine, now_ns - epoch_ns, output_ns - epoch_ns, number, kind, data)
        if ended:
            self.on = False
            where = f"{self.memory.file}: board {self.name} fails at {now_ns * 1e-9:.6g} s"
            raise BoardError(f"{where}: board_{ROUTINES[routine]} {told(ended)}")

    def command(self, opcode: Opcode, *arguments: int) -> Answer:
        """Have the firmware serve a command without bus and interrupt, before the simulation runs."""
        replies: list[bytes] = []
        self._asked = replies
        try:
            data = pack_command(self.device_type, opcode, *arguments)
            self._call(_FRAME, self.queue.now_ns, COMMAND_BASE + self.device_type, 0, data)
            self._call(_CAN, self.queue.now_ns)
        finally:
            self._asked = None
        if not replies:
            raise FirmwareError(f"{self.memory.file}: board {self.name} does not answer {opcode.name}")
        _, _, result, parameter, value = unpack_reply(replies[0])
        return Answer(Result(result), parameter, value)

    # --- what the firmware calls ------------------------------------------------------------------
    def _ask(self, call: int, a: int, b: int, data: bytes) -> int:
        found: int = self._answers[call](a, b, data)
        return found

    def _missing(self, what: str) -> BoardError:
        return BoardError(f"{self.memory.file}: board {self.name} has no {what}")

    def _crystal_100us(self, _a: int, _b: int, _data: bytes) -> int:
        return self.oscillator.local_ns(self.queue.now_ns) // _STAMP_NS & 0xFFFF_FFFF

    def _read_encoder(self, _a: int, _b: int, _data: bytes) -> int:
        if self.qei is None:
            raise self._missing("encoder")
        return self.qei.poscnt(self.queue.now_ns)

    def _read_current(self, motor: int, _b: int, _data: bytes) -> int:
        if self.adc is None:
            raise self._missing("ADC")
        return self.adc.read(self.queue.now_ns, motor)

    def _read_endat(self, _a: int, _b: int, _data: bytes) -> int:
        if self.endat is None:
            raise self._missing("EnDat encoder")
        position, alarm, good = self.endat.poll(self.queue.now_ns)
        return position | _ALARM * alarm | _WRONG_CRC * (not good)

    def _write_pwm(self, a: int, b: int, _data: bytes) -> int:
        if self.pwm is None:
            raise self._missing("PWM")
        self.pwm.write(self._output_ns, a, b)
        return 0

    def _write_pwm_q16(self, a: int, b: int, _data: bytes) -> int:
        if self.pwm is None:
            raise self._missing("PWM")
        self.pwm.write_spread(self._output_ns, a, b)
        return 0

    def _can_filter(self, number: int, word: int, _data: bytes) -> int:
        group = number >= 2
        self._masks[group] = word >> 16
        self._filters[group].append(word & 0xFFFF)
        return 0

    def _can_send(self, identifier: int, _b: int, data: bytes) -> int:
        if self._asked is not None and identifier == REPLY_BASE + self.device_type:
            self._asked.append(data)
            return 1
        self._sent[identifier] = frame = Frame(identifier, data)
        return self.send(frame, self._output_ns)

    def _can_withdraw(self, identifier: int, _b: int, _data: bytes) -> int:
        frame = self._sent.get(identifier)
        return 0 if frame is None else self.port.withdraw(frame)

    def _can_free(self, _a: int, _b: int, _data: bytes) -> int:
        return self.port.free_buffers

    def _can_state(self, _a: int, _b: int, _data: bytes) -> int:
        return _STATES.index(self.port.state)

    def _can_tec(self, _a: int, _b: int, _data: bytes) -> int:
        return self.port.tec

    def _request_can(self, _a: int, _b: int, _data: bytes) -> int:
        if self._asked is None:
            self.cpu.lines["can"].request(self.queue.now_ns)
        return 0

    def _can_notify(self, _a: int, _b: int, _data: bytes) -> int:
        if self._late is None:
            self._late, self._before, self.port.on_sent = b"", self.port.on_sent, self._freed
        return 0

    def _uart_send(self, _a: int, _b: int, data: bytes) -> int:
        return self.uart.send(self._output_ns, data)

    def _book_cycles(self, timer: int, pwm: int, _data: bytes) -> int:
        cpu = self.cpu
        cpu.top.own_ns = cpu.cycles_ns(timer)
        period_ns = 0 if self.pwm is None else self.pwm.period_ns
        cpu.steal(Source("pwm", _PWM_PRIORITY, 0, pwm) if pwm else None, period_ns)
        self.cost_ns = cpu.top.cost_ns
        return 0

    def _lost_interrupts(self, _a: int, _b: int, _data: bytes) -> int:
        return self.cpu.overruns

    def _count_dropped(self, _a: int, _b: int, _data: bytes) -> int:
        self.dropped += 1
        return 0

    def _debug_line(self, _a: int, _b: int, data: bytes) -> int:
        text = data.decode(errors="replace")
        _log.warning("%.6f s %s: %s", self.queue.now_ns * 1e-9, self.name, text)
        return 0


class _Asked(ParameterTable):
    """The parameters as the firmware's own commands tell them."""

    __slots__ = ("_board",)

    def __init__(self, board: FirmwareBoard) -> None:
        super().__init__()
        self._board = board

    def get(self, number: int) -> Answer:
        """GET_PARAMETER."""
        return self._board.command(Opcode.GET_PARAMETER, number)

    def set(self, number: int, value: int) -> Answer:
        """SET_PARAMETER."""
        return self._board.command(Opcode.SET_PARAMETER, number, value)
