import pytest

from boards.focus.config import FocusConfig, FocusPins
from boards.focus.firmware import FocusBoard
from boards.focus.stepping import Stepping
from bus.can import Frame, Wire
from bus.protocol import (
    Device,
    FocusFlag,
    Health,
    Opcode,
    Reply,
    Result,
    pack_command,
    unpack_focus,
    unpack_reply,
)
from bus.time import EventQueue, Oscillator
from plant.focus import FocusPort
from plant.model import load
from tests.boards.places import place


class Bench:
    def __init__(self, start: float) -> None:
        self.queue = EventQueue()
        wire = Wire(self.queue)
        self.port = FocusPort(load("low_preload").focus, start)
        pins = FocusPins(
            coils=self.port.coils, encoder=self.port.encoder, index=self.port.index, lvdt=self.port.lvdt
        )
        self.board = FocusBoard(place(Device.FOCUS, wire, Oscillator(20.0, 0)), pins, FocusConfig())
        self.pc = wire.attach("pc")
        self.pc.on_receive = self.hear
        self.replies: list[Reply] = []
        self.last = b""
        self.board.begin()

    def hear(self, _t_ns: int, frame: Frame) -> None:
        if frame.identifier == 0x241:
            self.last = frame.data
        elif frame.identifier == 0x141:
            self.replies.append(unpack_reply(frame.data))

    def run(self, seconds: float) -> None:
        self.queue.run_until(self.queue.now_ns + round(seconds * 1e9))

    def command(self, opcode: int, *arguments: int) -> Reply:
        before = len(self.replies)
        self.pc.send(Frame(0x0C1, pack_command(Device.FOCUS, opcode, *arguments)), self.queue.now_ns)
        self.run(0.01)
        assert len(self.replies) == before + 1
        return self.replies[-1]

    @property
    def flags(self) -> int:
        return unpack_focus(self.last).flags

    @property
    def truth(self) -> float:
        return self.port.position(self.queue.now_ns)


@pytest.mark.parametrize("start", [-790, -601, -600, -350, -3, 0, 37, 199, 201, 599, 640, 790])
def test_P12_index_and_lvdt_give_the_absolute_position(start: int) -> None:
    bench = Bench(float(start))
    bench.run(0.1)
    assert bench.command(Opcode.FOCUS_REFERENCE).result == Result.OK
    bench.run(5.0)
    assert bench.flags & FocusFlag.REFERENCED
    assert not bench.flags & FocusFlag.MOVING
    assert abs(bench.truth - bench.board.stepping.position) < 0.1
    assert bench.command(Opcode.PING).value == 0


@pytest.mark.parametrize("target", [0, -120, 40, 800, -800])
def test_P11_focus_goes_where_it_is_sent_within_a_half_step(target: int) -> None:
    bench = Bench(11.0)
    bench.run(0.1)
    bench.command(Opcode.FOCUS_REFERENCE)
    bench.run(5.0)
    assert bench.command(Opcode.FOCUS_MOVE_TO, target).result == Result.OK
    bench.run(5.0)
    focus = unpack_focus(bench.last)
    assert focus.position == target
    assert abs(bench.truth - target) < 1.0
    assert abs(focus.encoder - 4 * target) <= 4
    assert focus.flags & FocusFlag.HOLD


def test_H3_single_steps() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    before = unpack_focus(bench.last).position
    for _ in range(3):
        bench.command(Opcode.FOCUS_STEP, 1)
        bench.run(0.1)
    bench.command(Opcode.FOCUS_STEP, -1)
    bench.run(0.2)
    assert unpack_focus(bench.last).position == before + 2
    assert abs(bench.truth - 2.0) < 0.1


def test_H3_control_power_off_is_free_and_refuses_to_move() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    assert bench.command(Opcode.FOCUS_FREE).result == Result.OK
    bench.run(0.1)
    assert bench.flags & FocusFlag.FREE
    assert not bench.flags & FocusFlag.REFERENCED
    assert bench.command(Opcode.FOCUS_STEP, 1).result == Result.NOT_ALLOWED
    assert bench.command(Opcode.FOCUS_REFERENCE).result == Result.NOT_ALLOWED
    assert bench.command(Opcode.FOCUS_HOLD).result == Result.OK
    assert bench.command(Opcode.FOCUS_STEP, 1).result == Result.OK


def test_B5_hold_stops_a_move() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    bench.command(Opcode.FOCUS_MOVE_TO, 700)
    bench.run(0.6)
    assert bench.flags & FocusFlag.MOVING
    bench.command(Opcode.FOCUS_HOLD)
    bench.run(1.0)
    assert not bench.flags & FocusFlag.MOVING
    assert 100 < bench.truth < 400


def test_B5_targets_beyond_the_travel_are_refused() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    assert bench.command(Opcode.FOCUS_MOVE_TO, 801).result == Result.OUT_OF_RANGE


def test_a_stuck_index_fails_the_search_and_says_so() -> None:
    bench = Bench(30.0)
    bench.board.index_pin = lambda _t: True
    bench.run(0.1)
    bench.command(Opcode.FOCUS_REFERENCE)
    bench.run(5.0)
    assert not bench.flags & FocusFlag.REFERENCED
    assert bench.command(Opcode.PING).value & Health.SENSOR


def test_the_ramp_starts_and_ends_slowly() -> None:
    stepping = Stepping(FocusConfig())
    stepping.target = 300
    gaps = []
    while True:
        direction, gap = stepping.next()
        if not direction:
            break
        gaps.append(gap)
    assert len(gaps) == 300
    assert gaps[0] > 4 * 10**6 > 3 * 10**6 > min(gaps)
    assert gaps[-1] == FocusConfig().intervals_ns[0]
    assert stepping.position == 300
