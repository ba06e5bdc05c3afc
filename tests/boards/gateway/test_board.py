import pytest

from boards.gateway.firmware import FCY_HZ, TABLE, GatewayBoard
from bus.can import Frame, Wire
from bus.protocol import Device, Opcode, pack_command, pack_reply, pack_tach
from bus.protocol.report import PLACES, pack_report, unpack_report
from bus.time import EventQueue, Oscillator
from tests.boards.places import place
from tests.boards.tables import times_ns

MS = 1_000_000


class Bench:
    def __init__(self) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue)
        self.board = GatewayBoard(place(Device.GATEWAY, self.wire, Oscillator(0.0, 10**8)))
        self.node = self.wire.attach("node")
        self.heard: list[Frame] = []
        self.node.on_receive = lambda _t, frame: self.heard.append(frame)
        self.reports: list[tuple[int, bytes]] = []
        self.board.hid.to_host = lambda t, report: self.reports.append((t, report))
        self.board.begin()

    @property
    def frames(self) -> list[Frame]:
        return [frame for _, report in self.reports for frame in unpack_report(report)]


def test_B7_frames_reach_the_pc_with_their_identifiers_restored() -> None:
    bench = Bench()
    sent = [
        Frame(0x231, pack_tach(0x31, 0, 5, 1)),
        Frame(0x131, pack_reply(0x31, 1, 0, 0, 0)),
        Frame(0x332, bytes((0x32, 0xF3, 0, 0, 0, 0, 0, 0))),
    ]
    for frame in sent:
        bench.node.send(frame, 0)
    bench.queue.run_until(20 * MS)
    assert sorted(bench.frames, key=str) == sorted(sent, key=str)
    assert all(t % MS == 0 for t, _ in bench.reports)


def test_B7_a_full_report_leaves_at_the_next_usb_frame() -> None:
    bench = Bench()

    nodes = iter(PLACES)

    def more(_t_ns: int, _frame: Frame | None) -> None:
        node = next(nodes, None)
        if node is not None:
            bench.node.send(Frame(0x200 + node, pack_tach(node, 0, 5, 1)), bench.queue.now_ns)

    bench.node.on_sent = more
    more(0, None)
    bench.queue.run_until(10 * MS)
    # eight frames take about a millisecond on the wire
    assert [t for t, _ in bench.reports] in ([MS], [2 * MS])
    assert len(bench.frames) == 8


def test_L2_of_two_measurements_of_a_node_the_newer_is_reported() -> None:
    bench = Bench()
    bench.node.send(Frame(0x231, pack_tach(0x31, 0, 5, 1)), 0)
    bench.node.send(Frame(0x231, pack_tach(0x31, 0, 6, 1)), 0)
    bench.queue.run_until(20 * MS)
    ((_, report),) = bench.reports
    assert report == bytes(32) + pack_tach(0x31, 0, 6, 1) + bytes(24)


def test_B7_commands_go_to_the_bus_in_order_and_the_gateway_answers_its_own() -> None:
    bench = Bench()
    commands = [pack_command(0x11, Opcode.SET_RATE, k) for k in range(7)]
    bench.board.hid.write(0, pack_report([*commands, pack_command(0x61, Opcode.PING)]))
    bench.queue.run_until(20 * MS)
    assert [f.data for f in bench.heard if f.identifier == 0x091] == commands
    assert Frame(0x161, pack_reply(0x61, Opcode.PING, 0, 0, 0)) in bench.frames


