"""What the encoder says to each mode command, what the command does to it, and its memory."""

from boards.chips.endat import registers as at
from boards.chips.endat.registers import (
    ALARM_WORD,
    RECOVERY_WORD,
    WARNING_WORD,
    WRITABLE_AREAS,
    Alarm,
    Area,
    Info,
    Mode,
    Reply,
    words,
)
from boards.silicon.endat import POSITION_BITS, crc5

_STATUS = int(Area.STATUS)
_OPERATING_START = int(Area.MANUFACTURER_0)


class Memory:
    """area: selected by the last MRS (after a reset the first, ASSUMPTION)."""

    def __init__(self) -> None:
        self._words = words()
        self.power_up()

    def power_up(self) -> None:
        """Status as after switching on, with the usual alarm; parameters stay."""
        self.area = _OPERATING_START
        self._words[_STATUS, ALARM_WORD] = int(Alarm.UNDER_VOLTAGE)
        self._words[_STATUS, WARNING_WORD] = 0
        self._words[_STATUS, RECOVERY_WORD] = 0

    @property
    def alarms(self) -> int:
        """Alarm word."""
        return self._words[_STATUS, ALARM_WORD]

    @property
    def warnings(self) -> int:
        """Warning word."""
        return self._words[_STATUS, WARNING_WORD]

    @property
    def short_recovery(self) -> bool:
        """Whether the short t_m is selected."""
        return self._words[_STATUS, RECOVERY_WORD] & 3 == 1

    def raise_alarm(self, bits: int) -> None:
        """The encoder finds something wrong."""
        self._words[_STATUS, ALARM_WORD] = self.alarms | bits

    def raise_warning(self, bits: int) -> None:
        """The encoder finds something about to go wrong."""
        self._words[_STATUS, WARNING_WORD] = self.warnings | bits

    def clear_errors(self) -> None:
        """Alarms and warnings off."""
        self._words[_STATUS, ALARM_WORD] = self._words[_STATUS, WARNING_WORD] = 0

    def read(self, address: int) -> int:
        """Word of the selected area; 0 where there is none."""
        return self._words.get((self.area, address), 0)

    def write(self, address: int, value: int) -> None:
        """Write where writing is allowed; alarms and warnings can only be cleared, whole."""
        if self.area in WRITABLE_AREAS or (self.area == _STATUS and address == RECOVERY_WORD):
            self._words[self.area, address] = value
        elif self.area == _STATUS and address in (ALARM_WORD, WARNING_WORD) and not value:
            self._words[_STATUS, address] = 0


def bits_of(value: int, count: int) -> list[int]:
    """`value` in transmission order of everything but the position: most significant bit first."""
    return [value >> shift & 1 for shift in range(count - 1, -1, -1)]


def value_of(bits: list[int]) -> int:
    """Number that bits spell, most significant first."""
    value = 0
    for bit in bits:
        value = value << 1 | bit
    return value


def crc_bits(bits: list[int]) -> list[int]:
    """The five bits that follow `bits` on the line, most significant first."""
    return bits_of(crc5(value_of(bits[::-1]), len(bits)), 5)


