"""What enters a served network: by name, stamped and recorded, and the words that command it."""

from types import SimpleNamespace
from typing import Any

import pytest

from bus.can import Frame
from bus.can.wire import Wire
from bus.outside.node import OutsideNode
from bus.time import EventQueue
from scenarios.doors.livenetwork import Entry, LiveNetwork, frame_of, frame_text


class Desk:
    """A served network of stand-ins; heard: what was done to them; entered: what is recorded."""

    def __init__(self) -> None:
        self.heard: list[tuple[Any, ...]] = []
        self.entered: list[tuple[Any, ...]] = []
        self.queue = EventQueue()
        boards = {name: SimpleNamespace(power_on=self.hear(f"{name} on"), power_off=self.hear(f"{name} off"))
                  for name in ("FOCUS", "DISPLAY")}  # fmt: skip

        def board(name: str) -> Any:
            if name not in boards:
                raise ValueError(f"no board {name}")
            return boards[name]

        network = SimpleNamespace(
            queue=self.queue, uarts={}, board=board, boards=boards, wire=Wire(self.queue, 100_000),
            debug={"FOCUS": SimpleNamespace(write=self.hear("debug"))},
        )  # fmt: skip
        self.faults = SimpleNamespace(
            check=lambda name, given: {**given, "checked": name},
            running=[], start=self.start, clear=self.clear,
        )  # fmt: skip
        usb = SimpleNamespace(enter_by=lambda entry: entry.register("usb", self.hear("usb")))
        begun: Any = SimpleNamespace(network=network, faults=self.faults, usb=usb, nodes={})
        journal: Any = SimpleNamespace(write=lambda *entry: self.entered.append(entry))
        nothing: Any = None
        self.served = LiveNetwork(nothing, nothing, 2.5, journal, begun)

    def hear(self, who: str) -> Any:
        return lambda *given: self.heard.append((who, *given))

    def start(self, name: str, **values: Any) -> None:
        self.heard.append(("start", name, values))
        self.faults.running.append(SimpleNamespace(number=5 + len(self.faults.running)))

    def clear(self, number: int) -> None:
        if all(each.number != number for each in self.faults.running):
            raise ValueError(f"no fault {number} is on")
        self.heard.append(("clear", number))


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_an_entry_is_stamped_counted_and_done() -> None:
    queue, entered, done = EventQueue(), list[Any](), list[bytes]()
    journal: Any = SimpleNamespace(write=lambda *entry: entered.append(entry))
    entry = Entry(queue, journal)
    entry.register("b", done.append)
    entry.register("a", done.append)
    queue.run_until(7)
    entry.enter("b", b"x")
    assert (entry.count, entered, done, entry.kinds()) == (1, [(7, "b", b"x")], [b"x"], ["b", "a"])
    unrecorded = Entry(queue)
    unrecorded.register("b", done.append)
    unrecorded.enter("b", b"y")
    assert done == [b"x", b"y"] and unrecorded.count == 1


def test_a_kind_enters_once_and_never_in_the_middle_of_a_slice() -> None:
    entry = Entry(EventQueue())
    entry.register("b", lambda data: None)
    with pytest.raises(RuntimeError, match=r"^b is registered twice$"):
        entry.register("b", lambda data: None)
    entry.running = True
    with pytest.raises(RuntimeError, match=r"^b would enter in the middle of a slice$"):
        entry.enter("b", b"")
    assert entry.count == 0


def test_a_frame_is_written_as_candump_does() -> None:
    frame = Frame(0x211, bytes([0x11, 1, 0, 0]))
    assert frame_text(frame) == "211#11010000" and frame_of("211#11010000") == frame


@pytest.mark.parametrize("text", ["", "211", "211#1", "8FF#00", "20000123#00"])
def test_what_is_no_frame_of_this_bus_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        frame_of(text)


def test_what_enters_is_named_and_its_pace_is_set(desk: Desk) -> None:
    assert desk.served.entry.kinds() == ["usb", "command", "debug"] and desk.served.pacer.speed == 2.5
    assert not desk.served.ending and desk.served.now_ns == 0
    desk.served.run_until(9)
    desk.served.stop()
    assert desk.served.ending and desk.served.now_ns == 9


