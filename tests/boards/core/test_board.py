"""What all boards have in common: which frames they take, how they answer, what their health remembers."""

import pytest

from boards.core.board import BOOT_NS, INBOX, WARNING_NS
from bus.can import Frame
from bus.protocol import (
    COMMAND_BASE,
    Health,
    Opcode,
    Result,
    State,
    pack_command,
    unpack_heartbeat,
    unpack_reply,
)
from bus.time import EventQueue
from tests.boards.core.test_periodic import DEVICE, MS, Idle, bench

PING = pack_command(DEVICE, Opcode.PING)
COMMAND, REPLY, BEAT, MAIL = COMMAND_BASE + DEVICE, 0x100 + DEVICE, 0x700 + DEVICE, 0x223
SECOND = 1000 * MS


class Desk:
    """A board that hears MAIL from a board of type 0x23, and what it has sent."""

    def __init__(self) -> None:
        self.queue, self.board, self.frames = bench(tick_cycles=100)
        self.mail: list[tuple[int, bytes]] = []
        self.board.mail[MAIL] = lambda now_ns, data: self.mail.append((now_ns, data))
        self.queue.run_until(MS)

    def hears(self, frame: Frame) -> None:
        self.board._receive(self.queue.now_ns, frame)

    def run(self, ms: float) -> None:
        self.queue.run_until(self.queue.now_ns + round(ms * MS))

    def replies(self) -> list[tuple[int, int]]:
        """Opcode and result of each."""
        found = [unpack_reply(frame.data) for frame in self.frames if frame.identifier == REPLY]
        return [(each.opcode, each.result) for each in found]


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_new_board_has_counted_nothing(desk: Desk) -> None:
    board = desk.board
    assert (board.dropped, board.foreign, board.clipped, board.boots, board.on) == (0, 0, 0, 1, True)
    assert (board.state(), board.health()) == (State.READY, Health(0))
    assert board.port.passes(COMMAND) and not board.port.passes(COMMAND + 1)
    assert board.parameters.rows() == ()


@pytest.mark.parametrize(("frame", "taken", "foreign"), [
    (Frame(MAIL, bytes([0x23, *range(7)])), 1, 0), (Frame(MAIL, bytes([0x24, *range(7)])), 0, 1),
    (Frame(MAIL, bytes([0x23, *range(6)])), 0, 1), (Frame(MAIL, b""), 0, 1),
    (Frame(MAIL, bytes([0x23, *range(7)]), remote=True), 0, 1),
    (Frame(MAIL, bytes([0x23, *range(7)]), extended=True), 0, 0), (Frame(MAIL + 1, bytes(8)), 0, 0),
])  # fmt: skip
def test_a_measurement_is_its_senders_or_it_is_foreign(
    desk: Desk, frame: Frame, taken: int, foreign: int
) -> None:
    desk.hears(frame)
    assert (len(desk.mail), desk.board.foreign) == (taken, foreign)
    assert (Health.FOREIGN in desk.board.health()) is bool(foreign)
    if taken:
        assert desk.mail == [(desk.board.clock_ns(MS), frame.data)]


def test_a_command_that_is_wrong_is_answered_and_a_remote_one_is_not(desk: Desk) -> None:
    for frame in (
        Frame(COMMAND, PING), Frame(COMMAND, PING[:7]), Frame(COMMAND, bytes([0x12]) + PING[1:]),
        Frame(COMMAND, bytes([DEVICE, 0x7D, *bytes(6)])), Frame(COMMAND, PING, remote=True),
    ):  # fmt: skip
        desk.hears(frame)
        desk.run(4)
    assert desk.replies() == [
        (1, Result.OK), (1, Result.WRONG_LENGTH), (1, Result.WRONG_DEVICE_TYPE),
        (0x7D, Result.UNKNOWN_OPCODE),
    ]  # fmt: skip
    assert desk.board.foreign == 0


def test_eight_commands_wait_and_the_ninth_is_dropped(desk: Desk) -> None:
    assert INBOX == 8
    for _ in range(10):
        desk.hears(Frame(COMMAND, PING))
    assert desk.board.dropped == 2
    assert Health.DROPPED in desk.board.health()
    desk.run(40)
    assert desk.replies() == [(1, 0)] * 8


