from boards.display.firmware import DisplayBoard, angle
from bus.can import Frame, Wire
from bus.protocol import (
    Device,
    FocusFlag,
    Opcode,
    Result,
    pack_command,
    pack_focus,
    pack_summary,
    unpack_reply,
)
from bus.time import EventQueue, Oscillator
from tests.boards.places import place


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
