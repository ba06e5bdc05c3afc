"""Masks, filters, roll-over, overflow, RX STATUS (DS20001801 section 4, figure 12-9)."""

import pytest

from bus.can import Frame
from tests.boards.chips.mcp2515.bench import LISTEN, NORMAL, Bench

RX0, RX1, ERR = 0x01, 0x02, 0x20
FILTER = (0x00, 0x04, 0x08, 0x10, 0x14, 0x18)
MASK = (0x20, 0x24)


def standard(identifier: int, first: int = 0, second: int = 0) -> tuple[int, int, int, int]:
    return identifier >> 3, (identifier & 7) << 5, first, second


def extended(identifier: int) -> tuple[int, int, int, int]:
    top = identifier >> 18
    return top >> 3, (top & 7) << 5 | 8 | identifier >> 16 & 3, identifier >> 8 & 0xFF, identifier & 0xFF


def filtered(
    masks: dict[int, tuple[int, int, int, int]],
    filters: dict[int, tuple[int, int, int, int]],
    rxb0: int = 0,
    rxb1: int = 0,
) -> Bench:
    """Filters not named stand at an identifier nobody sends."""
    bench = Bench()
    for number in range(2):
        bench.write(MASK[number], *masks.get(number, (0xFF, 0xE3, 0xFF, 0xFF)))
    for number in range(6):
        bench.write(FILTER[number], *filters.get(number, extended(0x1ABCDEF0)))
    bench.write(0x28, 0x82, 0xD0, 0x00)
    bench.write(0x60, rxb0)
    bench.write(0x70, rxb1)
    bench.mode(NORMAL)
    return bench


@pytest.mark.parametrize("number", range(6))
def test_each_filter_leads_to_its_buffer_and_says_its_number(number: int) -> None:
    every_bit = standard(0x7FF)
    bench = filtered({0: every_bit, 1: every_bit}, {number: standard(0x345)})
    bench.partner_sends(Frame(0x344, b""), Frame(0x345, b"\x01"))
    buffer = 0 if number < 2 else 1
    assert bench.read(0x2C) == (RX0, RX1)[buffer]
    assert bench.read((0x60, 0x70)[buffer]) & 7 == number
    assert bench.spi(0xB0, 0)[1] == 0x40 << buffer | number


def test_the_lowest_filter_and_the_first_buffer_win() -> None:
    every_bit = standard(0x7FF)
    bench = filtered({0: every_bit, 1: every_bit}, {n: standard(0x345) for n in range(6)})
    bench.partner_sends(Frame(0x345, b""))
    assert bench.read(0x2C) == RX0
    assert bench.read(0x60) & 1 == 0
    bench = filtered({0: every_bit, 1: every_bit}, {n: standard(0x345) for n in range(3, 6)})
    bench.partner_sends(Frame(0x345, b""))
    assert bench.read(0x70) & 7 == 3


@pytest.mark.parametrize("bit", range(11))
def test_every_bit_of_a_standard_mask_counts(bit: int) -> None:
    bench = filtered({0: standard(0x7FF)}, {0: standard(0x2AA)})
    bench.partner_sends(Frame(0x2AA ^ 1 << bit, b""))
    assert bench.read(0x2C) == 0
    bench = filtered({0: standard(0x7FF ^ 1 << bit)}, {0: standard(0x2AA)})
    bench.partner_sends(Frame(0x2AA ^ 1 << bit, b""))
    assert bench.read(0x2C) == RX0


@pytest.mark.parametrize("bit", range(29))
def test_every_bit_of_an_extended_mask_counts(bit: int) -> None:
    wanted = 0x0AAAAAAA
    bench = filtered({1: extended(0x1FFFFFFF)}, {4: extended(wanted)})
    bench.partner_sends(Frame(wanted ^ 1 << bit, b"", extended=True))
    assert bench.read(0x2C) == 0
    bench.partner_sends(Frame(wanted, b"", extended=True))
    assert bench.read(0x2C) == RX1
    bench = filtered({1: extended(0x1FFFFFFF ^ 1 << bit)}, {4: extended(wanted)})
    bench.partner_sends(Frame(wanted ^ 1 << bit, b"", extended=True))
    assert bench.read(0x2C) == RX1


def test_a_filter_is_for_one_kind_of_identifier_whatever_the_mask() -> None:
    nothing = (0, 0, 0, 0)
    bench = filtered({0: nothing}, {0: standard(0), 1: standard(0)})
    bench.partner_sends(Frame(0x1234567, b"", extended=True))
    assert bench.read(0x2C) == 0
    bench = filtered({0: nothing}, {0: extended(0), 1: extended(0)})
    bench.partner_sends(Frame(0x123, b""))
    assert bench.read(0x2C) == 0
    bench.partner_sends(Frame(0x1234567, b"", extended=True))
    assert bench.read(0x2C) == RX0


