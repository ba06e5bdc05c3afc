"""SPI: nine instructions, by bytes or bits while chip select is low (DS20001801 section 12)."""

from enum import IntEnum
from typing import Protocol

IDLE_HIGH = 0xFF
"""What a master reads while the chip leaves SO alone. ASSUMPTION: a pull-up."""


class Instruction(IntEnum):
    """First byte after chip select; the short forms have their numbers in the low bits."""

    RESET = 0xC0
    READ = 0x03
    WRITE = 0x02
    BIT_MODIFY = 0x05
    READ_STATUS = 0xA0
    RX_STATUS = 0xB0
    READ_RX = 0x90
    LOAD_TX = 0x40
    RTS = 0x80


class Registers(Protocol):
    """What the instructions act on."""

    def read(self, address: int) -> int:
        """A register's value, 0..255."""

    def write(self, address: int, value: int, mask: int = ...) -> None:
        """Change the bits of `mask`."""

    def modify(self, address: int, mask: int, value: int) -> None:
        """BIT MODIFY."""

    def reset(self) -> None:
        """As after power-up."""

    def request_to_send(self, buffers: int) -> None:
        """RTS for a set of transmit buffers, bits 0..2."""

    def read_status(self) -> int:
        """Answer to READ STATUS."""

    def rx_status(self) -> int:
        """Answer to RX STATUS."""

    def deselected(self, buffer: int | None) -> None:
        """Chip select has risen; `buffer`: the one that READ RX BUFFER was reading."""


_READ_RX_ADDRESS = (0x61, 0x66, 0x71, 0x76)
_LOAD_TX_ADDRESS = (0x31, 0x36, 0x41, 0x46, 0x51, 0x56)


class SpiPort:
    """Shift register and instruction decoder. An unknown instruction is ignored until chip select rises."""

    def __init__(self, registers: Registers) -> None:
        self.registers = registers
        self.selected = False
        self._clear()

    def _clear(self) -> None:
        self._what: Instruction | None = None
        self._count = 0
        self._address = self._mask = 0
        self._rx: int | None = None
        self._in = self._out = self._bits = 0

    def select(self) -> None:
        """Chip select falls: the next byte is an instruction."""
        self.selected = True

    def deselect(self) -> None:
        """Chip select rises: what was begun and is not whole is forgotten."""
        if self.selected:
            self.selected = False
            buffer = self._rx
            self._clear()
            self.registers.deselected(buffer)

    def transfer(self, data: bytes) -> bytes:
        """One whole transaction: select, exchange every byte, deselect. As many bytes come back."""
        self.select()
        out = bytes(self.exchange(byte) for byte in data)
        self.deselect()
        return out

    def exchange(self, byte: int) -> int:
        """Eight clocks: a byte in, a byte out. Nobody answers while chip select is high."""
        if self.selected and not self._bits:
            whole = self._next()
            self._take(byte)
            self._count += 1
            return whole
        out = 0
        for shift in range(7, -1, -1):
            out = out << 1 | self.clock(byte >> shift & 1)
        return out

    def clock(self, bit: int) -> int:
        """One clock, most significant bit first: SI in, SO out."""
        if not self.selected:
            return 1
        if not self._bits:
            self._out = self._next()
        out = self._out >> (7 - self._bits) & 1
        self._in = self._in << 1 | bit
        self._bits += 1
        if self._bits == 8:
            byte, self._in, self._bits = self._in, 0, 0
            self._take(byte)
            self._count += 1
        return out

    def _next(self) -> int:
        """The byte that goes out during the next eight clocks."""
        registers = self.registers
        if self._what is Instruction.READ_STATUS:
            return registers.read_status()
        if self._what is Instruction.RX_STATUS:
            return registers.rx_status()
        if self._what is Instruction.READ_RX or (self._what is Instruction.READ and self._count >= 2):
            return registers.read(self._address)
        return IDLE_HIGH

    def _take(self, byte: int) -> None:
        if not self._count:
            self._decode(byte)
            return
        what = self._what
        if what is Instruction.READ_RX:
            self._address += 1
        elif what is Instruction.LOAD_TX:
            self.registers.write(self._address, byte)
            self._address += 1
        elif what is Instruction.READ or what is Instruction.WRITE:
            self._addressed(what, byte)
        elif what is Instruction.BIT_MODIFY:
            self._modify(byte)

    def _addressed(self, what: Instruction, byte: int) -> None:
        if self._count == 1:
            self._address = byte
            return
        if what is Instruction.WRITE:
            self.registers.write(self._address, byte)
        self._address += 1

    def _modify(self, byte: int) -> None:
        if self._count == 1:
            self._address = byte
        elif self._count == 2:
            self._mask = byte
        elif self._count == 3:
            self.registers.modify(self._address, self._mask, byte)

    def _decode(self, byte: int) -> None:
        if byte & 0xF9 == Instruction.READ_RX:
            self._what = Instruction.READ_RX
            self._address = _READ_RX_ADDRESS[byte >> 1 & 3]
            self._rx = byte >> 2 & 1
        elif byte & 0xF8 == Instruction.LOAD_TX and byte & 7 < len(_LOAD_TX_ADDRESS):
            self._what = Instruction.LOAD_TX
            self._address = _LOAD_TX_ADDRESS[byte & 7]
        elif byte & 0xF8 == Instruction.RTS:
            self._what = Instruction.RTS
            self.registers.request_to_send(byte & 7)
        elif byte in (
            Instruction.READ, Instruction.WRITE, Instruction.BIT_MODIFY, Instruction.READ_STATUS,
            Instruction.RX_STATUS,
        ):  # fmt: skip
            self._what = Instruction(byte)
        elif byte == Instruction.RESET:
            self.registers.reset()
