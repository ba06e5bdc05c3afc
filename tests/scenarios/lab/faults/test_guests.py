"""Nodes that do not belong on the bus: what they send and when, when they leave, and what proves it."""

from typing import Any

import pytest

from bus.can import Frame
from bus.can.length import frame_bits
from bus.can.port import BusError
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE
from scenarios.lab.faults.onbus import Babbler, Forger, Guest, Twin
from tests.scenarios.lab.faults.stub import BIT_NS, acted, place

ONE, OTHER = Frame(0x123, b"\1"), Frame(0x124, b"\2")


def test_a_guest_acts_when_its_frame_is_through() -> None:
    where = place()
    guest = Guest(where, "guest")
    guest.load(ONE, 5)
    port: Any = guest.port
    assert port.sent == [(ONE, 5)] and port.name == "guest"
    assert where.evidence.first_ns is None
    port.on_sent(9, ONE)
    assert acted(where.evidence) == (9, "frame 123#01")
    assert port in guest.wire.ports


@pytest.mark.parametrize(
    ("sending", "loaded", "acts"), [(True, True, True), (False, True, False), (True, False, False)]
)
def test_an_error_of_its_own_frame_is_proof_too(sending: bool, loaded: bool, acts: bool) -> None:
    where = place()
    guest: Any = Guest(where, "guest")
    if loaded:
        guest.load(ONE, 5)
    guest.port.on_error(7, BusError("bit", sending))
    assert where.evidence.on == ("frame 123#01" if acts else "")


def test_a_guest_leaves_at_once_or_after_what_has_begun() -> None:
    quiet: Any = Guest(place(), "guest")
    quiet.load(ONE, 5)
    quiet.clear(6)
    assert quiet.port not in quiet.wire.ports
    busy: Any = Guest(place(), "guest")
    busy.load(ONE, 5)
    busy.load(OTHER, 5)
    busy.port.begun = [OTHER]
    busy.clear(6)
    assert busy.port in busy.wire.ports
    busy.load(ONE, 7)
    assert len(busy.port.sent) == 2  # who leaves begins nothing
    busy.port.on_sent(8, OTHER)
    assert busy.port not in busy.wire.ports


def test_a_guest_that_is_bus_off_leaves_whatever_it_holds() -> None:
    guest: Any = Guest(place(), "guest")
    guest.load(ONE, 5)
    guest.port.begun, guest.port.state = [ONE], "bus_off"
    guest.clear(6)
    assert guest.port not in guest.wire.ports


def test_a_full_buffer_takes_nothing() -> None:
    guest: Any = Guest(place(), "guest")
    guest.port.room = 1
    guest.load(ONE, 1)
    guest.load(OTHER, 2)
    assert guest._loaded == [ONE]


@pytest.mark.parametrize(("load", "pauses"), [(1.0, 0.0), (0.5, 1.0), (0.2, 4.0)])
def test_a_babbler_leaves_a_share_of_the_time_to_others(load: float, pauses: float) -> None:
    babbler: Any = Babbler(place(), {"identifier": 0x10, "load": load}, 1000)
    frame = Frame(0x10, b"\xff" * 8)
    babbler.port.on_sent(50_000, frame)
    pause_ns = round(pauses * frame_bits(frame) * BIT_NS)
    assert babbler.port.sent == [(frame, 1000), (frame, 50_000 + pause_ns)]
    assert babbler.port.name == "babbler"


def test_a_forger_repeats_its_frame_until_it_is_cleared() -> None:
    where = place()
    forger: Any = Forger(where, {"identifier": 0x55, "data": 0x0102, "period": 4.0}, 100)
    queue: Any = where.network.queue
    assert [queue.step(), queue.step()] == [100, 4_000_000_100]
    frame = Frame(0x55, bytes([0, 0, 0, 0, 0, 0, 1, 2]))
    assert forger.port.sent == [(frame, 100), (frame, 4_000_000_100)] and forger.port.name == "forger"
    forger.clear(5_000_000_000)
    assert not queue.due and forger.port not in forger.wire.ports


def test_a_twin_measures_something_else_and_answers_commands() -> None:
    where = place()
    twin: Any = Twin(where, {"node": "B", "period": 0.005}, 0)
    queue: Any = where.network.queue
    queue.step()
    assert twin.port.name == "second B"
    assert twin.port.filters == [(0x7FF, COMMAND_BASE + 0x12)]
    assert twin.port.sent == [(Frame(MEASUREMENT_BASE + 0x12, b"\x12" + b"\x55" * 7), 0)]
    for data, opcode in ((b"\x12\x07", 7), (b"\x12", 0), (b"", 0)):
        twin.port.sent.clear()
        twin.port.on_receive(1000, Frame(COMMAND_BASE + 0x12, data))
        answer = bytes([0x12, opcode, 0, 0, 0x55, 0x55, 0, 0])
        assert twin.port.sent == [(Frame(REPLY_BASE + 0x12, answer), 2000)]  # 700 ns later, 300 ns long