@pytest.mark.parametrize(
    ("data", "taken"),
    [
        (b"\xab\xcd", True),
        (b"\xab\xcd\x00", True),
        (b"\xaa\xcd", False),
        (b"\xab\xcc", False),
        (b"\xab", False),
    ],
)
def test_filters_look_at_the_first_two_data_bytes_of_standard_frames(data: bytes, taken: bool) -> None:
    bench = filtered({0: standard(0x7FF, 0xFF, 0xFF)}, {1: standard(0x111, 0xAB, 0xCD)})
    bench.partner_sends(Frame(0x111, data))
    assert bench.read(0x2C) == (RX0 if taken else 0)


@pytest.mark.parametrize(
    ("rxm", "frame", "taken"),
    [
        (0, Frame(0x111, b"\x00\x00"), False),
        (1, Frame(0x111, b"\x00\x00"), True),  # data bytes count under 00 only
        (1, Frame(0x111 << 18, b"", extended=True), False),
        (2, Frame(0x111, b""), False),
        (2, Frame(0x111 << 18 | 0x0ABCD, b"", extended=True), True),
        (2, Frame(0x112 << 18 | 0x0ABCD, b"", extended=True), False),
        (3, Frame(0x7FF, b""), True),
        (3, Frame(0x1FFFFFFF, b"", extended=True), True),
    ],
)
def test_receive_modes(rxm: int, frame: Frame, taken: bool) -> None:
    filters = {0: standard(0x111, 0xAB, 0xCD), 1: extended(0x111 << 18 | 0xABCD)}
    bench = filtered({0: (0xFF, 0xE3, 0xFF, 0xFF)}, filters, rxb0=rxm << 5)
    bench.partner_sends(frame)
    assert bench.read(0x2C) == (RX0 if taken else 0)


def test_a_standard_frame_has_no_identifier_bits_17_and_16() -> None:
    """They stand beside SID2-0 in SIDL, and are for extended identifiers (registers 4-11 and 4-15)."""
    high, low, _, _ = standard(0x345)
    bench = filtered({0: (0xFF, 0xE3, 0, 0)}, {0: (high, low | 0x03, 0, 0)})
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert bench.read(0x2C) == RX0


def test_with_filters_off_the_first_filter_of_the_buffer_is_named() -> None:
    """RXM = 11 (ASSUMPTION: the data sheet leaves FILHIT open then)."""
    bench = filtered({}, {}, rxb0=0x60 | 0x04, rxb1=0x60)
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert (bench.read(0x60) & 1, bench.spi(0xB0, 0)[1] & 7) == (0, 0)
    bench = filtered({}, {}, rxb0=0x40, rxb1=0x60)
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert (bench.read(0x70) & 7, bench.spi(0xB0, 0)[1] & 7) == (2, 2)


@pytest.mark.parametrize("number", [0, 1])
def test_roll_over_and_overflow(number: int) -> None:
    every_bit = standard(0x7FF)
    codes = {number: standard(0x345), 1 - number: standard(0x001)}
    bench = filtered({0: every_bit, 1: every_bit}, codes, rxb0=0x04)
    bench.write(0x2B, ERR)
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert bench.read(0x60) == 0x06 | number
    bench.write(0x60, 0x04)
    assert bench.read(0x60) == 0x06 | number  # FILHIT0 cannot be written
    bench.partner_sends(Frame(0x345, b"\x02"))
    assert bench.read(0x2C) == RX0 | RX1
    assert bench.read(0x70) == 6 + number
    assert bench.read(0x66) == 1
    assert bench.read(0x76) == 2
    assert bench.spi(0xB0, 0)[1] == 0xC0 | number  # buffer 0 first
    assert bench.pin == []
    bench.partner_sends(Frame(0x345, b"\x03"))
    assert (bench.read(0x66), bench.read(0x76)) == (1, 2)
    assert bench.read(0x2D) == 0x80
    assert bench.read(0x2C) == RX0 | RX1 | ERR
    assert bench.pin == [True]
    bench.spi(0x05, 0x2C, RX0, 0)
    assert bench.spi(0xB0, 0)[1] == 0x80 | 6 + number
    bench.spi(0x05, 0x2D, 0x80, 0)
    assert bench.read(0x2D) == 0


