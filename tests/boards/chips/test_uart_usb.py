import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.uartline import FIFO_DSPIC, FIFO_PIC18, Received, UartLine, line_levels
from boards.chips.usb import HidDevice, Stall
from boards.chips.usb import device as usb
from boards.silicon.uart import Uart
from bus.time import EventQueue


def pair(
    baud: int = 115_200, other: int | None = None, depth: int = 4
) -> tuple[EventQueue, UartLine, UartLine]:
    queue = EventQueue()
    one, two = UartLine(queue, baud), UartLine(queue, other or baud, depth)
    one.peer, two.peer = two, one
    return queue, one, two


@given(st.binary(max_size=4), st.binary(max_size=4))
def test_bytes_go_both_ways(there: bytes, back: bytes) -> None:
    queue, one, two = pair()
    one.send(there)
    two.send(back)
    queue.run_until(10**9)
    assert [two.read() for _ in there] == [Received(byte, False) for byte in there]
    assert [one.read() for _ in back] == [Received(byte, False) for byte in back]
    assert one.read() is None


def test_a_byte_takes_ten_bits_as_in_the_packets_of_the_boards() -> None:
    queue, one, two = pair()
    heard: list[int] = []
    two.interrupt = heard.append
    one.send(b"ab")
    queue.run_until(10**9)
    assert heard == [Uart(queue).duration_ns(1), 2 * Uart(queue).duration_ns(1)]


def test_a_byte_is_a_start_bit_eight_bits_and_a_stop_bit() -> None:
    assert line_levels(0x55) == [0, 1, 0, 1, 0, 1, 0, 1, 0, 1]
    queue, one, two = pair(10)
    heard: list[int] = []
    two.interrupt = heard.append
    one.send(b"a")
    queue.run_until(2 * 10**9)
    assert heard == [10**9]  # ten bits at 10 baud


@pytest.mark.parametrize(("fifo", "depth"), [(FIFO_DSPIC, 4), (FIFO_PIC18, 2)], ids=["dsPIC", "PIC18"])
def test_an_overrun_loses_bytes_until_it_is_cleared(fifo: int, depth: int) -> None:
    queue, one, two = pair(depth=fifo)
    one.send(bytes(range(depth + 2)))
    queue.run_until(10**9)
    assert two.overrun
    assert two.available == depth
    assert two.read() == Received(0, False)
    one.send(b"x")
    queue.run_until(2 * 10**9)
    assert two.available == depth - 1  # nothing comes in while OERR stands
    two.clear_overrun()
    assert two.available == 0
    one.send(b"y")
    queue.run_until(3 * 10**9)
    assert two.read() == Received(ord("y"), False)


@pytest.mark.parametrize(
    ("baud", "byte", "good"),
    [
        (115_200, 0x55, True),
        (111_000, 0x55, True),
        (120_000, 0x55, True),
        (57_600, 0x55, False),
        (230_400, 0x00, False),
    ],
)
def test_baud_rates_within_4_percent_work_others_do_not(baud: int, byte: int, good: bool) -> None:
    queue, one, two = pair(115_200, baud)
    one.send(bytes((byte,)))
    queue.run_until(10**9)
    assert (two.read() == Received(byte, False)) == good


def test_behind_the_stop_bit_the_line_idles_high() -> None:
    """Looking later than a byte lasts: at half the rate bits 3 to 7 of nothing; 7 % late the stop bit."""
    for baud, byte, told in ((57_600, 0x00, 0xF8), (108_000, 0xFF, 0xFF)):
        queue, one, two = pair(115_200, baud)
        one.send(bytes((byte,)))
        queue.run_until(10**9)
        assert two.read() == Received(told, False)


def test_framing_error() -> None:
    _, one, two = pair()
    one.send_break(5)
    assert two.read() == Received(0, True)
    queue, fast, slow = pair(115_200, 230_400)
    fast.send(b"\x00")
    queue.run_until(10**9)
    assert slow.read() == Received(0, True)  # half way through it looks for the stop bit
    lone = UartLine(queue, 9600)
    lone.send(b"x")
    lone.send_break(0)
    queue.run_until(2 * 10**9)
    assert lone.available == 0


# --- USB ------------------------------------------------------------------------------------------------
def get(device: HidDevice, kind: int, index: int = 0, length: int = 255, recipient: int = 0x80) -> bytes:
    return device.control(struct.pack("<BBHHH", recipient, 6, kind << 8 | index, 0, length))