class Answers:
    """Memory, additional information and test values of an encoder.

    temperature: 0.1 K, content 4Ch. silent_until_ns: no answer before (after a reset).
    """

    def __init__(self) -> None:
        self.memory = Memory()
        self.temperature = 2932
        self.test_values = 0
        self.silent_until_ns = 0
        self._forget()

    def _forget(self) -> None:
        """Additional information off, nothing read, nothing under way."""
        self._info_1: int | None = None
        self._info_2: int | None = None
        self._parameter = (0, 0)
        self._test_port = 0
        self.busy_until_ns = 0

    def bits(self, t_ns: int, code: int, mode: Mode, position: int, argument: int) -> list[int]:
        """Bits after the start bit, CRCs and additional information included."""
        if mode.reply is Reply.PARAMETER:
            echo = bits_of(self._act(t_ns, code, argument >> 16, argument & 0xFFFF), 24)
            return echo + crc_bits(echo)
        alarm = bool(self.memory.alarms)
        if mode.reply is Reply.TEST:
            values = [int(alarm), *bits_of(self.test_values, 40)]
            return values + crc_bits(values)
        flags = [int(alarm)] if mode.reply is Reply.POSITION else [int(alarm), int(not alarm)]
        data = flags + [position >> k & 1 for k in range(POSITION_BITS)]
        out = data + crc_bits(data)
        if mode.reply is Reply.POSITION_22:
            for info in (self._info_2, self._info_1):
                if info is not None:
                    out += self._info(t_ns, info, position)
        return out

    def _info(self, t_ns: int, info: int, position: int) -> list[int]:
        """One additional information: a start bit, 24 bits, CRC."""
        memory = self.memory
        status = info & 0x1F | at.RM
        if memory.warnings:
            status |= at.WRN
        if t_ns < self.busy_until_ns:
            status |= at.BUSY
        word = bits_of(status << 16 | self._content(info, position), 24)
        return [1, *word, *crc_bits(word)]

    def _content(self, info: int, position: int) -> int:
        """16 bits of what `info` selects; 0 for what this encoder has not got."""
        address, value = self._parameter
        wrapped = position & (1 << POSITION_BITS) - 1
        contents: dict[int, int] = {
            Info.POSITION2_LOW: wrapped & 0xFFFF,
            Info.POSITION2_MIDDLE: wrapped >> 16,
            Info.MEMORY_LSB: address << 8 | value & 0xFF,
            Info.MEMORY_MSB: address << 8 | value >> 8,
            Info.MRS_ACKNOWLEDGE: self.memory.area,
            Info.TEST_ACKNOWLEDGE: self._test_port,
            Info.TEST_LOW: self.test_values & 0xFFFF,
            Info.TEST_MIDDLE: self.test_values >> 16 & 0xFFFF,
            Info.TEST_HIGH: self.test_values >> 32,
            Info.TEMPERATURE_1: self.temperature,
            Info.ERROR_SOURCE: self.memory.alarms,
        }
        return contents.get(info, 0)

    def _act(self, t_ns: int, code: int, head: int, data: int) -> int:
        """Do what a command with an argument says; the 24 bits it answers with."""
        if code == at.SELECT_MEMORY:
            self._select(head)
        elif code == at.RECEIVE_PARAMETER:
            self.memory.write(head, data)
            data = self.memory.read(head)
        elif code == at.SEND_PARAMETER:
            data = self.memory.read(head)
        elif code == at.RECEIVE_TEST:
            self._test_port = head
        elif code == at.RECEIVE_RESET:
            self.power_up(t_ns)
        return head << 16 | data

    def supplement(self, t_ns: int, code: int, argument: int) -> None:
        """What the master adds to a position (2.2) takes effect; the next transfer shows it."""
        head, data = argument >> 16, argument & 0xFFFF
        if code == at.POSITION_SELECT:
            self._select(head)
        elif code == at.POSITION_RECEIVE:
            self.memory.write(head, data)
            self.busy_until_ns = t_ns + at.ACCESS_NS
        elif code == at.POSITION_SEND:
            self._parameter = (head, self.memory.read(head))
            self.busy_until_ns = t_ns + at.ACCESS_NS
        elif code == at.POSITION_ERROR_RESET:
            self.memory.clear_errors()
        elif code == at.POSITION_TEST:
            self._test_port = head

    def _select(self, mrs: int) -> None:
        """An MRS code selects additional information or a memory area; others do nothing."""
        if mrs >> 4 == Info.NOP_1 >> 4:
            self._info_1 = None if mrs == Info.STOP_1 else mrs
        elif mrs >> 4 == Info.NOP_2 >> 4:
            self._info_2 = None if mrs == Info.STOP_2 else mrs
        elif mrs in tuple(at.Area):
            self.memory.area = mrs

    def power_up(self, t_ns: int) -> None:
        """Reset command or supply: all forgotten but parameters, silence for 50 ms after the answer."""
        self._forget()
        self.memory.power_up()
        self.silent_until_ns = t_ns + at.ACCESS_NS + at.RESET_NS