def test_a_command_by_another_way_is_answered_too(desk: Desk) -> None:
    desk.board.take_command(PING)
    desk.run(4)
    assert desk.replies() == [(1, 0)]


@pytest.mark.parametrize(("call", "bit"), [
    ("drop", Health.DROPPED), ("clip", Health.RANGE), ("refuse", Health.FOREIGN),
])  # fmt: skip
def test_a_mishap_stands_in_the_health_for_ten_seconds(desk: Desk, call: str, bit: Health) -> None:
    board, begun = desk.board, desk.queue.now_ns
    if call == "refuse":
        board.refuse(begun)
    else:
        getattr(board, call)()
    assert WARNING_NS == 10 * SECOND
    assert board.health() == bit
    desk.queue.run_until(begun + WARNING_NS - MS)
    assert board.health() == bit
    desk.queue.run_until(begun + WARNING_NS)
    assert board.health() == Health(0)
    assert board.dropped + board.clipped + board.foreign == 1


def test_lost_interrupts_and_an_error_state_are_in_the_health(desk: Desk) -> None:
    desk.board.cpu.top.overruns = 1
    assert desk.board.health() == Health.OVERRUN
    desk.board.cpu.top.overruns = 0
    desk.board.port.tec = 128
    assert desk.board.port.state == "passive"
    assert desk.board.health() == Health.BUS


def test_ping_tells_the_health(desk: Desk) -> None:
    desk.board.clip()
    assert desk.board._ping(0) == (Result.OK, 0, int(Health.RANGE))


def test_power_comes_back_with_a_boot_of_300_ms(desk: Desk) -> None:
    board = desk.board
    board.clip()
    desk.hears(Frame(COMMAND, PING))
    board.power_off(desk.queue.now_ns)
    assert (board.on, board.port.online) == (False, False)
    desk.hears(Frame(MAIL, bytes([0x23, *bytes(7)])))
    desk.run(10)
    assert (desk.mail, desk.replies()) == ([], [])
    begun = desk.queue.now_ns
    board.power_on(begun)
    board.power_on(begun)  # it is booting already
    desk.queue.run_until(begun + BOOT_NS - 1)
    assert not board.on and BOOT_NS == 300 * MS
    desk.queue.run_until(begun + BOOT_NS)
    assert (board.on, board.port.online, board.boots) == (True, True, 2)
    assert (board.health(), len(board.inbox)) == (Health(0), 0)
    board.power_on(desk.queue.now_ns)  # it runs already
    desk.run(400)
    assert board.boots == 2


def test_a_supply_that_fails_while_booting_begins_anew(desk: Desk) -> None:
    board = desk.board
    board.power_off(desk.queue.now_ns)
    board.power_on(desk.queue.now_ns)
    desk.run(200)
    board.power_off(desk.queue.now_ns)
    desk.run(50)
    board.power_on(desk.queue.now_ns)
    desk.run(299)
    assert not board.on  # the first boot would have been over
    desk.run(2)
    assert (board.on, board.boots) == (True, 2)


def test_a_processor_in_reset_is_silent_and_its_controller_acknowledges(desk: Desk) -> None:
    desk.board.hold_in_reset(desk.queue.now_ns)
    assert (desk.board.on, desk.board.port.online) == (False, True)
    desk.hears(Frame(COMMAND, PING))
    desk.run(20)
    assert desk.replies() == [] and desk.board.ends == []


def test_a_reply_that_finds_no_buffer_waits_and_so_do_commands(desk: Desk) -> None:
    """Three frames of less importance are in the buffers; the one that leaves first makes room."""
    sent: list[int] = []
    desk.board.port.on_sent = lambda _t_ns, frame: sent.append(frame.identifier)
    desk.run(2)
    for _ in range(2):
        desk.hears(Frame(COMMAND, PING))
    end_ns = desk.queue.now_ns + 10_000 + 1_000_000
    desk.queue.run_until(end_ns - 20_000)
    for number in range(3):
        assert desk.board.send(Frame(0x600 + number, bytes(8)), desk.queue.now_ns)
    assert desk.board.port.free_buffers == 0
    desk.queue.run_until(end_ns + 500)
    assert desk.replies() == []
    desk.run(4)
    assert desk.replies() == [(1, 0)] * 2
    assert sent[:2] == [0x600, REPLY] and sent.count(REPLY) == 2  # who listened before goes on listening
    assert desk.board.dropped == 0


