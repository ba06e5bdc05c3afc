"""Register map, SPI instructions and BIT MODIFY, against the tables of DS20001801 as written here by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.mcp2515 import registers
from tests.boards.chips.mcp2515.bench import CONFIG, LISTEN, LOOPBACK, NORMAL, Bench

RESET = {0x0D: 0x38, 0x0E: 0x80, 0x0F: 0x87}
"""0Dh: pins read high as inputs."""


def test_after_reset_the_registers_are_the_data_sheets() -> None:
    bench = Bench()
    for address in range(0x80):
        mirrored = address & 0x0F if address & 0x0F >= 0x0E else address
        assert bench.read(address) == RESET.get(mirrored, 0), hex(address)
    # what Linux's driver looks for after RESET
    bench.start()
    bench.spi(0xC0)
    assert bench.read(0x0F) & 0x17 == 0x07
    assert bench.read(0x0E) & 0xEE == 0x80
    assert bench.read(0x2A) == bench.read(0x60) == 0


def writable(address: int) -> int:
    """Bits a microcontroller may change in configuration mode, register by register (section 11)."""
    row, column = address >> 4, address & 0x0F
    if column == 0x0F:
        return 0xFF
    if column == 0x0E or address in (0x1C, 0x1D) or (row in (6, 7) and column):
        return 0
    singles = {
        0x0C: 0x3F, 0x0D: 0x07, 0x28: 0xC7, 0x29: 0xFF, 0x2A: 0xFF, 0x2B: 0xFF, 0x2C: 0xFF, 0x2D: 0xC0,
        0x60: 0x64, 0x70: 0x60, 0x30: 0x0B, 0x40: 0x0B, 0x50: 0x0B,
    }  # fmt: skip
    if address in singles:
        return singles[address]
    if row in (3, 4, 5):
        return {2: 0xEB, 5: 0x4F}.get(column, 0xFF)
    sidl = 0xE3 if row == 2 else 0xEB
    return sidl if column % 4 == 1 else 0xFF


@pytest.mark.parametrize("address", [a for a in range(0x80) if a & 0x0F != 0x0F])
@pytest.mark.parametrize("value", [0xFF, 0x55, 0xAA])
def test_every_register_keeps_the_bits_it_has(address: int, value: int) -> None:
    bench = Bench()
    before = bench.read(address)
    bench.write(address, value)
    expected = before & ~writable(address) | value & writable(address)
    if address == 0x60:
        expected |= (expected & 4) >> 1  # BUKT1 repeats BUKT
    if address == 0x0D:
        expected = value & 7 | (7 & ~value) << 3  # pins that are inputs read high
    if address == 0x0E:
        expected = before
    assert bench.read(address) == expected


def test_there_is_a_mask_for_each_address_and_no_more() -> None:
    below = [a for a in range(0x80) if a & 0x0F < 0x0E]  # the last two columns repeat CANSTAT and CANCTRL
    assert len(registers.WRITABLE) == 0x80
    assert [registers.WRITABLE[a] for a in below] == [writable(a) for a in below]


def test_canctrl_is_written_at_every_mirror() -> None:
    for row in range(8):
        bench = Bench()
        bench.write(row << 4 | 0x0F, 0x80)
        assert bench.read(0x0F) == 0x80
        bench.write(row << 4 | 0x0E, 0x00)
        assert bench.read(row << 4 | 0x0E) == 0x80


BIT_MODIFIABLE = {0x0C, 0x0D, 0x28, 0x29, 0x2A, 0x2B, 0x2C, 0x2D, 0x30, 0x40, 0x50, 0x60, 0x70}


@pytest.mark.parametrize("address", [a for a in range(0x80) if a & 0x0F < 0x0E and writable(a)])
def test_bit_modify_obeys_its_mask_only_where_it_may(address: int) -> None:
    bench = Bench()
    bench.write(address, 0)
    bench.spi(0x05, address, 0x01, 0xFF)
    value = bench.read(address)
    wanted = 0x01 if address in BIT_MODIFIABLE else 0xFF
    fixed = 0x30 if address == 0x0D else 0  # TXRTSCTRL: two pins stay inputs and read high
    assert value == wanted & writable(address) | fixed


def test_bit_modify_of_canctrl_at_its_mirrors() -> None:
    bench = Bench()
    for row in range(8):
        bench.spi(0x05, row << 4 | 0x0F, 0x04, 0x00 if row % 2 else 0xFF)
        assert bench.read(0x0F) == (0x83 if row % 2 else 0x87)


def test_filters_masks_and_timing_are_for_configuration_mode_only() -> None:
    locked = [*range(0x0C), *range(0x10, 0x1C), *range(0x20, 0x2B), 0x0D]
    bench = Bench()
    for address in locked:
        bench.write(address, 0xFF)
    told = {address: bench.read(address) for address in locked}
    bench.mode(LISTEN)
    for address in locked:
        bench.write(address, 0x00)
        hidden = address < 0x0C or 0x10 <= address < 0x1C or 0x20 <= address < 0x28
        assert bench.read(address) == (0 if hidden else told[address])
    bench.mode(CONFIG)
    assert {address: bench.read(address) for address in locked} == told


def test_pins_interrupts_and_transmit_buffers_are_for_any_mode() -> None:
    bench = Bench().start(LISTEN)
    for address in (0x0C, 0x2B, 0x2C, 0x31, 0x41, 0x51):
        for value in (0x00, 0x15, 0x00):
            bench.write(address, value)
            assert bench.read(address) == value


def test_read_and_write_go_on_to_the_next_address_and_wrap() -> None:
    bench = Bench()
    bench.spi(0x02, 0x36, *range(1, 9))
    assert bench.spi(0x03, 0x36, *[0] * 8)[2:] == list(range(1, 9))
    assert bench.spi(0x03, 0x7F, 0, 0, 0)[2:] == [0x87, 0, 0]
    bench.spi(0x02, 0x7E, 0, 0x80, 0xAB)
    assert bench.read(0x00) == 0xAB


@pytest.mark.parametrize("buffer", range(3))
def test_a_transmit_buffer_is_locked_while_it_waits(buffer: int) -> None:
    bench, first = Bench(), 0x31 + 0x10 * buffer
    bench.write(first, *range(1, 14))
    told = bench.spi(0x03, first, *[0] * 13)
    bench.write(first - 1, 0x08)
    bench.write(first, *[0x15] * 13)
    assert bench.spi(0x03, first, *[0] * 13) == told


def test_only_the_buffer_that_waits_is_locked() -> None:
    bench = Bench()
    bench.load(1, 0x123, b"\x11\x22")
    bench.write(0x40, 0x08)
    bench.write(0x41, *range(13))
    assert bench.spi(0x03, 0x41, *[0] * 7)[2:] == [0x24, 0x60, 0, 0, 2, 0x11, 0x22]
    bench.write(0x3D, 9)
    bench.write(0x51, 7)
    assert (bench.read(0x3D), bench.read(0x51)) == (9, 7)
    bench.write(0x4D, 5)
    bench.write(0x40, 0x00)
    bench.write(0x46, 0x99)
    assert (bench.read(0x46), bench.read(0x4D)) == (0x99, 0)


def test_load_tx_and_read_rx_start_where_their_short_forms_say() -> None:
    for number, address in enumerate((0x31, 0x36, 0x41, 0x46, 0x51, 0x56)):
        bench = Bench()
        bench.spi(0x40 + number, 0xA1, 0xA2)
        assert bench.spi(0x03, address, 0, 0)[2:] == [0xA1, 0xA2]
    bench = Bench().start(LOOPBACK)
    bench.load(0, 0x7F1, b"\x0a\x0b")
    bench.spi(0x81)
    bench.run()
    assert bench.spi(0x90, *[0] * 7)[1:] == [0xFE, 0x20, 0, 0, 2, 0x0A, 0x0B]


@pytest.mark.parametrize(("instruction", "first"), [(0x90, 0x61), (0x92, 0x66), (0x94, 0x71), (0x96, 0x76)])
def test_read_rx_frees_its_buffer_when_chip_select_rises(instruction: int, first: int) -> None:
    bench = Bench().start(LOOPBACK)
    bench.write(0x60, 0x64)
    for _ in range(2):
        bench.load(0, 0x155, bytes(range(0x10, 0x18)))
        bench.spi(0x81)
        bench.run()
    assert bench.read(0x2C) & 3 == 3
    told = bench.spi(0x03, first, *[0] * 5)[2:]
    chip = bench.chip.spi
    chip.select()
    assert [chip.exchange(byte) for byte in (instruction, 0, 0, 0, 0, 0)][1:] == told
    assert bench.chip.read(0x2C) & 3 == 3
    chip.deselect()
    assert bench.read(0x2C) & 3 == (2 if first < 0x70 else 1)


def test_status_instructions_repeat_while_selected() -> None:
    bench = Bench()
    bench.load(0, 1)
    bench.load(2, 2)
    bench.spi(0x85)
    bench.write(0x2C, 0x0A)
    # READ STATUS: RX0IF, RX1IF, TXREQ0, TX0IF, TXREQ1, TX1IF, TXREQ2, TX2IF
    assert bench.spi(0xA0, 0, 0, 0)[1:] == [0b01100110] * 3
    bench.write(0x2C, 0x15)
    assert bench.spi(0xA0, 0, 0)[1:] == [0b11001101] * 2
    assert bench.spi(0xB0, 0, 0)[1:] == [0x40] * 2
    bench.write(0x2C, 0x18)
    assert bench.spi(0xA0, 0)[1] == 0b11100100


def test_an_unknown_or_broken_off_instruction_changes_nothing() -> None:
    bench = Bench().start()
    told = [bench.read(address) for address in range(0x80)]
    for first in (0x00, 0x01, 0x04, 0x46, 0x47, 0x91, 0x98, 0xA1, 0xB1, 0xC1, 0xFF):
        assert bench.spi(first, 0x2B, 0xFF, 0xFF)[1:] == [0xFF] * 3
    bench.spi(0x02, 0x2B)
    bench.spi(0x05, 0x2B, 0xFF)
    bench.spi(0x03)
    bench.spi()
    assert [bench.read(address) for address in range(0x80)] == told


def test_a_byte_that_is_not_whole_is_not_written() -> None:
    bench = Bench()
    spi = bench.chip.spi
    spi.select()
    for byte in (0x02, 0x2B):
        spi.exchange(byte)
    for _ in range(7):
        spi.clock(1)
    spi.deselect()
    assert bench.read(0x2B) == 0
    assert spi.exchange(0x02) == 0xFF
    assert spi.clock(0) == 1
    assert not spi.selected


@given(st.lists(st.lists(st.integers(0, 255), max_size=6), max_size=8))
def test_whole_bytewise_and_bitwise_are_the_same(transactions: list[list[int]]) -> None:
    whole, bytewise, bitwise = Bench().start(), Bench().start(), Bench().start()
    for data in transactions:
        one = whole.spi(*data)
        bytewise.chip.spi.select()
        two = [bytewise.chip.spi.exchange(byte) for byte in data]
        bytewise.chip.spi.deselect()
        bitwise.chip.spi.select()
        three = []
        for byte in data:
            bits = [bitwise.chip.spi.clock(byte >> shift & 1) for shift in range(7, -1, -1)]
            three.append(int("".join(map(str, bits)), 2))
        bitwise.chip.spi.deselect()
        assert one == two == three
        for bench in (whole, bytewise, bitwise):
            bench.run(0.2)
    states = [[bench.read(address) for address in range(0x80)] for bench in (whole, bytewise, bitwise)]
    assert states[0] == states[1] == states[2]
    assert whole.heard == bytewise.heard == bitwise.heard


def test_pins_for_buffers_and_requests() -> None:
    bench = Bench()
    chip = bench.chip
    assert chip.buffer_full_pin(0) is chip.buffer_full_pin(1) is None
    bench.write(0x0C, 0b000101)  # RX0BF enabled, follows RX0IF
    assert chip.buffer_full_pin(0) is True
    assert chip.buffer_full_pin(1) is None
    bench.write(0x2C, 1)
    assert chip.buffer_full_pin(0) is False
    bench.write(0x0C, 0b101000)  # RX1BF enabled as an output, high
    assert (chip.buffer_full_pin(0), chip.buffer_full_pin(1)) == (None, True)
    bench.write(0x0C, 0b011000)
    assert chip.buffer_full_pin(1) is False
    bench.write(0x0C, 0b001010)  # RX1BF follows RX1IF
    assert chip.buffer_full_pin(1) is True
    bench.write(0x2C, 2)
    assert chip.buffer_full_pin(1) is False
    bench.write(0x0D, 0b010)
    bench.start(NORMAL)
    bench.load(0, 1)
    bench.load(1, 2)
    chip.drive_rts_pin(0, False)
    chip.drive_rts_pin(1, True)
    bench.run()
    assert bench.heard == []
    assert bench.read(0x0D) == 0b010 | 0b100 << 3
    chip.drive_rts_pin(1, False)
    chip.drive_rts_pin(1, False)
    bench.run()
    chip.drive_rts_pin(1, False)  # it has been low all the time
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [2]


def test_bytes_and_bits_clocked_while_chip_select_is_high_are_nobodys() -> None:
    fresh = Bench().chip.spi
    assert [fresh.exchange(byte) for byte in (0x03, 0x2A, 0)] == [0xFF] * 3
    bench = Bench().start()
    spi = bench.chip.spi
    assert [spi.exchange(byte) for byte in (0x02, 0x0F, 0x80)] == [0xFF] * 3
    assert [spi.clock(bit) for bit in (1, 1, 0)] == [1, 1, 1]
    assert bench.read(0x0E) & 0xE0 == NORMAL
    assert bench.read(0x0F) & 0xE0 == NORMAL
    spi.select()
    assert [spi.exchange(byte) for byte in (0x03, 0x2A, 0)] == [0xFF, 0xFF, 0x00]
    spi.deselect()
    spi.deselect()  # twice is once
    assert bench.spi(0x03, 0x28, 0, 0, 0)[2:] == [0x82, 0xD0, 0x00]


def test_a_byte_may_begin_in_the_middle_of_another() -> None:
    """READ of 28h with its bits four places late: CNF3, then CNF2, straddle the bytes of the master."""
    spi = Bench().start().chip.spi
    spi.select()
    assert [spi.clock(0) for _ in range(4)] == [1, 1, 1, 1]
    assert [spi.exchange(byte) for byte in (0x32, 0x80, 0x00, 0x00)] == [0xFF, 0xF8, 0x2D, 0x00]
    spi.deselect()
