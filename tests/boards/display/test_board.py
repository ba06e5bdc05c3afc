import pytest

from boards.display.firmware import FCY_HZ, TABLE, DisplayBoard, angle, focus_line, position_line
from bus.can import Frame, Wire
from bus.protocol import (
    Device,
    Focus,
    FocusFlag,
    Opcode,
    PositionFlag,
    Result,
    Summary,
    pack_command,
    pack_focus,
    pack_summary,
    unpack_reply,
)
from bus.time import EventQueue, Oscillator
from tests.boards.places import place
from tests.boards.tables import times_ns


def test_B6_shows_positions_and_focus() -> None:
    queue = EventQueue()
    wire = Wire(queue)
    positions = (int(Device.POSITION_RA), int(Device.POSITION_DEC))
    board = DisplayBoard(place(Device.DISPLAY, wire, Oscillator(0.0, 0)), positions, Device.FOCUS)
    pc = wire.attach("pc")
    replies = []
    pc.on_receive = lambda _t, f: replies.append(unpack_reply(f.data)) if f.identifier == 0x151 else None
    board.begin()
    assert board.lines == ("RA  --- -- --.-     ", "DEC --- -- --.-     ", "FOC ------          ")
    pc.send(Frame(0x321, pack_summary(positions[0], 0, 1 << 28)), 0)
    pc.send(Frame(0x322, pack_summary(positions[1], 1, 12345678)), 0)
    flags = FocusFlag.HOLD | FocusFlag.REFERENCED
    pc.send(Frame(0x241, pack_focus(Device.FOCUS, flags, -3, -12, 511)), 0)
    queue.run_until(300_000_000)
    assert board.lines == ("RA  180 00 00.0     ", "DEC   8 16 42.3 !   ", "FOC -  18.75  HOLD  ")
    for percent, result in ((40, Result.OK), (101, Result.OUT_OF_RANGE)):
        pc.send(Frame(0x0D1, pack_command(Device.DISPLAY, Opcode.BRIGHTNESS, percent)), queue.now_ns)
        queue.run_until(queue.now_ns + 5_000_000)
        assert replies[-1].result == result
    assert board.brightness == 40


def test_angles_are_cut_not_rounded() -> None:
    assert angle((1 << 29) - 1) == "359 59 59.9"


@pytest.mark.parametrize(("flags", "mark"), [
    (0, " "), (PositionFlag.ALARM, "!"), (PositionFlag.CRC_ERROR, "!"), (PositionFlag.LIMIT_LOW, "L"),
    (PositionFlag.LIMIT_HIGH, "L"), (PositionFlag.LIMIT_HIGH | PositionFlag.CRC_ERROR, "!"),
])  # fmt: skip
def test_B6_an_axis_beyond_its_limit_or_with_a_bad_reading_is_marked(flags: int, mark: str) -> None:
    """A quarter turn and one degree, one minute, one second."""
    steps = round((1 << 29) * (91 + 1 / 60 + 1.05 / 3600) / 360)
    assert position_line("RA ", Summary(0x21, flags, steps)) == f"RA   91 01 01.0 {mark}   "


@pytest.mark.parametrize(("flags", "position", "line"), [
    (0, 0, "FOC +   0.00? HOLD  "), (FocusFlag.MOVING | FocusFlag.REFERENCED, 1, "FOC +   6.25  MOVE  "),
    (FocusFlag.FREE, -800, "FOC -5000.00? FREE  "), (FocusFlag.REFERENCED, 160, "FOC +1000.00  HOLD  "),
])  # fmt: skip
def test_B6_the_focus_in_micrometres_of_6_25_a_half_step(flags: int, position: int, line: str) -> None:
    assert focus_line(Focus(0x41, flags, position, 0, 0)) == line


def test_B6_what_is_shown_is_as_old_as_the_last_refresh_and_gone_after_power_up() -> None:
    """Every 250 ms; HEARTBEAT every second; full brightness at first."""
    queue = EventQueue()
    wire = Wire(queue)
    board = DisplayBoard(place(Device.DISPLAY, wire, Oscillator(0.0, 0)), (0x21, 0x22), Device.FOCUS)
    pc = wire.attach("pc")
    beats: list[int] = []
    pc.on_receive = lambda t_ns, frame: beats.append(t_ns) if frame.identifier == 0x751 else None
    assert board.brightness == 100
    dashes = board.lines
    board.begin()
    queue.run_until(260_000_000)
    pc.send(Frame(0x321, pack_summary(0x21, 0, 1 << 28)), queue.now_ns)
    queue.run_until(499_000_000)
    assert board.lines == dashes
    queue.run_until(502_000_000)
    assert board.lines[0] == "RA  180 00 00.0     "
    queue.run_until(4_900_000_000)
    assert [round(t_ns / 1e9, 2) for t_ns in beats] == [0.25, 1.25, 2.25, 3.25, 4.25]
    board.power_off(queue.now_ns)
    board.begin(queue.now_ns)
    assert board.lines == dashes
    for percent, result in (
        (-1, Result.OUT_OF_RANGE),
        (0, Result.OK),
        (100, Result.OK),
        (101, Result.OUT_OF_RANGE),
    ):
        command = board.commands[Opcode.BRIGHTNESS]
        assert command(0, bytes((percent & 0xFF,)) + bytes(5)).result == result


def test_B6_routines_take_the_times_that_are_published() -> None:
    assert times_ns(TABLE, FCY_HZ) == {"refresh": (1200, 500_000), "can": (1200, 60_000)}
    assert [line.level for line in TABLE] == [line.name == "can" for line in TABLE]
