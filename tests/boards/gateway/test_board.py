from boards.gateway.firmware import RING_SLOTS, GatewayBoard
from bus.can import Frame, Wire
from bus.protocol import Device, Opcode, pack_command, pack_reply, pack_tach
from bus.protocol.report import PLACES, pack_report, unpack_report
from bus.time import EventQueue, Oscillator
from tests.boards.places import place

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
    for _ in range(RING_SLOTS + 5):
        bench.board._put(0, bytes(8))
    assert len(bench.board.ring) == RING_SLOTS
    assert bench.board.lost == 5


def test_foreign_frames_are_counted_and_ignored() -> None:
    bench = Bench()
    bench.node.send(Frame(0x2AA, b"\x01\x02"), 0)
    bench.node.send(Frame(0x2AA, bytes(8)), 0)
    bench.queue.run_until(20 * MS)
    assert bench.board.foreign == 2
    assert not bench.frames