def test_doors_to_can_have_nodes_of_their_own(desk: Desk) -> None:
    nodes = [desk.served.node(index) for index in (0, 1)]
    assert all(isinstance(node, OutsideNode) for node in nodes)
    assert [node.port.name for node in nodes] == ["outside", "outside 1"]
    assert desk.served.nodes == {"can0": nodes[0], "can1": nodes[1]}


def test_a_frame_enters_by_its_doors_node(desk: Desk) -> None:
    """One that stood in a snapshot is used again."""
    stood: Any = SimpleNamespace(arrive=desk.hear("node 3"))
    desk.served.nodes["can3"] = stood
    assert desk.served.node(3) is stood
    desk.served.frame(3, Frame(0x11, b"\x11\x05"))
    assert desk.heard == [("node 3", Frame(0x11, b"\x11\x05"))] and desk.entered == [(0, "can3", b"011#1105")]


@pytest.mark.parametrize(("words", "answer", "heard", "entered"), [
    ("power FOCUS on", "FOCUS on", ("FOCUS on", 7), b"power FOCUS on"),
    ("power DISPLAY off", "DISPLAY off", ("DISPLAY off", 7), b"power DISPLAY off"),
    ("fault start hang node=AXIS_RA for=5_s", "fault 5 is on",
     ("start", "hang", {"node": "AXIS_RA", "for": "5 s", "checked": "hang"}),
     b'fault start hang {"node": "AXIS_RA", "for": "5 s", "checked": "hang"}'),
])  # fmt: skip
def test_words_command_it(words: str, answer: str, heard: Any, entered: bytes, desk: Desk) -> None:
    """A name keeps its dashes below; of a value they are blanks."""
    desk.served.run_until(7)
    assert desk.served.command(words.split()) == answer
    assert desk.heard == [heard] and desk.entered == [(7, "command", entered)]


def test_a_fault_is_cleared_by_its_number(desk: Desk) -> None:
    for _ in range(2):
        desk.served.start_fault("hang")
    assert desk.served.start_fault("hang") == 7
    assert desk.served.command(["fault", "clear", "6"]) == "fault 6 cleared"
    assert desk.heard[-1] == ("clear", 6) and desk.entered[-1] == (0, "command", b"fault clear 6")
    with pytest.raises(ValueError, match=r"^no fault 9 is on$"):
        desk.served.command(["fault", "clear", "9"])
    assert len(desk.entered) == 4


@pytest.mark.parametrize(("words", "text"), [
    (["jump"], "no command 'jump'"), (["power", "FOCUS"], "power BOARD on|off"),
    (["power", "FOCUS", "up"], "power BOARD on|off"), (["power", "NONE", "on"], "no board NONE"),
    (["fault", "clear", "x"], "fault list | kinds | start NAME ARGUMENT=VALUE ... | clear NUMBER"),
    (["fault", "start", "hang", "node"], "'node': arguments are written name=value"),
    (["fault", "start", "hang", "=x"], "'=x': arguments are written name=value"),
    (["fault", "start", "hang", "node="], "'node=': arguments are written name=value"),
])  # fmt: skip
def test_other_words_are_refused_and_leave_no_trace(words: list[str], text: str, desk: Desk) -> None:
    with pytest.raises(ValueError) as caught:
        desk.served.command(words)
    assert str(caught.value) == text and not desk.entered and not desk.heard


def test_a_recorded_command_that_is_none_is_refused(desk: Desk) -> None:
    with pytest.raises(ValueError, match=r"^no such command$"):
        desk.served.entry.enter("command", b"jump")


def test_bytes_go_to_a_boards_debug_port(desk: Desk) -> None:
    desk.served.run_until(7)
    desk.served.debug("FOCUS", b"a b")
    assert desk.heard == [("debug", 7, b"a b")] and desk.entered == [(7, "debug", b"FOCUS a b")]
