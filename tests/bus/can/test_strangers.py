"""Nodes of another bit rate: who acknowledges, who objects, and when (ISO 11898-1)."""

import pytest

from bus.can import Frame, Wire, strangers
from bus.can.port import Offer
from bus.can.sampling import BitTiming
from bus.can.strangers import Strangers
from scenarios.native.finder import compiled
from tests.bus.can.test_wire import listen, network

FRAME = Frame(0x123, bytes.fromhex("0102030405060708"))
BITS = 119
"""With intermission (hardware.md 3.3)."""


def judged(wire: Wire) -> Strangers:
    offer = Offer(FRAME.identifier << 21, 1, 0, wire.ports[0], FRAME, BITS)
    return Strangers(wire, offer, wire.ports[1:]).judge()


def test_a_receiver_of_another_rate_alone_does_not_acknowledge() -> None:
    queue, wire = network(2)
    wire.ports[1].timing = BitTiming(500.0)
    assert not judged(wire).acknowledged
    wire.ports[1].timing = None
    assert judged(wire).acknowledged
    wire.ports[1].listen_only = True
    assert not judged(wire).acknowledged
    assert queue.now_ns == 0


def test_two_of_twice_the_rate_need_half_the_time() -> None:
    """50 bits with intermission (hardware.md 3.3) are 25 of this wire; the last three are its own."""
    queue, wire = network(2)
    log = listen(wire, 1)
    for port in wire.ports:
        port.timing = BitTiming(500.0)
    wire.ports[0].send(Frame(0x7FF, b""), 0)
    queue.run_until(1_000_000)
    assert log == [(22_000, Frame(0x7FF, b""))]
    assert wire.bits == 25 and not wire.errors


def test_a_receiver_whose_samples_are_right_takes_the_frame() -> None:
    """It is beyond its own tolerance, none, and yet samples every bit, the acknowledge slot included."""
    _, wire = network(3)
    wire.ports[2].timing = BitTiming(1000.01, tolerance=0.0)
    found = judged(wire)
    assert (found.error_bit, found.first, found.deaf) == (None, None, [])


def test_a_receiver_that_has_lost_a_bit_sees_the_acknowledge_as_a_form_error() -> None:
    """Of 993 ns a bit, never moved, it samples at 744.75 ns + 993 n: from n = 107 on, the bit before.

    The slot is bit 107 of this frame. What should be the delimiter, n = 108, is the slot: dominant, if
    somebody acknowledges.
    """
    _, wire = network(3)
    wire.ports[2].timing = BitTiming(993.0, jump=0.0, tolerance=0.0)
    found = judged(wire)
    assert (found.error_bit, found.first) == (108, wire.ports[2])
    wire.ports[1].listen_only = True
    assert judged(wire).error_bit is None


@pytest.mark.skipif(compiled(), reason="compiled code calls its own")
@pytest.mark.parametrize(("seen_ns", "bits", "alone", "deaf"), [
    ((50_000.0, None), 50, True, 0),  # one objects
    ((50_999.0, 50_000.0), 50, False, 0),  # both within the same bit
    ((51_000.0, 50_999.0), 50, True, 0),  # the first of the two
    ((50_999.0, 51_000.0), 50, True, 0),
    ((115_999.0, None), 115, True, 0),
    ((116_000.0, None), None, False, 1),  # the end of EOF: the frame is over
    ((116_000.0, 7_000.0), 7, True, 1),
])  # fmt: skip
def test_the_first_to_see_an_error_raises_it(
    seen_ns: tuple[float | None, float | None],
    bits: int | None,
    alone: bool,
    deaf: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    _, wire = network(4)
    for port in wire.ports[2:]:
        port.timing = BitTiming(500.0)
    told = list(seen_ns)
    monkeypatch.setattr(strangers, "error_ns", lambda *_: told.pop(0))
    found = judged(wire)
    assert found.error_bit == bits and (found.first is not None) == alone
    assert len(found.deaf) == deaf
    if alone and bits is not None:
        quickest = min((each, k) for k, each in enumerate(seen_ns) if each is not None)[1]
        assert found.first is wire.ports[2 + quickest]


@pytest.mark.skipif(compiled(), reason="compiled code calls its own")
@pytest.mark.parametrize("state", ["passive", "listen only"])
def test_who_may_not_object_is_deaf(state: str, monkeypatch: pytest.MonkeyPatch) -> None:
    _, wire = network(3)
    port = wire.ports[2]
    port.timing = BitTiming(500.0)
    port.listen_only, port.rec = state == "listen only", 128 if state == "passive" else 0
    monkeypatch.setattr(strangers, "error_ns", lambda *_: 50_000.0)
    found = judged(wire)
    assert (found.error_bit, found.deaf) == (None, [port])
