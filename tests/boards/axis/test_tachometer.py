"""Counts of other boards brought to a sampling instant: ages, the low-pass of four frames, silence, wraps."""

import pytest

from boards.axis.tachometer import RemoteAuxiliary, RemoteTachometer
from bus.protocol.motion import pack_tach

MS = 1_000_000
FRAME_NS = 120_000
LATCH_NS = FRAME_NS + 40_000
"""Age of a motor's count when its frame has come: on the wire, and 40 us of its routine (FIDELITY.md)."""


def told(frames: int, delta: int, start: int = 0) -> RemoteTachometer:
    """So many frames of a constant speed, the last one latched at 0 with the count `start`."""
    found = RemoteTachometer(FRAME_NS)
    for k in range(1 - frames, 1):
        count = start + k * delta & 0xFFFF_FFFF
        found.take(k * 10 * MS + LATCH_NS, pack_tach(0x31, 0, count, delta))
    return found


@pytest.mark.parametrize(("frames", "rate"), [(1, 25), (2, 43), (3, 57), (4, 68), (60, 100)])
def test_B4_the_rate_is_a_low_pass_of_four_frames(frames: int, rate: int) -> None:
    """100 counts a frame: 100 (1 - 0.75^n), whole counts, at the first sample and between two."""
    found = told(frames, 100)
    assert found.sample(0) in (rate, rate - 1)
    assert found.sample(10 * MS) in (rate, rate - 1)


@pytest.mark.parametrize("delta", [1000, -1000])
@pytest.mark.parametrize("start", [0, 500, 0x7FFF_FF00, 0xFFFF_FF00])
def test_B4_samples_add_up_to_what_the_motor_turned_across_any_wrap(delta: int, start: int) -> None:
    found = told(80, delta, start)
    found.sample(0)
    assert found.sample(5 * MS) == pytest.approx(delta / 2, abs=3)
    found.take(10 * MS + LATCH_NS, pack_tach(0x31, 0, start + delta & 0xFFFF_FFFF, delta))
    assert found.sample(12 * MS) == pytest.approx(0.7 * delta, abs=3)


def test_B4_a_motor_is_silent_beyond_25_ms_and_begins_anew() -> None:
    found = told(80, 1000)
    assert found.sample(25 * MS) == pytest.approx(1000, abs=3)
    assert found.sample(25 * MS + 1) == 0
    found.take(30 * MS + LATCH_NS, pack_tach(0x31, 0, 9_000, 1000))
    assert found.sample(30 * MS) == pytest.approx(1000, abs=3)  # not what the counts jumped by
    found.forget()
    assert found.sample(0) == 0
    found.take(LATCH_NS, pack_tach(0x31, 0, 9_000, 0))
    assert found.sample(0) == 0
    assert RemoteTachometer(FRAME_NS).sample(1) == 0


def encoder(position: int, age: int = 0, alarm: bool = False) -> bytes:
    """An ENCODER frame, as the DBC lays it out: flags, 17 bits of position, age in 4 us."""
    return bytes((0x25, alarm)) + (position & 0x1FFFF).to_bytes(4, "little") + bytes((age, 1))


def turned(frames: int, delta: int, at: int = 0) -> RemoteAuxiliary:
    """So many frames of a constant speed, 400 us old, the last one latched at 0 at this position."""
    found = RemoteAuxiliary(FRAME_NS)
    for k in range(1 - frames, 1):
        found.take(k * 10 * MS + FRAME_NS + 400_000, encoder(at + k * delta, 100))
    return found


@pytest.mark.parametrize("delta", [65, -65, 5000, -5000])
@pytest.mark.parametrize("at", [70_000, 0, 131_071, 65_536])
def test_B4_a_position_is_carried_on_within_17_bits(delta: int, at: int) -> None:
    found = turned(90, delta, at)
    for later_ms, share in ((0, 0.0), (5, 0.5), (25, 2.5)):
        off = (found.sample(later_ms * MS) - at - share * delta + 65_536) % 131_072 - 65_536
        assert abs(off) < 1.5
    assert found.sample(25 * MS + 1) == 0


@pytest.mark.parametrize(("frames", "share"), [(1, 0.0), (2, 0.25), (3, 0.4375)])
def test_B4_its_rate_is_a_low_pass_of_four_frames_too(frames: int, share: float) -> None:
    assert turned(frames, 6400, 10_000).sample(10 * MS) == pytest.approx(10_000 + share * 6400, abs=1)


@pytest.mark.parametrize(("gap_ms", "share"), [(24, 0.75), (25, 0.0)])
def test_B4_an_encoder_that_was_silent_begins_without_a_rate(gap_ms: int, share: float) -> None:
    """Behind a gap of 25 ms nothing is known of it; within, a quarter of the new difference, here none."""
    found = turned(90, 1000, 10_000)
    found.take(gap_ms * MS + FRAME_NS, encoder(10_000))
    assert found.sample((gap_ms + 10) * MS) == pytest.approx(10_000 + share * 1000, abs=3)


def test_B4_a_lamp_that_is_out_is_no_position() -> None:
    found = RemoteAuxiliary(FRAME_NS)
    assert found.sample(1) == 0
    found.take(FRAME_NS, encoder(10_000, alarm=True))
    assert found.sample(0) == 0
    found.take(FRAME_NS, encoder(20_001))
    found.take(10 * MS + FRAME_NS, encoder(30_000, alarm=True))
    assert found.sample(10 * MS) == 20_001
    found.forget()
    assert found.sample(0) == 0
    found.take(0, encoder(40_000, 255))  # latched 1.1 ms before this board had its supply again
    assert found.sample(10 * MS) == 40_000