def test_without_roll_over_buffer_0_overflows_alone() -> None:
    every_bit = standard(0x7FF)
    bench = filtered({0: every_bit, 1: every_bit}, {0: standard(0x345), 2: standard(0x345)})
    bench.partner_sends(Frame(0x345, b"\x01"), Frame(0x345, b"\x02"))
    assert bench.read(0x2C) == RX0 | ERR
    assert bench.read(0x2D) == 0x40
    assert bench.read(0x66) == 1


def test_buffer_1_overflows_too() -> None:
    every_bit = standard(0x7FF)
    bench = filtered({0: every_bit, 1: every_bit}, {5: standard(0x345)}, rxb0=0x04)
    bench.partner_sends(Frame(0x345, b"\x01"), Frame(0x345, b"\x02"))
    assert bench.read(0x2C) == RX1 | ERR
    assert bench.read(0x2D) == 0x80
    assert bench.read(0x76) == 1


@pytest.mark.parametrize(
    ("frame", "image", "kind"),
    [
        (Frame(0x123, b"\x01\x02"), [0x24, 0x60, 0, 0, 2, 1, 2, 0], 0),
        (Frame(0x7FF, bytes(3), remote=True), [0xFF, 0xF0, 0, 0, 0x43, 0, 0, 0], 1),
        (Frame(0x123 << 18 | 0x24567, b"\x01", True), [0x24, 0x6A, 0x45, 0x67, 1, 1, 0, 0], 2),
        (Frame(0x123 << 18 | 0x24567, b"", True, True), [0x24, 0x6A, 0x45, 0x67, 0x40, 0, 0, 0], 3),
    ],
)
@pytest.mark.parametrize("buffer", [0, 1])
def test_what_a_receive_buffer_holds(frame: Frame, image: list[int], kind: int, buffer: int) -> None:
    bench = Bench()
    bench.write(0x60, 0x60 if not buffer else 0)
    bench.write(0x70, 0x60)
    bench.write(0x28, 0x82, 0xD0, 0x00)
    if buffer:
        bench.write(0x20, 0xFF, 0xE3, 0xFF, 0xFF)
        for address in (0x00, 0x04):
            bench.write(address, *standard(0x7FE))
    bench.mode(LISTEN)
    bench.wire.attach("third").on_receive = lambda _t, _f: None
    bench.partner_sends(frame)
    assert bench.spi(0x03, 0x61 + 0x10 * buffer, *[0] * 8)[2:] == image
    assert bench.read(0x60 + 0x10 * buffer) & 0x08 == (0x08 if frame.remote else 0)
    assert bench.spi(0xB0, 0)[1] == 0x40 << buffer | kind << 3 | 2 * buffer  # RXM 11: its first filter
    bench.write(0x2C, 0)
    bench.partner_sends(Frame(1, b""))
    assert bench.read(0x60 + 0x10 * buffer) & 0x08 == 0
    assert bench.spi(0xB0, 0)[1] & 0x18 == 0


def test_a_reset_clears_masks_and_filters() -> None:
    bench = filtered({}, {})
    bench.spi(0xC0)
    bench.write(0x28, 0x82, 0xD0, 0x00)
    bench.mode(NORMAL)
    bench.partner_sends(Frame(0x345, b""))
    assert bench.read(0x2C) == RX0


def test_nothing_received_is_status_0() -> None:
    assert Bench().start().spi(0xB0, 0, 0)[1:] == [0, 0]


def test_the_other_buffer_stays_as_it_is() -> None:
    bench = Bench().start()
    bench.write(0x60, 0x60)
    bench.partner_sends(Frame(0x123, b"\x01"))
    assert bench.spi(0x03, 0x70, *[0] * 14)[2:] == [0x60, *[0] * 13]


def test_the_filter_number_of_the_last_message_is_forgotten() -> None:
    every_bit = standard(0x7FF)
    bench = filtered({0: every_bit, 1: every_bit}, {2: standard(0x102), 5: standard(0x105)}, rxb1=0x00)
    for identifier, number in ((0x105, 5), (0x102, 2), (0x105, 5)):
        bench.partner_sends(Frame(identifier, b""))
        assert bench.read(0x70) == number
        bench.write(0x2C, 0)
    both = filtered({0: every_bit}, {0: standard(0x100), 1: standard(0x101)}, rxb0=0x04)
    for identifier, number in ((0x101, 1), (0x100, 0)):
        both.partner_sends(Frame(identifier, b""))
        assert both.read(0x60) == 0x06 | number
        both.write(0x2C, 0)