def test_a_host_enumerates_the_device() -> None:
    device = HidDevice()
    assert get(device, 1, length=8) == usb.DEVICE[:8]
    assert device.control(struct.pack("<BBHHH", 0, 5, 7, 0, 0)) == b""
    assert device.address == 7
    # USB 2.0, table 9-8: class by interface, end point 0 of 8 bytes, Microchip's numbers, release 1.00
    told = (18, 1, 0x0200, 0, 0, 0, 8, 0x04D8, 0x003F, 0x0100, 1, 2, 0, 1)
    assert struct.unpack("<BBHBBBBHHHBBBB", get(device, 1)) == told
    configuration = get(device, 2)
    # table 9-10: one interface, bus powered, 100 mA in units of two
    assert struct.unpack_from("<BBHBBBBB", configuration) == (9, 2, len(configuration), 1, 1, 0, 0x80, 50)
    parts, at = [], 0
    while at < len(configuration):
        parts.append(configuration[at : at + configuration[at]])
        at += configuration[at]
    assert at == len(configuration)
    assert [part[1] for part in parts] == [2, 4, 0x21, 5, 5]
    assert parts[1] == bytes((9, 4, 0, 0, 2, 3, 0, 0, 0))  # two endpoints, class HID
    report = get(device, 0x22, recipient=0x81)
    assert struct.unpack("<BBHBBBH", parts[2]) == (9, 0x21, 0x0111, 0, 1, 0x22, len(report))
    assert get(device, 0x21) == parts[2]
    for part, address in ((parts[3], 0x81), (parts[4], 0x01)):
        assert struct.unpack("<BBBBHB", part) == (7, 5, address, 3, 64, 1)
    assert device.control(struct.pack("<BBHHH", 0, 9, 1, 0, 0)) == b""
    assert device.control(struct.pack("<BBHHH", 0x80, 8, 0, 0, 1)) == b"\x01"
    assert device.control(struct.pack("<BBHHH", 0x80, 0, 0, 0, 2)) == bytes(2)
    assert device.control(struct.pack("<BBHHH", 0x21, 0x0A, 0, 0, 0)) == b""
    assert get(device, 3, 0) == bytes((4, 3, 0x09, 0x04))  # English
    for index, name in ((1, "ARIES"), (2, "Schmidt gateway")):
        text = get(device, 3, index)
        assert (text[0], text[1], text[2:].decode("utf-16-le")) == (len(text), 3, name)
    assert device.control(struct.pack("<BBHHH", 0, 9, 0, 0, 0)) == b""
    assert device.control(struct.pack("<BBHHH", 0x80, 8, 0, 0, 1)) == b"\x00"
    assert device.control(struct.pack("<BBHHH", 0, 5, 127, 0, 0)) == b"" and device.address == 127


def test_the_report_descriptor_says_64_bytes_each_way() -> None:
    at, size, count, bits, items = 0, 0, 0, {}, []
    while at < len(usb.REPORT):  # HID 1.11, 6.2.2.2: short items
        prefix = usb.REPORT[at]
        data = usb.REPORT[at + 1 : at + 1 + (0, 1, 2, 4)[prefix & 3]]
        assert len(data) == (0, 1, 2, 4)[prefix & 3]
        value = int.from_bytes(data, "little")
        if prefix & 0xFC == 0x74:
            size = value
        elif prefix & 0xFC == 0x94:
            count = value
        elif prefix & 0xFC in (0x80, 0x90):
            bits[prefix & 0xFC] = size * count
        at += 1 + len(data)
        items.append((prefix & 0xFC, value))
    assert bits == {0x80: 512, 0x90: 512}
    # vendor's page and usage, an application; bytes; a variable each way
    head = [(0x04, 0xFF00), (0x08, 1), (0xA0, 1), (0x14, 0), (0x24, 255), (0x74, 8), (0x94, 64)]
    assert items == [*head, (0x08, 1), (0x80, 2), (0x08, 1), (0x90, 2), (0xC0, 0)]


@pytest.mark.parametrize(
    "setup",
    [
        b"",
        bytes(7),
        struct.pack("<BBHHH", 0x80, 6, 0x0300 | 9, 0, 255),
        struct.pack("<BBHHH", 0x80, 6, 0x0600, 0, 255),
        struct.pack("<BBHHH", 0x80, 6, 0x0101, 0, 255),
        struct.pack("<BBHHH", 0, 9, 2, 0, 0),
        struct.pack("<BBHHH", 0, 5, 128, 0, 0),
        struct.pack("<BBHHH", 0x40, 6, 0x0100, 0, 255),
        bytes(9),
        *(
            struct.pack("<BBHHH", kind, request, 1, 0, 0)
            for kind, request in ((0x80, 5), (0x80, 9), (0, 8), (0, 0), (0x20, 0x0A), (0, 6), (0x80, 1))
        ),
        *(struct.pack("<BBHHH", 0x80, 6, kind << 8, 0, 255) for kind in (0, 4, 0x20, 0x23)),
        struct.pack("<BBHHH", 0x80, 6, 0x0303, 0, 255),
    ],
)
def test_what_it_does_not_know_it_stalls(setup: bytes) -> None:
    device = HidDevice()
    with pytest.raises(Stall):
        device.control(setup)
    assert (device.address, device.configuration) == (0, 0)


def test_reports_wait_for_the_host_to_poll_once_a_frame() -> None:
    device = HidDevice()
    one, two = bytes([1]) * 64, bytes([2]) * 64
    assert device.put(one)
    assert device.put(two)
    assert not device.put(one)
    assert device.poll(0) is None  # not configured
    device.configuration = 1
    assert device.poll(0) == one
    assert device.put(one)
    assert device.poll(4_999_999) == two
    assert device.put(two)
    assert device.poll(5_000_000) == one
    assert device.poll(5_999_999) is None
    assert device.poll(6_000_000) == two
    assert device.poll(7_000_000) is None
    for wrong in (63, 65):
        with pytest.raises(ValueError, match="64 bytes"):
            device.put(bytes(wrong))


def test_output_reports_have_64_bytes_too() -> None:
    device = HidDevice()
    got: list[tuple[int, bytes]] = []
    with pytest.raises(Stall, match="not configured"):
        device.out(0, bytes(64))
    device.configuration = 1
    device.out(1, bytes(64))
    device.from_host = lambda t_ns, report: got.append((t_ns, report))
    device.out(2, bytes(64))
    assert got == [(2, bytes(64))]
    with pytest.raises(Stall, match="not 65"):
        device.out(3, bytes(65))