def test_a_newer_heartbeat_takes_the_buffer_of_the_old_one() -> None:
    """Nobody acknowledges: of ten, one waits."""
    queue: EventQueue
    board: Idle
    queue, board, _ = bench(tick_cycles=100)
    for port in list(board.port._wire.ports):
        if port is not board.port:
            board.port._wire.detach(port)
    for k in range(10):
        queue.run_until(k * 100 * MS + 50 * MS)
        board.refresh(0x234, bytes([k]), queue.now_ns)
    assert board.port.free_buffers >= 1
    assert board.dropped <= 1


def test_a_frame_that_finds_no_buffer_is_dropped(desk: Desk) -> None:
    for _ in range(3):
        desk.board.transmit(0x600, bytes(8), desk.queue.now_ns)
    assert desk.board.dropped == 0
    desk.board.transmit(0x600, bytes(8), desk.queue.now_ns)
    assert (desk.board.dropped, Health.DROPPED in desk.board.health()) == (1, True)


def test_a_heartbeat_has_whole_seconds_and_the_counters(desk: Desk) -> None:
    desk.board.cpu.top.overruns = 7
    desk.board.port.tec = 9
    desk.queue.run_until(2 * SECOND + 990 * MS)
    desk.frames.clear()
    desk.board.heartbeat(2 * SECOND + 995 * MS)
    desk.board.heartbeat(desk.board.epoch_ns + 3 * SECOND)
    desk.run(13)  # the next one of its own comes at 3.005 s
    beats = [unpack_heartbeat(frame.data) for frame in desk.frames if frame.identifier == BEAT]
    assert beats[-1].uptime == 3 and beats[-1].overruns == 7
    assert beats[-1].state == State.READY


def alone(desk: Desk) -> None:
    """Nobody acknowledges any more."""
    for port in list(desk.board.port._wire.ports):
        if port is not desk.board.port:
            port.online = False


def accompanied(desk: Desk) -> None:
    for port in desk.board.port._wire.ports:
        port.online = True


def held_up(desk: Desk, commands: int) -> None:
    """Commands are heard while three frames stay in the buffers, so that the first reply waits."""
    alone(desk)
    for number in range(3):
        assert desk.board.send(Frame(0x600 + number, bytes(8)), desk.queue.now_ns)
    for _ in range(commands):
        desk.hears(Frame(COMMAND, PING))
    desk.run(8)
    assert desk.replies() == [] and desk.board._late is not None


def test_commands_behind_a_late_reply_are_served_when_it_has_left(desk: Desk) -> None:
    held_up(desk, 3)
    accompanied(desk)
    desk.run(10)
    assert desk.replies() == [(1, 0)] * 3
    assert desk.board._late is None and desk.board.port.on_sent is None


def test_a_late_reply_is_forgotten_with_the_supply(desk: Desk) -> None:
    held_up(desk, 1)
    desk.board.power_off(desk.queue.now_ns)
    accompanied(desk)
    desk.board.power_on(desk.queue.now_ns)
    desk.run(310)
    assert desk.board._late is None and desk.board.port.on_sent is None
    assert desk.replies() == []
    desk.hears(Frame(COMMAND, PING))
    desk.run(4)
    assert desk.replies() == [(1, 0)]


def test_a_heartbeat_sends_the_late_reply_where_buffers_were_emptied(desk: Desk) -> None:
    """As after bus off, which tells nobody of it. While they are full the reply goes on waiting."""
    held_up(desk, 1)
    desk.board.heartbeat(desk.queue.now_ns)
    assert desk.board._late is not None
    desk.board.port.on_sent = None
    accompanied(desk)
    desk.run(2)
    assert desk.replies() == [] and desk.board.port.free_buffers == 3
    desk.board.heartbeat(desk.queue.now_ns)
    desk.run(2)
    assert desk.replies() == [(1, 0)] and desk.board._late is None


def test_outputs_go_to_their_unpowered_state(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    monkeypatch.setattr(Idle, "unpowered", lambda _, t_ns: seen.append(t_ns))
    desk.board.power_off(7 * MS)
    assert seen == [7 * MS]
