from itertools import pairwise

import pytest

from boards.core.board import BOOT_NS
from boards.focus.config import FCY_HZ, TABLE, FocusConfig, FocusPins
from boards.focus.firmware import FocusBoard
from bus.can import Frame, Wire
from bus.protocol import (
    Device,
    FocusFlag,
    Health,
    Opcode,
    Reply,
    Result,
    State,
    pack_command,
    unpack_focus,
    unpack_heartbeat,
    unpack_reply,
)
from bus.protocol.serial import PacketDecoder
from bus.time import EventQueue, Oscillator
from plant.focus import FocusPort
from plant.model import load
from tests.boards.places import place
from tests.boards.tables import times_ns


class Bench:
    def __init__(self, start: float) -> None:
        self.queue = EventQueue()
        wire = Wire(self.queue)
        self.port = FocusPort(load().focus, start)
        self.coils: list[tuple[int, int, bool, bool]] = []
        pins = FocusPins(
            coils=self.drive, encoder=self.port.encoder, index=self.port.index, lvdt=self.port.lvdt
        )
        self.board = FocusBoard(place(Device.FOCUS, wire, Oscillator(20.0, 0)), pins, FocusConfig())
        self.pc = wire.attach("pc")
        self.pc.on_receive = self.hear
        self.replies: list[Reply] = []
        self.last = b""
        self.heard: list[tuple[int, Frame]] = []
        self.board.begin()

    def drive(self, t_ns: int, phase: int, energised: bool, hold: bool) -> None:
        self.coils.append((t_ns, phase, energised, hold))
        self.port.coils(t_ns, phase, energised, hold)

    def hear(self, t_ns: int, frame: Frame) -> None:
        self.heard.append((t_ns, frame))
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


def test_B5_after_power_up_the_motor_is_held_as_the_board_says() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    bench.command(Opcode.FOCUS_MOVE_TO, 700)
    bench.run(0.3)
    bench.board.power_off(bench.queue.now_ns)
    assert bench.coils[-1][2:] == (False, False)
    cut = len(bench.coils)
    packets: list[int] = []
    bench.board.uart.sink = lambda t_ns, _data: packets.append(t_ns)
    bench.run(0.1)
    assert len(bench.coils) == cut  # the steps that were to come do not
    bench.board.power_on(bench.queue.now_ns)
    on_ns = bench.queue.now_ns + BOOT_NS
    bench.run(1.0)
    assert 250_000_000 < packets[0] - on_ns < 300_000_000  # 25 samples of now
    assert [pins[2:] for pins in bench.coils[cut:]] == [(False, True)]
    assert bench.flags == FocusFlag.HOLD
    focus = unpack_focus(bench.last)
    assert (focus.position, focus.encoder) == (0, 0)  # nothing of before is trusted


def test_B5_full_current_until_the_rotor_is_at_rest_then_hold() -> None:
    """50 ms behind the last step, seen by a routine of 10 ms that ends 50 us later."""
    bench = Bench(0.0)
    bench.run(0.1)
    bench.command(Opcode.FOCUS_STEP, 3)
    bench.run(0.2)
    steps, rests = ([pins for pins in bench.coils if pins[2] is on] for on in (True, False))
    assert [pins[1] for pins in steps] == [1, 2, 3]
    assert rests[-1][1:] == (3, False, True) and rests[-2][0] == 0  # at power-up and now
    assert 50_000_000 < rests[-1][0] - steps[-1][0] < 60_100_000


def test_B5_free_in_the_middle_of_a_move_leaves_no_step_behind() -> None:
    """Freed, held and sent again between two steps: the times of the new ramp, as if from rest."""
    bench = Bench(0.0)
    bench.run(0.1)
    bench.command(Opcode.FOCUS_MOVE_TO, 700)
    bench.run(0.5)
    position = bench.board.stepping.position
    for opcode, arguments in (
        (Opcode.FOCUS_FREE, ()), (Opcode.FOCUS_HOLD, ()), (Opcode.FOCUS_MOVE_TO, (position + 6,)),
    ):  # fmt: skip
        assert bench.pc.send(Frame(0x0C1, pack_command(Device.FOCUS, opcode, *arguments)), bench.queue.now_ns)
    before = len(bench.coils)
    bench.run(0.2)
    freed = next(k for k, pins in enumerate(bench.coils) if k >= before and pins[2:] == (False, False))
    position += freed - before  # a step came before the command
    assert bench.coils[freed + 1][2:] == (False, True)
    times = [t_ns for t_ns, _, on, _ in bench.coils[freed:] if on]
    assert len(times) == 6 - (freed - before)
    assert all(after - earlier > 7_000_000 for earlier, after in pairwise(times))
    assert bench.board.stepping.position == position + len(times)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("counts", "wrong"), [(8, False), (9, True)])
def test_P11_more_than_two_half_steps_are_lost_steps(counts: int, wrong: bool, sign: int) -> None:
    """Four counts of the encoder are a half step; told at rest, once the origin is known."""
    bench = Bench(190.0)
    bench.run(0.1)
    bench.board.qei.pin = lambda t_ns: bench.port.encoder(t_ns) + slip
    slip = 4000
    bench.run(0.02)
    assert bench.command(Opcode.PING).value == 0  # nothing is known yet
    slip = 0
    bench.command(Opcode.FOCUS_REFERENCE)
    bench.run(5.0)
    focus = unpack_focus(bench.last)
    assert focus.flags & FocusFlag.REFERENCED
    slip = sign * counts - (focus.encoder - 4 * focus.position)
    bench.run(0.02)
    assert bool(bench.command(Opcode.PING).value & Health.SENSOR) is wrong
    bench.command(Opcode.FOCUS_MOVE_TO, 0)
    assert bench.command(Opcode.PING).value == 0  # while it moves the rotor lags anyway


