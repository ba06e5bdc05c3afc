"""The debug port (B9): its text against python-can's slcan driver, its commands, its buffers, its pace."""

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.core.debug import BUFFER_BYTES, DebugPort, frame_of, line_of
from boards.display.firmware import DisplayBoard
from bus.can import Frame, Wire
from bus.protocol import COMMAND_BASE, Device, Opcode, Result, pack_command, unpack_reply
from bus.time import EventQueue, Oscillator
from tests.boards.places import place

MS = 1_000_000
DISPLAY = Device.DISPLAY


class Desk:
    """A display, a peer that acknowledges, and a PC on the display's debug port."""

    def __init__(self) -> None:
        self.queue = EventQueue()
        wire = Wire(self.queue)
        wire.attach("peer")
        self.board = DisplayBoard(
            place(DISPLAY, wire, Oscillator(0.0, 0)), (Device.POSITION_RA, Device.POSITION_DEC), Device.FOCUS
        )
        self.board.begin()
        self.port = DebugPort(self.board, wire)
        self.heard: list[tuple[int, bytes]] = []
        self.port.sink = lambda t_ns, data: self.heard.append((t_ns, data))

    def say(self, data: bytes, ms: int = 20) -> bytes:
        """Bytes in; what comes out meanwhile."""
        self.heard.clear()
        self.port.write(self.queue.now_ns, data)
        self.queue.run_until(self.queue.now_ns + ms * MS)
        return b"".join(data for _, data in self.heard)


@given(st.integers(0, 0x7FF), st.binary(max_size=8))
def test_a_frame_comes_back_from_its_line(identifier: int, data: bytes) -> None:
    line = line_of(Frame(identifier, data))
    assert frame_of(line.removesuffix(b"\r")) == Frame(identifier, data)


@given(st.binary(max_size=30))
def test_any_line_is_a_frame_or_none(line: bytes) -> None:
    frame = frame_of(line)
    assert frame is None or line_of(frame).rstrip(b"\r").lower() == line.lower()


def test_python_cans_own_slcan_driver_reads_and_writes_the_same() -> None:
    frame = Frame(0x0D1, bytes(range(8)))
    with can.Bus(interface="slcan", channel="loop://", sleep_after_open=0, timeout=1) as bus:
        cable = bus.serialPortOrig  # type: ignore[attr-defined]
        cable.reset_input_buffer()
        bus.send(can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=False))
        assert frame_of(cable.read_until(b"\r").removesuffix(b"\r")) == frame
        cable.write(line_of(frame))
        message = bus.recv(timeout=1)
    assert message is not None
    assert (message.arbitration_id, bytes(message.data), message.is_extended_id) == (0x0D1, frame.data, False)


def test_B9_a_command_is_answered_on_the_port_and_does_what_it_says() -> None:
    desk = Desk()
    assert desk.say(b"V\rO\r") == b"V1013\r\r"
    command = pack_command(DISPLAY, Opcode.BRIGHTNESS, 40)
    out = desk.say(line_of(Frame(COMMAND_BASE + DISPLAY, command)))
    accepted, answer = out.split(b"\r")[:2]
    assert accepted == b"z"
    frame = frame_of(answer)
    assert frame is not None and frame.identifier == 0x100 + DISPLAY
    assert unpack_reply(frame.data).result == Result.OK
    assert desk.board.brightness == 40


@pytest.mark.parametrize(
    "line", [b"t0D2851300000000000000", b"t0D18zz", b"T000000D10", b"x", b"t0D1", b"\xff\xfe"]
)
def test_what_is_not_for_this_board_is_refused(line: bytes) -> None:
    desk = Desk()
    desk.say(b"O\r")
    assert desk.say(line + b"\r") == b"\a"


def test_a_closed_port_says_nothing_of_the_bus_and_takes_no_command() -> None:
    desk = Desk()
    command = line_of(Frame(COMMAND_BASE + DISPLAY, pack_command(DISPLAY, Opcode.PING)))
    assert desk.say(command) == b"\a"
    desk.say(b"O\r")
    assert b"t751" in desk.say(b"", 1100)  # the heartbeat
    desk.say(b"C\r")
    assert desk.say(b"", 1100) == b""


def test_bytes_take_their_time_and_a_board_without_supply_is_silent() -> None:
    desk = Desk()
    desk.say(b"V\r")
    # 2 bytes in, 6 out, ten bits each at 115 200 baud
    assert desk.heard[0][0] == pytest.approx(8 * 10 / 115_200 * 1e9, abs=2)
    desk.board.power_off(desk.queue.now_ns)
    assert desk.say(b"V\r") == b""


def test_more_than_the_buffer_is_lost_and_counted() -> None:
    desk = Desk()
    desk.say(b"V" * (BUFFER_BYTES + 1), 40)
    assert desk.port.lost == 1
    assert desk.say(b"\rV\r") == b"\aV1013\r"


def test_the_end_of_a_line_that_is_too_long_is_no_line() -> None:
    desk = Desk()
    for _ in range(2):
        desk.say(b"x" * BUFFER_BYTES, 40)
    assert desk.say(b"V" * BUFFER_BYTES + b"\r", 40) == b""
    assert desk.say(b"\r") == b"\a"