def test_B7_a_pc_that_does_not_listen_costs_frames_not_the_gateway() -> None:
    bench = Bench()
    bench.board.hold_ns = 10**9
    for _ in range(512 // 8 + 5):  # a quarter of the PIC's memory
        bench.board._put(0, bytes(8))
    assert len(bench.board.ring) == 64
    assert bench.board.lost == bench.board.dropped == 5


def test_foreign_frames_are_counted_and_ignored() -> None:
    """Also a measurement of device type 0, whose slot would be an empty one, or beyond seven bits."""
    bench = Bench()
    foreign = [
        Frame(0x2AA, b"\x01\x02"), Frame(0x2AA, bytes(8)), Frame(0x200, bytes(8)),
        Frame(0x280, b"\x80" + bytes(7)),
    ]  # fmt: skip
    for frame in foreign:
        bench.node.send(frame, bench.queue.now_ns)
        bench.queue.run_until(bench.queue.now_ns + 5 * MS)
    assert bench.board.foreign == len(foreign)
    assert not bench.frames and not bench.board.ring
    for frame in (Frame(0x231, pack_tach(0x31, 0, 5, 1), extended=True), Frame(0x231, bytes(8), remote=True)):
        bench.node.send(frame, bench.queue.now_ns)
    bench.queue.run_until(bench.queue.now_ns + 20 * MS)
    assert not bench.frames and bench.board.foreign == len(foreign)


def tach(node: int, count: int = 5) -> Frame:
    return Frame(0x200 + node, pack_tach(node, 0, count, 1))


def test_B7_a_frame_waits_four_usb_frames_for_others() -> None:
    """It comes in the first millisecond; what comes meanwhile goes with it, the rest waits as long again."""
    bench = Bench()
    bench.node.send(tach(0x31), 0)
    bench.queue.run_until(3 * MS)
    bench.node.send(tach(0x32), bench.queue.now_ns)
    bench.queue.run_until(20 * MS)
    assert [t_ns for t_ns, _ in bench.reports] == [5 * MS]
    assert len(bench.frames) == 2


@pytest.mark.parametrize(("slots", "at"), [(7, [5]), (8, [1]), (15, [1, 5]), (16, [1, 2]), (20, [1, 2, 6])])
def test_B7_full_reports_leave_a_usb_frame_apart_and_the_rest_waits_for_others(
    slots: int, at: list[int]
) -> None:
    bench = Bench()
    for _ in range(slots):
        bench.board._put(0, tach(0x31).data)
    bench.queue.run_until(20 * MS)
    assert [t_ns for t_ns, _ in bench.reports] == [each * MS for each in at]
    assert bench.board.lost == 0 and not bench.board.ring


def test_B7_the_endpoint_is_busy_beyond_eight_reports_or_sixty_four_commands() -> None:
    """Unpacking takes 100 us each; a bus with nobody who acknowledges takes three commands and no more."""
    bench = Bench()
    bench.queue.run_until(MS)
    report = pack_report([pack_command(0x11, Opcode.PING)] * 8)
    bench.node.online = False
    for number in range(9):
        assert bench.board._ready() is (number < 8)
        bench.board.hid.write(MS, report)
    assert bench.board.dropped == 1
    bench.queue.run_until(3 * MS)
    for commands, ready in ((2, True), (1, False)):  # 64 less three in the controller: three more may wait
        bench.board.hid.write(bench.queue.now_ns, pack_report([pack_command(0x11, Opcode.PING)] * commands))
        bench.queue.run_until(bench.queue.now_ns + MS)
        assert bench.board._ready() is ready
    bench.node.online = True
    bench.queue.run_until(100 * MS)
    assert sum(frame.identifier == 0x091 for frame in bench.heard) == 67
    assert bench.board._ready()


def test_B7_the_gateway_is_heard_on_both_sides_and_forgets_all_at_power_up() -> None:
    bench = Bench()
    bench.node.send(Frame(0x0E1, pack_command(0x61, Opcode.PING)), 0)
    bench.queue.run_until(2_500 * MS)
    for identifier, count in ((0x161, 1), (0x761, 2)):
        assert sum(frame.identifier == identifier for frame in bench.heard) == count
        assert sum(frame.identifier == identifier for frame in bench.frames) == count
    bench.node.send(tach(0x31), bench.queue.now_ns)
    bench.queue.run_until(bench.queue.now_ns + MS // 2)
    report = pack_report([pack_command(0x11, Opcode.PING)] * 8)
    bench.node.online = False
    bench.board.hid.write(bench.queue.now_ns, report)
    bench.queue.run_until(bench.queue.now_ns + MS // 2)  # three commands in the controller, five wait
    bench.board.hid.write(bench.queue.now_ns, report)
    bench.board.power_off(bench.queue.now_ns)
    bench.board.hid.write(bench.queue.now_ns, report)
    bench.queue.run_until(bench.queue.now_ns + 100 * MS)
    bench.node.online = True
    bench.reports.clear()
    bench.heard.clear()
    bench.board.begin(bench.queue.now_ns)
    bench.node.send(tach(0x32), bench.queue.now_ns)
    fresh = pack_command(0x12, Opcode.PING)
    bench.board.hid.write(bench.queue.now_ns, pack_report([fresh]))
    bench.queue.run_until(bench.queue.now_ns + 100 * MS)
    assert bench.frames == [tach(0x32)] and [frame.data for frame in bench.heard] == [fresh]


def test_B7_routines_take_the_times_that_are_published() -> None:
    assert times_ns(TABLE, FCY_HZ) == {
        "second": (1000, 25_000),
        "can": (1000, 50_000),
        "usb": (1000, 100_000),
    }
    assert [line.level for line in TABLE] == [line.name != "second" for line in TABLE]