def test_B5_freed_while_it_searches_it_does_not_go_on_when_held() -> None:
    bench = Bench(30.0)
    bench.run(0.1)
    for opcode in (Opcode.FOCUS_REFERENCE, Opcode.FOCUS_FREE, Opcode.FOCUS_HOLD):
        assert bench.command(opcode).result == Result.OK
    assert bench.command(Opcode.FOCUS_MOVE_TO, 0).result == Result.OK
    bench.run(1.0)
    assert bench.flags & FocusFlag.HOLD and not bench.flags & FocusFlag.REFERENCED
    assert not bench.command(Opcode.PING).value & Health.SENSOR


def test_B5_a_board_without_supply_may_be_asked() -> None:
    bench = Bench(0.0)
    pins = FocusPins(
        coils=bench.drive, encoder=bench.port.encoder, index=bench.port.index, lvdt=bench.port.lvdt
    )
    board = FocusBoard(place(Device.FOCUS, Wire(bench.queue), Oscillator(0.0, 0)), pins, FocusConfig())
    assert board.state() == State.ACTIVE and not board.health() & Health.SENSOR


def test_B5_what_is_refused_and_what_is_no_motion() -> None:
    bench = Bench(0.0)
    bench.run(0.1)
    for target, result in (
        (800, Result.OK), (801, Result.OUT_OF_RANGE), (-800, Result.OK), (-801, Result.OUT_OF_RANGE),
    ):  # fmt: skip
        assert bench.command(Opcode.FOCUS_MOVE_TO, target).result == result
    assert bench.command(Opcode.FOCUS_REFERENCE).result == Result.NOT_ALLOWED  # it moves
    bench.run(5.0)
    assert bench.command(Opcode.FOCUS_STEP, -1).result == Result.OUT_OF_RANGE
    made = len(bench.coils)
    assert bench.command(Opcode.FOCUS_MOVE_TO, -800).result == Result.OK
    assert not bench.board.stepping.moving and len(bench.coils) == made
    assert bench.command(Opcode.FOCUS_REFERENCE).result == Result.OK
    for opcode in (Opcode.FOCUS_MOVE_TO, Opcode.FOCUS_STEP, Opcode.FOCUS_REFERENCE):
        arguments = () if opcode is Opcode.FOCUS_REFERENCE else (0,)
        assert bench.command(opcode, *arguments).result == Result.NOT_ALLOWED
    assert bench.command(Opcode.FOCUS_HOLD).result == Result.OK
    bench.run(1.0)
    assert bench.flags & FocusFlag.HOLD and not bench.flags & FocusFlag.REFERENCED
    assert bench.command(Opcode.FOCUS_STEP, 1).result == Result.OK  # the search is over


def test_H3_periods_of_the_frames_and_what_the_sensors_say() -> None:
    """FOCUS every 50 ms with index and LVDT, HEARTBEAT every second, 25 samples of 10 ms in a packet."""
    bench = Bench(192.0)
    packets: list[tuple[int, bytes]] = []
    bench.board.uart.sink = lambda t_ns, data: packets.append((t_ns, data))
    bench.run(3.0)
    periods = {0x241: 50_000_000, 0x741: 1_000_000_000}
    for identifier, period in periods.items():
        times = [t_ns for t_ns, frame in bench.heard if frame.identifier == identifier]
        assert len(times) in (3_000_000_000 // period, 3_000_000_000 // period - 1)
        assert all(abs(after - before - period) < 300_000 for before, after in pairwise(times))
    states = [unpack_heartbeat(frame.data).state for _, frame in bench.heard if frame.identifier == 0x741]
    assert set(states) == {State.ACTIVE}
    focus = unpack_focus(bench.last)
    lvdt = round(512 * (1 + 192 / 800))
    assert abs(focus.lvdt - lvdt) < 30 and not focus.flags & FocusFlag.INDEX_SEEN
    rows = [row for _, data in packets for packet in PacketDecoder().feed(data) for row in packet.rows]
    assert len(rows) in (275, 300) and set(rows) == {(0, 0, focus.lvdt)}
    bench.command(Opcode.FOCUS_STEP, 8)
    bench.run(0.2)
    assert bench.flags & FocusFlag.INDEX_SEEN
    focus = unpack_focus(bench.last)
    assert (focus.position, focus.encoder) == (8, 32)
    bench.command(Opcode.FOCUS_FREE)
    bench.run(1.0)
    states = [unpack_heartbeat(frame.data).state for _, frame in bench.heard if frame.identifier == 0x741]
    assert states[-1] == State.READY


def test_B5_routines_take_the_times_that_are_published() -> None:
    assert times_ns(TABLE, FCY_HZ) == {
        "sample": (1200, 50_000),
        "step": (1200, 15_000),
        "can": (1200, 60_000),
    }
    assert [line.level for line in TABLE] == [line.name == "can" for line in TABLE]