@pytest.mark.parametrize("line", [b"t+D10", b"t0_10", b"t D10", b"t0D1+", b"t8000", b"t0D19" + b"00" * 9])
def test_digits_that_only_python_knows_are_none(line: bytes) -> None:
    assert frame_of(line) is None


def test_the_same_bytes_cut_anywhere_do_the_same() -> None:
    text = b"O\r" + line_of(Frame(COMMAND_BASE + DISPLAY, pack_command(DISPLAY, Opcode.PING)))
    whole, cut = Desk(), Desk()
    expected = whole.say(text)
    for byte in text:
        cut.port.write(cut.queue.now_ns, bytes([byte]))
    cut.queue.run_until(20 * MS)
    assert b"".join(data for _, data in cut.heard) == expected


@pytest.mark.parametrize("length", range(12))
def test_a_line_is_over_with_its_return_whatever_follows_and_however_it_comes(length: int) -> None:
    """Found by a quarter of a million inputs: `C` took effect behind the line feed when it came in one piece,
    so a reply that was on its way got out; and times were rounded piece by piece."""
    said = b"x" * length + b"\rV\r\nV\r\r\n"
    heard = []
    for cuts in ([said], [said[at : at + 1] for at in range(len(said))], [said[:3], said[3:]]):
        desk = Desk()
        for piece in cuts:
            desk.port.write(desk.queue.now_ns, piece)
        desk.say(b"")
        heard.append(desk.heard)
    assert heard[0] == heard[1] == heard[2]


BIT_NS = 1e9 / 115_200


def test_a_new_port_is_closed_and_has_lost_nothing() -> None:
    port = Desk().port
    assert (port.baud, port.lost, port.opened, port.tapped) == (115_200, 0, False, False)
    assert (line_of(Frame(0x0D1, b"\x0a")), frame_of(b"t0D110A")) == (b"t0D110A\r", Frame(0x0D1, b"\x0a"))


@pytest.mark.parametrize("line", [b"", b"S8", b"s1234", b"W0", b"m", b"M", b"Z0", b"X1", b"F"])
def test_what_sets_up_an_adapter_is_done_without_doing_anything(line: bytes) -> None:
    desk = Desk()
    assert desk.say(line + b"\r") == b"\r"
    assert not desk.port.opened


def test_what_comes_before_the_line_has_been_read_waits_in_one_buffer() -> None:
    desk = Desk()
    desk.port.write(0, b"S" * 200)
    desk.port.write(0, b"S" * 100)  # 56 find room
    assert desk.port.lost == 44
    desk.say(b"", 40)
    desk.say(b"\r", 40)
    assert desk.say(b"V\r") == b"V1013\r"
    desk.port.write(desk.queue.now_ns, b"S" * 256)
    assert desk.port.lost == 44
    desk.port.write(desk.queue.now_ns, b"S")
    assert desk.port.lost == 45


def test_bytes_that_follow_at_once_or_later_are_through_when_their_bits_are() -> None:
    desk = Desk()
    desk.port.write(0, b"S")
    desk.port.write(0, b"S\r")  # on the heels of the first
    desk.say(b"", 30)
    assert desk.heard[0][0] == pytest.approx(4 * 10 * BIT_NS, abs=2)  # three in, one out
    desk.heard.clear()
    start_ns = desk.queue.now_ns
    desk.say(b"V\r")
    assert desk.heard[0][0] - start_ns == pytest.approx((2 + 6) * 10 * BIT_NS, abs=2)


def test_an_hour_of_bytes_is_an_hour() -> None:
    assert Desk().port._duration_ns(3600 * 11_520) == 3600 * 10**9


def test_what_goes_out_has_a_buffer_too() -> None:
    """256 bytes: 42 answers of six to `V`, and one byte of four more."""
    desk = Desk()
    for _ in range(43):
        desk.port._say(0, b"V1013\r")
    assert desk.port.lost == 6
    desk.port._say(0, b"1234")
    assert desk.port.lost == 6  # just full
    desk.port._say(0, b"x")
    desk.port._say(0, b"y")
    assert desk.port.lost == 8
    assert desk.say(b"", 40) == b"V1013\r" * 42 + b"1234"
    ends = [t_ns for t_ns, _ in desk.heard]
    assert ends[0] == pytest.approx(6 * 10 * BIT_NS, abs=1)
    assert ends[-1] == pytest.approx(256 * 10 * BIT_NS, abs=50)


def test_a_port_that_is_opened_twice_says_a_frame_once() -> None:
    desk = Desk()
    desk.say(b"O\rC\rO\rO\r")
    out = desk.say(b"", 1100)
    assert out.count(b"t751") == 1


def test_half_a_line_is_forgotten_with_the_supply() -> None:
    desk = Desk()
    desk.say(b"V")
    desk.board.power_off(desk.queue.now_ns)
    desk.say(b"1")
    desk.board.power_on(desk.queue.now_ns)
    assert desk.say(b"", 400) == b""
    assert desk.say(b"\r") == b"\r"


def test_nobody_needs_to_listen_to_a_port() -> None:
    desk = Desk()
    desk.port.sink = None
    desk.port.write(0, b"V\r")
    desk.queue.run_until(10 * MS)
    assert desk.port.out == []
