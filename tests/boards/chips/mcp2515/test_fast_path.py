"""The boards' fast CAN controller and the chip at register level put the same frames on the wire."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from boards.core import board as core
from boards.silicon.can import CanController
from bus.can import Frame, Port, Wire
from bus.can.length import frame_bits
from bus.time import EventQueue
from tests.boards.chips.mcp2515.controller import Mcp2515Controller
from tests.boards.lab import RA, Lab

Received = Callable[[int, Frame], None]
READY_NS = 30_000
"""End of the routine that sends."""
BIT_NS = 1000
"""1 Mbit/s."""
GROUPS = ((0x7FF, [0x091]), (0x700, [0x100, 0x200]))


def controller(port: Port, on_receive: Received) -> Mcp2515Controller:
    return Mcp2515Controller(port._wire.queue, port, on_receive)


sends = st.lists(
    st.tuples(
        st.integers(0, 1),  # who
        st.sampled_from([0x091, 0x100, 0x123, 0x201, 0x2FE, 0x300, 0x7FE]),  # + who: no two nodes send one
        st.binary(max_size=8),
        # ns to the next one, in whole bits: at once, or more than a bit later (within its first bit the fast
        # controller may still choose among its buffers, the chip has chosen; a frame that is ready within the
        # last bit of a bus that falls idle may start a nanosecond apart, which no node can tell)
        st.one_of(st.just(0), st.integers(2, 400).map(lambda bits: 1000 * bits)),
    ),
    max_size=40,
)


@settings(max_examples=60)
@given(sends)
def test_random_traffic(traffic: list[tuple[int, int, bytes, int]]) -> None:
    logs = []
    for make in (CanController, controller):
        queue = EventQueue()
        wire = Wire(queue)
        log: list[object] = []
        wire.tap(lambda *what, log=log: log.append(what))  # type: ignore[misc]
        nodes = [
            make(wire.attach(name), lambda t, f, n=name, log=log: log.append((n, t, f)))  # type: ignore[misc]
            for name in "ab"
        ]
        wire.attach("c")
        for node in nodes:
            node.accept(*GROUPS)
        for who, identifier, data, gap in traffic:
            log.append(nodes[who].send(Frame(identifier + who, data), queue.now_ns + READY_NS))
            queue.run_until(queue.now_ns + gap)
        queue.run_until(queue.now_ns + 10_000_000)
        logs.append(log)
    # The first bit of a frame that had waited for the bus, too: whoever is ready within it meets a chip that
    # has chosen, or a fast controller that has not.
    sent = [what for what in logs[0] if isinstance(what, tuple) and isinstance(what[0], int)]
    starts = {t_ns - (frame_bits(frame) - 3) * BIT_NS for t_ns, frame, _ in sent}
    ready = itertools.accumulate((gap for *_, gap in traffic), initial=READY_NS)
    assume(not any(0 < t_ns - start <= BIT_NS for t_ns in ready for start in starts))
    assert logs[0] == logs[1]


@pytest.mark.parametrize("make", [CanController, controller])
def test_two_nodes_send_one_frame_at_once_and_one_of_them_has_a_more_urgent_one(make: Any) -> None:
    """The wire carries the frame once for both; what comes within its first bit has to wait."""
    queue = EventQueue()
    wire = Wire(queue)
    log: list[int] = []
    wire.tap(lambda _t, frame, _name: log.append(frame.identifier))
    nodes = [make(wire.attach(name), lambda _t, _frame: None) for name in "ab"]
    wire.attach("c")
    nodes[0].send(Frame(0x300, b""), READY_NS)
    nodes[1].send(Frame(0x092, b""), READY_NS)
    nodes[1].send(Frame(0x300, b""), READY_NS)
    nodes[0].send(Frame(0x091, b""), READY_NS)
    queue.run_until(129_000)
    nodes[1].send(Frame(0x092, b"x"), queue.now_ns)
    queue.run_until(1_000_000)
    assert log == [0x091, 0x092, 0x300, 0x092]
    assert all(port.free_buffers == 3 for port in wire.ports[:2])


def test_the_boards_do_not_notice(monkeypatch: pytest.MonkeyPatch) -> None:
    told = []
    for make in (CanController, controller):
        monkeypatch.setattr(core, "CanController", make)
        lab = Lab()
        log: list[tuple[int, Frame, str]] = []
        lab.wire.tap(lambda *what, log=log: log.append(what))  # type: ignore[misc]
        lab.run(0.3)
        reply = lab.command(0x10, 1)
        lab.command(0x12, 400_000)
        lab.run(0.5)
        told.append((log, reply, lab.plant.angle))
        assert lab.axis.device_type == RA
    assert len(told[0][0]) > 400
    assert told[0] == told[1]
