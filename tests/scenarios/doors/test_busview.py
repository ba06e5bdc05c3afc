"""What a host sees of the emulated bus: loads of the last second, faults in words, looks of the telescope."""

from types import SimpleNamespace
from typing import Any

import pytest

from bus.can.frame import Frame
from bus.can.length import frame_bits
from host.console.views import Node
from scenarios.doors import busview
from scenarios.doors.busview import EmulatedBus, Looks
from scenarios.lab.faults.kind import Kind, Parameter

BIT_NS = 2000
S = 1_000_000_000
FRAME = Frame(0x211, b"\1\2")
BITS = frame_bits(FRAME)


class Served:
    """A wire whose bits a test counts."""

    def __init__(self) -> None:
        self.taps: list[Any] = []
        board = SimpleNamespace(name="A", online=False, state="active", tec=3, rec=4)
        guest = SimpleNamespace(name="guest", online=True, state="passive", tec=0, rec=0)
        wire = SimpleNamespace(
            bit_ns=BIT_NS, bits=0, errors={"bit": 2}, ports=[board, guest], tap=self.taps.append
        )
        self.network = SimpleNamespace(wire=wire, boards={"A": SimpleNamespace(on=True)}, plant="plant")
        self.now_ns, self.scenario = 0, "scenario"
        self.faults: Any = SimpleNamespace(running=[], kinds=list)

    def send(self, sender: str) -> None:
        self.network.wire.bits += BITS
        self.taps[0](self.now_ns, FRAME, sender)

    def command(self, words: list[str]) -> str:
        if words == ["bad"]:
            raise ValueError("not so")
        if words == ["worse"]:
            raise TypeError("no argument")
        return "|".join(words)


@pytest.fixture
def served() -> Any:
    return Served()


def test_a_second_without_time_has_no_load(served: Any) -> None:
    state = EmulatedBus(served).look()
    assert state.load == 0.0 and state.errors == {"bit": 2} and state.frames == [] and state.running == []
    assert state.nodes == [Node("A", True, "active", 3, 4, 0.0), Node("guest", True, "passive", 0, 0, 0.0)]


def test_loads_are_shares_of_the_last_second_by_sender(served: Any) -> None:
    """Three frames in half a second, two of A; a second later they are forgotten."""
    bus = EmulatedBus(served)
    for sender in ("A", "A", "guest"):
        served.send(sender)
    served.now_ns = S // 2
    state = bus.look()
    share = BITS * BIT_NS / (S / 2)
    assert state.load == pytest.approx(3 * share)
    assert [node.load for node in state.nodes] == pytest.approx([2 * share, share])
    served.send("guest")
    served.now_ns = S + S // 2
    state = bus.look()
    assert state.load == pytest.approx(BITS * BIT_NS / S)
    assert [node.load for node in state.nodes] == pytest.approx([0.0, BITS * BIT_NS / S])
    served.now_ns = 2 * S
    assert bus.look().load == pytest.approx(BITS * BIT_NS / (1.5 * S))


def test_a_node_that_is_no_board_is_on_when_it_is_online(served: Any) -> None:
    bus = EmulatedBus(served)
    served.network.wire.ports[1].online = served.network.boards["A"].on = False
    assert [node.powered for node in bus.look().nodes] == [False, False]


def test_the_last_25_frames_are_kept(served: Any) -> None:
    bus = EmulatedBus(served)
    for served.now_ns in range(27):
        served.send("A")
    frames = bus.look().frames
    assert len(frames) == 25 and frames[-1] == (26, "A", 0x211, b"\1\2") and frames[0][0] == 2


def test_a_fault_that_is_on_is_a_line(served: Any) -> None:
    served.now_ns = 5 * S
    given = SimpleNamespace(number=3, name="hang", arguments={"node": "A", "x": 2}, since_ns=2_560_000_000)
    served.faults.running = [given, SimpleNamespace(number=4, name="stop", arguments={}, since_ns=0)]
    expected = [(3, "hang, node=A x=2 for 2.4 s"), (4, "stop, no arguments for 5.0 s")]
    assert EmulatedBus(served).look().running == expected


def test_a_kind_of_fault_names_what_has_to_be_given(served: Any) -> None:
    parameters = (
        Parameter("node", "which", "node"),
        Parameter("every", "how often", "time", default="", low=0.5),
        Parameter("load", "of the time", "fraction", default=0.5, low=0.0, high=1.0),
    )
    kind = Kind("bus", "noise", "it hums", parameters, lambda *_: None, one_of=("every",))  # type: ignore[arg-type]
    served.faults.kinds = lambda: [kind]
    (found,) = EmulatedBus(served).fault_kinds()
    assert found[:4] == ("noise", "bus", "it hums", "node= every=")
    said = "node: which; every: how often, s; load: of the time, 0 to 1 (0.5 when left out)"
    assert found.arguments == said


def test_a_wish_is_answered_or_refused(served: Any) -> None:
    bus = EmulatedBus(served)
    assert bus.wish("power A  on") == ("power|A|on", False)
    assert bus.wish("bad") == ("not so", True) and bus.wish("worse") == ("no argument", True)


def test_looks_are_10_ms_apart_while_somebody_wants_them(
    served: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(busview, "look", lambda plant, scenario, t_ns: (plant, scenario, t_ns))
    looks = Looks(served)
    looks.poll(0)
    assert looks.taken() == []
    looks.wanted = True
    for t_ns in (0, 9_999_999, 10_000_000, 10_000_001, 25_000_000):
        looks.poll(t_ns)
    found: Any = looks.taken()
    assert found == [("plant", "scenario", t_ns) for t_ns in (0, 10_000_000, 25_000_000)]
    assert looks.taken() == []
